//! Osher's approximate Riemann solver for a perfect gas and a moving face.
//!
//! F = F(W_L) + integral of A^- dW along a path from W_L to W_R of the three wave families in physical order
//! (u - a, u, u + a): Osher and Solomon 1982, Math. Comp. 38; physical ordering, Hemker and Spekreijse 1986; Toro,
//! Riemann Solvers and Numerical Methods for Fluid Dynamics, section 12.3. With g = (gamma-1)/2, n = 2/(gamma-1),
//! z = (gamma-1)/(2 gamma), H = (p_L/p_R)^z the intermediate states are
//!
//! ```text
//! P     = (a_L + a_R - g (u_R - u_L)) / (a_L + a_R H)
//! a_1   = a_L P,    rho_1 = rho_L P^n,      p* = p_L P^(n+2),    u* = u_L + n (a_L - a_1)
//! a_2   = a_R P H,  rho_2 = rho_R (P H)^n
//! ```
//!
//! and the sonic points of the first and the third wave
//!
//! ```text
//! a_S0 = ((gamma-1) u_L + 2 a_L)/(gamma+1) =  u_S0,   rho, p isentropic from L
//! a_S1 = (2 a_R - (gamma-1) u_R)/(gamma+1) = -u_S1,   rho, p isentropic from R
//! ```
//!
//! The integral is the sum of the fluxes of the six states with weights in {-1, 0, 1}, which follow from the signs of
//! u_L - a_L, u* - a_1, u*, u* + a_2, u_R + a_R. All is done in the frame of the face; the flux is moved to the fixed
//! frame exactly (Galilei). Only the normal velocity enters the path; the tangential velocity is carried by the mass
//! that crosses from either side of the contact.

use crate::gas::{Gas, State};
use crate::real::Real;

/// Least P, as part of the speeds of sound over the denominator: below it the path runs through vacuum.
const VACUUM: f64 = 1e-8;

/// Fluxes in the frame of the face, tangential velocities left out.
struct Normal<T> {
    /// Mass from the left side of the contact (states L, S0, 1).
    mass_l: T,
    /// Mass from the right side of the contact (states 2, S1, R).
    mass_r: T,
    /// Normal momentum and pressure.
    momentum: T,
    /// Enthalpy and kinetic energy of the normal velocity.
    energy: T,
}

/// The states of the path, `[rho, u, p]`, and their weights.
struct Path<T> {
    /// L, S0, 1, 2, S1, R.
    states: [[T; 3]; 6],
    weights: [T; 6],
    a_l: T,
    a_r: T,
    /// P and P H.
    ratio: [T; 2],
    /// H and the denominator of P.
    h: T,
    denominator: T,
    /// a_S0/a_L and a_S1/a_R.
    sonic: [T; 2],
}

#[inline(always)]
fn path<T: Real, G: Gas>(gas: &G, l: [T; 3], r: [T; 3]) -> Path<T> {
    let (zero, one, two) = (T::splat(0.0), T::splat(1.0), T::splat(2.0));
    let g1 = T::splat(gas.gamma_1());
    let g = T::splat(0.5 * gas.gamma_1());
    let n = T::splat(gas.n());
    let [rho_l, u_l, p_l] = l;
    let [rho_r, u_r, p_r] = r;
    let a_l = gas.sound(rho_l, p_l);
    let a_r = gas.sound(rho_r, p_r);
    let h = (p_l / p_r).power(gas.z());
    let both = a_l + a_r;
    let denominator = a_l + a_r * h;
    let ratio_1 = (both - g * (u_r - u_l)).max(T::splat(VACUUM) * both) / denominator;
    let ratio_2 = ratio_1 * h;
    let a_1 = a_l * ratio_1;
    let a_2 = a_r * ratio_2;
    let p_n = gas.power_n(ratio_1);
    let rho_1 = rho_l * p_n;
    let p_star = p_l * p_n * ratio_1 * ratio_1;
    let rho_2 = rho_r * gas.power_n(ratio_2);
    let u_star = u_l + n * (a_l - a_1);
    let half_sum = T::splat(1.0 / (gas.gamma() + 1.0));
    let a_s0 = ((g1 * u_l + two * a_l) * half_sum).max(zero);
    let a_s1 = ((two * a_r - g1 * u_r) * half_sum).max(zero);
    let q0 = a_s0 / a_l;
    let q1 = a_s1 / a_r;
    let q0_n = gas.power_n(q0);
    let q1_n = gas.power_n(q1);

    let negative = |x: T| T::select_lt(x, zero, one, zero);
    let (s_l, s_1, s_c, s_2, s_r) = (
        negative(u_l - a_l),
        negative(u_star - a_1),
        negative(u_star),
        negative(u_star + a_2),
        negative(u_r + a_r),
    );
    Path {
        states: [
            l,
            [rho_l * q0_n, a_s0, p_l * q0_n * q0 * q0],
            [rho_1, u_star, p_star],
            [rho_2, u_star, p_star],
            [rho_r * q1_n, -a_s1, p_r * q1_n * q1 * q1],
            r,
        ],
        weights: [one - s_l, s_l - s_1, s_1 - s_c, s_c - s_2, s_2 - s_r, s_r],
        a_l,
        a_r,
        ratio: [ratio_1, ratio_2],
        h,
        denominator,
        sonic: [q0, q1],
    }
}

#[inline(always)]
fn sum_fluxes<T: Real, G: Gas>(gas: &G, path: &Path<T>) -> Normal<T> {
    let enthalpy = T::splat(gas.gamma() / gas.gamma_1());
    let half = T::splat(0.5);
    let zero = T::splat(0.0);
    let mut mass = [zero; 2];
    let (mut momentum, mut energy) = (zero, zero);
    for s in 0..6 {
        let [rho, u, p] = path.states[s];
        let m = path.weights[s] * rho * u;
        mass[s / 3] = mass[s / 3] + m;
        momentum = momentum + m * u + path.weights[s] * p;
        energy = energy + half * m * u * u + path.weights[s] * enthalpy * p * u;
    }
    Normal {
        mass_l: mass[0],
        mass_r: mass[1],
        momentum,
        energy,
    }
}

#[inline(always)]
fn dot<T: Real>(a: [T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Osher's flux per unit area from `l` to `r` (primitive states) through a face with unit normal `n` (from left to
/// right) that moves along its normal at `face_speed`. Rows: mass, momentum x, y, z, energy.
#[inline(always)]
pub fn flux_osher<T: Real, G: Gas>(gas: &G, l: &State<T>, r: &State<T>, n: &[T; 3], face_speed: T) -> State<T> {
    let half = T::splat(0.5);
    let (v_l, v_r) = ([l[1], l[2], l[3]], [r[1], r[2], r[3]]);
    let (un_l, un_r) = (dot(v_l, n), dot(v_r, n));
    let path = path(gas, [l[0], un_l - face_speed, l[4]], [r[0], un_r - face_speed, r[4]]);
    let f = sum_fluxes(gas, &path);
    // Velocity in the face: the whole velocity less its normal part.
    let t_l = [v_l[0] - un_l * n[0], v_l[1] - un_l * n[1], v_l[2] - un_l * n[2]];
    let t_r = [v_r[0] - un_r * n[0], v_r[1] - un_r * n[1], v_r[2] - un_r * n[2]];
    let mass = f.mass_l + f.mass_r;
    let tangential = half * (f.mass_l * dot(t_l, &t_l) + f.mass_r * dot(t_r, &t_r));
    // From the frame of the face to the fixed one.
    let along = f.momentum + mass * face_speed;
    let energy = f.energy + tangential + face_speed * (f.momentum + half * mass * face_speed);
    [
        mass,
        along * n[0] + f.mass_l * t_l[0] + f.mass_r * t_r[0],
        along * n[1] + f.mass_l * t_l[1] + f.mass_r * t_r[1],
        along * n[2] + f.mass_l * t_l[2] + f.mass_r * t_r[2],
        energy,
    ]
}

/// Gradient with respect to `[rho_l, u_l, p_l, rho_r, u_r, p_r]`.
type Gradient<T> = [T; 6];

#[inline(always)]
fn combine<T: Real>(a: T, x: &Gradient<T>, b: T, y: &Gradient<T>) -> Gradient<T> {
    let mut out = *x;
    for m in 0..6 {
        out[m] = a * x[m] + b * y[m];
    }
    out
}

/// Gradients of `[rho, u, p]` of the four computed states S0, 1, 2, S1: the formulas at the head of this file,
/// differentiated one after the other.
#[inline(always)]
fn state_gradients<T: Real, G: Gas>(gas: &G, path: &Path<T>, l: [T; 3], r: [T; 3]) -> [[Gradient<T>; 3]; 4] {
    let (zero, one, two) = (T::splat(0.0), T::splat(1.0), T::splat(2.0));
    let half = T::splat(0.5);
    let g1 = T::splat(gas.gamma_1());
    let g = T::splat(0.5 * gas.gamma_1());
    let n = T::splat(gas.n());
    let m = T::splat(gas.n() + 2.0);
    let [rho_l, _, p_l] = l;
    let [rho_r, _, p_r] = r;
    let (a_l, a_r, h) = (path.a_l, path.a_r, path.h);
    let [ratio_1, ratio_2] = path.ratio;

    let a_l_rho = -half * a_l / rho_l;
    let a_l_p = half * a_l / p_l;
    let a_r_rho = -half * a_r / rho_r;
    let a_r_p = half * a_r / p_r;
    let h_pl = T::splat(gas.z()) * h / p_l;
    let h_pr = -T::splat(gas.z()) * h / p_r;

    let numerator: Gradient<T> = [a_l_rho, g, a_l_p, a_r_rho, -g, a_r_p];
    let denominator: Gradient<T> = [
        a_l_rho,
        zero,
        a_l_p + a_r * h_pl,
        a_r_rho * h,
        zero,
        a_r_p * h + a_r * h_pr,
    ];
    let inverse = one / path.denominator;
    let d_1 = combine(inverse, &numerator, -ratio_1 * inverse, &denominator);
    let mut d_2 = d_1.map(|d| d * h);
    d_2[2] = d_2[2] + ratio_1 * h_pl;
    d_2[5] = d_2[5] + ratio_1 * h_pr;

    let [_, s0, s_1, s_2, s1, _] = path.states;
    // u* = u_L + n a_L (1 - P)
    let mut u_star = d_1.map(|d| -n * a_l * d);
    let left = n * (one - ratio_1);
    u_star[0] = u_star[0] + left * a_l_rho;
    u_star[1] = u_star[1] + one;
    u_star[2] = u_star[2] + left * a_l_p;
    // rho_1 = rho_L P^n, p* = p_L P^(n+2), rho_2 = rho_R (P H)^n
    let over_1 = one / ratio_1;
    let over_2 = one / ratio_2;
    let mut rho_1 = d_1.map(|d| n * s_1[0] * over_1 * d);
    rho_1[0] = rho_1[0] + s_1[0] / rho_l;
    let mut p_star = d_1.map(|d| m * s_1[2] * over_1 * d);
    p_star[2] = p_star[2] + s_1[2] / p_l;
    let mut rho_2 = d_2.map(|d| n * s_2[0] * over_2 * d);
    rho_2[3] = rho_2[3] + s_2[0] / rho_r;

    // Sonic points: q = a_S/a of their side; rho_S = rho q^n, p_S = p q^(n+2).
    let half_sum = T::splat(1.0 / (gas.gamma() + 1.0));
    let [q0, q1] = path.sonic;
    let tiny = T::splat(1e-30);
    let du0 = [two * half_sum * a_l_rho, g1 * half_sum, two * half_sum * a_l_p];
    let dq0 = [(du0[0] - q0 * a_l_rho) / a_l, du0[1] / a_l, (du0[2] - q0 * a_l_p) / a_l];
    let over0 = one / q0.max(tiny);
    let side = |d: [T; 3], offset: usize| {
        let mut out = [zero; 6];
        out[offset..offset + 3].copy_from_slice(&d);
        out
    };
    let s0_rho = [
        n * s0[0] * over0 * dq0[0] + s0[0] / rho_l,
        n * s0[0] * over0 * dq0[1],
        n * s0[0] * over0 * dq0[2],
    ];
    let s0_p = [
        m * s0[2] * over0 * dq0[0],
        m * s0[2] * over0 * dq0[1],
        m * s0[2] * over0 * dq0[2] + s0[2] / p_l,
    ];
    let da1 = [two * half_sum * a_r_rho, -g1 * half_sum, two * half_sum * a_r_p];
    let dq1 = [(da1[0] - q1 * a_r_rho) / a_r, da1[1] / a_r, (da1[2] - q1 * a_r_p) / a_r];
    let over1 = one / q1.max(tiny);
    let s1_rho = [
        n * s1[0] * over1 * dq1[0] + s1[0] / rho_r,
        n * s1[0] * over1 * dq1[1],
        n * s1[0] * over1 * dq1[2],
    ];
    let s1_p = [
        m * s1[2] * over1 * dq1[0],
        m * s1[2] * over1 * dq1[1],
        m * s1[2] * over1 * dq1[2] + s1[2] / p_r,
    ];
    [
        [side(s0_rho, 0), side(du0, 0), side(s0_p, 0)],
        [rho_1, u_star, p_star],
        [rho_2, u_star, p_star],
        [side(s1_rho, 3), side(da1.map(|d| -d), 3), side(s1_p, 3)],
    ]
}

/// Derivatives of [`flux_osher`] with respect to both primitive states, `[column][row]` (column = variable).
///
/// The weights are constant but at the switches, where the flux is continuous with them (it is C1 there).
#[inline(always)]
pub fn jacobian_osher<T: Real, G: Gas>(
    gas: &G,
    l: &State<T>,
    r: &State<T>,
    n: &[T; 3],
    face_speed: T,
) -> [[State<T>; 5]; 2] {
    let (zero, one, half) = (T::splat(0.0), T::splat(1.0), T::splat(0.5));
    let enthalpy = T::splat(gas.gamma() / gas.gamma_1());
    let (v_l, v_r) = ([l[1], l[2], l[3]], [r[1], r[2], r[3]]);
    let (un_l, un_r) = (dot(v_l, n), dot(v_r, n));
    let left = [l[0], un_l - face_speed, l[4]];
    let right = [r[0], un_r - face_speed, r[4]];
    let path = path(gas, left, right);
    let computed = state_gradients(gas, &path, left, right);
    let unit = |at: usize| {
        let mut out = [zero; 6];
        out[at] = one;
        out
    };
    let gradients = [
        [unit(0), unit(1), unit(2)],
        computed[0],
        computed[1],
        computed[2],
        computed[3],
        [unit(3), unit(4), unit(5)],
    ];

    // Gradients of the fluxes in the frame of the face.
    let mut mass = [[zero; 6]; 2];
    let mut mass_value = [zero; 2];
    let (mut momentum, mut energy) = ([zero; 6], [zero; 6]);
    for (s, [d_rho, d_u, d_p]) in gradients.iter().enumerate() {
        let [rho, u, p] = path.states[s];
        let c = path.weights[s];
        let side = s / 3;
        mass_value[side] = mass_value[side] + c * rho * u;
        let (c_u, c_rho, c_uu) = (c * u, c * rho, c * u * u);
        let half_uuu = half * c_uu * u;
        let e_u = c * (enthalpy * p + T::splat(1.5) * rho * u * u);
        let e_p = enthalpy * c_u;
        for m in 0..6 {
            mass[side][m] = mass[side][m] + c_u * d_rho[m] + c_rho * d_u[m];
            momentum[m] = momentum[m] + c_uu * d_rho[m] + T::splat(2.0) * c_rho * u * d_u[m] + c * d_p[m];
            energy[m] = energy[m] + half_uuu * d_rho[m] + e_u * d_u[m] + e_p * d_p[m];
        }
    }

    let t_l = [v_l[0] - un_l * n[0], v_l[1] - un_l * n[1], v_l[2] - un_l * n[2]];
    let t_r = [v_r[0] - un_r * n[0], v_r[1] - un_r * n[1], v_r[2] - un_r * n[2]];
    let k_l = half * dot(t_l, &t_l);
    let k_r = half * dot(t_r, &t_r);
    // Column of the flux for a change of one of the six variables of the path.
    let column = |m: usize| -> State<T> {
        let (ml, mr) = (mass[0][m], mass[1][m]);
        let total = ml + mr;
        let along = momentum[m] + total * face_speed;
        [
            total,
            along * n[0] + ml * t_l[0] + mr * t_r[0],
            along * n[1] + ml * t_l[1] + mr * t_r[1],
            along * n[2] + ml * t_l[2] + mr * t_r[2],
            energy[m] + ml * k_l + mr * k_r + face_speed * (momentum[m] + half * total * face_speed),
        ]
    };
    let mut out = [[[zero; 5]; 5]; 2];
    for (side, tangential) in [(0, t_l), (1, t_r)] {
        out[side][0] = column(3 * side);
        out[side][4] = column(3 * side + 2);
        let normal = column(3 * side + 1);
        let carried = mass_value[side];
        for c in 0..3 {
            // A change of velocity component c: its normal part moves along the path, the rest is carried.
            let mut col = normal.map(|x| x * n[c]);
            for row in 0..3 {
                let delta = if row == c { one } else { zero };
                col[1 + row] = col[1 + row] + carried * (delta - n[row] * n[c]);
            }
            col[4] = col[4] + carried * tangential[c];
            out[side][1 + c] = col;
        }
    }
    out
}
