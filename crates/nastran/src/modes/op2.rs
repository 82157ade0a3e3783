//! OUTPUT2 binaries: eigenvector tables (OUGV1, BOUGV1, OPHIG), LAMA and the GRIDs of GEOM1.
//!
//! The file is a chain of Fortran records, each between two 4-byte lengths. Records of one word are markers: positive, the
//! number of words that follow; negative, the end of a logical record, with two flags behind; zero, the end of a table.
//! Words have 4 or 8 bytes, in either byte order; the first record tells.

use super::{Collector, Eigenvalue, ModeFileError, ModeTable};

/// A grid point of GEOM1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Op2Grid {
    /// Its number.
    pub id: u32,
    /// Coordinate system of its position.
    pub cp: u32,
    /// Position in that system.
    pub position: [f64; 3],
    /// Coordinate system of its displacements.
    pub cd: u32,
}

/// What an op2 file holds of modes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Op2Modes {
    /// Frequencies and shapes.
    pub table: ModeTable,
    /// Grid points, if the file has GEOM1.
    pub grids: Vec<Op2Grid>,
}

/// Words of one logical record.
struct Record<'a> {
    pieces: Vec<&'a [u8]>,
    format: Format,
}

#[derive(Clone, Copy)]
struct Format {
    little: bool,
    word: usize,
}

impl Format {
    fn length(self, bytes: [u8; 4]) -> usize {
        (if self.little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
        }) as usize
    }

    fn bits(self, bytes: &[u8]) -> u64 {
        let mut all = [0; 8];
        if self.little {
            all[..bytes.len()].copy_from_slice(bytes);
            u64::from_le_bytes(all)
        } else {
            all[8 - bytes.len()..].copy_from_slice(bytes);
            u64::from_be_bytes(all)
        }
    }

    fn integer(self, bytes: &[u8]) -> i64 {
        if self.word == 4 {
            i64::from(self.bits(bytes) as u32 as i32)
        } else {
            self.bits(bytes) as i64
        }
    }

    fn real(self, bytes: &[u8]) -> f64 {
        if self.word == 4 {
            f64::from(f32::from_bits(self.bits(bytes) as u32))
        } else {
            f64::from_bits(self.bits(bytes))
        }
    }
}

impl<'a> Record<'a> {
    fn words(&self) -> Vec<&'a [u8]> {
        self.pieces
            .iter()
            .flat_map(|piece| piece.chunks_exact(self.format.word))
            .collect()
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    format: Format,
}

type Result<T> = std::result::Result<T, ModeFileError>;

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Result<Self> {
        let first: [u8; 4] = bytes
            .get(..4)
            .and_then(|b| b.try_into().ok())
            .ok_or_else(|| error(0, "the file ends before its first record"))?;
        for little in [true, false] {
            let word = if little {
                u32::from_le_bytes(first)
            } else {
                u32::from_be_bytes(first)
            } as usize;
            if word == 4 || word == 8 {
                return Ok(Self {
                    bytes,
                    at: 0,
                    format: Format { little, word },
                });
            }
        }
        Err(error(
            0,
            "this is no op2 file: it does not begin with a record of one word",
        ))
    }

    /// The next Fortran record.
    fn block(&mut self) -> Result<&'a [u8]> {
        let start = self.at;
        let length_at = |at: usize| -> Option<usize> {
            let bytes: [u8; 4] = self.bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
            Some(self.format.length(bytes))
        };
        let cut = || error(start, "the file ends inside a record; it was cut off");
        let length = length_at(start).ok_or_else(cut)?;
        let end = start
            .checked_add(4)
            .and_then(|s| s.checked_add(length))
            .ok_or_else(cut)?;
        let data = self.bytes.get(start + 4..end).ok_or_else(cut)?;
        let closing = length_at(end).ok_or_else(cut)?;
        if closing != length {
            return Err(error(
                end,
                &format!("a record of {length} bytes is closed as one of {closing}"),
            ));
        }
        self.at = end + 4;
        Ok(data)
    }

    fn marker(&mut self) -> Result<i64> {
        let at = self.at;
        let data = self.block()?;
        if data.len() == self.format.word {
            Ok(self.format.integer(data))
        } else {
            Err(error(
                at,
                &format!("needed a marker of one word, got a record of {} bytes", data.len()),
            ))
        }
    }

    fn is_done(&self) -> bool {
        self.at >= self.bytes.len()
    }

    /// The label in front of the tables (PARAM POST -1), if there is one.
    fn pass_label(&mut self) -> Result<()> {
        let start = self.at;
        if self.marker()? != 3 {
            self.at = start;
            return Ok(());
        }
        self.block()?;
        // Label words, then -1 and 0.
        for _ in 0..8 {
            match self.marker()? {
                m if m > 0 => {
                    self.block()?;
                }
                0 => return Ok(()),
                _ => {}
            }
        }
        Err(error(self.at, "the label in front of the tables does not end"))
    }

    /// The next table: its name and logical records; none at the end of the file.
    fn table(&mut self) -> Result<Option<(String, Vec<Record<'a>>)>> {
        if self.is_done() {
            return Ok(None);
        }
        if self.marker()? <= 0 {
            return Ok(None);
        }
        let format = self.format;
        let name: String = self
            .block()?
            .chunks_exact(format.word)
            .flat_map(|word| word.iter().take(4))
            .map(|b| char::from(*b))
            .collect::<String>()
            .trim()
            .to_owned();
        let mut records: Vec<Record<'a>> = vec![Record {
            pieces: Vec::new(),
            format,
        }];
        let mut first = true;
        loop {
            match self.marker()? {
                0 => break,
                m if m < 0 => {
                    // The -1 behind the name has no flags.
                    if !first {
                        self.marker()?;
                        self.marker()?;
                    }
                    first = false;
                    records.push(Record {
                        pieces: Vec::new(),
                        format,
                    });
                }
                _ => {
                    let piece = self.block()?;
                    if let Some(record) = records.last_mut() {
                        record.pieces.push(piece);
                    }
                }
            }
        }
        Ok(Some((name, records)))
    }
}

fn error(at: usize, what: &str) -> ModeFileError {
    ModeFileError::Bytes {
        format: "op2",
        at,
        what: what.to_owned(),
    }
}

/// Reads the modes (and grid points, if it has them) of an op2 file.
///
/// # Errors
/// Truncated and foreign files, a file without real eigenvectors, modes with different points.
pub fn read_op2(bytes: &[u8]) -> Result<Op2Modes> {
    let mut reader = Reader::new(bytes)?;
    reader.pass_label()?;
    let mut eigenvalues = Vec::new();
    let mut shapes = Collector::default();
    let mut grids = Vec::new();
    while let Some((name, records)) = reader.table()? {
        match name.as_str() {
            "LAMA" | "BLAMA" | "LAMAS" | "CLAMA1" => eigenvalues = read_lama(&records),
            "GEOM1" | "GEOM1S" | "GEOM1N" => grids = read_grids(&records),
            name if name.starts_with("OUG")
                || name.starts_with("BOUG")
                || name.starts_with("OPHIG")
                || name.starts_with("BOPHIG") =>
            {
                read_vectors(&records, &mut shapes);
            }
            _ => {}
        }
    }
    let table = shapes.finish(eigenvalues)?;
    if table.shapes.is_empty() {
        return Err(ModeFileError::Nothing {
            format: "op2",
            what: "table of real eigenvectors (OUGV1, BOUGV1 or OPHIG)",
            hint: "ask for VECTOR(PLOT) = ALL and PARAM,POST,-1",
        });
    }
    Ok(Op2Modes { table, grids })
}

/// Rows of seven words: mode, order, eigenvalue, radians, cycles, mass, stiffness.
fn read_lama(records: &[Record]) -> Vec<Eigenvalue> {
    let mut found = Vec::new();
    // Behind the name come trailer, name again, header and the rows.
    for record in records.iter().skip(4) {
        let f = record.format;
        for row in record.words().chunks_exact(7) {
            let mode = f.integer(row[0]);
            if (1..1_000_000).contains(&mode) {
                found.push(Eigenvalue {
                    mode: mode as usize,
                    eigenvalue: f.real(row[2]),
                    freq_hz: f.real(row[4]),
                    generalized_mass: Some(f.real(row[5])),
                });
            }
        }
    }
    found.dedup_by_key(|e| e.mode);
    found
}

/// GRID records: key 4501, 45, 1, then eight words a point.
fn read_grids(records: &[Record]) -> Vec<Op2Grid> {
    let mut found = Vec::new();
    for record in records {
        let f = record.format;
        let words = record.words();
        if words.len() < 11 || f.integer(words[0]) != 4501 || f.integer(words[1]) != 45 || f.integer(words[2]) != 1 {
            continue;
        }
        for row in words[3..].chunks_exact(8) {
            let number = |i: usize| u32::try_from(f.integer(row[i])).ok();
            if let (Some(id), Some(cp), Some(cd)) = (number(0), number(1), number(5)) {
                found.push(Op2Grid {
                    id,
                    cp,
                    position: [f.real(row[2]), f.real(row[3]), f.real(row[4])],
                    cd,
                });
            }
        }
    }
    found
}

/// Pairs of a header record and a data record; only real eigenvectors sorted by mode are taken.
fn read_vectors(records: &[Record], shapes: &mut Collector) {
    let mut header: Option<usize> = None;
    for record in records {
        let f = record.format;
        let words = record.words();
        // A header has 146 words: approach code, table code, ..., mode number, eigenvalue, ..., width of the rows.
        if words.len() == 146 {
            let approach = f.integer(words[0]) / 10;
            let table = f.integer(words[1]) % 1000;
            let is_mode =
                approach == 2 && matches!(table, 1 | 7) && f.integer(words[1]) < 2000 && f.integer(words[9]) == 8;
            header = None;
            if let (true, Ok(mode)) = (is_mode, usize::try_from(f.integer(words[4]))) {
                let eigenvalue = f.real(words[5]);
                shapes.open(mode, eigenvalue, eigenvalue.max(0.0).sqrt() / std::f64::consts::TAU);
                header = Some(mode);
            }
        } else if header.is_some() {
            for row in words.chunks_exact(8) {
                // The number is ten times the point's, plus a device code.
                let Ok(point) = u32::try_from(f.integer(row[0]) / 10) else {
                    continue;
                };
                let mut values = [0.0; 6];
                for (value, word) in values.iter_mut().zip(&row[2..]) {
                    *value = f.real(word);
                }
                if f.integer(row[1]) == 2 {
                    values[1..].fill(0.0);
                }
                shapes.row(point, values);
            }
            if !words.is_empty() {
                header = None;
            }
        }
    }
}
