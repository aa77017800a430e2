//! Worlds as bytes, and worlds in lent memory.

use bitgrain_kernel::{
    Capacity, Domain, Drain, Error, Group, Head, LentStore, LossPolicy, Memory, NewGrain, Obstacle,
    Real, Store, digest, nudge, remove, save, save_size, start, step,
};

use crate::edits::{Five, SKINS, law, row, steps};

fn bytes<R: Real>(store: &mut Five<R>) -> Vec<u8> {
    let mut world = store.world();
    let mut out = vec![0xaa; save_size(&world) + 8];
    let size = save(&mut world, &mut out).unwrap();
    assert_eq!(size + 8, out.len());
    // Nothing is written behind it.
    assert_eq!(out[size..], [0xaa; 8]);
    out.truncate(size);
    out
}

fn goes_on<R: Real>() {
    let mut store = row::<R>(0.03);
    store.set_policy(LossPolicy {
        takes_out: true,
        drain: Some(Drain {
            point: [R::ZERO, R::ZERO, R::HALF],
            normal: [R::ZERO, R::ZERO, R::ONE],
        }),
    });
    for skin in SKINS {
        steps(&mut store.world(), 17).unwrap();
        let saved = bytes(&mut store);
        let mut other = Five::<R>::new(Domain::open(), R::ONE, R::from_f64(skin));
        other.load(&saved).unwrap();
        let (mut a, mut b) = (store.world(), other.world());
        assert_eq!(
            (a.clock.step, a.dt, a.policy),
            (b.clock.step, b.dt, b.policy)
        );
        assert_eq!((a.domain, a.grains.groups), (b.domain, b.grains.groups));
        for _ in 0..20 {
            assert_eq!(digest(&a), digest(&b));
            steps(&mut a, 1).unwrap();
            steps(&mut b, 1).unwrap();
        }
        // Saved again it is the same.
        assert_eq!(bytes(&mut store), bytes(&mut other));
    }
}

#[test]
fn a_saved_world_goes_on() {
    goes_on::<f64>();
    goes_on::<f32>();
}

#[cfg(feature = "fixed")]
#[test]
fn a_saved_world_in_fixed_point_goes_on() {
    goes_on::<bitgrain_kernel::fixed_point::I32F32>();
}

#[test]
fn open_space_and_every_shape_are_saved() {
    every_shape_is_saved(0);
    every_shape_is_saved(7);
}

/// Of this material.
fn every_shape_is_saved(material: u8) {
    let mut store = Store::<f64, 2, 4, 4, 3>::new(Domain::open(), 1e-3, 0.1);
    store
        .add_group(Group::free_along_z([0.0, 0.0, -1.0]).of_material(material))
        .unwrap();
    for body in [
        Obstacle {
            material,
            ..Obstacle::sphere([0.0; 3], 1.0)
        },
        Obstacle::cylinder([5.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.5),
        Obstacle::plane([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]),
    ] {
        store.add_obstacle(body).unwrap();
    }
    store.add_grain(7, 0, [0.0, 0.0, 1.49], 0.5, 0.5).unwrap();
    start(&mut store.world(), &law()).unwrap();
    let mut world = store.world();
    steps(&mut world, 9).unwrap();
    let mut saved = [0; 2000];
    save(&mut world, &mut saved).unwrap();
    let mut other = Store::<f64, 2, 4, 4, 3>::vacant();
    other.load(&saved).unwrap();
    assert_eq!(other.world().obstacles, world.obstacles);
    assert_eq!(other.world().domain, world.domain);
    assert_eq!(other.world().grains.groups, world.grains.groups);
}

/// Every bit counts, and so does every byte that is missing.
#[test]
fn changed_bytes_are_refused_and_nothing_is_lost() {
    let mut store = row::<f64>(0.03);
    steps(&mut store.world(), 9).unwrap();
    let saved = bytes(&mut store);
    let mut other = row::<f64>(0.03);
    let before = digest(&other.world());
    let mut refused = |bytes: &[u8], fault: Error| {
        assert_eq!(other.load(bytes), Err(fault), "{}", bytes.len());
        assert_eq!(digest(&other.world()), before);
        step(&mut row::<f64>(0.03).world(), &law()).unwrap();
    };
    for at in 0..saved.len() {
        let mut changed = saved.clone();
        changed[at] ^= 1 << (at % 8);
        let head = (8..32).contains(&at);
        let fault = if head {
            Error::OtherVersion
        } else {
            Error::BadSave
        };
        refused(&changed, fault);
    }
    for end in (0..saved.len()).step_by(7) {
        // Cut before the version it names none.
        let fault = match end {
            8..20 => Error::OtherVersion,
            _ => Error::BadSave,
        };
        refused(&saved[..end], fault);
    }
    step(&mut other.world(), &law()).unwrap();
    let mut single = row::<f32>(0.03);
    assert_eq!(single.load(&saved), Err(Error::OtherVersion));
    let mut small = Store::<f64, 3, 16, 16, 2>::vacant();
    assert_eq!(small.load(&saved), Err(Error::GrainsFull { needed: 4 }));
    let mut few = Store::<f64, 5, 16, 16, 1>::vacant();
    assert_eq!(few.load(&saved), Err(Error::BadStorage));
    // The skin is the store's own: a list may be too short for it.
    let mut short = Store::<f64, 5, 16, 3, 2>::new(Domain::open(), 1.0, 9.0);
    let full = short.load(&saved);
    assert_eq!(full, Err(Error::ObstacleContactsFull { needed: 8 }));
    assert_eq!(step(&mut short.world(), &law()), Err(Error::NotStarted));
    short.set_skin(0.0);
    assert_eq!(short.load(&saved), Ok(()));
}

#[test]
fn only_a_world_at_rest_is_saved() {
    let mut store = row::<f64>(0.03);
    let needed = save_size(&store.world());
    let mut out = vec![0; needed];
    let short = save(&mut store.world(), &mut out[1..]);
    assert_eq!(short, Err(Error::BufferTooShort { needed }));
    store.world().grains.velocity[0][0] += 0.5;
    assert_eq!(save(&mut store.world(), &mut out), Err(Error::Edited));
    store.world().clock.stop();
    assert_eq!(save(&mut store.world(), &mut out), Err(Error::NotStarted));
    assert!(out.iter().all(|byte| *byte == 0));
}

/// Memory as a host lends it.
struct Lender {
    capacity: Capacity,
    head: Head<f64>,
    numbers: Vec<f64>,
    words: Vec<u32>,
    images: Vec<[i32; 3]>,
    group: Vec<u8>,
    groups: Vec<Group<f64>>,
    obstacles: Vec<Obstacle<f64>>,
}

impl Lender {
    /// With other things in it than zeros.
    fn new(capacity: Capacity, skin: f64) -> Self {
        let domain = Domain::new([0.0; 3], [12.0, 8.0, 8.0], [true, true, false]);
        Self {
            capacity,
            head: Head::new(domain.unwrap(), 1e-3, skin),
            numbers: vec![f64::NAN; capacity.numbers().unwrap()],
            words: vec![77; capacity.words().unwrap()],
            images: vec![[5; 3]; capacity.grains],
            group: vec![9; capacity.grains],
            groups: vec![Group::frozen(); capacity.groups],
            obstacles: vec![Obstacle::sphere([0.0; 3], -1.0); capacity.obstacles],
        }
    }

    fn store(&mut self) -> LentStore<'_, f64> {
        let memory = Memory {
            head: &mut self.head,
            numbers: &mut self.numbers,
            words: &mut self.words,
            images: &mut self.images,
            group: &mut self.group,
            groups: &mut self.groups,
            obstacles: &mut self.obstacles,
            facets: &[],
        };
        LentStore::new(memory, self.capacity).unwrap()
    }
}

/// A world in lent memory has the bits of one in a store, though the host makes the store anew for each call.
#[test]
fn lent_memory_holds_the_same_world() {
    let mut store = row::<f64>(0.03);
    let mut lender = Lender::new(Capacity::for_bed(5, 2), 0.1);
    let mut lent = lender.store();
    lent.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    lent.add_group(Group::prescribed_velocity()).unwrap();
    let bodies: Vec<_> = row::<f64>(0.0).world().obstacles.to_vec();
    for (k, body) in bodies.iter().enumerate() {
        assert_eq!(lent.add_obstacle(*body), Ok(k as u32));
    }
    assert_eq!(lent.add_obstacle(bodies[0]), Err(Error::BadStorage));
    for (id, group, x) in [
        (1, 0, [2.0, 4.0, 1.0]),
        (3, 0, [2.999, 4.0, 1.0]),
        (4, 0, [4.009, 4.0, 1.0]),
        (7, 1, [2.0, 5.2, 1.0]),
    ] {
        lent.add_grain(id, group, x, 0.5, 0.5).unwrap();
    }
    start(&mut lent.world(), &law()).unwrap();
    let rain = [NewGrain {
        id: 5,
        group: 0,
        position: [6.0, 4.0, 3.0],
        radius: 0.5,
        mass: 0.5,
        velocity: [0.0; 3],
        spin: [0.0; 3],
    }];
    for round in 0..60 {
        assert_eq!(digest(&store.world()), digest(&lender.store().world()));
        step(&mut store.world(), &law()).unwrap();
        step(&mut lender.store().world(), &law()).unwrap();
        match round {
            10 => {
                store.insert(rain).unwrap();
                lender.store().insert(rain).unwrap();
                let full = lender.store().add_grain(9, 0, [0.0; 3], 0.5, 0.5);
                assert_eq!(full, Err(Error::GrainsFull { needed: 6 }));
            }
            20 => {
                nudge(&mut store.world(), 4, [3.0, 0.0, 1.0], [0.0; 3]).unwrap();
                nudge(&mut lender.store().world(), 4, [3.0, 0.0, 1.0], [0.0; 3]).unwrap();
            }
            30 => {
                remove(&mut store.world(), &[3, 4]).unwrap();
                remove(&mut lender.store().world(), &[3, 4]).unwrap();
                assert_eq!(lender.store().count(), 3);
            }
            40 => {
                let mut saved = vec![0; save_size(&store.world())];
                save(&mut store.world(), &mut saved).unwrap();
                lender = Lender::new(Capacity::for_bed(4, 2), 0.02);
                lender.store().load(&saved).unwrap();
            }
            _ => {}
        }
    }
}

#[test]
fn memory_that_is_too_short_is_refused() {
    let capacity = Capacity::for_bed(5, 2);
    let refused = |shorten: fn(&mut Lender), capacity: Capacity| {
        let mut lender = Lender::new(Capacity::for_bed(5, 2), 0.1);
        shorten(&mut lender);
        let memory = Memory {
            head: &mut lender.head,
            numbers: &mut lender.numbers,
            words: &mut lender.words,
            images: &mut lender.images,
            group: &mut lender.group,
            groups: &mut lender.groups,
            obstacles: &mut lender.obstacles,
            facets: &[],
        };
        LentStore::new(memory, capacity).err() == Some(Error::BadStorage)
    };
    assert!(!refused(|_| (), capacity));
    for shorten in [
        |l: &mut Lender| l.numbers.truncate(9),
        |l: &mut Lender| l.words.truncate(9),
        |l: &mut Lender| l.images.truncate(4),
        |l: &mut Lender| l.group.truncate(4),
        |l: &mut Lender| l.groups.truncate(7),
        |l: &mut Lender| l.obstacles.truncate(1),
        |l: &mut Lender| l.store().add_grain(1, 0, [0.0; 3], 0.5, 0.5).unwrap(),
    ] {
        let less = Capacity {
            grains: 0,
            ..capacity
        };
        assert!(refused(shorten, capacity) || refused(shorten, less));
    }
    let huge = Capacity {
        pairs: usize::MAX / 3,
        ..capacity
    };
    assert_eq!(huge.numbers(), None);
    assert!(refused(|_| (), huge));
    let none = Capacity {
        cells: 0,
        ..capacity
    };
    assert!(refused(|_| (), none));
}

/// A host may drive an obstacle as slowly as it likes: the world runs, so it is saved and loaded too, and edited.
#[test]
fn a_slow_obstacle_hinders_no_load_and_no_edit() {
    let mut store = row::<f64>(0.03);
    store.world().obstacles[1].velocity = [1e-14, 0.0, 0.0];
    steps(&mut store.world(), 3).unwrap();
    let saved = bytes(&mut store);
    let mut other = Five::<f64>::vacant();
    other.load(&saved).unwrap();
    remove(&mut other.world(), &[4]).unwrap();
    remove(&mut store.world(), &[4]).unwrap();
    let slow = NewGrain {
        id: 9,
        group: 1,
        position: [9.0, 1.0, 2.0],
        radius: 0.5,
        mass: 0.5,
        velocity: [1e-12, 0.0, 0.0],
        spin: [0.0; 3],
    };
    assert_eq!(store.insert([slow]), Err(Error::TooSlow { id: 9 }));
    let rests = NewGrain {
        velocity: [0.0; 3],
        ..slow
    };
    store.insert([rests]).unwrap();
    other.insert([rests]).unwrap();
    steps(&mut store.world(), 3).unwrap();
    steps(&mut other.world(), 3).unwrap();
    assert_eq!(digest(&store.world()), digest(&other.world()));
}
