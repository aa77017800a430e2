//! The real number a world is computed in, and the few operations a step may use.
//!
//! A step is allowed `+ - * /`, comparison, selection and [`Real::sqrt`], all correctly rounded by
//! IEEE 754, and nothing else: that is what makes its bits the same on every machine.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number with correctly rounded arithmetic: `f64` (the reference), `f32`, or with the feature `fixed` one of
/// the fixed-point types.
pub trait Real:
    Copy
    + PartialOrd
    + Default
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// The spacing of numbers just above 1, `2^-52` or `2^-23`: the unit of the rounding margins.
    const EPSILON: Self;
    /// The largest finite number; stands for "no limit".
    const MAX: Self;
    /// The least positive number, a subnormal one.
    const LEAST: Self;
    /// The least positive normal number.
    const LEAST_NORMAL: Self;
    /// The name of this type in Rust, as `f64`.
    const NAME: &'static str;
    /// Whether numbers are evenly spaced, [`Real::EPSILON`] apart, and those that are too large become an overflow
    /// mark that must not be lost. Floats pay nothing for it.
    const FIXED_POINT: bool = false;

    /// The correctly rounded square root; NaN below zero.
    fn sqrt(self) -> Self;
    /// The nearest number to `value`; for set-up, never inside a step.
    fn from_f64(value: f64) -> Self;
    /// This number as `f64`, exact for floats, else the nearest; never inside a step.
    fn to_f64(self) -> f64;
    /// A count up to 2^20 as a number.
    fn from_count(count: u32) -> Self;
    /// Whether this is neither infinite nor NaN, and no overflow mark.
    fn is_finite(self) -> bool;
    /// This number, or the overflow mark of `other` if that has one: a law calls it on what it selects by a
    /// comparison with `other`, which loses the mark. Floats have none.
    #[inline(always)]
    fn carry(self, _other: Self) -> Self {
        self
    }
    /// Truncated towards zero, 0 for negative numbers and NaN; for the cells of the search only.
    fn to_index(self) -> usize;
    /// The number's bits in words, the lowest first, for a digest; the second is `None` if one
    /// word holds them.
    fn to_words(self) -> (u32, Option<u32>);
    /// The number with these bits; a second word that its type has not is ignored.
    fn from_words(low: u32, high: Option<u32>) -> Self;
}

macro_rules! real {
    ($float:ident, $sqrt:path, $words:path, $number:path) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const EPSILON: Self = $float::EPSILON;
            const MAX: Self = $float::MAX;
            const LEAST: Self = $float::from_bits(1);
            const LEAST_NORMAL: Self = $float::MIN_POSITIVE;
            const NAME: &'static str = stringify!($float);

            #[inline(always)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn from_count(count: u32) -> Self {
                count as $float
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
            #[inline(always)]
            fn to_index(self) -> usize {
                self as usize
            }
            #[inline(always)]
            fn to_words(self) -> (u32, Option<u32>) {
                $words(self)
            }
            #[inline(always)]
            fn from_words(low: u32, high: Option<u32>) -> Self {
                $number(low, high)
            }
        }
    };
}

#[cfg(feature = "std")]
mod root {
    #[inline(always)]
    pub fn f64(x: f64) -> f64 {
        x.sqrt()
    }
    #[inline(always)]
    pub fn f32(x: f32) -> f32 {
        x.sqrt()
    }
}
#[cfg(not(feature = "std"))]
mod root {
    #[inline(always)]
    pub fn f64(x: f64) -> f64 {
        libm::sqrt(x)
    }
    #[inline(always)]
    pub fn f32(x: f32) -> f32 {
        libm::sqrtf(x)
    }
}

/// The words of a number.
mod words {
    pub fn f64(x: f64) -> (u32, Option<u32>) {
        let bits = x.to_bits();
        (bits as u32, Some((bits >> 32) as u32))
    }
    pub fn f32(x: f32) -> (u32, Option<u32>) {
        (x.to_bits(), None)
    }
}

real!(f64, root::f64, words::f64, numbers::f64);
real!(f32, root::f32, words::f32, numbers::f32);

/// The numbers of words.
mod numbers {
    pub fn f64(low: u32, high: Option<u32>) -> f64 {
        f64::from_bits(u64::from(low) | u64::from(high.unwrap_or(0)) << 32)
    }
    pub fn f32(low: u32, _: Option<u32>) -> f32 {
        f32::from_bits(low)
    }
}

/// The larger of two numbers by comparison; the first when they compare equal or not at all.
#[inline(always)]
pub fn larger<R: Real>(a: R, b: R) -> R {
    if b > a { b } else { a }
}

/// The smaller of two numbers by comparison; the first when they compare equal or not at all.
#[inline(always)]
pub fn smaller<R: Real>(a: R, b: R) -> R {
    if b < a { b } else { a }
}

/// The number without its sign.
#[inline(always)]
pub fn magnitude<R: Real>(a: R) -> R {
    if a < R::ZERO { -a } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two square roots that a build may choose from give the same bits: over edge cases and
    /// ten million random words, spread over all exponents.
    #[test]
    fn square_roots_of_std_and_libm_are_equal() {
        let same = |bits: u64| {
            let (x, y) = (
                f64::from_bits(bits),
                f32::from_bits((bits >> 32) as u32 % 0x7f80_0001),
            );
            assert_eq!(libm::sqrt(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
            assert_eq!(libm::sqrtf(y).to_bits(), y.sqrt().to_bits(), "{y:e}");
        };
        let edges = [
            0.0,
            f64::MIN_POSITIVE,
            5e-324,
            f64::MAX,
            f64::INFINITY,
            1.0,
            2.0,
            0.5,
        ];
        for x in edges {
            for ulp in 0..3u64 {
                same(x.to_bits().saturating_sub(ulp));
                same((x.to_bits() + ulp).min(f64::INFINITY.to_bits()));
            }
        }
        let mut word = 0x9e37_79b9_7f4a_7c15u64;
        for _ in 0..10_000_000 {
            // A linear congruence is random enough to spread over mantissas and exponents.
            word = word
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            // Positive and not NaN in both widths.
            same((word >> 1) % f64::INFINITY.to_bits());
        }
    }

    #[test]
    fn comparisons_choose_the_first_of_equals() {
        assert_eq!(larger(0.0f64, -0.0).to_bits(), 0.0f64.to_bits());
        assert_eq!(smaller(-0.0f64, 0.0).to_bits(), (-0.0f64).to_bits());
        assert_eq!(magnitude(-3.5), 3.5);
    }
}
