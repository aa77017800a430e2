//! A machine off the contract is found out when a world is made: the processor's own modes, set by
//! hand, and number types that do what an unsuitable build would.
#![allow(unsafe_code)]

use core::ops::{Add, Div, Mul, Neg, Sub};

use bitgrain_kernel::{ArithmeticDefect, Error, Real, check_arithmetic};

fn found<R: Real>() -> Option<ArithmeticDefect> {
    match check_arithmetic::<R>() {
        Ok(()) => None,
        Err(Error::Arithmetic { flaw }) => Some(flaw),
        Err(other) => panic!("{other}"),
    }
}

/// The modes of an x86-64 processor, and a world that is refused under each.
#[cfg(target_arch = "x86_64")]
mod modes {
    use core::arch::asm;

    use bitgrain_kernel::contact::HertzHistory;
    use bitgrain_kernel::{Domain, Group, Store, start};

    use super::*;

    /// What `act` gives while some bits of the control word are set.
    fn under<T>(bits: u32, act: impl FnOnce() -> T) -> T {
        let (mut before, mut during) = (0u32, 0u32);
        // SAFETY: the word is stored and loaded whole, and put back before anything else runs.
        unsafe { asm!("stmxcsr [{}]", in(reg) &mut before) };
        let set = before | bits;
        unsafe { asm!("ldmxcsr [{}]", in(reg) &set) };
        let result = act();
        unsafe {
            asm!("stmxcsr [{}]", in(reg) &mut during);
            asm!("ldmxcsr [{}]", in(reg) &before);
        }
        assert_eq!(during & bits, bits, "the mode was on all the time");
        result
    }

    const DENORMALS_ARE_ZERO: u32 = 1 << 6;
    const FLUSH_TO_ZERO: u32 = 1 << 15;
    const DOWN: u32 = 1 << 13;
    const UP: u32 = 2 << 13;
    const TOWARDS_ZERO: u32 = 3 << 13;

    #[test]
    fn modes_of_the_processor_are_found() {
        for (bits, flaw) in [
            (0, None),
            (DENORMALS_ARE_ZERO, Some(ArithmeticDefect::DenormalsAreZero)),
            (FLUSH_TO_ZERO, Some(ArithmeticDefect::FlushToZero)),
            (
                FLUSH_TO_ZERO | DENORMALS_ARE_ZERO,
                Some(ArithmeticDefect::DenormalsAreZero),
            ),
            (DOWN, Some(ArithmeticDefect::Rounding)),
            (UP, Some(ArithmeticDefect::Rounding)),
            (TOWARDS_ZERO, Some(ArithmeticDefect::Rounding)),
        ] {
            assert_eq!(under(bits, found::<f64>), flaw, "f64, {bits:#x}");
            assert_eq!(under(bits, found::<f32>), flaw, "f32, {bits:#x}");
        }
    }

    #[test]
    fn a_world_is_refused_before_it_starts() {
        let mut store = Store::<f64, 1, 4, 1, 1>::new(Domain::open(), 1e-4, 0.1);
        store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
        store.add_grain(1, 0, [0.0; 3], 0.5, 0.5).unwrap();
        let law = HertzHistory {
            kn: 2e5,
            kt: 2.45e5,
            gamma_n: 0.0,
            gamma_t: 0.0,
            mu: 0.5,
        };
        let told = under(FLUSH_TO_ZERO, || start(&mut store.world(), &law));
        let flaw = ArithmeticDefect::FlushToZero;
        assert_eq!(told, Err(Error::Arithmetic { flaw }));
        assert!(told.unwrap_err().to_string().contains("flush-to-zero"));
        assert_eq!(start(&mut store.world(), &law), Ok(()));
    }
}

/// Double precision as a build would have it that allows products and sums to be fused, or that
/// keeps sums in the 64-bit mantissa of x87 before it rounds them.
#[derive(Clone, Copy, Debug, Default)]
struct Off<const FUSES: bool> {
    value: f64,
    /// The factors, where this is a product that is not yet rounded.
    product: Option<(f64, f64)>,
}

impl<const FUSES: bool> Off<FUSES> {
    const fn of(value: f64) -> Self {
        Self {
            value,
            product: None,
        }
    }
}

/// `a + b` rounded to 64 bits and then to 53.
fn rounded_twice(a: f64, b: f64) -> f64 {
    let sum = a + b;
    let part = sum - a;
    let rest = (a - (sum - part)) + (b - part);
    let last = f64::from_bits(sum.to_bits() + 1) - sum;
    // The rest in units of the 64th bit, to nearest even: adding and subtracting 1.5 2^52 rounds.
    let unit = last / 2048.0;
    let big = 6_755_399_441_055_744.0;
    let kept = ((rest / unit + big) - big) * unit;
    let tie = kept.abs() == 0.5 * last;
    if tie && sum.to_bits() & 1 == 1 {
        sum + kept.signum() * last
    } else {
        sum
    }
}

impl<const FUSES: bool> Add for Off<FUSES> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::of(if FUSES {
            self.value + other.value
        } else {
            rounded_twice(self.value, other.value)
        })
    }
}
impl<const FUSES: bool> Sub for Off<FUSES> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::of(match self.product {
            Some((a, b)) if FUSES => a.mul_add(b, -other.value),
            _ => self.value - other.value,
        })
    }
}
impl<const FUSES: bool> Mul for Off<FUSES> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            product: Some((self.value, other.value)),
        }
    }
}
impl<const FUSES: bool> Div for Off<FUSES> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self::of(self.value / other.value)
    }
}
impl<const FUSES: bool> Neg for Off<FUSES> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::of(-self.value)
    }
}
impl<const FUSES: bool> PartialEq for Off<FUSES> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}
impl<const FUSES: bool> PartialOrd for Off<FUSES> {
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        self.value.partial_cmp(&other.value)
    }
}
impl<const FUSES: bool> Real for Off<FUSES> {
    const ZERO: Self = Self::of(0.0);
    const ONE: Self = Self::of(1.0);
    const HALF: Self = Self::of(0.5);
    const EPSILON: Self = Self::of(f64::EPSILON);
    const MAX: Self = Self::of(f64::MAX);
    const LEAST: Self = Self::of(5e-324);
    const LEAST_NORMAL: Self = Self::of(f64::MIN_POSITIVE);
    const NAME: &'static str = "off";
    fn sqrt(self) -> Self {
        Self::of(self.value.sqrt())
    }
    fn from_f64(value: f64) -> Self {
        Self::of(value)
    }
    fn to_f64(self) -> f64 {
        self.value
    }
    fn from_count(count: u32) -> Self {
        Self::of(f64::from(count))
    }
    fn is_finite(self) -> bool {
        self.value.is_finite()
    }
    fn to_index(self) -> usize {
        self.value as usize
    }
    fn to_words(self) -> (u32, Option<u32>) {
        self.value.to_words()
    }
    fn from_words(low: u32, high: Option<u32>) -> Self {
        Self::of(f64::from_words(low, high))
    }
}

#[test]
fn builds_off_the_contract_are_found() {
    assert_eq!(found::<Off<true>>(), Some(ArithmeticDefect::Fused));
    assert_eq!(
        found::<Off<false>>(),
        Some(ArithmeticDefect::ExcessPrecision)
    );
}
