//! Every operation of the fixed-point types against exact integers, and worlds computed with them.

use bitgrain_kernel::Real;
use bitgrain_kernel::fixed_point::{Fixed, I24F40, I32F32, I40F24, Places};
use fixed::FixedI64;
use proptest::prelude::*;

/// The exact number `n / d`, of any sign, rounded to the nearest integer, ties to even: by definition, not by bits.
fn nearest(n: i128, d: i128) -> i128 {
    let (n, d) = if d < 0 { (-n, -d) } else { (n, d) };
    let (floor, left) = (n.div_euclid(d), n.rem_euclid(d));
    match (2 * left).cmp(&d) {
        std::cmp::Ordering::Less => floor,
        std::cmp::Ordering::Greater => floor + 1,
        std::cmp::Ordering::Equal => floor + floor.rem_euclid(2),
    }
}

/// The bits that the number with these exact bits has: the mark beyond the range.
fn held(bits: i128) -> i64 {
    match bits.unsigned_abs() > i64::MAX as u128 {
        true => i64::MIN,
        false => bits as i64,
    }
}

/// Integers of all sizes, the edges among them.
fn bits() -> impl Strategy<Value = i64> {
    let edges = prop::sample::select(vec![
        0,
        1,
        -1,
        2,
        3,
        1 << 31,
        1 << 32,
        (1 << 32) + 1,
        -(1 << 32),
        3 << 31,
        1 << 40,
        1 << 62,
        i64::MAX,
        i64::MAX - 1,
        -i64::MAX,
        i64::MIN,
    ]);
    let sized = (any::<i64>(), 0..64u32).prop_map(|(n, down)| n >> down);
    // A few bits at any place: products and quotients with ties.
    let few = (-9..10i64, 0..60u32).prop_map(|(n, up)| n << up);
    prop_oneof![2 => edges, 6 => sized, 2 => few]
}

fn check<F: Places>(a: i64, b: i64) {
    let (x, y) = (Fixed::<F>::from_bits(a), Fixed::<F>::from_bits(b));
    let (p, q) = (i128::from(a), i128::from(b));
    let one = 1i128 << F::BITS;
    let mark = a == i64::MIN || b == i64::MIN;
    let is = |found: Fixed<F>, exact: Option<i128>, what: &str| {
        let wanted = exact.filter(|_| !mark).map_or(i64::MIN, held);
        assert_eq!(found.to_bits(), wanted, "{} {what} of {a} and {b}", F::NAME);
    };
    is(x + y, Some(p + q), "sum");
    is(x - y, Some(p - q), "difference");
    is(x * y, Some(nearest(p * q, one)), "product");
    is(x / y, (b != 0).then(|| nearest(p * one, q)), "quotient");
    assert_eq!((-x).to_bits(), if a == i64::MIN { a } else { -a });
    assert_eq!(x < y, !mark && a < b);
    assert_eq!(x <= y, !mark && a <= b);
    assert_eq!(x > y, !mark && a > b);
    assert_eq!(x >= y, !mark && a >= b);
    assert_eq!(x == y, !mark && a == b);
    assert_eq!(x.partial_cmp(&y), (!mark).then(|| a.cmp(&b)));
    assert_eq!(x.carry(y).to_bits(), if b == i64::MIN { b } else { a });
    // The root is the integer whose square is nearest: r - 1/2 < sqrt(n) < r + 1/2, all times two and squared.
    let r = i128::from(x.sqrt().to_bits());
    if a < 0 {
        assert_eq!(r, i128::from(i64::MIN));
    } else {
        let four = 4 * p * one;
        assert!(r >= 0 && (2 * r + 1) * (2 * r + 1) > four, "root of {a}");
        assert!(r == 0 || (2 * r - 1) * (2 * r - 1) < four, "root of {a}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, ..Default::default() })]

    #[test]
    fn every_operation_is_rounded_once(a in bits(), b in bits()) {
        check::<fixed::types::extra::U24>(a, b);
        check::<fixed::types::extra::U32>(a, b);
        check::<fixed::types::extra::U40>(a, b);
    }

    /// Products and quotients of numbers as worlds have them, beside `f64`: half a place and the float's own error.
    #[test]
    fn numbers_are_those_of_floats(a in -1e4..1e4f64, b in 1e-3..1e4f64) {
        let (x, y) = (I32F32::new(a), I32F32::new(b));
        let place = I32F32::EPSILON.to_f64();
        prop_assert!((x.to_f64() - a).abs() <= 0.5 * place);
        let (a, b) = (x.to_f64(), y.to_f64());
        prop_assert!(((x * y).to_f64() - a * b).abs() <= 0.5 * place + 1e-15 * (a * b).abs());
        prop_assert!(((x / y).to_f64() - a / b).abs() <= 0.5 * place + 1e-15 * (a / b).abs());
        prop_assert!((y.sqrt().to_f64() - b.sqrt()).abs() <= 0.5 * place + 1e-15 * b);
    }

    /// A float becomes the nearest number: the crate `fixed` rounds the same way.
    #[test]
    fn floats_become_the_nearest_number(value in prop_oneof![
        any::<f64>(),
        -3e9..3e9f64,
        -1e-9..1e-9f64,
        (-99..99i32, -36..0i32).prop_map(|(n, p)| f64::from(n) * 2f64.powi(p)),
    ]) {
        let found = I32F32::new(value);
        let wanted = FixedI64::<fixed::types::extra::U32>::checked_from_num(value).map(FixedI64::to_bits);
        prop_assert_eq!(found.to_bits(), wanted.unwrap_or(i64::MIN), "{}", value);
        prop_assert_eq!(I32F32::from_f64(value).to_bits(), found.to_bits());
    }
}

#[test]
fn counts_and_cells() {
    assert_eq!(I32F32::from_count(1 << 20).to_f64(), f64::from(1 << 20));
    assert_eq!(I24F40::from_count(7).to_f64(), 7.0);
    assert_eq!(I40F24::new(41.9).to_index(), 41);
    assert_eq!(I40F24::new(-0.1).to_index(), 0);
    assert_eq!(I40F24::from_bits(i64::MIN).to_index(), 0);
    assert_eq!(
        format!("{:?} {:?}", I32F32::new(-1.5), I32F32::new(f64::NAN)),
        "-1.5 overflow"
    );
}
