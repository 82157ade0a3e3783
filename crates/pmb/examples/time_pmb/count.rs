//! Operations of the kernels, counted by running them on a number that counts: additions, multiplications, divisions and roots
//! as one each, a multiply-add as two, comparisons and selections as none.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use dip_pmb::flux::{flux_osher, jacobian_osher};
use dip_pmb::gas::Diatomic;
use dip_pmb::real::Real;
use dip_pmb::reconstruct::muscl;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

/// A number that counts what is done with it.
#[derive(Clone, Copy)]
struct Counted(f64);

fn done(operations: u64, value: f64) -> Counted {
    COUNT.with(|c| c.set(c.get() + operations));
    Counted(value)
}

impl Add for Counted {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        done(1, self.0 + o.0)
    }
}
impl Sub for Counted {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        done(1, self.0 - o.0)
    }
}
impl Mul for Counted {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        done(1, self.0 * o.0)
    }
}
impl Div for Counted {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        done(1, self.0 / o.0)
    }
}
impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Counted {
    fn splat(value: f64) -> Self {
        Self(value)
    }
    fn sqrt(self) -> Self {
        done(1, self.0.sqrt())
    }
    fn power(self, exponent: f64) -> Self {
        // Two series of 11 and 13 multiply-adds and what stands round them in the kernel's own power.
        done(2 * (11 + 13) + 13, Real::power(self.0, exponent))
    }
    fn max(self, o: Self) -> Self {
        Self(Real::max(self.0, o.0))
    }
    fn select_lt(a: Self, b: Self, yes: Self, no: Self) -> Self {
        if a.0 < b.0 { yes } else { no }
    }
}

fn counted<R>(work: impl FnOnce() -> R) -> u64 {
    COUNT.with(|c| c.set(0));
    std::hint::black_box(work());
    COUNT.with(Cell::get)
}

const LEFT: [f64; 5] = [1.0, 0.9, 0.1, 0.2, 1.1];
const RIGHT: [f64; 5] = [1.1, 0.8, 0.2, 0.1, 1.0];

fn face<R>(work: impl FnOnce([Counted; 5], [Counted; 5], [Counted; 3]) -> R) -> u64 {
    counted(|| work(LEFT.map(Counted), RIGHT.map(Counted), [0.6, 0.8, 0.0].map(Counted)))
}

/// Operations a cell of a three-dimensional residual: three faces, and the sums over the faces.
pub fn residual(reconstruction: dip_pmb::reconstruct::Reconstruction) -> u64 {
    use dip_pmb::reconstruct::{Koren, Mean, Reconstruction, VanAlbada};
    let e2 = [Counted(1e-3); 3];
    let states = face(|l, r, _| match reconstruction {
        Reconstruction::Constant => [l, r],
        Reconstruction::Unlimited => muscl::<_, Mean>(&r, &l, &r, &l, &e2),
        Reconstruction::VanAlbada => muscl::<_, VanAlbada>(&r, &l, &r, &l, &e2),
        Reconstruction::Koren => muscl::<_, Koren>(&r, &l, &r, &l, &e2),
    });
    let flux = face(|l, r, n| flux_osher(&Diatomic, &l, &r, &n, Counted(0.0)));
    3 * (states + flux + 5) + 5 * 5
}

/// Operations a cell of the analytic Jacobian: derivatives on three faces, times area, added to two diagonals.
pub fn jacobian() -> u64 {
    let derivatives = face(|l, r, n| jacobian_osher(&Diatomic, &l, &r, &n, Counted(0.0)));
    3 * (derivatives + 50 + 50)
}
