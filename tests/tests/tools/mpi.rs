//! Runs on ranks that MPI joins: the files are those of one process, whatever happens to the ranks.
//!
//! `.ci/run ranks` builds the programs with the feature `mpi` into `target/ranks`. `RANKS=all` asks for more ways to
//! share the work. The ranks are more than the cores of a small machine. Letters are counted into `golden/ranks.csv`.

mod letters;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use bitgrain::random::{Purpose, uniforms};
use bitgrain_tests::processes::{MPI_AS_ROOT, Process, processes, signal};
use bitgrain_tests::{CAMPAIGN, RIG, SMALL, differing, output, results, root, two_drags};

/// The command without MPI.
const PLAIN: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

type Files = BTreeMap<String, Vec<u8>>;

/// A program that was built with the feature `mpi`.
fn built(name: &str) -> PathBuf {
    let path = root().join("target/ranks/release").join(name);
    assert!(path.exists(), "{} is built by .ci/run", path.display());
    path
}

/// A folder with scenarios in it.
fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let rig = RIG.replace("distance = 0.012", "distance = 0.006");
    write("rig.toml", &rig.replace("every = 100", "every = 40"));
    write("cylinder.toml", &cylinder());
    write("small.toml", SMALL);
    write("two.toml", &two_drags().replace("\"small\"", "\"two\""));
    write("camp.toml", CAMPAIGN);
    folder
}

/// The rig without a lid, through whose bed the cylinder goes itself, with fields and snapshots.
fn cylinder() -> String {
    let lid = RIG.find("[lid]").unwrap()..RIG.find("[drag]").unwrap();
    let mut text = RIG.to_string();
    text.replace_range(lid, "");
    let text = text.replace("moves = \"bed\"", "moves = \"intruder\"");
    let text = text.replace("\"rig\"", "\"cylinder\"") + "snapshots = 2\n";
    text + "\n[measure.fields]\nevery = 20\n"
}

/// Some ranks with some threads each.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    ranks: usize,
    threads: usize,
}

fn ways() -> Vec<Way> {
    let way = |ranks, threads| Way { ranks, threads };
    if std::env::var("RANKS").is_ok_and(|asked| asked == "all") {
        let ranks = [1, 2, 4, 8, 16].into_iter();
        return ranks
            .flat_map(|ranks| [way(ranks, 1), way(ranks, 2)])
            .collect();
    }
    vec![way(1, 2), way(2, 1), way(3, 1), way(8, 1)]
}

/// `mpirun`, for so many ranks that each has a part of a small bed.
fn mpirun(folder: &Path, ranks: usize) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--oversubscribe", "-n", &ranks.to_string()]);
    command.current_dir(folder);
    command.envs(MPI_AS_ROOT);
    command.env("BITGRAIN_PART_MIN", "30");
    command
}

/// The command in a way.
fn shared(folder: &Path, way: Way, line: &str) -> Command {
    let mut command = mpirun(folder, way.ranks);
    command.arg(built("bitgrain-under-test"));
    command.args(line.split_whitespace());
    command.args(["--threads", &way.threads.to_string()]);
    command
}

fn told(out: &Output) -> String {
    let [out, err] = [&out.stdout, &out.stderr].map(|text| String::from_utf8_lossy(text));
    format!("{out}{err}")
}

/// Runs it to its end, which must be a good one.
fn done(mut command: Command) -> String {
    let out = command.output().expect("mpirun starts");
    assert!(out.status.success(), "{command:?}: {}", told(&out));
    told(&out)
}

fn plain(folder: &Path, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let out = output(PLAIN, folder, &words);
    assert!(out.status.success(), "{line}: {}", told(&out));
}

/// The files that one process without MPI leaves.
fn alone(folder: &Path, line: &str) -> Files {
    plain(folder, &format!("{line} --threads 1 --beds beds --out one"));
    results(&folder.join("one"))
}

/// Pouring, settling, lids, fields, snapshots, and a campaign: every file, and a process alone verifies it.
#[test]
#[ignore = "needs Open MPI: `.ci/run ranks`"]
fn any_number_of_ranks_writes_the_bytes_of_one_process() {
    let desk = desk();
    let folder = desk.path();
    let lines = [
        "run quick",
        "run rig.toml",
        "run cylinder.toml",
        "sweep camp.toml",
    ];
    for line in lines {
        let one = alone(folder, line);
        assert!(one.len() > 5, "{line}");
        for way in ways() {
            let began = Instant::now();
            done(shared(
                folder,
                way,
                &format!("{line} --beds fresh --out many"),
            ));
            let many = results(&folder.join("many"));
            let wrong = differing(&one, &many);
            assert!(wrong.is_empty(), "{line}, {way:?}: {wrong:?}");
            println!("{line}, {way:?}: {:.1} s", began.elapsed().as_secs_f64());
            if way == *ways().last().unwrap() {
                plain(folder, "verify many --sample 1");
            }
            fs::remove_dir_all(folder.join("fresh")).unwrap();
            fs::remove_dir_all(folder.join("many")).unwrap();
        }
        fs::remove_dir_all(folder.join("one")).unwrap();
    }
}

/// A host's bed, into which grains come and which they leave.
#[test]
#[ignore = "needs Open MPI: `.ci/run ranks`"]
fn a_bed_with_insertion_and_removal_is_that_of_one_process() {
    let desk = desk();
    let folder = desk.path();
    let mut alone = Command::new(built("edited"));
    alone.args(["1", "one"]).current_dir(folder);
    let expected = done(alone);
    let file = fs::read(folder.join("one")).unwrap();
    assert_eq!(expected.lines().count(), 6, "{expected}");
    for way in ways() {
        let mut command = mpirun(folder, way.ranks);
        command.arg(built("edited"));
        command.args([&way.threads.to_string(), "many"]);
        // What is printed after that is the memory of each rank.
        assert!(done(command).starts_with(&expected), "{way:?}");
        assert!(fs::read(folder.join("many")).unwrap() == file, "{way:?}");
    }
}

/// The processes that are ranks in a folder, in order.
fn ranks_of(folder: &Path) -> Vec<u32> {
    let rank = |process: &Process| {
        let words = &mut process.environment.iter();
        words.find_map(|word| {
            let rank = word.strip_prefix("OMPI_COMM_WORLD_RANK=")?;
            rank.parse::<u32>().ok()
        })
    };
    let here = processes().into_iter();
    let here = here.filter(|process| process.folder == folder);
    let mut found: Vec<_> = here
        .filter_map(|process| Some((rank(&process)?, process.id)))
        .collect();
    found.sort_unstable();
    found.into_iter().map(|(_, id)| id).collect()
}

fn begin(mut command: Command) -> Child {
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("mpirun starts")
}

/// Any rank may be killed at any time: whatever number of ranks, or a process alone, goes on from what was saved.
#[test]
#[ignore = "needs Open MPI: `.ci/run ranks`"]
fn killed_ranks_lose_nothing() {
    let desk = desk();
    let folder = &desk.path().canonicalize().unwrap();
    let one = alone(folder, "run two.toml");
    let (mut kills, mut attempt, mut rounds) = (0, 0, 0);
    while kills < 30 {
        rounds += 1;
        let (mut killed, mut ended) = (0, false);
        while !ended {
            attempt += 1;
            let draws: [f64; 4] = uniforms(11, Purpose::Sample, attempt);
            let below = |k: usize, most: usize| (draws[k] * most as f64) as usize;
            let way = Way {
                ranks: 2 + below(0, 3),
                threads: 1 + below(1, 2),
            };
            let line = match folder.join("many/scenario.toml").exists() {
                true => "run --resume many --save-every 20",
                false => "run two.toml --beds fresh --out many --save-every 20",
            };
            if killed == 8 {
                // What many ranks began one process ends.
                plain(folder, &format!("{line} --threads 1"));
                break;
            }
            let mut child = begin(shared(folder, way, line));
            let wait = Duration::from_millis(400 + below(2, 1600) as u64);
            let began = Instant::now();
            while began.elapsed() < wait && child.try_wait().unwrap().is_none() {
                sleep(Duration::from_millis(5));
            }
            let ranks = ranks_of(folder);
            if let Some(victim) = ranks.get(below(3, ranks.len().max(1))) {
                signal(*victim, "9");
            }
            ended = child.wait_with_output().unwrap().status.success();
            killed += usize::from(!ended);
        }
        kills += killed;
        let wrong = differing(&one, &results(&folder.join("many")));
        assert!(wrong.is_empty(), "{wrong:?}");
        plain(folder, "verify many --sample 1");
        fs::remove_dir_all(folder.join("fresh")).unwrap();
        fs::remove_dir_all(folder.join("many")).unwrap();
    }
    println!("{kills} ranks killed in {rounds} runs");
}

/// A rank that stands still for a minute costs a minute; one that is waited for too long is named.
#[test]
#[ignore = "needs Open MPI, and takes more than a minute: `.ci/run ranks`"]
fn a_rank_that_stands_still() {
    let desk = desk();
    let folder = &desk.path().canonicalize().unwrap();
    let one = alone(folder, "run two.toml");
    let two = Way {
        ranks: 2,
        threads: 1,
    };
    let stop = |command: Command| {
        let child = begin(command);
        let began = Instant::now();
        while !folder.join("many/runs/run-1").exists() {
            assert!(began.elapsed() < Duration::from_secs(60), "it begins");
            sleep(Duration::from_millis(20));
        }
        let stopped = ranks_of(folder)[1];
        signal(stopped, "STOP");
        (child, stopped)
    };
    let line = "run two.toml --beds fresh --out many";
    let mut hasty = shared(folder, two, line);
    hasty.env("BITGRAIN_PATIENCE", "2");
    let (child, _) = stop(hasty);
    let out = child.wait_with_output().unwrap();
    let said = told(&out);
    assert_eq!(out.status.code(), Some(3), "{said}");
    assert_eq!(
        said.matches("rank 1 did not answer for").count(),
        1,
        "{said}"
    );
    fs::remove_dir_all(folder.join("many")).unwrap();
    let (mut child, stopped) = stop(shared(folder, two, line));
    sleep(Duration::from_secs(60));
    assert!(child.try_wait().unwrap().is_none(), "it waits");
    signal(stopped, "CONT");
    let out = child.wait_with_output().unwrap();
    assert!(out.status.success(), "{}", told(&out));
    let wrong = differing(&one, &results(&folder.join("many")));
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Ranks that are not alike are named once, before anything is done; and a build without MPI does nothing twice.
#[test]
#[ignore = "needs Open MPI and gcc: `.ci/run ranks`"]
fn ranks_that_are_not_alike_are_named() {
    let desk = desk();
    let folder = desk.path();
    let program = built("bitgrain-under-test");
    let other = folder.join("other");
    let mut bytes = fs::read(&program).unwrap();
    bytes.push(0);
    fs::write(&other, bytes).unwrap();
    fs::set_permissions(&other, fs::metadata(&program).unwrap().permissions()).unwrap();
    // A library that, when it is loaded, has the processor take numbers near zero for zero.
    let library = folder.join("fast.so");
    let source = folder.join("fast.c");
    fs::write(&source, "").unwrap();
    let mut gcc = Command::new("gcc");
    gcc.args(["-shared", "-ffast-math", "-o"])
        .arg(&library)
        .arg(&source);
    done(gcc);
    let run = ["run", "two.toml"];
    let preload = format!("LD_PRELOAD={}", library.display());
    let cases = [
        (vec![], other.as_path(), run, "rank 1 was built otherwise"),
        (
            vec![],
            &program,
            ["run", "rig.toml"],
            "rank 1 was called with other arguments",
        ),
        (
            vec!["-x", &preload],
            &program,
            run,
            "rank 1 does not compute by the bit contract",
        ),
    ];
    for (options, second, words, problem) in cases {
        let mut command = mpirun(folder, 1);
        command.arg(&program).args(run);
        command
            .args([":", "-n", "1"])
            .args(options)
            .arg(second)
            .args(words);
        let out = command.output().unwrap();
        let said = told(&out);
        assert_eq!(out.status.code(), Some(3), "{said}");
        assert_eq!(said.matches(problem).count(), 1, "{said}");
        assert!(!folder.join("out").exists(), "{problem}");
    }
    let mut command = mpirun(folder, 2);
    command.arg(PLAIN).args(run);
    let out = command.output().unwrap();
    let said = told(&out);
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("this build knows no MPI"), "{said}");
    assert!(!folder.join("out").exists());
}
