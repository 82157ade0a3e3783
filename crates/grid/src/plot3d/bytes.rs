//! Numbers in bytes: byte orders, Fortran records, text.

/// Reads numbers of one byte order.
#[derive(Clone, Copy)]
pub(super) struct Order {
    pub(super) big_endian: bool,
}

impl Order {
    pub(super) fn i32(self, bytes: &[u8], at: usize) -> Option<i32> {
        let raw: [u8; 4] = bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(if self.big_endian {
            i32::from_be_bytes(raw)
        } else {
            i32::from_le_bytes(raw)
        })
    }

    pub(super) fn i64(self, bytes: &[u8], at: usize) -> Option<i64> {
        let raw: [u8; 8] = bytes.get(at..at.checked_add(8)?)?.try_into().ok()?;
        Some(if self.big_endian {
            i64::from_be_bytes(raw)
        } else {
            i64::from_le_bytes(raw)
        })
    }

    pub(super) fn reals(self, bytes: &[u8], double: bool) -> Vec<f64> {
        if double {
            let one = |raw: [u8; 8]| {
                if self.big_endian {
                    f64::from_be_bytes(raw)
                } else {
                    f64::from_le_bytes(raw)
                }
            };
            bytes.as_chunks::<8>().0.iter().map(|&raw| one(raw)).collect()
        } else {
            let one = |raw: [u8; 4]| {
                if self.big_endian {
                    f32::from_be_bytes(raw)
                } else {
                    f32::from_le_bytes(raw)
                }
            };
            bytes
                .as_chunks::<4>()
                .0
                .iter()
                .map(|&raw| f64::from(one(raw)))
                .collect()
        }
    }

    pub(super) fn integers(self, bytes: &[u8]) -> Vec<i32> {
        let one = |raw: [u8; 4]| {
            if self.big_endian {
                i32::from_be_bytes(raw)
            } else {
                i32::from_le_bytes(raw)
            }
        };
        bytes.as_chunks::<4>().0.iter().map(|&raw| one(raw)).collect()
    }

    pub(super) fn long_integers(self, bytes: &[u8]) -> Vec<i64> {
        let one = |raw: [u8; 8]| {
            if self.big_endian {
                i64::from_be_bytes(raw)
            } else {
                i64::from_le_bytes(raw)
            }
        };
        bytes.as_chunks::<8>().0.iter().map(|&raw| one(raw)).collect()
    }
}

/// The records of a Fortran unformatted file: their contents. `None` if the markers do not chain to the end. A negative
/// 4-byte marker ahead says that the record goes on in the next piece (gfortran, records over 2 GiB).
pub(super) fn records(bytes: &[u8], order: Order, marker: usize) -> Option<Vec<Vec<&[u8]>>> {
    let read = |at: usize| {
        if marker == 8 {
            order.i64(bytes, at)
        } else {
            order.i32(bytes, at).map(i64::from)
        }
    };
    let mut out: Vec<Vec<&[u8]>> = Vec::new();
    let mut at = 0usize;
    let mut open = false;
    while at < bytes.len() {
        let length = read(at)?;
        let size = usize::try_from(length.unsigned_abs()).ok()?;
        let start = at.checked_add(marker)?;
        let end = start.checked_add(size)?;
        let content = bytes.get(start..end)?;
        if read(end)?.unsigned_abs() != length.unsigned_abs() {
            return None;
        }
        match (open, out.last_mut()) {
            (true, Some(pieces)) => pieces.push(content),
            _ => out.push(vec![content]),
        }
        open = length < 0;
        at = end + marker;
    }
    (!open && !out.is_empty()).then_some(out)
}

/// Fortran leaves the letter of an exponent of three digits out: `1.5-103`.
fn without_letter(word: &str) -> Option<f64> {
    let at = word.rfind(['+', '-']).filter(|&at| at > 0)?;
    let (mantissa, exponent) = word.split_at(at);
    if !mantissa.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    format!("{mantissa}E{exponent}").parse().ok()
}

/// Numbers of a text file: blanks, commas and line ends between; Fortran's `3*1.5` and `1.0D-3` understood.
/// `None` if a word is no number, or if there are absurdly many.
pub(super) fn text(bytes: &[u8]) -> Option<Vec<f64>> {
    let text = std::str::from_utf8(bytes).ok()?;
    let mut out: Vec<f64> = Vec::new();
    for word in words(text) {
        let (times, value) = number(word)?;
        // A repeat count may stand for more numbers than the file has bytes; a grid has no use for that many.
        if times > bytes.len().saturating_mul(64) {
            return None;
        }
        out.extend(std::iter::repeat_n(value, times));
    }
    Some(out)
}

/// Of a file that is text, the line (from 1) and the word which is no number.
pub(super) fn odd_word(bytes: &[u8]) -> Option<(usize, &str)> {
    let text = std::str::from_utf8(bytes).ok()?;
    // Bytes below 128 may be anything; text has no control characters but those between lines and columns.
    if text.chars().any(|c| c.is_control() && !c.is_whitespace()) {
        return None;
    }
    text.lines().enumerate().find_map(|(n, line)| {
        words(line)
            .find(|word| number(word).is_none())
            .map(|word| (n + 1, word))
    })
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',')
        .filter(|w| !w.is_empty())
}

/// A word of a text file: how often, and what.
fn number(word: &str) -> Option<(usize, f64)> {
    let (times, value) = match word.split_once('*') {
        Some((n, value)) => (n.parse::<usize>().ok()?, value),
        None => (1, word),
    };
    let value = value
        .parse::<f64>()
        .ok()
        .or_else(|| value.replace(['D', 'd'], "E").parse().ok())
        .or_else(|| without_letter(value))?;
    Some((times, value))
}

/// Kinds of files that are known by their first bytes, and what to do with them.
const KNOWN: [(&[u8], &str); 7] = [
    (b"\x1f\x8b", "compressed with gzip: unpack it first (`gunzip FILE`)"),
    (b"BZh", "compressed with bzip2: unpack it first (`bunzip2 FILE`)"),
    (b"\xfd7zXZ", "compressed with xz: unpack it first (`unxz FILE`)"),
    (b"PK\x03\x04", "a zip archive: unpack it first"),
    (b"\x89HDF", "HDF5: a CGNS file is to end in .cgns"),
    (
        b"@(#)ADF",
        "CGNS of the old ADF kind: `adf2hdf` makes HDF5 of it, to end in .cgns",
    ),
    (b"#!TDV", "Tecplot's own kind of file: write Plot3D or CGNS instead"),
];

/// What a file is that is no Plot3D file.
pub(super) fn known(bytes: &[u8]) -> Option<&'static str> {
    KNOWN
        .iter()
        .find(|(start, _)| bytes.starts_with(start))
        .map(|(_, what)| *what)
}
