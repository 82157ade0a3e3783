//! Numbers in which matrices, factors and search directions are kept.

use std::fmt::Debug;
use std::ops::{Add, Mul, Sub};

/// `f32` or `f64`. Single precision halves the memory traffic of every triangular solve, which is what bounds it.
pub trait Storage:
    Copy
    + Debug
    + Default
    + Send
    + Sync
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + 'static
{
    /// Rounds to this precision.
    fn from_f64(value: f64) -> Self;
    /// Widens, exactly.
    fn to_f64(self) -> f64;
    /// `self * a + b`, fused.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// `-self`.
    fn negate(self) -> Self;
}

impl Storage for f32 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self::mul_add(self, a, b)
    }
    #[inline(always)]
    fn negate(self) -> Self {
        -self
    }
}

impl Storage for f64 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self::mul_add(self, a, b)
    }
    #[inline(always)]
    fn negate(self) -> Self {
        -self
    }
}
