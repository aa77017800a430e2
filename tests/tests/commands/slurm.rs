//! Job scripts, with programs in the place of Slurm's: what is submitted, when a job goes back into the queue, when it
//! stops, and what is said where there is no Slurm. `tools::slurm` runs them with a real one.
#![cfg(unix)]

use std::fmt::Write;
use std::process::{Command, Output};

use bitgrain_tests::{CAMPAIGN, CampaignDesk, golden, results, told, two_drags};

use crate::{FINISHED, PROGRAM};

type Desk = CampaignDesk;

/// A folder with a campaign and a run, and programs of Slurm's names in `bin`.
fn desk() -> Desk {
    let desk = Desk::new(PROGRAM, CAMPAIGN);
    desk.write("run.toml", &two_drags());
    std::fs::create_dir(desk.folder.path().join("bin")).unwrap();
    // A job's number, and what it was submitted with.
    program(
        &desk,
        "sbatch",
        "echo \"$@\" >> submitted; n=$(wc -l < submitted); echo \"$((100 + n));here\"",
    );
    // The step is asked to stop after as long as the variable says.
    program(
        &desk,
        "srun",
        "shift 2; \"$@\" & child=$!; [ -z \"$STOP\" ] || { sleep \"$STOP\"; kill -TERM $child; }; wait $child",
    );
    program(&desk, "scontrol", "echo \"$@\" >> requeued");
    desk
}

fn program(desk: &Desk, name: &str, text: &str) {
    let path = desk.folder.path().join("bin").join(name);
    std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    std::fs::set_permissions(&path, mode).unwrap();
}

/// A command line in the desk's folder, which finds the programs in `bin`.
fn shell(desk: &Desk, line: &str) -> Output {
    let path = format!("bin:{}", std::env::var("PATH").unwrap_or_default());
    let mut command = Command::new("sh");
    command.args(["-c", line]).env("PATH", path);
    command.current_dir(desk.folder.path()).output().unwrap()
}

fn does(desk: &Desk, line: &str, status: i32) -> String {
    let out = shell(desk, line);
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    let told = told + &String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(status), "{line}: {told}");
    told
}

fn text(desk: &Desk, name: &str) -> String {
    std::fs::read_to_string(desk.folder.path().join(name)).unwrap_or_default()
}

/// A folder that begins as an option does is none of the shell's.
#[test]
fn a_folder_is_no_option() {
    let desk = desk();
    let submit = format!("'{PROGRAM}' run run.toml --out=-c --submit slurm");
    assert_eq!(does(&desk, &submit, 0), "./-c/slurm/1/run.sh: job 101\n");
}

/// Beds, then drags, then the merge; the scripts do the campaign, and what is submitted again is what is missing.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_is_submitted_in_three_parts() {
    let desk = desk();
    let sweep = format!("'{PROGRAM}' sweep camp.toml");
    let submit = format!("{sweep} --submit slurm -- --time=10 --array=%3 --comment 'two words'");
    let told = does(&desk, &submit, 0);
    assert_eq!(
        told,
        "missing: beds 2, drags 4\nout/camp/slurm/1/beds.sh: job 101\nout/camp/slurm/1/drags.sh: job \
         102\nout/camp/slurm/1/merge.sh: job 103\n"
    );
    assert_eq!(
        text(&desk, "submitted"),
        "--parsable --time=10 --comment two words out/camp/slurm/1/beds.sh\n\
         --parsable --time=10 --comment two words --dependency=afterany:101 out/camp/slurm/1/drags.sh\n\
         --parsable --time=10 --comment two words --dependency=afterany:102 out/camp/slurm/1/merge.sh\n"
    );
    let script = text(&desk, "out/camp/slurm/1/drags.sh");
    assert!(script.contains("#SBATCH --array=1-4%3\n"), "{script}");
    assert_eq!(
        text(&desk, "out/camp/slurm/1/drags.txt"),
        "mu0.1/run-1\nmu0.1/run-2\nmu0.5/run-1\nmu0.5/run-2\n"
    );
    let element = |kind: &str, k: u32, status: i32| {
        let line = format!("SLURM_ARRAY_TASK_ID={k} sh out/camp/slurm/1/{kind}.sh");
        does(&desk, &line, status)
    };
    for (kind, count) in [("beds", 2), ("drags", 3)] {
        for k in 1..=count {
            element(kind, k, 0);
        }
    }
    let merged = does(&desk, "sh out/camp/slurm/1/merge.sh", 3);
    assert!(
        merged.contains("1 of 4 rows of out/camp are missing"),
        "{merged}"
    );
    let told = does(&desk, &submit, 0);
    assert!(told.contains("missing: beds 0, drags 1"), "{told}");
    assert!(!told.contains("beds.sh"), "{told}");
    assert_eq!(text(&desk, "out/camp/slurm/2/drags.txt"), "mu0.5/run-2\n");
    does(
        &desk,
        "SLURM_ARRAY_TASK_ID=1 sh out/camp/slurm/2/drags.sh",
        0,
    );
    does(&desk, "sh out/camp/slurm/2/merge.sh", 0);
    let mut files = results(&desk.out());
    files.retain(|name, _| !name.starts_with("slurm/"));
    assert!(files == *FINISHED);
    assert!(does(&desk, &submit, 0).contains("nothing to submit"));
    // The scripts are no part of what is verified.
    does(&desk, &format!("'{PROGRAM}' verify out/camp --sample 1"), 0);
}

/// More tasks than an array may have are several arrays, after all of which the merge comes.
#[test]
fn many_tasks_are_several_arrays() {
    let desk = desk();
    let seeds: Vec<String> = (1..=1001).map(|seed| seed.to_string()).collect();
    let many = CAMPAIGN
        .replace("mu = [0.1, 0.5]", &format!("seed = [{}]", seeds.join(", ")))
        .replace("speed = [1.0, 2.0]", "speed = 1.0");
    desk.write("camp.toml", &many);
    let submit = format!("'{PROGRAM}' sweep camp.toml --submit slurm");
    does(&desk, &submit, 0);
    let submitted = text(&desk, "submitted");
    assert_eq!(
        submitted
            .lines()
            .map(|line| line.trim_start_matches("--parsable "))
            .collect::<Vec<_>>(),
        [
            "out/camp/slurm/1/beds.sh",
            "out/camp/slurm/1/beds-2.sh",
            "--dependency=afterany:101:102 out/camp/slurm/1/drags.sh",
            "--dependency=afterany:101:102 out/camp/slurm/1/drags-2.sh",
            "--dependency=afterany:103:104 out/camp/slurm/1/merge.sh",
        ]
    );
    let second = text(&desk, "out/camp/slurm/1/drags-2.sh");
    assert!(
        second.contains("#SBATCH --array=1-1\n") && second.contains("drags-2.txt"),
        "{second}"
    );
}

/// A run that is asked to stop goes back into the queue as long as it saves something new, and ends with the same
/// bytes.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_goes_back_into_the_queue_while_it_gets_on() {
    let desk = desk();
    let run = format!("'{PROGRAM}' run run.toml --set drag.dt=1e-4");
    does(&desk, &format!("{run} --out alone"), 0);
    does(&desk, "mv beds beds-alone", 0);
    let told = does(
        &desk,
        &format!("{run} --out again --submit slurm -- --time=1"),
        0,
    );
    assert_eq!(told, "again/slurm/1/run.sh: job 101\n");
    // What was submitted is run, whatever becomes of the file.
    desk.write("run.toml", "");
    let job = |stop: &str| {
        shell(
            &desk,
            &format!("STOP={stop} SLURM_JOB_ID=101 sh again/slurm/1/run.sh"),
        )
    };
    let mut stops = 0;
    loop {
        let out = job("0.4");
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        match out.status.code() {
            Some(0) => break,
            Some(130) => stops += 1,
            other => panic!("{other:?}: {told}"),
        }
        assert_eq!(text(&desk, "requeued").lines().count(), stops);
        assert!(stops < 50, "it gets on");
    }
    assert!(stops >= 1);
    assert!(text(&desk, "requeued").starts_with("requeue 101\n"));
    let files = |out: &str| {
        let mut files = results(&desk.folder.path().join(out));
        files.retain(|name, _| !name.starts_with("slurm/"));
        files
    };
    assert!(files("again") == files("alone"));
}

/// A job that fails, or that saves nothing in its time, stops.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_job_without_an_end_stops() {
    let desk = desk();
    let run = format!("'{PROGRAM}' run run.toml --set bed.settled=1e-12 --submit slurm");
    does(&desk, &run, 0);
    // Asked to stop at once, again and again: the program does not come to its first step.
    program(&desk, "srun", "exit 130");
    let job = "SLURM_JOB_ID=101 sh out/small/slurm/1/run.sh";
    let told = does(&desk, job, 3);
    assert!(
        told.contains("out/small: nothing was saved in the time of this job"),
        "{told}"
    );
    for status in [1, 2, 3, 137] {
        program(&desk, "srun", &format!("exit {status}"));
        does(&desk, job, status);
    }
    assert_eq!(text(&desk, "requeued"), "");
}

/// What is said if there is no Slurm, if it refuses, if another scheduler is asked for, and on wrong tasks, for review.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_cannot_be_submitted_is_told() {
    let desk = desk();
    let mut text = String::new();
    let mut says = |name: &str, line: &str| {
        let path = if name == "no Slurm" {
            "PATH=bare; "
        } else {
            ""
        };
        let words = format!("{path}exec '{PROGRAM}' {line}");
        let out = shell(&desk, &words);
        let printed = String::from_utf8_lossy(&out.stdout).replace(PROGRAM, "bitgrain");
        write!(text, "# {name}\n{printed}{}", told(&[line], &out)).unwrap();
    };
    says("another scheduler", "sweep camp.toml --submit pbs");
    says("another scheduler for a run", "run run.toml --submit lsf");
    says(
        "an array of one's own",
        "sweep camp.toml --submit slurm -- --array=1-3",
    );
    says("options without --submit", "sweep camp.toml -- --time=3");
    says("two things at once", "sweep camp.toml --tasks --merge");
    says("no such task", "sweep camp.toml --task mu0.5/run-3");
    says("no such kind of task", "sweep camp.toml --tasks=rows");
    says("only written", "sweep camp.toml --submit slurm --dry-run");
    says(
        "a run, only written",
        "run run.toml --submit slurm --dry-run",
    );
    says("nothing is done yet", "sweep camp.toml --merge");
    // A shell, and nothing else.
    let bare = desk.folder.path().join("bare");
    std::fs::create_dir(&bare).unwrap();
    std::os::unix::fs::symlink("/bin/sh", bare.join("sh")).unwrap();
    says("no Slurm", "sweep camp.toml --submit slurm");
    program(
        &desk,
        "sbatch",
        "echo 'sbatch: error: Batch job submission failed' >&2; exit 1",
    );
    says(
        "a refusal",
        "sweep camp.toml --submit slurm -- --partition=none",
    );
    let changed = CAMPAIGN.replace("mu = [0.1, 0.5]", "mu = [0.1, 0.4]");
    desk.write("camp.toml", &changed);
    says("changed since", "sweep camp.toml --task mu0.4/run-1");
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("slurm", text));
}
