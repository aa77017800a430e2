//! Spheres that forces move, as scenarios ask for them: dropped, pulled, dragged and free to rise. Closed forms without
//! grains; energy and momentum; the same bits by any threads, from any checkpoint; goldens.

use std::path::Path;

use bitgrain::bed::library::BedCache;
use bitgrain::checkpoint;
use bitgrain::drag::{Dragging, drag};
use bitgrain::folder::Folder;
use bitgrain::manifest::{FolderKind, Vouched};
use bitgrain::present::series;
use bitgrain::progress::{Progress, Stage};
use bitgrain::released::text;
use bitgrain::scenario::{self, CheckedScenario, DragPlan, Release};
use bitgrain::series::SeriesRow;
use bitgrain::simulation::{Grain, Simulation, hex, sphere_mass};
use bitgrain::summary::{DragSummary, Summary, read_summary};
use bitgrain::threads::on_threads;
use bitgrain_kernel::{Domain, Group, Obstacle};
use bitgrain_tests::{SMALL, assert_named, golden, printed};

/// A scenario of 300 grains whose intruder moves so, in a bed that has hardly settled.
fn small(intruder: &str, drag: &str) -> CheckedScenario {
    let text = SMALL
        .replacen("[8.0, 6.0, 6.0]", "[8.0, 6.0, 8.0]", 1)
        .replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1)
        .replacen("height = 2.5\nspeed = 1.0", intruder, 1)
        .replacen("distance = 4.0", drag, 1);
    let text = text + "\n[measure]\nevery = 20\nsnapshots = 0\nenergy = true\n";
    scenario::parse(&text, "small", &[], Path::new("")).unwrap()
}

fn dropped() -> CheckedScenario {
    let intruder = "motion = \"dropped\"\ndensity = 2.0\ndrop_height = [0.5, 4.0, 12.0]";
    small(intruder, "duration = 3.0")
}

fn pulled() -> CheckedScenario {
    let intruder = "motion = \"pulled\"\nheight = 2.5\nspeed = 1.0\nforce = [10.0, 60.0, 120.0]\n\
                    rises = true\nspins = true";
    small(intruder, "distance = 4.0\nduration = 2.0")
}

fn floating() -> CheckedScenario {
    let intruder = "motion = \"floating\"\ndensity = 8.0\nheight = [3.0, 4.4]\nspeed = 1.0";
    small(intruder, "distance = 4.0")
}

/// A run and what it left.
struct Made {
    folder: tempfile::TempDir,
    summary: Summary,
    series: Vec<Vec<SeriesRow>>,
}

fn made(scenario: &CheckedScenario) -> Made {
    let folder = tempfile::tempdir().unwrap();
    let library = BedCache::new(folder.path().join("beds"));
    let out = folder.path().join("out");
    bitgrain::present::run(scenario, &out, &library, 2, &Progress::new(false)).unwrap();
    assert_named(&out);
    let summary = read_summary(&out.join("summary.json")).unwrap();
    let vouched = Vouched::open(&out, FolderKind::Run).unwrap();
    let series = series(&Folder(&out), &vouched, &summary).unwrap();
    Made {
        folder,
        summary,
        series,
    }
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("released"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(
        "recipe: `cargo test -p bitgrain-tests --release --test physics released::`",
    );
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// A sphere of diameter 2 over a plane, and one frozen grain far away: no force but gravity and the host's.
fn alone(plan: &DragPlan) -> Simulation {
    let domain = Domain::new([0.0; 3], [40.0, 40.0, 60.0], [true, true, false]).unwrap();
    let grain = Grain {
        id: 1,
        group: 0,
        diameter: 1.0,
        density: 1.0,
        position: [2.0, 2.0, 0.5],
        velocity: [0.0; 3],
        spin: [0.0; 3],
    };
    let sphere = Obstacle {
        inverse_mass: 1.0 / sphere_mass(2.0, 3.0),
        ..Obstacle::sphere([20.0, 20.0, 30.0], 1.0)
    };
    let plane = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    let law = dropped().contact_law();
    let groups = vec![Group::frozen()];
    let bodies = vec![sphere, plane];
    let mut sim = Simulation::new(law, domain, plan.motion.dt, groups, &[grain], bodies);
    sim.start().unwrap();
    sim
}

/// The rows of a plan without grains.
fn rows(plan: &DragPlan) -> Vec<SeriesRow> {
    drag(&mut alone(plan), plan, &mut ()).unwrap().1.series
}

fn plan(scenario: &CheckedScenario, wanted: impl Fn(Release) -> bool) -> DragPlan {
    let mut plans = scenario.drags().iter();
    let mut plan = plans.find(|plan| wanted(plan.release)).unwrap().clone();
    // Of a chain of digests nothing is asked here.
    plan.energy = false;
    plan
}

/// Largest part by which numbers may be off that took so many additions.
const ROUNDING: f64 = 1e-10;

#[test]
fn without_grains_a_drop_is_a_parabola() {
    let plan = plan(&dropped(), |release| {
        release == Release::Dropped { height: 12.0 }
    });
    let rows = rows(&plan);
    // From a tenth of d above the surface, the grain's top at 1, with the energy of the fall from 12 above it.
    let (begin, fallen) = (1.0 + 0.1 + 1.0, 12.0 - 0.1);
    let speed = (2.0f64 * fallen).sqrt();
    for row in &rows {
        let (t, body) = (row.time, row.body.unwrap());
        let z = begin - speed * t - 0.5 * t * t;
        assert!(
            (body.place[2] - z).abs() < ROUNDING * z.abs().max(1.0),
            "{row:?}"
        );
        assert!((body.velocity[2] + speed + t).abs() < ROUNDING * speed);
        assert!((row.distance - (begin - z)).abs() < ROUNDING * 50.0);
        assert_eq!(
            (body.place[0], body.velocity[0], body.spin),
            (20.0, 0.0, [0.0; 3])
        );
    }
    let last = rows.last().unwrap();
    assert!((last.time - 3.0).abs() < 1e-9 && rows.len() == 500);
}

#[test]
fn without_grains_a_pull_is_a_parabola_and_a_floating_sphere_falls() {
    let plan_of = plan(&pulled(), |release| {
        matches!(release, Release::Pulled { force: 60.0, .. })
    });
    let mass = sphere_mass(2.0, 3.0);
    for row in rows(&plan_of) {
        let (t, body) = (row.time, row.body.unwrap());
        let travel = 0.5 * 60.0 / mass * t * t;
        assert!((row.distance - travel).abs() < ROUNDING * 40.0, "{row:?}");
        assert!((body.velocity[0] - 60.0 / mass * t).abs() < ROUNDING * 10.0);
        // It rises freely, so it falls.
        assert!((body.place[2] - 30.0 + 0.5 * t * t).abs() < ROUNDING * 30.0);
    }
    let plan_of = plan(&floating(), |release| {
        matches!(release, Release::Floating { .. })
    });
    for row in rows(&plan_of) {
        let (t, body) = (row.time, row.body.unwrap());
        assert!((row.distance - t).abs() < ROUNDING * 10.0, "{row:?}");
        assert!((body.place[2] - 30.0 + 0.5 * t * t).abs() < ROUNDING * 30.0);
        assert_eq!(body.velocity[0], 1.0);
    }
}

/// What the rows say of force and velocity is one motion: velocity Verlet changes momentum by the trapezoidal sum of
/// the forces, whose first and last halves are known.
fn check_momentum(made: &Made, run: &DragSummary, rows: &[SeriesRow], axis: usize, outer: f64) {
    let known = run.released.as_ref().unwrap();
    let out = made.folder.path().join("out");
    let bed = checkpoint::read_noted(&Folder(&out).bed(&run.bed))
        .unwrap()
        .0;
    let before = match made.summary.inputs.is_dropped() {
        true => 0.0,
        false => bed.obstacles[0].force[axis],
    };
    // Columns are drag and lift.
    let force = |values: [f64; 3]| [-values[0], f64::NAN, values[1]][axis];
    let (mut sum, mut step) = (0.0, 0);
    for row in rows {
        sum += force(row.force_mean) * (row.step - step) as f64;
        step = row.step;
    }
    let last = force(rows.last().unwrap().force);
    let dt = made.summary.inputs.drag.dt;
    let pushed = dt * (sum + 0.5 * (before - last)) + outer * dt * step as f64;
    let gained = known.mass * (known.end_velocity[axis] - known.begin_velocity[axis]);
    let scale = dt
        * rows
            .iter()
            .map(|row| force(row.force_mean).abs() * 20.0)
            .sum::<f64>();
    assert!(
        (pushed - gained).abs() < ROUNDING * (scale + gained.abs()),
        "{pushed} {gained}"
    );
    assert!(scale > 1.0, "something pushes it: {scale}");
}

/// Momentum, energy, and a run that is verified from its checkpoints.
fn check(made: &Made) {
    let scenario = &made.summary.inputs;
    for ((run, rows), plan) in made
        .summary
        .runs
        .iter()
        .zip(&made.series)
        .zip(scenario.drags())
    {
        let energy = run.energy.as_ref().unwrap();
        // Of first order in the overlap a step: a few parts in a thousand at these speeds.
        assert!(
            energy.closure().abs() < 5e-3,
            "{}: {}",
            run.name,
            energy.closure()
        );
        let Some(known) = &run.released else { continue };
        let weight = known.mass * scenario.gravity;
        match plan.release {
            Release::Pulled { force, .. } => check_momentum(made, run, rows, 0, force),
            _ => check_momentum(made, run, rows, 2, -weight),
        }
    }
    let program = env!("CARGO_BIN_EXE_bitgrain-under-test");
    let told = printed(
        program,
        made.folder.path(),
        &["verify", "out", "--sample", "3"],
        0,
    );
    assert!(!told.is_empty());
}

/// Found numbers, and the digests of the ends.
fn golden_text(made: &Made) -> String {
    let digests = made.summary.runs.iter();
    let digests: String = digests
        .map(|run| format!("{} {}\n", run.name, run.digest))
        .collect();
    text(&made.summary, &made.series) + &digests
}

#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_small_drop_gives_its_golden() {
    let made = made(&dropped());
    check(&made);
    let depths: Vec<f64> = made
        .summary
        .runs
        .iter()
        .map(|run| run.released.unwrap().penetration(run.diameter))
        .collect();
    assert!(
        depths.windows(2).all(|pair| pair[0] < pair[1]),
        "{depths:?}"
    );
    snapshot("small-impact", &golden_text(&made));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_small_pull_gives_its_golden() {
    let made = made(&pulled());
    check(&made);
    snapshot("small-pull", &golden_text(&made));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_small_floating_drag_gives_its_golden() {
    let made = made(&floating());
    check(&made);
    snapshot("small-float", &golden_text(&made));
}

/// However the steps are shared out, and wherever a run was stopped and taken up again.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn any_threads_and_stops_give_the_same_bits() {
    for scenario in [dropped(), pulled(), floating()] {
        let mut plan = scenario
            .drags()
            .iter()
            .rfind(|plan| plan.bed == 0)
            .unwrap()
            .clone();
        // An account of the energy is kept on one thread, and of one of them here.
        let accounts = matches!(plan.release, Release::Pulled { .. });
        plan.energy = accounts;
        let plan = &plan;
        let bed = &scenario.beds()[0];
        let settled = bitgrain::bed::pour(&scenario, bed, &mut Stage::silent()).unwrap();
        let run = |threads: usize, stop: Option<u64>| {
            let mut sim = settled.clone();
            sim.stepping.divide_always();
            sim.stepping.tunes = false;
            let mut dragging = Dragging::begin(&mut sim, plan, "").unwrap();
            let go = |dragging: &mut Dragging, sim: &mut Simulation, last: u64| {
                on_threads(threads, || {
                    dragging.go_on(sim, plan, &Stage::silent(), &mut Until(last))
                })
                .unwrap()
                .unwrap();
            };
            if let Some(step) = stop {
                go(&mut dragging, &mut sim, step);
                // By way of a file.
                let bytes = checkpoint::pack(&mut sim, &dragging.note()).unwrap();
                let (read, note) = checkpoint::unpack(&bytes, "here").unwrap();
                (sim, dragging) = (read, Dragging::of(&note).unwrap());
            }
            go(&mut dragging, &mut sim, u64::MAX);
            let known = dragging.released();
            let digest = hex(&sim.digest().unwrap().whole);
            (
                digest,
                dragging.chain.text(),
                known,
                dragging.record.series.clone(),
            )
        };
        let one = run(1, None);
        assert!(one.2.is_some());
        for (threads, stop) in [(3, None), (2, Some(1234)), (1, Some(plan.steps() - 7))] {
            if threads == 1 || !accounts {
                assert!(run(threads, stop) == one, "{threads} {stop:?}");
            }
        }
    }
}

/// Goes on to a step.
struct Until(u64);

impl bitgrain::observer::Observer for Until {
    fn last_step(&self) -> u64 {
        self.0
    }
}

/// The three shipped scenarios as a user runs them.
#[test]
#[ignore = "three minutes: `.ci/run long`"]
fn the_shipped_scenarios_give_their_goldens() {
    for name in ["impact-quick", "pull-quick", "float-quick"] {
        let made = made(&scenario::load(name, &[]).unwrap());
        snapshot(name, &golden_text(&made));
    }
}
