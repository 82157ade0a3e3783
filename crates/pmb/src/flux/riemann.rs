//! The exact Riemann problem of a perfect gas, to check approximate fluxes with.
//!
//! Toro, Riemann Solvers and Numerical Methods for Fluid Dynamics, chapter 4: the pressure between the waves is the
//! root of f_L(p) + f_R(p) + u_R - u_L = 0, with f a shock (4.6) or a rarefaction (4.7).

use crate::gas::Gas;

/// Star region of a Riemann problem between `[rho, u, p]` and `[rho, u, p]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Pressure between the waves.
    pub p: f64,
    /// Velocity between the waves.
    pub u: f64,
}

fn wave(gas: &impl Gas, p: f64, [rho, _, p_side]: [f64; 3]) -> (f64, f64) {
    let gamma = gas.gamma();
    let a = gas.sound(rho, p_side);
    if p > p_side {
        let big_a = 2.0 / ((gamma + 1.0) * rho);
        let big_b = (gamma - 1.0) / (gamma + 1.0) * p_side;
        let root = (big_a / (p + big_b)).sqrt();
        ((p - p_side) * root, root * (1.0 - 0.5 * (p - p_side) / (p + big_b)))
    } else {
        let ratio = (p / p_side).powf(gas.z());
        (gas.n() * a * (ratio - 1.0), ratio / (rho * a) * (p_side / p))
    }
}

/// Pressure and velocity between the waves, or `None` where the states draw a vacuum between them.
#[must_use]
pub fn star(gas: &impl Gas, l: [f64; 3], r: [f64; 3]) -> Option<Star> {
    let (a_l, a_r) = (gas.sound(l[0], l[2]), gas.sound(r[0], r[2]));
    let du = r[1] - l[1];
    if gas.n() * (a_l + a_r) <= du {
        return None;
    }
    // Two-rarefaction pressure as a start: exact if both waves are, never negative.
    let z = gas.z();
    let mut p = ((a_l + a_r - du / gas.n()) / (a_l / l[2].powf(z) + a_r / r[2].powf(z))).powf(1.0 / z);
    for _ in 0..100 {
        let (f_l, d_l) = wave(gas, p, l);
        let (f_r, d_r) = wave(gas, p, r);
        let next = (p - (f_l + f_r + du) / (d_l + d_r)).max(0.01 * p);
        let change = (next - p).abs() / (next + p);
        p = next;
        if change < 1e-16 {
            break;
        }
    }
    let (f_l, _) = wave(gas, p, l);
    let (f_r, _) = wave(gas, p, r);
    Some(Star {
        p,
        u: 0.5 * (l[1] + r[1]) + 0.5 * (f_r - f_l),
    })
}

/// State `[rho, u, p]` on the ray x/t = `xi`, or `None` where a vacuum forms.
#[must_use]
pub fn sample(gas: &impl Gas, l: [f64; 3], r: [f64; 3], xi: f64) -> Option<[f64; 3]> {
    let star = star(gas, l, r)?;
    // The right side is the mirror image of the left.
    if xi <= star.u {
        Some(sample_left(gas, l, star, xi))
    } else {
        let mirrored = sample_left(gas, [r[0], -r[1], r[2]], Star { p: star.p, u: -star.u }, -xi);
        Some([mirrored[0], -mirrored[1], mirrored[2]])
    }
}

fn sample_left(gas: &impl Gas, side: [f64; 3], star: Star, xi: f64) -> [f64; 3] {
    let [rho, u, p] = side;
    let gamma = gas.gamma();
    let a = gas.sound(rho, p);
    let ratio = star.p / p;
    if star.p > p {
        // (4.52)
        let shock = u - a * ((gamma + 1.0) / (2.0 * gamma) * ratio + gas.z()).sqrt();
        if xi <= shock {
            return side;
        }
        let g = (gamma - 1.0) / (gamma + 1.0);
        [rho * (ratio + g) / (g * ratio + 1.0), star.u, star.p]
    } else {
        let a_star = a * ratio.powf(gas.z());
        if xi <= u - a {
            side
        } else if xi >= star.u - a_star {
            [rho * ratio.powf(1.0 / gamma), star.u, star.p]
        } else {
            // (4.56): inside the fan
            let c = (2.0 * a + (gamma - 1.0) * (u - xi)) / (gamma + 1.0);
            [rho * (c / a).powf(gas.n()), xi + c, p * (c / a).powf(gas.n() + 2.0)]
        }
    }
}
