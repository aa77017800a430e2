//! The valid range of a number type: what moves slower than it can resolve is refused.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{Domain, Error, Group, Obstacle, Real, Store, start};

/// How fast something moves, or 0.
#[derive(Clone, Copy, Default)]
struct Speeds {
    gravity: f64,
    carried: f64,
    ball: f64,
}

/// Starts a world of two grains, one free and one carried, and a ball, in a box of this period, with
/// a time step of 1/4096.
fn begin<R: Real>(period: f64, speeds: Speeds) -> Result<(), Error> {
    let real = R::from_f64;
    let (lo, hi) = ([R::ZERO; 3], [period, 10.0, 10.0].map(real));
    let domain = Domain::new(lo, hi, [true, false, false])?;
    let mut store = Store::<R, 2, 8, 4, 2>::new(domain, real(1.0 / 4096.0), real(0.1));
    let down = [R::ZERO, R::ZERO, real(-speeds.gravity)];
    store.add_group(Group::free(down)).unwrap();
    store.add_group(Group::prescribed_velocity()).unwrap();
    let ball = Obstacle {
        velocity: [real(speeds.ball), R::ZERO, R::ZERO],
        ..Obstacle::sphere([6.0, 5.0, 5.0].map(real), R::ONE)
    };
    store.add_obstacle(ball).unwrap();
    for (id, group) in [(1, 0), (2, 1)] {
        let place = [2.0, f64::from(3 * id), 5.0].map(real);
        store.add_grain(id, group, place, R::HALF, R::HALF)?;
    }
    let mut world = store.world();
    world.grains.velocity[1][0] = real(speeds.carried);
    let gamma = R::ZERO;
    let law = HertzHistory {
        kn: real(2e3),
        kt: real(2e3),
        gamma_n: gamma,
        gamma_t: gamma,
        mu: R::HALF,
    };
    start(&mut world, &law)
}

/// The slowest that is taken, over 16 units in the last place of the period a step: 1 within the
/// rounding of the speed itself.
fn threshold<R: Real>(period: f64, at_speed: impl Fn(f64) -> Speeds) -> f64 {
    let unit = 16.0 * R::EPSILON.to_f64() * period * 4096.0;
    let taken = |ratio: f64| begin::<R>(period, at_speed(ratio * unit)).is_ok();
    assert!(taken(0.0) && taken(1.001) && !taken(0.999) && !taken(1e-3));
    unit
}

#[test]
fn what_moves_less_than_sixteen_units_in_the_last_place_is_refused() {
    let ball = |ball| Speeds {
        ball,
        ..Speeds::default()
    };
    let carried = |carried| Speeds {
        carried,
        ..Speeds::default()
    };
    // The speed of a fall through a radius of a half.
    let falls = |speed: f64| Speeds {
        gravity: speed * speed / 0.5,
        ..Speeds::default()
    };
    for period in [64.0, 1024.0] {
        // In single precision grains a period of 1024 wide fall too slowly, in double they do not.
        assert!(threshold::<f32>(period, ball) > 0.4 * period / 64.0);
        threshold::<f32>(period, carried);
        threshold::<f32>(period, falls);
        assert!(threshold::<f64>(period, ball) < 1e-7);
        threshold::<f64>(period, carried);
        threshold::<f64>(period, falls);
    }
    let one = |gravity| Speeds {
        gravity,
        ..Speeds::default()
    };
    assert_eq!(begin::<f32>(64.0, one(1.0)), Ok(()));
    let weak = Err(Error::GravityTooWeak { group: 0 });
    assert_eq!(begin::<f32>(1024.0, one(1.0)), weak);
    assert_eq!(begin::<f64>(1024.0, one(1.0)), Ok(()));
    let slow = Err(Error::ObstacleTooSlow { obstacle: 0 });
    assert_eq!(begin::<f32>(64.0, ball(0.1)), slow);
    let slow = Err(Error::TooSlow { id: 2 });
    assert_eq!(begin::<f32>(64.0, carried(0.1)), slow);
}
