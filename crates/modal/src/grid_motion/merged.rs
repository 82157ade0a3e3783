//! Which nodes of a grid are one.

use dip_grid::{Face, MultiBlock};

/// Which nodes of block faces are one: those that interfaces join, those at the same place to the bit (collapsed edges,
/// blocks that meet in an edge), and in a two-dimensional grid those across it.
#[derive(Debug, Clone)]
pub(super) struct Merged {
    /// First node of each block in the count over all blocks.
    first: Vec<usize>,
    /// Towards the smallest node that is the same.
    parent: Vec<usize>,
}

impl Merged {
    pub(super) fn new(grid: &MultiBlock) -> Self {
        let mut first = Vec::with_capacity(grid.blocks.len());
        let mut count = 0;
        for block in &grid.blocks {
            first.push(count);
            count += block.node_count();
        }
        let mut merged = Self {
            first,
            parent: (0..count).collect(),
        };
        for interface in &grid.topology.interfaces {
            let (a, b) = (interface.a, interface.b);
            for q in a.window.lo[1]..=a.window.hi[1] {
                for p in a.window.lo[0]..=a.window.hi[0] {
                    let [s, t] = interface.node_on_b(p, q);
                    let one = merged.of_face(grid, a.block, a.face, p, q);
                    let other = merged.of_face(grid, b.block, b.face, s, t);
                    merged.join(one, other);
                }
            }
        }
        let mut places: Vec<([u64; 3], usize)> = merged
            .face_nodes(grid)
            .into_iter()
            .map(|n| (merged.position(grid, n).map(|v| (v + 0.0).to_bits()), n))
            .collect();
        places.sort_unstable();
        for pair in places.windows(2) {
            if pair[0].0 == pair[1].0 {
                merged.join(pair[0].1, pair[1].1);
            }
        }
        if grid.is_two_dimensional() {
            for (b, block) in grid.blocks.iter().enumerate() {
                let plane = (block.ni + 1) * (block.nj + 1);
                for n in 0..plane {
                    merged.join(merged.of(b, n), merged.of(b, n + plane));
                }
            }
        }
        merged
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    fn root(&self, mut n: usize) -> usize {
        while self.parent[n] != n {
            n = self.parent[n];
        }
        n
    }

    /// The merged node of node `n` of block `b`.
    pub(super) fn of(&self, b: usize, n: usize) -> usize {
        self.root(self.first[b] + n)
    }

    pub(super) fn of_face(&self, grid: &MultiBlock, b: usize, face: Face, p: usize, q: usize) -> usize {
        let block = &grid.blocks[b];
        let [i, j, k] = block.node_behind(face, p, q, 0);
        self.of(b, block.node(i, j, k))
    }

    pub(super) fn position(&self, grid: &MultiBlock, node: usize) -> [f64; 3] {
        let b = self.first.partition_point(|&f| f <= node) - 1;
        let (block, n) = (&grid.blocks[b], node - self.first[b]);
        [block.x[n], block.y[n], block.z[n]]
    }

    /// All merged nodes on faces of blocks, ascending.
    fn face_nodes(&self, grid: &MultiBlock) -> Vec<usize> {
        let mut all = Vec::new();
        for (b, block) in grid.blocks.iter().enumerate() {
            for face in Face::ALL {
                let [np, nq] = block.face_cells(face);
                for q in 0..=nq {
                    all.extend((0..=np).map(|p| self.of_face(grid, b, face, p, q)));
                }
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    }
}
