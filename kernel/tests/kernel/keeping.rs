//! Laws that keep words of contacts: saved, resumed, in parts, at every skin, in storage that fits and that does not.

use bitgrain_kernel::contact::{
    HertzTsuji, Law, Rolling, RollingResistance, RollingSpring, TangentialForce, TangentialState,
    Torque, TurningState,
};
use bitgrain_kernel::contact::{NormalForce, NormalState};
use bitgrain_kernel::{
    ContactHistory, Digest, Domain, Error, Group, KeptContact, Obstacle, Store, World, digest,
    resume, save, start, step,
};

use crate::common::crowd::tsuji;
use crate::common::parts::{Ghosts, steps_in_parts};
use crate::common::sticky::{STICKY, Sticky};

/// A heap of grains, with storage for `WORDS` words.
type Heap<const WORDS: usize> = Store<f64, 30, 400, 200, 3, WORDS>;

const GRAINS: u32 = 30;

/// Grains that fall onto a floor and a ball that turns.
fn heap<const WORDS: usize>(skin: f64) -> Box<Heap<WORDS>> {
    let domain = Domain::new([0.0; 3], [4.0, 4.0, 30.0], [true, true, false]).unwrap();
    let mut store = Box::new(Heap::<WORDS>::new(domain, 2e-3, skin));
    store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    store.add_obstacle(floor).unwrap();
    let ball = Obstacle {
        angular_velocity: [0.3, 0.2, 0.0],
        ..Obstacle::sphere([2.0, 2.0, 0.5], 0.8)
    };
    store.add_obstacle(ball).unwrap();
    for k in 0..GRAINS {
        let place = [
            0.6 + 1.03 * f64::from(k % 3),
            0.6 + 1.02 * f64::from(k / 3 % 3),
            1.9 + 1.01 * f64::from(k / 9),
        ];
        store.add_grain(2 * k + 1, 0, place, 0.5, 0.5).unwrap();
        store.world().grains.spin[k as usize] = [0.4, 0.1 * f64::from(k % 4), 0.3, 0.0];
    }
    store
}

/// `epsd2` or `sds` on a soft law of Guillard.
fn rolling(spring: RollingSpring) -> Rolling<f64, HertzTsuji<f64>> {
    let resistance = RollingResistance {
        spring,
        k: 200.0,
        gamma: 0.5,
        mu: 0.1,
    };
    Rolling {
        law: HertzTsuji::new(2e4, 0.3, 0.4, 0.5),
        resistance,
    }
}

const STEPS: usize = 4000;

fn steps<L: Law<f64>>(world: &mut World<'_, f64>, law: &L, count: usize) {
    for _ in 0..count {
        step(world, law).unwrap();
    }
}

/// The digest after so many steps, with storage for `WORDS` words.
fn run<const WORDS: usize, L: Law<f64>>(law: &L, skin: f64) -> Digest {
    let mut store = heap::<WORDS>(skin);
    let mut world = store.world();
    start(&mut world, law).unwrap();
    steps(&mut world, law, STEPS);
    digest(&world).unwrap()
}

/// Skins, more storage, saving, resuming, and parts change no bit.
fn keeps_its_bits<L: Law<f64>>(law: &L) {
    let whole = run::<3, L>(law, 0.1);
    assert_eq!(run::<3, L>(law, 0.0), whole);
    assert_eq!(run::<8, L>(law, 0.4), whole);
    // Saved and loaded, and taken up by hand, half way.
    let mut store = heap::<3>(0.2);
    start(&mut store.world(), law).unwrap();
    steps(&mut store.world(), law, STEPS / 2);
    let mut bytes = vec![0; 20_000];
    let length = save(&mut store.world(), &mut bytes).unwrap();
    let mut loaded = heap::<4>(0.05);
    loaded.load(&bytes[..length]).unwrap();
    let mut again = vec![0; 20_000];
    assert_eq!(save(&mut loaded.world(), &mut again), Ok(length));
    assert_eq!(again, bytes);
    let kept: Vec<KeptContact<f64>> = store.world().kept_contacts().collect();
    assert!(kept.iter().any(|contact| contact.memory[0] != 0.0) && kept.len() > 20);
    let mut world = store.world();
    resume(&mut world, kept).unwrap();
    for world in [&mut world, &mut loaded.world()] {
        steps(world, law, STEPS / 2);
        assert_eq!(digest(world), Ok(whole));
    }
    // In parts, of which each finds the pairs of its own grains.
    let mut store = heap::<3>(0.1);
    start(&mut store.world(), law).unwrap();
    let owner: Vec<u8> = (0..GRAINS).map(|k| (k * 7 % 3) as u8).collect();
    let mut world = store.world();
    for count in [1, 700, STEPS as u64 - 701] {
        steps_in_parts(&mut world, &owner, Ghosts::All, law, count).unwrap();
    }
    assert_eq!(digest(&world), Ok(whole));
}

#[test]
fn laws_that_keep_words_keep_their_bits() {
    keeps_its_bits(&rolling(RollingSpring::Sds));
    keeps_its_bits(&rolling(RollingSpring::Epsd2));
    keeps_its_bits(&STICKY);
}

/// What resists nothing is the law without it, to the bit; its words are zero then.
#[test]
fn without_a_coefficient_nothing_resists() {
    for spring in [RollingSpring::Sds, RollingSpring::Epsd2] {
        let law = rolling(spring);
        let none = Rolling {
            resistance: RollingResistance {
                mu: 0.0,
                ..law.resistance
            },
            ..law
        };
        let bare = run::<0, _>(&law.law, 0.1);
        let resisted = run::<3, _>(&none, 0.1);
        assert_eq!(resisted, bare);
        assert_ne!(run::<3, _>(&law, 0.1).spins, bare.spins);
    }
}

#[test]
fn storage_without_room_for_words_is_refused() {
    let law = rolling(RollingSpring::Sds);
    let mut store = heap::<0>(0.1);
    assert_eq!(start(&mut store.world(), &law), Err(Error::LawMisfit));
    let mut store = heap::<2>(0.1);
    assert_eq!(start(&mut store.world(), &law), Err(Error::LawMisfit));
    // Another law in the middle of a run.
    start(&mut store.world(), &tsuji()).unwrap();
    assert_eq!(step(&mut store.world(), &law), Err(Error::LawMisfit));
    // What was saved with words needs them.
    let mut store = heap::<3>(0.1);
    start(&mut store.world(), &law).unwrap();
    steps(&mut store.world(), &law, 2000);
    let mut bytes = vec![0; 20_000];
    let length = save(&mut store.world(), &mut bytes).unwrap();
    let mut short = heap::<2>(0.1);
    assert_eq!(short.load(&bytes[..length]), Err(Error::LawMisfit));
}

/// A law that reaches further than pairs are listed would miss some of them.
#[test]
fn a_law_that_reaches_further_than_pairs_are_listed_is_refused() {
    let mut store = heap::<3>(0.1);
    start(&mut store.world(), &STICKY).unwrap();
    steps(&mut store.world(), &STICKY, 2000);
    let kept: Vec<KeptContact<f64>> = store.world().kept_contacts().collect();
    let mut bytes = vec![0; 20_000];
    let length = save(&mut store.world(), &mut bytes).unwrap();
    let wide = Sticky { gap: 0.2, ..STICKY };
    assert_eq!(step(&mut store.world(), &wide), Err(Error::LawMisfit));
    // The same of a world that is taken up and was not told.
    store.load(&bytes[..length]).unwrap();
    store.world().clock.set_reach(0.0);
    resume(&mut store.world(), kept.clone()).unwrap();
    assert_eq!(step(&mut store.world(), &STICKY), Err(Error::LawMisfit));
    store.load(&bytes[..length]).unwrap();
    store.world().clock.set_reach(STICKY.gap);
    resume(&mut store.world(), kept.clone()).unwrap();
    step(&mut store.world(), &STICKY).unwrap();
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        store.world().clock.set_reach(bad);
        assert!(resume(&mut store.world(), kept.clone()).is_err(), "{bad}");
    }
}

/// Two grains that were pressed together hang on each other until the gap is passed: no history is lost before, and
/// none is left after.
#[test]
fn what_acts_at_a_distance_is_kept_as_long_as_it_acts() {
    let mut store = Store::<f64, 2, 8, 2, 1, 3>::new(Domain::open(), 2e-4, 0.0);
    store.add_group(Group::free([0.0; 3])).unwrap();
    store.add_grain(1, 0, [0.0; 3], 0.5, 0.5).unwrap();
    store.add_grain(2, 0, [0.999, 0.0, 0.0], 0.5, 0.5).unwrap();
    store.world().grains.velocity[1][0] = 30.0;
    let mut world = store.world();
    start(&mut world, &STICKY).unwrap();
    let (mut apart, mut pulled) = (0, 0);
    for _ in 0..100 {
        step(&mut world, &STICKY).unwrap();
        let gap = world.grains.position[1][0] - world.grains.position[0][0] - 1.0;
        let kept: Vec<_> = world.kept_contacts().collect();
        let pulls = world.grains.force[0][0] > 0.0;
        assert_eq!(kept.len(), usize::from(gap < STICKY.gap), "{gap}");
        if gap < STICKY.gap {
            pulled += usize::from(gap > 0.0 && pulls);
            assert_eq!(kept[0].memory[0], 1.0);
        } else {
            apart += 1;
            assert_eq!(world.grains.force[0], [0.0; 4]);
        }
    }
    assert!(pulled > 3 && apart > 3, "{pulled} {apart}");
}

/// A law that only keeps words, so many; it gives all eight, whatever it says that it keeps.
#[derive(Clone, Copy)]
struct Counting<const WORDS: usize>;

impl<const WORDS: usize> Law<f64> for Counting<WORDS> {
    const MEMORY: usize = WORDS;

    fn normal_force(&self, c: &NormalState<f64>) -> NormalForce<f64> {
        tsuji_of_unit().normal_force(c)
    }

    fn tangential_force(
        &self,
        normal: &NormalForce<f64>,
        state: &TangentialState<f64>,
    ) -> TangentialForce<f64> {
        tsuji_of_unit().tangential_force(normal, state)
    }

    fn torque(&self, _: &NormalForce<f64>, state: &TurningState<f64>) -> Torque<f64> {
        let mut memory = state.contact.memory;
        for (k, word) in memory.iter_mut().enumerate() {
            *word += state.dt * (k + 1) as f64;
        }
        Torque {
            torque: [0.0; 3],
            memory,
        }
    }
}

fn tsuji_of_unit() -> HertzTsuji<f64> {
    HertzTsuji::new(2e4, 0.3, 0.4, 0.5)
}

/// Every word is in the digest, and comes back from where it was saved.
#[test]
fn every_word_is_in_the_digest() {
    let mut store = heap::<8>(0.1);
    start(&mut store.world(), &Counting::<8>).unwrap();
    steps(&mut store.world(), &Counting::<8>, 2000);
    let mut world = store.world();
    let before = digest(&world).unwrap();
    let kept: Vec<KeptContact<f64>> = world.kept_contacts().collect();
    for word in 0..8 {
        for contact in [0, kept.len() - 1] {
            let mut changed = kept.clone();
            changed[contact].memory[word] += 1e-9;
            resume(&mut world, changed).unwrap();
            assert_ne!(
                digest(&world).unwrap().histories,
                before.histories,
                "{word} {contact}"
            );
        }
    }
    resume(&mut world, kept.clone()).unwrap();
    assert_eq!(digest(&world), Ok(before));
    // A word that is no number is refused.
    let mut bad = kept.clone();
    bad[0].memory[7] = f64::NAN;
    assert_eq!(resume(&mut world, bad), Err(Error::BadContactHistory));
    // Without words the springs alone come back.
    let springs: Vec<ContactHistory<f64>> = kept.iter().map(|contact| contact.history).collect();
    resume(&mut world, springs).unwrap();
    assert_ne!(digest(&world).unwrap().histories, before.histories);
}

/// Words that are not the law's are dropped, of contacts with grains and with obstacles, so that storage for more words
/// changes no bit.
#[test]
fn storage_for_more_words_than_the_law_keeps_changes_nothing() {
    fn end<const STORED: usize>() -> (Digest, usize) {
        let mut store = heap::<STORED>(0.1);
        start(&mut store.world(), &Counting::<2>).unwrap();
        steps(&mut store.world(), &Counting::<2>, 2000);
        let world = store.world();
        let is_on_obstacle =
            |c: &KeptContact<f64>| matches!(c.history, ContactHistory::Obstacle { .. });
        (
            digest(&world).unwrap(),
            world.kept_contacts().filter(is_on_obstacle).count(),
        )
    }
    let (fits, on_obstacles) = end::<2>();
    assert!(on_obstacles > 0);
    assert_eq!(end::<3>().0, fits);
    assert_eq!(end::<8>().0, fits);
}
