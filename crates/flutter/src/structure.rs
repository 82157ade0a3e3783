//! The structure: generalized mass, stiffness, viscous and structural damping.

use faer::{Mat, c64};

use crate::error::{FlutterError, Result, check_value};

/// Structural damping coefficient g (twice the critical damping ratio).
#[derive(Debug, Clone, PartialEq, Default)]
pub enum StructuralDamping {
    /// No structural damping.
    #[default]
    None,
    /// The same g for all of the stiffness.
    Uniform(f64),
    /// One g per natural mode, in the order of rising frequency.
    PerMode(Vec<f64>),
    /// g(f) taken at each natural frequency (Nastran's TABDMP1, type G): linear between the points, and the line of the
    /// first or last two points continued outside of them.
    Table {
        /// Frequencies, Hz, rising.
        freq_hz: Vec<f64>,
        /// g at these frequencies.
        g: Vec<f64>,
    },
}

/// How structural damping enters the equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DampingForm {
    /// K (1 + i g): hysteretic (Nastran PARAM KDAMP -1). It acts on oscillating motion only: none at zero frequency.
    #[default]
    ComplexStiffness,
    /// B = g K / omega_n: viscous at the natural frequencies (Nastran PARAM KDAMP 1).
    ViscousAtNaturalFrequency,
}

/// Natural modes of K phi = omega^2 M phi.
#[derive(Debug, Clone)]
pub struct NaturalModes {
    /// Circular frequencies, rad/s, rising; rigid-body modes have zero.
    pub omega_rad_s: Vec<f64>,
    /// Modes as columns in generalized coordinates, phi^T M phi = 1.
    pub shapes: Mat<f64>,
}

/// Generalized mass, stiffness and damping, dense, SI (kg, N/m, N s/m times the units of the generalized coordinates).
#[derive(Debug, Clone)]
pub struct Structure {
    pub(crate) mass: Mat<f64>,
    pub(crate) stiffness: Mat<f64>,
    pub(crate) viscous: Mat<f64>,
    pub(crate) damping: StructuralDamping,
    pub(crate) form: DampingForm,
    pub(crate) natural: NaturalModes,
}

impl Structure {
    /// Mass and stiffness, `n x n`, symmetric; the mass positive definite.
    ///
    /// # Errors
    /// Sizes, numbers that are not finite, matrices that are not symmetric to 1e-6, or a mass that is singular.
    pub fn new(mass: Mat<f64>, stiffness: Mat<f64>) -> Result<Self> {
        let n = mass.nrows();
        if n == 0 {
            return Err(FlutterError::Shape {
                what: "generalized mass".into(),
                needed: "at least 1 x 1".into(),
                got: "0 x 0".into(),
            });
        }
        check_square("generalized mass", &mass, n)?;
        check_square("generalized stiffness", &stiffness, n)?;
        check_symmetric("generalized mass", &mass)?;
        check_symmetric("generalized stiffness", &stiffness)?;
        let natural = natural_modes(&mass, &stiffness)?;
        Ok(Self {
            viscous: Mat::zeros(n, n),
            mass,
            stiffness,
            damping: StructuralDamping::None,
            form: DampingForm::default(),
            natural,
        })
    }

    /// Uncoupled modes: generalized masses and natural frequencies in Hz.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn from_modes(generalized_mass: &[f64], freq_hz: &[f64]) -> Result<Self> {
        let n = generalized_mass.len();
        if freq_hz.len() != n {
            return Err(FlutterError::Shape {
                what: "natural frequencies".into(),
                needed: format!("{n}, one per generalized mass"),
                got: freq_hz.len().to_string(),
            });
        }
        let diagonal = |f: &dyn Fn(usize) -> f64| Mat::from_fn(n, n, |i, j| if i == j { f(i) } else { 0.0 });
        let omega = |i: usize| std::f64::consts::TAU * freq_hz[i];
        Self::new(
            diagonal(&|i| generalized_mass[i]),
            diagonal(&|i| generalized_mass[i] * omega(i) * omega(i)),
        )
    }

    /// Adds viscous damping B, `n x n`.
    ///
    /// # Errors
    /// Size or numbers that are not finite.
    pub fn with_viscous_damping(mut self, damping: Mat<f64>) -> Result<Self> {
        check_square("generalized viscous damping", &damping, self.size())?;
        self.viscous = damping;
        Ok(self)
    }

    /// Adds structural damping in the form chosen.
    ///
    /// # Errors
    /// A list that does not fit the modes, or a table that does not rise in frequency.
    pub fn with_structural_damping(mut self, damping: StructuralDamping, form: DampingForm) -> Result<Self> {
        match &damping {
            StructuralDamping::None => {}
            StructuralDamping::Uniform(g) => check_value("structural damping g", *g, "a finite number", true)?,
            StructuralDamping::PerMode(g) => {
                if g.len() != self.size() {
                    return Err(FlutterError::Shape {
                        what: "structural damping".into(),
                        needed: format!("{} values, one per mode", self.size()),
                        got: g.len().to_string(),
                    });
                }
                for (mode, &value) in g.iter().enumerate() {
                    check_value(
                        &format!("structural damping g of mode {}", mode + 1),
                        value,
                        "a finite number",
                        true,
                    )?;
                }
            }
            StructuralDamping::Table { freq_hz, g } => {
                if freq_hz.is_empty() || freq_hz.len() != g.len() {
                    return Err(FlutterError::Shape {
                        what: "structural damping table".into(),
                        needed: "as many g as frequencies, at least one".into(),
                        got: format!("{} frequencies and {} g", freq_hz.len(), g.len()),
                    });
                }
                for j in 0..g.len() {
                    let rises = j == 0 || freq_hz[j] > freq_hz[j - 1];
                    check_value(
                        "structural damping table, frequency in Hz",
                        freq_hz[j],
                        "rising frequencies",
                        rises,
                    )?;
                    check_value("structural damping table, g", g[j], "a finite number", true)?;
                }
            }
        }
        self.damping = damping;
        self.form = form;
        Ok(self)
    }

    /// Number of generalized coordinates.
    #[must_use]
    pub fn size(&self) -> usize {
        self.mass.nrows()
    }

    /// Natural modes.
    #[must_use]
    pub fn natural_modes(&self) -> &NaturalModes {
        &self.natural
    }

    /// g of each natural mode.
    #[must_use]
    pub fn damping_per_mode(&self) -> Vec<f64> {
        let omega = &self.natural.omega_rad_s;
        match &self.damping {
            StructuralDamping::None => vec![0.0; omega.len()],
            StructuralDamping::Uniform(g) => vec![*g; omega.len()],
            StructuralDamping::PerMode(g) => g.clone(),
            StructuralDamping::Table { freq_hz, g } => omega
                .iter()
                .map(|w| interpolate_table(freq_hz, g, w / std::f64::consts::TAU))
                .collect(),
        }
    }

    /// Hysteretic part of the stiffness, Im K: M Phi diag(g omega^2) Phi^T M, which is g K for uniform g.
    pub(crate) fn hysteretic(&self) -> Mat<f64> {
        let n = self.size();
        match (&self.damping, self.form) {
            (StructuralDamping::None, _) | (_, DampingForm::ViscousAtNaturalFrequency) => Mat::zeros(n, n),
            (StructuralDamping::Uniform(g), _) => Mat::from_fn(n, n, |i, j| g * self.stiffness[(i, j)]),
            _ => {
                let g = self.damping_per_mode();
                self.modal_matrix(|mode, omega| g[mode] * omega * omega)
            }
        }
    }

    /// All viscous damping: B and, in that form, structural damping as M Phi diag(g omega) Phi^T M.
    pub(crate) fn viscous_total(&self) -> Mat<f64> {
        if self.form == DampingForm::ViscousAtNaturalFrequency && self.damping != StructuralDamping::None {
            let g = self.damping_per_mode();
            &self.viscous + self.modal_matrix(|mode, omega| g[mode] * omega)
        } else {
            self.viscous.clone()
        }
    }

    /// M Phi diag(d) Phi^T M: the matrix whose modal form is diagonal d.
    fn modal_matrix(&self, diagonal: impl Fn(usize, f64) -> f64) -> Mat<f64> {
        let n = self.size();
        let weighted = &self.mass * &self.natural.shapes;
        let scaled = Mat::from_fn(n, n, |i, j| weighted[(i, j)] * diagonal(j, self.natural.omega_rad_s[j]));
        scaled * weighted.transpose()
    }
}

/// g(f) of a table: linear inside, the end lines continued outside (Nastran's rule for TABDMP1).
fn interpolate_table(freq_hz: &[f64], g: &[f64], at_hz: f64) -> f64 {
    let last = freq_hz.len() - 1;
    if last == 0 {
        return g[0];
    }
    let low = freq_hz.partition_point(|&f| f <= at_hz).clamp(1, last) - 1;
    g[low] + (g[low + 1] - g[low]) * (at_hz - freq_hz[low]) / (freq_hz[low + 1] - freq_hz[low])
}

fn check_square(what: &str, matrix: &Mat<f64>, n: usize) -> Result<()> {
    if matrix.nrows() != n || matrix.ncols() != n {
        return Err(FlutterError::Shape {
            what: what.into(),
            needed: format!("{n} x {n}"),
            got: format!("{} x {}", matrix.nrows(), matrix.ncols()),
        });
    }
    for column in 0..n {
        for row in 0..n {
            let value = matrix[(row, column)];
            if !value.is_finite() {
                return Err(FlutterError::NotFinite {
                    what: what.into(),
                    row,
                    column,
                    value,
                });
            }
        }
    }
    Ok(())
}

fn check_symmetric(what: &str, matrix: &Mat<f64>) -> Result<()> {
    let n = matrix.nrows();
    for column in 0..n {
        for row in 0..column {
            let (a, b) = (matrix[(row, column)], matrix[(column, row)]);
            let scale = (matrix[(row, row)] * matrix[(column, column)])
                .abs()
                .sqrt()
                .max(a.abs())
                .max(b.abs());
            if (a - b).abs() > 1e-6 * scale {
                return Err(FlutterError::Value {
                    what: format!("{what}, entries ({row}, {column}) and ({column}, {row}) differ"),
                    needed: "a symmetric matrix".into(),
                    got: a - b,
                });
            }
        }
    }
    Ok(())
}

/// K phi = omega^2 M phi by Cholesky M = L L^T and the symmetric eigenproblem of L^-1 K L^-T.
fn natural_modes(mass: &Mat<f64>, stiffness: &Mat<f64>) -> Result<NaturalModes> {
    let n = mass.nrows();
    let fail = |reason: String| FlutterError::NoNaturalModes { reason };
    // Scaling by the diagonal first makes the test for a singular mass independent of the units of the coordinates.
    let mut scale = vec![0.0; n];
    for (i, s) in scale.iter_mut().enumerate() {
        if mass[(i, i)] <= 0.0 {
            return Err(fail(format!(
                "generalized mass of coordinate {} is {} (needed > 0)",
                i + 1,
                mass[(i, i)]
            )));
        }
        *s = mass[(i, i)].sqrt().recip();
    }
    let mut factor = Mat::<f64>::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let symmetric = 0.5 * (mass[(i, j)] + mass[(j, i)]) * scale[i] * scale[j];
            let sum: f64 = (0..j).map(|l| factor[(i, l)] * factor[(j, l)]).sum();
            let rest = symmetric - sum;
            if i == j {
                if rest <= 1e-13 {
                    return Err(fail(format!(
                        "the generalized mass is singular or indefinite (pivot {rest:.1e} of coordinate {})",
                        j + 1
                    )));
                }
                factor[(j, j)] = rest.sqrt();
            } else {
                factor[(i, j)] = rest / factor[(j, j)];
            }
        }
    }
    // C = L^-1 S K S L^-T by two forward substitutions.
    let forward = |mut b: Mat<f64>| {
        for column in 0..n {
            for i in 0..n {
                let sum: f64 = (0..i).map(|l| factor[(i, l)] * b[(l, column)]).sum();
                b[(i, column)] = (b[(i, column)] - sum) / factor[(i, i)];
            }
        }
        b
    };
    let scaled = Mat::from_fn(n, n, |i, j| {
        0.5 * (stiffness[(i, j)] + stiffness[(j, i)]) * scale[i] * scale[j]
    });
    let half = forward(scaled).transpose().to_owned();
    let standard = forward(half);
    let standard = Mat::from_fn(n, n, |i, j| 0.5 * (standard[(i, j)] + standard[(j, i)]));
    let eigen = standard
        .self_adjoint_eigen(faer::Side::Lower)
        .map_err(|_| fail("the symmetric eigenvalue solution did not converge".into()))?;
    let largest = eigen.S().column_vector().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut omega_rad_s = Vec::with_capacity(n);
    for &value in eigen.S().column_vector().iter() {
        if value < -1e-9 * largest.max(f64::MIN_POSITIVE) {
            return Err(fail(format!(
                "omega^2 = {value:.6e} rad^2/s^2 is negative: the stiffness is not positive"
            )));
        }
        omega_rad_s.push(value.max(0.0).sqrt());
    }
    // phi = S L^-T z, back substitution.
    let mut shapes = eigen.U().to_owned();
    for column in 0..n {
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|l| factor[(l, i)] * shapes[(l, column)]).sum();
            shapes[(i, column)] = (shapes[(i, column)] - sum) / factor[(i, i)];
        }
        for i in 0..n {
            shapes[(i, column)] *= scale[i];
        }
    }
    Ok(NaturalModes { omega_rad_s, shapes })
}

/// Complex copy in column order.
pub(crate) fn columns(matrix: &Mat<f64>) -> Vec<c64> {
    let n = matrix.nrows();
    (0..n * n).map(|e| c64::new(matrix[(e % n, e / n)], 0.0)).collect()
}
