//! The campaigns on Kumar 2018: `kumar-small`, under forty minutes on two cores, and `kumar-middle`, three hours.
//! Their findings are made again from the tables here, and two drags of the small one are done again.
//!
//! `golden/README.md` says how the files are made.

use bitgrain::analysis::{self, describe};
use bitgrain::campaign;
use bitgrain::campaign::table::CampaignTable;
use bitgrain::claims::book::Book;
use bitgrain::claims::evidence::Evidence;
use bitgrain::claims::kumar::measure;
use bitgrain::files::write_text;
use bitgrain::folder::Folder;
use bitgrain::manifest::FolderKind;
use bitgrain_tests::drags::validation;
use bitgrain_tests::wee::forge_manifest;
use bitgrain_tests::{golden, output, unpacked};
use serde_json::Value;

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

/// Campaigns whose tables are here.
const TABLES: [&str; 6] = [
    "kumar-small",
    "kumar-middle",
    "kumar-yield",
    "kumar-table-1",
    "kumar-fig-5",
    "kumar-deep",
];

/// Rows that they have at least.
const ROWS_LEAST: [usize; 6] = [113, 239, 5, 22, 57, 41];

/// Two drags of one bed that are done again: its files, all of the member.
const MEMBER: &str = "mu0.5-D2-h8";
const FILES: [(&str, &str); 2] = [
    ("bed.safetensors.gz", "beds/bed.safetensors"),
    ("bed.chain.csv.gz", "beds/bed.chain.csv"),
];

fn evidence(campaign: &str) -> Evidence {
    Evidence::read(&golden(campaign).join("results.csv.gz"), false).unwrap()
}

/// The guide and the README show the ratios to Table I that the table gives.
#[test]
fn the_documents_have_the_ratios_to_table_one() {
    let table = CampaignTable::read(&golden("kumar-table-1/results.csv.gz")).unwrap();
    let found = analysis::analyse(&table, false).table_one;
    let row = |one: &analysis::TableOne| {
        assert_eq!(one.reading, analysis::Reading::Uncut);
        let cell = |froude: f64| match one.points.iter().find(|point| point.0 == froude) {
            Some((_, _, ratio)) => format!(" {:.3} ± {:.3} |", ratio.value, ratio.error),
            None => " |".into(),
        };
        let cells: String = [0.25, 0.5, 0.75, 0.875, 1.0].map(cell).concat();
        format!("| D = {} d |{cells}\n", one.diameter)
    };
    let rows: String = found.iter().map(row).collect();
    assert!(validation().contains(&rows), "the guide should say\n{rows}");
    let means: Vec<String> = found
        .iter()
        .map(|one| format!("{:.2}", one.ratio.value))
        .collect();
    let largest = found.iter().map(|one| one.ratio.error).fold(0.0, f64::max);
    let told = format!("{} (± {largest:.2})", means.join(", "));
    let readme = std::fs::read_to_string(golden("../README.md")).unwrap();
    assert!(readme.contains(&told), "the README should say {told}");
}

/// From its settled bed each drag gives its row of the table digit for digit.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn rows_done_again_are_those_of_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let member = folder.path().join("out/members").join(MEMBER);
    for (packed, name) in FILES {
        let path = member.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, unpacked(&format!("kumar-small/{packed}"))).unwrap();
    }
    let table = golden("kumar-small/results.csv.gz");
    let rows = [5, 9].map(|k| format!("{MEMBER}/run-{k}"));
    // The campaign's own file is the folder's claim, and comes first; so is the scenario of the member.
    let plan = campaign::load("kumar-small", &[]).unwrap();
    let own = plan.members.iter().find(|one| one.name == MEMBER).unwrap();
    let text = Folder(&member).scenario_text(&own.scenario);
    std::fs::write(member.join("scenario.toml"), text).unwrap();
    forge_manifest(&member, FolderKind::Run, &[]);
    let text = format!("# {}\n{}", bitgrain::files::bits(), plan.text());
    std::fs::write(folder.path().join("out/campaign.toml"), text).unwrap();
    let args = [
        "sweep",
        "kumar-small",
        "--out",
        "out",
        "--only",
        &rows[0],
        "--only",
        &rows[1],
        "--against",
        table.to_str().unwrap(),
        "--found-is-enough",
        "-v",
    ];
    let out = output(PROGRAM, folder.path(), &args);
    let lines = String::from_utf8_lossy(&out.stderr).into_owned();
    // The bed was found.
    assert_eq!(out.status.code(), Some(3), "{lines}");
    assert!(lines.contains("were executed by this call"), "{lines}");
    for how in ["run-5: Fr 2, drag", "run-9: Fr 10, drag", "(dragged,"] {
        assert!(lines.contains(how), "{how}: {lines}");
    }
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(said.contains("2 runs agree with"), "{said}");
}

/// The rows of a table are runs of its campaign as that is now, in its order: all of them, or of a campaign that is
/// still being computed those that are done, which are at least so many.
#[test]
fn tables_are_those_of_the_shipped_campaigns() {
    for (name, least) in TABLES.into_iter().zip(ROWS_LEAST) {
        let table = CampaignTable::read(&golden(name).join("results.csv.gz")).unwrap();
        let plan = campaign::load(name, &[]).unwrap();
        let mut row = 0;
        for member in &plan.members {
            for run in member.scenario.drags() {
                if row == table.len()
                    || [table.text(row, "member"), table.text(row, "run")]
                        != [&member.name, &run.name]
                {
                    continue;
                }
                let near = |column: &str, want: f64| {
                    let got = table.real(row, column).unwrap();
                    assert_eq!(got, want, "{}/{}: {column}", member.name, run.name);
                };
                near("speed", run.motion.speed);
                near("steps", run.steps() as f64);
                near("mu", member.scenario.law.mu());
                near("dt", member.scenario.drag.dt);
                assert_eq!(table.text(row, "digest").len(), 64);
                row += 1;
            }
        }
        assert_eq!(row, table.len(), "{name}");
        assert!(row >= least, "{name}: {row} rows");
    }
}

/// Numbers of two trees agree: to the bit here, to 1e-9 if another mathematical library is behind statrs.
fn same(now: &Value, then: &Value, place: &str) {
    match (now, then) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            let most = if cfg!(target_arch = "x86_64") {
                0.0
            } else {
                1e-9
            };
            assert!(
                (a - b).abs() <= most * b.abs(),
                "{place}: {a} instead of {b}"
            );
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{place}");
            for (k, (a, b)) in a.iter().zip(b).enumerate() {
                same(a, b, &format!("{place}[{k}]"));
            }
        }
        (Value::Object(a), Value::Object(b)) => {
            let names = |map: &serde_json::Map<String, Value>| -> Vec<String> {
                map.keys().cloned().collect()
            };
            assert_eq!(names(a), names(b), "{place}");
            for (name, value) in a {
                same(value, &b[name], &format!("{place}.{name}"));
            }
        }
        _ => assert_eq!(now, then, "{place}"),
    }
}

/// Every fitted number, with errors, covariance and residuals, follows from the table again; the
/// result is there to read.
#[test]
fn tables_say_what_they_said() {
    for name in TABLES {
        let evidence = evidence(name);
        let now = analysis::text(&evidence.analysis);
        if std::env::var("INSTA_UPDATE").as_deref() == Ok("always") {
            write_text(&golden(name).join("analysis.json"), &now, true).unwrap();
        }
        let then = unpacked(&format!("{name}/analysis.json.gz"));
        let tree = |text: &[u8]| serde_json::from_slice(text).unwrap();
        same(&tree(now.as_bytes()), &tree(&then), name);
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path(golden(name));
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!("analysis", describe(&evidence.analysis)));
    }
}

/// phi + alpha takes phi of each depth from 25 d on, where the paper has it, and a shallower one only if there is no
/// other.
#[test]
fn the_sum_takes_phi_of_deep_intruders() {
    let mut analysis = evidence("kumar-deep").analysis;
    let book = Book::shipped().claim;
    let claim = book.iter().find(|claim| claim.id == "kumar-sum").unwrap();
    let deep = measure(claim, &analysis).unwrap().unwrap();
    assert_eq!(deep.of, 2, "{}", deep.note);
    assert!(!deep.note.contains(" at 10 d"), "{}", deep.note);
    for scaling in &mut analysis.scaling {
        scaling.phi.retain(|phi| phi.at < 20.0);
    }
    let shallow = measure(claim, &analysis).unwrap().unwrap();
    assert_eq!(shallow.of, 1, "{}", shallow.note);
    assert!(shallow.note.contains(" at 10 d"), "{}", shallow.note);
    assert!(shallow.value.value < deep.value.value);
}

/// The guide says what `kumar-deep` gives with nothing cut, as the paper averages its drags.
#[test]
fn the_guide_has_the_exponents_with_nothing_cut() {
    let text = String::from_utf8(unpacked("kumar-deep/results.csv.gz")).unwrap();
    let (head, rows) = text.split_once("\nmember,").unwrap();
    let (columns, rows) = rows.split_once('\n').unwrap();
    let other = |column| match column {
        "drag" => "drag_uncut",
        "drag_error" => "drag_uncut_error",
        "drag_uncut" => "drag",
        "drag_uncut_error" => "drag_error",
        same => same,
    };
    let columns: Vec<&str> = columns.split(',').map(other).collect();
    let swapped = format!("{head}\nmember,{}\n{rows}", columns.join(","));
    let table = CampaignTable::parse(&swapped, "swapped").unwrap();
    let analysis = analysis::analyse(&table, false);
    let book = Book::shipped().claim;
    let of = |id: &str| {
        let claim = book.iter().find(|claim| claim.id == id).unwrap();
        let found = measure(claim, &analysis).unwrap().unwrap();
        (found.value.value, found.value.error)
    };
    let phi = analysis.scaling[0].phi.iter();
    let phi = phi.filter_map(|one| one.fit.found()?.parameter("p"));
    let phi: Vec<_> = phi.map(|p| (p.value, p.error)).collect();
    let [shallow, middle, deep] = phi[..] else {
        panic!("phi at three depths")
    };
    let told = |(value, error): (f64, f64)| format!("{value:.2} ± {error:.2}");
    let (alpha, error) = of("kumar-alpha-above-one");
    let told = format!(
        "phi is {}, {} and {}, its growth {}, alpha {alpha:.3} ± {error:.3}, and the sum {} at 26 d",
        told(shallow),
        told(middle),
        told(deep),
        told(of("kumar-phi-depth")),
        told(of("kumar-sum"))
    );
    let page = validation();
    let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(page.contains(&told), "the guide should say {told}");
}

/// The page shows every section, draws no invalid number, and is small enough to be opened.
#[test]
fn tables_have_a_page() {
    for name in TABLES {
        let page = bitgrain::report::campaign_page(&evidence(name));
        assert!(page.len() < 5_000_000, "{}", page.len());
        for heading in [
            "Drag against Froude number",
            "Round the intruder",
            "Yield force",
            "Does the bed above stay?",
            "Beside the paper",
            "Every fit",
            "The runs",
        ] {
            assert!(
                page.contains(&format!(">{heading}</h2>")),
                "{name}: {heading}"
            );
        }
        assert!(!page.contains("NaN") && !page.contains("inf\""), "{name}");
        // The others have a few drags.
        let charts = if TABLES[..2].contains(&name) { 15 } else { 3 };
        let drawn = page.matches("<svg class=\"chart\"").count();
        assert!(drawn > charts, "{name}: {drawn}");
        let table = CampaignTable::read(&golden(name).join("results.csv.gz")).unwrap();
        for row in 0..table.len() {
            let name = format!(
                ">{}/{}</th>",
                table.text(row, "member"),
                table.text(row, "run")
            );
            assert_eq!(page.matches(&name).count(), 1, "{name}");
        }
    }
}
