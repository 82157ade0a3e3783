//! A Nastran SOL 145 deck made into our structure, lattice and flutter solution.
