//! The AIC's file: influence coefficients of one lattice, kept to be used with any structure.
//!
//! Little-endian, version 1: 8 bytes `DIPAIC\r\n`, version u32, line fit u8, integral sum u8, two zero bytes, number of boxes
//! u64, number of conditions u64, semichord f64, geometry hash u128, then (Mach number, k) f64 pairs, then the matrices by
//! columns (re, im) f64 in the same order, then the FNV-1a 128 hash of all that precedes. The `\r\n` in the magic
//! shows a transfer in text mode, the trailing hash everything else.

use std::io::{Read, Write};
use std::path::Path;

use crate::aic::Aerodynamics;
use crate::c64;
use crate::hash::Fnv128;
use crate::kernel::{IntegralSum, Kernel, LineFit};
use crate::matrix::ComplexMatrix;

const MAGIC: [u8; 8] = *b"DIPAIC\r\n";
const VERSION: u32 = 1;
const HEADER_BYTES: u64 = 8 + 4 + 4 + 8 + 8 + 8 + 16;
const HASH_BYTES: u64 = 16;

/// What can be wrong with an AIC file.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The system's error.
    #[error("AIC file {path}: {source}")]
    File {
        /// Its path.
        path: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Not an AIC file, damaged, or of another version.
    #[error("AIC file {path}: {reason}; make it anew with `dlm aic`")]
    Format {
        /// Its path.
        path: String,
        /// What was needed and what was got.
        reason: String,
    },
    /// The file belongs to another lattice or kernel.
    #[error("AIC file does not belong to this model: {reason}; make it anew with `dlm aic`")]
    Stamp {
        /// What was needed and what was got.
        reason: String,
    },
    /// A condition that the file does not hold.
    #[error("AIC file holds no condition M = {mach}, k = {k}; it holds {have:?}")]
    Condition {
        /// Mach number asked for.
        mach: f64,
        /// k asked for.
        k: f64,
        /// (M, k) of the file.
        have: Vec<(f64, f64)>,
    },
}

/// Influence coefficients with the stamp of what they were made from.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredAic {
    /// Kernel used.
    pub kernel: Kernel,
    /// b of k = omega b / U, in the lattice's length unit.
    pub semichord: f64,
    /// [`crate::lattice::Lattice::geometry_hash`].
    pub geometry_hash: u128,
    /// Number of boxes.
    pub n_boxes: usize,
    /// (Mach number, k) of each matrix.
    pub conditions: Vec<(f64, f64)>,
    /// AIC per condition, [row = pressure box][column = downwash box].
    pub matrices: Vec<ComplexMatrix>,
}

impl StoredAic {
    /// Computes the AIC for all Mach numbers and reduced frequencies of a model.
    ///
    /// # Errors
    /// As [`Aerodynamics::influence`].
    pub fn compute(model: &Aerodynamics, mach: &[f64], k: &[f64]) -> Result<Self, crate::aic::AicError> {
        let mut conditions = Vec::with_capacity(mach.len() * k.len());
        let mut matrices = Vec::with_capacity(mach.len() * k.len());
        for &m in mach {
            matrices.extend(model.influence(m, k)?);
            conditions.extend(k.iter().map(|&k| (m, k)));
        }
        Ok(Self {
            kernel: model.kernel(),
            semichord: model.semichord(),
            geometry_hash: model.lattice().geometry_hash(),
            n_boxes: model.lattice().n_boxes(),
            conditions,
            matrices,
        })
    }

    /// Whether the coefficients belong to this model.
    ///
    /// # Errors
    /// Says what differs.
    pub fn check(&self, model: &Aerodynamics) -> Result<(), StoreError> {
        let differs = |what: &str, needed: String, got: String| {
            Err(StoreError::Stamp {
                reason: format!("{what}: {needed} needed, got {got}"),
            })
        };
        if self.n_boxes != model.lattice().n_boxes() {
            return differs("boxes", model.lattice().n_boxes().to_string(), self.n_boxes.to_string());
        }
        let hash = model.lattice().geometry_hash();
        if self.geometry_hash != hash {
            return differs(
                "geometry hash",
                format!("{hash:032x}"),
                format!("{:032x}", self.geometry_hash),
            );
        }
        if self.kernel != model.kernel() {
            return differs("kernel", format!("{:?}", model.kernel()), format!("{:?}", self.kernel));
        }
        if self.semichord.to_bits() != model.semichord().to_bits() {
            return differs("semichord", model.semichord().to_string(), self.semichord.to_string());
        }
        Ok(())
    }

    /// The AIC of a condition (to 1e-9 in M and k).
    ///
    /// # Errors
    /// The condition is not there.
    pub fn get(&self, mach: f64, k: f64) -> Result<&ComplexMatrix, StoreError> {
        self.conditions
            .iter()
            .position(|c| (c.0 - mach).abs() <= 1e-9 && (c.1 - k).abs() <= 1e-9)
            .and_then(|i| self.matrices.get(i))
            .ok_or_else(|| StoreError::Condition {
                mach,
                k,
                have: self.conditions.clone(),
            })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// The system's; matrices that do not fit the conditions.
    pub fn save(&self, path: &Path) -> Result<(), StoreError> {
        let name = path.display().to_string();
        let fits = self.matrices.len() == self.conditions.len()
            && self
                .matrices
                .iter()
                .all(|m| m.rows() == self.n_boxes && m.columns() == self.n_boxes);
        if !fits {
            return Err(StoreError::Format {
                path: name,
                reason: format!("one matrix of {0} x {0} per condition is needed", self.n_boxes),
            });
        }
        let system = |source| StoreError::File {
            path: name.clone(),
            source,
        };
        let file = std::fs::File::create(path).map_err(system)?;
        let mut out = HashingWriter {
            inner: std::io::BufWriter::new(file),
            hash: Fnv128::new(),
        };
        self.write(&mut out).map_err(system)?;
        let hash = out.hash.value();
        out.inner.write_all(&hash.to_le_bytes()).map_err(system)?;
        out.inner.flush().map_err(system)
    }

    fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        out.write_all(&MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        let fit = match self.kernel.fit {
            LineFit::Parabolic => 0,
            LineFit::Quartic => 1,
        };
        let sum = match self.kernel.integrals {
            IntegralSum::Laschka11 => 0,
            IntegralSum::Desmarais12 => 1,
        };
        out.write_all(&[fit, sum, 0, 0])?;
        out.write_all(&(self.n_boxes as u64).to_le_bytes())?;
        out.write_all(&(self.conditions.len() as u64).to_le_bytes())?;
        out.write_all(&self.semichord.to_le_bytes())?;
        out.write_all(&self.geometry_hash.to_le_bytes())?;
        for (mach, k) in &self.conditions {
            out.write_all(&mach.to_le_bytes())?;
            out.write_all(&k.to_le_bytes())?;
        }
        let mut bytes = Vec::with_capacity(16 * self.n_boxes);
        for matrix in &self.matrices {
            for j in 0..self.n_boxes {
                bytes.clear();
                for z in matrix.column(j) {
                    bytes.extend_from_slice(&z.re.to_le_bytes());
                    bytes.extend_from_slice(&z.im.to_le_bytes());
                }
                out.write_all(&bytes)?;
            }
        }
        Ok(())
    }

    /// Reads a file and checks it whole: sizes against the file's length before anything is allocated, then the hash.
    ///
    /// # Errors
    /// The system's, or [`StoreError::Format`].
    pub fn load(path: &Path) -> Result<Self, StoreError> {
        let name = path.display().to_string();
        let system = |source| StoreError::File {
            path: name.clone(),
            source,
        };
        let bad = |reason: String| StoreError::Format {
            path: name.clone(),
            reason,
        };
        let file = std::fs::File::open(path).map_err(system)?;
        let length = file.metadata().map_err(system)?.len();
        if length < HEADER_BYTES + HASH_BYTES {
            return Err(bad(format!(
                "{} bytes or more are needed, got {length}",
                HEADER_BYTES + HASH_BYTES
            )));
        }
        let mut input = HashingReader {
            inner: std::io::BufReader::new(file),
            hash: Fnv128::new(),
        };
        let magic: [u8; 8] = input.take().map_err(system)?;
        if magic != MAGIC {
            return Err(bad("it does not begin as an AIC file".into()));
        }
        let version = u32::from_le_bytes(input.take().map_err(system)?);
        if version != VERSION {
            return Err(bad(format!("version {VERSION} needed, got {version}")));
        }
        let [fit, sum, ..]: [u8; 4] = input.take().map_err(system)?;
        let kernel = match (fit, sum) {
            (0 | 1, 0 | 1) => Kernel {
                fit: if fit == 0 { LineFit::Parabolic } else { LineFit::Quartic },
                integrals: if sum == 0 {
                    IntegralSum::Laschka11
                } else {
                    IntegralSum::Desmarais12
                },
            },
            _ => return Err(bad(format!("unknown kernel {fit}, {sum}"))),
        };
        let boxes = u64::from_le_bytes(input.take().map_err(system)?);
        let count = u64::from_le_bytes(input.take().map_err(system)?);
        let body = boxes
            .checked_mul(boxes)
            .and_then(|n| n.checked_mul(16))
            .and_then(|n| n.checked_add(16))
            .and_then(|n| n.checked_mul(count))
            .and_then(|n| n.checked_add(HEADER_BYTES + HASH_BYTES));
        if body != Some(length) {
            return Err(bad(format!(
                "{count} conditions of {boxes} boxes do not make a file of {length} bytes: it is cut short or damaged"
            )));
        }
        let semichord = f64::from_le_bytes(input.take().map_err(system)?);
        let geometry_hash = u128::from_le_bytes(input.take().map_err(system)?);
        let mut conditions = Vec::with_capacity(count as usize);
        for _ in 0..count {
            let mach = f64::from_le_bytes(input.take().map_err(system)?);
            conditions.push((mach, f64::from_le_bytes(input.take().map_err(system)?)));
        }
        let n = boxes as usize;
        let mut matrices = Vec::with_capacity(count as usize);
        let mut bytes = vec![0_u8; 16 * n];
        for _ in 0..count {
            let mut matrix = ComplexMatrix::zeros(n, n);
            for column in matrix.data_mut().chunks_exact_mut(n.max(1)) {
                input.read_exact(&mut bytes).map_err(system)?;
                for (z, b) in column.iter_mut().zip(bytes.chunks_exact(16)) {
                    let part = |at: usize| {
                        let mut word = [0_u8; 8];
                        word.copy_from_slice(&b[at..at + 8]);
                        f64::from_le_bytes(word)
                    };
                    *z = c64::new(part(0), part(8));
                }
            }
            matrices.push(matrix);
        }
        let hash = input.hash.value();
        let stored = u128::from_le_bytes(input.take().map_err(system)?);
        if hash != stored {
            return Err(bad("its contents do not fit its hash: it is damaged".into()));
        }
        Ok(Self {
            kernel,
            semichord,
            geometry_hash,
            n_boxes: n,
            conditions,
            matrices,
        })
    }
}

struct HashingWriter<W> {
    inner: W,
    hash: Fnv128,
}

impl<W: Write> Write for HashingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let n = self.inner.write(bytes)?;
        self.hash.add(&bytes[..n]);
        Ok(n)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}

struct HashingReader<R> {
    inner: R,
    hash: Fnv128,
}

impl<R: Read> HashingReader<R> {
    fn take<const N: usize>(&mut self) -> std::io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    fn read_exact(&mut self, bytes: &mut [u8]) -> std::io::Result<()> {
        self.inner.read_exact(bytes)?;
        self.hash.add(bytes);
        Ok(())
    }
}
