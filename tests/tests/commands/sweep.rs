//! Campaigns: one table of many runs, whatever happens meanwhile.

use std::process::{Command, Stdio};
use std::time::Duration;

use bitgrain::campaign::table::CampaignTable;
use bitgrain_tests::wee::Room;
use bitgrain_tests::{CAMPAIGN, CampaignDesk, failing_campaign, output, results};

use crate::{CAMP, FINISHED, PROGRAM};

type Desk = CampaignDesk;

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_ends_with_the_same_bytes_however_it_was_run() {
    let alone = Desk::new(PROGRAM, CAMPAIGN);
    alone.done(&["--threads", "1"]);
    let want = results(&alone.out());
    let table = alone.table();
    let names: Vec<(&str, &str)> = (0..table.len())
        .map(|k| (table.text(k, "member"), table.text(k, "run")))
        .collect();
    let (a, b) = ("mu0.1", "mu0.5");
    assert_eq!(
        names,
        [(a, "run-1"), (a, "run-2"), (b, "run-1"), (b, "run-2")]
    );
    for name in ["members/mu0.5/report.html", "report.html", "analysis.json"] {
        assert!(want.contains_key(name), "{name}");
    }
    // Side by side, more threads than stages, and all that is there already.
    let beside = Desk::new(PROGRAM, CAMPAIGN);
    let lines = beside.done(&["--threads", "5", "--jobs", "2", "-v"]);
    assert!(
        lines.contains("4 of 4 runs") && lines.contains("mu0.5 run-2: Fr"),
        "{lines}"
    );
    assert!(results(&beside.out()) == want);
    beside.done(&[]);
    assert!(results(&beside.out()) == want);
    // Killed again and again, wherever it was.
    let killed = Desk::new(PROGRAM, CAMPAIGN);
    let mut kills = 0;
    for wait in [10, 40, 80, 30, 120, 60, 150, 100, 50, 200] {
        let mut child = Command::new(PROGRAM)
            .args([
                "sweep",
                "camp.toml",
                "--save-every",
                "500",
                "--threads",
                "2",
            ])
            .current_dir(killed.folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    assert!(kills >= 3, "{kills} kills");
    killed.done(&[]);
    assert!(results(&killed.out()) == want);
}

/// The inputs in the table are those of the members, the numbers and digests those of their runs; the columns of the
/// Parquet file are the table's.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_table_holds_what_its_members_say() {
    let desk = &*CAMP;
    let table = desk.table();
    let parquet = std::fs::read(desk.out().join("results.parquet")).unwrap();
    let holds = |name: &str| {
        parquet
            .windows(name.len())
            .any(|part| part == name.as_bytes())
    };
    for name in ["mu0.5", "drag_error", table.text(3, "digest")] {
        assert!(holds(name), "{name}");
    }
    for k in 0..table.len() {
        let folder = desk.out().join("members").join(table.text(k, "member"));
        let scenario = std::fs::read_to_string(folder.join("scenario.toml")).unwrap();
        assert!(
            scenario.contains(&format!("mu = {}", table.text(k, "mu"))),
            "{scenario}"
        );
        let summary = folder
            .join("runs")
            .join(table.text(k, "run"))
            .join("summary.json");
        let summary: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(summary).unwrap()).unwrap();
        assert_eq!(summary["run"]["digest"], table.text(k, "digest"));
        assert_eq!(
            summary["run"]["drag"]["mean"].as_f64(),
            table.real(k, "drag")
        );
    }
    // A member is a run like any other.
    let member = desk.out().join("members/mu0.1");
    let out = output(
        PROGRAM,
        desk.folder.path(),
        &["verify", member.to_str().unwrap(), "--segment", "run-2"],
    );
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_fails_keeps_its_row_and_stops_nothing() {
    let wrong = failing_campaign();
    let desk = Desk::new(PROGRAM, &wrong);
    let out = desk.sweep(&[]);
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(3), "{message}");
    assert!(message.contains("2 of 3 runs failed"), "{message}");
    let table = desk.table();
    let page = std::fs::read_to_string(desk.out().join("report.html")).unwrap();
    assert!(page.contains("run-2 failed.</b>") && page.contains("did not settle"));
    let ends: Vec<&str> = (0..3).map(|k| table.text(k, "status")).collect();
    assert_eq!(ends, ["done", "failed", "failed"]);
    assert!(table.text(1, "reason").contains("run-2 stopped at step"));
    assert!(table.text(2, "reason").contains("did not settle"));
    assert_eq!(table.real(1, "speed"), Some(150.0));
    assert_eq!(table.text(1, "drag"), "");
    // It is not tried again unless that is asked for, and then ends the same.
    let before = results(&desk.out());
    let again = desk.sweep(&["-v"]);
    let lines = String::from_utf8_lossy(&again.stderr).into_owned();
    assert!(
        again.status.code() == Some(3) && !lines.contains("150"),
        "{lines}"
    );
    assert!(results(&desk.out()) == before);
    // What is lost of a drag that failed is made again.
    let lost = before
        .keys()
        .find(|name| name.ends_with("/run-2/chain.csv"));
    std::fs::remove_file(desk.out().join(lost.unwrap())).unwrap();
    desk.sweep(&[]);
    assert!(results(&desk.out()) == before);
    // Saved often on the way: a drag that failed leaves no state to go on from.
    let retried = desk.sweep(&["--retry", "-v", "--save-every", "20"]);
    let lines = String::from_utf8_lossy(&retried.stderr).into_owned();
    assert!(
        retried.status.code() == Some(3) && lines.contains("the others go on"),
        "{lines}"
    );
    assert!(results(&desk.out()) == before);
}

/// A damaged bed of the library is no result of any drag, whoever finds it: what the message says is done, and the same
/// command goes on.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_fault_of_the_machine_is_no_row() {
    let room = crate::FURNISHED.copy();
    let beds = room.files("beds");
    let name = beds
        .keys()
        .find(|name| name.ends_with(".safetensors"))
        .unwrap();
    let mut bytes = beds[name].clone();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    room.write(&format!("beds/{name}"), bytes);
    let name = name.split('/').next().unwrap();
    for words in ["", " --task mu0.3/run-1", " --task mu0.5/run-1"] {
        let command = format!("sweep weecamp.toml --out new{words}");
        let out = room.told(&command);
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(
            out.status.code() == Some(2) && told.contains(&format!("bed remove {name}"))
                || out.status.success(),
            "{told}"
        );
        assert!(!out.status.success() || !words.is_empty(), "{command}");
        let failures = room
            .files("new")
            .into_keys()
            .filter(|name| name.ends_with("failure.json"));
        assert_eq!(failures.collect::<Vec<_>>(), Vec::<String>::new());
    }
    room.done(&format!("bed remove {name}"));
    room.done("sweep weecamp.toml --out new");
    assert!(room.files("new") == crate::FURNISHED.files("camp"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn two_campaigns_never_share_a_folder() {
    let slow = CAMPAIGN.replace("\"bed.settled\" = 1e-2", "\"bed.settled\" = 1e-12");
    let desk = Desk::new(PROGRAM, &slow);
    let mut first = Command::new(PROGRAM)
        .args(["sweep", "camp.toml"])
        .current_dir(desk.folder.path())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !desk.out().join("members/mu0.5/scenario.toml").exists() {
        assert!(first.try_wait().unwrap().is_none(), "it is at work");
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = desk.sweep(&[]);
    let refused = String::from_utf8_lossy(&second.stderr).into_owned();
    assert_eq!(second.status.code(), Some(2), "{refused}");
    assert!(
        refused.contains("another run is at work in it"),
        "{refused}"
    );
    // A member of it is at work too.
    let member = output(
        PROGRAM,
        desk.folder.path(),
        &["run", "--resume", "out/camp/members/mu0.5"],
    );
    let refused = String::from_utf8_lossy(&member.stderr).into_owned();
    assert_eq!(member.status.code(), Some(2), "{refused}");
    first.kill().unwrap();
    first.wait().unwrap();
}

/// One row is done again alone and compared with the whole campaign's; the others can follow.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_row_is_done_alone_and_held_against_a_table() {
    let golden = CAMP.out().join("results.csv");
    let golden = golden.to_str().unwrap();
    let desk = Desk::new(PROGRAM, CAMPAIGN);
    let row = ["--only", "mu0.5/run-2", "--against", golden];
    let out = desk.sweep(&row);
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(said.contains("1 runs agree with"), "{said}");
    assert!(!said.contains("executed again"), "{said}");
    // Once more nothing is executed: what was found is executed again.
    let again = desk.sweep(&row);
    let said = String::from_utf8_lossy(&again.stdout).into_owned();
    assert_eq!(again.status.code(), Some(0), "{said}");
    for told in [
        "1 runs agree with",
        "links 0 were executed by this call",
        "executed again: all",
    ] {
        assert!(said.contains(told), "{said}");
    }
    let again = desk.sweep(&[&row[..], &["--found-is-enough"]].concat());
    let said = String::from_utf8_lossy(&again.stderr).into_owned();
    assert!(
        again.status.code() == Some(3) && said.contains("links 0 were executed"),
        "{said}"
    );
    // Where nothing is compared, nothing is asked for.
    for nothing in [&["--tasks"][..], &["--task", "mu0.5/run-2"]] {
        let out = desk.sweep(&[nothing, &["--against", golden]].concat());
        assert_eq!(out.status.code(), Some(2), "{nothing:?}");
    }
    let table = desk.table();
    assert_eq!((table.len(), table.text(0, "run")), (1, "run-2"));
    let page = std::fs::read_to_string(desk.out().join("report.html")).unwrap();
    // Not all of the member is done, so that it has no report to be linked.
    assert!(page.contains("Runs: 1 of 4 planned") && !page.contains("href=\"members"));
    assert!(!desk.out().join("members/mu0.1/beds").exists());
    // A last digit that differs is reported.
    let text = std::fs::read_to_string(golden).unwrap();
    let drag = table.text(0, "drag");
    let last = drag.chars().last().unwrap();
    let other = if last == '3' { '4' } else { '3' };
    let changed = format!("{}{other}", &drag[..drag.len() - 1]);
    desk.write("changed.csv", &text.replace(drag, &changed));
    let out = desk.sweep(&["--only", "mu0.5/run-2", "--against", "changed.csv"]);
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(3), "{message}");
    let told = format!("mu0.5/run-2: drag is {drag}, and {changed} in changed.csv");
    assert!(message.contains(&told), "{message}");
    desk.done(&["--only", "mu0.5"]);
    assert_eq!(desk.table().len(), 2);
    desk.done(&[]);
    assert!(results(&desk.out()) == *FINISHED);
}

/// Files may grow to this many blocks of 512 bytes: what is done stays, and is continued.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_full_disk_stops_a_campaign_with_what_is_done_intact() {
    let desk = Desk::new(PROGRAM, CAMPAIGN);
    let mut stops = 0;
    for blocks in [8, 80, 160, 200, 230, 260, 300, 500, 4000] {
        let limited = format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" sweep camp.toml --save-every 300"
        );
        let out = output("sh", desk.folder.path(), &["-c", &limited, PROGRAM]);
        let message = String::from_utf8_lossy(&out.stderr).into_owned();
        match out.status.code() {
            Some(0) => break,
            Some(1) => assert!(
                message.contains("then give the same command again"),
                "{message}"
            ),
            other => panic!("{other:?}: {message}"),
        }
        stops += 1;
        let rows = desk.out().join("results.csv");
        if rows.exists() {
            CampaignTable::read(&rows).unwrap();
        }
    }
    assert!(stops >= 3, "{stops}");
    assert!(results(&desk.out()) == *FINISHED);
}

/// Ratios that are kept follow the stiffness, and nothing else.
#[test]
fn rules_hold_what_they_say() {
    let campaign = r#"
name = "stiff"
keep = ["kt/kn", "gamma_n/kn^0.6", "gamma_t/gamma_n", "dt*kn^0.4"]
base = "quick"
[[grid]]
name = "kn"
kn = [2.5e5, 2.5e6]
[[grid]]
name = "damping"
keep = ["gamma_t/gamma_n"]
gamma_n = [400.0]
"#;
    let place = std::path::Path::new("");
    let plan = bitgrain::campaign::plan::parse(campaign, "stiff", &["drag.dt=4e-4".into()], place)
        .unwrap();
    let names: Vec<&str> = plan.members.iter().map(|m| &m.name[..]).collect();
    assert_eq!(names, ["Kn2.5e5", "Kn2.5e6", "gn400"]);
    let law = |k: usize| bitgrain_tests::hertz_history(&plan.members[k].scenario.law);
    let dt = |k: usize| plan.members[k].scenario.drag.dt;
    let quick = bitgrain::scenario::load("quick", &[]).unwrap();
    assert_eq!(law(0), bitgrain_tests::hertz_history(&quick.law));
    assert_eq!(dt(0), 4e-4);
    let [kn, kt, gamma_n, gamma_t, mu] = law(1);
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    near(kn, 2.5e6);
    near(kt / kn, 1.225);
    // 10^0.6 and 10^0.4, to fifteen digits.
    near(gamma_n / law(0)[2], 3.981071705534973);
    near(gamma_t, gamma_n);
    near(dt(0) / dt(1), 2.511_886_431_509_58);
    assert_eq!(mu, 0.5);
    assert_eq!(law(2)[..4], [2.5e5, 3.0625e5, 400.0, 400.0]);
    assert_eq!(dt(2), 4e-4);
}

/// A plan states its cost, and touches nothing.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_dry_run_tells_the_cost() {
    let desk = Desk::new(PROGRAM, CAMPAIGN);
    let out = desk.sweep(&["--dry-run", "--threads", "4"]);
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(out.status.success());
    // 140 grains, 4 of travel at speeds 1 and 2 with steps of 3e-4: 20,000 steps.
    let row = text.lines().find(|line| line.starts_with("mu0.1")).unwrap();
    let words: Vec<&str> = row.split_whitespace().collect();
    assert_eq!((words[1], words[2], words[4]), ("140", "2", "3"), "{text}");
    assert!(
        text.contains("beds to pour                     2"),
        "{text}"
    );
    assert!(
        text.contains("on 4 thread(s), 4 stages at a time"),
        "{text}"
    );
    assert!(!desk.out().exists());
}

/// Distances within which coordination is measured and the drag by travel are columns at the end of a table; the
/// forecast of a folder counts what is done there.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn distances_and_travel_are_columns() {
    let room = Room::new(PROGRAM);
    room.done("sweep weecamp.toml --out camp --set measure.reaches=[1.0,2.0] --only mu0.3");
    let table = CampaignTable::read(&room.path("camp/results.csv")).unwrap();
    let names: Vec<&str> = table.columns().collect();
    let last = ["drag_uncut_error", "large_overlaps", "drag_travel_1"];
    assert_eq!(names[names.len() - 3..], last);
    for row in 0..table.len() {
        let same = |a: &str, b: &str| assert_eq!(table.text(row, a), table.text(row, b), "{a}");
        for name in [
            "coordination",
            "coordination_error",
            "kappa",
            "kappa_error",
            "floating",
        ] {
            let within = match name.strip_suffix("_error") {
                Some(name) => format!("{name}_within_2_error"),
                None => format!("{name}_within_2"),
            };
            same(name, &within);
        }
        // Fewer grains, nearer to the intruder.
        assert_ne!(
            table.text(row, "coordination_within_1"),
            table.text(row, "coordination")
        );
        assert!(table.real(row, "drag_travel_1").unwrap() > 0.0);
        assert!((0.0..=1.0).contains(&table.real(row, "large_overlaps").unwrap()));
    }
    let left = room.done("sweep weecamp.toml --out camp --set measure.reaches=[1.0,2.0] --dry-run");
    assert!(left.contains("2 (2 are done)"), "{left}");
    assert!(room.path("camp/performance.json").exists());
    let told = room.says(
        "sweep weecamp.toml --set measure.reaches=[2.0,1.0] --dry-run",
        2,
    );
    assert!(
        told.contains("expected at most 16 ascending lengths"),
        "{told}"
    );
}
