//! A bar that turns in a tank, as in Guillard 2014, section II, at a size of seconds, from end to end: its goldens, its
//! bed, the work of the bar, and a tank that turns round a bar at rest.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use bitgrain::bed::BASE;
use bitgrain::bed::library::BedCache;
use bitgrain::checkpoint::{self, StageState};
use bitgrain::drag::Dragging;
use bitgrain::progress::{Progress, Stage};
use bitgrain::scenario::{self, CheckedScenario};
use bitgrain::series::read_series;
use bitgrain::simulation::Simulation;
use bitgrain::summary::{Summary, Tank, read_summary};
use bitgrain_tests::tank::TANK;
use bitgrain_tests::{assert_named, golden, results};

fn scenario() -> CheckedScenario {
    scenario::parse(TANK, "tank", &[], Path::new("")).unwrap()
}

fn run_into(out: &Path, beds: &Path, threads: usize) {
    let library = BedCache::new(beds);
    bitgrain::present::run(&scenario(), out, &library, threads, &Progress::new(false)).unwrap();
}

/// One run that the tests of this file share.
struct Made {
    out: PathBuf,
    beds: PathBuf,
    whole: Summary,
}

/// Poured and turned once for all tests of this file: a quarter of a minute, because the budget of energy, which is
/// part of its goldens, is summed by one thread.
static MADE: LazyLock<Made> = LazyLock::new(|| {
    // Not a temporary folder: nothing that is static is ever dropped.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tank");
    let _ = std::fs::remove_dir_all(&folder);
    let (out, beds) = (folder.join("out"), folder.join("beds"));
    run_into(&out, &beds, 1);
    Made {
        whole: read_summary(&out.join("summary.json")).unwrap(),
        out,
        beds,
    }
});

impl Made {
    fn bed(&self) -> (Simulation, StageState) {
        checkpoint::read_noted(&self.out.join("beds/bed.safetensors")).unwrap()
    }

    fn tank(&self) -> &Tank {
        self.whole.runs[0].tank.as_ref().unwrap()
    }
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("tank"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings
        .set_description("recipe: `cargo test -p bitgrain-tests --release --test physics tank::`");
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// The numbers to read, and the hash of each file but the report, whose looks may change while its numbers do not.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn the_tank_gives_its_goldens() {
    let (bed, run, tank) = (&MADE.whole.beds[0], &MADE.whole.runs[0], MADE.tank());
    let mut text = format!(
        "{} grains, {} of them floor and wall; surface {:.6}, packing {:.6}, carried {:.6}\n\
         C_d {:.4} +- {:.2}, lift {:.4} +- {:.1} buoyancies, direct {:.4}, {:.4} turns\n",
        bed.grains,
        bed.frozen,
        bed.surface,
        bed.packing_fraction,
        bed.support / bed.weight,
        tank.drag_coefficient,
        tank.drag_coefficient_error,
        tank.lift_over_buoyancy,
        tank.lift_over_buoyancy_error,
        tank.direct.unwrap(),
        tank.turns,
    );
    for half in &tank.half_turns {
        text += &format!("drag {:.4}, lift {:.4}\n", half.drag.mean, half.lift.mean);
    }
    text += &format!("bed {}\nstate {}\n", bed.digest, run.digest);
    snapshot("summary", &text);
    assert_named(&MADE.out);
    let files = results(&MADE.out);
    let hashed = files.iter().filter(|(name, _)| *name != "report.html");
    let hashes = hashed.map(|(name, bytes)| format!("{}  {name}\n", blake3::hash(bytes).to_hex()));
    snapshot("files", &hashes.collect::<String>());
}

/// On two threads, with the bed at hand, every byte is the same as on one; and the last piece of the drag that accounts
/// for its energy, from a checkpoint on.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn threads_and_stops_change_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    // An account of the energy is kept on one thread.
    let sets = ["measure.energy=false", "drag.distance=4.0"].map(String::from);
    let short = scenario::parse(TANK, "tank", &sets, Path::new("")).unwrap();
    let runs = [1, 2].map(|threads| {
        let out = folder.path().join(format!("out{threads}"));
        let library = BedCache::new(&MADE.beds);
        bitgrain::present::run(&short, &out, &library, threads, &Progress::new(false)).unwrap();
        results(&out)
    });
    assert!(runs[0] == runs[1]);
    let scenario = scenario();
    let plan = &scenario.drags()[0];
    let at = |step: u64| {
        MADE.out
            .join(format!("runs/run-1/checkpoints/{step:012}.safetensors"))
    };
    let last = plan.checkpoints.len() - 2;
    let (mut sim, note) = checkpoint::read_noted(&at(plan.checkpoints[last])).unwrap();
    let mut dragging = Dragging::of(&note).unwrap();
    dragging
        .go_on(&mut sim, plan, &Stage::silent(), &mut ())
        .unwrap();
    let end = checkpoint::pack(&mut sim, &dragging.note()).unwrap();
    assert!(end == std::fs::read(at(plan.steps())).unwrap());
}

/// Floor and wall are the grains whose centres settled within the base's length of them, all others lie inside, and the
/// bed is at rest; those of the wall reach from the floor to the surface.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn floor_and_wall_are_grains() {
    let (scenario, (sim, _)) = (scenario(), MADE.bed());
    let (radius, base) = (0.5 * scenario.bed.size[0], scenario.bed.base);
    let mut highest = 0.0;
    for (i, x) in sim.position.iter().enumerate() {
        let [across, along] = [x[0] - radius, x[1] - radius];
        let out = (across * across + along * along).sqrt();
        let near = radius - out < base || x[2] < base;
        // Those of the floor were glued before the upper ones fell on them, and free ones settled a little after that.
        let frozen = sim.group[i] == BASE;
        assert!(
            frozen || radius - out > base - 0.02 && x[2] > base - 0.02,
            "{x:?}"
        );
        assert!(near || !frozen, "{x:?}");
        assert!(out + x[3] < radius + 0.05 && x[2] - x[3] > -0.05, "{x:?}");
        if frozen && x[2] > highest {
            highest = x[2];
        }
    }
    let bed = &MADE.whole.beds[0];
    assert!((bed.surface - highest).abs() < 1.0, "{highest}");
    assert!((bed.support / bed.weight - 1.0).abs() < 5e-4);
    // Between loose and close random packing, less what the wall makes.
    assert!((0.52..0.62).contains(&bed.packing_fraction), "{bed:?}");
}

/// The bar turns at a constant rate, so that its work is the torque times the angle; nothing else does work, and all of
/// it is found again as energy or heat.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn the_torque_does_the_work() {
    let (run, tank) = (&MADE.whole.runs[0], MADE.tank());
    let energy = run.energy.unwrap();
    let torque = run.drag_uncut * tank.length / 4.0;
    let angle = tank.turning_rate * run.steps as f64 * scenario().drag.dt;
    // Half a step at either end of tens of thousands.
    assert!(
        (energy.obstacles / (torque * angle) - 1.0).abs() < 1e-3,
        "{energy:?}"
    );
    assert!((energy.residual / energy.work).abs() < 1e-3, "{energy:?}");
    let end = checkpoint::read(&MADE.out.join(format!(
        "runs/run-1/checkpoints/{:012}.safetensors",
        run.steps
    )));
    let body = end.unwrap().obstacles[0];
    let [w, _, _, z] = body.orientation;
    let turned = 2.0 * z.atan2(w);
    let off = (angle - turned) / std::f64::consts::TAU;
    // Fifty thousand turns round.
    assert!((off - off.round()).abs() < 1e-11, "{off}");
    let series = read_series(&MADE.out.join("runs/run-1/forces.csv")).unwrap();
    let last = series.last().unwrap();
    assert_eq!(last.force[0], 0.0 - last.torque[2] * 4.0 / tank.length);
}

/// Forces on the bar along the first steps, in the mean: drag by the torque and lift.
fn means(series: &[[f64; 2]]) -> [f64; 2] {
    let sum = |k: usize| series.iter().map(|force| force[k]).sum::<f64>();
    [0, 1].map(|k| sum(k) / series.len() as f64)
}

/// The paper turns its tank round a bar at rest; here the bar turns in a tank at rest. Grains of floor and wall that
/// are carried round, and a bed that goes with them as it begins, put the same forces on the bar, but for those of the
/// order of `Omega^2 R/g` and what grains that feel them do otherwise.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn a_turning_tank_puts_the_same_forces_on_a_bar_at_rest() {
    let scenario = scenario();
    let rate = 0.1;
    let middle = 0.5 * scenario.bed.size[0];
    let forces = |sim: &Simulation| {
        let body = &sim.obstacles[0];
        [-body.torque[2], body.force[2]]
    };
    let (mut still, _) = MADE.bed();
    let histories = still.contact_histories();
    still.obstacles[0].angular_velocity[2] = rate;
    still.resume(&histories).unwrap();
    let (mut turning, _) = MADE.bed();
    for i in 0..turning.count() {
        let x = turning.position[i];
        let v = [rate * (x[1] - middle), -rate * (x[0] - middle)];
        (turning.velocity[i][0], turning.velocity[i][1]) = (v[0], v[1]);
        turning.spin[i][2] = -rate;
    }
    turning.obstacles[1].angular_velocity[2] = -rate;
    let wall = (0..turning.count()).filter(|&i| turning.group[i] == BASE);
    let (dt, wall) = (turning.dt, wall.collect::<Vec<usize>>());
    let (c, s) = ((-rate * dt).cos(), (-rate * dt).sin());
    let mut found: [Vec<[f64; 2]>; 2] = Default::default();
    for _ in 0..1500 {
        let histories = turning.contact_histories();
        for &i in &wall {
            // Along the chord, so that it stays on its circle.
            let [x, y] = [
                turning.position[i][0] - middle,
                turning.position[i][1] - middle,
            ];
            turning.velocity[i][0] = (c * x - s * y - x) / dt;
            turning.velocity[i][1] = (s * x + c * y - y) / dt;
            turning.spin[i][2] = -rate;
        }
        turning.resume(&histories).unwrap();
        turning.steps(1).unwrap();
        still.steps(1).unwrap();
        for (series, sim) in found.iter_mut().zip([&still, &turning]) {
            series.push(forces(sim));
        }
    }
    let [rest, moved] = found.map(|series| means(&series));
    for (a, b) in rest.into_iter().zip(moved) {
        // Omega^2 R/g is 0.065 here.
        assert!((a / b - 1.0).abs() < 0.1, "{rest:?} {moved:?}");
    }
}
