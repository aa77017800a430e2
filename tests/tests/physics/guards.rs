//! Guards: what is refused before a run, what stops one, and that each of them fires.

use bitgrain::case::{BoxSpec, Case, ObstacleSpec};
use bitgrain::error::Error;
use bitgrain::law::{CONTACT_FRACTION_MAX, HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::observe::deepest_overlap;
use bitgrain::scenario;
use bitgrain::summary::LARGE_OVERLAP;
use bitgrain_kernel::Error as KernelError;
use bitgrain_tests::{SMALL, ball, floor, golden, open_case, output, settled_bed, told};

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

fn kumar(gamma: f64) -> LawSpec {
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: gamma,
        gamma_t: gamma,
        mu: 0.5,
        rolling: None,
    })
}

/// Of the stiffness of [`kumar`].
fn guillard(restitution: f64) -> LawSpec {
    LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 2e5 * 1.5 * 0.91,
        poisson: 0.3,
        restitution,
        mu: 0.5,
        rolling: None,
    })
}

/// Two grains that meet at this speed after `gap`: how long they touch, and their restitution.
fn collide(law: LawSpec, speed: f64, dt: f64, gap: f64) -> (f64, f64) {
    let grains = vec![
        ball(1, [0.0; 3], [0.5 * speed, 0.0, 0.0]),
        ball(2, [1.0 + gap, 0.0, 0.0], [-0.5 * speed, 0.0, 0.0]),
    ];
    let case = open_case(law, dt, grains, vec![]);
    let mut sim = case.start("collision", |_| {}).expect("a sound case");
    let mut touching = 0;
    for _ in 0..100_000 {
        let mut touch = false;
        sim.step_watched(|_| touch = true).expect("a sound case");
        touching += u32::from(touch);
        if touching > 0 && !touch {
            let apart = sim.velocity[1][0] - sim.velocity[0][0];
            return (f64::from(touching) * dt, apart / speed);
        }
    }
    panic!("the grains stay together");
}

/// The closed form against the kernel, slow and fast, soft and stiff: to a step of a thousand.
#[test]
fn an_undamped_collision_lasts_as_long_as_foreseen() {
    for law in [kumar(0.0), guillard(1.0)] {
        for speed in [0.01, 1.3, 20.0] {
            let foreseen = law.contact_duration(speed, 0.5, 1.0);
            let (lasted, e) = collide(law, speed, foreseen / 1000.0, 1e-9);
            assert!(
                (lasted / foreseen - 1.0).abs() < 2e-3,
                "{lasted} {foreseen}"
            );
            assert!((e - 1.0).abs() < 1e-6, "{e}");
        }
    }
}

/// The reason for the bound: how far restitution is off, at worst over the moments within a step at which grains meet.
/// At a tenth of the duration it is off by 0.003, 0.005 and 0.022; at a sixth by 0.011, 0.027 and 0.058.
#[test]
fn at_the_longest_time_step_collisions_come_out_right() {
    for (law, within) in [
        (kumar(0.0), 0.003),
        (kumar(792.0), 0.0055),
        (guillard(0.6), 0.0225),
    ] {
        for speed in [1.0, 6.0] {
            let duration = law.contact_duration(speed, 0.5, 1.0);
            let (_, fine) = collide(law, speed, duration / 2000.0, 1e-9);
            let worst = |fraction: f64| {
                let dt = fraction * duration;
                let off = (0..40).map(|k| {
                    let gap = speed * dt * (f64::from(k) + 0.5) / 40.0;
                    (collide(law, speed, dt, gap).1 - fine).abs()
                });
                off.fold(0.0, |a, b| if b > a { b } else { a })
            };
            let (at, beyond) = (worst(CONTACT_FRACTION_MAX), worst(1.0 / 6.0));
            assert!(
                at < within && beyond > 2.0 * at,
                "{law:?} {speed}: {at} {beyond}"
            );
        }
    }
}

/// A time step may pass by the Rayleigh time and be too long for collisions at the speed of the drag; at
/// the speed of its pouring a bed is judged too. What passes both passes.
#[test]
fn a_time_step_too_long_for_collisions_is_refused() {
    let load = |sets: &[&str]| {
        let soft = ["law.kn=2e5", "law.kt=2.45e5"];
        let sets = soft.iter().chain(sets).map(|s| s.to_string());
        scenario::load("quick", &sets.collect::<Vec<_>>()).map_err(|e| e.to_string())
    };
    let fast = "intruder.speed=[30.0]";
    let far = "drag.distance=16.0";
    let every = "measure.every=1";
    let refused = load(&["drag.dt=9e-4", fast, far, every]).unwrap_err();
    assert!(refused.contains("`drag.dt`: is 0.0009"), "{refused}");
    assert!(
        refused.contains("a collision at the speed of the drag, 30.0000"),
        "{refused}"
    );
    // As long as stated.
    let limit = refused.split("of it, ").nth(1).unwrap();
    let limit: f64 = limit.split(',').next().unwrap().parse().unwrap();
    let just = format!("drag.dt={:e}", 0.999 * limit);
    assert!(load(&[&just, fast, far, every]).is_ok());
    let beyond = format!("drag.dt={:e}", 1.001 * limit);
    assert!(load(&[&beyond, fast, far, every]).is_err());

    let slow = "intruder.speed=[0.375]";
    let near = "drag.distance=16.0";
    let quick = load(&["drag.dt=9e-4", slow, near, every]).unwrap();
    assert_eq!(quick.fastest().1, "a fall through the bed");
    assert!(quick.drag.dt < CONTACT_FRACTION_MAX * quick.shortest_contact());
    for name in [
        "kumar-system-1",
        "kumar-system-2",
        "guillard-small",
        "guillard-2014",
    ] {
        let shipped = scenario::load(name, &[]).unwrap();
        let steps = shipped.shortest_contact() / shipped.drag.dt;
        assert!(steps > 1.5 / CONTACT_FRACTION_MAX, "{name}: {steps}");
    }
}

/// Both times are printed before a run and as it starts.
#[test]
fn both_times_are_printed() {
    let quick = scenario::load("quick", &[]).unwrap();
    let line = quick.time_step_line();
    for part in [
        "time step 0.0008 sqrt(d/g): 0.1887",
        "of the Rayleigh time",
        "of the duration of a collision at the speed of a fall through the bed",
    ] {
        assert!(line.contains(part), "{line}");
    }
    let folder = tempfile::tempdir().unwrap();
    let out = output(PROGRAM, folder.path(), &["run", "quick", "--dry-run"]);
    let text = String::from_utf8(out.stdout).unwrap();
    for part in ["time step / Rayleigh time", "time step / collision"] {
        assert!(text.contains(part), "{text}");
    }
}

/// A grain with its lowest point this deep in a body whose highest point is at z = 0.
fn laid_on(body: ObstacleSpec, depth: f64) -> Case {
    let grain = ball(7, [0.0, 0.0, 0.5 - depth], [0.0; 3]);
    open_case(kumar(792.0), 1e-4, vec![grain], vec![body])
}

fn sphere(diameter: f64) -> ObstacleSpec {
    ObstacleSpec::sphere([0.0, 0.0, -0.5 * diameter], diameter)
}

fn bar(diameter: f64) -> ObstacleSpec {
    ObstacleSpec::cylinder([0.0, 0.0, -0.5 * diameter], [0.0, 1.0, 0.0], diameter)
}

fn fault(told: &Result<bitgrain::simulation::Simulation, Error>) -> Option<KernelError> {
    match told {
        Err(Error::Run { fault, .. }) => Some(*fault),
        _ => None,
    }
}

/// The limit is half the smaller radius, for grains and for every kind of obstacle, at the start.
#[test]
fn an_overlap_beyond_half_the_smaller_radius_is_refused() {
    let on_obstacle = Some(KernelError::ObstacleTooDeep { id: 7, obstacle: 0 });
    for (body, limit) in [
        (floor(), 0.25),
        (sphere(4.0), 0.25),
        (sphere(0.5), 0.125),
        (bar(4.0), 0.25),
        (bar(0.5), 0.125),
    ] {
        let start = |depth| laid_on(body.clone(), depth).start("deep", |_| {});
        assert!(start(limit - 1e-6).is_ok(), "{body:?}");
        assert_eq!(fault(&start(limit + 1e-6)), on_obstacle, "{body:?}");
    }
    let pair = |diameter: f64, depth: f64| {
        let mut other = ball(9, [0.5 + 0.5 * diameter - depth, 0.0, 0.0], [0.0; 3]);
        other.diameter = diameter;
        let grains = vec![ball(7, [0.0; 3], [0.0; 3]), other];
        open_case(kumar(792.0), 1e-4, grains, vec![]).start("deep", |_| {})
    };
    for (diameter, limit) in [(1.0, 0.25), (0.5, 0.125), (2.0, 0.25)] {
        assert!(pair(diameter, limit - 1e-6).is_ok());
        let found = fault(&pair(diameter, limit + 1e-6));
        assert_eq!(found, Some(KernelError::OverlapTooDeep { i: 7, j: 9 }));
    }
}

/// During a run: a grain that hits as fast as its contact is too soft for stops the run in the step that
/// goes too deep, whatever it hits; at a third of the speed it bounces.
#[test]
fn an_overlap_too_deep_stops_a_run() {
    let run = |mut case: Case, speed: f64| {
        case.grains[0].velocity = [0.0, 0.0, -speed];
        case.grains[0].position[2] = 0.501;
        let mut sim = case.start("hit", |_| {}).expect("a sound case");
        let done = sim.steps(2000);
        (done, sim.step_count())
    };
    for body in [floor(), sphere(4.0), bar(4.0)] {
        let (done, steps) = run(laid_on(body.clone(), 0.0), 150.0);
        assert_eq!(
            done,
            Err(KernelError::ObstacleTooDeep { id: 7, obstacle: 0 }),
            "{body:?}"
        );
        assert!((5..60).contains(&steps), "{steps}");
        assert_eq!(run(laid_on(body.clone(), 0.0), 50.0).0, Ok(()));
    }
    let mut pair = laid_on(floor(), 0.0);
    pair.obstacles.clear();
    pair.grains.push(ball(9, [0.0, 0.0, -0.5], [0.0; 3]));
    let (done, _) = run(pair.clone(), 250.0);
    assert_eq!(done, Err(KernelError::OverlapTooDeep { i: 7, j: 9 }));
    assert_eq!(run(pair, 50.0).0, Ok(()));
}

/// In the soft bed of 2,500 grains overlaps exceed the range of Hertz's law if its ball moves fast, and not if
/// it moves slowly.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn a_fast_drag_through_soft_grains_overlaps_deeply() {
    let deepest = |speed: f64| {
        let mut sim = settled_bed();
        sim.obstacles[0].velocity = [speed, 0.0, 0.0];
        let mut deepest = 0.0;
        for _ in 0..2500 {
            sim.steps(1).unwrap();
            let contacts = sim.count_contacts();
            deepest = deepest_overlap(&sim, &contacts).max(deepest);
        }
        deepest
    };
    let (slow, fast) = (deepest(0.5), deepest(8.0));
    assert!(slow > 0.005 && slow <= LARGE_OVERLAP, "{slow}");
    assert!(fast > LARGE_OVERLAP, "{fast}");
}

/// A closed box of 4 by 4 by 4 with a grain in its middle.
fn closed() -> Case {
    let grain = ball(5, [2.0; 3], [0.0; 3]);
    let mut case = open_case(kumar(792.0), 1e-4, vec![grain], vec![]);
    case.bounds = Some(BoxSpec {
        lo: [0.0; 3],
        hi: [4.0; 3],
        periodic: [false; 3],
    });
    case
}

/// A grain whose centre passes a closed edge stops the run in that step, with its name and a hint; an
/// edge that is periodic lets it through.
#[test]
fn a_grain_that_leaves_through_any_closed_edge_stops_the_run() {
    for axis in 0..3 {
        for way in [-10.0, 10.0] {
            let mut case = closed();
            case.grains[0].velocity[axis] = way;
            let mut sim = case.start("edge", |_| {}).unwrap();
            let escaped = sim.steps(5000).unwrap_err();
            assert_eq!(escaped, KernelError::Escaped { id: 5 });
            // Two lengths at ten a time: 2,000 steps, up to the rounding of their sum.
            assert!(
                (1999..=2000).contains(&sim.step_count()),
                "{}",
                sim.step_count()
            );
            let told = Error::run("edge", sim.step_count() + 1, escaped).to_string();
            for part in [
                "grain 5 left the box",
                "make the box higher, or see what pushed",
            ] {
                assert!(told.contains(part), "{told}");
            }
            case.bounds.as_mut().unwrap().periodic[axis] = true;
            let mut sim = case.start("edge", |_| {}).unwrap();
            assert_eq!(sim.steps(5000), Ok(()));
        }
    }
}

/// A ball that comes down beside a grain squeezes it out through the closed edge.
fn squeezed() -> Case {
    let mut case = closed();
    case.law = LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 792.0,
        gamma_t: 792.0,
        mu: 0.1,
        rolling: None,
    })
    .into();
    case.grains[0].position = [3.8, 2.0, 0.499];
    let down = ObstacleSpec {
        velocity: [0.0, 0.0, -2.0],
        ..ObstacleSpec::sphere([2.5, 2.0, 2.0], 2.0)
    };
    case.obstacles = vec![down, floor()];
    case
}

#[test]
fn a_grain_that_is_squeezed_out_stops_the_run() {
    let mut sim = squeezed().start("squeeze", |_| {}).unwrap();
    assert_eq!(sim.steps(20_000), Err(KernelError::Escaped { id: 5 }));
    assert!(sim.position[0][0] >= 4.0);
}

/// The messages, by command.
#[test]
fn guards_teach() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    let mut tell = |what: &str, file: &str, content: &str, args: &[&str], status: i32| {
        std::fs::write(folder.path().join(file), content).unwrap();
        let out = output(PROGRAM, folder.path(), args);
        assert_eq!(out.status.code(), Some(status), "{what}");
        text.push_str(&format!("# {what}\n{}", told(args, &out)));
    };
    let run = ["run", "bed.toml"];
    let slow = SMALL.replacen("dt = 3e-4", "dt = 9.4e-4", 1);
    let fast = slow.replacen("speed = 1.0", "speed = 40.0", 1);
    tell(
        "a time step too long for collisions",
        "bed.toml",
        &fast,
        &run,
        2,
    );
    let long = SMALL.replacen("dt = 3e-4", "dt = 1e-3", 1);
    tell("a time step too long for waves", "bed.toml", &long, &run, 2);
    let replay = ["replay", "case.json", "--steps", "20000"];
    let case = |case: &Case| serde_json::to_string(case).unwrap();
    for (what, body) in [("plane", floor()), ("ball", sphere(4.0)), ("bar", bar(4.0))] {
        let what = format!("a grain too deep in a {what}");
        tell(&what, "case.json", &case(&laid_on(body, 0.26)), &replay, 3);
    }
    tell(
        "a grain squeezed out",
        "case.json",
        &case(&squeezed()),
        &replay,
        3,
    );
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(
        "recipe: `cargo test -p bitgrain-tests --release --test physics guards::`",
    );
    settings.bind(|| insta::assert_snapshot!("guards", text));
}
