//! Drag through a bed that LAMMPS poured (`bedS_D4.data.gz`), against LAMMPS' own drags through it:
//! contact histories empty, the intruder at its speed at once, one box length, the first quarter cut.
//!
//! At first the two agree to every digit that LAMMPS printed. But grains are chaotic: two programs that
//! agree to the last digit but one give different forces after a while. What can agree then are means,
//! within their errors. Where the force is not stationary (Fr 5 and 8: it decays over the whole box)
//! each eighth of the run is compared too, with the spread of twelve runs of ours whose time steps
//! differ by parts in ten thousand.
//!
//! The whole of it takes a quarter of an hour on two cores:
//! `cargo test -p bitgrain-tests --release --test drag -- --ignored`. The ordinary tests hold the numbers
//! that came out of it against LAMMPS', and run fixed pieces of it again.

use std::fmt::Write;

use bitgrain::checkpoint;
use bitgrain::drag::{Means, drag};
use bitgrain::scenario::{self, Scenario};
use bitgrain::series::SeriesRow;
use bitgrain::sim::{Sim, hex};
use bitgrain_tests::{Shown, golden, hertz_history};

/// Froude numbers and the steps of LAMMPS' runs.
const POINTS: [(f64, u64); 4] = [(0.5, 301_600), (2.0, 75_600), (5.0, 30_000), (8.0, 18_800)];
/// Those whose eighths are compared.
const EIGHTHS: [f64; 2] = [5.0, 8.0];
/// Runs of ours for the spread of an eighth.
const REPLICAS: usize = 12;
/// Where the slowest run is cut for a checkpoint, and where a piece of it ends.
const PIECE: [u64; 2] = [200_000, 204_000];

/// The scenario of one drag; the `replica`-th has its time step longer by so many parts in 10,000.
fn scenario_of(froude: f64, replica: usize) -> Scenario {
    let file = golden("peers/drag/lammps.toml");
    let sets = [
        format!("intruder.froude={froude:?}"),
        format!("drag.dt={:?}", 1.5e-4 * (1.0 + 1e-4 * replica as f64)),
    ];
    scenario::load(file.to_str().unwrap(), &sets).unwrap()
}

/// One drag, and the states at the `marks`.
fn pull(froude: f64, replica: usize, marks: &[u64]) -> (Means, Vec<SeriesRow>, Vec<Sim>) {
    let scenario = scenario_of(froude, replica);
    let mut sim =
        bitgrain::bed::import::bed(&scenario, scenario.source.as_deref().unwrap()).unwrap();
    let plan = scenario.runs().remove(0);
    let mut states = Vec::new();
    let mut mark = Shown(marks, |_, sim: &mut Sim| states.push(sim.clone()));
    let (means, record) = drag(&mut sim, &scenario, &plan, &mut mark).unwrap();
    (means, record.series, states)
}

/// Mean drag over each eighth of so many steps.
fn eighths(rows: &[SeriesRow], steps: u64) -> [f64; 8] {
    std::array::from_fn(|k| {
        let (from, to) = (steps / 8 * k as u64, steps / 8 * (k as u64 + 1));
        let part = rows.iter().filter(|row| row.step > from && row.step <= to);
        let drags: Vec<f64> = part.map(|row| row.force_mean[0]).collect();
        drags.iter().sum::<f64>() / drags.len() as f64
    })
}

fn line(froude: f64, replica: usize, steps: u64) -> (String, Vec<Sim>) {
    let marks = if froude == 0.5 { &PIECE[..] } else { &[] };
    let (means, rows, states) = pull(froude, replica, marks);
    let mut text = format!(
        "{froude:3.1} {replica} {:10.4} {:8.4} {:10.4} {:8.4}",
        means.drag.mean, means.drag.standard_error, means.lift.mean, means.lift.standard_error
    );
    for part in eighths(&rows, steps) {
        write!(text, " {part:9.3}").unwrap();
    }
    (text, states)
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("peers/drag"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(
        "recipe: golden/peers/drag/lammps.toml; \
         `cargo test -p bitgrain-tests --release --test drag -- --ignored`",
    );
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// Where a thread leaves a drag's line and states.
type Slot = std::sync::Mutex<Option<(String, Vec<Sim>)>>;

const HEAD: &str =
    "Fr  #       drag    error       lift    error  drag of each eighth of the run\n";

/// Every drag, all over: the numbers that the other tests hold to. With INSTA_UPDATE=always it also
/// writes the checkpoint of the slowest anew.
#[test]
#[ignore = "a quarter of an hour on two cores"]
fn all_drags_give_their_goldens() {
    let jobs: Vec<(f64, usize, u64)> = POINTS
        .iter()
        .flat_map(|&(froude, steps)| {
            let count = if EIGHTHS.contains(&froude) {
                REPLICAS
            } else {
                1
            };
            (0..count).map(move |k| (froude, k, steps))
        })
        .collect();
    let next = std::sync::atomic::AtomicUsize::new(0);
    let done: Vec<Slot> = jobs.iter().map(|_| Slot::default()).collect();
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    let Some(&(froude, replica, steps)) = jobs.get(k) else {
                        return;
                    };
                    *done[k].lock().unwrap() = Some(line(froude, replica, steps));
                }
            });
        }
    });
    let mut text = String::from(HEAD);
    let mut piece = String::new();
    for slot in done {
        let (line, mut states) = slot.into_inner().unwrap().unwrap();
        writeln!(text, "{line}").unwrap();
        if let [from, to] = &mut states[..] {
            let path = golden("peers/drag/fr0.5.safetensors");
            if std::env::var("INSTA_UPDATE").is_ok_and(|v| v == "always") {
                checkpoint::write(&path, from).unwrap();
            }
            piece = format!(
                "{}\n{}\n",
                hex(&from.digest().whole),
                hex(&to.digest().whole)
            );
        }
    }
    snapshot("piece", &piece);
    snapshot("bitgrain", &text);
}

/// The body of a snapshot file.
fn body(name: &str) -> String {
    let text = std::fs::read_to_string(golden(&format!("peers/drag/{name}.snap"))).unwrap();
    let (_, rest) = text.split_once("---\n").unwrap();
    rest.split_once("---\n").unwrap().1.to_string()
}

/// Lines of our numbers: Froude number, drag, its error, lift, its error, eighths.
fn ours() -> Vec<(f64, [f64; 4], [f64; 8])> {
    let lines = body("bitgrain");
    let row = |line: &str| {
        let numbers: Vec<f64> = line
            .split_whitespace()
            .map(|w| w.parse().unwrap())
            .collect();
        let four = std::array::from_fn(|k| numbers[2 + k]);
        (numbers[0], four, std::array::from_fn(|k| numbers[6 + k]))
    };
    lines.lines().skip(1).map(row).collect()
}

/// LAMMPS' drag, its error, lift and its error.
fn lammps_means(froude: f64) -> [f64; 4] {
    let text = std::fs::read_to_string(golden("peers/drag/drag.csv")).unwrap();
    let rows = text.lines().skip(2);
    let rows =
        rows.map(|line| -> Vec<f64> { line.split(',').map(|w| w.parse().unwrap()).collect() });
    let row = rows.into_iter().find(|row| row[2] == froude).unwrap();
    [row[5], row[6], row[7], row[8]]
}

/// LAMMPS' drag over each eighth of its run.
fn lammps_eighths(froude: f64) -> [f64; 8] {
    let name = format!("peers/drag/series_D4_mu0.5_Fr{froude}.csv");
    let text = std::fs::read_to_string(golden(&name)).unwrap();
    let rows = text.lines().skip(2);
    let drags: Vec<f64> = rows
        .map(|line| -line.split(',').nth(1).unwrap().parse::<f64>().unwrap())
        .collect();
    let part = drags.len() / 8;
    std::array::from_fn(|k| drags[k * part..(k + 1) * part].iter().sum::<f64>() / part as f64)
}

/// The comparison as the README shows it: differences over their combined standard errors.
fn table() -> String {
    let ours = ours();
    let mut text = String::from(
        "| Fr | drag, LAMMPS | drag, bitgrain | difference | lift, LAMMPS | lift, bitgrain | difference |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for (froude, _) in POINTS {
        let l = lammps_means(froude);
        let (_, b, _) = ours.iter().find(|row| row.0 == froude).unwrap();
        let off = |k: usize| (b[k] - l[k]) / (b[k + 1] * b[k + 1] + l[k + 1] * l[k + 1]).sqrt();
        writeln!(
            text,
            "| {froude} | {:.0} ± {:.0} | {:.0} ± {:.0} | {:+.1} σ | {:.0} ± {:.0} | {:.0} ± {:.0} | {:+.1} σ |",
            l[0], l[1], b[0], b[1], off(0), l[2], l[3], b[2], b[3], off(2)
        )
        .unwrap();
        // Three combined standard errors, each program's from its own blocks.
        assert!(
            off(0).abs() < 3.0 && off(2).abs() < 3.0,
            "Fr {froude}: {b:?} against {l:?}"
        );
    }
    text
}

/// LAMMPS' input and our scenario say the same.
#[test]
fn both_programs_are_asked_the_same() {
    let input = std::fs::read_to_string(golden("peers/drag/in.lammps")).unwrap();
    let scenario = scenario_of(8.0, 0);
    let word = |name: &str, k: usize| -> f64 {
        let line = input.lines().find(|line| line.starts_with(name)).unwrap();
        line.split_whitespace().nth(k).unwrap().parse().unwrap()
    };
    let style: [f64; 5] = std::array::from_fn(|k| word("pair_style", k + 2));
    assert_eq!(style, hertz_history(&scenario.law));
    assert_eq!(word("timestep", 1), scenario.drag.dt);
    assert_eq!(word("fix weight", 4), scenario.gravity);
    let speed = input.split("-var V ").nth(1).unwrap();
    let speed: f64 = speed.split(' ').next().unwrap().parse().unwrap();
    // The same but for how it was rounded.
    assert!((speed / scenario.runs()[0].speed - 1.0).abs() < 1e-15);
}

#[test]
fn drags_agree_with_lammps() {
    let table = table();
    let readme = std::fs::read_to_string(golden("../README.md")).unwrap();
    assert!(
        readme.contains(&table),
        "the README's table should be\n{table}"
    );
}

/// Mean and standard deviation.
fn spread(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, (square / (n - 1.0)).sqrt())
}

/// The decay of the fast drags, part by part, and their means, against the spread of several runs: as
/// the README shows it.
#[test]
fn eighths_of_fast_drags_agree_with_lammps() {
    let ours = ours();
    let mut text = String::from(
        "| Fr | eighth of the run | 1 | 2 | 3 | 4 | 5 | 6 | 7 | 8 | mean of 5 to 20 d |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let mut worst = (0.0, String::new());
    for froude in EIGHTHS {
        let runs: Vec<_> = ours.iter().filter(|r| r.0 == froude).collect();
        assert_eq!(runs.len(), REPLICAS);
        let theirs = lammps_eighths(froude);
        let mut rows = [
            format!("| {froude} | LAMMPS |"),
            "| | bitgrain, the same steps |".to_string(),
            format!("| | bitgrain, {REPLICAS} runs |"),
        ];
        for k in 0..9 {
            let of = |run: &(f64, [f64; 4], [f64; 8])| if k < 8 { run.2[k] } else { run.1[0] };
            let values: Vec<f64> = runs.iter().map(|run| of(run)).collect();
            let (mean, deviation) = spread(&values);
            let theirs = if k < 8 {
                theirs[k]
            } else {
                lammps_means(froude)[0]
            };
            write!(rows[0], " {theirs:.0} |").unwrap();
            write!(rows[1], " {:.0} |", values[0]).unwrap();
            write!(rows[2], " {mean:.0} ± {deviation:.0} |").unwrap();
            // One run of theirs against the mean of ours, which spread as theirs would.
            let off = (theirs - mean).abs() / (deviation * (1.0 + 1.0 / REPLICAS as f64).sqrt());
            if off > worst.0 {
                worst = (off, format!("Fr {froude}, column {}: {off:.2}", k + 1));
            }
        }
        rows.iter().for_each(|row| writeln!(text, "{row}").unwrap());
    }
    assert!(worst.0 < 3.0, "{}\n{text}", worst.1);
    let readme = std::fs::read_to_string(golden("../README.md")).unwrap();
    assert!(
        readme.contains(&text),
        "{}; the README's table should be\n{text}",
        worst.1
    );
}

/// Before chaos has made a rounding error large, the two programs give the same forces: drag and lift
/// of the first 40 rows, 3,000 steps, to the six digits that LAMMPS printed.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn the_first_rows_are_those_of_lammps() {
    let mut scenario = scenario_of(5.0, 0);
    scenario.measure.every = 75;
    let mut plan = scenario.runs().remove(0);
    plan.steps = 3000;
    plan.discard = 0.1;
    let mut sim =
        bitgrain::bed::import::bed(&scenario, scenario.source.as_deref().unwrap()).unwrap();
    let (_, record) = drag(&mut sim, &scenario, &plan, &mut ()).unwrap();
    let text = std::fs::read_to_string(golden("peers/drag/series_D4_mu0.5_Fr5.csv")).unwrap();
    let theirs = text.lines().skip(2).take(40);
    let mut rows = 0;
    for (row, line) in record.series.iter().zip(theirs) {
        let numbers: Vec<f64> = line.split(',').map(|w| w.parse().unwrap()).collect();
        assert_eq!(row.step as f64, numbers[0]);
        // Six significant digits: half of the last one, and as much for what chaos has made of
        // rounding by then.
        for (ours, theirs) in [
            (row.force_mean[0], -numbers[1]),
            (row.force_mean[1], numbers[3]),
        ] {
            assert!(
                (ours - theirs).abs() <= 1e-5 * theirs.abs(),
                "{line}: {ours}"
            );
        }
        rows += 1;
    }
    assert_eq!(rows, 40);
}

/// The fastest drag from its beginning, and a piece of the slowest from a checkpoint.
#[test]
#[cfg_attr(debug_assertions, ignore = "half a minute in release")]
fn pieces_of_the_drags_run_again() {
    let (froude, steps) = POINTS[3];
    let (again, _) = line(froude, 0, steps);
    assert!(
        body("bitgrain").lines().any(|line| line == again),
        "{again}"
    );

    let mut sim = checkpoint::read(&golden("peers/drag/fr0.5.safetensors")).unwrap();
    let begin = hex(&sim.digest().whole);
    sim.steps(PIECE[1] - PIECE[0]).unwrap();
    let text = format!("{begin}\n{}\n", hex(&sim.digest().whole));
    assert_eq!(body("piece").trim(), text.trim());
}
