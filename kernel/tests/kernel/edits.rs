//! Rows are read-only between two steps: one that was written to is found at every skin, and after
//! an edit that the kernel was told of a run has the same bits at every skin.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::phases::seal;
use bitgrain_kernel::phases::{MotionPhase, integrate};
use bitgrain_kernel::phases::{begin, drift, end, ensure_pair_list, ensure_pair_list_ahead};
use bitgrain_kernel::{
    ContactHistory, Digest, Domain, Error, Group, Obstacle, Real, Shape, Store, World, digest,
    resume, start, step,
};

/// From none to one that lists every pair.
pub const SKINS: [f64; 5] = [0.0, 0.006, 0.03, 0.1, 1.0];

pub type Five<R> = Store<R, 5, 16, 16, 2>;

pub fn law<R: Real>() -> HertzHistory<R> {
    let [kn, kt, gamma, mu] = [2e4, 2.45e4, 50.0, 0.5].map(R::from_f64);
    HertzHistory {
        kn,
        kt,
        gamma_n: gamma,
        gamma_t: gamma,
        mu,
    }
}

/// Three grains in a row, the first two in touch and the third 0.01 from them, over a floor; another one
/// carried beside them, and a ball.
pub fn row<R: Real>(skin: f64) -> Five<R> {
    let real = |v: [f64; 3]| v.map(R::from_f64);
    let domain = Domain::new(real([0.0; 3]), real([12.0, 8.0, 8.0]), [true, true, false]);
    let mut store = Five::new(domain.unwrap(), R::from_f64(1e-3), R::from_f64(skin));
    store
        .add_group(Group::free(real([0.0, 0.0, -1.0])))
        .unwrap();
    store.add_group(Group::prescribed_velocity()).unwrap();
    let mut add = |id: u32, group: u8, place: [f64; 3]| {
        let added = store.add_grain(id, group, real(place), R::HALF, R::HALF);
        added.unwrap();
    };
    add(1, 0, [2.0, 4.0, 1.0]);
    add(3, 0, [2.999, 4.0, 1.0]);
    add(4, 0, [4.009, 4.0, 1.0]);
    add(7, 1, [2.0, 5.2, 1.0]);
    let floor = Obstacle::plane([R::ZERO; 3], real([0.0, 0.0, 1.0]));
    store.add_obstacle(floor).unwrap();
    let ball = Obstacle::sphere(real([8.0, 4.0, 2.0]), R::HALF);
    store.add_obstacle(ball).unwrap();
    start(&mut store.world(), &law()).unwrap();
    store
}

pub fn steps<R: Real>(world: &mut World<'_, R>, count: usize) -> Result<(), Error> {
    (0..count).try_for_each(|_| step(world, &law()))
}

/// What becomes of a world that is edited after 20 steps, and its state 60 steps later.
fn edited(
    skin: f64,
    edit: impl Fn(&mut World<'_, f64>),
) -> (Result<(), Error>, Result<Digest, Error>) {
    let mut store = row::<f64>(skin);
    let mut world = store.world();
    steps(&mut world, 20).unwrap();
    edit(&mut world);
    let went = steps(&mut world, 60);
    (went, digest(&world))
}

/// Edits of what the bound of the next travel is made from: without the refusal each of them gives other
/// bits at other skins.
fn throws() -> [fn(&mut World<'_, f64>); 2] {
    [
        |world| world.grains.velocity[1][0] = 25.0,
        |world| world.grains.force[1][0] = 25_000.0,
    ]
}

#[test]
fn what_is_written_between_two_steps_is_refused_at_every_skin() {
    for throw in throws() {
        let first = edited(SKINS[0], throw);
        assert_eq!(first.0, Err(Error::Edited));
        for skin in SKINS {
            assert_eq!(edited(skin, throw), first, "skin {skin}");
        }
    }
}

#[test]
fn after_an_edit_and_a_resume_every_skin_has_the_same_bits() {
    for throw in throws() {
        let taken_up = |world: &mut World<'_, f64>| {
            let histories: Vec<ContactHistory<f64>> = world.contact_histories().collect();
            throw(world);
            resume(world, histories).unwrap();
        };
        let first = edited(SKINS[0], taken_up);
        assert_eq!(first.0, Ok(()));
        assert_ne!(first, edited(SKINS[0], |_| {}), "the edit has an effect");
        for skin in SKINS {
            assert_eq!(edited(skin, taken_up), first, "skin {skin}");
        }
    }
}

/// An edit of a store's world: it must be found, and what puts it back must be too.
fn found<R: Real>(what: &str, edit: impl Fn(&mut World<'_, R>)) {
    let mut store = row::<R>(0.03);
    let mut world = store.world();
    steps(&mut world, 3).unwrap();
    edit(&mut world);
    let before = (digest(&world), *world.clock);
    for _ in 0..2 {
        assert_eq!(step(&mut world, &law()), Err(Error::Edited), "{what}");
    }
    assert_eq!((digest(&world), *world.clock), before, "{what}");
    start(&mut world, &law()).unwrap();
    assert_eq!(steps(&mut world, 3), Ok(()), "{what}");
}

fn every_edit_is_found<R: Real>() {
    for i in 0..4 {
        for a in 0..4 {
            // By one unit in the last place, or from 0.0 to -0.0.
            let nudge = |x: &mut R| {
                *x = if *x == R::ZERO {
                    -*x
                } else {
                    *x + *x * R::EPSILON
                }
            };
            let name = |what: &str| format!("{what} {i} {a}");
            let at = |row: usize| (i, a, row);
            let rows = ["position", "velocity", "spin", "force", "torque"];
            for (row, what) in rows.into_iter().enumerate() {
                let (i, a, row) = at(row);
                found::<R>(&name(what), |world| {
                    let g = &mut world.grains;
                    let rows = [&mut *g.position, g.velocity, g.spin, g.force, g.torque];
                    let [x, v, w, force, torque] = rows;
                    nudge(&mut [x, v, w, force, torque][row][i][a]);
                });
            }
        }
    }
    found::<R>("a point", |world| {
        world.obstacles[1].point[0] = R::from_f64(8.001)
    });
    found::<R>("a size", |world| {
        world.obstacles[1].shape = Shape::Sphere { radius: R::ONE }
    });
    found::<R>("a mass", |world| world.obstacles[1].inverse_mass = R::ONE);
    found::<R>("a material", |world| world.obstacles[1].material = 1);
    found::<R>("two obstacles", |world| world.obstacles.swap(0, 1));
    found::<R>("the time step", |world| world.dt = R::from_f64(1.1e-3));
    // All at once, in a way that a plain sum or an exclusive or would not see.
    found::<R>("mirrored", |world| {
        for v in world.grains.velocity.iter_mut() {
            v.iter_mut().take(2).for_each(|x| *x = -*x);
        }
    });
    found::<R>("swapped", |world| world.grains.velocity.swap(0, 2));
}

#[test]
fn every_edit_is_found_in_both_precisions() {
    every_edit_is_found::<f64>();
    every_edit_is_found::<f32>();
}

/// What is lent read-only may be lent otherwise the next time.
#[test]
fn another_table_or_box_is_found() {
    let mut store = row::<f64>(0.03);
    let wide = Domain::new([0.0; 3], [13.0, 8.0, 8.0], [true, true, false]).unwrap();
    let closed = Domain::new([0.0; 3], [12.0, 8.0, 8.0], [true; 3]).unwrap();
    let heavy = Group {
        infinite_mass: true,
        ..Group::prescribed_velocity()
    };
    let light = Group::free([0.0, 0.0, -0.5]);
    let free = Group::free([0.0, 0.0, -1.0]);
    let mut group = [0, 0, 1, 1];
    for k in 0..5 {
        let mut world = store.world();
        let (tables, others) = ([free, heavy], [light, Group::prescribed_velocity()]);
        match k {
            0 => world.domain = &wide,
            1 => world.domain = &closed,
            2 => world.grains.groups = &tables,
            3 => world.grains.groups = &others,
            _ => world.grains.group = &mut group,
        }
        assert_eq!(step(&mut world, &law()), Err(Error::Edited), "{k}");
        // As it was, it goes on.
        assert_eq!(step(&mut store.world(), &law()), Ok(()), "{k}");
    }
}

#[test]
fn what_may_change_between_two_steps_is_not_held_against_a_run() {
    let mut store = row::<f64>(0.03);
    steps(&mut store.world(), 5).unwrap();
    store.set_skin(0.2);
    store.set_outer_skin(0.1);
    let mut world = store.world();
    world.clock.step = 1_000_000;
    world.obstacles[1].velocity = [-4.0, 0.5, 0.0];
    world.obstacles[0].force = [7.0; 3];
    world.obstacles[0].torque = [7.0; 3];
    assert_eq!(steps(&mut world, 5), Ok(()));
    assert_eq!(world.clock.step, 1_000_005);
}

/// A host that leaves out a joint of a stretch is told, and nothing is computed from what it has.
#[test]
fn a_stretch_begins_and_ends() {
    let mut store = row::<f64>(0.03);
    let mut world = store.world();
    let sealed = seal(&world.grain_motion(), 0);
    let refused = Err(Error::NotStarted);
    // Not begun.
    assert_eq!(ensure_pair_list_ahead(&mut world), refused);
    assert_eq!(ensure_pair_list(&mut world), refused);
    assert_eq!(end(&mut world, sealed), refused);
    let still = integrate(&mut world.grain_motion(), MotionPhase::CheckOnly);
    assert_eq!(drift(&mut world, still), refused);
    // Begun with the seal of other rows, and with the right one.
    let elsewhere = seal(&world.grain_motion(), 1);
    assert_eq!(begin(&mut world, elsewhere), Err(Error::Edited));
    assert_eq!(begin(&mut world, sealed), Ok(()));
    // Not ended.
    assert_eq!(begin(&mut world, sealed), refused);
    // A step within it leaves it open.
    assert_eq!(step(&mut world, &law()), Ok(()));
    assert!(world.clock.has_begun() && !world.clock.rests());
    assert_eq!(begin(&mut world, sealed), refused);
    let sealed = seal(&world.grain_motion(), 0);
    assert_eq!(end(&mut world, sealed), Ok(()));
    assert_eq!(step(&mut world, &law()), Ok(()));
}

/// A list that was looked at is not looked at again before the forces are done: they would be summed twice.
#[test]
fn a_step_that_failed_is_not_gone_on_with() {
    let mut store = row::<f64>(0.03);
    let mut world = store.world();
    let sealed = seal(&world.grain_motion(), 0);
    begin(&mut world, sealed).unwrap();
    let passed = integrate(&mut world.grain_motion(), MotionPhase::Drift);
    drift(&mut world, passed).unwrap();
    assert_eq!(ensure_pair_list(&mut world), Ok(()));
    assert_eq!(ensure_pair_list(&mut world), Err(Error::NotStarted));
}
