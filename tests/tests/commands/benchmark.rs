//! `bitgrain benchmark`: what it writes, that all checks hold, and what it says of a wrong name.

use std::path::Path;

use bitgrain_tests::{differing, golden, number, printed, results};
use serde_json::Value;

use crate::PROGRAM;

/// The rows of a table under its heading, as text.
fn rows(text: &str) -> (Vec<&str>, Vec<Vec<&str>>) {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == head.len()));
    (head, rows)
}

/// Numbers of a column.
fn column(text: &str, name: &str) -> Vec<f64> {
    let (head, rows) = rows(text);
    let at = head.iter().position(|own| *own == name).expect("a column");
    rows.iter()
        .map(|row| row[at].parse().expect("a number"))
        .collect()
}

/// All eight tests hold; the same bytes in every run; theory is met by the tables themselves.
#[test]
fn chung_and_ooi_hold() {
    let folder = tempfile::tempdir().unwrap();
    let run = |out: &str| {
        let text = printed(
            PROGRAM,
            folder.path(),
            &["benchmark", "chung-ooi", "--out", out],
            0,
        );
        (text, results(&folder.path().join(out)))
    };
    let (text, files) = run("one");
    assert_eq!(text.matches(" checks hold").count(), 8, "{text}");
    let (_, again) = run("two");
    assert!(differing(&files, &again).is_empty());
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    let tables = (1..9).map(|k| format!("test-{k}.csv"));
    let expected: Vec<String> = ["report.html", "summary.json"]
        .map(String::from)
        .into_iter()
        .chain(tables)
        .collect();
    assert_eq!(names, expected);

    let summary: Value = serde_json::from_slice(&files["summary.json"]).unwrap();
    let tests = summary["tests"].as_array().unwrap();
    let checks = tests
        .iter()
        .flat_map(|test| test["checks"].as_array().unwrap());
    let held = checks.map(|check| {
        assert_eq!(check["holds"], true, "{check}");
        assert!(
            number(&check["deviation"]) <= 1e-3 && number(&check["cases"]) >= 1.0,
            "{check}"
        );
    });
    assert!(held.count() > 50);
    // Published curves of these tests are compared.
    let compared = tests
        .iter()
        .filter(|test| !test["comparisons"].as_array().unwrap().is_empty());
    let compared: Vec<f64> = compared.map(|test| number(&test["number"])).collect();
    assert_eq!(compared, [1.0, 2.0, 4.0, 5.0, 6.0, 8.0]);
    // In test 4 the whole curves are within 4 % of the published ones; digitising alone is good to 1 %.
    for one in tests[3]["comparisons"].as_array().unwrap() {
        assert!(number(&one["largest"]) < 0.04, "{one}");
    }

    let table = |k: usize| std::str::from_utf8(&files[&format!("test-{k}.csv")]).unwrap();
    // Glass by Hertz, (4/3) E* sqrt(R) delta^(3/2); limestone as published.
    let force = column(table(1), "force");
    let highest = |part: &[f64]| part.iter().fold(0.0, |a: f64, b| a.max(*b));
    let half = force.len() / 2;
    assert!((highest(&force[..half]) / 10_697.0 - 1.0).abs() < 1e-3);
    assert!((highest(&force[half..]) / 7_108.0 - 1.0).abs() < 1e-3);
    let (asked, found) = (
        column(table(3), "restitution"),
        column(table(3), "normal_restitution"),
    );
    assert_eq!(asked.len(), 10);
    for (asked, found) in asked.iter().zip(&found) {
        assert!((found / asked - 1.0).abs() < 1e-3, "{asked} {found}");
    }
    // Each material of each test, and both cases of test 8.
    for (k, materials) in [
        (1, 2),
        (2, 2),
        (3, 2),
        (4, 2),
        (5, 2),
        (6, 2),
        (7, 2),
        (8, 2),
    ] {
        let (_, rows) = rows(table(k));
        let found: std::collections::BTreeSet<&str> = rows.iter().map(|row| row[0]).collect();
        assert_eq!(found.len(), materials, "test {k}");
    }
    let page = std::str::from_utf8(&files["report.html"]).unwrap();
    assert_eq!(page.matches("<h2 id=\"test-").count(), 8);
    assert_eq!(page.matches("<svg class=\"chart\"").count(), 34);
    assert!(!page.contains("NaN") && !page.contains("<b>no</b>"));
}

/// A small bed, for a while before the ball meets it: it falls as theory says, the same bytes on one thread and two,
/// and from a file of the places too.
#[test]
fn a_ball_falls_on_a_bed() {
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &[&str], out: &str| {
        let args = [
            &[
                "benchmark",
                "dosta-impact",
                "--until",
                "0.005",
                "--out",
                out,
            ],
            more,
        ]
        .concat();
        let text = printed(PROGRAM, folder.path(), &args, 0);
        (text, results(&folder.path().join(out)))
    };
    let (text, files) = run(&["--grains", "400", "--threads", "1"], "one");
    assert_eq!(text.matches("2 of 2 checks hold").count(), 2, "{text}");
    assert_eq!(text.matches("g = 9.8: ").count(), 2, "{text}");
    let (_, again) = run(&["--grains", "400", "--threads", "2"], "two");
    assert!(differing(&files, &again).is_empty());
    let table = |files: &std::collections::BTreeMap<String, Vec<u8>>, k: usize| {
        String::from_utf8(files[&format!("test-{k}.csv")].clone()).unwrap()
    };
    for (k, g) in [(1, 9.81), (2, 9.8)] {
        let text = table(&files, k);
        let (time, z, v) = (
            column(&text, "time"),
            column(&text, "z"),
            column(&text, "vz"),
        );
        // One row each millisecond.
        assert_eq!(time.len(), 6);
        for ((t, z), v) in time.iter().zip(&z).zip(&v) {
            assert!(
                (z - (0.06 - 5.0 * t - 0.5 * g * t * t)).abs() < 1e-12,
                "{t}"
            );
            assert!((v - (-5.0 - g * t)).abs() < 1e-11, "{t}");
        }
    }
    let start =
        "Radius[m] PosX[m] PosY[m] PosZ[m]\n0.001 0.04 0.02 -0.0892\n5 0.01 0.01 0 0 0.06\n";
    std::fs::write(folder.path().join("start.txt"), start).unwrap();
    let (_, from_file) = run(&["--start", "start.txt"], "three");
    assert_eq!(
        table(&from_file, 1),
        table(&files, 1),
        "the ball is still in the air"
    );
    let page = std::str::from_utf8(&from_file["report.html"]).unwrap();
    assert!(page.contains("as in start.txt"));

    // One layer does not stop it, and bodies do not push each other.
    let through = [
        "benchmark",
        "dosta-impact",
        "--start",
        "start.txt",
        "--out",
        "four",
    ];
    let refused = printed(PROGRAM, folder.path(), &through, 2);
    assert!(refused.contains("take a deeper bed"), "{refused}");
    for (wrong, said) in [
        (vec!["dosta-impact", "--grains", "0"], "--grains: is 0"),
        (vec!["dosta-impact", "--until", "0"], "--until: is 0"),
        (vec!["dosta-impact", "--start", "none.txt"], "none.txt"),
        (
            vec!["chung-ooi", "--until", "1"],
            "--until: is no option of chung-ooi",
        ),
    ] {
        let args = [vec!["benchmark"], wrong, vec!["--out", "five"]].concat();
        let refused = printed(PROGRAM, folder.path(), &args, 2);
        assert!(refused.contains(said), "{refused}");
    }
    assert!(!folder.path().join("five").exists());
}

/// At its full size, poured and hit at both values of g, it gives the golden ways of the ball.
#[test]
#[ignore = "10 billion grain-steps: `.ci/run impact`, eight minutes on two cores"]
fn the_ball_goes_its_golden_way() {
    let folder = tempfile::tempdir().unwrap();
    printed(
        PROGRAM,
        folder.path(),
        &["benchmark", "dosta-impact", "--out", "out"],
        0,
    );
    let files = results(&folder.path().join("out"));
    for name in ["test-1.csv", "test-2.csv"] {
        let own = String::from_utf8(files[name].clone()).unwrap();
        let theirs = std::fs::read_to_string(golden("dosta-impact").join(name)).unwrap();
        assert_eq!(own, theirs, "{name}");
    }
}

#[test]
fn a_benchmark_is_asked_for_by_name() {
    let here = Path::new(".");
    let list = printed(PROGRAM, here, &["benchmark"], 0);
    assert!(list.starts_with("chung-ooi "), "{list}");
    let refused = printed(PROGRAM, here, &["benchmark", "chung-oui"], 2);
    assert_eq!(
        refused,
        "bitgrain: chung-oui: is no benchmark; there are: chung-ooi, dosta-impact\n"
    );
    printed(PROGRAM, here, &["benchmark", "--out", "nowhere"], 2);
    // A folder of something else is left alone.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scenario.toml"), "x").unwrap();
    let refused = printed(
        PROGRAM,
        folder.path(),
        &["benchmark", "chung-ooi", "--out", "."],
        2,
    );
    assert!(refused.contains("holds scenario.toml"), "{refused}");
    assert_eq!(results(folder.path()).len(), 1);
}
