//! A report as a browser shows it: nothing cut off, no text too small, no label over another, a
//! unit on every axis, no error, on a desk and on a phone.
//!
//! Needs a Chromium: `cargo test -p bitgrain-tests --release --test tools browser:: -- --ignored`. The
//! variable `CHROMIUM` names its program if that is not `chromium`.

use std::path::Path;
use std::process::Command;

use bitgrain::frames::{Frame, Slice};
use bitgrain::motion::Moves;
use bitgrain::report::{
    self, BedPicture, Drawings, Film, FlowGrain, FlowPicture, PictureGrain, Scene,
};
use bitgrain::scenario::{self};
use bitgrain::series::SeriesRow;
use bitgrain::simulation::Role;
use bitgrain::summary::{Summary, parse_summary};
use bitgrain_tests::golden;

use crate::chromium::{Browser, IN_SOFTWARE};

/// Widths of a desk's and a phone's window, in CSS pixels.
const WIDTHS: [u32; 2] = [1280, 390];
/// Smallest text that can be read on a phone, in CSS pixels.
const SMALLEST: f64 = 9.0;

/// Looks through the page in the frame and writes what is wrong into the document, a line each.
const SCRIPT: &str = concat!(include_str!("browser.js"), include_str!("frame.js"));

/// A made-up number between 0 and 1 for each `n`; neighbours are unlike.
fn noise(n: u64) -> f64 {
    let mixed = (n + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) as f64 / u64::MAX as f64
}

/// The golden numbers of the quick scenario, every run also through a second bed.
fn summary() -> Summary {
    let text = std::fs::read_to_string(golden("quick/summary.snap")).unwrap();
    let json = &text[text
        .find("\n{")
        .expect("a summary after the snapshot's head")..];
    let mut whole = parse_summary(json, Path::new("quick")).unwrap();
    let mut deep = whole.beds[0].clone();
    deep.name = "bed-2".into();
    whole.beds.push(deep);
    for mut run in whole.runs.clone() {
        run.name = format!("{}-deep", run.name);
        run.bed = "bed-2".into();
        whole.runs.push(run);
    }
    whole
}

/// The same with every length in metres and forces that need a power of ten.
fn in_si(mut whole: Summary) -> Summary {
    whole.units = scenario::parse(SI, "si", &[], Path::new(""))
        .unwrap()
        .units();
    for run in &mut whole.runs {
        run.drag.mean *= 1e-9;
        run.drag.standard_error *= 1e-9;
    }
    whole
}

/// A scenario in SI units with the other contact law.
const SI: &str = "name = \"glass-beads-in-a-box-with-a-rather-long-name\"\nunits = \"si\"\n\
gravity = 9.81\n[bed]\nbox = [0.1, 0.06, 0.05]\ngrains = 12000\ndiameters = [0.0027, 0.0033]\n\
density = 2500.0\nbase = 0.002\n[law]\nkind = \"hertz_tsuji\"\nyoung = 5e6\npoisson = 0.45\n\
restitution = 0.6\nmu = 0.5\n[intruder]\ndiameter = 0.01\ndensity = 2500.0\nheight = 0.02\n\
froude = [0.5, 2.0]\n[drag]\ndt = 1e-6\ndistance = 0.05\n";

/// A force series whose forces are of the size of `force`.
fn series(force: f64, time: f64) -> Vec<SeriesRow> {
    let row = |k: u64| SeriesRow {
        step: 25 * k,
        time: time * k as f64 / 600.0,
        distance: k as f64 / 75.0,
        force_mean: [force * (noise(k) + noise(k / 20)), 0.0, 0.0],
        ..SeriesRow::default()
    };
    (1..=600).map(row).collect()
}

/// Sites of a jittered lattice that fills a box of quick's size, `unit` long each.
fn sites(unit: f64) -> Vec<[f64; 3]> {
    let site = |n: u64| {
        let place = [n % 20, n / 20 % 13, n / 260].map(|k| k as f64);
        [0, 1, 2].map(|a| unit * (place[a] + 0.5 + 0.3 * (noise(3 * n + a as u64) - 0.5)))
    };
    (0..2340).map(site).collect()
}

fn bed_picture(name: &str, unit: f64) -> BedPicture {
    let grain = |position: [f64; 3]| PictureGrain {
        position,
        radius: 0.5 * unit,
        role: if position[2] < unit {
            Role::Base
        } else {
            Role::Free
        },
    };
    BedPicture {
        name: name.into(),
        lo: [0.0; 3],
        hi: [20.0, 13.0, 40.0].map(|x| x * unit),
        surface: 9.0 * unit,
        grains: sites(unit).into_iter().map(grain).collect(),
        intruder: ([10.0, 6.5, 4.0].map(|x| x * unit), unit),
        half_length: None,
        moves: Moves::Intruder,
        arrow: true,
    }
}

/// A flow that falls off with the distance from the intruder, through every colour.
fn flow_picture(run: &str, froude: f64, unit: f64) -> FlowPicture {
    let centre = [18.0, 6.5, 4.0].map(|x| x * unit);
    let grain = |position: [f64; 3]| {
        let off: [f64; 3] = std::array::from_fn(|a| (position[a] - centre[a]) / unit);
        let square = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
        FlowGrain {
            position,
            radius: 0.5 * unit,
            velocity: [2.5 / (1.0 + 0.3 * square), 0.0, off[2] / (1.0 + square)],
            role: if position[2] < unit {
                Role::Base
            } else {
                Role::Free
            },
        }
    };
    FlowPicture {
        run: run.into(),
        froude,
        speed: 1.5,
        travel: 8.0 * unit,
        lo: [0.0; 3],
        hi: [20.0, 13.0, 40.0].map(|x| x * unit),
        intruder: (centre, unit),
        reach: 7.0 * unit,
        moves: Moves::Intruder,
        grains: sites(unit).into_iter().map(grain).collect(),
    }
}

/// A drag past a lattice, forty frames of it.
fn film(run: &str) -> Film {
    let cut = |n: u64, travel: f64| Slice {
        x: (n % 14) as f64 - 7.0 - travel % 1.0,
        z: (n / 14) as f64 - 4.0,
        radius: 0.3 + 0.2 * noise(n),
        u: 0.0,
        w: 0.0,
        speed: noise(n + 7),
        role: if n < 14 { Role::Base } else { Role::Free },
    };
    let frame = |k: u64| Frame {
        step: k,
        travel: 0.25 * k as f64,
        cuts: (0..140).map(|n| cut(n, 0.25 * k as f64)).collect(),
    };
    Film {
        run: run.into(),
        radius: 1.0,
        floor: 4.0,
        moves: Moves::Intruder,
        frames: (1..=40).map(frame).collect(),
    }
}

/// Reports to look at, with their names: reduced units with two beds, and SI.
fn pages() -> Vec<(&'static str, String)> {
    let page = |whole: &Summary, text: &str, unit: f64, force: f64| {
        let rows: Vec<_> = whole.runs.iter().map(|_| series(force, 16.0)).collect();
        let beds: Vec<_> = whole
            .beds
            .iter()
            .map(|b| bed_picture(&b.name, unit))
            .collect();
        // The last run has none, and the page says so.
        let runs = &whole.runs[..whole.runs.len() - 1];
        let flows: Vec<_> = runs
            .iter()
            .map(|run| flow_picture(&run.name, run.froude, unit))
            .collect();
        let films: Vec<_> = runs.iter().map(|run| film(&run.name)).collect();
        let scene = Scene {
            state: flows[0].clone(),
            half_length: None,
        };
        let drawings = Drawings {
            scene: Some(&scene),
            series: &rows,
            beds: &beds,
            flows: &flows,
            films: &films[..2],
            ..Drawings::default()
        };
        report::page(whole, text, &drawings)
    };
    let reduced = scenario::load("quick", &[]).unwrap().to_toml();
    let si = scenario::parse(SI, "si", &[], Path::new(""))
        .unwrap()
        .to_toml();
    vec![
        ("reduced", page(&summary(), &reduced, 1.0, 200.0)),
        ("si", page(&in_si(summary()), &si, 0.003, 2e-7)),
    ]
}

/// What is wrong with a page in a window of a width, a line for each find.
fn finds(folder: &Path, page: &str, width: u32) -> Vec<String> {
    std::fs::write(folder.join("report.html"), page).unwrap();
    let wrapper = format!(
        "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<body><iframe id=\"page\" src=\"report.html\" \
         style=\"border:0;width:{width}px;height:2000px\"></iframe><pre id=\"finds\"></pre>\n\
         <script>const SMALLEST = {SMALLEST};\n{SCRIPT}</script></body>\n"
    );
    let path = folder.join("wrapper.html");
    std::fs::write(&path, wrapper).unwrap();
    let program = std::env::var("CHROMIUM").unwrap_or_else(|_| "chromium".into());
    let run = Command::new(&program)
        .args(["--headless", "--no-sandbox"])
        .args(IN_SOFTWARE)
        .args(["--allow-file-access-from-files", "--enable-logging=stderr"])
        .args(["--virtual-time-budget=10000", "--window-size=1400,2100"])
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .arg("--dump-dom")
        .arg(format!("file://{}", path.display()))
        .output()
        .unwrap_or_else(|e| panic!("{program} cannot be started (set CHROMIUM): {e}"));
    let errors = String::from_utf8_lossy(&run.stderr);
    let logged = errors.lines().filter(|line| line.contains("CONSOLE"));
    let mut finds: Vec<String> = logged.map(|line| format!("console: {line}")).collect();
    let dom = String::from_utf8_lossy(&run.stdout);
    let written = dom
        .split_once("<pre id=\"finds\">")
        .and_then(|(_, rest)| rest.split_once("</pre>"))
        .map_or("", |(text, _)| text);
    // The last line counts what was looked at: without it the script did not come to its end.
    if !written.lines().any(|line| line.starts_with("looked at ")) {
        finds.push(format!(
            "the script did not end; the browser said\n{errors}"
        ));
    }
    let looked = |line: &&str| !line.is_empty() && !line.starts_with("looked at ");
    finds.extend(written.lines().filter(looked).map(str::to_owned));
    finds
}

#[test]
#[ignore = "needs a Chromium"]
fn a_report_can_be_read_on_a_desk_and_on_a_phone() {
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for (name, page) in pages() {
        for width in WIDTHS {
            let finds = finds(folder.path(), &page, width);
            wrong.extend(
                finds
                    .iter()
                    .map(|find| format!("{name} at {width} px: {find}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The last snapshot is drawn: where WebGL is, its canvas is not empty; where it is not, the page says so.
#[test]
#[ignore = "needs a Chromium"]
fn the_last_snapshot_is_seen_from_every_side() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.html");
    let (_, page) = &pages()[0];
    std::fs::write(&file, page).unwrap();
    let mut browser = Browser::start(&[]);
    browser.open(&file, "");
    // A picture is kept until the next frame: it is drawn by a key and read in the same one.
    let picture = "new Promise((done) => requestAnimationFrame(() => { \
         const canvas = document.querySelector('figure.scene canvas'), copy = document.createElement('canvas'); \
         canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'})); \
         requestAnimationFrame(() => { [copy.width, copy.height] = [60, 40]; \
         const flat = copy.getContext('2d'); flat.drawImage(canvas, 0, 0, 60, 40); \
         const {data} = flat.getImageData(0, 0, 60, 40); \
         done([...data].filter((x, k) => k % 4 === 3 && x > 0).length); }); }))";
    let seen = browser.value(picture).as_u64().unwrap();
    // The bed fills about a fifth of its canvas, and neither all nor nothing of it.
    assert!((200..2000).contains(&seen), "{seen} of 2,400 parts");
    assert_eq!(browser.errors(), Vec::<String>::new());
    assert_eq!(browser.requests(), Vec::<String>::new());
    let mut blind = Browser::start(&["--disable-3d-apis"]);
    blind.open(&file, "");
    let note = blind.value("document.querySelector('figure.scene .none').textContent");
    assert_eq!(note, "There is no picture: this browser shows no WebGL 2.");
}

/// The checks themselves: a page with one fault of each kind has each of them found.
#[test]
#[ignore = "needs a Chromium"]
fn faults_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let page = "<!DOCTYPE html><html><body style=\"margin:0\">\
        <p style=\"font-size:8px\">tiny</p><p style=\"width:2000px\">wide</p>\
        <svg class=\"chart\" viewBox=\"0 0 100 100\" width=\"100\"><text x=\"80\" y=\"20\">beyond\
        </text><text x=\"10\" y=\"50\">over</text><text x=\"14\" y=\"52\">lap</text>\
        <text x=\"10\" y=\"90\">x (d)</text></svg>\
        <script>console.error('said'); throw new Error('thrown')</script></body></html>";
    let finds = finds(folder.path(), page, 390).join("\n");
    for part in [
        "wider than the window",
        "beyond the window",
        "small text",
        "outside its drawing",
        "texts overlap",
        "no upright axis label",
        "said",
        "thrown",
    ] {
        assert!(finds.contains(part), "no \"{part}\" in\n{finds}");
    }
    assert!(!finds.contains("no level axis label"), "{finds}");
}
