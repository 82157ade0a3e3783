//! Finds the layout of a grid file, and reads it.

use super::bytes::{Order, known, odd_word, records, text};
use super::records::unformatted;
use super::{Encoding, Grid, Layout};
use crate::block::Block;

/// Most blocks a file may claim to have.
pub(super) const MOST_BLOCKS: usize = 1 << 20;

/// Node counts of a block.
pub(super) type Size = [usize; 3];

pub(super) fn grid(bytes: &[u8]) -> Result<Grid, String> {
    if bytes.is_empty() {
        return Err("the file is empty".into());
    }
    let mut tried = Vec::new();
    if let Some(numbers) = text(bytes) {
        return ascii(&numbers);
    }
    let mut fits: Vec<Grid> = Vec::new();
    for big_endian in [false, true] {
        let order = Order { big_endian };
        for marker in [4, 8] {
            if let Some(records) = records(bytes, order, marker) {
                match unformatted(&records, order, marker) {
                    Ok(grid) => fits.push(grid),
                    Err(what) => tried.push(what),
                }
            }
        }
    }
    if fits.is_empty() {
        for big_endian in [false, true] {
            stream(bytes, Order { big_endian }, &mut fits);
        }
    }
    // Of several readings the sane one; none sane: the first, whose check then says what is wrong with it.
    let sane = fits.iter().position(|g| check(g).is_ok());
    let chosen = match sane {
        Some(n) => fits.swap_remove(n),
        None if !fits.is_empty() => fits.swap_remove(0),
        None => {
            no_grid(bytes)?;
            let start = tried.into_iter().next().unwrap_or_else(|| {
                "no Plot3D layout fits its length: neither Fortran records (their markers do not chain to the end), nor \
                 stream binary (block sizes and coordinates do not add up to the length), nor text"
                    .into()
            });
            return Err(format!(
                "{start}; the file may be truncated or of another format ({} bytes)",
                bytes.len()
            ));
        }
    };
    check(&chosen)?;
    Ok(chosen)
}

/// An error for a file that is plainly something else.
pub(super) fn no_grid(bytes: &[u8]) -> Result<(), String> {
    if let Some(what) = known(bytes) {
        return Err(format!("not Plot3D but {what}"));
    }
    if let Some((line, word)) = odd_word(bytes) {
        if bytes.ends_with(word.as_bytes()) {
            return Err(format!(
                "it ends in line {line} within a number, \"{word}\": it is truncated"
            ));
        }
        let word: String = word.chars().take(40).collect();
        return Err(format!(
            "line {line}: \"{word}\" is no number; a Plot3D text file holds numbers alone"
        ));
    }
    Ok(())
}

fn check(grid: &Grid) -> Result<(), String> {
    for (n, block) in grid.blocks.iter().enumerate() {
        for (name, values) in [("x", &block.x), ("y", &block.y), ("z", &block.z)] {
            // Bytes of another precision or order read as numbers like 1e-290 or 1e200.
            if let Some(at) = values.iter().position(|v| !v.is_finite() || v.abs() > 1e30) {
                let [ni, nj, _] = block.nodes();
                return Err(format!(
                    "block {}: {name} of node ({}, {}, {}) is {:e}, not a coordinate",
                    n + 1,
                    at % ni,
                    at / ni % nj,
                    at / (ni * nj),
                    values[at]
                ));
            }
        }
        let largest = block
            .x
            .iter()
            .chain(&block.z)
            .chain(&block.y)
            .fold(0.0f64, |m, v| m.max(v.abs()));
        if largest < 1e-30 {
            return Err(format!("block {}: all coordinates are zero", n + 1));
        }
    }
    if let Some(n) = grid.surface {
        return Err(format!(
            "block {} is one node thick and does not lie in a plane: a surface, not a grid of cells",
            n + 1
        ));
    }
    Ok(())
}

/// Sizes from integers; `None` if any is not a possible size.
pub(super) fn sizes(integers: &[i64], three_d: bool) -> Option<Vec<Size>> {
    let d = if three_d { 3 } else { 2 };
    if integers.is_empty() || !integers.len().is_multiple_of(d) {
        return None;
    }
    integers
        .chunks(d)
        .map(|c| {
            let n: Vec<usize> = c
                .iter()
                .map(|&v| usize::try_from(v).ok().filter(|&n| n >= 1))
                .collect::<Option<_>>()?;
            let size = [n[0], n[1], if three_d { n[2] } else { 1 }];
            // At least a surface, and a number of nodes that can be counted.
            size[0].checked_mul(size[1])?.checked_mul(size[2])?.checked_mul(64)?;
            (size.iter().filter(|&&n| n >= 2).count() >= 2).then_some(size)
        })
        .collect()
}

/// Of blocks one node thick only those along k are understood as two-dimensional.
pub(super) fn thick_along_k(sizes: &[Size]) -> Result<(), String> {
    match sizes.iter().position(|s| s[2] > 1 && (s[0] == 1 || s[1] == 1)) {
        Some(n) => {
            let [i, j, k] = sizes[n];
            Err(format!(
                "block {} has {i} x {j} x {k} nodes; a block one node thick must be so along k",
                n + 1
            ))
        }
        None => Ok(()),
    }
}

pub(super) fn nodes(size: Size) -> usize {
    size[0] * size[1] * size[2]
}

/// The header of a text file: layout, sizes and how many numbers it takes, in order of trust.
pub(super) fn headers(numbers: &[f64]) -> Vec<(bool, bool, Vec<Size>, usize)> {
    let whole = |v: f64| (v.fract() == 0.0 && v.abs() < 1e15).then_some(v as i64);
    let mut out = Vec::new();
    for (multi, three_d) in [(true, true), (true, false), (false, true), (false, false)] {
        let d = if three_d { 3 } else { 2 };
        let (start, count) = if multi {
            match numbers.first().and_then(|&v| whole(v)) {
                Some(n) if n >= 1 && n as usize <= MOST_BLOCKS => (1, d * n as usize),
                _ => continue,
            }
        } else {
            (0, d)
        };
        let Some(head) = numbers.get(start..start + count) else {
            continue;
        };
        let Some(integers) = head.iter().map(|&v| whole(v)).collect::<Option<Vec<i64>>>() else {
            continue;
        };
        if let Some(sizes) = sizes(&integers, three_d) {
            out.push((multi, three_d, sizes, start + count));
        }
    }
    out
}

fn ascii(numbers: &[f64]) -> Result<Grid, String> {
    let mut nearest: Option<String> = None;
    for (multi, three_d, sizes, start) in headers(numbers) {
        let total: usize = sizes.iter().map(|&s| nodes(s)).fold(0, usize::saturating_add);
        let reals = total.saturating_mul(if three_d { 3 } else { 2 });
        let left = numbers.len() - start;
        for iblank in [false, true] {
            if left == reals.saturating_add(if iblank { total } else { 0 }) {
                thick_along_k(&sizes)?;
                let layout = Layout {
                    encoding: Encoding::Ascii,
                    double: true,
                    multi,
                    three_d,
                    iblank,
                };
                let grid = build(&sizes, layout, &mut |block, part| {
                    let n = nodes(sizes[block]);
                    let parts = if three_d { 3 } else { 2 } + usize::from(iblank);
                    let before: usize = sizes[..block].iter().map(|&s| nodes(s) * parts).sum();
                    let at = start + before + part * n;
                    numbers[at..at + n].to_vec()
                });
                check(&grid)?;
                return Ok(grid);
            }
        }
        nearest.get_or_insert_with(|| {
            let what = if multi {
                format!("{} blocks", sizes.len())
            } else {
                "one block".into()
            };
            format!(
                "the header says {what} in {} with {total} nodes, which takes {reals} coordinates; the file has {left} \
                 numbers after the header ({})",
                if three_d { "3-D" } else { "2-D" },
                if left < reals {
                    "it is truncated, or the sizes are wrong"
                } else {
                    "too many"
                }
            )
        });
    }
    Err(nearest.unwrap_or_else(|| {
        let what = "a text file that does not start with block sizes of a Plot3D grid";
        // Sizes that no file holds: say so instead of leaving a user to guess.
        let product: f64 = numbers.get(1..4).unwrap_or_default().iter().product();
        if product > 1e15 && product.is_finite() {
            return format!(
                "{what}: the first would have {product:.1e} nodes, and {} numbers follow",
                numbers.len().saturating_sub(4)
            );
        }
        what.to_owned()
    }))
}

/// Builds blocks; `part(block, n)` gives the n-th array of a block (coordinates, then iblank).
pub(super) fn build(sizes: &[Size], layout: Layout, part: &mut dyn FnMut(usize, usize) -> Vec<f64>) -> Grid {
    let mut blocks = Vec::with_capacity(sizes.len());
    let mut iblank = Vec::with_capacity(sizes.len());
    let mut surface = None;
    for (n, &size) in sizes.iter().enumerate() {
        let d = if layout.three_d { 3 } else { 2 };
        let arrays: Vec<Vec<f64>> = (0..d).map(|m| part(n, m)).collect();
        if surface.is_none() && is_surface(size, &arrays) {
            surface = Some(n);
        }
        blocks.push(block(n, size, arrays));
        iblank.push(
            layout
                .iblank
                .then(|| part(n, d).into_iter().map(|v| v as i32).collect()),
        );
    }
    Grid {
        blocks,
        iblank,
        layout,
        surface,
    }
}

/// True for a block one node thick with three coordinates of which neither the second nor the third is constant (to 1e-5 of the
/// extent of the first, for files of few digits).
fn is_surface(size: Size, arrays: &[Vec<f64>]) -> bool {
    let extent = |v: &[f64]| {
        let [lo, hi] = v.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], &a| {
            [lo.min(a), hi.max(a)]
        });
        hi - lo
    };
    match arrays {
        [x, y, z] if size[2] == 1 => extent(y).min(extent(z)) > 1e-5 * extent(x),
        _ => false,
    }
}

/// A block from its coordinate arrays. A block one node thick becomes one cell thick: 2-D x, y are our x, z, and k runs
/// to port so that the block keeps its hand.
fn block(n: usize, size: Size, mut arrays: Vec<Vec<f64>>) -> Block {
    let name = (n + 1).to_string();
    if size[2] == 1 {
        let (x, z) = (arrays.swap_remove(0), arrays.swap_remove(arrays.len() - 1));
        // With three coordinates the plane may be x-y or x-z: the one that is not constant is up.
        let extent = |v: &[f64]| {
            let spread = |m: f64, a: &f64| m.max((a - v[0]).abs());
            v.iter().fold(0.0, spread)
        };
        let up = if arrays.first().is_some_and(|y| extent(y) > extent(&z)) {
            arrays.swap_remove(0)
        } else {
            z
        };
        return Block::across(&name, [size[0] - 1, size[1] - 1], &x, &up);
    }
    let (z, y, x) = (arrays.pop(), arrays.pop(), arrays.pop());
    Block {
        name,
        ni: size[0].max(2) - 1,
        nj: size[1].max(2) - 1,
        nk: size[2] - 1,
        x: x.unwrap_or_default(),
        y: y.unwrap_or_default(),
        z: z.unwrap_or_default(),
    }
}

/// Bytes of a block for a layout; `None` if they cannot be counted.
pub(super) fn block_bytes(size: Size, three_d: bool, double: bool, iblank: bool) -> Option<usize> {
    let per_node = if three_d { 3 } else { 2 } * if double { 8 } else { 4 } + if iblank { 4 } else { 0 };
    nodes(size).checked_mul(per_node)
}

/// Precision and iblank: double or single without, then with.
pub(super) const VARIANTS: [(bool, bool); 4] = [(true, false), (false, false), (true, true), (false, true)];

/// The n-th array of a block's bytes.
pub(super) fn array(bytes: &[u8], count: usize, part: usize, order: Order, layout: Layout) -> Vec<f64> {
    let d = if layout.three_d { 3 } else { 2 };
    let size = if layout.double { 8 } else { 4 };
    if part < d {
        order.reals(&bytes[part * count * size..(part + 1) * count * size], layout.double)
    } else {
        order
            .integers(&bytes[d * count * size..d * count * size + 4 * count])
            .into_iter()
            .map(f64::from)
            .collect()
    }
}

/// Sizes at the head of a stream, and where they end.
pub(super) fn stream_header(bytes: &[u8], order: Order, multi: bool, three_d: bool) -> Option<(Vec<Size>, usize)> {
    let d = if three_d { 3 } else { 2 };
    let count = if multi {
        usize::try_from(order.i32(bytes, 0)?).ok()?
    } else {
        1
    };
    if count == 0 || count > MOST_BLOCKS {
        return None;
    }
    let start = if multi { 4 } else { 0 };
    let end = start + 4 * d * count;
    let head: Vec<i64> = order
        .integers(bytes.get(start..end)?)
        .into_iter()
        .map(i64::from)
        .collect();
    Some((sizes(&head, three_d)?, end))
}

fn stream(bytes: &[u8], order: Order, fits: &mut Vec<Grid>) {
    for (multi, three_d) in [(true, true), (true, false), (false, true), (false, false)] {
        let Some((sizes, start)) = stream_header(bytes, order, multi, three_d) else {
            continue;
        };
        if thick_along_k(&sizes).is_err() {
            continue;
        }
        for (double, iblank) in VARIANTS {
            let mut ends = Vec::with_capacity(sizes.len() + 1);
            ends.push(start);
            let total = sizes.iter().try_fold(start, |at, &s| {
                let end = at.checked_add(block_bytes(s, three_d, double, iblank)?)?;
                ends.push(end);
                Some(end)
            });
            if total == Some(bytes.len()) {
                let encoding = Encoding::Stream {
                    big_endian: order.big_endian,
                };
                let layout = Layout {
                    encoding,
                    double,
                    multi,
                    three_d,
                    iblank,
                };
                fits.push(build(&sizes, layout, &mut |b, part| {
                    array(&bytes[ends[b]..ends[b + 1]], nodes(sizes[b]), part, order, layout)
                }));
            }
        }
    }
}
