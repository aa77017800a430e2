//! The energy budget of a simulation: it closes, by terms that are all needed, and changes nothing.

use bitgrain::case::GrainSpec;
use bitgrain::checkpoint;
use bitgrain::energy_budget::{Audit, EnergyRow};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::simulation::Simulation;
use bitgrain_tests::{ball, floor, golden_case, open_case, output, settled_bed};

/// The largest residual of the balance, over the work done.
const CLOSED: f64 = 1e-3;

fn kumar(kn: f64, gamma: f64, mu: f64) -> LawSpec {
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn,
        kt: 1.225 * kn,
        gamma_n: gamma,
        gamma_t: gamma,
        mu,
        rolling: None,
    })
}

fn guillard(young: f64, restitution: f64, mu: f64) -> LawSpec {
    LawSpec::HertzTsuji(HertzTsujiParameters {
        young,
        poisson: 0.3,
        restitution,
        mu,
        rolling: None,
    })
}

fn spun(id: u32, position: [f64; 3], velocity: [f64; 3], spin: f64) -> GrainSpec {
    GrainSpec {
        spin: [0.0, 0.0, spin],
        ..ball(id, position, velocity)
    }
}

/// A grain on its way to a floor.
fn hits_floor(law: LawSpec, velocity: [f64; 3], dt: f64) -> Simulation {
    let grain = ball(1, [0.0, 0.0, 0.5005], velocity);
    let case = open_case(law, dt, vec![grain], vec![floor()]);
    case.start("floor", |_| {}).expect("a sound case")
}

/// Two grains on their way to each other: half the relative velocity, the offset across it, the spin of
/// both about the axis that the pair will turn about.
fn meets(law: LawSpec, velocity: [f64; 2], offset: f64, spin: f64, dt: f64) -> Simulation {
    let apart = (1.0 - offset * offset).sqrt() + 5e-4;
    let [x, y] = velocity;
    let grains = vec![
        spun(1, [0.0; 3], [x, y, 0.0], spin),
        spun(2, [apart, offset, 0.0], [-x, -y, 0.0], spin),
    ];
    let case = open_case(law, dt, grains, vec![]);
    case.start("pair", |_| {}).expect("a sound case")
}

/// The budget after this many steps, and its largest residual over the work done by then.
fn followed(sim: &mut Simulation, steps: u64) -> (EnergyRow, f64) {
    let mut audit = Audit::new(sim);
    let mut worst = 0.0;
    for _ in 0..steps {
        audit.step(sim).expect("a sound case");
        let open = audit.row(0).closure().abs();
        worst = if open > worst { open } else { worst };
    }
    assert!(audit.is_finite());
    (audit.row(sim.step_count()), worst)
}

/// One grain or two under both laws, with and without friction and damping: some 45, 90 and 180 steps a
/// contact; the fastest slide goes 40 times the spring's length in a step. Halving the time step
/// leaves a quarter of the largest residual while a contact lasts.
#[test]
fn the_account_of_a_collision_closes_with_the_square_of_the_time_step() {
    let laws = [
        kumar(2e5, 0.0, 0.0),
        kumar(2e5, 0.0, 0.5),
        kumar(2e5, 792.0, 0.5),
        kumar(2e5, 792.0, 0.1),
        kumar(2e5, 0.0, 10.0),
        guillard(2e5, 1.0, 0.5),
        guillard(2e5, 0.6, 0.5),
        guillard(2e5, 0.6, 0.1),
        guillard(2e5, 1.0, 10.0),
    ];
    let mut most: f64 = 0.0;
    for law in laws {
        for velocity in [[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [20.0, 0.0, -1.0]] {
            let open = |dt: f64| followed(&mut hits_floor(law, velocity, dt), (0.1 / dt) as u64);
            check_convergence(open, &format!("{law:?} {velocity:?}"), &mut most);
        }
        for (velocity, offset, spin) in [([0.5, 0.1], 0.1, 5.0), ([0.5, 10.0], 0.1, -8.0)] {
            let open = |dt: f64| {
                let mut sim = meets(law, velocity, offset, spin, dt);
                followed(&mut sim, (0.1 / dt) as u64)
            };
            check_convergence(open, &format!("{law:?} {velocity:?}"), &mut most);
        }
    }
    println!("open by {most:.1e} at most");
}

fn check_convergence(open: impl Fn(f64) -> (EnergyRow, f64), what: &str, most: &mut f64) {
    let worst = [4e-4, 2e-4, 1e-4].map(|dt| {
        let (row, worst) = open(dt);
        assert!(row.work > 0.2, "{what}");
        assert!(row.closure().abs() < CLOSED / 2.0, "{what}: {row:?}");
        worst
    });
    *most = if worst[0] > *most { worst[0] } else { *most };
    // In the middle of a contact both ends of the trapezoidal rule show, at some 90 steps a contact.
    assert!(worst[1] < 1.5 * CLOSED, "{what}: {worst:?}");
    // Sixteen, unless a contact begins, sticks or ends in another step; and the little that is left then.
    assert!(
        worst[0] > 9.0 * worst[2] || worst[0] < 2e-6,
        "{what}: {worst:?}"
    );
    if what.contains("[0.0, 0.0, -1.0]") {
        let ratios = worst.windows(2).map(|pair| pair[0] / pair[1]);
        assert!(
            ratios.clone().all(|r| (3.5..4.7).contains(&r)),
            "{what}: {worst:?}"
        );
    }
}

/// Cases with many bodies: name, simulation, steps, and the closure measured.
fn crowds() -> Vec<(&'static str, Simulation, u64, f64)> {
    let golden = |name: &str| golden_case(name).start(name, |_| {}).expect("a sound case");
    vec![
        ("collapse.json", golden("collapse.json"), 6000, 1e-4),
        ("materials.json", golden("materials.json"), 4000, 2e-4),
        ("rolling.json", golden("rolling.json"), 4000, 4e-4),
        ("lid.json", golden("lid.json"), 6000, 8e-4),
        (
            "lid.json:hertz_history",
            golden("lid.json:hertz_history"),
            6000,
            8e-4,
        ),
        ("rig.json", golden("rig.json"), 6000, 3e-4),
        (
            "rig.json:hertz_history",
            golden("rig.json:hertz_history"),
            6000,
            3e-4,
        ),
        ("the dragged bed of 2,500 grains", settled_bed(), 3000, 1e-4),
    ]
}

/// Carried bases and lids, cylinders, balls and planes, with and without weight, under both laws; and a
/// settled bed that a ball is dragged through. Over the net work of the ball alone the residual of the last is
/// as large.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn the_account_of_many_grains_closes() {
    for (name, mut sim, steps, measured) in crowds() {
        let (row, worst) = followed(&mut sim, steps);
        println!(
            "{name}: {:+.1e}, at worst {worst:.1e}; {row:?}",
            row.closure()
        );
        assert!(worst < CLOSED, "{name}: {worst:e}");
        assert!(
            row.closure().abs() < measured,
            "{name}: {:e}",
            row.closure()
        );
        if name.contains("2,500") {
            assert!(
                row.residual.abs() < 1.5 * measured * row.obstacles,
                "{row:?}"
            );
        }
    }
}

/// Names of the terms with their signs in the balance, whose residual is their sum.
fn terms(row: &EnergyRow) -> [(&'static str, f64); 12] {
    [
        ("kinetic", row.kinetic),
        ("normal", row.normal),
        ("tangential", row.tangential),
        ("gravitational", row.gravitational),
        ("obstacles", -row.obstacles),
        ("carriers", -row.carriers),
        ("normal_damping", row.normal_damping),
        ("tangential_damping", row.tangential_damping),
        ("sliding", row.sliding),
        ("stiffening", -row.stiffening),
        ("projection", row.projection),
        ("erased", row.erased),
    ]
}

/// Every term is needed: for each there is a case whose balance closes with it and without it has a residual above
/// a thousandth of the work done. (Of the three state terms that are not zero at the start
/// of a case, the change is left out.)
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn without_any_one_term_the_account_is_open() {
    // Soft grains that turn about each other while they touch, with more friction than they can use.
    let turns = meets(guillard(2e3, 1.0, 1e3), [1.0, 3.0], 0.5, 2.0, 2e-3);
    let slides = hits_floor(kumar(2e5, 0.0, 0.5), [1.0, 0.0, -1.0], 1e-4);
    let damped = hits_floor(guillard(2e5, 0.6, 0.5), [1.0, 0.0, -1.0], 1e-4);
    let lid = golden_case("lid.json")
        .start("lid", |_| {})
        .expect("a sound case");
    let cases = [
        (
            "turns",
            turns,
            300,
            &["projection", "erased", "kinetic"][..],
        ),
        (
            "slides",
            slides,
            1000,
            &["sliding", "stiffening", "kinetic"],
        ),
        (
            "damped",
            damped,
            1000,
            &["normal_damping", "tangential_damping"],
        ),
        ("lid", lid, 3000, &["carriers", "gravitational"]),
        (
            "quick",
            settled_bed(),
            1000,
            &["obstacles", "normal", "tangential"],
        ),
    ];
    let mut needed = std::collections::BTreeSet::new();
    for (name, mut sim, steps, terms_needed) in cases {
        let mut audit = Audit::new(&mut sim);
        let begin = audit.row(0);
        for _ in 0..steps {
            audit.step(&mut sim).expect("a sound case");
        }
        let row = audit.row(0);
        assert!(row.closure().abs() < CLOSED, "{name}: {:e}", row.closure());
        let changes = terms(&row).into_iter().zip(terms(&begin));
        for ((term, now), (_, before)) in changes {
            let open = (row.residual - (now - before)) / row.work;
            if terms_needed.contains(&term) {
                assert!(open.abs() > CLOSED, "{name} without {term}: {open:e}");
                needed.insert(term);
            }
        }
    }
    let all = terms(&EnergyRow::default());
    assert_eq!(needed.len(), all.len(), "{needed:?}");
}

/// A term that must vanish is zero, to rounding: each term is computed by itself.
#[test]
fn terms_are_zero_where_the_law_has_nothing_of_them() {
    let zero = |what: &str, part: f64, row: &EnergyRow| {
        assert!(part.abs() < 1e-12 * row.work, "{what}: {part:e} of {row:?}");
    };
    // Nothing slides at a friction that is never reached, and nothing is damped.
    let (row, _) = followed(
        &mut meets(kumar(2e5, 0.0, 1e6), [0.5, 0.2], 0.1, 5.0, 1e-4),
        1000,
    );
    assert!(row.stiffening.abs() > 1e-3 * row.work && row.erased != 0.0);
    zero("sliding", row.sliding, &row);
    zero("damping", row.normal_damping, &row);
    zero("damping", row.tangential_damping, &row);
    // Without friction a spring that alone is held to the cap holds nothing.
    let free = guillard(2e5, 0.6, 0.0);
    let (row, _) = followed(&mut hits_floor(free, [1.0, 0.0, -1.0], 1e-4), 1000);
    assert!(row.normal_damping > 0.1 * row.work);
    for part in [
        row.tangential_damping,
        row.sliding,
        row.stiffening,
        row.erased,
    ] {
        zero("tangential", part, &row);
    }
    // With the damper on the cap too the spring is bent, but no damper works outside of sliding.
    let free = kumar(2e5, 792.0, 0.0);
    let (row, _) = followed(&mut hits_floor(free, [1.0, 0.0, -1.0], 1e-4), 1000);
    zero("tangential damping", row.tangential_damping, &row);
    // On a flat floor with the full radius as lever nothing turns.
    let law = kumar(2e5, 792.0, 0.5);
    let (row, _) = followed(&mut hits_floor(law, [1.0, 0.0, -1.0], 1e-4), 1000);
    assert!(
        row.tangential_damping > 1e-3 * row.work && row.sliding > 1e-3 * row.work,
        "{row:?}"
    );
    zero("projection", row.projection, &row);
    // Nothing moves the floor, and nothing carries the grain.
    assert_eq!((row.obstacles, row.carriers), (0.0, 0.0));
    // The ball rests in the end: what it lost was dissipated, stored by nothing.
    assert_eq!((row.normal, row.tangential), (0.0, 0.0));
}

/// The budget changes no bit of the simulation, and goes on from a saved copy of itself and of the
/// state with the same bits as without saving.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn a_follower_changes_no_bit_and_can_be_saved() {
    let begin = |name: &str| golden_case(name).start(name, |_| {}).expect("a sound case");
    for name in ["rolling.json", "rig.json", "rig.json:hertz_history"] {
        let (mut plain, mut sim) = (begin(name), begin(name));
        plain.steps(1500).unwrap();
        let mut audit = Audit::new(&mut sim);
        for _ in 0..700 {
            audit.step(&mut sim).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state.safetensors");
        checkpoint::write(&path, &mut sim).unwrap();
        let saved = serde_json::to_string(&audit).unwrap();
        let mut resumed = checkpoint::read(&path).unwrap();
        let mut again: Audit = serde_json::from_str(&saved).unwrap();
        assert_eq!(again, audit, "{name}");
        for _ in 700..1500 {
            audit.step(&mut sim).unwrap();
            again.step(&mut resumed).unwrap();
        }
        assert_eq!(again, audit, "{name}");
        assert_eq!(sim.digest(), plain.digest(), "{name}");
        assert_eq!(resumed.digest(), plain.digest(), "{name}");
    }
}

/// `bitgrain replay --energy` prints the budget with each sample, and the same states as without.
#[test]
fn a_replay_prints_the_account() {
    let program = env!("CARGO_BIN_EXE_bitgrain-under-test");
    let case = "golden/cases/rig.json";
    let args = [
        "replay",
        case,
        "--steps",
        "400",
        "--every",
        "150",
        "--contacts",
    ];
    let told = |more: &[&str]| {
        let out = output(
            program,
            &bitgrain_tests::root(),
            &[&args[..], more].concat(),
        );
        assert!(out.status.success());
        String::from_utf8(out.stdout).unwrap()
    };
    let (plain, whole) = (told(&[]), told(&["--energy"]));
    let mut lines = 0;
    for (plain, whole) in plain.lines().zip(whole.lines()) {
        let mut sample: serde_json::Value = serde_json::from_str(whole).unwrap();
        let energy = sample.as_object_mut().unwrap().remove("energy").unwrap();
        assert_eq!(
            sample,
            serde_json::from_str::<serde_json::Value>(plain).unwrap()
        );
        for (term, _) in terms(&EnergyRow::default()) {
            assert!(energy[term].is_f64(), "{term}");
        }
        let (work, left) = (
            energy["work"].as_f64().unwrap(),
            energy["residual"].as_f64(),
        );
        assert!(left.unwrap().abs() <= CLOSED * work, "{energy}");
        lines += 1;
    }
    assert_eq!(lines, 4);
}
