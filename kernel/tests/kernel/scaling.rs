//! What the scaling helper says of units that fit and of units that do not.

use bitgrain_kernel::fixed_point::{I24F40, I32F32, I40F24};
use bitgrain_kernel::scaling::{Scales, check};

/// Reduced units: diameter, density and gravity 1, and the stiffness of Kumar 2018.
const REDUCED: Scales = Scales {
    normal_stiffness: 2e5,
    tangential_stiffness: 2.45e5,
    damping: 792.0 * 0.3,
    radius: [0.45, 0.55],
    mass: [0.38, 0.7],
    overlap: 0.02,
    speed: 5.0,
    dt: 3e-4,
    extent: 60.0,
};

#[test]
fn reduced_units_fit() {
    let all = check::<I32F32>(&REDUCED).unwrap();
    let of = |name: &str| *all.iter().find(|m| m.product == name).unwrap();
    // 1.5e-3 is 2^-9.4 and has 32 - 10 bits; (2.45e5 * 0.02 + 237.6 * 5)^2 is 2^25.1 of 2^31.
    assert_eq!(of("v dt").below, 22);
    assert_eq!(of("q q").above, 5);
}

#[test]
fn what_does_not_fit_is_named_with_what_would_do() {
    let stiff = Scales {
        normal_stiffness: 2e9,
        tangential_stiffness: 1e9,
        ..REDUCED
    };
    let told = |scales: &Scales| check::<I32F32>(scales).unwrap_err().to_string();
    assert_eq!(
        told(&Scales {
            overlap: 0.1,
            dt: 1e-3,
            tangential_stiffness: 6e5,
            ..REDUCED
        }),
        "q q is 3.7e9, too large for I32F32; I40F24 would do"
    );
    // The square of a force is beyond every type.
    assert_eq!(
        told(&stiff),
        "q q is 4.0e14, too large for I32F32; no type would do: take units in which the grains' diameter, \
         their mass and gravity are near 1"
    );
}

/// Half a millimetre of glass, in metres, kilograms and seconds.
#[test]
fn si_units_are_refused() {
    let glass = Scales {
        normal_stiffness: 1e9,
        tangential_stiffness: 1e9,
        damping: 1e-3,
        radius: [2.5e-4, 2.5e-4],
        mass: [1.6e-7, 1.6e-7],
        overlap: 1e-6,
        speed: 1.0,
        dt: 1e-7,
        extent: 0.1,
    };
    for told in [
        check::<I40F24>(&glass).unwrap_err(),
        check::<I32F32>(&glass).unwrap_err(),
        check::<I24F40>(&glass).unwrap_err(),
    ] {
        assert_eq!(told.instead, None, "{told}");
    }
    for wrong in [f64::NAN, f64::INFINITY] {
        assert!(
            check::<I32F32>(&Scales {
                speed: wrong,
                ..REDUCED
            })
            .is_err()
        );
    }
}
