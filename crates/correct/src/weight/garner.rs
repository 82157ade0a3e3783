//! The semi-empirical correction after Garner and Dau: unsteady pressures from steady nonlinear ones.
//!
//! The linear pressure jump of a strip is dCp = 2 (du + i (k/b) dphi), dphi the integral of du from the leading edge. The
//! steady nonlinear slope over the linear one, box by box, scales the part that comes from the perturbation velocity du; the
//! part that comes from the potential's change in time is made anew from the scaled velocity, so that it keeps its
//! own phase lag:
//!
//! ```text
//! p = 2 L u,  L = 1 + i (k/b) C,   corrected p = L R L^-1 p
//! ```
//!
//! with C the running integral over the boxes of a strip and R the steady ratios. At k = 0 it is the steady pressure ratio.

use dip_dlm::c64;
use dip_dlm::lattice::Lattice;

/// Perturbation velocities u = L^-1 p / 2 from pressures `[box]`, in place.
pub(crate) fn velocity_of(lattice: &Lattice, wave_number: f64, p: &mut [c64]) {
    for strip in lattice.strips() {
        let mut potential = c64::new(0.0, 0.0);
        let range = strip.first..strip.first + strip.count;
        for (p, b) in p[range.clone()].iter_mut().zip(&lattice.boxes()[range]) {
            // Half of the own box lies ahead of its middle.
            let diagonal = c64::new(1.0, 0.5 * wave_number * b.chord);
            let u = (*p * 0.5 - c64::new(0.0, wave_number) * potential) / diagonal;
            potential += u * b.chord;
            *p = u;
        }
    }
}

/// Pressures p = 2 L u from perturbation velocities `[box]`, in place.
pub(crate) fn pressure_of(lattice: &Lattice, wave_number: f64, u: &mut [c64]) {
    for strip in lattice.strips() {
        let mut potential = c64::new(0.0, 0.0);
        let range = strip.first..strip.first + strip.count;
        for (u, b) in u[range.clone()].iter_mut().zip(&lattice.boxes()[range]) {
            let own = *u;
            let middle = potential + own * (0.5 * b.chord);
            *u = (own + c64::new(0.0, wave_number) * middle) * 2.0;
            potential += own * b.chord;
        }
    }
}
