//! Grains that come, go and change their group between two steps.

use bitgrain_kernel::{
    Cause, ContactHistory, Departure, Digest, Domain, Drain, Error, Group, LossPolicy, NewGrain,
    Obstacle, Real, Store, World, digest, insert, nudge, regroup, remove, resume, start, step,
    take_out,
};

use crate::edits::{SKINS, law, steps};

type Bed<R> = Store<R, 12, 80, 24, 3>;

/// A heap of nine grains in a corner, ids 2, 4, ..., 18, the last two frozen and touching; it slides and falls.
fn heap<R: Real>(skin: f64) -> Bed<R> {
    let real = |v: [f64; 3]| v.map(R::from_f64);
    let domain = Domain::new(real([0.0; 3]), real([6.0, 6.0, 9.0]), [true, true, false]);
    let mut bed = Bed::new(domain.unwrap(), R::from_f64(1e-3), R::from_f64(skin));
    bed.add_group(Group::free(real([0.3, 0.0, -1.0]))).unwrap();
    bed.add_group(Group::frozen()).unwrap();
    bed.add_obstacle(Obstacle::plane([R::ZERO; 3], real([0.0, 0.0, 1.0])))
        .unwrap();
    let ball = Obstacle::sphere(real([4.5, 3.0, 0.5]), R::HALF);
    bed.add_obstacle(ball).unwrap();
    for k in 0..9u32 {
        let (layer, place) = (f64::from(k / 3), f64::from(k % 3));
        let x = [1.0 + 0.999 * place, 2.0, 0.4995 + 0.999 * layer];
        let group = u8::from(k >= 7);
        bed.add_grain(2 * k + 2, group, real(x), R::HALF, R::HALF)
            .unwrap();
    }
    start(&mut bed.world(), &law()).unwrap();
    bed
}

fn new<R: Real>(id: u32, position: [f64; 3]) -> NewGrain<R> {
    let real = |v: [f64; 3]| v.map(R::from_f64);
    NewGrain {
        id,
        group: 0,
        position: real(position),
        radius: R::from_f64(0.4),
        mass: R::from_f64(0.3),
        velocity: real([0.1, 0.0, -0.5]),
        spin: real([0.0, 2.0, 0.0]),
    }
}

/// Whatever can be done to a world without a new start.
fn edits<R: Real>(bed: &mut Bed<R>, round: usize) {
    match round {
        // In the middle, at the beginning and at the end, one of them in touch with the heap.
        0 => {
            let rain = [
                new(1, [1.0, 4.5, 3.0]),
                new(9, [1.0, 2.85, 1.4985]),
                new(40, [2.8, 4.5, 3.0]),
            ];
            bed.insert(rain).unwrap();
        }
        1 => remove(&mut bed.world(), &[4, 9, 14]).unwrap(),
        2 => regroup(&mut bed.world(), &[1, 6, 8], 1).unwrap(),
        3 => {
            let mut world = bed.world();
            let place = world.place_of(40).unwrap();
            let v = [R::HALF, R::ZERO, R::ONE];
            nudge(&mut world, place, v, [R::ZERO; 3]).unwrap();
        }
        4 => regroup(&mut bed.world(), &[1, 6, 16, 18], 0).unwrap(),
        _ => bed.insert([new(3, [2.0, 4.5, 3.0])]).unwrap(),
    }
}

/// All that a world holds, put into a new store of another skin by hand and taken up again: what an edit must equal.
fn again<R: Real>(bed: &mut Bed<R>, skin: f64) -> Bed<R> {
    let world = bed.world();
    let mut other = Bed::new(*world.domain, world.dt, R::from_f64(skin));
    for group in world.grains.groups {
        other.add_group(*group).unwrap();
    }
    for body in world.obstacles.iter() {
        other.add_obstacle(*body).unwrap();
    }
    let histories: Vec<ContactHistory<R>> = world.contact_histories().collect();
    let g = &world.grains;
    for i in 0..g.count() {
        let [x, y, z, radius] = g.position[i];
        let added = other.add_grain(g.id[i], g.group[i], [x, y, z], radius, g.velocity[i][3]);
        added.unwrap();
    }
    let mut taken = other.world();
    taken.grains.velocity.copy_from_slice(g.velocity);
    taken.grains.spin.copy_from_slice(g.spin);
    taken.grains.force.copy_from_slice(g.force);
    taken.grains.torque.copy_from_slice(g.torque);
    taken.grains.image.copy_from_slice(g.image);
    taken.clock.step = world.clock.step;
    resume(&mut taken, histories).unwrap();
    other
}

/// After each edit and the steps after it: the state and the ids.
fn run<R: Real>(skin: f64, cut: Option<f64>) -> Vec<(Digest, Vec<u32>)> {
    let mut bed = heap::<R>(skin);
    let mut seen = Vec::new();
    for round in 0..6 {
        steps(&mut bed.world(), 120).unwrap();
        edits(&mut bed, round);
        let look = |world: &World<'_, R>| (digest(world).unwrap(), world.grains.id.to_vec());
        seen.push(look(&bed.world()));
        if let Some(skin) = cut {
            bed = again(&mut bed, skin);
            seen.push(look(&bed.world()));
        }
        steps(&mut bed.world(), 40).unwrap();
        seen.push(look(&bed.world()));
    }
    seen
}

fn edits_have_the_same_bits<R: Real>() {
    let first = run::<R>(SKINS[0], None);
    let ids: Vec<u32> = (1..=9).map(|k| 2 * k).collect();
    assert_eq!(first[0].1[..3], [1, 2, 4]);
    assert_eq!(first[2].1, [1, 2, 6, 8, 10, 12, 16, 18, 40]);
    assert_ne!(first[2].1, ids);
    for skin in SKINS {
        assert_eq!(run::<R>(skin, None), first, "{skin}");
    }
    let mut cut = run::<R>(SKINS[0], Some(0.1));
    // A state that was put by hand is that of the edit: it stands there twice.
    for round in (0..6).rev() {
        let at = 3 * round;
        assert_eq!(cut[at], cut[at + 1], "{round}");
        cut.remove(at);
    }
    assert_eq!(cut, first);
}

#[test]
fn edits_have_the_same_bits_at_every_skin_and_cut() {
    edits_have_the_same_bits::<f64>();
    edits_have_the_same_bits::<f32>();
}

/// The springs of contacts that no edit ends.
#[test]
fn histories_of_others_stay() {
    let springs = |bed: &mut Bed<f64>| {
        let world = bed.world();
        let id = |place: u32| world.grains.id[place as usize];
        let named = world.contact_histories().map(|history| match history {
            ContactHistory::Pair { i, j, spring } => (id(i), id(j), spring),
            ContactHistory::Obstacle {
                i,
                obstacle,
                spring,
            } => (id(i), 1000 + obstacle, spring),
        });
        named.collect::<Vec<_>>()
    };
    let mut bed = heap::<f64>(0.05);
    steps(&mut bed.world(), 60).unwrap();
    let before = springs(&mut bed);
    let stretched = before.iter().filter(|s| s.2 != [0.0; 3]).count();
    assert!(stretched > 6, "{before:?}");
    bed.insert([new(5, [1.0, 4.5, 3.0])]).unwrap();
    assert_eq!(springs(&mut bed), before);
    remove(&mut bed.world(), &[5, 8]).unwrap();
    let kept = |s: &&(u32, u32, [f64; 3])| s.0 != 8 && s.1 != 8;
    let left: Vec<_> = before.iter().filter(kept).copied().collect();
    assert!(left.len() < before.len());
    assert_eq!(springs(&mut bed), left);
    // Two heavy grains have no contact, nor has a heavy one with the floor.
    regroup(&mut bed.world(), &[2, 4], 1).unwrap();
    let heavy = |id: u32| id == 2 || id == 4 || id >= 1000;
    let light = |s: &&(u32, u32, [f64; 3])| !(heavy(s.0) && heavy(s.1));
    let free: Vec<_> = left.iter().filter(light).copied().collect();
    assert!(free.len() < left.len());
    assert_eq!(springs(&mut bed), free);
}

/// Removing searches for no neighbours; one call that inserts or regroups does once.
#[test]
fn what_edits_cost() {
    let mut bed = heap::<f64>(0.05);
    steps(&mut bed.world(), 10).unwrap();
    let searches = |bed: &mut Bed<f64>| bed.world().clock.outer_list_rebuilds();
    let before = searches(&mut bed);
    remove(&mut bed.world(), &[2]).unwrap();
    step(&mut bed.world(), &law()).unwrap();
    assert_eq!(searches(&mut bed), before);
    bed.insert([new(1, [1.0, 4.5, 3.0]), new(3, [2.0, 4.5, 3.0])])
        .unwrap();
    assert_eq!(searches(&mut bed), before + 1);
    regroup(&mut bed.world(), &[1, 3], 1).unwrap();
    assert_eq!(searches(&mut bed), before + 2);
}

/// Each is refused with its reason, and what comes after is as if it had not been tried.
#[test]
fn edits_that_cannot_be_change_nothing() {
    let mut bed = heap::<f64>(0.05);
    let mut calm = heap::<f64>(0.05);
    steps(&mut bed.world(), 30).unwrap();
    steps(&mut calm.world(), 30).unwrap();
    let fine = new::<f64>(5, [1.0, 4.5, 3.0]);
    let with = |change: fn(&mut NewGrain<f64>)| {
        let mut grain = fine;
        change(&mut grain);
        grain
    };
    for (grain, fault) in [
        (with(|g| g.id = 8), Error::BadOrder { id: 8 }),
        (with(|g| g.group = 2), Error::BadGrain { id: 5 }),
        (with(|g| g.radius = 0.0), Error::BadGrain { id: 5 }),
        (with(|g| g.mass = f64::NAN), Error::BadGrain { id: 5 }),
        (with(|g| g.spin[1] = f64::NAN), Error::NotFinite { id: 5 }),
        (with(|g| g.position[2] = 9.5), Error::Escaped { id: 5 }),
        (with(|g| g.position[0] = 6.0), Error::Escaped { id: 5 }),
        (with(|g| g.velocity[0] = 400.1), Error::TooFast { id: 5 }),
        (with(|g| g.radius = 3.1), Error::PeriodTooShort { axis: 0 }),
        (
            with(|g| g.position[2] = 0.1),
            Error::ObstacleTooDeep { id: 5, obstacle: 0 },
        ),
        (
            with(|g| g.position = [1.1, 2.0, 0.6]),
            Error::OverlapTooDeep { i: 2, j: 5 },
        ),
    ] {
        assert_eq!(bed.insert([grain]), Err(fault));
        // Among others that are sound, too.
        let three = [new(1, [1.0, 4.5, 4.0]), grain, new(50, [2.0, 4.5, 4.0])];
        assert!(bed.insert(three).is_err());
    }
    let two = [fine, new(4, [2.0, 4.5, 4.0])];
    assert_eq!(bed.insert(two), Err(Error::BadOrder { id: 4 }));
    let many: Vec<_> = (0..4).map(|k| new(100 + k, [1.0; 3])).collect();
    assert_eq!(
        bed.insert(many.iter().copied()),
        Err(Error::GrainsFull { needed: 13 })
    );
    let no_rows = insert(&mut bed.world(), [fine]);
    assert_eq!(no_rows, Err(Error::BadStorage));

    let mut world = bed.world();
    let unknown = Err(Error::UnknownGrain { id: 7 });
    assert_eq!(remove(&mut world, &[4, 7]), unknown);
    assert_eq!(regroup(&mut world, &[7], 0), unknown);
    let order = Err(Error::BadOrder { id: 4 });
    assert_eq!(remove(&mut world, &[6, 4]), order);
    assert_eq!(remove(&mut world, &[4, 4]), order);
    assert_eq!(regroup(&mut world, &[6, 4], 0), order);
    assert_eq!(regroup(&mut world, &[6], 2), Err(Error::BadGrain { id: 6 }));
    assert_eq!(digest(&world), digest(&calm.world()));
    for _ in 0..30 {
        step(&mut bed.world(), &law()).unwrap();
        step(&mut calm.world(), &law()).unwrap();
        assert_eq!(digest(&bed.world()), digest(&calm.world()));
    }
    // What was written to is not sealed by an edit.
    bed.world().grains.velocity[0][0] = 0.5;
    assert_eq!(bed.insert([fine]), Err(Error::Edited));
    assert_eq!(remove(&mut bed.world(), &[4]), Err(Error::Edited));
    assert_eq!(regroup(&mut bed.world(), &[4], 1), Err(Error::Edited));
    bed.world().clock.stop();
    assert_eq!(bed.insert([fine]), Err(Error::NotStarted));
    assert_eq!(remove(&mut bed.world(), &[4]), Err(Error::NotStarted));
}

/// A full list: grains that find no room for their pairs do not come, and a group is not changed.
#[test]
fn a_full_list_refuses_an_edit() {
    let mut bed = Store::<f64, 4, 5, 1, 2>::new(Domain::open(), 1e-3, 3.0);
    bed.add_group(Group::free([0.0; 3])).unwrap();
    bed.add_group(Group::frozen()).unwrap();
    for k in 0..3u32 {
        let x = [1.2 * f64::from(k), 0.0, 0.0];
        bed.add_grain(k, 1, x, 0.5, 0.5).unwrap();
    }
    start(&mut bed.world(), &law()).unwrap();
    bed.insert([new(3, [3.6, 0.0, 0.0])]).unwrap();
    remove(&mut bed.world(), &[3]).unwrap();
    let before = digest(&bed.world());
    bed.set_skin(0.0);
    bed.set_outer_skin(9.0);
    regroup(&mut bed.world(), &[0, 1, 2], 0).unwrap();
    let six = bed.insert([new(3, [3.6, 0.0, 0.0])]);
    assert_eq!(six, Err(Error::OuterListFull { needed: 6 }));
    assert_eq!(digest(&bed.world()), before);
    assert_eq!(bed.world().grains.group, [0, 0, 0]);
    regroup(&mut bed.world(), &[0, 1, 2], 1).unwrap();
    bed.insert([new(3, [3.6, 0.0, 0.0])]).unwrap();
    let full = regroup(&mut bed.world(), &[0, 1, 2], 0);
    assert_eq!(full, Err(Error::OuterListFull { needed: 6 }));
    assert_eq!(bed.world().grains.group, [1, 1, 1, 0]);
    step(&mut bed.world(), &law()).unwrap();
}

/// Grains fall through the closed bottom of a box, or behind a drain, or are pressed into each other; with the cause
/// and the step at which each goes.
fn lose(
    skin: f64,
    policy: LossPolicy<f64>,
    cut: bool,
) -> (Vec<(u64, u32, Cause)>, Digest, Vec<u32>) {
    let domain = Domain::new([0.0; 3], [12.0, 8.0, 8.0], [true, true, false]).unwrap();
    let mut store = Store::<f64, 12, 80, 24, 3>::new(domain, 1e-3, skin);
    store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    store.add_group(Group::prescribed_velocity()).unwrap();
    store
        .add_obstacle(Obstacle::sphere([8.0, 4.0, 0.6], 0.5))
        .unwrap();
    // Two that fall out in turn and push each other, one that is pressed on a ball, and two that are pressed together.
    for (id, group, x) in [
        (1, 0, [2.0, 4.0, 0.3]),
        (3, 0, [2.1, 4.0, 1.28]),
        (4, 1, [8.0, 4.0, 1.7]),
        (6, 1, [5.0, 6.0, 4.0]),
        (9, 1, [6.2, 6.0, 4.0]),
        (12, 0, [2.0, 1.0, 6.0]),
    ] {
        store.add_grain(id, group, x, 0.5, 0.5).unwrap();
    }
    store.world().grains.velocity[2][2] = -1.0;
    store.world().grains.velocity[4][0] = -1.0;
    store.set_policy(policy);
    start(&mut store.world(), &law()).unwrap();
    let mut seen = Vec::new();
    for k in 0..2000 {
        let mut world = store.world();
        step(&mut world, &law()).unwrap();
        let losing = world.clock.is_losing();
        if losing {
            let sealed = step(&mut world, &law());
            assert_eq!(sealed, Err(Error::GrainsLeaving));
            let edit = remove(&mut world, &[1]);
            assert_eq!(edit, Err(Error::GrainsLeaving));
        }
        let now = world.clock.step;
        let show = |gone: Departure<f64>| seen.push((now, gone.grain.id, gone.cause));
        let count = take_out(&mut world, show).unwrap();
        assert_eq!(count > 0, losing);
        if cut && k % 97 == 0 {
            let histories: Vec<_> = world.contact_histories().collect();
            resume(&mut world, histories).unwrap();
        }
    }
    let world = store.world();
    (seen, digest(&world).unwrap(), world.grains.id.to_vec())
}

#[test]
fn losses_are_the_same_at_every_skin_and_cut() {
    let policy = LossPolicy {
        takes_out: true,
        drain: Some(Drain {
            point: [0.0, 0.0, 0.2],
            normal: [0.0, -1.0, 2.0],
        }),
    };
    let drained = LossPolicy {
        drain: Some(Drain {
            point: [0.0, 0.0, 5.0],
            normal: [0.0, 0.0, 1.0],
        }),
        ..policy
    };
    let plain = LossPolicy {
        drain: None,
        ..policy
    };
    for policy in [policy, plain, drained] {
        let first = lose(SKINS[0], policy, false);
        assert!(!first.0.is_empty());
        for skin in SKINS {
            assert_eq!(lose(skin, policy, false), first, "{skin}");
            assert_eq!(lose(skin, policy, true), first, "{skin}");
        }
    }
    let causes = |policy| {
        let mut all: Vec<_> = lose(0.03, policy, false)
            .0
            .iter()
            .map(|e| (e.1, e.2))
            .collect();
        all.sort_by_key(|e| e.0);
        all
    };
    let plain = causes(plain);
    assert_eq!(plain[0], (1, Cause::Escaped));
    assert!(
        plain.contains(&(9, Cause::OverlapTooDeep { with: 6 })),
        "{plain:?}"
    );
    assert!(
        plain.contains(&(4, Cause::ObstacleTooDeep { obstacle: 0 })),
        "{plain:?}"
    );
    assert!(causes(policy).contains(&(1, Cause::Drained)));
    // Five of six begin behind this one.
    let first = lose(0.03, drained, false).0;
    assert_eq!(first.iter().filter(|e| e.0 == 1).count(), 5);
    assert!(first.iter().all(|e| e.2 == Cause::Drained));
}

#[test]
fn without_a_policy_losses_stop_the_world() {
    for drop in [0, 1] {
        let domain = Domain::new([0.0; 3], [12.0, 8.0, 8.0], [true, true, false]).unwrap();
        let mut store = Store::<f64, 2, 4, 4, 1>::new(domain, 1e-3, 0.1);
        store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
        store.add_grain(5, 0, [2.0, 4.0, 0.001], 0.5, 0.5).unwrap();
        start(&mut store.world(), &law()).unwrap();
        if drop == 1 {
            store.set_policy(LossPolicy {
                takes_out: true,
                drain: None,
            });
        }
        let mut world = store.world();
        let stepped = steps(&mut world, 60);
        let fault = match drop {
            0 => Error::Escaped { id: 5 },
            _ => Error::GrainsLeaving,
        };
        assert_eq!(stepped, Err(fault));
        assert_eq!(
            take_out(&mut world, |_| ()),
            [Err(Error::NotStarted), Ok(1)][drop]
        );
        // A world may be empty.
        assert_eq!(step(&mut world, &law()).is_ok(), drop == 1);
    }
}
