//! Fixed-point numbers that check themselves: every operation against exact integers of 128 bits, which hold each
//! product, each shifted dividend and each square.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use bitgrain_kernel::Real;
use bitgrain_kernel::fixed_point::I32F32;

/// An [`I32F32`] whose every operation is checked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exact(I32F32);

/// The overflow mark.
const MARK: i64 = i64::MIN;

/// 1, in bits.
const ONE: i128 = 1 << 32;

impl Exact {
    fn bits(self) -> Option<i128> {
        Some(i128::from(self.0.to_bits())).filter(|bits| *bits != i128::from(MARK))
    }

    /// The number that was found, which must be `n / d` to the nearest place, ties to even, or the mark if that has no
    /// place or there is none.
    fn checked(found: I32F32, exact: Option<(i128, i128)>) -> Self {
        let nearest = exact.map(|(n, d)| {
            let (n, d) = if d < 0 { (-n, -d) } else { (n, d) };
            let (floor, left) = (n.div_euclid(d), n.rem_euclid(d));
            match (2 * left).cmp(&d) {
                Ordering::Less => floor,
                Ordering::Greater => floor + 1,
                Ordering::Equal => floor + (floor & 1),
            }
        });
        let held = nearest.filter(|bits| bits.unsigned_abs() <= i64::MAX as u128);
        assert_eq!(
            found.to_bits(),
            held.map_or(MARK, |bits| bits as i64),
            "{exact:?}"
        );
        Self(found)
    }

    fn both(self, other: Self) -> Option<(i128, i128)> {
        Some((self.bits()?, other.bits()?))
    }
}

/// A dividend with as many places more as a number has, and its divisor.
fn lengthened((a, b): (i128, i128)) -> (i128, i128) {
    (a * ONE, b)
}

impl Add for Exact {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::checked(self.0 + other.0, self.both(other).map(|(a, b)| (a + b, 1)))
    }
}
impl Sub for Exact {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::checked(self.0 - other.0, self.both(other).map(|(a, b)| (a - b, 1)))
    }
}
impl Mul for Exact {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::checked(
            self.0 * other.0,
            self.both(other).map(|(a, b)| (a * b, ONE)),
        )
    }
}
impl Div for Exact {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let exact = self.both(other).filter(|(_, b)| *b != 0);
        Self::checked(self.0 / other.0, exact.map(lengthened))
    }
}
impl Neg for Exact {
    type Output = Self;
    fn neg(self) -> Self {
        Self::checked(-self.0, self.bits().map(|a| (-a, 1)))
    }
}
impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let order = self.both(*other).map(|(a, b)| a.cmp(&b));
        assert_eq!(self.0 < other.0, order == Some(Ordering::Less));
        assert_eq!(
            self.0 <= other.0,
            matches!(order, Some(Ordering::Less | Ordering::Equal))
        );
        order
    }
}

impl Real for Exact {
    const ZERO: Self = Self(I32F32::ZERO);
    const ONE: Self = Self(I32F32::ONE);
    const HALF: Self = Self(I32F32::HALF);
    const EPSILON: Self = Self(I32F32::EPSILON);
    const MAX: Self = Self(I32F32::MAX);
    const LEAST: Self = Self(I32F32::LEAST);
    const LEAST_NORMAL: Self = Self(I32F32::LEAST_NORMAL);
    const NAME: &'static str = "exact";
    const FIXED_POINT: bool = true;

    fn sqrt(self) -> Self {
        let found = self.0.sqrt();
        match self.bits().filter(|bits| *bits >= 0) {
            None => assert_eq!(found.to_bits(), MARK),
            Some(bits) => {
                // r - 1/2 < sqrt(n) < r + 1/2, twice and squared.
                let (r, four) = (i128::from(found.to_bits()), 4 * bits * ONE);
                assert!(r >= 0 && (2 * r + 1) * (2 * r + 1) > four, "root of {bits}");
                assert!(r == 0 || (2 * r - 1) * (2 * r - 1) < four, "root of {bits}");
            }
        }
        Self(found)
    }
    fn from_f64(value: f64) -> Self {
        Self(I32F32::from_f64(value))
    }
    fn to_f64(self) -> f64 {
        self.0.to_f64()
    }
    fn from_count(count: u32) -> Self {
        Self::checked(
            I32F32::from_count(count),
            Some((i128::from(count) * ONE, 1)),
        )
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    fn carry(self, other: Self) -> Self {
        Self(self.0.carry(other.0))
    }
    fn to_index(self) -> usize {
        self.0.to_index()
    }
    fn to_words(self) -> (u32, Option<u32>) {
        self.0.to_words()
    }
    fn from_words(low: u32, high: Option<u32>) -> Self {
        Self(I32F32::from_words(low, high))
    }
}
