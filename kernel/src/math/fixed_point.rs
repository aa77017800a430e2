//! Fixed-point numbers: a step without floating point, for lockstep games, for rules that ban floats, and for
//! processors that have none.
//!
//! A number is a 64-bit integer times `2^-F`. Every operation gives the exact result rounded to the nearest number,
//! ties to even. To nearest rather than towards zero: an error has no preferred sign, so that energy does not drift by
//! rounding; and `-(a b) = (-a) b`, so that action and reaction stay equal to the bit.
//!
//! Nothing wraps or saturates. A result that is too large, a quotient by zero and the root of a negative number give
//! the overflow mark, a value of its own: every operation on it gives it again, and every comparison with it is false.
//! If a comparison would lose it, [`Real::carry`] hands it on. A step that meets it ends with
//! [`crate::Error::Overflow`], in the middle: a host that wants the state before keeps a copy.

use core::cmp::Ordering;
use core::fmt;
use core::ops::{Add, Div, Mul, Neg, Sub};

use fixed::FixedI64;
use fixed::types::extra::{LeEqU64, U24, U32, U40, Unsigned};

use crate::math::real::Real;

/// A 64-bit fixed-point number with `F` bits after the point.
#[derive(Clone, Copy, Default)]
pub struct Fixed<F: Places>(FixedI64<F>);

/// Range 2.1e9, spacing 2.3e-10: for reduced units.
pub type I32F32 = Fixed<U32>;
/// Range 5.5e11, spacing 6.0e-8: for stiff laws.
pub type I40F24 = Fixed<U24>;
/// Range 8.4e6, spacing 9.1e-13: for small overlaps.
pub type I24F40 = Fixed<U40>;

/// Bits after the point that a world can be computed with.
pub trait Places: LeEqU64 + Copy + Default + fmt::Debug + Send + Sync + 'static {
    /// How many.
    const BITS: u32 = <Self as Unsigned>::U32;
    /// What the type is called in the crate `fixed`.
    const NAME: &'static str;
}

impl Places for U24 {
    const NAME: &'static str = "I40F24";
}
impl Places for U32 {
    const NAME: &'static str = "I32F32";
}
impl Places for U40 {
    const NAME: &'static str = "I24F40";
}

/// A fixed-point number.
pub trait FixedPoint: Real {
    /// Bits after the point.
    const PLACES: u32;
}

impl<F: Places> FixedPoint for Fixed<F> {
    const PLACES: u32 = F::BITS;
}

/// The overflow mark.
const MARK: i64 = i64::MIN;

/// The number of this size and sign, or the mark.
#[inline(always)]
const fn signed(size: u64, negative: bool) -> i64 {
    if size > i64::MAX as u64 {
        MARK
    } else if negative {
        -(size as i64)
    } else {
        size as i64
    }
}

/// `size`, one more if `left` of it, in any unit, is more than the `rest` to the next number, or as much and `size` is
/// odd.
#[inline(always)]
const fn rounded(size: u64, left: u64, rest: u64) -> u64 {
    size + (left > rest || left == rest && size & 1 == 1) as u64
}

/// `a b 2^-F`. On small machines it is called, not copied to each place: flash and stack are scarce there.
#[cfg_attr(not(any(target_arch = "arm", target_arch = "riscv32")), inline)]
#[cfg_attr(any(target_arch = "arm", target_arch = "riscv32"), inline(never))]
const fn product(a: i64, b: i64, places: u32) -> i64 {
    if a == MARK || b == MARK {
        return MARK;
    }
    // Four products of 32 bits: what a small processor has.
    let (x, y) = (a.unsigned_abs(), b.unsigned_abs());
    let (xh, xl) = (x >> 32, x & 0xffff_ffff);
    let (yh, yl) = (y >> 32, y & 0xffff_ffff);
    let low = xl * yl;
    // Neither sum can overflow: the factors have 31 and 32 bits.
    let middle = xh * yl + (low >> 32);
    let cross = xl * yh + (middle & 0xffff_ffff);
    let high = xh * yh + (middle >> 32) + (cross >> 32);
    let low = (cross << 32) | (low & 0xffff_ffff);
    // The product is high 2^64 + low.
    if high >> (places - 1) != 0 {
        return MARK;
    }
    let size = (high << (64 - places)) | (low >> places);
    let left = low << (64 - places);
    signed(rounded(size, left, 1 << 63), (a ^ b) < 0)
}

/// `a / b`.
#[cfg_attr(not(any(target_arch = "arm", target_arch = "riscv32")), inline)]
#[cfg_attr(any(target_arch = "arm", target_arch = "riscv32"), inline(never))]
const fn quotient(a: i64, b: i64, places: u32) -> i64 {
    if a == MARK || b == MARK || b == 0 {
        return MARK;
    }
    let (x, y) = (a.unsigned_abs(), b.unsigned_abs());
    let (mut size, mut left) = if x < y { (0, x) } else { (x / y, x % y) };
    if size >> (63 - places) != 0 {
        return MARK;
    }
    // The places after the point, as many at a time as there is room for before what is left: all of them if
    // the divisor is small.
    let mut wanted = places;
    while wanted > 0 && left > 0 {
        let room = left.leading_zeros();
        let digits = if room < wanted { room } else { wanted };
        left <<= digits;
        size = (size << digits) | (left / y);
        left %= y;
        wanted -= digits;
    }
    size <<= wanted;
    // What is left against the rest of the divisor: twice that could overflow.
    signed(rounded(size, left, y - left), (a ^ b) < 0)
}

/// The root of `a`.
#[cfg_attr(not(any(target_arch = "arm", target_arch = "riscv32")), inline)]
#[cfg_attr(any(target_arch = "arm", target_arch = "riscv32"), inline(never))]
const fn root(a: i64, places: u32) -> i64 {
    if a <= 0 {
        return if a == 0 { 0 } else { MARK };
    }
    // The root of the integer a 2^F: of its leading bits at once, then one bit for each two that follow.
    let x = a as u64;
    let free = x.leading_zeros();
    let shift = if free < places { free } else { places };
    let shift = shift - (places - shift) % 2;
    let top = x << shift;
    let mut size = top.isqrt();
    let mut left = top - size * size;
    let mut bits = (places - shift) / 2;
    while bits > 0 {
        left <<= 2;
        size <<= 1;
        if left > size << 1 {
            left -= (size << 1) + 1;
            size += 1;
        }
        bits -= 1;
    }
    // Half of an odd number is no root of an integer: there are no ties.
    signed(size + (left > size) as u64, false)
}

/// The nearest number to `value`, from its bits.
#[inline]
const fn nearest(value: f64, places: u32) -> i64 {
    let bits = value.to_bits();
    let negative = bits >> 63 == 1;
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let digits = bits & ((1 << 52) - 1);
    if exponent == 0x7ff {
        return MARK;
    }
    if exponent == 0 {
        return 0;
    }
    let digits = digits | 1 << 52;
    let shift = exponent - 1075 + places as i32;
    if shift > 10 {
        MARK
    } else if shift >= 0 {
        signed(digits << shift, negative)
    } else if shift < -54 {
        0
    } else {
        let down = -shift as u32;
        let left = digits & ((1 << down) - 1);
        signed(rounded(digits >> down, left, 1 << (down - 1)), negative)
    }
}

impl<F: Places> Fixed<F> {
    /// The number `bits 2^-F`; `i64::MIN` is the overflow mark.
    pub const fn from_bits(bits: i64) -> Self {
        Self(FixedI64::from_bits(bits))
    }

    /// Its bits; `i64::MIN` for the overflow mark.
    pub const fn to_bits(self) -> i64 {
        self.0.to_bits()
    }

    /// The nearest number to `value`; the overflow mark beyond the range. No floating-point operation.
    pub const fn new(value: f64) -> Self {
        Self::from_bits(nearest(value, F::BITS))
    }
}

impl<F: Places> From<FixedI64<F>> for Fixed<F> {
    /// The same number; the least one there is, which has no negative, becomes the overflow mark.
    fn from(value: FixedI64<F>) -> Self {
        Self(value)
    }
}

impl<F: Places> From<Fixed<F>> for Option<FixedI64<F>> {
    /// The same number; `None` for the overflow mark.
    fn from(value: Fixed<F>) -> Self {
        value.is_finite().then_some(value.0)
    }
}

impl<F: Places> Add for Fixed<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.to_bits(), other.to_bits());
        let (sum, over) = a.overflowing_add(b);
        let marked = over || a == MARK || b == MARK;
        Self::from_bits(if marked { MARK } else { sum })
    }
}

impl<F: Places> Sub for Fixed<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<F: Places> Neg for Fixed<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // The mark is the one integer that has no negative, and so stays.
        Self::from_bits(self.to_bits().wrapping_neg())
    }
}

impl<F: Places> Mul for Fixed<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::from_bits(product(self.to_bits(), other.to_bits(), F::BITS))
    }
}

impl<F: Places> Div for Fixed<F> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self::from_bits(quotient(self.to_bits(), other.to_bits(), F::BITS))
    }
}

impl<F: Places> PartialEq for Fixed<F> {
    /// Never for the overflow mark.
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.to_bits() == other.to_bits() && self.is_finite()
    }
}

impl<F: Places> PartialOrd for Fixed<F> {
    /// `None` for the overflow mark.
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let finite = self.is_finite() && other.is_finite();
        finite.then(|| self.to_bits().cmp(&other.to_bits()))
    }

    #[inline(always)]
    fn lt(&self, other: &Self) -> bool {
        // The mark is below all numbers.
        self.to_bits() < other.to_bits() && self.is_finite()
    }

    #[inline(always)]
    fn le(&self, other: &Self) -> bool {
        self.to_bits() <= other.to_bits() && self.is_finite()
    }

    #[inline(always)]
    fn gt(&self, other: &Self) -> bool {
        other < self
    }

    #[inline(always)]
    fn ge(&self, other: &Self) -> bool {
        other <= self
    }
}

impl<F: Places> fmt::Debug for Fixed<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.is_finite() {
            true => fmt::Display::fmt(&self.0, f),
            false => f.write_str("overflow"),
        }
    }
}

impl<F: Places> Real for Fixed<F> {
    const ZERO: Self = Self::from_bits(0);
    const ONE: Self = Self::from_bits(1 << F::BITS);
    const HALF: Self = Self::from_bits(1 << (F::BITS - 1));
    const EPSILON: Self = Self::from_bits(1);
    const MAX: Self = Self::from_bits(i64::MAX);
    const LEAST: Self = Self::from_bits(1);
    const LEAST_NORMAL: Self = Self::from_bits(1);
    const NAME: &'static str = F::NAME;
    const FIXED_POINT: bool = true;

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::from_bits(root(self.to_bits(), F::BITS))
    }
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self::new(value)
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        match self.is_finite() {
            true => self.to_bits() as f64 / (1u64 << F::BITS) as f64,
            false => f64::NAN,
        }
    }
    #[inline(always)]
    fn from_count(count: u32) -> Self {
        let room = count >> (63 - F::BITS) == 0;
        Self::from_bits(if room {
            i64::from(count) << F::BITS
        } else {
            MARK
        })
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.to_bits() != MARK
    }
    #[inline(always)]
    fn carry(self, other: Self) -> Self {
        if other.is_finite() { self } else { other }
    }
    #[inline(always)]
    fn to_index(self) -> usize {
        let whole = self.to_bits() >> F::BITS;
        if whole < 0 { 0 } else { whole as usize }
    }
    #[inline(always)]
    fn to_words(self) -> (u32, Option<u32>) {
        let bits = self.to_bits() as u64;
        (bits as u32, Some((bits >> 32) as u32))
    }
    #[inline(always)]
    fn from_words(low: u32, high: Option<u32>) -> Self {
        Self::from_bits((u64::from(low) | u64::from(high.unwrap_or(0)) << 32) as i64)
    }
}
