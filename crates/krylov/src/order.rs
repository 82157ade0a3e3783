//! In which order BILU(0) eliminates the cells of all blocks, and which of them may be worked on at the same time.
//!
//! Blocks follow each other by rank, each is swept along i, j and k from one end to the other. What the factors are
//! worth depends on this: a wave that crosses an interface is carried on in the same sweep only if one block is swept
//! towards the interface and the next one away from it.
//!
//! Blocks are cut into slabs of layers. A slab needs the one before it in its block and those of other blocks, earlier in
//! the order, that it touches; slabs that need nothing of each other are worked on side by side. Every cell sees the
//! same values whatever the number of threads.

/// A coupling of an outermost cell of a block to a cell of another block (or to the other end of its own).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coupling {
    /// Block of the row.
    pub block: u32,
    /// Cell of the row in its block.
    pub cell: u32,
    /// Direction of the neighbour, 0 to 2.
    pub direction: u8,
    /// True if the neighbour lies at the larger index.
    pub upper: bool,
    /// The neighbour, counted over all blocks.
    pub neighbour: u32,
}

/// When a block comes, and from which ends it is swept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sweep {
    /// Blocks of smaller rank come first; of equal ones that of the smaller index.
    pub rank: usize,
    /// Along i, j, k: from the largest index to the smallest.
    pub reversed: [bool; 3],
}

/// Place of a coupling's block among the matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) block: u32,
    /// `cell * directions + direction`.
    pub(crate) at: u32,
    pub(crate) upper: bool,
}

/// A coupling between two cells as one of them sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    /// The cell, in its slab.
    pub(crate) cell: u32,
    /// Its block for the neighbour.
    pub(crate) entry: Entry,
    /// The neighbour's block for it.
    pub(crate) back: Entry,
    /// The neighbour: slab and cell in it.
    pub(crate) slab: u32,
    pub(crate) neighbour: u32,
}

/// Some layers of a block: rows of i, or planes of i and j where there is more than one cell along k.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slab {
    pub(crate) number: usize,
    pub(crate) block: usize,
    /// First cell in its block.
    pub(crate) first: usize,
    /// First cell over all blocks.
    pub(crate) offset: usize,
    /// Cells of a row, rows of a layer, layers.
    pub(crate) size: [usize; 3],
    /// The block's sweep along rows, along the rows of a layer, and from layer to layer.
    pub(crate) reversed: [bool; 3],
    /// Slabs of the block before and after it in the sweep, and the cells of each.
    pub(crate) previous: Option<usize>,
    pub(crate) next: Option<usize>,
    /// Couplings to cells earlier in the order, in the order of the sweep.
    pub(crate) before: Vec<Link>,
    /// Couplings to cells later in the order, in the opposite order.
    pub(crate) after: Vec<Link>,
    /// Slabs that must be finished before it: in the order, and in the opposite one.
    pub(crate) needs: [Vec<usize>; 2],
}

impl Slab {
    pub(crate) fn cell_count(&self) -> usize {
        self.size.iter().product()
    }

    /// Number of a cell in the sweep of its slab.
    fn place(&self, cell: usize) -> usize {
        let [ni, rows, layers] = self.size;
        let turned = |n: usize, count: usize, reversed: bool| if reversed { count - 1 - n } else { n };
        let i = turned(cell % ni, ni, self.reversed[0]);
        let row = turned(cell / ni % rows, rows, self.reversed[1]);
        let layer = turned(cell / (ni * rows), layers, self.reversed[2]);
        i + ni * (row + rows * layer)
    }
}

/// The order of all cells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Order {
    /// By block, layers ascending.
    pub(crate) slabs: Vec<Slab>,
    /// Numbers of the slabs as they are begun: those that need nothing of each other stand side by side.
    pub(crate) queue: Vec<usize>,
    /// Most slabs that can be worked on side by side.
    pub(crate) breadth: usize,
    pub(crate) cell_count: usize,
}

/// Directions that a block's matrix keeps.
pub(crate) fn directions(cells: [usize; 3]) -> usize {
    if cells[2] == 1 { 2 } else { 3 }
}

impl Order {
    /// The order of blocks of `cells` with `couplings` between them. Blocks without a sweep are swept from the smallest
    /// indices, in the order of their numbers. Couplings that are not returned by the neighbour, or join a cell to itself, are
    /// left out.
    pub(crate) fn new(cells: &[[usize; 3]], couplings: &[Coupling], sweeps: &[Sweep]) -> Self {
        let sweep = |b: usize| sweeps.get(b).copied().unwrap_or_default();
        let mut slabs = Vec::new();
        let mut starts = Vec::with_capacity(cells.len());
        let mut offset = 0;
        for (b, c) in cells.iter().enumerate() {
            starts.push(slabs.len());
            cut(b, *c, offset, sweep(b), &mut slabs);
            offset += c.iter().product::<usize>();
        }
        // Number of every slab in the order.
        let mut sequence: Vec<usize> = (0..slabs.len()).collect();
        sequence.sort_by_key(|n| {
            let slab = &slabs[*n];
            let number = if slab.reversed[2] { slabs.len() - n } else { *n };
            (sweep(slab.block).rank, slab.block, number)
        });
        let mut position = vec![0; slabs.len()];
        for (p, n) in sequence.iter().enumerate() {
            position[*n] = p;
        }
        for [row, back] in pairs(couplings, cells) {
            let (slab, cell) = find(&slabs, &starts, row.block as usize, row.cell as usize);
            let (other, neighbour) = find(&slabs, &starts, back.block as usize, back.cell as usize);
            let link = Link {
                cell: cell as u32,
                entry: entry(row, cells),
                back: entry(back, cells),
                slab: other as u32,
                neighbour: neighbour as u32,
            };
            let is_before = if slab == other {
                slabs[slab].place(neighbour) < slabs[slab].place(cell)
            } else {
                position[other] < position[slab]
            };
            if is_before {
                slabs[slab].before.push(link);
            } else {
                slabs[slab].after.push(link);
            }
        }
        for slab in &mut slabs {
            let (mut before, mut after) = (std::mem::take(&mut slab.before), std::mem::take(&mut slab.after));
            before.sort_by_key(|link| slab.place(link.cell as usize));
            after.sort_by_key(|link| std::cmp::Reverse(slab.place(link.cell as usize)));
            (slab.before, slab.after) = (before, after);
        }
        for slab in &mut slabs {
            let others = |links: &[Link]| -> Vec<usize> { links.iter().map(|link| link.slab as usize).collect() };
            slab.needs = [
                distinct(slab.number, slab.previous, others(&slab.before)),
                distinct(slab.number, slab.next, others(&slab.after)),
            ];
        }
        let waves = waves(&slabs, &sequence);
        Self {
            breadth: waves.iter().map(Vec::len).max().unwrap_or(0),
            queue: waves.concat(),
            slabs,
            cell_count: offset,
        }
    }
}

/// Slabs other than `own` of which it needs values.
fn distinct(own: usize, neighbour: Option<usize>, mut others: Vec<usize>) -> Vec<usize> {
    others.extend(neighbour);
    others.retain(|n| *n != own);
    others.sort_unstable();
    others.dedup();
    others
}

/// Cuts a block into slabs: enough of them that waves are wide, none so small that its start takes longer than its work.
fn cut(block: usize, cells: [usize; 3], offset: usize, sweep: Sweep, slabs: &mut Vec<Slab>) {
    const LEAST_CELLS: usize = 400;
    const MOST: usize = 64;
    let [ni, nj, nk] = cells;
    let (rows, layers, reversed) = if directions(cells) == 3 {
        (nj, nk, sweep.reversed)
    } else {
        (1, nj, [sweep.reversed[0], false, sweep.reversed[1]])
    };
    let count = (ni * nj * nk / LEAST_CELLS).clamp(1, MOST).min(layers.max(1));
    let start = slabs.len();
    for n in 0..count {
        let (from, to) = (layers * n / count, layers * (n + 1) / count);
        let number = start + n;
        let (below, above) = ((n > 0).then(|| number - 1), (n + 1 < count).then_some(number + 1));
        let (previous, next) = if reversed[2] { (above, below) } else { (below, above) };
        slabs.push(Slab {
            number,
            block,
            first: from * ni * rows,
            offset: offset + from * ni * rows,
            size: [ni, rows, to - from],
            reversed,
            previous,
            next,
            before: Vec::new(),
            after: Vec::new(),
            needs: [Vec::new(), Vec::new()],
        });
    }
}

/// Slab of a block's cell, and the cell in it.
fn find(slabs: &[Slab], starts: &[usize], block: usize, cell: usize) -> (usize, usize) {
    let of_block = &slabs[starts[block]..];
    let n = of_block.partition_point(|s| s.block == block && s.first <= cell) - 1;
    (starts[block] + n, cell - of_block[n].first)
}

fn entry(coupling: Coupling, cells: &[[usize; 3]]) -> Entry {
    let directions = directions(cells[coupling.block as usize]) as u32;
    Entry {
        block: coupling.block,
        at: coupling.cell * directions + u32::from(coupling.direction),
        upper: coupling.upper,
    }
}

/// Every coupling with the one that returns it. Two cells may touch twice: then the first goes with the first.
fn pairs(couplings: &[Coupling], cells: &[[usize; 3]]) -> Vec<[Coupling; 2]> {
    let mut offsets = Vec::with_capacity(cells.len());
    let mut total = 0;
    for c in cells {
        offsets.push(total as u32);
        total += c.iter().product::<usize>();
    }
    let mut keyed: Vec<(u32, u32, usize)> = couplings
        .iter()
        .enumerate()
        .filter(|(_, c)| usize::from(c.direction) < directions(cells[c.block as usize]))
        .map(|(n, c)| (offsets[c.block as usize] + c.cell, c.neighbour, n))
        .collect();
    keyed.sort_unstable();
    let first = |row: u32, neighbour: u32| keyed.partition_point(|k| (k.0, k.1) < (row, neighbour));
    keyed
        .iter()
        .enumerate()
        .filter(|(_, (row, neighbour, _))| row != neighbour)
        .filter_map(|(at, (row, neighbour, n))| {
            let nth = at - first(*row, *neighbour);
            let back = keyed.get(first(*neighbour, *row) + nth)?;
            ((back.0, back.1) == (*neighbour, *row)).then(|| [couplings[*n], couplings[back.2]])
        })
        .collect()
}

/// Wave of every slab: one later than the latest that it needs.
fn waves(slabs: &[Slab], sequence: &[usize]) -> Vec<Vec<usize>> {
    let mut depth = vec![0; slabs.len()];
    let mut waves: Vec<Vec<usize>> = Vec::new();
    for n in sequence {
        let slab = &slabs[*n];
        depth[*n] = slab.needs[0].iter().map(|m| depth[*m] + 1).max().unwrap_or(0);
        if waves.len() <= depth[*n] {
            waves.resize(depth[*n] + 1, Vec::new());
        }
        waves[depth[*n]].push(*n);
    }
    waves
}
