//! Writes Plot3D grids.

use std::io::Write;
use std::path::Path;

use super::{Encoding, Layout, Plot3dError};
use crate::block::Block;

/// Writes blocks to a file. With `layout.three_d` off, the k = 0 plane of every block as x and z.
/// `iblank` (node by node, one list a block) is written if the layout asks; 1 where it is missing.
/// # Errors
/// If the file cannot be written, or several blocks are to go into a file for one.
pub fn write(path: &Path, blocks: &[Block], iblank: &[Option<Vec<i32>>], layout: Layout) -> Result<(), Plot3dError> {
    let io = |source| Plot3dError::Io {
        path: path.to_owned(),
        source,
    };
    let bytes = encode(blocks, iblank, layout).map_err(|what| Plot3dError::Content {
        file: path.to_string_lossy().into_owned(),
        what,
    })?;
    std::fs::File::create(path)
        .and_then(|mut f| f.write_all(&bytes))
        .map_err(io)
}

/// The bytes of a grid file.
/// # Errors
/// Several blocks for a layout without a block count, or a block too large for its header.
pub fn encode(blocks: &[Block], iblank: &[Option<Vec<i32>>], layout: Layout) -> Result<Vec<u8>, String> {
    let mut out = Writer::new(layout);
    let sizes: Vec<Vec<usize>> = blocks
        .iter()
        .map(|b| {
            if layout.three_d {
                b.nodes().to_vec()
            } else {
                b.nodes()[..2].to_vec()
            }
        })
        .collect();
    header(&mut out, &sizes, layout.multi)?;
    for (n, block) in blocks.iter().enumerate() {
        let plane = block.nodes()[0] * block.nodes()[1];
        let arrays: Vec<&[f64]> = if layout.three_d {
            vec![&block.x, &block.y, &block.z]
        } else {
            vec![&block.x[..plane], &block.z[..plane]]
        };
        out.begin();
        for values in &arrays {
            out.reals(values);
        }
        if layout.iblank {
            let given = iblank.get(n).and_then(Option::as_ref);
            let count = arrays[0].len();
            out.integers(
                &(0..count)
                    .map(|m| given.and_then(|v| v.get(m).copied()).unwrap_or(1))
                    .collect::<Vec<i32>>(),
            );
        }
        out.end();
    }
    Ok(out.bytes)
}

/// Number of blocks and sizes, as every Plot3D file starts.
pub(super) fn header(out: &mut Writer, sizes: &[Vec<usize>], multi: bool) -> Result<(), String> {
    if !multi && sizes.len() != 1 {
        return Err(format!(
            "a file without a block count holds one block, not {}",
            sizes.len()
        ));
    }
    let small = |n: usize| i32::try_from(n).map_err(|_| format!("{n} is too large for a Plot3D header"));
    if multi {
        out.begin();
        out.integers(&[small(sizes.len())?]);
        out.end();
    }
    out.begin();
    for size in sizes {
        out.integers(&size.iter().map(|&n| small(n)).collect::<Result<Vec<i32>, String>>()?);
    }
    out.end();
    Ok(())
}

/// Numbers into bytes.
pub(super) struct Writer {
    layout: Layout,
    pub(super) bytes: Vec<u8>,
    start: usize,
}

impl Writer {
    pub(super) fn new(layout: Layout) -> Self {
        Self {
            layout,
            bytes: Vec::new(),
            start: 0,
        }
    }

    fn big(&self) -> bool {
        matches!(
            self.layout.encoding,
            Encoding::Records { big_endian: true, .. } | Encoding::Stream { big_endian: true }
        )
    }

    /// Opens a record.
    pub(super) fn begin(&mut self) {
        self.start = self.bytes.len();
        if let Encoding::Records { marker, .. } = self.layout.encoding {
            self.bytes.extend(std::iter::repeat_n(0, marker));
        }
    }

    /// Closes a record: its length goes before and behind it.
    pub(super) fn end(&mut self) {
        let Encoding::Records { marker, .. } = self.layout.encoding else {
            return;
        };
        let length = self.bytes.len() - self.start - marker;
        let raw: Vec<u8> = match (marker, self.big()) {
            (8, true) => (length as u64).to_be_bytes().to_vec(),
            (8, false) => (length as u64).to_le_bytes().to_vec(),
            (_, true) => (length as u32).to_be_bytes().to_vec(),
            (_, false) => (length as u32).to_le_bytes().to_vec(),
        };
        self.bytes[self.start..self.start + marker].copy_from_slice(&raw);
        self.bytes.extend(raw);
    }

    pub(super) fn integers(&mut self, values: &[i32]) {
        if self.layout.encoding == Encoding::Ascii {
            self.lines(values.iter().map(ToString::to_string), 12);
            return;
        }
        let big = self.big();
        for v in values {
            self.bytes.extend(if big { v.to_be_bytes() } else { v.to_le_bytes() });
        }
    }

    pub(super) fn reals(&mut self, values: &[f64]) {
        if self.layout.encoding == Encoding::Ascii {
            // The shortest digits that read back as the same number.
            self.lines(values.iter().map(|v| format!("{v:e}")), 4);
            return;
        }
        let big = self.big();
        for v in values {
            match (self.layout.double, big) {
                (true, true) => self.bytes.extend(v.to_be_bytes()),
                (true, false) => self.bytes.extend(v.to_le_bytes()),
                (false, true) => self.bytes.extend((*v as f32).to_be_bytes()),
                (false, false) => self.bytes.extend((*v as f32).to_le_bytes()),
            }
        }
    }

    fn lines(&mut self, words: impl Iterator<Item = String>, columns: usize) {
        for (n, word) in words.enumerate() {
            if n > 0 {
                self.bytes.push(if n % columns == 0 { b'\n' } else { b' ' });
            }
            self.bytes.extend(word.bytes());
        }
        self.bytes.push(b'\n');
    }
}
