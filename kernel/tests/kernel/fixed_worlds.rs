//! Worlds in fixed point beside theory and beside `f64`, and what ends one that outgrows its type.

use bitgrain_kernel::conformance::{Room, World as Named, history};
use bitgrain_kernel::contact::{HertzHistory, HertzTsuji, Law};
use bitgrain_kernel::fixed_point::{I24F40, I32F32, I40F24};
use bitgrain_kernel::vec3::{dot, head};
use bitgrain_kernel::{Domain, Error, Group, Obstacle, Real, Store, World, start, step};

type Pair<R> = Store<R, 2, 4, 4, 1>;

/// A grain of diameter 1 and mass 1 on its way along x to another that rests, and the law's time step.
fn two<R: Real>(speed: f64, dt: f64) -> Box<Pair<R>> {
    let real = R::from_f64;
    let mut store = Box::new(Pair::<R>::new(Domain::open(), real(dt), real(0.1)));
    let group = store.add_group(Group::free([R::ZERO; 3])).unwrap();
    for (id, x) in [(1, 0.0), (2, 1.001)] {
        let place = [real(x), R::ZERO, R::ZERO];
        store.add_grain(id, group, place, R::HALF, R::ONE).unwrap();
    }
    store.world().grains.velocity[0][0] = real(speed);
    store
}

/// Speed of parting over the speed of approach.
fn restitution<R: Real, L: Law<R>>(law: &L, speed: f64, dt: f64) -> f64 {
    let mut store = two::<R>(speed, dt);
    let mut world = store.world();
    start(&mut world, law).unwrap();
    loop {
        step(&mut world, law).unwrap();
        let apart = world.grains.position[1][0] - world.grains.position[0][0];
        let leaves = world.grains.velocity[1][0] > world.grains.velocity[0][0];
        if apart > R::ONE && leaves {
            let [v, u] = [1, 0].map(|i: usize| world.grains.velocity[i][0].to_f64());
            return (v - u) / speed;
        }
    }
}

/// A collision takes some hundred steps. In each the overlap is wrong by a place or so, and the stiffness of 2e3 makes
/// that a force, which acts for a time step of 1e-3: the error of the restitution is some thousand places over the
/// speed. `f64` with the same time step is the exact answer.
#[test]
fn restitution_is_that_of_floats() {
    for speed in [0.25, 1.0] {
        for gamma in [0.0, 50.0, 300.0] {
            let exact = restitution(&history::<f64>(gamma), speed, 1e-3);
            let error = |found: f64, place: f64| {
                let bound = 2000.0 * place / speed;
                assert!(
                    (found - exact).abs() < bound,
                    "{gamma}: {found}, not {exact} +- {bound}"
                );
            };
            error(
                restitution(&history::<I32F32>(gamma), speed, 1e-3),
                I32F32::EPSILON.to_f64(),
            );
            error(
                restitution(&history::<I24F40>(gamma), speed, 1e-3),
                I24F40::EPSILON.to_f64(),
            );
        }
        // The law's own parameter, which it meets but for the time step.
        let law = HertzTsuji::<I32F32>::new(4e3, 0.3, 0.6, 0.5);
        let found = restitution(&law, speed, 1e-4);
        assert!((found - 0.6).abs() < 2e-3, "{found}");
    }
}

/// A ball that slides on a plane without damping ends rolling at 5/7 of its speed, whatever the friction: the rule of
/// angular momentum about the line of contact. The overlap shortens the lever by its part of the radius.
#[test]
fn sliding_ends_in_rolling() {
    fn end<R: Real>() -> [f64; 2] {
        let real = R::from_f64;
        let mut store = Box::new(Pair::<R>::new(Domain::open(), real(1e-3), real(0.1)));
        let group = store
            .add_group(Group::free([R::ZERO, R::ZERO, -R::ONE]))
            .unwrap();
        let up = [R::ZERO, R::ZERO, R::ONE];
        store
            .add_obstacle(Obstacle::plane([R::ZERO; 3], up))
            .unwrap();
        // At rest on the plane: kn sqrt(r) delta^1.5 is the weight.
        let delta = libm::pow(1.0 / (2e3 * libm::sqrt(0.5)), 2.0 / 3.0);
        let place = [R::ZERO, R::ZERO, real(0.5 - delta)];
        store.add_grain(1, group, place, R::HALF, R::ONE).unwrap();
        store.world().grains.velocity[0][0] = R::ONE;
        let law = history(50.0);
        let mut world = store.world();
        start(&mut world, &law).unwrap();
        for _ in 0..4000 {
            step(&mut world, &law).unwrap();
        }
        let grains = &world.grains;
        [grains.velocity[0][0], grains.spin[0][1]].map(R::to_f64)
    }
    let (exact, found, coarse) = (end::<f64>(), end::<I32F32>(), end::<I40F24>());
    assert!(
        (exact[0] - 5.0 / 7.0).abs() < 5e-3 && (0.5 * exact[1] - 5.0 / 7.0).abs() < 5e-3,
        "{exact:?}"
    );
    for k in 0..2 {
        // Four thousand steps, each with an error of a few places.
        assert!(
            (found[k] - exact[k]).abs() < 1e4 * I32F32::EPSILON.to_f64(),
            "{found:?} {exact:?}"
        );
        assert!(
            (coarse[k] - exact[k]).abs() < 1e4 * I40F24::EPSILON.to_f64(),
            "{coarse:?} {exact:?}"
        );
    }
}

/// Height of the centre of mass and kinetic energy of the free grains of a world.
fn state<R: Real>(world: &World<'_, R>) -> [f64; 2] {
    let rows = world
        .grains
        .position
        .iter()
        .zip(world.grains.velocity.iter());
    let (mut mass, mut height, mut energy) = (0.0, 0.0, 0.0);
    for ((x, v), group) in rows.zip(&*world.grains.group) {
        if *group == 0 {
            let m = v[3].to_f64();
            mass += m;
            height += m * x[2].to_f64();
            energy += 0.5 * m * dot(head(*v), head(*v)).to_f64();
        }
    }
    [height / mass, energy / mass]
}

/// Ten thousand steps of the collapse's free grains on its floor: centre of mass and energy beside `f64`.
#[test]
fn a_collapse_stays_beside_floats() {
    fn course<R: Real>() -> Vec<[f64; 2]> {
        let mut room = Box::new(Room::<R>::vacant());
        Named::CollapseHistory.lay(&mut room).unwrap();
        // Its free grains and its floor, with longer lists: more contacts meet in the end than a room has entries for.
        let from = room.world();
        let mut store = Box::new(Store::<R, 30, 200, 60, 5>::new(
            *from.domain,
            from.dt,
            from.skin,
        ));
        for group in from.grains.groups {
            store.add_group(*group).unwrap();
        }
        store.add_obstacle(from.obstacles[0]).unwrap();
        for (i, x) in from.grains.position.iter().enumerate() {
            let v = from.grains.velocity[i];
            let (id, group) = (from.grains.id[i], from.grains.group[i]);
            if group == 0 {
                store.add_grain(id, group, head(*x), x[3], v[3]).unwrap();
                *store.world().grains.velocity.last_mut().unwrap() = v;
            }
        }
        let law = history(50.0);
        let mut world = store.world();
        start(&mut world, &law).unwrap();
        let mut states = Vec::new();
        for n in 1..=10_000 {
            step(&mut world, &law).unwrap();
            if n % 100 == 0 {
                states.push(state(&world));
            }
        }
        states
    }
    let (exact, found) = (course::<f64>(), course::<I32F32>());
    let apart = |states: std::ops::Range<usize>, k: usize| {
        states
            .map(|n| (exact[n][k] - found[n][k]).abs())
            .fold(0.0, f64::max)
    };
    // While they fall and first meet: the error of rounding alone.
    assert!(apart(0..4, 0) < 1e-7 && apart(0..4, 1) < 1e-6);
    // Later contacts magnify every difference, and grains come to lie otherwise; the bed stays the same bed. Measured:
    // 0.007 d of its height and 0.002 of kinetic energy over mass, which was 2 at first.
    assert!(apart(0..100, 0) < 0.02, "{}", apart(0..100, 0));
    assert!(apart(0..100, 1) < 0.01, "{}", apart(0..100, 1));
}

#[test]
fn what_outgrows_the_type_ends_the_step() {
    // The spring of this contact pulls with a square beyond the range, though the spring itself is a number.
    let law = HertzHistory {
        kn: I32F32::new(1e6),
        kt: I32F32::new(1e8),
        gamma_n: I32F32::ZERO,
        gamma_t: I32F32::ZERO,
        mu: I32F32::HALF,
    };
    let mut store = two::<I32F32>(1.0, 1e-3);
    let mut world = store.world();
    world.grains.velocity[0][1] = I32F32::new(10.0);
    start(&mut world, &law).unwrap();
    let mut end = Ok(());
    for _ in 0..100 {
        end = step(&mut world, &law);
        if end.is_err() {
            break;
        }
    }
    assert_eq!(end, Err(Error::Overflow { id: 1 }));
    assert_eq!(step(&mut world, &law), Err(Error::NotStarted));
    // A speed whose square is no number is found, however short its way in a step is.
    let mut store = two::<I32F32>(1.0, 1e-7);
    store.world().grains.velocity[0][1] = I32F32::new(5e4);
    let started = start(&mut store.world(), &law);
    assert_eq!(started, Err(Error::Overflow { id: 1 }));
    // Numbers that the type has not are refused at once.
    let mut store = two::<I32F32>(1e10, 1e-3);
    assert_eq!(
        start(&mut store.world(), &law),
        Err(Error::Overflow { id: 1 })
    );
    // So are places from which differences would overflow, and bodies whose distances have no square.
    let far = I32F32::new(1e9);
    assert!(Domain::new([-far; 3], [far; 3], [false; 3]).is_err());
    let mut store = two::<I32F32>(1.0, 1e-3);
    store.world().grains.position[1][3] = I32F32::new(3e4);
    assert_eq!(
        start(&mut store.world(), &law),
        Err(Error::Overflow { id: 2 })
    );
}
