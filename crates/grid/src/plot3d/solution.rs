//! Plot3D solutions (Q files): density, momentum, energy at every node.

use std::path::Path;

use super::bytes::{Order, records, text};
use super::detect::{Size, headers, no_grid, nodes, sizes, stream_header};
use super::overflow;
use super::records::record_header;
use super::write::{Writer, header};
use super::{Encoding, Layout, Plot3dError};

/// One block of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionBlock {
    /// Nodes along i, j, k (k = 1 in 2-D).
    pub nodes: [usize; 3],
    /// Free stream Mach number, angle of attack (deg), Reynolds number, time.
    pub reference: [f64; 4],
    /// Density, momentum (2 or 3 components), total energy, non-dimensional as the writer chose: `[variable][k][j][i]`. Files of
    /// OVERFLOW have more behind these: the ratio of specific heats, species, turbulence.
    pub q: Vec<Vec<f64>>,
}

/// A solution file's contents. `layout.iblank` has no meaning here.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Blocks.
    pub blocks: Vec<SolutionBlock>,
    /// How the file was written.
    pub layout: Layout,
}

/// Reads a solution of any layout.
/// # Errors
/// Says what does not fit.
pub fn read_solution(path: &Path) -> Result<Solution, Plot3dError> {
    let bytes = std::fs::read(path).map_err(|source| Plot3dError::Io {
        path: path.to_owned(),
        source,
    })?;
    parse_solution(&path.to_string_lossy(), &bytes)
}

/// Reads a solution from the bytes of a file; `file` names it in messages.
/// # Errors
/// As [`read_solution`].
pub fn parse_solution(file: &str, bytes: &[u8]) -> Result<Solution, Plot3dError> {
    solution(bytes).map_err(|what| Plot3dError::Content {
        file: file.to_owned(),
        what,
    })
}

fn values(size: Size, three_d: bool) -> Option<usize> {
    nodes(size).checked_mul(if three_d { 5 } else { 4 })
}

fn solution(bytes: &[u8]) -> Result<Solution, String> {
    if let Some(numbers) = text(bytes) {
        for (multi, three_d, sizes, start) in headers(&numbers) {
            let total = sizes
                .iter()
                .try_fold(start, |at, &s| at.checked_add(4)?.checked_add(values(s, three_d)?));
            if total == Some(numbers.len()) {
                let layout = Layout {
                    encoding: Encoding::Ascii,
                    double: true,
                    multi,
                    three_d,
                    iblank: false,
                };
                return Ok(build(&sizes, layout, numbers[start..].to_vec()));
            }
        }
        return Err("a text file whose count of numbers is not that of a Plot3D solution (4 reference values and 5, in 2-D 4, values a node, for every block)".into());
    }
    for big_endian in [false, true] {
        let order = Order { big_endian };
        for marker in [4, 8] {
            let Some(all) = records(bytes, order, marker) else {
                continue;
            };
            let found = from_records(&all, order, marker).or_else(|| overflow::solution(&all, order, marker));
            if let Some(found) = found {
                return Ok(found);
            }
        }
    }
    let mut fits = Vec::new();
    for big_endian in [false, true] {
        let order = Order { big_endian };
        for (multi, three_d) in [(true, true), (true, false), (false, true), (false, false)] {
            let Some((sizes, start)) = stream_header(bytes, order, multi, three_d) else {
                continue;
            };
            for double in [true, false] {
                let width = if double { 8 } else { 4 };
                let total = sizes
                    .iter()
                    .try_fold(0usize, |n, &s| n.checked_add(4)?.checked_add(values(s, three_d)?));
                if total.and_then(|n| n.checked_mul(width)) == Some(bytes.len() - start) {
                    let encoding = Encoding::Stream { big_endian };
                    let layout = Layout {
                        encoding,
                        double,
                        multi,
                        three_d,
                        iblank: false,
                    };
                    fits.push(build(&sizes, layout, order.reals(&bytes[start..], double)));
                }
            }
        }
    }
    let sane = |s: &Solution| {
        s.blocks
            .iter()
            .flat_map(|b| b.q.iter().flatten())
            .all(|v| v.is_finite() && v.abs() < 1e30)
    };
    if let Some(found) = fits.into_iter().find(sane) {
        return Ok(found);
    }
    no_grid(bytes)?;
    Err(format!(
        "no layout of a Plot3D solution fits its {} bytes; it may be truncated or of another format",
        bytes.len()
    ))
}

fn from_records(all: &[Vec<&[u8]>], order: Order, marker: usize) -> Option<Solution> {
    let (head, multi, used) = record_header(all, order).ok()?;
    let length = |n: usize| all[n].iter().map(|p| p.len()).sum::<usize>();
    for three_d in [true, false] {
        let Some(sizes) = sizes(&head, three_d) else { continue };
        if multi.is_some_and(|n| n != sizes.len()) || all.len() - used != 2 * sizes.len() {
            continue;
        }
        for double in [true, false] {
            let width = if double { 8 } else { 4 };
            let fits = sizes.iter().enumerate().all(|(n, &s)| {
                length(used + 2 * n) == 4 * width
                    && values(s, three_d).and_then(|v| v.checked_mul(width)) == Some(length(used + 2 * n + 1))
            });
            if fits {
                let encoding = Encoding::Records {
                    big_endian: order.big_endian,
                    marker,
                };
                let layout = Layout {
                    encoding,
                    double,
                    multi: multi.is_some(),
                    three_d,
                    iblank: false,
                };
                let numbers = all[used..]
                    .iter()
                    .flat_map(|pieces| order.reals(&pieces.concat(), double))
                    .collect();
                return Some(build(&sizes, layout, numbers));
            }
        }
    }
    None
}

fn build(sizes: &[Size], layout: Layout, numbers: Vec<f64>) -> Solution {
    let mut at = 0;
    let blocks = sizes
        .iter()
        .map(|&size| {
            let n = nodes(size);
            let reference = [0, 1, 2, 3].map(|m| numbers[at + m]);
            at += 4;
            let variables = if layout.three_d { 5 } else { 4 };
            let q = (0..variables)
                .map(|v| numbers[at + v * n..at + (v + 1) * n].to_vec())
                .collect();
            at += variables * n;
            SolutionBlock {
                nodes: size,
                reference,
                q,
            }
        })
        .collect();
    Solution { blocks, layout }
}

/// Writes a solution in its layout: the arrays that Plot3D has a place for, without those that OVERFLOW adds.
/// # Errors
/// If the file cannot be written or the arrays do not have the sizes the blocks say.
pub fn write_solution(path: &Path, solution: &Solution) -> Result<(), Plot3dError> {
    let content = |what| Plot3dError::Content {
        file: path.to_string_lossy().into_owned(),
        what,
    };
    let layout = solution.layout;
    let variables = if layout.three_d { 5 } else { 4 };
    let mut out = Writer::new(layout);
    let sizes: Vec<Vec<usize>> = solution
        .blocks
        .iter()
        .map(|b| b.nodes[..if layout.three_d { 3 } else { 2 }].to_vec())
        .collect();
    header(&mut out, &sizes, layout.multi).map_err(content)?;
    for (n, block) in solution.blocks.iter().enumerate() {
        let count: usize = block.nodes.iter().product();
        if block.q.len() < variables || block.q.iter().any(|v| v.len() != count) {
            return Err(content(format!(
                "block {}: {variables} arrays of {count} values are needed",
                n + 1
            )));
        }
        out.begin();
        out.reals(&block.reference);
        out.end();
        out.begin();
        for v in &block.q[..variables] {
            out.reals(v);
        }
        out.end();
    }
    std::fs::write(path, out.bytes).map_err(|source| Plot3dError::Io {
        path: path.to_owned(),
        source,
    })
}
