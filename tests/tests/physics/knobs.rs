//! Settings that must not change a bit, and the digests that every build must give.

use std::io::Write;

use bitgrain::checkpoint;
use bitgrain::law::{Sprung, WithLaw};
use bitgrain::simulation::{Role, Simulation, hex};
use bitgrain_kernel::contact::{HertzHistory, Law};
use bitgrain_kernel::{ContactForce, Digest, Group, Obstacle, Partner, Store, digest, start, step};
use bitgrain_tests::{golden, golden_case};

#[path = "../../../kernel/tests/kernel/common/part.rs"]
mod part;
#[path = "../../../kernel/tests/kernel/common/parts.rs"]
mod parts;

use parts::{Ghosts, steps_in_parts};

/// A golden case and its started simulation.
fn begin(name: &str) -> Simulation {
    let case = golden_case(name);
    case.start(name, |_| {}).expect("a sound case")
}

/// The rig comes under either law.
const CASES: [&str; 6] = [
    "collapse.json",
    "lid.json",
    "rig.json",
    "rig.json:hertz_history",
    "materials.json",
    "rolling.json",
];

/// What the goldens of the rig cover: every kind of body that it has pushes every other that it
/// should, all of it goes round the box, and nothing gets lost.
#[test]
fn the_rig_has_every_contact_of_a_rig() {
    for name in &CASES[2..4] {
        let mut sim = begin(name);
        let roles = [Role::Free, Role::Base, Role::Lid];
        let of = |sim: &Simulation, role| (0..sim.count()).filter(|&i| sim.role(i) == role).count();
        assert_eq!(roles.map(|role| of(&sim, role)), [30, 12, 12]);
        let mut met = std::collections::BTreeMap::new();
        let mut across = 0;
        for _ in 0..10_000 {
            let mut seen: Vec<ContactForce<f64>> = Vec::new();
            sim.step_seen(&mut seen).unwrap();
            for p in seen {
                let mut pair = [format!("{:?}", sim.role(p.i as usize)), String::new()];
                pair[1] = match p.partner {
                    Partner::Grain(j) => format!("{:?}", sim.role(j as usize)),
                    Partner::Obstacle(k) => k.to_string(),
                };
                pair.sort();
                *met.entry(pair.join(" ")).or_insert(0) += 1;
                // The bar lies beside the periodic edge along x.
                across += usize::from(
                    p.partner == Partner::Obstacle(0) && sim.position[p.i as usize][0] > 5e-3,
                );
            }
        }
        // Obstacles are the bar, the floor and the plane above the lid.
        for pair in ["Base Free", "Free Free", "Free Lid", "0 Free", "1 Base"] {
            assert!(met.get(pair) > Some(&1000), "{name}, {pair}: {met:?}");
        }
        assert!(across > 1000, "{name}: {across} of {met:?}");
        let round = (0..sim.count()).filter(|&i| sim.image[i][0] == 1);
        assert!(round.count() > 24, "{name}: base, lid and more go round");
    }
}

#[test]
fn skins_and_search_schedules_change_nothing() {
    for name in CASES {
        let mut ends = Vec::new();
        let unit = begin(name).outer_skin;
        for (skin, reach) in [
            (0.0, 0.0),
            (0.0, 1.0),
            (0.01, 0.1),
            (0.3, 0.0),
            (0.05, 3.0),
            (12.0, 0.0),
            (3.0, 12.0),
        ] {
            let mut sim = begin(name);
            sim.stepping.tunes = false;
            (sim.skin, sim.outer_skin) = (skin * unit, reach * unit);
            sim.start().unwrap();
            sim.steps(1500).unwrap();
            ends.push((sim.digest(), sim.list_counts().0, sim.prunes()));
        }
        assert!(
            ends.iter().all(|(digest, ..)| *digest == ends[0].0),
            "{name}"
        );
        let (always, renewed, seldom) = (&ends[0], &ends[1], &ends[5]);
        assert!(
            always.1 > 1000 && renewed.1 < 1000 && renewed.2 > 1000 && seldom.1 < 100,
            "the schedules differed: {ends:?}"
        );
    }
}

#[test]
fn watching_saving_and_the_length_of_a_call_change_nothing() {
    for name in CASES {
        let mut plain = begin(name);
        plain.steps(900).unwrap();
        let mut watched = begin(name);
        let folder = tempfile::tempdir().unwrap();
        let mut seen = 0;
        for n in 0..900u64 {
            watched
                .step_watched(|_: ContactForce<f64>| seen += 1)
                .unwrap();
            if n % 50 == 0 {
                watched.digest().unwrap();
                checkpoint::write(&folder.path().join("state"), &mut watched).unwrap();
            }
        }
        assert!(seen > 0);
        assert_eq!(plain.digest(), watched.digest(), "{name}");
    }
}

/// Saved and resumed: equal at every later step, not only at the end.
#[test]
fn a_checkpoint_goes_on_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    for name in CASES {
        let mut sim = begin(name);
        sim.steps(700).unwrap();
        checkpoint::write(&path, &mut sim).unwrap();
        let mut again = checkpoint::read(&path).unwrap();
        assert_eq!(again.step_count(), 700);
        for _ in 0..300 {
            assert_eq!(
                sim.digest(),
                again.digest(),
                "{name} at step {}",
                sim.step_count()
            );
            sim.steps(1).unwrap();
            again.steps(1).unwrap();
        }
    }
}

#[test]
fn a_damaged_checkpoint_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    let mut sim = begin("collapse.json");
    sim.steps(300).unwrap();
    checkpoint::write(&path, &mut sim).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for k in 0..200 {
        let mut damaged = whole.clone();
        let at = whole.len() * k / 200;
        if k % 4 == 0 {
            damaged.truncate(at);
        } else {
            damaged[at] ^= 1 << (k % 8);
        }
        std::fs::File::create(&path)
            .unwrap()
            .write_all(&damaged)
            .unwrap();
        assert!(
            checkpoint::read(&path).is_err(),
            "byte {at} of {}",
            whole.len()
        );
    }
}

/// Any cut into parts gives the bits of the whole world: threads rely on it.
#[test]
fn cuts_into_parts_change_nothing() {
    for name in CASES {
        let mut sim = begin(name);
        sim.steps(3000).unwrap();
        sim.law.with(Cut { sim: &sim, name });
    }
}

/// A simulation to be cut, with the name of its case.
struct Cut<'s> {
    sim: &'s Simulation,
    name: &'s str,
}

impl WithLaw for Cut<'_> {
    type Output = ();

    fn run<L: Law<f64> + Sprung>(self, law: &L) {
        cut(self.sim, law, self.name);
    }
}

fn cut(sim: &Simulation, law: &impl Law<f64>, name: &str) {
    let count = sim.count();
    let mut whole = sim.clone();
    let mut world = whole.world();
    (0..3).for_each(|_| step(&mut world, law).unwrap());
    let whole = digest(&world).unwrap();
    // By ids in two halves and in three runs, by turns of four and of sixteen, and by height.
    let mut by_height: Vec<usize> = (0..count).collect();
    by_height.sort_by(|a, b| sim.position[*a][2].total_cmp(&sim.position[*b][2]));
    let height = |k: usize| by_height.iter().position(|place| *place == k).unwrap_or(0);
    let of: [&dyn Fn(usize) -> usize; 5] = [
        &|k| 2 * k / count,
        &|k| usize::from(k > 6) + usize::from(k > 14),
        &|k| k % 4,
        &|k| k % 16,
        &|k| 3 * height(k) / count,
    ];
    for (number, part) in of.iter().enumerate() {
        let owner: Vec<u8> = (0..count).map(|k| part(k) as u8).collect();
        for ghosts in [Ghosts::All, Ghosts::Near] {
            for at_once in [1, 3] {
                let cut = after_steps_in_parts(sim, law, &owner, ghosts, at_once);
                assert_eq!(whole, cut, "{name}, {number} {ghosts:?} {at_once}");
            }
        }
    }
}

/// The state after three steps in parts, so many at a time.
fn after_steps_in_parts(
    sim: &Simulation,
    law: &impl Law<f64>,
    owner: &[u8],
    ghosts: Ghosts,
    at_once: u64,
) -> Digest {
    let mut sim = sim.clone();
    let mut world = sim.world();
    for _ in 0..3 / at_once {
        steps_in_parts(&mut world, owner, ghosts, law, at_once).unwrap();
    }
    digest(&world).unwrap()
}

/// The digests of every build: run these in debug and in release.
#[test]
fn digests_are_the_golden_ones() {
    let mut text = String::new();
    for name in CASES {
        let mut sim = begin(name);
        for _ in 0..=10 {
            let step = sim.step_count();
            text.push_str(&format!(
                "{name} {step:>5} {}\n",
                hex(&sim.digest().unwrap().whole)
            ));
            sim.steps(1000).unwrap();
        }
    }
    text.push_str(&format!("f32 column      {}\n", hex(&column_f32())));
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("digests"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(
        "recipe: golden/cases; `cargo test -p bitgrain-tests --test physics knobs::`",
    );
    settings.bind(|| insta::assert_snapshot!("cases", text));
}

/// Twelve grains in a column, in single precision and without an allocator.
fn column_f32() -> [u8; 32] {
    let mut store = Store::<f32, 12, 64, 24, 2>::new(bitgrain_kernel::Domain::open(), 2e-4, 0.1);
    let law = HertzHistory {
        kn: 2e4,
        kt: 2.45e4,
        gamma_n: 200.0,
        gamma_t: 200.0,
        mu: 0.5,
    };
    store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    store
        .add_obstacle(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]))
        .unwrap();
    for k in 0..12u8 {
        let lean = 0.05 * f32::from(k % 3);
        let position = [lean, -lean, 0.55 + 1.02 * f32::from(k)];
        store
            .add_grain(u32::from(k) + 1, 0, position, 0.5, 0.52)
            .unwrap();
    }
    let mut world = store.world();
    start(&mut world, &law).unwrap();
    let mut contacts = 0;
    for _ in 0..6000 {
        step(&mut world, &law).unwrap();
        contacts += world.contact_histories().count();
    }
    assert!(contacts > 6000, "grains hit and rest on each other");
    bitgrain_kernel::digest(&world).unwrap().whole
}

/// The verb `debug` of `.ci/run` builds what it says.
#[test]
#[ignore = "for `.ci/run debug`, whose build has such checks"]
#[should_panic(expected = "overflow")]
fn overflow_is_looked_for() {
    std::hint::black_box(std::hint::black_box(i32::MAX) + 1);
}
