//! The kernel: normal wash at a point from a line of pressure doublets along a box's quarter chord.
//!
//! Landahl's form of the kernel, K1 T1 / r1^2 + K2 T2 / r1^4, with the steady part taken out (it is met exactly by a
//! horseshoe vortex, `steady`) and the rest fitted by a polynomial along the doublet line (`line_fit`). The integrals
//! I1 and I2 rest on a sum of exponentials (`integrals`). `landahl` evaluates it for many points at a time, `assembly`
//! runs it all over the lattice.
//!
//! Sources: Albano and Rodden, AIAA J. 7(2) 1969; Rodden, Giesing and Kalman, AGARD CP-80-71 part II (1971) and J. Aircraft
//! 9(10) 1972; Rodden, Taylor and McIntosh, J. Aircraft 35(5) 1998; Laschka 1963; Desmarais, NASA TM 83207 / AIAA 82-0687.

mod assembly;
mod integrals;
mod landahl;
mod lanes;
mod line_fit;
mod steady;

pub use assembly::downwash;

/// Polynomial that the kernel's numerator is fitted with along the doublet line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LineFit {
    /// Three points, Rodden, Giesing and Kalman 1971/1972 (Nastran's default).
    Parabolic,
    /// Five points, Rodden, Taylor and McIntosh 1998: allows wider boxes.
    #[default]
    Quartic,
}

/// Exponential sum for u / sqrt(1 + u^2) in the integrals I1 and I2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum IntegralSum {
    /// Laschka's 11 terms (1963), as N5KA and MSC Nastran use.
    Laschka11,
    /// Desmarais' 12 terms (D12.1, 1982).
    #[default]
    Desmarais12,
}

/// Approximations that make up a kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Kernel {
    /// Fit along the doublet line.
    pub fit: LineFit,
    /// Exponential sum of the integrals.
    pub integrals: IntegralSum,
}

impl Kernel {
    /// Parabolic fit with Laschka's sum: what MSC Nastran's default means.
    pub const NASTRAN: Self = Self {
        fit: LineFit::Parabolic,
        integrals: IntegralSum::Laschka11,
    };
    /// Quartic fit with Desmarais' sum: the default of Dip's own cases.
    pub const QUARTIC: Self = Self {
        fit: LineFit::Quartic,
        integrals: IntegralSum::Desmarais12,
    };
}
