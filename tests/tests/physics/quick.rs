//! The quick scenario as a user runs it: its goldens, and equal bytes for a second run.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use bitgrain::bed::library::BedCache;
use bitgrain::folder::Folder;
use bitgrain::progress::Progress;
use bitgrain::{published, remarks, scenario, summary};
use bitgrain_tests::{golden, printed, results, root, unpacked};

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

fn settings(recipe: &str) -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("quick"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(recipe);
    settings
}

fn snapshot(name: &str, recipe: &str, text: &str) {
    settings(recipe).bind(|| insta::assert_snapshot!(name, text));
}

/// The first picture of a report as a separate file: the one that the README shows.
fn first_picture(report: &[u8]) -> Vec<u8> {
    let page = std::str::from_utf8(report).unwrap();
    let begin = page.find("<svg class=\"slice\"").unwrap();
    let end = begin + page[begin..].find("</svg>").unwrap() + "</svg>".len();
    let picture = &page[begin..end];
    let alone = "<svg xmlns=\"http://www.w3.org/2000/svg\" ";
    picture.replacen("<svg ", alone, 1).into_bytes()
}

/// The files that the guide's chapter on file formats promises.
fn check_names(files: &BTreeMap<String, Vec<u8>>) {
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    let of_run = |name: &&&str| name.starts_with("runs/run-1/");
    assert_eq!(
        names.iter().filter(of_run).collect::<Vec<_>>(),
        [
            &"runs/run-1/angles.csv",
            &"runs/run-1/chain.csv",
            &"runs/run-1/checkpoints/000000004685.safetensors",
            &"runs/run-1/checkpoints/000000009370.safetensors",
            &"runs/run-1/checkpoints/000000014055.safetensors",
            &"runs/run-1/checkpoints/000000018739.safetensors",
            &"runs/run-1/coordination.csv",
            &"runs/run-1/forces.csv",
            &"runs/run-1/frames/000000004685.csv",
            &"runs/run-1/frames/000000009370.csv",
            &"runs/run-1/snapshots/contacts.000000009370.vtk",
            &"runs/run-1/snapshots/contacts.000000018739.vtk",
            &"runs/run-1/snapshots/grains.000000009370.dump",
            &"runs/run-1/snapshots/grains.000000009370.vtk",
            &"runs/run-1/snapshots/grains.000000018739.dump",
            &"runs/run-1/snapshots/grains.000000018739.vtk",
            &"runs/run-1/summary.json",
        ]
    );
    let others: Vec<&&str> = names
        .iter()
        .filter(|name| !name.starts_with("runs/"))
        .collect();
    assert_eq!(
        others,
        [
            &"beds/bed.chain.csv",
            &"beds/bed.data",
            &"beds/bed.safetensors",
            &"manifest.json",
            &"report.html",
            &"scenario.toml",
            &"summary.json"
        ]
    );
}

/// The fastest of the three drags alone, from its bed to its report: every file, the picture that the README shows, and
/// the last links that the README, the guide and the program itself tell. It takes some fifteen seconds of a processor
/// because it is what newcomers make.
#[test]
#[cfg_attr(debug_assertions, ignore = "a quarter of a minute in release")]
fn the_fastest_drag_gives_its_goldens() {
    let one = ["intruder.froude=3.0", "drag.distance=32.0"].map(String::from);
    let quick = scenario::load("quick", &one).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let library = BedCache::new(folder.path().join("beds"));
    let out = folder.path().join("out");
    bitgrain::present::run(&quick, &out, &library, 2, &Progress::new(false)).unwrap();
    let files = results(&out);
    check_names(&files);
    let whole = summary::read_summary(&out.join("summary.json")).unwrap();
    let bed = &whole.beds[0];
    assert!(
        (bed.support / bed.weight - 1.0).abs() < 1e-3,
        "the settled bed carries its weight"
    );
    assert!((0.58..0.62).contains(&bed.packing_fraction), "{bed:?}");
    assert!((4.0..6.0).contains(&bed.coordination_number), "{bed:?}");
    let run = &whole.runs[0];
    assert!(run.drag.mean > 0.0 && run.lift.mean > 0.0);
    let published: BTreeMap<&str, &str> = published::links("quick").into_iter().collect();
    assert_eq!(
        [&bed.chain, &run.chain],
        ["bed", "run-3"].map(|stage| published[stage])
    );
    for page in ["README.md", "harness/guide/src/first-run.md"] {
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        assert!(text.contains(published["run-3"]), "{page}");
    }
    let recipe = "recipe: `cargo test -p bitgrain-tests --release --test physics quick::`";
    let hashes: String = files
        .iter()
        .filter(|(name, _)| *name != "report.html")
        .map(|(name, bytes)| format!("{}  {name}\n", blake3::hash(bytes).to_hex()))
        .collect();
    snapshot("files", recipe, &hashes);
    let bed = first_picture(&files["report.html"]);
    settings(recipe).bind(|| insta::assert_binary_snapshot!("bed.svg", bed));
}

/// What a newcomer reads first has nothing to be known before it is believed.
#[test]
fn the_quick_scenario_ends_without_a_remark() {
    let text = std::fs::read_to_string(golden("quick/summary.snap")).unwrap();
    let json = &text[text.find("\n{").unwrap()..];
    let whole = summary::parse_summary(json, Path::new("quick")).unwrap();
    assert_eq!(remarks::remarks(&whole), []);
}

/// Forces to read, every number and digest to hold; and what the command says of them.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn the_quick_scenario_gives_its_goldens() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out/quick");
    let told = |words: &[&str]| {
        let words = [&["run", "quick", "--beds", "beds"], words].concat();
        printed(PROGRAM, folder.path(), &words, 0)
    };
    let ends = "as published: this machine keeps the contract\n";
    let said = told(&[]);
    assert!(
        said.contains(ends) && !said.contains("before you believe it"),
        "{said}"
    );
    let said = told(&[]);
    assert!(
        said.contains("not confirmed: the links are as published, and 0 of ")
            && !said.contains(ends),
        "{said}"
    );
    let whole = summary::read_summary(&out.join("summary.json")).unwrap();
    let recipe = "recipe: `bitgrain run quick`";
    let mut table = String::from(
        "   Fr        V   drag +- error        lift +- error    contacts  angle  coordination\n",
    );
    for r in &whole.runs {
        table.push_str(&format!(
            "{:5.2} {:8.4} {:8.2} +- {:5.2} {:10.2} +- {:5.2} {:10.2} {:8.3} {:8.2}\n",
            r.froude,
            r.speed,
            r.drag.mean,
            r.drag.standard_error,
            r.lift.mean,
            r.lift.standard_error,
            r.contacts.mean,
            r.contact_angle.map_or(f64::NAN, |a| a.mean),
            r.coordination.map_or(f64::NAN, |z| z.mean),
        ));
    }
    snapshot("forces", recipe, &table);
    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    snapshot("summary", recipe, &text);
}

/// The bed that other tests begin with is that of `pull-quick`.
#[test]
#[ignore = "ten seconds: `.ci/run long`"]
fn the_bed_of_other_tests_is_poured_again() {
    let scenario = scenario::load("pull-quick", &[]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let words = [
        "run",
        "pull-quick",
        "--beds",
        "beds",
        "--out",
        "out",
        "--only",
        "run-1",
    ];
    printed(PROGRAM, folder.path(), &words, 0);
    let settled = std::fs::read(Folder(&out).bed(&scenario.beds()[0].name)).unwrap();
    assert!(settled == unpacked("bed-2500/settled.safetensors.gz"));
}

/// A small run three times: other thread counts, folders, time zones and locales, and finally with
/// the bed that the run before it poured; the same bytes.
#[test]
fn a_second_run_gives_the_same_bytes() {
    let mut results_of = Vec::new();
    let library = tempfile::tempdir().unwrap();
    let settings = [
        ("1", "UTC", "C", "beds"),
        (
            "3",
            "Asia/Kolkata",
            "de_DE.UTF-8",
            library.path().to_str().unwrap(),
        ),
        ("2", "UTC", "C", library.path().to_str().unwrap()),
    ];
    for (k, (threads, zone, locale, beds)) in settings.into_iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join(format!("out{threads}"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_bitgrain-under-test"));
        command
            .args([
                "run",
                "quick",
                "--threads",
                threads,
                "--beds",
                beds,
                "--out",
            ])
            .arg(&out);
        for set in [
            // Enough that threads share the work of each bed and drag.
            "bed.grains=1100",
            "bed.box=[14.0, 11.0, 8.0]",
            "bed.settled=1e-3",
            "intruder.diameter=1.5",
            "intruder.height=2.8",
            "intruder.froude=2.0",
            "drag.distance=3.0",
            "drag.dt=4e-4",
        ] {
            command.args(["--set", set]);
        }
        let run = command
            .current_dir(folder.path())
            .env("TZ", zone)
            .env("LANG", locale)
            .output();
        let run = run.unwrap();
        let told = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{told}");
        assert!(told.is_empty(), "quiet where there is no terminal: {told}");
        assert!(String::from_utf8_lossy(&run.stdout).contains("report.html"));
        let how = std::fs::read_to_string(out.join("performance.json")).unwrap();
        let expected = if k == 2 { "\"reused\"" } else { "\"poured\"" };
        assert!(how.contains(expected), "{how}");
        results_of.push(results(&out));
    }
    // The scenario, the manifest, the summary and the report; the bed; of the drag five tables, four checkpoints,
    // four files of frames and two snapshots of three files.
    assert_eq!(results_of[0].len(), 4 + 3 + 5 + 4 + 4 + 2 * 3);
    assert!(results_of[0] == results_of[1], "the same names and bytes");
    assert!(
        results_of[0] == results_of[2],
        "a reused bed gives the same bytes"
    );
}
