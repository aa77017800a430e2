//! Campaigns in pieces: many processes on one folder, whatever becomes of them, end with the table of one.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use bitgrain_tests::{CAMPAIGN, CampaignDesk, RIG, differing, failing_campaign, output, results};

use crate::{FINISHED, PROGRAM};

type Desk = CampaignDesk;

/// A campaign as one process leaves it.
fn alone(campaign: &str) -> BTreeMap<String, Vec<u8>> {
    let desk = Desk::new(PROGRAM, campaign);
    desk.sweep(&[]);
    results(&desk.out())
}

/// What `--tasks` prints, a line each.
fn lines(desk: &Desk, more: &[&str]) -> Vec<String> {
    let out = desk.sweep(&[&["--tasks"], more].concat());
    assert!(out.status.success());
    let text = String::from_utf8(out.stdout).unwrap();
    text.lines().map(String::from).collect()
}

/// Begins a command line.
fn begin(desk: &Desk, line: &str) -> Child {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("exec {line}")]);
    command.current_dir(desk.folder.path());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Runs one, and returns what it printed if it ends with this status.
fn does(desk: &Desk, line: &str, status: i32) -> String {
    let out = output("sh", desk.folder.path(), &["-c", line]);
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    let told = told + &String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(status), "{line}: {told}");
    told
}

fn until(what: &str, done: impl Fn() -> bool) {
    let began = Instant::now();
    while !done() {
        assert!(began.elapsed() < Duration::from_secs(120), "{what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn same(desk: &Desk, want: &BTreeMap<String, Vec<u8>>) {
    let wrong = differing(&results(&desk.out()), want);
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn lines_make_the_bytes_of_one_process_in_any_shell() {
    let want = &*FINISHED;
    // One after the other; two at a time; and all at once, so that drags wait for beds.
    for shell in [
        "sh",
        "tr '\\n' '\\0' | xargs -0 -P 2 -I{} sh -c '{}'",
        "tr '\\n' '\\0' | xargs -0 -P 6 -I{} sh -c '{}'",
    ] {
        let desk = Desk::new(PROGRAM, CAMPAIGN);
        let list = lines(&desk, &[]);
        let ends: Vec<&str> = list
            .iter()
            .map(|line| line.split(" --task ").nth(1).unwrap())
            .collect();
        assert_eq!(
            ends,
            [
                "mu0.1/bed",
                "mu0.5/bed",
                "mu0.1/run-1",
                "mu0.1/run-2",
                "mu0.5/run-1",
                "mu0.5/run-2"
            ]
            .map(|task| format!("{task} --threads 1"))
        );
        assert!(!desk.out().exists(), "to list is to write nothing");
        desk.write("lines", &(list.join("\n") + "\n"));
        does(&desk, &format!("{shell} < lines"), 0);
        assert!(lines(&desk, &[]).is_empty(), "{shell}: all is done");
        assert!(!desk.out().join("results.csv").exists());
        desk.done(&["--merge"]);
        same(&desk, want);
        // What is merged stays so, by any command.
        desk.done(&["--merge"]);
        desk.done(&[]);
        same(&desk, want);
        assert!(!desk.out().join("tasks").exists());
    }
}

/// Programs between the list and a shell may take quotes away, and no path is an option.
#[test]
fn lines_execute_nothing_but_the_program() {
    let desk = Desk::new(PROGRAM, CAMPAIGN);
    for out in [
        "$(touch x)",
        "a;touch x",
        "a&touch x",
        "`touch x`",
        "a|touch x",
        "a>x",
        "a #b",
        "~/a",
        "a*",
        "a?",
        "[ab]",
        "{a,b}",
        "!a",
        "a\\b",
        "a\"b",
        "a'b'",
    ] {
        let told = desk.sweep(&["--tasks", "--out", out]);
        let text = String::from_utf8_lossy(&told.stderr).into_owned();
        assert_eq!(told.status.code(), Some(2), "{out}: {text}");
        assert!(told.stdout.is_empty() && text.contains("--tasks"), "{text}");
    }
    let list = lines(&desk, &["--out=-x", "--beds=-y"]);
    assert!(list[0].contains(" --out ./-x --beds ./-y "), "{}", list[0]);
    desk.write("camp.toml", &CAMPAIGN.replace("\"friction\"", "\"-x\""));
    let told = desk.sweep(&["--tasks"]);
    let text = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(
        told.status.code() == Some(2) && text.contains("grid.name"),
        "{text}"
    );
}

/// In two stages nobody waits; a plain sweep does what workers have left.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn stages_and_what_is_left_can_be_done_apart() {
    let want = &*FINISHED;
    let desk = Desk::new(PROGRAM, CAMPAIGN);
    let of = |kind: &str, more: &[&str]| {
        let kind = format!("--tasks={kind}");
        let out = desk.sweep(&[&[&kind[..]], more].concat());
        String::from_utf8(out.stdout)
            .unwrap()
            .lines()
            .map(String::from)
            .collect::<Vec<_>>()
    };
    let (beds, drags) = (of("beds", &[]), of("drags", &[]));
    assert_eq!((beds.len(), drags.len()), (2, 4));
    assert_eq!(of("all", &["--only", "mu0.5/run-2"]).len(), 2);
    for line in &beds {
        does(&desk, line, 0);
        assert!(does(&desk, line, 0).contains("/bed: done before"));
    }
    assert!(of("beds", &[]).is_empty());
    does(&desk, &drags[1], 0);
    assert!(does(&desk, &drags[1], 0).contains("mu0.1/run-2: done before"));
    // The table has the rows that there are, and the others are named with their commands.
    let out = desk.sweep(&["--merge"]);
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(out.status.code(), Some(3));
    let rest = [&drags[0], &drags[2], &drags[3]].map(|line| format!("{line}\n"));
    assert_eq!(told, rest.concat());
    assert_eq!(desk.table().len(), 1);
    does(&desk, &drags[3], 0);
    desk.done(&[]);
    same(&desk, want);
}

/// Of beds under lids those below are listed first, each once.
#[test]
fn beds_below_lids_come_first() {
    let campaign = CAMPAIGN
        .replace("small.toml", "rig.toml")
        .replace("\"bed.settled\" = 1e-2, ", "")
        .replace("speed = [1.0, 2.0]", "speed = 0.1");
    let desk = Desk::new(PROGRAM, &campaign);
    desk.write("rig.toml", RIG);
    let list = lines(&desk, &[]);
    let tasks: Vec<&str> = list
        .iter()
        .map(|line| {
            line.split(' ')
                .skip_while(|word| *word != "--task")
                .nth(1)
                .unwrap()
        })
        .collect();
    assert_eq!(tasks[..2], ["mu0.1/bed-1", "mu0.5/bed-1"]);
    assert_eq!(tasks.len(), 16);
    for (k, task) in tasks.iter().enumerate() {
        assert_eq!(task.contains("-run-"), k >= 8, "{tasks:?}");
    }
}

/// All tasks at once; one process is killed at its drag, which alone is missing, and is gone on with.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_worker_that_dies_costs_its_row() {
    let longer = CAMPAIGN.replace("speed = [1.0, 2.0]", "speed = [0.3, 2.0]");
    let want = &alone(&longer);
    let desk = Desk::new(PROGRAM, &longer);
    let list = lines(&desk, &["--save-every", "500"]);
    let victim = list
        .iter()
        .position(|line| line.contains("mu0.5/run-1 "))
        .unwrap();
    let mut children: Vec<Child> = list.iter().map(|line| begin(&desk, line)).collect();
    let own = desk.out().join("tasks/mu0.5/run-1");
    until("the drag is saved", || {
        own.join("runs/run-1/latest.safetensors").exists()
    });
    children[victim].kill().unwrap();
    for (k, mut child) in children.into_iter().enumerate() {
        let status = child.wait().unwrap();
        assert_eq!(status.success(), k != victim, "{}", list[k]);
    }
    let out = desk.sweep(&["--save-every", "500", "--merge"]);
    assert_eq!(out.status.code(), Some(3));
    assert_eq!(
        String::from_utf8_lossy(&out.stdout),
        format!("{}\n", list[victim])
    );
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(
        message.contains("1 of 4 rows of out/camp are missing"),
        "{message}"
    );
    assert_eq!(desk.table().len(), 3);
    let told = does(&desk, &format!("{} -v", list[victim]), 0);
    assert!(told.contains("resumed"), "{told}");
    desk.done(&["--merge"]);
    same(&desk, want);
}

/// Workers are killed at many instants, merges too; the same commands end with the same bytes.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn workers_and_merges_are_killed_at_any_instant() {
    let want = &*FINISHED;
    let desk = Desk::new(PROGRAM, CAMPAIGN);
    let mut kills = 0;
    for wait in [5, 20, 40, 10, 60, 80, 15, 50, 30, 100] {
        let mut children: Vec<Child> = Vec::new();
        for line in lines(&desk, &["--save-every", "500"]) {
            children.push(begin(&desk, &line));
        }
        std::thread::sleep(Duration::from_millis(wait));
        // Some end, some are killed; a merge may be at work among them.
        let program = format!("'{PROGRAM}' sweep camp.toml --merge");
        let mut merge = begin(&desk, &program);
        std::thread::sleep(Duration::from_millis(wait / 10));
        for child in children.iter_mut().chain([&mut merge]) {
            kills += usize::from(child.try_wait().unwrap().is_none());
            let _ = child.kill();
            child.wait().unwrap();
        }
    }
    assert!(kills >= 5, "{kills} kills");
    for line in lines(&desk, &[]) {
        does(&desk, &line, 0);
    }
    desk.done(&["--merge"]);
    same(&desk, want);
}

/// Two workers at one task: the second ends at once; so does another command that would do it.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_task_that_is_taken_is_left_alone() {
    let slow = CAMPAIGN.replace("\"bed.settled\" = 1e-2", "\"bed.settled\" = 1e-12");
    let desk = Desk::new(PROGRAM, &slow);
    let list = lines(&desk, &[]);
    let mut first = begin(&desk, &list[0]);
    let own = desk.out().join("tasks/mu0.1/bed/manifest.json");
    until("it is at work", || own.exists());
    let told = does(&desk, &list[0], 0);
    assert!(
        told.contains("mu0.1/bed: another worker is at it"),
        "{told}"
    );
    let out = desk.sweep(&[]);
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(2), "{message}");
    assert!(
        message.contains("workers are at tasks of it (mu0.1/bed)"),
        "{message}"
    );
    // A drag of that bed waits; a signal ends the waiting.
    let drag = list
        .iter()
        .find(|line| line.contains("mu0.1/run-1"))
        .unwrap();
    let mut waits = begin(&desk, &format!("{drag} -v"));
    std::thread::sleep(Duration::from_millis(300));
    assert!(waits.try_wait().unwrap().is_none());
    let term = format!("kill -TERM {}", waits.id());
    Command::new("sh").args(["-c", &term]).status().unwrap();
    let out = waits.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(130), "{message}");
    assert!(
        message.contains("another worker pours mu0.1/bed"),
        "{message}"
    );
    first.kill().unwrap();
    first.wait().unwrap();
}

/// What fails has its row as in one process, and is tried again only if that is asked for.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_fails_has_its_row() {
    let wrong = failing_campaign();
    let want = &alone(&wrong);
    let desk = Desk::new(PROGRAM, &wrong);
    let list = lines(&desk, &[]);
    for line in &list {
        let fails = ["mu0.5/run-2", "mu0.4/"]
            .iter()
            .any(|task| line.contains(task));
        let told = does(&desk, line, if fails { 3 } else { 0 });
        assert_eq!(told.contains("its row will say so"), fails, "{told}");
    }
    assert!(lines(&desk, &[]).is_empty());
    assert_eq!(lines(&desk, &["--retry"]).len(), 3);
    let out = desk.sweep(&["--merge"]);
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(3), "{message}");
    assert!(message.contains("2 of 3 runs failed"), "{message}");
    same(&desk, want);
    let again = lines(&desk, &["--retry"]);
    assert!(
        again.iter().all(|line| line.contains(" --retry --task ")),
        "{again:?}"
    );
    for line in &again {
        does(&desk, line, 3);
    }
    assert_eq!(desk.sweep(&["--merge"]).status.code(), Some(3));
    same(&desk, want);
}

/// Spoils a file.
type Spoil<'a> = &'a dyn Fn(&Path);

fn flip(path: &Path) {
    let mut bytes = std::fs::read(path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(path, bytes).unwrap();
}

/// A row whose files are not as its manifest says, or whose manifest is damaged or missing, is not believed: it is
/// named, and its command makes it again.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_merge_believes_manifests_alone() {
    let want = &*FINISHED;
    let made = Desk::new(PROGRAM, CAMPAIGN);
    for line in lines(&made, &[]) {
        does(&made, &line, 0);
    }
    let text = std::fs::read_to_string(made.out().join("tasks/mu0.1/run-1/manifest.json")).unwrap();
    let spoils: [(&str, Spoil); 5] = [
        ("runs/run-1/summary.json", &flip),
        ("beds/bed.safetensors", &flip),
        ("manifest.json", &flip),
        ("runs/run-1/forces.csv", &|path| {
            std::fs::remove_file(path).unwrap()
        }),
        ("manifest.json", &|path| {
            std::fs::write(path, &text).unwrap()
        }),
    ];
    for (name, spoil) in spoils {
        let desk = Desk::new(PROGRAM, CAMPAIGN);
        bitgrain_tests::wee::copy_all(made.folder.path(), desk.folder.path());
        spoil(
            &desk
                .out()
                .join("tasks/mu0.1/run-2")
                .join(name.replace("run-1", "run-2")),
        );
        let out = desk.sweep(&["--merge"]);
        let message = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(3), "{name}: {message}");
        assert!(
            message.contains("1 of 4 rows of out/camp are missing"),
            "{name}: {message}"
        );
        let printed = String::from_utf8_lossy(&out.stdout).into_owned();
        assert!(printed.contains("--task mu0.1/run-2"), "{name}: {printed}");
        assert_eq!(desk.table().len(), 3, "{name}");
        if std::fs::read(desk.out().join("tasks/mu0.1/run-2/manifest.json")).unwrap()
            == text.as_bytes()
        {
            // By that manifest these files are of others.
            assert!(does(&desk, &printed, 2).contains("has no entry of it"));
            std::fs::remove_dir_all(desk.out().join("tasks/mu0.1/run-2/runs")).unwrap();
        }
        does(&desk, &printed, 0);
        desk.done(&["--merge"]);
        same(&desk, want);
    }
}
