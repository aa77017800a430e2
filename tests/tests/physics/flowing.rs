//! The whole result of `guillard-small`, which takes most of an hour: its first steps are done
//! again here from the settled bed, and its summary is made again from its series.
//!
//! `golden/README.md` says how the files are made.

use bitgrain::claims;
use bitgrain::drag::drag;
use bitgrain::flow::{FLOW, FlowRow, PROFILE, flow_text};
use bitgrain::scenario::{self, CheckedScenario};
use bitgrain::series::{SeriesRow, read_series, series_text};
use bitgrain::summary::{DragSummary, Flow, Summary, read_summary};
use bitgrain::{block_averaging::Mean, checkpoint};
use bitgrain_tests::{golden, unpacked};

/// Steps done again: eight rows of the force series and one of the flow.
const AGAIN: u64 = 4_000;

fn scenario() -> CheckedScenario {
    scenario::load("guillard-small", &[]).unwrap()
}

fn bytes(name: &str) -> Vec<u8> {
    unpacked(&format!("guillard-small/{name}"))
}

fn text(name: &str) -> String {
    String::from_utf8(bytes(name)).unwrap()
}

fn whole() -> Summary {
    read_summary(&golden("guillard-small/summary.json")).unwrap()
}

fn series(file: &str) -> Vec<SeriesRow> {
    read_series(&golden("guillard-small").join(file)).unwrap()
}

/// Forces, flow and profile of the runs with a pressure gradient and without.
const FILES: [[&str; 3]; 2] = [
    [
        "bed-1-run-1.forces.csv.gz",
        "bed-1-run-1.flow.csv",
        "bed-1-run-1.profile.csv",
    ],
    [
        "bed-2-run-1.forces.csv.gz",
        "bed-2-run-1.flow.csv",
        "bed-2-run-1.profile.csv",
    ],
];

/// The runs of the summary with how their beds flowed: with a pressure gradient, and without.
fn pair(whole: &Summary) -> [(&DragSummary, &Flow); 2] {
    let of = |k: usize| {
        let run = &whole.runs[k];
        (run, run.flow.as_ref().unwrap())
    };
    assert_eq!(whole.runs.len(), 2);
    let [with, without] = [of(0), of(1)];
    assert!(with.1.pressure_gradient && !without.1.pressure_gradient);
    [with, without]
}

#[test]
#[cfg_attr(debug_assertions, ignore = "ten seconds in release, minutes in debug")]
fn the_first_steps_done_again_give_the_same_rows() {
    let scenario = scenario();
    let packed = bytes("bed-1.safetensors.gz");
    let mut bed = checkpoint::parse(&packed, "bed-1", None).unwrap();
    assert_eq!(
        bitgrain::simulation::hex(&bed.digest().unwrap().whole),
        whole().beds[0].digest
    );
    let mut plan = scenario.drags()[0].clone();
    // Averages are of no concern here; those of the whole run begin much later.
    plan.motion = plan.motion.averaged_beyond(0.0, AGAIN);
    let (_, record) = drag(&mut bed, &plan, &mut ()).unwrap();
    assert_eq!(record.series.len(), 8);
    let (units, measure) = (scenario.units(), scenario.measure.columns(plan.release));
    let again = series_text(&units, measure, &record.series);
    assert!(
        text("bed-1-run-1.forces.csv.gz").starts_with(&again),
        "{again}"
    );
    let gauge = record.flow.unwrap();
    assert_eq!(gauge.rows.len(), 1);
    let again = flow_text(&units, &gauge.rows);
    assert!(text("bed-1-run-1.flow.csv").starts_with(&again), "{again}");
}

/// The mean of `force_mean` over rows that end after `from` and up to `to`.
fn mean(series: &[SeriesRow], component: usize, from: u64, to: u64) -> f64 {
    let inside = series
        .iter()
        .filter(|row| row.step > from && row.step <= to);
    let values: Vec<f64> = inside.map(|row| row.force_mean[component]).collect();
    assert!(!values.is_empty());
    values.iter().sum::<f64>() / values.len() as f64
}

/// Sums of 1,251 rounded means against a sum over each of the 625,500 steps: two orders of summation.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-10 * b.abs()
}

#[test]
fn the_means_are_those_of_the_series() {
    let whole = whole();
    assert_eq!(
        whole.inputs,
        scenario(),
        "the result is that of the scenario as it is shipped"
    );
    for ((run, flow), [forces, flows, profile]) in pair(&whole).into_iter().zip(FILES) {
        let series = series(forces);
        assert_eq!(series.last().unwrap().step, run.steps);
        let from = run.steps - run.window_steps;
        let of = |component: usize| mean(&series, component, from, run.steps);
        for (k, force) in [run.drag, run.lift, run.side].iter().enumerate() {
            let Mean { mean, .. } = *force;
            assert!(same(of(k), mean), "{}: {} and {mean}", run.name, of(k));
        }
        let area = flow.pressure * run.diameter * whole.inputs.bed.size[1];
        assert!(same(flow.drag_coefficient, run.drag.mean / area));
        let rows = FLOW.parse(&text(flows)).unwrap();
        let window: Vec<&FlowRow> = rows.iter().filter(|row| row.step > from + 3_749).collect();
        let over = |of: fn(&FlowRow) -> f64| {
            window.iter().map(|row| of(row)).sum::<f64>() / window.len() as f64
        };
        assert!(same(over(|row| row.far_field), flow.far_field));
        assert!(same(over(|row| row.pressure), flow.pressure_measured));
        assert!(same(
            over(|row| row.base) / over(|row| row.drag),
            flow.carried_by_base
        ));
        let most = window.iter().map(|row| row.floating).max();
        assert_eq!(most, Some(flow.floating));
        let layers = PROFILE.parse(&text(profile)).unwrap();
        let slowest = layers.iter().filter(|(_, _, v)| *v == flow.far_field_least);
        assert_eq!(slowest.count(), 1, "of the layers inside the bed");
    }
}

/// Conditions of any such run for its numbers to mean anything.
#[test]
fn the_bed_follows_its_base_and_base_and_lid_carry_the_drag() {
    let whole = whole();
    for (run, flow) in pair(&whole) {
        assert!(flow.far_field >= claims::FAR_FIELD_LEAST, "{flow:?}");
        assert!(flow.travel >= claims::TRAVEL_LEAST, "{flow:?}");
        let carried = flow.carried_by_base + flow.carried_by_lid;
        assert!((carried - 1.0).abs() < 0.01, "{}: {carried}", run.name);
        // Newton's second law. A Verlet step counts the forces of the window's ends half, the means count
        // the last one whole: of 600,000 steps that is a few forces of the drag's size.
        let missing = carried - 1.0 - flow.inertia;
        assert!(missing.abs() < 1e-5, "{missing}");
    }
}

/// At half the speed the drag over the same travel is the same to 5 %: inertia plays no part.
#[test]
fn half_the_speed_changes_the_drag_by_less_than_a_twentieth() {
    let (slow, fast) = (series("half.forces.csv.gz"), series(FILES[0][0]));
    let travel = slow.last().unwrap().distance;
    let begin = scenario().drags()[0].discard;
    let drag = |series: &[SeriesRow]| {
        let step_at = |distance: f64| {
            let mut before = series
                .iter()
                .filter(|row| row.distance <= distance * (1.0 + 1e-9));
            before.next_back().unwrap().step
        };
        mean(series, 0, step_at(begin), step_at(travel))
    };
    let ratio = drag(&slow) / drag(&fast);
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    let speed = |row: &SeriesRow| row.distance / row.time;
    assert!((speed(&slow[9]) / speed(&fast[9]) - 0.5).abs() < 1e-9);
}
