//! What hosts do to a world between and within steps: forces of their own, and blows.

use bitgrain_kernel::{
    Clock, ContactHistory, Error, GrainState, Real, World, digest, nudge, remove, resume, save,
    start, step, step_with,
};

use crate::edits::{SKINS, law, row, steps};

type Vectors<R> = ([R; 3], [R; 3]);

fn with<R: Real>(
    world: &mut World<'_, R>,
    count: usize,
    mut external: impl FnMut(&GrainState<R>) -> Vectors<R>,
) -> Result<(), Error> {
    (0..count).try_for_each(|_| step_with(world, &law(), &mut external))
}

fn zero<R: Real>(sign: R) -> impl FnMut(&GrainState<R>) -> Vectors<R> {
    move |_| ([R::ZERO * sign; 3], [R::ZERO * sign; 3])
}

/// A force of zero, of either sign, changes no bit of any step.
fn nothing_changes_nothing<R: Real>() {
    for sign in [R::ONE, -R::ONE] {
        let (mut plain, mut pushed) = (row::<R>(0.03), row::<R>(0.03));
        let (mut plain, mut pushed) = (plain.world(), pushed.world());
        for _ in 0..60 {
            steps(&mut plain, 1).unwrap();
            with(&mut pushed, 1, zero(sign)).unwrap();
            assert_eq!(digest(&pushed), digest(&plain));
        }
    }
}

#[test]
fn a_force_of_zero_changes_no_bit() {
    nothing_changes_nothing::<f64>();
    nothing_changes_nothing::<f32>();
}

/// In a constant force F a grain that touches nothing gains F/m dt in each step, in the first half of it, since the
/// forces of the start are those of contacts; and a constant torque turns it in the same way.
#[test]
fn a_constant_force_gives_the_closed_form() {
    let mut store = row::<f64>(0.1);
    let mut world = store.world();
    let ([x, ..], before) = (world.grains.position[2], world.grains.velocity[2]);
    let (push, turn, n) = (0.25, 0.05, 40);
    let external = |grain: &GrainState<f64>| match grain.id {
        4 => ([push, 0.0, 0.0], [0.0, turn, 0.0]),
        _ => ([0.0; 3], [0.0; 3]),
    };
    with(&mut world, n, external).unwrap();
    let (dt, halves) = (1e-3, n as f64 - 0.5);
    let [.., radius] = world.grains.position[2];
    let mass = before[3];
    // Rounding of so many sums.
    let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
    assert!(near(world.grains.velocity[2][0], push / mass * dt * halves));
    let inertia = 0.4 * mass * radius * radius;
    assert!(near(world.grains.spin[2][1], turn / inertia * dt * halves));
    // Each step drifts at the velocity in its middle: 0, 1, 2, ... times F/m dt.
    let way = push / mass * dt * dt * (n * (n - 1) / 2) as f64;
    assert!(near(world.grains.position[2][0] - x, way));
    assert_eq!(world.grains.force[2][0], push);
}

/// A force on grains sees each once, by ascending id, and what it throws about has the same bits at every skin.
#[test]
fn forces_of_a_host_have_the_same_bits_at_every_skin() {
    let at = |skin| {
        let mut store = row::<f64>(skin);
        let mut world = store.world();
        let mut seen = Vec::new();
        let external = |grain: &GrainState<f64>| {
            seen.push((grain.place, grain.id, grain.group));
            // The drag of a wind that comes and goes across.
            let [x, y, _] = grain.velocity;
            let wind = if grain.position[0] < 3.0 { 18.0 } else { -18.0 };
            ([wind - x, -y, 0.0], [0.0, 0.0, -grain.spin[2]])
        };
        with(&mut world, 200, external).unwrap();
        assert_eq!(seen.len(), 800);
        assert_eq!(seen[..4], [(0, 1, 0), (1, 3, 0), (2, 4, 0), (3, 7, 1)]);
        digest(&world)
    };
    let first = at(SKINS[0]);
    let calm = |skin| {
        let mut store = row::<f64>(skin);
        let mut world = store.world();
        steps(&mut world, 200).unwrap();
        digest(&world)
    };
    assert_ne!(first, calm(SKINS[0]));
    for skin in SKINS {
        assert_eq!(at(skin), first, "{skin}");
    }
}

#[test]
fn a_force_that_is_no_number_is_found_at_its_grain() {
    for bad in [f64::NAN, f64::INFINITY] {
        for turns in [false, true] {
            let mut store = row::<f64>(0.03);
            let mut world = store.world();
            let external = |grain: &GrainState<f64>| {
                let v = [0.0, if grain.id == 3 { bad } else { 0.0 }, 0.0];
                if turns { ([0.0; 3], v) } else { (v, [0.0; 3]) }
            };
            let fault = with(&mut world, 1, external);
            assert_eq!(fault, Err(Error::NotFinite { id: 3 }));
            assert_eq!(step(&mut world, &law()), Err(Error::NotStarted));
        }
    }
}

/// After a fault of the motion a world has no state: nothing reads one, and nothing goes on from it.
#[test]
fn a_fault_leaves_no_state() {
    type Act = fn(&mut World<'_, f64>) -> Result<(), Error>;
    let faults: [(Act, Error); 3] = [
        (
            |world| with(world, 1, |_| ([f64::NAN; 3], [0.0; 3])),
            Error::NotFinite { id: 1 },
        ),
        (
            |world| {
                nudge(world, 1, [400.0, 0.0, 0.0], [0.0; 3])?;
                steps(world, 10)
            },
            Error::OverlapTooDeep { i: 3, j: 4 },
        ),
        (
            |world| {
                world.obstacles[1].velocity[0] = 1e4;
                steps(world, 1)
            },
            Error::ObstacleTooFast { obstacle: 1 },
        ),
    ];
    for (act, fault) in faults {
        let mut store = row::<f64>(0.03);
        let mut world = store.world();
        steps(&mut world, 5).unwrap();
        let histories: Vec<ContactHistory<f64>> = world.contact_histories().collect();
        assert!(world.clock.has_state());
        assert_eq!(act(&mut world), Err(fault));
        world.obstacles[1].velocity[0] = 0.0;
        let refused = Err(Error::NotStarted);
        assert!(!world.clock.has_state());
        assert_eq!(digest(&world).err(), refused.err());
        assert_eq!(save(&mut world, &mut [0; 9000]), Err(Error::NotStarted));
        assert_eq!(step(&mut world, &law()), refused);
        assert_eq!(start(&mut world, &law()), refused);
        assert_eq!(resume(&mut world, histories), refused);
        assert_eq!(nudge(&mut world, 1, [0.0; 3], [0.0; 3]), refused);
        assert_eq!(remove(&mut world, &[1]), refused);
        // What is added does not make it a state.
        store.add_grain(9, 0, [5.0; 3], 0.5, 0.5).unwrap();
        assert!(!store.world().clock.has_state());
        // Another clock is of another world, which begins with what stands in the rows.
        *store.world().clock = Clock::default();
        assert!(store.world().clock.has_state());
    }
}

/// A blow is what a write and a new start with all histories is, at every skin, whether it is hard or soft.
#[test]
fn a_nudge_is_an_edit_and_a_resume() {
    for blow in [0.01, 25.0] {
        let run = |skin, resumes: bool| {
            let mut store = row::<f64>(skin);
            let mut world = store.world();
            steps(&mut world, 20).unwrap();
            for (place, spin) in [(1, 3.0), (0, -2.0), (1, 1.0)] {
                let [_, y, z, mass] = world.grains.velocity[place];
                if resumes {
                    let histories: Vec<ContactHistory<f64>> = world.contact_histories().collect();
                    world.grains.velocity[place] = [blow, y, z, mass];
                    world.grains.spin[place][1] = spin;
                    resume(&mut world, histories).unwrap();
                } else {
                    let [x, _, last, _] = world.grains.spin[place];
                    nudge(&mut world, place, [blow, y, z], [x, spin, last]).unwrap();
                }
            }
            let rebuilt = world.clock.prunes();
            steps(&mut world, 60).unwrap();
            (digest(&world), rebuilt)
        };
        let first = run(SKINS[0], true).0;
        for skin in SKINS {
            assert_eq!(run(skin, true).0, first, "{skin}");
            assert_eq!(run(skin, false).0, first, "{skin}");
        }
        // It lists no pairs.
        assert!(run(0.1, false).1 < run(0.1, true).1);
    }
}

#[test]
fn a_nudge_that_cannot_be_changes_nothing() {
    let mut store = row::<f64>(0.03);
    let mut world = store.world();
    steps(&mut world, 3).unwrap();
    let before = (digest(&world), *world.clock);
    let still = [0.0; 3];
    for (place, velocity, spin, fault) in [
        (4, still, still, Error::NoGrain { place: 4 }),
        (1, [f64::NAN, 0.0, 0.0], still, Error::NotFinite { id: 3 }),
        (
            1,
            still,
            [0.0, 0.0, f64::INFINITY],
            Error::NotFinite { id: 3 },
        ),
        // It is carried, and would move by less than 16 units in the last place of 12.
        (3, [1e-12, 0.0, 0.0], still, Error::TooSlow { id: 7 }),
        // Half a diameter in a step of 1e-3.
        (1, [501.0, 0.0, 0.0], still, Error::TooFast { id: 3 }),
    ] {
        assert_eq!(nudge(&mut world, place, velocity, spin), Err(fault));
        assert_eq!((digest(&world), *world.clock), before);
    }
    steps(&mut world, 3).unwrap();
    // What was written to beside it is found.
    world.grains.velocity[0][2] = 0.5;
    nudge(&mut world, 1, still, still).unwrap();
    assert_eq!(step(&mut world, &law()), Err(Error::Edited));
    world.clock.stop();
    assert_eq!(nudge(&mut world, 1, still, still), Err(Error::NotStarted));
}

/// Numbers of errors never change: a host in another language has them in its source.
#[test]
fn errors_have_their_numbers() {
    let flaw = bitgrain_kernel::ArithmeticDefect::FlushToZero;
    let bent = bitgrain_kernel::ObstacleDefect::Tilted;
    let (id, obstacle, needed, place) = (1, 2, 3, 4);
    for (code, error) in [
        (1, Error::BadDomain { axis: 0 }),
        (2, Error::PeriodTooShort { axis: 0 }),
        (3, Error::BadStorage),
        (4, Error::BadOrder { id }),
        (5, Error::BadGrain { id }),
        (
            6,
            Error::BadObstacle {
                obstacle,
                flaw: bent,
            },
        ),
        (7, Error::BadTimeStep),
        (8, Error::Arithmetic { flaw }),
        (9, Error::TooSlow { id }),
        (10, Error::ObstacleTooSlow { obstacle }),
        (11, Error::GravityTooWeak { group: 0 }),
        (12, Error::BadContactHistory),
        (13, Error::BadSave),
        (14, Error::OtherVersion),
        (15, Error::OtherFacets { obstacle }),
        (16, Error::UnknownMaterial { material: 0 }),
        (17, Error::LawMisfit),
        (20, Error::PairListFull { needed }),
        (21, Error::OuterListFull { needed }),
        (22, Error::ObstacleContactsFull { needed }),
        (23, Error::BufferTooShort { needed }),
        (24, Error::GrainsFull { needed }),
        (30, Error::Overflow { id }),
        (31, Error::ObstacleOverflow { obstacle }),
        (32, Error::NotFinite { id }),
        (33, Error::ObstacleNotFinite { obstacle }),
        (34, Error::ObstacleTooFast { obstacle }),
        (35, Error::TooFast { id }),
        (36, Error::Escaped { id }),
        (37, Error::OverlapTooDeep { i: 1, j: 2 }),
        (38, Error::ObstacleTooDeep { id, obstacle }),
        (50, Error::NotStarted),
        (51, Error::Edited),
        (52, Error::NoGrain { place }),
        (53, Error::UnknownGrain { id }),
        (54, Error::GrainsLeaving),
    ] {
        assert_eq!(error.code(), code, "{error}");
    }
}
