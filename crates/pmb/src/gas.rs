//! A perfect gas with constant ratio of specific heats, and its state in primitive variables.
//!
//! Primitive variables are `[rho, u, v, w, p]`, non-dimensional by free-stream density, free-stream speed and the
//! reference length (pressure by rho U^2); conservative ones `[rho, rho u, rho v, rho w, rho E]`.

use crate::real::Real;

/// Variables of the mean flow.
pub const VARIABLES: usize = 5;
/// One state of five variables.
pub type State<T> = [T; VARIABLES];

/// A perfect gas. Kernels take the gas as a type, so that for gamma = 7/5 the powers are products.
pub trait Gas: Copy + Send + Sync {
    /// Ratio of specific heats.
    fn gamma(&self) -> f64;
    /// `x^n` with n = 2/(gamma - 1), for x >= 0: density along an isentrope as a function of the speed of sound.
    fn power_n<T: Real>(&self, x: T) -> T;

    /// gamma - 1
    #[inline(always)]
    fn gamma_1(&self) -> f64 {
        self.gamma() - 1.0
    }
    /// n = 2/(gamma - 1)
    #[inline(always)]
    fn n(&self) -> f64 {
        2.0 / self.gamma_1()
    }
    /// z = (gamma - 1)/(2 gamma): speed of sound goes as p^z along an isentrope.
    #[inline(always)]
    fn z(&self) -> f64 {
        self.gamma_1() / (2.0 * self.gamma())
    }
    /// Speed of sound.
    #[inline(always)]
    fn sound<T: Real>(&self, rho: T, p: T) -> T {
        (T::splat(self.gamma()) * p / rho).sqrt()
    }
}

/// gamma = 7/5: air, and every gas of two-atom molecules at moderate temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Diatomic;

impl Gas for Diatomic {
    #[inline(always)]
    fn gamma(&self) -> f64 {
        1.4
    }
    #[inline(always)]
    fn power_n<T: Real>(&self, x: T) -> T {
        let x2 = x * x;
        x2 * x2 * x
    }
    // Literals, so that nothing is rounded twice and all of it is known to the compiler.
    #[inline(always)]
    fn gamma_1(&self) -> f64 {
        0.4
    }
    #[inline(always)]
    fn n(&self) -> f64 {
        5.0
    }
    #[inline(always)]
    fn z(&self) -> f64 {
        1.0 / 7.0
    }
}

/// Any other ratio of specific heats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perfect {
    /// Ratio of specific heats, above 1.
    pub gamma: f64,
}

impl Gas for Perfect {
    #[inline(always)]
    fn gamma(&self) -> f64 {
        self.gamma
    }
    #[inline(always)]
    fn power_n<T: Real>(&self, x: T) -> T {
        // The floor keeps zero (vacuum) out of the logarithm.
        x.max(T::splat(1e-60)).power(self.n())
    }
}

/// Conservative variables of a primitive state.
#[inline(always)]
pub fn conservative<T: Real>(gas: &impl Gas, w: &State<T>) -> State<T> {
    let [rho, u, v, ww, p] = *w;
    let kinetic = T::splat(0.5) * rho * (u * u + v * v + ww * ww);
    [
        rho,
        rho * u,
        rho * v,
        rho * ww,
        p * T::splat(1.0 / gas.gamma_1()) + kinetic,
    ]
}

/// Primitive variables of a conservative state.
#[inline(always)]
pub fn primitive<T: Real>(gas: &impl Gas, q: &State<T>) -> State<T> {
    let [rho, mu, mv, mw, e] = *q;
    let (u, v, w) = (mu / rho, mv / rho, mw / rho);
    let kinetic = T::splat(0.5) * (mu * u + mv * v + mw * w);
    [rho, u, v, w, T::splat(gas.gamma_1()) * (e - kinetic)]
}

/// dQ/dW: derivative of the conservative variables with respect to the primitive ones, row-major `[row][column]`.
#[inline]
pub fn conservative_gradient(gas: &impl Gas, w: &State<f64>) -> [[f64; VARIABLES]; VARIABLES] {
    let [rho, u, v, ww, _] = *w;
    [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [u, rho, 0.0, 0.0, 0.0],
        [v, 0.0, rho, 0.0, 0.0],
        [ww, 0.0, 0.0, rho, 0.0],
        [
            0.5 * (u * u + v * v + ww * ww),
            rho * u,
            rho * v,
            rho * ww,
            1.0 / gas.gamma_1(),
        ],
    ]
}

/// Physical flux through a face with unit normal `n` that moves along it at `face_speed`:
/// `rho U [1, u, v, w, E] + p [0, n, u.n]` with U = u.n - face speed (formulation.md, section 2).
#[inline(always)]
pub fn flux_exact<T: Real>(gas: &impl Gas, w: &State<T>, n: &[T; 3], face_speed: T) -> State<T> {
    let [rho, u, v, ww, p] = *w;
    let un = u * n[0] + v * n[1] + ww * n[2];
    let mass = rho * (un - face_speed);
    let e = p * T::splat(1.0 / gas.gamma_1()) / rho + T::splat(0.5) * (u * u + v * v + ww * ww);
    [
        mass,
        mass * u + p * n[0],
        mass * v + p * n[1],
        mass * ww + p * n[2],
        mass * e + p * un,
    ]
}
