//! Fields and loads of whole drags: properties that hold whatever the grains do, and whatever else is done
//! meanwhile.

use std::path::Path;

use bitgrain::bed::library::BedCache;
use bitgrain::coarse_graining::load::Sum;
use bitgrain::coarse_graining::{CoarseGraining, FieldPoint, Flag, intruder_outline, read};
use bitgrain::drag::Dragging;
use bitgrain::motion::Moves;
use bitgrain::progress::{Progress, Stage};
use bitgrain::scenario::{self, CheckedScenario};
use bitgrain::simulation::{Grain, Simulation};
use bitgrain::summary::{Summary, read_summary};
use bitgrain::threads::on_threads;
use bitgrain::{bed, checkpoint, present};
use bitgrain_kernel::{ContactForce, Domain, Group, Obstacle, Partner};
use bitgrain_tests::{RIG, SMALL, Shown, output, results};

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

fn parsed(text: &str, sets: &[&str]) -> CheckedScenario {
    let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    scenario::parse(text, "fields", &sets, Path::new("")).unwrap()
}

/// The rig over a short way under its heavier lid, with these fields; three quarters of a second.
fn rig(fields: &str) -> CheckedScenario {
    let text = format!("{RIG}\n[measure.fields]\n{fields}\n");
    let sets = [
        "lid.effective_depth=0.03",
        "lid.pressure_gradient=\"with\"",
        "drag.distance=0.006",
        "measure.every=40",
    ];
    parsed(&text, &sets)
}

/// Fields of transients, and windows that no box holds, are refused.
#[test]
fn fields_of_no_steady_state_are_refused() {
    let why = |sets: &[&str]| {
        let mut all = vec!["measure.fields={grid=[8, 6, 6], every=50}".to_string()];
        all.extend(sets.iter().map(|s| s.to_string()));
        match scenario::parse(SMALL, "small", &all, Path::new("")) {
            Ok(_) => String::new(),
            Err(error) => error.to_string(),
        }
    };
    assert_eq!(why(&[]), "");
    assert!(why(&["drag.discard=1.4"]).contains("`drag.discard`: is 1.4, before the steady state"));
    assert_eq!(why(&["drag.discard=1.5"]), "");
    let low = why(&["bed.box=[8.0, 8.0, 6.0]", "measure.fields.window=3.0"]);
    assert!(
        low.contains("`measure.fields.window`: is a radius of 3") && low.contains("6 along z"),
        "{low}"
    );
}

fn run_into(scenario: &CheckedScenario, out: &Path, beds: &Path, threads: usize) -> Summary {
    let library = BedCache::new(beds);
    bitgrain::present::run(scenario, out, &library, threads, &Progress::new(false)).unwrap();
    read_summary(&out.join("summary.json")).unwrap()
}

/// Sampled at every step, the load is the force on the cylinder: normal and tangential parts together give
/// the mean drag and lift, which other code sums in another order. Fields change no state.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn loads_are_the_forces() {
    let folder = tempfile::tempdir().unwrap();
    let beds = folder.path().join("beds");
    let asked = "grid = [9, 1, 8]\nevery = 1";
    let mut whole = None;
    for moves in [Moves::Intruder, Moves::Bed] {
        let scenario = rig(asked).changed(|s| s.drag.moves = moves).unwrap();
        let out = folder.path().join(format!("{moves:?}"));
        let made = run_into(&scenario, &out, &beds, 2);
        let (run, rig_of) = (&made.runs[0], made.beds[0].rig.as_ref().unwrap());
        let flow = run.flow.as_ref().unwrap();
        let load = flow.load.as_ref().unwrap();
        let area = rig_of.diameter * rig_of.length;
        for (force, mean) in load
            .forces()
            .into_iter()
            .zip([run.drag.mean, run.lift.mean])
        {
            assert!((force * area / mean - 1.0).abs() < 1e-9, "{force} {mean}");
        }
        // The eight parts have as many steps to one or two in three hundred and seventy-five.
        let drag = load.mean(|sum| sum.drag).0 * area;
        assert!((drag / run.drag.mean - 1.0).abs() < 2e-3, "{drag}");
        // The front bears pressure, several times the bed's; behind there is almost none. If an angle had
        // the wrong sign, the normal forces would be taken for tangential ones.
        let behind = load.normal_near(std::f64::consts::PI, 0.5);
        assert!(
            load.normal_near(0.0, 0.3) > 3.0 * flow.pressure,
            "{moves:?}"
        );
        assert!(behind >= 0.0 && behind < flow.pressure, "{behind}");
        let tangential = load.mean(Sum::tangential_part).0;
        assert!((0.01..0.3).contains(&tangential), "{tangential}");
        whole = Some(made);
    }
    let whole = whole.unwrap();
    let run = &whole.runs[0];
    let without = rig("").changed(|s| s.measure.fields = None).unwrap();
    let bare = run_into(&without, &folder.path().join("without"), &beds, 2);
    assert_eq!(bare.runs[0].digest, run.digest);
    assert_eq!(bare.runs[0].drag, run.drag);
    assert!(bare.runs[0].flow.as_ref().unwrap().load.is_none());
}

/// A drag that is saved and resumed in the middle of the window, on other threads, ends with the same
/// files; so does one that is sampled while observers watch.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn a_drag_in_two_parts_has_the_fields_of_one() {
    let scenario = rig("grid = [20, 2, 12]\nevery = 150");
    let scenario = scenario.changed(|s| s.lid = None).unwrap();
    let plan = &scenario.drags()[0];
    let go = |sim: &mut Simulation,
              dragging: &mut Dragging,
              observer: &mut dyn FnMut(u64),
              looks: &[u64]| {
        let mut observer = Shown(looks, |n, _: &mut Simulation| observer(n));
        let stage = Stage::silent();
        dragging.go_on(sim, plan, &stage, &mut observer).unwrap();
    };
    let begun = || {
        let mut sim = bed::pour(&scenario, &scenario.beds()[0], &mut Stage::silent()).unwrap();
        let dragging = Dragging::begin(&mut sim, plan, "").unwrap();
        (sim, dragging)
    };
    let (mut sim, mut whole) = begun();
    go(&mut sim, &mut whole, &mut |_| (), &[]);
    let (mut sim, mut part) = begun();
    let half = plan.motion.window[0] + 1000;
    let mut saved = Until(half, None);
    part.go_on(&mut sim, plan, &Stage::silent(), &mut saved)
        .unwrap();
    let (mut again, note) = checkpoint::unpack(&saved.1.unwrap(), "half").unwrap();
    let mut dragging = Dragging::of(&note).unwrap();
    assert_eq!(dragging.step, half);
    assert!(dragging.fields.as_ref().unwrap().samples() > 0);
    on_threads(3, || {
        let looks: Vec<u64> = (half..plan.steps()).step_by(7).collect();
        let mut seen = 0;
        go(&mut again, &mut dragging, &mut |_| seen += 1, &looks);
        assert!(seen > 100);
    })
    .unwrap();
    let sums = |d: &Dragging| d.fields.as_ref().unwrap().array();
    assert!(sums(&whole) == sums(&dragging));
    assert_eq!(whole.note().course, dragging.note().course);
    // Sums of another grid, or cut off, are refused.
    for length in [note.fields.len() - 1, note.fields.len() - 8 * 13, 0] {
        let mut wrong = note.clone();
        wrong.fields.truncate(length);
        assert!(Dragging::of(&wrong).unwrap_err().contains("sums of fields"));
    }
}

/// Keeps the state at a step, and goes no further.
struct Until(u64, Option<Vec<u8>>);

impl bitgrain::observer::Observer for Until {
    fn on_checkpoint(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        note: &dyn Fn() -> checkpoint::StageState,
    ) -> bitgrain::error::Result<()> {
        if step == self.0 {
            self.1 = Some(checkpoint::pack(sim, &note())?);
        }
        Ok(())
    }

    fn last_step(&self) -> u64 {
        self.0
    }
}

/// Five grains with a moving cylinder in the middle of a high box, which nothing pulls.
fn cluster(scenario: &CheckedScenario) -> Simulation {
    let places = [
        // Two on the cylinder, beside each other across the edge of the box along y, and one on the second.
        [3.02, 0.1, 12.0],
        [3.02, 7.15, 12.1],
        [2.23, 7.6, 12.45],
        // A pair across the edge along x.
        [9.9, 4.0, 9.0],
        [0.85, 4.1, 9.2],
    ];
    let grain = |(k, position): (usize, &[f64; 3])| Grain {
        id: k as u32 + 1,
        group: 0,
        diameter: 1.0,
        density: 1.0,
        position: *position,
        velocity: [1.0 + k as f64, 0.5, -0.25 * k as f64],
        spin: [0.5, -1.0, 2.0],
    };
    let grains: Vec<Grain> = places.iter().enumerate().map(grain).collect();
    let domain = Domain::new([0.0; 3], scenario.bed.size, [true, true, false]).unwrap();
    let mut body = Obstacle::cylinder([5.0, 0.0, 12.0], [0.0, 1.0, 0.0], RADIUS);
    body.velocity = [2.0, 0.0, 0.0];
    let law = scenario.law.build().unwrap();
    let groups = vec![Group::free([0.0; 3])];
    let mut sim = Simulation::new(law, domain, scenario.drag.dt, groups, &grains, vec![body]);
    sim.start().unwrap();
    sim
}

/// Radius of its cylinder.
const RADIUS: f64 = 1.5;

/// Sum of force times branch over all contacts; with the cylinder from a grain's centre to the point of contact.
fn virial(sim: &Simulation, contacts: &[ContactForce<f64>]) -> [[f64; 3]; 3] {
    let place = |i: u32| [0, 1, 2].map(|a| sim.position[i as usize][a]);
    let mut virial = [[0.0; 3]; 3];
    for c in contacts {
        let from_partner = match c.partner {
            Partner::Grain(j) => sim.domain.separation(place(c.i), place(j)),
            Partner::Obstacle(_) => {
                let [x, _, z] = sim.domain.separation(place(c.i), sim.obstacles[0].point);
                let gap = 1.0 - RADIUS / x.hypot(z);
                [gap * x, 0.0, gap * z]
            }
        };
        for (a, row) in virial.iter_mut().enumerate() {
            let force = c.normal_force * c.normal[a] + c.tangential_force[a];
            for (sum, x) in row.iter_mut().zip(from_partner) {
                *sum += force * x;
            }
        }
    }
    virial
}

/// Fields add up to the totals of grains and contacts: volume, momentum in the intruder's frame, and the virial.
#[test]
fn fields_come_to_their_grains_and_contacts() {
    let fine = "measure.fields={grid=[50, 40, 120], window=1.3}";
    let tall = ["bed.box=[10.0, 8.0, 24.0]", "bed.grains=1500", fine];
    let scenario = parsed(SMALL, &tall);
    let mut sim = cluster(&scenario);
    let mut contacts = Vec::new();
    sim.step_seen(&mut contacts).unwrap();
    let on_body = contacts
        .iter()
        .filter(|c| c.partner == Partner::Obstacle(0));
    assert_eq!((contacts.len(), on_body.count()), (5, 2), "{contacts:?}");
    let plan = &scenario.drags()[0];
    let mut gauge = CoarseGraining::new(&plan.fields.unwrap(), &plan.motion);
    gauge.add(&sim, &contacts, plan.motion.window[0]);
    let fields = gauge.points(intruder_outline(&sim));
    let cell: f64 = fields.grid.step().iter().product();
    let total = |of: &dyn Fn(&FieldPoint) -> f64| {
        let known = fields.points.iter().filter(|p| p.packing_fraction > 0.0);
        known.map(of).sum::<f64>() * cell
    };
    // A sum over points is an integral to this part of it on this grid; it falls as the grid gets finer.
    let near = |got: f64, want: f64, scale: f64| {
        assert!((got - want).abs() < 2e-3 * scale, "{got} {want}");
    };
    let volume = std::f64::consts::PI / 6.0;
    near(total(&|p| p.packing_fraction), 5.0 * volume, 5.0 * volume);
    let frame = sim.obstacles[0].velocity;
    for (a, own) in frame.iter().enumerate() {
        let momentum = volume * sim.velocity.iter().map(|v| v[a] - own).sum::<f64>();
        let got = total(&|p| p.packing_fraction * p.velocity[a]);
        near(got, momentum, 10.0 * volume);
    }
    let virial = virial(&sim, &contacts);
    let sizes = virial.as_flattened().iter().map(|x| x.abs());
    let largest = sizes.fold(0.0, f64::max);
    for (a, row) in virial.iter().enumerate() {
        for (b, want) in row.iter().enumerate() {
            near(total(&|p| p.stress[a][b]), *want, 5.0 * largest);
        }
    }
}

/// A resting bed carries its weight: sigma_zz = rho g (z_s - z), with the bed's own density, and its surface is where
/// that falls to half. (The median of the highest tops is a third of a diameter above it.)
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn a_resting_bed_carries_its_weight() {
    let sets = [
        "bed.box=[10.0, 8.0, 24.0]",
        "bed.grains=1500",
        "intruder.diameter=1.0",
        "intruder.height=2.5",
        "bed.settled=1e-7",
    ];
    let text = format!("{SMALL}\n[measure.fields]\ngrid = [20, 16, 96]\nevery = 1\n");
    let scenario = parsed(&text, &sets);
    let mut sim = bed::pour(&scenario, &scenario.beds()[0], &mut Stage::silent()).unwrap();
    let mut plan = scenario.drags()[0].clone();
    plan.motion = plan.motion.averaged_beyond(0.0, plan.steps());
    let mut gauge = CoarseGraining::new(&plan.fields.unwrap(), &plan.motion);
    let mut contacts = Vec::new();
    sim.step_seen(&mut contacts).unwrap();
    gauge.add(&sim, &contacts, plan.motion.window[0]);
    let fields = gauge.points(intruder_outline(&sim));
    let [nx, ny, _] = fields.grid.counts;
    let layer = |kz: usize, of: fn(&FieldPoint) -> f64| {
        let points = (0..nx * ny).map(|k| of(&fields.points[kz * nx * ny + k]));
        points.sum::<f64>() / (nx * ny) as f64
    };
    let solid = |kz: usize| layer(kz, |p| p.packing_fraction);
    let top = (0..96)
        .rev()
        .find(|kz| solid(*kz) > 0.5 * solid(32))
        .unwrap();
    let surface = fields.grid.at(2, top);
    let heights: Vec<usize> = (0..96)
        .filter(|kz| (5.0..surface - 4.0).contains(&fields.grid.at(2, *kz)))
        .collect();
    assert!(heights.len() > 10, "{surface}");
    let mean = |of: fn(&FieldPoint) -> f64| {
        heights.iter().map(|k| layer(*k, of)).sum::<f64>() / heights.len() as f64
    };
    let density = mean(|p| p.packing_fraction);
    let depth = heights
        .iter()
        .map(|k| surface - fields.grid.at(2, *k))
        .sum::<f64>();
    let weight = density * depth / heights.len() as f64;
    let stress = mean(|p| p.stress[2][2]);
    assert!((stress / weight - 1.0).abs() < 0.02, "{stress} {weight}");
    // So it is at every height, with what lies above.
    for &kz in &heights {
        let above: f64 = (kz + 1..96).map(solid).sum();
        let weight = fields.grid.step()[2] * (above + 0.5 * solid(kz));
        let stress = layer(kz, |p| p.stress[2][2]);
        assert!(
            (stress / weight - 1.0).abs() < 0.02,
            "{kz}: {stress} {weight}"
        );
    }
    // Nothing pushes along x on the whole, so that no shear stress is left.
    assert!(mean(|p| p.stress[2][0]).abs() < 0.05 * stress);
    // Above the bed no grain came by.
    assert_eq!(fields.flags[fields.flags.len() - 1], Flag::Empty);
}

/// The files of a run: tables that are read again, an image, the page with its pictures; `verify` makes the
/// tables again.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn a_run_leaves_its_fields() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let both = |s: &mut scenario::Scenario| {
        s.lid.as_mut().unwrap().pressure_gradient = scenario::Gradient::Both;
    };
    let scenario = rig("grid = [54, 2, 32]\nevery = 100")
        .changed(both)
        .unwrap();
    let whole = run_into(&scenario, &out, &folder.path().join("beds"), 2);
    present::write_report(&bitgrain::folder::Folder(&out)).unwrap();
    let files = results(&out);
    let text = |name: &str| String::from_utf8(files[name].clone()).unwrap();
    for run in &whole.runs {
        let of = |file: &str| text(&format!("runs/{}/{file}", run.name));
        let grid = bitgrain::coarse_graining::grid::Grid {
            counts: [54, 2, 32],
            size: scenario.bed.size,
        };
        let plane = read::plane(&of("plane.csv"), grid).unwrap();
        let count = |flag: Flag| plane.flags.iter().filter(|f| **f == flag).count();
        assert!(count(Flag::Whole) > 500 && count(Flag::Cut) > 10 && count(Flag::Empty) > 10);
        // Far grains go by at the speed of the base.
        let far = plane.at(0, 14).unwrap().velocity[0];
        assert!((far / run.speed - 1.0).abs() < 0.3, "{far}");
        assert_eq!(of("load.csv").lines().count(), 2 + 64);
        assert!(of("fields.vti").contains("<ImageData WholeExtent=\"0 53 0 1 0 31\""));
        assert!(run.flow.as_ref().unwrap().disturbance.is_some());
    }
    let page = text("report.html");
    assert!(!page.contains("NaN"), "no number that is none is drawn");
    for words in ["Fields round the intruder", "Load on the cylinder"] {
        assert!(page.contains(&format!(">{words}</h2>")), "{words}");
    }
    let said = output(PROGRAM, folder.path(), &["verify", "out"]);
    let lines = String::from_utf8_lossy(&said.stdout).into_owned();
    assert_eq!(
        said.status.code(),
        Some(0),
        "{lines}{}",
        String::from_utf8_lossy(&said.stderr)
    );
}
