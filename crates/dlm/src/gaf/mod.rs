//! Generalized aerodynamic forces of a set of modes over Mach number and reduced frequency.
//!
//! `Q_ij(M, k) = sum over boxes of h_i(1/4 chord) area dCp_j`, dCp_j = AIC w_j, w_j = dh_j/dx + i k h_j / b. The force on
//! mode i is `q_dyn Q_ij` per amplitude of mode j. Unit: that of (h_i h_j) times length (area times h over length).

use faer::Par;
use rayon::prelude::*;

use crate::aic::{Aerodynamics, AicError, FactoredDownwash};
use crate::matrix::ComplexMatrix;
use crate::motion::BoxMotion;

mod interpolate;
mod table;

pub use interpolate::{Interpolation, KInterpolant};
pub use table::{GeneralizedForceTable, TableError};

/// Where a box's motion is taken from the mode shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PointRule {
    /// Slope and displacement at the control point (3/4 chord), force displacement at 1/4 chord: the true shape, better
    /// with few boxes. The default of Dip's own cases.
    #[default]
    ControlPoint,
    /// Displacement and slope at the mid-chord; the box is a rigid plate: h(3/4) = h + c/4 h', h(1/4) = h - c/4 h'.
    /// Nastran's rule.
    MidChord,
}

/// Complex matrices kept in memory at once while several reduced frequencies are worked on together: a share of memory,
/// and above all independent of the number of threads.
const BATCH_BYTES: usize = 400 << 20;

impl Aerodynamics {
    /// Calls `use_factored` for every reduced frequency of one Mach number, sharing what does not depend on k and using all
    /// cores over k. Results come in the order of `k`, and do not depend on the number of threads.
    ///
    /// # Errors
    /// The first one of any condition.
    pub fn for_each_k<T: Send>(
        &self,
        mach: f64,
        k: &[f64],
        use_factored: impl Fn(FactoredDownwash) -> Result<T, AicError> + Sync,
    ) -> Result<Vec<T>, AicError> {
        let n = self.lattice().n_boxes();
        let batch = (BATCH_BYTES / (16 * n * n).max(1)).clamp(1, k.len().max(1));
        let mut results = Vec::with_capacity(k.len());
        for k in k.chunks(batch) {
            let matrices = self.downwash(mach, k)?;
            if let [k] = *k {
                for matrix in matrices {
                    results.push(use_factored(FactoredDownwash::new(matrix, mach, k, Par::rayon(0))?)?);
                }
            } else {
                let part: Vec<Result<T, AicError>> = matrices
                    .into_par_iter()
                    .zip(k.par_iter())
                    .map(|(matrix, &k)| use_factored(FactoredDownwash::new(matrix, mach, k, Par::Seq)?))
                    .collect();
                // The first error in the order of k, whatever thread met one first.
                for result in part {
                    results.push(result?);
                }
            }
        }
        Ok(results)
    }

    /// Pressures of every mode, one matrix per k: dCp [row = box][column = mode], per unit of the mode's amplitude.
    ///
    /// # Errors
    /// Conditions out of range, a singular lattice, or a motion of another lattice.
    pub fn pressures(&self, mach: f64, k: &[f64], motion: &BoxMotion) -> Result<Vec<ComplexMatrix>, AicError> {
        self.check_motion(motion)?;
        self.for_each_k(mach, k, |factored| {
            let mut columns = motion.downwash(factored.k() / self.semichord());
            factored.solve_in_place(&mut columns)?;
            Ok(columns)
        })
    }

    /// The AIC for every k, dCp = AIC w, [row = pressure box][column = downwash box].
    ///
    /// # Errors
    /// Conditions out of range or a singular lattice.
    pub fn influence(&self, mach: f64, k: &[f64]) -> Result<Vec<ComplexMatrix>, AicError> {
        self.for_each_k(mach, k, |factored| factored.influence())
    }

    fn check_motion(&self, motion: &BoxMotion) -> Result<(), AicError> {
        let needed = self.lattice().n_boxes();
        let size = |what, needed, got| {
            if needed == got {
                Ok(())
            } else {
                Err(AicError::Size { what, needed, got })
            }
        };
        size("boxes of the motion", needed, motion.n_boxes)?;
        size("slopes of the motion", needed * motion.n_modes, motion.slope.len())?;
        size(
            "displacements at the control points",
            needed * motion.n_modes,
            motion.at_control.len(),
        )?;
        size(
            "displacements at the force points",
            needed * motion.n_modes,
            motion.at_force.len(),
        )
    }
}

/// Q from pressures: `Q[row = force mode][column = displacement mode]`. Pressures are [row = box][column = mode].
///
/// # Errors
/// Sizes that do not fit.
pub fn generalized_force(
    aerodynamics: &Aerodynamics,
    motion: &BoxMotion,
    pressures: &ComplexMatrix,
) -> Result<ComplexMatrix, AicError> {
    aerodynamics.check_motion(motion)?;
    let boxes = aerodynamics.lattice().boxes();
    if pressures.rows() != boxes.len() {
        return Err(AicError::Size {
            what: "rows of the pressures",
            needed: boxes.len(),
            got: pressures.rows(),
        });
    }
    Ok(ComplexMatrix::from_fn(motion.n_modes, pressures.columns(), |i, j| {
        let h = &motion.at_force[i * boxes.len()..(i + 1) * boxes.len()];
        pressures
            .column(j)
            .iter()
            .zip(boxes)
            .zip(h)
            .map(|((p, b), h)| p * (b.area * h))
            .sum()
    }))
}

/// Q over Mach numbers and reduced frequencies.
///
/// # Errors
/// Conditions out of range, a singular lattice, or sizes that do not fit.
pub fn generalized_forces(
    aerodynamics: &Aerodynamics,
    motion: &BoxMotion,
    mach: &[f64],
    k: &[f64],
) -> Result<GeneralizedForceTable, AicError> {
    let mut q = Vec::with_capacity(mach.len());
    for &m in mach {
        let pressures = aerodynamics.pressures(m, k, motion)?;
        q.push(
            pressures
                .iter()
                .map(|p| generalized_force(aerodynamics, motion, p))
                .collect::<Result<Vec<_>, _>>()?,
        );
    }
    Ok(GeneralizedForceTable {
        mach: mach.to_vec(),
        k: k.to_vec(),
        semichord: aerodynamics.semichord(),
        geometry_hash: aerodynamics.lattice().geometry_hash(),
        kernel: aerodynamics.kernel(),
        q,
    })
}
