//! The downwash matrix, strip by strip.
//!
//! All boxes of a strip share y, z, width and dihedral, so for a pair of strips r1 is one number per fit point: the line
//! weights, the integrals' coefficients (per k) and the horseshoe's legs are found once per pair; what is left per pair of
//! boxes depends on x alone and runs over the receiving strip as vector code. Geometry (square roots, one exponential) is
//! found once and used for all reduced frequencies.

use faer::c64;
use rayon::prelude::*;

use super::integrals::{Desmarais12, ExponentialSum, Laschka11, SumCoefficients};
use super::landahl::{Lanes, Point, Scratch, Wave};
use super::line_fit::LineWeights;
use super::steady::Horseshoe;
use super::{IntegralSum, Kernel, LineFit};
use crate::lattice::{Lattice, PlaneSymmetry, Strip};
use crate::matrix::ComplexMatrix;

/// Smallest r1 in half widths: on the doublet line's own x-axis the kernel has a finite limit, which this gives to
/// round-off.
const R1_FLOOR: f64 = 1e-8;

/// Downwash matrices D for one Mach number: `w = D dCp`, one matrix per wave number `kappa = omega / U = k / b`
/// (1 / the lattice's length unit), each [row = receiving box][column = sending box].
///
/// w is the flow's velocity along the receiving box's normal over U, dCp the lower minus the upper pressure over the
/// dynamic pressure. The Mach number must be in [0, 1) and the wave numbers finite; callers check.
pub fn downwash(lattice: &Lattice, kernel: Kernel, mach: f64, wave_numbers: &[f64]) -> Vec<ComplexMatrix> {
    match kernel.integrals {
        IntegralSum::Laschka11 => assemble::<Laschka11>(lattice, kernel.fit, mach, wave_numbers),
        IntegralSum::Desmarais12 => assemble::<Desmarais12>(lattice, kernel.fit, mach, wave_numbers),
    }
}

/// One image of a receiving strip: reflecting the receiver is the same as reflecting the sender.
struct Image {
    sign: f64,
    flip_y: bool,
    flip_z: bool,
}

fn images(lattice: &Lattice) -> Vec<Image> {
    let one = |sign: f64, flip_y: bool, flip_z: bool| Image { sign, flip_y, flip_z };
    let (sy, sz) = (lattice.symmetry_y.sign(), lattice.symmetry_z.sign());
    let mut list = vec![one(1.0, false, false)];
    if lattice.symmetry_y != PlaneSymmetry::None {
        list.push(one(sy, true, false));
    }
    if lattice.symmetry_z != PlaneSymmetry::None {
        list.push(one(sz, false, true));
    }
    if lattice.symmetry_y != PlaneSymmetry::None && lattice.symmetry_z != PlaneSymmetry::None {
        list.push(one(sy * sz, true, true));
    }
    list
}

impl Image {
    /// Whether the sending strip lies in a reflected plane: it is its own image and counts once.
    fn is_itself(&self, sender: &Strip) -> bool {
        let tolerance = 1e-6 * sender.half_width;
        let in_y = sender.y.abs() < tolerance && sender.cos_dihedral.abs() < 1e-6;
        let in_z = sender.z.abs() < tolerance && sender.sin_dihedral.abs() < 1e-6;
        (self.flip_y && in_y) || (self.flip_z && in_z)
    }

    /// Receiver's y, z and normal (y, z) after reflection.
    fn receiver(&self, strip: &Strip) -> ([f64; 2], [f64; 2]) {
        let (a, b) = (
            if self.flip_y { -1.0 } else { 1.0 },
            if self.flip_z { -1.0 } else { 1.0 },
        );
        (
            [a * strip.y, b * strip.z],
            [-a * strip.sin_dihedral, b * strip.cos_dihedral],
        )
    }
}

/// What a sending strip writes: its columns in every matrix.
struct Columns<'a> {
    strip: usize,
    of: Vec<&'a mut [c64]>,
}

fn assemble<S: ExponentialSum>(lattice: &Lattice, fit: LineFit, mach: f64, wave_numbers: &[f64]) -> Vec<ComplexMatrix> {
    let n = lattice.n_boxes();
    let mut matrices: Vec<ComplexMatrix> = wave_numbers.iter().map(|_| ComplexMatrix::zeros(n, n)).collect();
    // x from the lattice's own origin: small phases stay small wherever the user's origin is.
    let origin = lattice.boxes()[0].force_point[0];
    let x_receiver: Vec<f64> = lattice.boxes().iter().map(|b| b.control_point[0] - origin).collect();
    // exp(-i kappa x) of the control points, [k][box].
    let phases: Vec<Vec<c64>> = wave_numbers
        .iter()
        .map(|kappa| {
            x_receiver
                .iter()
                .map(|x| c64::new((kappa * x).cos(), -(kappa * x).sin()))
                .collect()
        })
        .collect();
    let images = images(lattice);
    let shared = Shared {
        lattice,
        fit,
        mach,
        wave_numbers,
        origin,
        x_receiver,
        phases,
        images,
    };
    let mut rest: Vec<&mut [c64]> = matrices.iter_mut().map(ComplexMatrix::data_mut).collect();
    let mut tasks = Vec::with_capacity(lattice.strips().len());
    for (index, strip) in lattice.strips().iter().enumerate() {
        let mut of = Vec::with_capacity(rest.len());
        for slice in &mut rest {
            let (head, tail) = std::mem::take(slice).split_at_mut(strip.count * n);
            of.push(head);
            *slice = tail;
        }
        tasks.push(Columns { strip: index, of });
    }
    let longest = lattice.strips().iter().map(|s| s.count).max().unwrap_or(0);
    tasks.into_par_iter().for_each_init(
        || Scratch::new(longest, wave_numbers.len()),
        |scratch, columns| {
            shared.fill::<S>(columns, scratch);
        },
    );
    matrices
}

struct Shared<'a> {
    lattice: &'a Lattice,
    fit: LineFit,
    mach: f64,
    wave_numbers: &'a [f64],
    origin: f64,
    x_receiver: Vec<f64>,
    phases: Vec<Vec<c64>>,
    images: Vec<Image>,
}

impl Shared<'_> {
    fn fill<S: ExponentialSum>(&self, mut columns: Columns<'_>, scratch: &mut Scratch) {
        let sender = self.lattice.strips()[columns.strip];
        let group = |s: &Strip| self.lattice.surfaces()[s.surface].interference_group;
        for receiver in self.lattice.strips() {
            if group(receiver) != group(&sender) {
                continue;
            }
            for image in &self.images {
                if !image.is_itself(&sender) {
                    self.pair::<S>(&sender, receiver, image, &mut columns, scratch);
                }
            }
        }
    }

    /// Adds one image of a receiving strip to the columns of a sending strip.
    fn pair<S: ExponentialSum>(
        &self,
        sender: &Strip,
        receiver: &Strip,
        image: &Image,
        columns: &mut Columns<'_>,
        scratch: &mut Scratch,
    ) {
        let n = self.lattice.n_boxes();
        let m = receiver.count;
        let boxes = self.lattice.boxes();
        let (point, normal) = image.receiver(receiver);
        let e = sender.half_width;
        let (cos, sin) = (sender.cos_dihedral, sender.sin_dihedral);
        let (dy, dz) = (point[0] - sender.y, point[1] - sender.z);
        let (y, z) = (dy * cos + dz * sin, dz * cos - dy * sin);
        let beta2 = 1.0 - self.mach * self.mach;
        let weights = LineWeights::new(self.fit, y, z, e);
        // Cosine and sine of the dihedral difference, sender minus receiver.
        let t1 = cos * normal[1] - sin * normal[0];
        let sin_difference = sin * normal[1] + cos * normal[0];
        let stations = self.fit.stations();
        scratch.coefficients.clear();
        for s in stations {
            let r1 = (y - s * e).hypot(z).max(R1_FLOOR * e);
            scratch.coefficients.extend(
                self.wave_numbers
                    .iter()
                    .map(|kappa| SumCoefficients::new::<S>(kappa * r1)),
            );
        }
        for (k, phases) in self.phases.iter().enumerate() {
            for (i, p) in phases[receiver.first..receiver.first + m].iter().enumerate() {
                scratch.phase_re[k][i] = p.re;
                scratch.phase_im[k][i] = p.im;
            }
        }
        let ends = [
            [sender.y - e * cos, sender.z - e * sin],
            [sender.y + e * cos, sender.z + e * sin],
        ];
        let horseshoe = Horseshoe::new(ends, point, normal);
        let inverse_beta = 1.0 / beta2.sqrt();
        let x_points = &self.x_receiver[receiver.first..receiver.first + m];
        let n_k = self.wave_numbers.len();
        let all_steady = self.wave_numbers.iter().all(|kappa| *kappa == 0.0);
        for column in 0..sender.count {
            let from = &boxes[sender.first + column];
            let (x1, x2) = (from.doublet_1[0] - self.origin, from.doublet_2[0] - self.origin);
            for (w, x) in scratch.steady[..m].iter_mut().zip(x_points) {
                *w = horseshoe.wash(x - x1, x - x2, inverse_beta, from.chord);
            }
            scratch.base[..m].fill(0.0);
            for k in 0..n_k {
                scratch.re[k][..m].fill(0.0);
                scratch.im[k][..m].fill(0.0);
            }
            let scale = from.chord / (8.0 * std::f64::consts::PI);
            let tan_sweep = (x2 - x1) / (2.0 * e);
            let mid = 0.5 * (x1 + x2);
            for (p, s) in stations.iter().enumerate() {
                if all_steady {
                    break;
                }
                let x0 = mid + s * e * tan_sweep;
                for (x, at) in scratch.x[..m].iter_mut().zip(x_points) {
                    *x = at - x0;
                }
                let across = y - s * e;
                let r1 = across.hypot(z).max(R1_FLOOR * e);
                let w1 = scale * weights.planar[p] * t1;
                let t2 = z * (z * t1 + across * sin_difference);
                let w2 = weights.nonplanar.map(|w| scale * w[p] * t2);
                let point = Point {
                    r1,
                    mach: self.mach,
                    beta2,
                    w1,
                    w2: w2.unwrap_or(0.0),
                };
                if w2.is_some() {
                    point.geometry::<S, true>(scratch, m);
                } else {
                    point.geometry::<S, false>(scratch, m);
                }
                for (k, &kappa) in self.wave_numbers.iter().enumerate() {
                    if kappa == 0.0 {
                        continue;
                    }
                    let wave = Wave {
                        k1: kappa * r1,
                        kappa,
                        // exp(-i kappa x) = exp(-i kappa x_receiver) exp(+i kappa x0)
                        shift: c64::new((kappa * x0).cos(), (kappa * x0).sin()),
                        coefficients: &scratch.coefficients[p * n_k + k],
                    };
                    let lanes = Lanes {
                        one_minus_v: &scratch.one_minus_v[..m],
                        side: &scratch.side[..m],
                        power: &scratch.power[..m],
                        phase: &scratch.phase[..m],
                        compress: &scratch.compress[..m],
                        u: &scratch.u[..m],
                        k2_plain: &scratch.k2_plain[..m],
                        k2_re: &scratch.k2_re[..m],
                        k2_im: &scratch.k2_im[..m],
                        phase_re: &scratch.phase_re[k][..m],
                        phase_im: &scratch.phase_im[k][..m],
                    };
                    let (re, im) = (&mut scratch.re[k][..m], &mut scratch.im[k][..m]);
                    match (w2.is_some(), self.mach > 0.0) {
                        (false, false) => point.unsteady::<S, false, false>(&wave, lanes, re, im),
                        (false, true) => point.unsteady::<S, false, true>(&wave, lanes, re, im),
                        (true, false) => point.unsteady::<S, true, false>(&wave, lanes, re, im),
                        (true, true) => point.unsteady::<S, true, true>(&wave, lanes, re, im),
                    }
                }
            }
            for (k, kappa) in self.wave_numbers.iter().enumerate() {
                let first = column * n + receiver.first;
                let out = &mut columns.of[k][first..first + m];
                let unsteady = if *kappa == 0.0 { 0.0 } else { image.sign };
                for (i, d) in out.iter_mut().enumerate() {
                    d.re += image.sign * scratch.steady[i] + unsteady * (scratch.base[i] + scratch.re[k][i]);
                    d.im += unsteady * scratch.im[k][i];
                }
            }
        }
    }
}
