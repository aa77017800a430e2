//! The host's arithmetic, tested when a world is made: a program that was linked with fast-math,
//! or a library that left the rounding mode changed, would change every bit silently.

use core::hint::black_box;

use crate::error::{ArithmeticDefect, Error};
use crate::math::real::Real;

/// Tests the few operations that a machine outside the contract gets wrong; about twenty of them.
///
/// # Errors
/// [`Error::Arithmetic`], saying what is wrong.
#[inline(never)]
pub fn check_arithmetic<R: Real>() -> Result<(), Error> {
    // The negative control of the tests runs where this must fail.
    if cfg!(bitgrain_negative_control) {
        return Ok(());
    }
    // Integer arithmetic has no modes.
    if R::FIXED_POINT {
        return Ok(());
    }
    match flaw::<R>() {
        None => Ok(()),
        Some(flaw) => Err(Error::Arithmetic { flaw }),
    }
}

fn flaw<R: Real>() -> Option<ArithmeticDefect> {
    // Hidden from the compiler, so that nothing is evaluated at compile time.
    let one = black_box(R::ONE);
    let half = black_box(R::HALF);
    let ulp = black_box(R::EPSILON);
    let zero = R::ZERO.to_words();

    // The least of all numbers times the largest is a normal number again.
    if black_box(black_box(R::LEAST) * R::MAX).to_words() == zero {
        return Some(ArithmeticDefect::DenormalsAreZero);
    }
    if black_box(black_box(R::LEAST_NORMAL) * half).to_words() == zero {
        return Some(ArithmeticDefect::FlushToZero);
    }
    // To nearest, 1 is 1 still, and three quarters of a step above it are one step.
    let few = black_box(ulp * (half * half));
    let (up, down) = (black_box(one + few), black_box(one - few * half));
    let near = black_box(one + (few + few + few));
    if up != one || down != one || near != one + ulp || black_box(-one - few) != -one {
        return Some(ArithmeticDefect::Rounding);
    }
    // A sum that is first kept with more digits is rounded twice: the first rounding makes a false tie.
    let tie = black_box(ulp * half);
    let above = black_box(tie + tie * ulp * R::from_f64(256.0));
    if black_box(one + above) != one + ulp {
        return Some(ArithmeticDefect::ExcessPrecision);
    }
    // (1 + u)^2 - (1 + 2u) is u^2 if product and sum are rounded as one.
    let near = black_box(one + ulp);
    let far = black_box(one + (ulp + ulp));
    if black_box(near * near - far) != R::ZERO {
        return Some(ArithmeticDefect::Fused);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machine_keeps_the_contract() {
        assert_eq!(check_arithmetic::<f64>(), Ok(()));
        assert_eq!(check_arithmetic::<f32>(), Ok(()));
    }
}
