//! Grids in Fortran records.

use super::bytes::Order;
use super::detect::{MOST_BLOCKS, Size, VARIANTS, array, block_bytes, build, nodes, sizes, thick_along_k};
use super::{Encoding, Grid, Layout};

/// Reads the records of a Fortran unformatted file: whole blocks, planes, or CFL3D's own order.
pub(super) fn unformatted(all: &[Vec<&[u8]>], order: Order, marker: usize) -> Result<Grid, String> {
    let (head, multi, used) = record_header(all, order)?;
    let encoding = Encoding::Records {
        big_endian: order.big_endian,
        marker,
    };
    if let Some(grid) = size_before_each(all, order, encoding) {
        return Ok(grid);
    }
    let mut what = String::from("its first records are not the sizes of Plot3D blocks");
    for three_d in [true, false] {
        let Some(sizes) = sizes(&head, three_d) else { continue };
        if multi.is_some_and(|n| n != sizes.len()) {
            continue;
        }
        let layout = Layout {
            encoding,
            double: true,
            multi: multi.is_some(),
            three_d,
            iblank: false,
        };
        let rest = &all[used..];
        if rest.len() == sizes.len() {
            if let Some(fits) = whole(rest, &sizes, order, layout) {
                thick_along_k(&sizes)?;
                return Ok(fits);
            }
            what = misfit(rest, &sizes, three_d);
            continue;
        }
        if let Some(grid) = planes(rest, &sizes, order, encoding, multi.is_some(), three_d) {
            return Ok(grid);
        }
        if let Some(grid) = array_by_array(rest, &sizes, order, layout) {
            return Ok(grid);
        }
        what = format!(
            "the header says {} blocks, the file has {} records of coordinates",
            sizes.len(),
            rest.len()
        );
    }
    Err(what)
}

/// A record for every block, with all its arrays. Precision and iblank of `layout` are found.
fn whole(all: &[Vec<&[u8]>], sizes: &[Size], order: Order, layout: Layout) -> Option<Grid> {
    VARIANTS.into_iter().find_map(|(double, iblank)| {
        let fits = |(record, &s): (&Vec<&[u8]>, &Size)| {
            block_bytes(s, layout.three_d, double, iblank) == Some(bytes_of(record))
        };
        if !all.iter().zip(sizes).all(fits) {
            return None;
        }
        let layout = Layout {
            double,
            iblank,
            ..layout
        };
        let joined: Vec<Vec<u8>> = all.iter().map(|pieces| pieces.concat()).collect();
        Some(build(sizes, layout, &mut |b, part| {
            array(&joined[b], nodes(sizes[b]), part, order, layout)
        }))
    })
}

/// A record for every array of every block, as programs write that know records of one array only (Python's among them).
fn array_by_array(all: &[Vec<&[u8]>], sizes: &[Size], order: Order, layout: Layout) -> Option<Grid> {
    thick_along_k(sizes).ok()?;
    let parts = all.len() / sizes.len().max(1);
    let arrays = if layout.three_d { 3..=4 } else { 2..=3 };
    if !arrays.contains(&parts) || all.len() != parts * sizes.len() {
        return None;
    }
    let equal = |records: &[Vec<&[u8]>]| {
        let coordinates = &records[..*arrays.start()];
        coordinates.iter().all(|r| bytes_of(r) == bytes_of(&records[0]))
    };
    if !all.chunks(parts).all(equal) {
        return None;
    }
    let joined: Vec<Vec<&[u8]>> = all.chunks(parts).map(<[Vec<&[u8]>]>::concat).collect();
    whole(&joined, sizes, order, layout).filter(|grid| usize::from(grid.layout.iblank) == parts - arrays.start())
}

fn bytes_of(record: &[&[u8]]) -> usize {
    record.iter().map(|p| p.len()).sum()
}

/// Which block's record has another length than its size says.
fn misfit(all: &[Vec<&[u8]>], sizes: &[Size], three_d: bool) -> String {
    let fits = |n: usize| {
        let found = Some(bytes_of(&all[n]));
        VARIANTS
            .iter()
            .any(|&(d, i)| block_bytes(sizes[n], three_d, d, i) == found)
    };
    let n = (0..sizes.len()).find(|&n| !fits(n)).unwrap_or(0);
    let [ni, nj, nk] = sizes[n];
    format!(
        "block {} should have {ni} x {nj} x {nk} nodes, but its record of {} bytes holds another number",
        n + 1,
        bytes_of(&all[n])
    )
}

/// Plot3D's `PLANES`: a record for each plane k, with x, y, z (and iblank) of that plane.
fn planes(
    all: &[Vec<&[u8]>],
    sizes: &[Size],
    order: Order,
    encoding: Encoding,
    multi: bool,
    three_d: bool,
) -> Option<Grid> {
    let count = sizes.iter().try_fold(0usize, |sum, s| sum.checked_add(s[2]))?;
    if !three_d || all.len() != count {
        return None;
    }
    let starts: Vec<usize> = sizes
        .iter()
        .scan(0, |at, s| {
            let start = *at;
            *at += s[2];
            Some(start)
        })
        .collect();
    VARIANTS.into_iter().find_map(|(double, iblank)| {
        let fits = |(b, s): (usize, &Size)| {
            let wanted = block_bytes([s[0], s[1], 1], three_d, double, iblank);
            (0..s[2]).all(|k| Some(bytes_of(&all[starts[b] + k])) == wanted)
        };
        if !sizes.iter().enumerate().all(fits) || thick_along_k(sizes).is_err() {
            return None;
        }
        let layout = Layout {
            encoding,
            double,
            multi,
            three_d,
            iblank,
        };
        Some(build(sizes, layout, &mut |b, part| {
            let [ni, nj, nk] = sizes[b];
            (0..nk)
                .flat_map(|k| array(&all[starts[b] + k].concat(), ni * nj, part, order, layout))
                .collect()
        }))
    })
}

/// CFL3D's own kind of file: the size of a block stands before its coordinates, block by block. Its first index is CFL3D's
/// j, then k, then i (CFL3D User's Manual, NASA TM-1998-208444, chapter 4): ours are i, j, k in that order, which keeps the
/// hand. One block alone is the same file as Plot3D's.
fn size_before_each(all: &[Vec<&[u8]>], order: Order, encoding: Encoding) -> Option<Grid> {
    if all.len() < 4 || !all.len().is_multiple_of(2) {
        return None;
    }
    let (heads, blocks): (Vec<_>, Vec<_>) = all.chunks(2).map(|pair| (pair[0].concat(), pair[1].concat())).unzip();
    let integers: Vec<i64> = heads
        .iter()
        .map(|h| (h.len() == 12).then(|| order.integers(h)))
        .collect::<Option<Vec<_>>>()?
        .concat()
        .into_iter()
        .map(i64::from)
        .collect();
    let sizes = sizes(&integers, true)?;
    thick_along_k(&sizes).ok()?;
    let double = [true, false].into_iter().find(|&double| {
        let fits = |(s, b): (&Size, &Vec<u8>)| block_bytes(*s, true, double, false) == Some(b.len());
        sizes.iter().zip(&blocks).all(fits)
    })?;
    let layout = Layout {
        encoding,
        double,
        multi: true,
        three_d: true,
        iblank: false,
    };
    Some(build(&sizes, layout, &mut |b, part| {
        array(&blocks[b], nodes(sizes[b]), part, order, layout)
    }))
}

/// Sizes as integers, the number of blocks if the file says it, and how many records that took. Integers have four bytes, or
/// eight (programs compiled with `-i8`) where that makes sense.
pub(super) fn record_header(all: &[Vec<&[u8]>], order: Order) -> Result<(Vec<i64>, Option<usize>, usize), String> {
    let first = all.first().map(|r| r.concat()).unwrap_or_default();
    // Two sizes of four bytes are a number far beyond any size.
    let small = |v: &i64| (1..=i64::from(i32::MAX)).contains(v);
    let long = !first.is_empty() && first.len().is_multiple_of(8) && order.long_integers(&first).iter().all(small);
    let width = if long { 8 } else { 4 };
    let integers = |n: usize| -> Option<Vec<i64>> {
        let record = all.get(n)?.concat();
        let believed = record.len() <= 3 * width * MOST_BLOCKS && record.len().is_multiple_of(width);
        believed.then(|| {
            if long {
                order.long_integers(&record)
            } else {
                order.integers(&record).into_iter().map(i64::from).collect()
            }
        })
    };
    let first = integers(0).ok_or("its first record is not a header of integers")?;
    if let [count] = first[..] {
        let count = usize::try_from(count).ok().filter(|n| (1..=MOST_BLOCKS).contains(n));
        let count = count.ok_or_else(|| format!("its first record says {} blocks", first[0]))?;
        let sizes = integers(1).ok_or("its second record is not the sizes of blocks")?;
        return Ok((sizes, Some(count), 2));
    }
    Ok((first, None, 1))
}
