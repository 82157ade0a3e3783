//! Influence coefficients: from downwash to pressures at one Mach number and reduced frequency.

use faer::{Par, c64};

use crate::kernel::{Kernel, downwash};
use crate::lattice::{Finding, Lattice, Severity};
use crate::lu::Lu;
use crate::matrix::ComplexMatrix;

/// Why pressures could not be found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AicError {
    /// Mach number outside the subsonic range.
    #[error(
        "Mach number {mach}: the doublet lattice needs 0 <= M < 1; use the flow solver for transonic and faster flow"
    )]
    Mach {
        /// The number given.
        mach: f64,
    },
    /// Reduced frequency or semichord not usable.
    #[error("reduced frequency k = {k} with semichord b = {semichord}: k must be finite and not negative, b positive")]
    ReducedFrequency {
        /// k = omega b / U.
        k: f64,
        /// b.
        semichord: f64,
    },
    /// The lattice makes the matrix singular.
    #[error("the lattice cannot be solved: {message}")]
    Lattice {
        /// The first finding of severity error.
        message: String,
    },
    /// The factorization or its solution is not finite.
    #[error("the downwash matrix at M = {mach}, k = {k} is singular: check the lattice for coincident boxes")]
    Singular {
        /// Mach number.
        mach: f64,
        /// k = omega b / U.
        k: f64,
    },
    /// An array has the wrong size.
    #[error("{what}: {needed} needed, got {got}")]
    Size {
        /// Which array.
        what: &'static str,
        /// Size needed.
        needed: usize,
        /// Size got.
        got: usize,
    },
}

/// A lattice with its kernel and reference semichord: the aerodynamic model.
#[derive(Clone, Debug)]
pub struct Aerodynamics {
    lattice: Lattice,
    kernel: Kernel,
    semichord: f64,
}

impl Aerodynamics {
    /// `semichord` is b of k = omega b / U, in the lattice's length unit.
    ///
    /// # Errors
    /// Findings of severity error in the lattice's geometry, or a semichord that is not positive.
    pub fn new(lattice: Lattice, kernel: Kernel, semichord: f64) -> Result<Self, AicError> {
        if !(semichord.is_finite() && semichord > 0.0) {
            return Err(AicError::ReducedFrequency { k: 0.0, semichord });
        }
        if let Some(Finding { message, .. }) = lattice
            .check_geometry()
            .into_iter()
            .find(|f| f.severity == Severity::Error)
        {
            return Err(AicError::Lattice { message });
        }
        Ok(Self {
            lattice,
            kernel,
            semichord,
        })
    }

    /// The lattice.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The kernel.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Reference semichord b.
    pub fn semichord(&self) -> f64 {
        self.semichord
    }

    /// [`Lattice::check`] for this kernel and semichord.
    pub fn check(&self, mach: f64, k_max: f64) -> Vec<Finding> {
        self.lattice.check(self.kernel, mach, k_max, self.semichord)
    }

    fn wave_number(&self, k: f64) -> Result<f64, AicError> {
        if k.is_finite() && k >= 0.0 {
            Ok(k / self.semichord)
        } else {
            Err(AicError::ReducedFrequency {
                k,
                semichord: self.semichord,
            })
        }
    }

    /// Downwash matrices D, w = D dCp, [k][row = receiving box][column = sending box].
    ///
    /// # Errors
    /// Mach number or reduced frequency out of range.
    pub fn downwash(&self, mach: f64, k: &[f64]) -> Result<Vec<ComplexMatrix>, AicError> {
        if !(0.0..1.0).contains(&mach) {
            return Err(AicError::Mach { mach });
        }
        let wave_numbers = k.iter().map(|&k| self.wave_number(k)).collect::<Result<Vec<_>, _>>()?;
        Ok(downwash(&self.lattice, self.kernel, mach, &wave_numbers))
    }

    /// Factorizes the downwash matrix of one condition.
    ///
    /// # Errors
    /// Out of range, or singular.
    pub fn factor(&self, mach: f64, k: f64) -> Result<FactoredDownwash, AicError> {
        let matrix = self
            .downwash(mach, &[k])?
            .pop()
            .unwrap_or_else(|| ComplexMatrix::zeros(0, 0));
        FactoredDownwash::new(matrix, mach, k, Par::rayon(0))
    }
}

/// A factorized downwash matrix: gives pressures for any downwash.
#[derive(Debug)]
pub struct FactoredDownwash {
    mach: f64,
    k: f64,
    lu: Lu<c64>,
}

impl FactoredDownwash {
    /// LU with partial pivoting, in place.
    pub(crate) fn new(matrix: ComplexMatrix, mach: f64, k: f64, parallelism: Par) -> Result<Self, AicError> {
        let n = matrix.rows();
        let lu = Lu::new(n, matrix.into_data(), parallelism);
        // faer divides by a zero pivot without a word; what follows is not finite then.
        let broken = |z: &c64| !(z.re.is_finite() && z.im.is_finite());
        if lu.factors().iter().any(broken) || lu.diagonal().any(|z| *z == c64::new(0.0, 0.0)) {
            return Err(AicError::Singular { mach, k });
        }
        Ok(Self { mach, k, lu })
    }

    /// Mach number of the condition.
    pub fn mach(&self) -> f64 {
        self.mach
    }

    /// Reduced frequency of the condition.
    pub fn k(&self) -> f64 {
        self.k
    }

    /// Pressures dCp = AIC w for several downwash vectors, [row = box][column = case], in place.
    ///
    /// # Errors
    /// Wrong number of rows; a result that is not finite.
    pub fn solve_in_place(&self, downwash: &mut ComplexMatrix) -> Result<(), AicError> {
        let n = self.lu.n();
        if downwash.rows() != n {
            return Err(AicError::Size {
                what: "rows of the downwash",
                needed: n,
                got: downwash.rows(),
            });
        }
        self.lu.solve_in_place(downwash.view_mut());
        if downwash.is_finite() {
            Ok(())
        } else {
            Err(AicError::Singular {
                mach: self.mach,
                k: self.k,
            })
        }
    }

    /// The AIC itself, D^-1, [row = pressure box][column = downwash box].
    ///
    /// # Errors
    /// A result that is not finite.
    pub fn influence(&self) -> Result<ComplexMatrix, AicError> {
        let n = self.lu.n();
        let mut identity = ComplexMatrix::zeros(n, n);
        for i in 0..n {
            identity[(i, i)] = c64::new(1.0, 0.0);
        }
        self.solve_in_place(&mut identity)?;
        Ok(identity)
    }
}
