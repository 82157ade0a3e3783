//! The flux through one boundary face.

use crate::flux::flux_osher;
use crate::gas::{Gas, State, flux_exact};
use crate::real::Real;

/// A boundary condition with its values, non-dimensional.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// Slip wall: nothing crosses, pressure is that of the wave which stops the normal velocity.
    Wall,
    /// Mirror plane: as a wall, but cells beyond it are mirror images.
    Symmetry,
    /// Free stream in the ghost cells, Osher's flux between it and the cell.
    FarField(State<f64>),
    /// Far field by Riemann invariants: the incoming one from the free stream, the outgoing one from the cell.
    FarFieldCharacteristic(State<f64>),
    /// A given state at every face of the patch, first window direction fastest; Osher's flux takes what enters.
    Fixed(Vec<State<f64>>),
    /// Given total pressure, total temperature (as p/rho of the gas at rest) and direction of the flow.
    InflowSubsonic {
        /// Total pressure.
        pressure: f64,
        /// Total pressure over total density.
        temperature: f64,
        /// Unit vector along the flow.
        direction: [f64; 3],
    },
    /// A given state enters.
    InflowSupersonic(State<f64>),
    /// Given static pressure; entropy and the outgoing Riemann invariant come from the cell.
    OutflowSubsonic {
        /// Static pressure.
        pressure: f64,
    },
    /// The cell's state leaves.
    OutflowSupersonic,
    /// A face without area.
    Collapsed,
}

impl Boundary {
    /// True for solid walls, where forces are taken.
    #[must_use]
    pub fn is_wall(&self) -> bool {
        matches!(self, Self::Wall)
    }
}

#[inline(always)]
fn splat_state<T: Real>(s: &State<f64>) -> State<T> {
    s.map(T::splat)
}

/// Pressure at a face that stops the normal velocity `un` (positive towards the face): Osher's flux between a state and
/// its mirror image, p (1 + g u_n/a)^(n+2), exact for a simple wave.
#[inline(always)]
pub fn pressure_at_wall<T: Real, G: Gas>(gas: &G, rho: T, un: T, p: T) -> T {
    let a = gas.sound(rho, p);
    let ratio = (T::splat(1.0) + T::splat(0.5 * gas.gamma_1()) * un / a).max(T::splat(1e-3));
    p * gas.power_n(ratio) * ratio * ratio
}

/// Flux per unit area out of the domain through a boundary face with outward unit normal `n` that moves outward at
/// `face_speed`; `w` is the inside state at the face, `index` the face's place in its patch.
#[inline(always)]
pub fn flux_boundary<T: Real, G: Gas>(
    gas: &G,
    boundary: &Boundary,
    index: usize,
    w: &State<T>,
    n: &[f64; 3],
    face_speed: f64,
) -> State<T> {
    let normal = n.map(T::splat);
    let speed = T::splat(face_speed);
    let un = w[1] * normal[0] + w[2] * normal[1] + w[3] * normal[2];
    let zero = T::splat(0.0);
    match boundary {
        Boundary::Wall | Boundary::Symmetry => {
            let p = pressure_at_wall(gas, w[0], un - speed, w[4]);
            [zero, p * normal[0], p * normal[1], p * normal[2], p * speed]
        }
        Boundary::FarField(outside) | Boundary::InflowSupersonic(outside) => {
            flux_osher(gas, w, &splat_state(outside), &normal, speed)
        }
        Boundary::Fixed(states) => flux_osher(gas, w, &splat_state(&states[index]), &normal, speed),
        Boundary::FarFieldCharacteristic(outside) => flux_exact(
            gas,
            &state_characteristic(gas, w, outside, n, un, speed),
            &normal,
            speed,
        ),
        Boundary::InflowSubsonic {
            pressure,
            temperature,
            direction,
        } => {
            let state = state_inflow(gas, w, un, *pressure, *temperature, direction, n);
            flux_exact(gas, &state, &normal, speed)
        }
        Boundary::OutflowSubsonic { pressure } => flux_exact(
            gas,
            &state_outflow(gas, w, un, *pressure, &normal, speed),
            &normal,
            speed,
        ),
        Boundary::OutflowSupersonic => flux_exact(gas, w, &normal, speed),
        Boundary::Collapsed => [zero; 5],
    }
}

/// Blazek, Computational Fluid Dynamics, section 8.3: Riemann invariants `u_n + n a` of the inside and `u_n - n a` of
/// the outside give normal velocity and speed of sound at the face; entropy and tangential velocity come from where
/// the flow comes from.
#[inline(always)]
fn state_characteristic<T: Real, G: Gas>(
    gas: &G,
    w: &State<T>,
    outside: &State<f64>,
    n: &[f64; 3],
    un: T,
    speed: T,
) -> State<T> {
    let half = T::splat(0.5);
    let order = gas.n();
    let out = splat_state::<T>(outside);
    let a = gas.sound(w[0], w[4]);
    let un_out = T::splat(outside[1] * n[0] + outside[2] * n[1] + outside[3] * n[2]);
    let a_out = T::splat(gas.sound(outside[0], outside[4]));
    let order_t = T::splat(order);
    // Supersonic: both invariants come from the same side.
    let plus_in = un + order_t * a;
    let minus_out = un_out - order_t * a_out;
    let plus_out = un_out + order_t * a_out;
    let minus_in = un - order_t * a;
    let plus = T::select_lt(un_out + a_out, speed, plus_out, plus_in);
    let minus = T::select_lt(speed, un - a, minus_in, minus_out);
    let un_b = half * (plus + minus);
    let a_b = (T::splat(0.25 * gas.gamma_1()) * (plus - minus)).max(T::splat(1e-6));
    let pick = |inside: T, outside: T| T::select_lt(speed, un_b, inside, outside);
    // rho of the isentrope through the source state: (a_b/a)^n.
    let rho_s = pick(w[0], out[0]);
    let a_s = pick(a, a_out);
    let un_s = pick(un, un_out);
    let rho = rho_s * gas.power_n(a_b / a_s);
    let mut state = [rho; 5];
    for c in 0..3 {
        state[1 + c] = pick(w[1 + c], out[1 + c]) + (un_b - un_s) * T::splat(n[c]);
    }
    state[4] = rho * a_b * a_b / T::splat(gas.gamma());
    state
}

/// Total conditions and direction are given; the outgoing invariant `u_n + n a` comes from inside. The speed of sound
/// at the face is the larger root of the quadratic of both (Carlson, NASA/TM-2011-217181, section 2.7).
#[inline(always)]
fn state_inflow<T: Real, G: Gas>(
    gas: &G,
    w: &State<T>,
    un: T,
    pressure: f64,
    temperature: f64,
    direction: &[f64; 3],
    n: &[f64; 3],
) -> State<T> {
    let gamma = gas.gamma();
    let order = gas.n();
    let a = gas.sound(w[0], w[4]);
    let plus = un + T::splat(order) * a;
    // With the flow along `direction`, u_n = q d.n (negative), q^2 = n (a0^2 - a^2).
    let dn = (direction[0] * n[0] + direction[1] * n[1] + direction[2] * n[2]).min(-1e-3);
    let a0_squared = gamma * temperature;
    // q dn = plus - n a  =>  (n dn^2 + n^2) a^2 - 2 n plus a + plus^2 - n dn^2 a0^2 = 0
    let dn2 = dn * dn;
    let qa = T::splat(order * dn2 + order * order);
    let qb = T::splat(order) * plus;
    let qc = plus * plus - T::splat(order * dn2 * a0_squared);
    let root = (qb * qb - qa * qc).max(T::splat(1e-12)).sqrt();
    let a_b = (qb + root) / qa;
    let limit = T::splat(a0_squared.sqrt());
    let a_b = T::select_lt(a_b, limit, a_b, limit);
    let q = (T::splat(order) * (T::splat(a0_squared) - a_b * a_b))
        .max(T::splat(1e-30))
        .sqrt();
    let ratio = a_b / limit;
    let rho = T::splat(pressure / temperature) * gas.power_n(ratio);
    let p = rho * a_b * a_b / T::splat(gamma);
    [
        rho,
        q * T::splat(direction[0]),
        q * T::splat(direction[1]),
        q * T::splat(direction[2]),
        p,
    ]
}

/// Static pressure is given; entropy, tangential velocity and `u_n + n a` leave with the flow. A supersonic outflow
/// leaves as it is.
#[inline(always)]
fn state_outflow<T: Real, G: Gas>(gas: &G, w: &State<T>, un: T, pressure: f64, normal: &[T; 3], speed: T) -> State<T> {
    let a = gas.sound(w[0], w[4]);
    let p = T::splat(pressure);
    let ratio = (p / w[4]).power(gas.z());
    let rho = w[0] * gas.power_n(ratio);
    let change = T::splat(gas.n()) * a * (T::splat(1.0) - ratio);
    let state = [
        rho,
        w[1] + change * normal[0],
        w[2] + change * normal[1],
        w[3] + change * normal[2],
        p,
    ];
    let mut out = state;
    for v in 0..5 {
        out[v] = T::select_lt(a, un - speed, w[v], state[v]);
    }
    out
}
