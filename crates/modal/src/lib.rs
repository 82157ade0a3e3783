//! The structure: finite elements, normal modes, modal tables.
