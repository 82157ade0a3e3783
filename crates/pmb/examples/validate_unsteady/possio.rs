//! Possio's integral equation: a thin plate that oscillates in subsonic flow, in two dimensions.
//!
//! Downwash and pressure, both times e^(i omega t), lengths in semichords, x from -1 to 1 (Possio 1938; Bisplinghoff,
//! Ashley and Halfman, Aeroelasticity, section 6-4):
//!
//! `w(x)/U = k/2 int dCp(s) K(M, k (x - s)) ds`,
//!
//! `K(M, X) = 1/(4 b) { e^(i M^2 X/b^2) [i M sgn(X) H1(M|X|/b^2) - H0(M|X|/b^2)]
//!            + i b^2 e^(-i X) [2/(pi b) ln((1 + b)/M) + int_0^(X/b^2) e^(i u) H0(M|u|) du] }`
//!
//! with b^2 = 1 - M^2 and Hankel functions of the second kind. Solved with dCp = sqrt((1-s)/(1+s)) f(s) by collocation at the
//! points where the Gauss rule for that weight is exact for Cauchy's kernel.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector};

type C = Complex<f64>;
const I: C = C::new(0.0, 1.0);

/// H0 and H1 of the second kind for 0 < x < 15, by their power series.
fn hankel(x: f64) -> [C; 2] {
    const EULER: f64 = 0.577_215_664_901_532_9;
    let q = -0.25 * x * x;
    let (mut j0, mut y0, mut j1, mut y1) = (0.0, 0.0, 0.0, 0.0);
    let (mut term0, mut term1, mut sum) = (1.0, 0.5 * x, 0.0);
    for m in 0..60 {
        let n = f64::from(m);
        j0 += term0;
        j1 += term1;
        y0 -= term0 * sum;
        y1 -= term1 * (2.0 * sum + 1.0 / (n + 1.0));
        term0 *= q / ((n + 1.0) * (n + 1.0));
        term1 *= q / ((n + 1.0) * (n + 2.0));
        sum += 1.0 / (n + 1.0);
    }
    let log = (0.5 * x).ln() + EULER;
    let y0 = 2.0 / PI * (log * j0 + y0);
    let y1 = 2.0 / PI * log * j1 - 2.0 / (PI * x) + y1 / PI;
    [C::new(j0, -y0), C::new(j1, -y1)]
}

/// int_0^z e^(iu) H0(M|u|) du: u = z t^3 takes the logarithm out; Simpson's rule.
fn wake(mach: f64, z: f64) -> C {
    const N: usize = 96;
    let mut sum = C::new(0.0, 0.0);
    for n in 1..=N {
        let t = n as f64 / N as f64;
        let u = z * t * t * t;
        let weight = if n == N {
            1.0
        } else if n % 2 == 1 {
            4.0
        } else {
            2.0
        };
        sum += (I * u).exp() * hankel(mach * u.abs())[0] * (weight * 3.0 * z * t * t);
    }
    sum / (3.0 * N as f64)
}

fn kernel(mach: f64, x: f64) -> C {
    let b2 = 1.0 - mach * mach;
    let b = b2.sqrt();
    let [h0, h1] = hankel(mach * x.abs() / b2);
    let near = (I * (mach * mach * x / b2)).exp() * (I * (mach * x.signum()) * h1 - h0);
    let far = (-I * x).exp() * (wake(mach, x / b2) + 2.0 / (PI * b) * ((1.0 + b) / mach).ln());
    (near + I * b2 * far) / (4.0 * b)
}

/// How the plate moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateMotion {
    /// Nose up about the axis, by one radian.
    Pitch,
    /// Up, by one chord.
    Plunge,
}

/// Lift coefficient and moment coefficient (nose up, about the axis, by chord squared) of a unit of motion times e^(i omega t).
/// `axis` in chords from the leading edge, `k = omega c/(2U)`.
pub fn coefficients(mach: f64, k: f64, axis: f64, motion: PlateMotion) -> [C; 2] {
    const N: usize = 60;
    let step = PI / (2 * N + 1) as f64;
    let load = |j: usize| -((2 * j + 1) as f64 * step).cos();
    let weight = |j: usize| 2.0 * step * (1.0 - load(j));
    let axis = 2.0 * axis - 1.0;
    let collocation = |i: usize| -((2 * (i + 1)) as f64 * step).cos();
    let mut matrix = DMatrix::from_fn(N, N, |i, j| {
        kernel(mach, k * (collocation(i) - load(j))) * (0.5 * k * weight(j))
    });
    // K ~ i/(2 pi b) ln|X|: a rule of mid-points a step dt apart, with the singular point half-way between two of them, gives
    // dt ln 2 too much of a logarithm (Stirling); the load there is the mean of its neighbours'.
    let log = I * (0.5 * k / (2.0 * PI * (1.0 - mach * mach).sqrt()) * 2.0 * step * 2.0_f64.ln());
    for i in 0..N {
        let next = (i + 1).min(N - 1);
        for j in [i, next] {
            matrix[(i, j)] -= log * (0.5 * (1.0 - collocation(i)));
        }
    }
    let right = DVector::from_fn(N, |i, _| match motion {
        PlateMotion::Pitch => -(C::new(1.0, 0.0) + I * k * (collocation(i) - axis)),
        // A chord is two semichords.
        PlateMotion::Plunge => I * k * 2.0,
    });
    let zero = C::new(0.0, 0.0);
    let Some(f) = matrix.lu().solve(&right) else {
        return [C::new(f64::NAN, f64::NAN); 2];
    };
    let (mut lift, mut moment) = (zero, zero);
    for j in 0..N {
        let d = f[j] * weight(j);
        lift += d * 0.5;
        moment -= d * (0.25 * (load(j) - axis));
    }
    [lift, moment]
}

/// The same in incompressible flow from Theodorsen's function C(k) = H1/(H1 + i H0) (NACA Report 496).
pub fn incompressible(k: f64, axis: f64, motion: PlateMotion) -> [C; 2] {
    let [h0, h1] = hankel(k);
    let c = h1 / (h1 + I * h0);
    let a = 2.0 * axis - 1.0;
    let ik = I * k;
    // Apparent mass lift at mid-chord, circulatory lift at the quarter chord, of an angle theta and a rise h (semichords).
    let (lift, moment_mid) = match motion {
        PlateMotion::Pitch => {
            let circulatory = 2.0 * PI * c * (1.0 + ik * (0.5 - a));
            let lift = PI * (ik - ik * ik * a) + circulatory;
            // About mid-chord: (c L_c / 4) - (pi/4) ik - (pi/16) (ik)^2, by chord squared.
            (lift, circulatory * 0.25 - ik * (0.25 * PI) - ik * ik * (PI / 16.0))
        }
        PlateMotion::Plunge => {
            let circulatory = -2.0 * PI * c * ik * 2.0;
            (circulatory - PI * ik * ik * 2.0, circulatory * 0.25)
        }
    };
    [lift, moment_mid + lift * (0.5 * a)]
}
