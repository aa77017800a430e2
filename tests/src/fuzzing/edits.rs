//! Edits of a world in any order: insert, remove, regroup, nudge, losses, forces of a host, steps, save and load.
//!
//! Two stores with other skins do the same; each gives the same answer and digest as the other, whatever was refused,
//! and now and then one of them becomes what the other saved.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{
    Domain, Drain, Error as KernelError, Group, LossPolicy, NewGrain, Obstacle, Store, World,
    digest, nudge, regroup, remove, save, save_size, start, step, step_with, take_out,
};

use super::bytes::Bytes;

type Bed = Store<f64, 16, 256, 64, 3>;

const LAW: HertzHistory<f64> = HertzHistory {
    kn: 2e4,
    kt: 2.45e4,
    gamma_n: 50.0,
    gamma_t: 50.0,
    mu: 0.5,
};

/// Grains on a floor beside a ball; whether at least one edit was done.
pub fn edits(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    let mut beds = Box::new([0.0, bytes.between(0.0, 1.0)].map(bed));
    let mut done = 0;
    if beds.each_mut().map(|bed| start(&mut bed.world(), &LAW)) != [Ok(()), Ok(())] {
        panic!("the bed is sound");
    }
    for _ in 0..40 {
        if bytes.0.is_empty() {
            break;
        }
        let before = beds.each_mut().map(|bed| digest(&bed.world()));
        let edit = Edit::of(&mut bytes);
        let [a, b] = beds.each_mut().map(|bed| edit.on(bed));
        assert_eq!(a, b, "{edit:?}");
        let after = beds.each_mut().map(|bed| digest(&bed.world()));
        assert_eq!(after[0], after[1], "{edit:?}");
        for bed in beds.iter_mut() {
            assert!(bed.world().grains.id.is_sorted_by(|a, b| a < b));
        }
        match a {
            Ok(()) => done += usize::from(!matches!(edit, Edit::Steps(..))),
            Err(_) if !beds[0].world().clock.rests() => return done > 0,
            Err(_) => assert_eq!(before, after, "{edit:?} was refused"),
        }
        if bytes.below(4) == 0 {
            let [one, other] = &mut *beds;
            pass_on(one, other, &mut bytes);
        }
    }
    done > 0
}

fn bed(skin: f64) -> Bed {
    let domain = Domain::new([0.0; 3], [5.0, 5.0, 8.0], [true, true, false]).unwrap();
    let mut bed = Bed::new(domain, 1e-3, skin);
    for group in [
        Group::free([0.2, 0.0, -1.0]),
        Group::frozen(),
        Group::free_along_z([0.0, 0.0, -1.0]),
    ] {
        bed.add_group(group).unwrap();
    }
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    bed.add_obstacle(floor).unwrap();
    bed.add_obstacle(Obstacle::sphere([3.5, 3.5, 0.5], 0.5))
        .unwrap();
    for k in 0..6u32 {
        let x = [
            1.0 + 0.999 * f64::from(k % 3),
            1.0,
            0.4995 + 0.999 * f64::from(k / 3),
        ];
        bed.add_grain(10 * k + 10, 0, x, 0.5, 0.5).unwrap();
    }
    bed
}

/// What is done to both.
#[derive(Debug)]
enum Edit {
    Steps(usize, Option<[f64; 3]>),
    Insert(Vec<NewGrain<f64>>),
    Remove(Vec<u32>),
    Regroup(Vec<u32>, u8),
    Nudge(u32, [f64; 3], [f64; 3]),
    Policy(LossPolicy<f64>),
    Drive(usize, [f64; 3]),
}

impl Edit {
    fn of(bytes: &mut Bytes) -> Self {
        let ids = |bytes: &mut Bytes| {
            let count = bytes.below(4);
            (0..count).map(|_| u32::from(bytes.byte() % 80)).collect()
        };
        match bytes.below(8) {
            0 => Self::Insert((0..=bytes.below(3)).map(|_| grain(bytes)).collect()),
            1 => Self::Remove(ids(bytes)),
            2 => Self::Regroup(ids(bytes), bytes.byte() % 4),
            3 => {
                let speed = bytes.scale(-2.0, 3.0);
                Self::Nudge(
                    u32::from(bytes.byte() % 80),
                    bytes.vector().map(|v| v * speed),
                    bytes.vector(),
                )
            }
            4 => Self::Policy(LossPolicy {
                takes_out: bytes.below(4) > 0,
                drain: (bytes.below(2) == 0).then(|| Drain {
                    point: [0.0, 0.0, bytes.between(-1.0, 1.0)],
                    normal: bytes.vector(),
                }),
            }),
            5 => Self::Drive(bytes.below(2), bytes.vector()),
            6 => Self::Steps(bytes.below(60), Some(bytes.vector())),
            _ => Self::Steps(bytes.below(60), None),
        }
    }

    fn on(&self, bed: &mut Bed) -> Result<(), KernelError> {
        match self {
            Self::Steps(count, push) => {
                (0..*count).try_for_each(|_| one_step(&mut bed.world(), *push))
            }
            Self::Insert(grains) => bed.insert(grains.iter().copied()),
            Self::Remove(ids) => remove(&mut bed.world(), ids),
            Self::Regroup(ids, group) => regroup(&mut bed.world(), ids, *group),
            Self::Nudge(id, velocity, spin) => {
                let mut world = bed.world();
                let place = world.place_of(*id);
                let place = place.ok_or(KernelError::UnknownGrain { id: *id })?;
                nudge(&mut world, place, *velocity, *spin)
            }
            Self::Policy(policy) => {
                bed.set_policy(*policy);
                Ok(())
            }
            Self::Drive(number, velocity) => {
                bed.world().obstacles[*number].velocity = *velocity;
                Ok(())
            }
        }
    }
}

fn one_step(world: &mut World<'_, f64>, push: Option<[f64; 3]>) -> Result<(), KernelError> {
    match push {
        Some(push) => step_with(world, &LAW, |grain| (push, grain.velocity)),
        None => step(world, &LAW),
    }?;
    take_out(world, |_| ()).map(|_| ())
}

fn grain(bytes: &mut Bytes) -> NewGrain<f64> {
    NewGrain {
        id: u32::from(bytes.byte() % 80),
        group: bytes.byte() % 4,
        position: [5.0, 5.0, 8.0].map(|length| bytes.between(-0.01, length)),
        radius: bytes.between(0.2, 0.6),
        mass: bytes.between(0.1, 1.0),
        velocity: bytes.vector(),
        spin: bytes.vector(),
    }
}

/// Lets a store become what another one saved; a byte that is changed on the way is found.
fn pass_on(from: &mut Bed, to: &mut Bed, bytes: &mut Bytes) {
    let mut saved = vec![0; save_size(&from.world())];
    let size = save(&mut from.world(), &mut saved).unwrap();
    assert_eq!(size, saved.len());
    let at = usize::from(u16::from_le_bytes([bytes.byte(), bytes.byte()])) % size;
    let flip = bytes.byte() | 1;
    saved[at] ^= flip;
    let before = digest(&to.world());
    assert!(to.load(&saved).is_err(), "byte {at}");
    assert_eq!(digest(&to.world()), before);
    saved[at] ^= flip;
    to.load(&saved).unwrap();
    assert_eq!(digest(&to.world()), digest(&from.world()));
}
