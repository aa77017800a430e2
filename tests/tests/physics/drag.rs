//! Drag through beds that LAMMPS poured (`bedS_*`), against LAMMPS' own drags through them: contact
//! histories empty, the intruder at its speed at once, one box length, the first quarter cut.
//!
//! At first the two agree to every digit that LAMMPS printed. But grains are chaotic: two programs that
//! agree to the last digit but one give different forces after a while. What can agree then are means,
//! within their errors. Where the force is not stationary (Fr 5 and 8: it decays over the whole box)
//! each eighth of the run is compared too, with the spread of twelve runs of ours whose time steps
//! differ by parts in ten thousand.
//!
//! The whole of it takes half an hour on two quiet cores:
//! `cargo test -p bitgrain-tests --release --test physics drag:: -- --ignored`. The ordinary tests compare its
//! numbers with those of LAMMPS; `.ci/run long` runs fixed pieces of it again.

use std::fmt::Write;

use bitgrain::checkpoint;
use bitgrain::drag::{Means, drag};
use bitgrain::error::Error;
use bitgrain::scenario::CheckedScenario;
use bitgrain::series::SeriesRow;
use bitgrain::simulation::{Simulation, hex};
use bitgrain_kernel::Error as KernelError;
use bitgrain_tests::drags::{Bed, Ours, blocks, body, cells, spread, tail, validation};
use bitgrain_tests::{Shown, golden, hertz_history};

/// Frictionless grains leak through a base; there, and only there, a floor is under it.
const BEDS: [Bed; 4] = [
    Bed {
        diameter: 4.0,
        friction: 0.5,
        file: "bedS_D4.data.gz",
        series: "series_D4_mu0.5_Fr",
    },
    Bed {
        diameter: 2.0,
        friction: 0.5,
        file: "bedS_D2.data.gz",
        series: "series_D2_mu0.5_Fr",
    },
    Bed {
        diameter: 3.0,
        friction: 0.5,
        file: "bedS_D3.data.gz",
        series: "series_D3_mu0.5_Fr",
    },
    Bed {
        diameter: 4.0,
        friction: 0.0,
        file: "bedS_D4_mu0.data.gz",
        series: "series_D4_mu0_Fr",
    },
];
const FROUDES: [f64; 4] = [0.5, 2.0, 5.0, 8.0];
/// Those whose eighths are compared.
const EIGHTHS: [f64; 2] = [5.0, 8.0];
/// Runs of ours for the spread of an eighth.
const REPLICAS: usize = 12;
/// Where the slowest run through the first bed is cut for a checkpoint, and where a piece of it ends.
const PIECE: [u64; 2] = [200_000, 204_000];

/// One drag, and the states at the `marks`.
fn pull(scenario: &CheckedScenario, marks: &[u64]) -> (Means, Vec<SeriesRow>, Vec<Simulation>) {
    let mut sim =
        bitgrain::bed::import::bed(scenario, scenario.source.as_deref().unwrap()).unwrap();
    let plan = scenario.drags()[0].clone();
    let mut states = Vec::new();
    let mut mark = Shown(marks, |_, sim: &mut Simulation| states.push(sim.clone()));
    let (means, record) = drag(&mut sim, &plan, &mut mark).unwrap();
    (means, record.series, states)
}

/// Mean drag over each eighth of this many steps.
fn eighths(rows: &[SeriesRow], steps: u64) -> [f64; 8] {
    std::array::from_fn(|k| {
        let (from, to) = (steps / 8 * k as u64, steps / 8 * (k as u64 + 1));
        let part = rows.iter().filter(|row| row.step > from && row.step <= to);
        let drags: Vec<f64> = part.map(|row| row.force_mean[0]).collect();
        drags.iter().sum::<f64>() / drags.len() as f64
    })
}

fn line(bed: &Bed, froude: f64, replica: usize) -> (String, Vec<Simulation>) {
    let slowest = (bed.file, froude) == (BEDS[0].file, 0.5);
    let marks = if slowest { &PIECE[..] } else { &[] };
    let (means, rows, states) = pull(&bed.scenario(froude, replica), marks);
    let mut text = format!(
        "{} {:3.1} {froude:3.1} {replica:<2} {:9.4} {:8.4} {:10.4} {:8.4}",
        bed.diameter,
        bed.friction,
        means.drag.mean,
        means.drag.standard_error,
        means.lift.mean,
        means.lift.standard_error
    );
    for part in eighths(&rows, bed.lammps(froude).steps) {
        write!(text, " {part:9.3}").unwrap();
    }
    (text, states)
}

fn snapshot(name: &str, command: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("peers/drag"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    let recipe = format!("recipe: golden/peers/drag/lammps.toml; `{command}`");
    settings.set_description(recipe);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// Every bed at every Froude number.
fn points() -> impl Iterator<Item = (&'static Bed, f64)> {
    BEDS.iter()
        .flat_map(|bed| FROUDES.map(|froude| (bed, froude)))
}

/// The place for a drag's line and states from a thread.
type Slot = std::sync::Mutex<Option<(String, Vec<Simulation>)>>;

const RECIPE: &str = "cargo test -p bitgrain-tests --release --test physics drag:: -- --ignored";
const HEAD: &str =
    "D mu  Fr  #       drag    error       lift    error  drag of each eighth of the run\n";

/// Every drag, as a whole: the numbers that the other tests use. With INSTA_UPDATE=always it also
/// rewrites the checkpoint of the slowest.
#[test]
#[ignore = "half an hour on two quiet cores"]
fn all_drags_give_their_goldens() {
    let mut jobs: Vec<(&Bed, f64, usize)> = Vec::new();
    for (bed, froude) in points() {
        let count = if EIGHTHS.contains(&froude) {
            REPLICAS
        } else {
            1
        };
        jobs.extend((0..count).map(|k| (bed, froude, k)));
    }
    let next = std::sync::atomic::AtomicUsize::new(0);
    let done: Vec<Slot> = jobs.iter().map(|_| Slot::default()).collect();
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    let Some(&(bed, froude, replica)) = jobs.get(k) else {
                        return;
                    };
                    *done[k].lock().unwrap() = Some(line(bed, froude, replica));
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
                hex(&from.digest().unwrap().whole),
                hex(&to.digest().unwrap().whole)
            );
        }
    }
    snapshot("piece", RECIPE, &piece);
    snapshot("bitgrain", RECIPE, &text);
}

/// LAMMPS' means in `drag.csv` are those of its series: eight blocks of the last three quarters.
#[test]
fn the_peer_s_means_are_those_of_its_series() {
    for (bed, froude) in points() {
        let row = bed.lammps(froude);
        let (head, series) = bed.lammps_series(froude);
        let name = bed.file.trim_end_matches(".gz");
        let every = row.steps / 400;
        let says = [
            format!("D={} mu={} Fr={froude} ", bed.diameter, bed.friction),
            format!(" dt=0.00015 bed={name};"),
            format!(" the {every} steps "),
        ];
        assert!(says.iter().all(|part| head.contains(part)), "{head}");
        assert_eq!(series.len(), 400);
        for (k, line) in series.iter().enumerate() {
            assert_eq!(line[0] as u64, every * (k as u64 + 1));
        }
        for (axis, sign, at) in [(1, -1.0, 0), (3, 1.0, 2)] {
            let kept: Vec<f64> = series[100..].iter().map(|row| sign * row[axis]).collect();
            let (mean, deviation) = spread(&blocks(&kept, 8));
            for (made, told) in [(mean, at), (deviation / 8f64.sqrt(), at + 1)] {
                assert!(
                    (made / row.means[told] - 1.0).abs() < 1e-8,
                    "{head}: {made}"
                );
            }
        }
    }
}

/// LAMMPS' input and our scenarios say the same.
#[test]
fn both_programs_are_asked_the_same() {
    let input = std::fs::read_to_string(golden("peers/drag/in.lammps")).unwrap();
    let variable = |word: &str| {
        let Some(name) = word.strip_prefix("${").and_then(|w| w.strip_suffix('}')) else {
            return word.to_string();
        };
        let head = format!("variable {name} index ");
        let mut lines = input.lines();
        lines.find_map(|l| l.strip_prefix(&head)).unwrap().into()
    };
    let word = |name: &str, k: usize| -> f64 {
        let line = input.lines().find(|line| line.contains(name)).unwrap();
        let after = line.split_once(name).unwrap().1;
        let word = after.split_whitespace().nth(k).unwrap();
        variable(word).parse().unwrap()
    };
    let scenario = BEDS[0].scenario(8.0, 0);
    for style in ["pair_style gran/hertz/history", "wall/gran hertz/history"] {
        let style: [f64; 5] = std::array::from_fn(|k| word(style, k));
        assert_eq!(style, hertz_history(&scenario.law));
    }
    assert_eq!(word("timestep", 0), scenario.drag.dt);
    assert_eq!(word("fix weight free gravity", 0), scenario.gravity);
    assert_eq!(word(" zplane", 0), 0.0);
    assert!(input.contains("-var bed bedS_D4_mu0.data -var mu 0 -var floor yes"));
    let speed = word("-var V", 0);
    // The same but for how it was rounded.
    assert!((speed / scenario.drags()[0].motion.speed - 1.0).abs() < 1e-15);
    for (bed, froude) in points() {
        let (scenario, row) = (bed.scenario(froude, 0), bed.lammps(froude));
        let plan = scenario.drags()[0].clone();
        assert_eq!(scenario.beds()[0].diameter, bed.diameter);
        assert!((row.speed / plan.motion.speed - 1.0).abs() < 1e-9);
        // LAMMPS' runs end with a row of their series, 400 of them.
        assert!(row.steps.abs_diff(plan.steps()) <= 200);
        assert_eq!(scenario.bed.floor, bed.friction == 0.0);
    }
}

/// Both programs' drag and lift at a point with their errors, as cells of a table, and the differences
/// over the combined errors.
fn means_of(bed: &Bed, froude: f64) -> (String, [f64; 2]) {
    let l = bed.lammps(froude).means;
    let b = bed.ours(froude)[0].means;
    let [drag, lift] = [0, 2].map(|k| cells([l[k], l[k + 1]], [b[k], b[k + 1]]));
    (
        format!("| {froude} |{}{}", drag.0, lift.0),
        [drag.1, lift.1],
    )
}

const MEANS: &str = "| Fr | drag, LAMMPS | drag, bitgrain | difference \
    | lift, LAMMPS | lift, bitgrain | difference |\n";

/// Means at every point within three combined standard errors, each program's from its own blocks; and
/// the squares of all of them together no larger than chance makes them. The guide shows the first bed.
#[test]
fn drags_agree_with_lammps() {
    let mut shown = format!("{MEANS}{}|\n", "| --- ".repeat(7));
    let mut text = format!("| D | mu {MEANS}{}|\n", "| --- ".repeat(9));
    let mut squares = [0.0; 2];
    let mut worst: f64 = 0.0;
    for (k, (bed, froude)) in points().enumerate() {
        let (row, off) = means_of(bed, froude);
        if k < FROUDES.len() {
            writeln!(shown, "{row}").unwrap();
        }
        writeln!(text, "| {} | {} {row}", bed.diameter, bed.friction).unwrap();
        for (square, off) in squares.iter_mut().zip(off) {
            *square += off * off;
            worst = worst.max(off.abs());
        }
    }
    let chances = squares.map(|square| tail(square, 16));
    for (name, (square, p)) in ["drag", "lift"].iter().zip(squares.iter().zip(chances)) {
        let line = format!("chi-square of {name}: {square:.1} over 16 points, p = {p:.2}");
        writeln!(text, "{line}").unwrap();
    }
    let told = squares.map(|square| format!("{square:.0}"));
    let told = format!(
        "chi-square is {} for drag and {} for lift",
        told[0], told[1]
    );
    assert!(worst < 3.0, "{worst}\n{text}");
    // One per cent is at 32.0.
    assert!(chances.iter().all(|p| *p > 0.01), "{text}");
    assert!(
        validation().contains(&shown),
        "the guide's table should be\n{shown}"
    );
    assert!(validation().contains(&told), "the guide should say: {told}");
    snapshot(
        "comparison",
        "cargo test -p bitgrain-tests --release --test physics drag::",
        &text,
    );
}

/// The decay of the fast drags, part by part, and their means: the table, and LAMMPS' run against ours
/// over their spread, column by column.
fn decay(bed: &Bed) -> (String, Vec<(String, f64)>) {
    let mut text = String::from(
        "| Fr | eighth of the run | 1 | 2 | 3 | 4 | 5 | 6 | 7 | 8 | mean of 5 to 20 d |\n",
    );
    writeln!(text, "{}|", "| --- ".repeat(11)).unwrap();
    let mut offs = Vec::new();
    for froude in EIGHTHS {
        let runs = bed.ours(froude);
        assert_eq!(runs.len(), REPLICAS);
        let drags: Vec<f64> = bed
            .lammps_series(froude)
            .1
            .iter()
            .map(|row| -row[1])
            .collect();
        let mut theirs = blocks(&drags, 8);
        theirs.push(bed.lammps(froude).means[0]);
        let mut rows = [
            format!("| {froude} | LAMMPS |"),
            "| | bitgrain, the same steps |".to_string(),
            format!("| | bitgrain, {REPLICAS} runs |"),
        ];
        for (k, theirs) in theirs.into_iter().enumerate() {
            let of = |run: &Ours| *run.eighths.get(k).unwrap_or(&run.means[0]);
            let values: Vec<f64> = runs.iter().map(of).collect();
            let (mean, deviation) = spread(&values);
            write!(rows[0], " {theirs:.0} |").unwrap();
            write!(rows[1], " {:.0} |", values[0]).unwrap();
            write!(rows[2], " {mean:.0} ± {deviation:.0} |").unwrap();
            // One run of theirs against the mean of ours, which spread as theirs would.
            let off = (theirs - mean) / (deviation * (1.0 + 1.0 / REPLICAS as f64).sqrt());
            let place = format!(
                "{} {} Fr {froude}, column {}",
                bed.diameter,
                bed.friction,
                k + 1
            );
            offs.push((place, off));
        }
        rows.iter().for_each(|row| writeln!(text, "{row}").unwrap());
    }
    (text, offs)
}

/// The decay agrees part by part at every bed. The guide shows the first bed.
#[test]
fn eighths_of_fast_drags_agree_with_lammps() {
    let mut text = String::new();
    let mut offs = Vec::new();
    for bed in &BEDS {
        let (table, off) = decay(bed);
        writeln!(text, "D = {}, mu = {}\n{table}", bed.diameter, bed.friction).unwrap();
        offs.extend(off);
    }
    let far: Vec<_> = offs.iter().filter(|(_, off)| off.abs() >= 3.0).collect();
    assert!(far.is_empty(), "{far:?}\n{text}");
    let (shown, _) = decay(&BEDS[0]);
    assert!(
        validation().contains(&shown),
        "the guide's table should be\n{shown}"
    );
    snapshot(
        "eighths",
        "cargo test -p bitgrain-tests --release --test physics drag::",
        &text,
    );
}

/// The beginning of a drag at Fr 5 with LAMMPS' series of it: rows of both.
fn first_rows(bed: &Bed, floor: bool, rows: u64) -> Result<Vec<[[f64; 2]; 2]>, Error> {
    let (_, theirs) = bed.lammps_series(5.0);
    let scenario = bed.scenario(5.0, 0).changed(|s| {
        s.bed.floor = floor;
        s.measure.every = theirs[0][0] as u64;
    });
    let scenario = scenario.unwrap();
    let mut plan = scenario.drags()[0].clone();
    let steps = rows * scenario.measure.every;
    plan.motion = plan.motion.averaged_beyond(0.1, steps);
    let mut sim = bitgrain::bed::import::bed(&scenario, scenario.source.as_deref().unwrap())?;
    let (_, record) = drag(&mut sim, &plan, &mut ())?;
    let pairs = record.series.iter().zip(theirs);
    let pairs = pairs.map(|(ours, theirs)| {
        assert_eq!(ours.step as f64, theirs[0]);
        let ours = [ours.force_mean[0], ours.force_mean[1]];
        [ours, [-theirs[1], theirs[3]]]
    });
    Ok(pairs.collect())
}

/// Six significant digits: half of the last one, and as much for what chaos has made of rounding.
fn same([ours, theirs]: [[f64; 2]; 2]) -> bool {
    let pairs = ours.into_iter().zip(theirs);
    pairs
        .into_iter()
        .all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs())
}

/// Before chaos has made a rounding error large, the two programs give the same forces: drag and lift
/// of the first 40 rows, some 3,000 steps, to the six digits that LAMMPS printed.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn the_first_rows_are_those_of_lammps() {
    for bed in &BEDS {
        let rows = first_rows(bed, bed.friction == 0.0, 40).unwrap();
        assert_eq!(rows.len(), 40);
        for (k, row) in rows.into_iter().enumerate() {
            assert!(same(row), "{}, row {k}: {row:?}", bed.file);
        }
    }
}

/// The floor is what holds frictionless grains: without it the forces soon are others, and a grain leaks.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn frictionless_grains_need_the_floor() {
    let bed = &BEDS[3];
    let rows = first_rows(bed, false, 40).unwrap();
    let agree = rows.into_iter().take_while(|row| same(*row)).count();
    assert!(agree < 40, "{agree}");
    let leak = first_rows(bed, false, 60).unwrap_err();
    let escaped = matches!(
        leak,
        Error::Run {
            fault: KernelError::Escaped { .. },
            ..
        }
    );
    assert!(escaped, "{leak}");
}

/// The fastest drag from its beginning, and a piece of the slowest from a checkpoint.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn pieces_of_the_drags_run_again() {
    let (again, _) = line(&BEDS[0], 8.0, 0);
    assert!(
        body("bitgrain").lines().any(|line| line == again),
        "{again}"
    );

    let mut sim = checkpoint::read(&golden("peers/drag/fr0.5.safetensors")).unwrap();
    let begin = hex(&sim.digest().unwrap().whole);
    sim.steps(PIECE[1] - PIECE[0]).unwrap();
    let text = format!("{begin}\n{}\n", hex(&sim.digest().unwrap().whole));
    assert_eq!(body("piece").trim(), text.trim());
}
