//! Beds that their base and lid carry past a cylinder: momentum, the lid's motion, what floats, frames of
//! reference, checkpoints. The beds are small and hardly settled, since what is tested here holds for any bed.

use std::path::Path;
use std::sync::LazyLock;

use bitgrain::bed::{self, Pouring};
use bitgrain::checkpoint;
use bitgrain::drag::{DragSeries, Means, drag};
use bitgrain::flow::FlowRow;
use bitgrain::motion::Moves;
use bitgrain::progress::Stage;
use bitgrain::scenario::{self, BedPlan, CheckedScenario, DragPlan};
use bitgrain::simulation::{Role, Simulation};
use bitgrain_kernel::{ContactHistory, KeptContact};
use bitgrain_tests::{RIG, Shown, largest};

const SPEED: f64 = 0.1;

fn rig() -> CheckedScenario {
    let sets = ["lid.effective_depth=0.03", "bed.settled=1e-2"];
    scenario::parse(RIG, "rig", &sets.map(String::from), Path::new("")).unwrap()
}

/// The bare bed, and with a lid: with and without a pressure gradient.
static BEDS: LazyLock<[Simulation; 3]> = LazyLock::new(|| {
    let scenario = rig();
    let [with, without] = scenario.beds() else {
        panic!("two beds are planned");
    };
    let bare = BedPlan {
        lid: None,
        ..with.clone()
    };
    let stage = &mut Stage::silent();
    let bare = bed::pour(&scenario, &bare, stage).unwrap();
    let covered = |plan, stage: &mut Stage| {
        let mut bed = Pouring::cover(&mut bare.clone(), "", &scenario, plan).unwrap();
        bed.go_on(&scenario, plan, stage, &mut ()).unwrap();
        bed.sim
    };
    [bare.clone(), covered(with, stage), covered(without, stage)]
});

fn places(sim: &Simulation, role: Role) -> Vec<usize> {
    (0..sim.count()).filter(|&i| sim.role(i) == role).collect()
}

/// A run of this many steps, averaged after the first `discard` of them, which shows some of its states.
fn plan(
    scenario: &CheckedScenario,
    speed: f64,
    steps: u64,
    discard: u64,
    shown: &[u64],
) -> DragPlan {
    let mut plan = scenario.drags()[0].clone();
    plan.motion.speed = speed;
    plan.distance = plan.motion.travel(steps);
    // Half a step early, so that rounding decides nothing.
    plan.discard = plan.motion.travel(discard) - 0.5 * plan.motion.travel(1);
    plan.motion = plan.motion.averaged_beyond(plan.discard, steps);
    // The steps at which a test looks.
    plan.snapshots = shown.to_vec();
    plan
}

fn run(
    sim: &mut Simulation,
    plan: &DragPlan,
    mut show: impl FnMut(u64, &Simulation),
) -> (Means, DragSeries) {
    let mut shown = Shown(&plan.snapshots, |n, sim: &mut Simulation| show(n, sim));
    drag(sim, plan, &mut shown).unwrap()
}

/// Force of everything on the free grains along x.
fn on_free(sim: &Simulation) -> f64 {
    places(sim, Role::Free)
        .iter()
        .map(|&i| sim.force[i][0])
        .sum()
}

/// What base and lid put into the bed and the cylinder takes out changes its momentum. A step's kick is the
/// mean of the forces before and after it, the window's mean of those after: that difference is known too,
/// and no more than rounding is left.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn what_base_and_lid_carry_is_the_drag() {
    let scenario = rig();
    for bed in &*BEDS {
        let (first, last) = (1500, 3750);
        let plan = plan(&scenario, SPEED, last, first + 1, &[first, last]);
        let mut ends = Vec::new();
        let (means, record) = run(&mut bed.clone(), &plan, |_, sim| ends.push(on_free(sim)));
        let flow = means.flow.unwrap();
        assert_eq!((flow.rows, record.flow.unwrap().rows.len()), (3, 5));
        let missing = flow.base + flow.lid - flow.drag - flow.inertia;
        let kicks = (ends[1] - ends[0]) / (2.0 * (last - first) as f64);
        let scale = flow.base.abs() + flow.lid.abs() + flow.drag.abs();
        assert!(kicks.abs() > 1e-7 * scale, "the ends differ: {kicks}");
        // Each step sums some hundred forces, each to a part in 10^16.
        let off = (missing - kicks).abs() / scale;
        assert!(off < 1e-12, "{off} of {scale} N");
        assert!(flow.drag > 0.0 && flow.base > 0.0);
        assert_eq!(flow.lid > 0.0, !places(bed, Role::Lid).is_empty());
        // So near its start the bed still changes its speed.
        assert!(flow.inertia.abs() > 1e-3 * flow.drag, "{flow:?}");
    }
}

/// Gravity pulls the lid always, and the bed below it as planned.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn gravity_acts_on_whom_it_is_planned_to() {
    let [bare, with, without] = &*BEDS;
    let of = |sim: &Simulation, role: Role| {
        let found = places(sim, role);
        let pull = |&i: &usize| sim.groups[usize::from(sim.group[i])].gravity;
        assert!(found.iter().all(|i| pull(i) == pull(&found[0])));
        pull(&found[0])
    };
    let (down, none) = ([0.0, 0.0, -9.81], [0.0; 3]);
    assert_eq!(of(bare, Role::Free), down);
    for (sim, bulk) in [(with, down), (without, none)] {
        assert_eq!((of(sim, Role::Free), of(sim, Role::Lid)), (bulk, down));
        assert_eq!(sim.count(), bare.count() + 27 * 4);
        assert_eq!(places(sim, Role::Lid).len(), 27 * 4);
    }
    assert_eq!(bare.obstacles.len(), 2, "cylinder and floor");
    assert_eq!(with.obstacles.len(), 2);
    assert_eq!(without.obstacles.len(), 3, "and a ceiling");
}

/// Base, lid, floor and ceiling go by as one body; the lid's grains are free along z alone.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn base_lid_and_planes_go_by_as_one() {
    let scenario = rig();
    let plan = plan(&scenario, SPEED, 1500, 2, &[1500]);
    for bed in &BEDS[1..] {
        let mut sim = bed.clone();
        run(&mut sim, &plan, |_, _| ());
        let width = sim.domain.hi()[0];
        let along =
            |sim: &Simulation, i: usize| sim.position[i][0] + f64::from(sim.image[i][0]) * width;
        let carried = [places(&sim, Role::Base), places(&sim, Role::Lid)].concat();
        let mut lifted = 0;
        for &i in &carried {
            let v = sim.velocity[i];
            assert_eq!([v[0], v[1]], [SPEED, 0.0]);
            assert_eq!(sim.position[i][1].to_bits(), bed.position[i][1].to_bits());
            let way = along(&sim, i) - along(bed, i);
            // Each step rounds to half a unit in the last place of a length below the box's.
            let rounding = 1500.0 * 0.5 * f64::EPSILON * width;
            assert!((way - plan.distance).abs() < rounding, "{way}");
            lifted += usize::from(sim.position[i][2] != bed.position[i][2]);
        }
        assert_eq!(lifted, 27 * 4, "all of the lid, none of the base");
        assert_eq!(sim.obstacles[0].velocity, [0.0; 3]);
        assert_eq!(sim.obstacles[0].point, bed.obstacles[0].point);
        assert!(
            sim.obstacles[1..]
                .iter()
                .all(|o| o.velocity == [SPEED, 0.0, 0.0])
        );
    }
}

/// A grain of the bed put between lid and ceiling: counted in every row, held in by the ceiling, and without
/// weight it flies straight on between them.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn what_floats_above_the_lid_is_counted_and_held() {
    let scenario = rig();
    let mut sim = BEDS[2].clone();
    let ceiling = sim.obstacles[2].point[2];
    let lid = places(&sim, Role::Lid);
    let top = largest(lid.iter().map(|&k| sim.position[k][2]));
    let radius = sim.position[0][3];
    let free = places(&sim, Role::Free);
    let one = free[free.len() / 2];
    let histories = sim.contact_histories();
    let parts = |contact: &KeptContact<f64>| match contact.history {
        ContactHistory::Pair { i, j, .. } => i as usize == one || j as usize == one,
        ContactHistory::Obstacle { i, .. } => i as usize == one,
    };
    let left = histories.iter().filter(|contact| !parts(contact)).collect();
    sim.position[one][2] = ceiling - 1.1 * radius;
    assert!(ceiling - 2.2 * radius > top, "there is room above the lid");
    sim.velocity[one] = [SPEED, 0.0, 0.05, sim.velocity[one][3]];
    sim.force[one] = [0.0; 4];
    sim.torque[one] = [0.0; 4];
    sim.resume(&left).unwrap();
    let (mut highest, mut turned) = (0.0, false);
    let all: Vec<u64> = (1..=1500).collect();
    let plan = plan(&scenario, SPEED, 1500, 2, &all);
    let (_, record) = run(&mut sim, &plan, |_, sim| {
        let z = sim.position[one][2];
        highest = if z > highest { z } else { highest };
        turned |= sim.velocity[one][2] < 0.0;
    });
    assert!(turned, "the ceiling turns it back");
    // A contact this slow is no deeper than a hundredth of a radius.
    assert!(
        (ceiling - 1.01 * radius..ceiling).contains(&(highest)),
        "{highest}"
    );
    let counted = |rows: &[FlowRow]| rows.iter().map(|row| row.floating).collect::<Vec<_>>();
    assert_eq!(counted(&record.flow.unwrap().rows), [1, 1]);
    let (_, without) = run(&mut BEDS[2].clone(), &plan, |_, _| ());
    assert_eq!(counted(&without.flow.unwrap().rows), [0, 0]);
}

/// Saved during the motion and resumed: the same digests from then on.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_bed_under_its_lid_goes_on_from_a_checkpoint() {
    let scenario = rig();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    for bed in &BEDS[1..] {
        let mut sim = bed.clone();
        run(&mut sim, &plan(&scenario, SPEED, 300, 2, &[]), |_, _| ());
        checkpoint::write(&path, &mut sim).unwrap();
        let mut again = checkpoint::read(&path).unwrap();
        assert_eq!(again.groups, sim.groups);
        for _ in 0..5 {
            assert_eq!(sim.digest(), again.digest());
            sim.steps(40).unwrap();
            again.steps(40).unwrap();
        }
        assert_eq!(sim.digest(), again.digest());
    }
}

/// The bed seen in a mirror across x.
fn mirrored(sim: &Simulation) -> Simulation {
    let mut other = sim.clone();
    let width = other.domain.hi()[0];
    let turn = |v: &mut [f64; 4]| v[0] = -v[0];
    // Spins and torques turn the other way round the axes across the mirror.
    let spin = |w: &mut [f64; 4]| (w[1], w[2]) = (-w[1], -w[2]);
    for i in 0..other.count() {
        let x = width - other.position[i][0];
        other.position[i][0] = if x < width { x } else { 0.0 };
        other.image[i][0] = -other.image[i][0];
        turn(&mut other.velocity[i]);
        turn(&mut other.force[i]);
        spin(&mut other.spin[i]);
        spin(&mut other.torque[i]);
    }
    for body in &mut other.obstacles {
        body.point[0] = width - body.point[0];
        body.force[0] = -body.force[0];
    }
    let histories = other.contact_histories();
    let mirrored = histories.iter().map(|mut contact| {
        let (ContactHistory::Pair { spring, .. } | ContactHistory::Obstacle { spring, .. }) =
            &mut contact.history;
        spring[0] = -spring[0];
        contact
    });
    other.resume(&mirrored.collect()).unwrap();
    other
}

/// A cylinder that moves through a bed at rest, and the mirrored bed that goes by the cylinder as a whole:
/// the same relative motion. The measured force is exactly the same; the two runs, which round
/// differently, agree in every measured number up to the growth of rounding errors.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn who_moves_does_not_matter() {
    // So fast that two rows of the flow take few steps, in which rounding errors hardly grow.
    let fast = 0.5;
    for bed in &*BEDS {
        let scenario = rig().changed(|s| s.measure.every = 10).unwrap();
        let mut plan = plan(&scenario, fast, 300, 2, &[10, 300]);
        let (mut through, mut past) = (vec![], vec![]);
        plan.motion.moves = Moves::Intruder;
        let mut still = mirrored(bed);
        let begin = [still.obstacles[0].force, bed.obstacles[0].force];
        let ([x, y, z], other) = (begin[0], begin[1]);
        assert_eq!([-x, y, z], other, "at rest they are mirror images exactly");
        let (a, one) = run(&mut still, &plan, |_, sim| {
            through.push(sim.obstacles[0].force)
        });
        plan.motion.moves = Moves::Bed;
        let mut boosted = bed.clone();
        for i in places(bed, Role::Free) {
            boosted.velocity[i][0] += fast;
        }
        let (b, two) = run(&mut boosted, &plan, |_, sim| {
            past.push(sim.obstacles[0].force)
        });
        for (k, row) in [0, 29].into_iter().enumerate() {
            let [x, y, z] = through[k];
            assert_eq!(one.series[row].force, [-x, z, y]);
            let [x, y, z] = past[k];
            assert_eq!(two.series[row].force, [x, z, y]);
        }
        let scale = a.drag.mean.abs();
        assert!(scale > 0.0);
        for (a, b) in one.series.iter().zip(&two.series) {
            assert_eq!(a.contacts, b.contacts);
            for k in 0..3 {
                close(a.force[k], b.force[k], scale);
                close(a.force_mean[k], b.force_mean[k], scale);
            }
            assert!((a.angle.unwrap() - b.angle.unwrap()).abs() < SAME);
        }
        let (one, two) = (one.flow.unwrap().rows, two.flow.unwrap().rows);
        assert_eq!((one.len(), two.len()), (2, 2));
        for (a, b) in one.iter().zip(&two) {
            assert_eq!((a.step, a.floating), (b.step, b.floating));
            close(a.base, b.base, scale);
            close(a.lid, b.lid, scale);
            for (a, b) in [
                (a.distance, b.distance),
                (a.far_field, b.far_field),
                (a.momentum, b.momentum),
                (a.pressure, b.pressure),
                (a.packing, b.packing),
                (a.lid_height, b.lid_height),
            ] {
                close(a, b, a.abs());
            }
        }
        close(a.drag.mean, b.drag.mean, scale);
        close(a.lift.mean, b.lift.mean, scale);
    }
}

/// What a rounding error of a part in 10^16 of the box, which is one in 10^11 of an overlap, may grow to in
/// some hundred steps.
const SAME: f64 = 1e-6;

fn close(a: f64, b: f64, scale: f64) {
    assert!((a - b).abs() <= SAME * scale, "{a} and {b} of {scale}");
}
