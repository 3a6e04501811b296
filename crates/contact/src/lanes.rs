//! Four numbers side by side, one for each of a facet's four points.
//!
//! These are plain arrays with loops over them. The compiler puts them into one wide register if the caller was
//! compiled for one. Products and sums are not fused, so that every bit equals that of the scalar operations.

use std::ops::{Add, Mul, Neg, Sub};

/// One number for each of four points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes(pub [f64; 4]);

/// One vector for each of four points. `[xyz]`
pub(crate) type Vectors = [Lanes; 3];

impl Lanes {
    /// The same number in all four lanes.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut result = [0.0; 4];
        for k in 0..4 {
            result[k] = f(self.0[k], other.0[k]);
        }
        Self(result)
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut result = [0.0; 4];
        for k in 0..4 {
            result[k] = f(self.0[k]);
        }
        Self(result)
    }

    /// Element-wise quotient.
    #[inline(always)]
    pub(crate) fn over(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    /// Element-wise square root.
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Element-wise absolute value.
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// Element-wise maximum.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// 1 where this is less than `other`, else 0. A comparison with NaN gives 0.
    #[inline(always)]
    pub(crate) fn less(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { 1.0 } else { 0.0 })
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

#[inline(always)]
pub(crate) fn dot(a: &Vectors, b: &Vectors) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: &Vectors, b: &Vectors) -> Vectors {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// a + b s.
#[inline(always)]
pub(crate) fn along(a: &Vectors, b: &Vectors, s: Lanes) -> Vectors {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
}

#[inline(always)]
pub(crate) fn over(a: &Vectors, s: Lanes) -> Vectors {
    [a[0].over(s), a[1].over(s), a[2].over(s)]
}
