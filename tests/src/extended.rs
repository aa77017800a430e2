//! Numbers of some 32 digits, each the sum of two `f64` (double-double: Dekker, Numer. Math. 18, 224 (1971); Hida, Li
//! and Bailey, ARITH-15, 155 (2001)), to tell rounding from method.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number: the sum of both parts, the lower of which is at most half a spacing of the upper one.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Extended {
    high: f64,
    low: f64,
}

/// 0.
pub const ZERO: Extended = Extended {
    high: 0.0,
    low: 0.0,
};

impl From<f64> for Extended {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

/// The sum of two numbers and its error, the larger of them first.
fn ordered_sum(a: f64, b: f64) -> Extended {
    let high = a + b;
    let low = b - (high - a);
    Extended { high, low }
}

/// The sum of any two numbers and its error.
fn sum(a: f64, b: f64) -> Extended {
    let high = a + b;
    let part = high - a;
    let low = (a - (high - part)) + (b - part);
    Extended { high, low }
}

/// The product of two numbers and its error.
fn product(a: f64, b: f64) -> Extended {
    let high = a * b;
    let low = a.mul_add(b, -high);
    Extended { high, low }
}

impl Extended {
    /// The nearest `f64`.
    pub fn to_f64(self) -> f64 {
        self.high
    }

    /// The square root, of zero or more.
    pub fn sqrt(self) -> Self {
        if self == ZERO {
            return ZERO;
        }
        // Two steps of Newton's method from 16 digits.
        let mut root = Self::from(self.high.sqrt());
        for _ in 0..2 {
            root = root + (self - root * root) / (root + root);
        }
        root
    }

    /// The size.
    pub fn abs(self) -> Self {
        if self < ZERO { -self } else { self }
    }
}

impl Add for Extended {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let (high, low) = (sum(self.high, b.high), sum(self.low, b.low));
        let part = ordered_sum(high.high, high.low + low.high);
        ordered_sum(part.high, part.low + low.low)
    }
}

impl Neg for Extended {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Extended {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Extended {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let part = product(self.high, b.high);
        ordered_sum(
            part.high,
            part.low + (self.high * b.low + self.low * b.high),
        )
    }
}

impl Div for Extended {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let first = self.high / b.high;
        let rest = self - b * Self::from(first);
        let second = rest.high / b.high;
        let rest = rest - b * Self::from(second);
        Self::from(first) + Self::from(second) + Self::from(rest.high / b.high)
    }
}
