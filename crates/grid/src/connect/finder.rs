//! Face cells that touch, found by the numbers of their corners.

use std::collections::HashMap;

use super::Cell;
use super::points::{Points, shortest_edge};
use crate::face::{Face, Window};
use crate::period::Period;
use crate::topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side};

pub(super) struct Finder {
    /// Cells with an interface or a patch, `[block][face][p + np q]`.
    used: Vec<[Vec<bool>; 6]>,
    /// Point numbers of the face nodes, equal for equal points: `[block][face][p + (np+1) q]`, and the same for the
    /// nodes moved by the period.
    here: Vec<[Vec<u32>; 6]>,
    moved: Vec<[Vec<u32>; 6]>,
}

impl Finder {
    pub(super) fn new(grid: &MultiBlock) -> Self {
        let per_face = |n: usize| Face::ALL.map(|f| grid.blocks[n].face_cells(f));
        let used = (0..grid.blocks.len())
            .map(|n| per_face(n).map(|[p, q]| vec![false; p * q]))
            .collect();
        let mut finder = Self {
            used,
            here: Vec::new(),
            moved: Vec::new(),
        };
        let patches: Vec<Side> = grid.topology.patches.iter().map(Patch::side).collect();
        let ends = grid.topology.interfaces.iter().flat_map(|i| [i.a, i.b]);
        for side in patches.into_iter().chain(ends) {
            if side.block >= grid.blocks.len() {
                continue;
            }
            let [np, nq] = grid.blocks[side.block].face_cells(side.face);
            for q in side.window.lo[1]..side.window.hi[1].min(nq) {
                for p in side.window.lo[0]..side.window.hi[0].min(np) {
                    finder.used[side.block][side.face as usize][p + np * q] = true;
                }
            }
        }
        finder
    }

    /// Numbers the points of all faces; with a period, the moved points get the numbers of those they fall on.
    pub(super) fn number(&mut self, grid: &MultiBlock, tolerance: f64, period: Option<Period>) {
        let mut points = Points::new(tolerance);
        let mut table = |period: Option<Period>| -> Vec<[Vec<u32>; 6]> {
            grid.blocks
                .iter()
                .map(|block| {
                    Face::ALL.map(|face| {
                        let [np, nq] = block.face_cells(face);
                        let mut numbers = Vec::with_capacity((np + 1) * (nq + 1));
                        for q in 0..=nq {
                            for p in 0..=np {
                                let at = block.point_at(block.node_behind(face, p, q, 0));
                                let there = period.map_or(at, |by| by.moved(at));
                                numbers.push(points.number(there, 0.1 * shortest_edge(block, face, p, q)));
                            }
                        }
                        numbers
                    })
                })
                .collect()
        };
        self.here = table(None);
        self.moved = match period {
            Some(_) => table(period),
            None => self.here.clone(),
        };
    }

    pub(super) fn is_used(&self, grid: &MultiBlock, cell: Cell) -> bool {
        let [np, _] = grid.blocks[cell.block].face_cells(cell.face);
        self.used[cell.block][cell.face as usize][cell.p + np * cell.q]
    }

    fn set_used(&mut self, grid: &MultiBlock, cell: Cell) {
        let [np, _] = grid.blocks[cell.block].face_cells(cell.face);
        self.used[cell.block][cell.face as usize][cell.p + np * cell.q] = true;
    }

    /// Corner numbers in the order (0,0), (1,0), (0,1), (1,1).
    fn corners(&self, grid: &MultiBlock, cell: Cell, moved: bool) -> [u32; 4] {
        let [np, _] = grid.blocks[cell.block].face_cells(cell.face);
        let numbers = &(if moved { &self.moved } else { &self.here })[cell.block][cell.face as usize];
        let at = |p: usize, q: usize| numbers[p + (np + 1) * q];
        [
            at(cell.p, cell.q),
            at(cell.p + 1, cell.q),
            at(cell.p, cell.q + 1),
            at(cell.p + 1, cell.q + 1),
        ]
    }

    fn all_cells<'a>(&self, grid: &'a MultiBlock) -> impl Iterator<Item = Cell> + use<'a> {
        grid.blocks.iter().enumerate().flat_map(|(block, b)| {
            Face::ALL.into_iter().flat_map(move |face| {
                let [np, nq] = b.face_cells(face);
                (0..nq).flat_map(move |q| (0..np).map(move |p| Cell { block, face, p, q }))
            })
        })
    }

    pub(super) fn free(&self, grid: &MultiBlock) -> usize {
        self.all_cells(grid).filter(|&c| !self.is_used(grid, c)).count()
    }

    fn is_collapsed(&self, grid: &MultiBlock, cell: Cell) -> bool {
        distinct(self.corners(grid, cell, false)) < 3
    }

    /// Adds patches for collapsed face cells; how many.
    pub(super) fn collapsed(&mut self, grid: &mut MultiBlock) -> usize {
        let windows = self.windows(grid, |f, g, c| !f.is_used(g, c) && f.is_collapsed(g, c));
        for &(block, face, window) in &windows {
            for q in window.lo[1]..window.hi[1] {
                for p in window.lo[0]..window.hi[0] {
                    self.set_used(grid, Cell { block, face, p, q });
                }
            }
            let condition = Condition::Collapsed;
            grid.topology.patches.push(Patch {
                name: "collapsed".into(),
                block,
                face,
                window,
                condition,
            });
        }
        windows.len()
    }

    /// Rectangles that cover all face cells of a kind, each once.
    pub(super) fn windows(
        &self,
        grid: &MultiBlock,
        wanted: impl Fn(&Self, &MultiBlock, Cell) -> bool,
    ) -> Vec<(usize, Face, Window)> {
        let mut out = Vec::new();
        for (block, b) in grid.blocks.iter().enumerate() {
            for face in Face::ALL {
                let [np, nq] = b.face_cells(face);
                let mut left: Vec<bool> = Vec::with_capacity(np * nq);
                for q in 0..nq {
                    for p in 0..np {
                        left.push(wanted(self, grid, Cell { block, face, p, q }));
                    }
                }
                for q in 0..nq {
                    for p in 0..np {
                        if !left[p + np * q] {
                            continue;
                        }
                        let mut end = [p + 1, q + 1];
                        while end[0] < np && left[end[0] + np * q] {
                            end[0] += 1;
                        }
                        while end[1] < nq && (p..end[0]).all(|p| left[p + np * end[1]]) {
                            end[1] += 1;
                        }
                        for b in q..end[1] {
                            for a in p..end[0] {
                                left[a + np * b] = false;
                            }
                        }
                        out.push((block, face, Window::new([p, q], end)));
                    }
                }
            }
        }
        out
    }

    /// Pairs free face cells with equal corners and joins the pairs to windows.
    pub(super) fn match_cells(&mut self, grid: &MultiBlock, period: Option<Period>) -> (Vec<Interface>, usize) {
        let mut by_corners: HashMap<[u32; 4], Vec<Cell>> = HashMap::new();
        for cell in self.all_cells(grid).filter(|&c| !self.is_used(grid, c)) {
            let corners = self.corners(grid, cell, false);
            if distinct(corners) >= 3 {
                by_corners.entry(sorted(corners)).or_default().push(cell);
            }
        }
        let mut ambiguous = 0;
        let mut partner: HashMap<Cell, Cell> = HashMap::new();
        for cell in self.all_cells(grid).filter(|&c| !self.is_used(grid, c)) {
            let corners = self.corners(grid, cell, true);
            if distinct(corners) < 3 {
                continue;
            }
            let Some(same) = by_corners.get(&sorted(corners)) else {
                continue;
            };
            let others: Vec<Cell> = same.iter().copied().filter(|&c| c != cell).collect();
            match others[..] {
                [other] => {
                    partner.insert(cell, other);
                }
                [] => {}
                _ => ambiguous += 1,
            }
        }
        let mut out = Vec::new();
        for cell in self.all_cells(grid).collect::<Vec<_>>() {
            if self.is_used(grid, cell) {
                continue;
            }
            let Some(&other) = partner.get(&cell) else { continue };
            if self.is_used(grid, other) {
                continue;
            }
            if let Some(interface) = self.grow(grid, &partner, cell, other, period) {
                out.push(interface);
            }
        }
        (out, ambiguous)
    }

    /// The largest interface with `a` as its first cell, over the orientations that fit (a triangle fits two).
    fn grow(
        &mut self,
        grid: &MultiBlock,
        partner: &HashMap<Cell, Cell>,
        a: Cell,
        b: Cell,
        period: Option<Period>,
    ) -> Option<Interface> {
        let mut best: Option<(usize, Orientation, [usize; 2])> = None;
        for orientation in Orientation::ALL {
            let fits = |dp: usize, dq: usize| self.pair_fits(grid, partner, a, b, orientation, dp, dq);
            if !fits(0, 0) {
                continue;
            }
            let [np, nq] = grid.blocks[a.block].face_cells(a.face);
            // Along p first, then along q: a's and b's cells must stay apart where a block touches itself.
            let mut size = [1, 1];
            while a.p + size[0] < np && fits(size[0], 0) && self.apart(a, b, orientation, [size[0] + 1, 1]) {
                size[0] += 1;
            }
            while a.q + size[1] < nq
                && (0..size[0]).all(|dp| fits(dp, size[1]))
                && self.apart(a, b, orientation, [size[0], size[1] + 1])
            {
                size[1] += 1;
            }
            if best.is_none_or(|(count, ..)| size[0] * size[1] > count) {
                best = Some((size[0] * size[1], orientation, size));
            }
        }
        let (_, orientation, size) = best?;
        let window_a = Window::new([a.p, a.q], [a.p + size[0], a.q + size[1]]);
        let window_b = window_on_b(b, orientation, size);
        for q in 0..size[1] {
            for p in 0..size[0] {
                self.set_used(
                    grid,
                    Cell {
                        p: a.p + p,
                        q: a.q + q,
                        ..a
                    },
                );
                if let Some(other) = across(b, orientation, p, q) {
                    self.set_used(grid, other);
                }
            }
        }
        Some(Interface {
            a: Side {
                block: a.block,
                face: a.face,
                window: window_a,
            },
            b: Side {
                block: b.block,
                face: b.face,
                window: window_b,
            },
            orientation,
            period,
        })
    }

    #[expect(clippy::too_many_arguments, reason = "one pair of cells and the step from it")]
    fn pair_fits(
        &self,
        grid: &MultiBlock,
        partner: &HashMap<Cell, Cell>,
        a: Cell,
        b: Cell,
        orientation: Orientation,
        dp: usize,
        dq: usize,
    ) -> bool {
        let cell = Cell {
            p: a.p + dp,
            q: a.q + dq,
            ..a
        };
        let Some(other) = across(b, orientation, dp, dq) else {
            return false;
        };
        if partner.get(&cell) != Some(&other) || self.is_used(grid, cell) || self.is_used(grid, other) {
            return false;
        }
        let (ca, cb) = (self.corners(grid, cell, true), self.corners(grid, other, false));
        (0..4).all(|n| {
            let [p, q] = orientation.map([n % 2, n / 2], [2, 2]);
            ca[n] == cb[p + 2 * q]
        })
    }

    /// True if the windows of `size` do not overlap.
    fn apart(&self, a: Cell, b: Cell, orientation: Orientation, size: [usize; 2]) -> bool {
        if a.block != b.block || a.face != b.face {
            return true;
        }
        let window_a = Window::new([a.p, a.q], [a.p + size[0], a.q + size[1]]);
        window_a.intersection(&window_on_b(b, orientation, size)).is_none()
    }
}

/// The cell of b's face that lies on the cell `(dp, dq)` steps from a's first one, whose partner is `b`.
fn across(b: Cell, orientation: Orientation, dp: usize, dq: usize) -> Option<Cell> {
    let steps = if orientation.swap { [dq, dp] } else { [dp, dq] };
    let go = |from: usize, step: usize, back: bool| {
        if back {
            from.checked_sub(step)
        } else {
            Some(from + step)
        }
    };
    Some(Cell {
        p: go(b.p, steps[0], orientation.reverse[0])?,
        q: go(b.q, steps[1], orientation.reverse[1])?,
        ..b
    })
}

fn window_on_b(b: Cell, orientation: Orientation, size: [usize; 2]) -> Window {
    let size = orientation.size(size);
    let range = |from: usize, n: usize, back: bool| {
        if back {
            (from + 1 - n.min(from + 1), from + 1)
        } else {
            (from, from + n)
        }
    };
    let (p0, p1) = range(b.p, size[0], orientation.reverse[0]);
    let (q0, q1) = range(b.q, size[1], orientation.reverse[1]);
    Window::new([p0, q0], [p1, q1])
}

fn distinct(c: [u32; 4]) -> usize {
    let s = sorted(c);
    1 + (1..4).filter(|&n| s[n] != s[n - 1]).count()
}

fn sorted(mut c: [u32; 4]) -> [u32; 4] {
    c.sort_unstable();
    c
}
