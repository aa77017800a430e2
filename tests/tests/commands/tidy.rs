//! A test that reads the repository: what the kernel may not call, how long files and functions may
//! be, that every golden has a recipe and a test, and every law its source.

use std::collections::BTreeSet;

use bitgrain_tests::root;

/// Files below a folder of the repository with this ending, by their names from its root.
fn files(folder: &str, ending: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut open = vec![root().join(folder)];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            let name = path
                .strip_prefix(root())
                .unwrap()
                .to_str()
                .unwrap()
                .replace('\\', "/");
            let made = ["target", "corpus", "artifacts", "coverage"];
            let kept = !made.iter().any(|m| path.ends_with(m));
            if path.is_dir() && kept {
                open.push(path);
            } else if path.is_file() && name.ends_with(ending) && !name.ends_with(".snap.new") {
                found.push(name);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "no {ending} in {folder}");
    found
}

fn text(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap()
}

/// Sources of the harness' crates.
fn harness() -> Vec<String> {
    let crates = ["sim", "lab", "analysis"].map(|name| format!("harness/{name}/src"));
    let folders = crates.iter().map(String::as_str).chain(["harness/src"]);
    folders.flat_map(|folder| files(folder, ".rs")).collect()
}

fn sources() -> Vec<String> {
    let folders = ["kernel", "harness", "tests", "fuzz"];
    folders
        .iter()
        .flat_map(|folder| files(folder, ".rs"))
        .collect()
}

/// A source without its tests and without comments.
fn code(name: &str) -> String {
    let text = text(name);
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    let lines = code
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""));
    lines.collect::<Vec<_>>().join("\n")
}

/// Calls whose bits depend on the platform, the compiler or the order of arguments, in the files that a
/// step runs through. Whole numbers may be compared where floats may not: in the search and the lists.
#[test]
fn a_step_calls_nothing_that_could_change_its_bits() {
    let always = [
        "mul_add",
        "powf",
        "powi",
        ".exp(",
        ".exp2(",
        ".ln(",
        ".log",
        ".sin(",
        ".cos(",
        ".tan(",
        "atan2",
        "acos",
        "asin",
        "hypot",
        "cbrt",
        "rem_euclid",
        "div_euclid",
        ".recip(",
        "fadd_fast",
        "algebraic_",
        "to_radians",
        "to_degrees",
        ".sum::<R",
        ".product",
        "HashMap",
        "HashSet",
        "Instant",
        "unsafe {",
        "alloc::",
        "std::vec",
        "Box<",
        "println",
    ];
    let floats = [
        ".min(", ".max(", ".clamp(", ".abs(", ".signum(", ".fract(", ".floor(", ".round(",
    ];
    let whole = [
        "cell_list.rs",
        "grid.rs",
        "pair_list.rs",
        "digest/state.rs",
        "store.rs",
    ];
    let mut read = 0;
    for name in files("kernel/src", ".rs") {
        let code = code(&name);
        let counts = whole.iter().any(|file| name.ends_with(file));
        let banned = always
            .iter()
            .chain(if counts { &[][..] } else { &floats[..] });
        for call in banned {
            assert!(!code.contains(call), "{name} calls {call}");
        }
        read += 1;
    }
    assert!(read > 15);
    // Where the two square roots meet, and what is worked out before a world is made or between steps: constructors of
    // laws, the scales of a number type, the velocities of a drive, the times that a step must resolve.
    for name in files("kernel/src", ".rs") {
        let code = code(&name);
        let mut known = "math/real.rs math/scaling.rs state/drive.rs time_step.rs".split(' ');
        let known = known.any(|file| name == format!("kernel/src/{file}"));
        let law = name.starts_with("kernel/src/contact/") && code.contains(" Law<R> for ");
        if !known && !law {
            assert!(!code.contains("libm::"), "{name}");
        }
        if let Some((_, step)) = code.split_once(" Law<R> for ") {
            assert!(!step.contains("libm::"), "{name}");
        }
    }
    // Whatever the harness computes with powers and logarithms, it computes everywhere alike.
    for name in harness() {
        let code = code(&name);
        for call in [
            ".powf(", ".powi(", ".exp(", ".ln(", ".log10(", ".log2(", ".sin(", ".cos(", ".tan(",
            ".acos(", ".asin(", ".atan2(", ".cbrt(", ".hypot(", "mul_add",
        ] {
            assert!(
                !code.contains(call),
                "{name} calls {call}: take it from libm"
            );
        }
    }
}

/// Code that makes results does not use what must not reach a result file: maps in the order of a
/// hash, the clock, names of machine, user and place, how many threads there are.
#[test]
fn nothing_of_the_machine_can_reach_a_result() {
    let words = [
        "HashMap",
        "HashSet",
        "Instant",
        "SystemTime",
        "env::var",
        "hostname",
        "current_dir",
        "available_parallelism",
        "current_num_threads",
        "process::id",
        "RandomState",
        "thread_rng",
    ];
    // Speeds and progress, and the skin, which changes no bit; names of files half written; threads; a
    // map of one entry, as safetensors takes it.
    let allowed = [
        ("bench.rs", "Instant"),
        ("forecast.rs", "Instant"),
        ("pace.rs", "Instant"),
        ("progress.rs", "Instant"),
        ("run/mod.rs", "Instant"),
        ("skin.rs", "Instant"),
        ("stepping.rs", "Instant"),
        ("parts/part.rs", "Instant"),
        // Whether a launcher of MPI programs started the process, and how long a silent one is waited for.
        ("ranks/mod.rs", "env::var"),
        ("ranks/joined.rs", "env::var"),
        ("ranks/joined.rs", "Instant"),
        ("parts/ranks.rs", "Instant"),
        ("disk.rs", "process::id"),
        // What the processes of a command that is asked are known by.
        ("recording/command.rs", "process::id"),
        ("threads.rs", "current_num_threads"),
        ("threads.rs", "available_parallelism"),
        // Which pieces of a run are verified, if no seed is given.
        ("cli/checks.rs", "SystemTime"),
        ("cli/channels.rs", "Instant"),
        ("run/saving.rs", "Instant"),
        ("checkpoint.rs", "HashMap"),
    ];
    for name in harness() {
        let code = code(&name);
        for word in words.iter().filter(|word| code.contains(**word)) {
            let may = allowed
                .iter()
                .any(|(file, what)| name.ends_with(file) && what == word);
            assert!(may, "{name} has {word}");
        }
    }
}

#[test]
fn files_lines_and_functions_keep_their_sizes() {
    let mut long = Vec::new();
    for name in sources() {
        let text = text(&name);
        let most = 460;
        if text.lines().count() > most {
            long.push(format!(
                "{name}: {} lines, at most {most}",
                text.lines().count()
            ));
        }
        let mut begin = None;
        for (k, line) in text.lines().enumerate() {
            if line.chars().count() > 120 {
                long.push(format!(
                    "{name}:{}: a line of {}",
                    k + 1,
                    line.chars().count()
                ));
            }
            let indent = line.len() - line.trim_start().len();
            let head = line
                .trim_start()
                .trim_start_matches("pub ")
                .trim_start_matches("(super) ");
            if head.starts_with("fn ") && !line.ends_with(';') && !line.ends_with('}') {
                begin = Some((k, indent));
            }
            if let Some((from, at)) = begin
                && line.trim() == "}"
                && indent == at
            {
                if k - from > 90 {
                    long.push(format!(
                        "{name}:{}: a function of {} lines",
                        from + 1,
                        k - from
                    ));
                }
                begin = None;
            }
            for left in [
                "todo!",
                "unimplemented!",
                "dbg!",
                concat!("FIX", "ME"),
                concat!("XX", "X"),
            ] {
                let quoted = name.ends_with("tidy.rs");
                assert!(quoted || !line.contains(left), "{name}:{}: {left}", k + 1);
            }
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}

/// The file of a test module, whichever binary it is in.
fn test_of(module: &str) -> String {
    let binaries = ["commands", "physics", "alone", "tools"];
    let mut places = binaries
        .map(|binary| format!("tests/tests/{binary}/{module}.rs"))
        .into_iter();
    let place = places.find(|place| root().join(place).exists());
    place.unwrap_or_else(|| panic!("no test is called {module}"))
}

/// `golden/README.md` has a row for every golden: what, recipe, test. The test is there and reads it.
#[test]
fn every_golden_has_a_recipe_and_a_test() {
    let table = text("golden/README.md");
    let rows: Vec<Vec<&str>> = table
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| {
            line.split('|')
                .map(|cell| cell.trim().trim_matches('`'))
                .collect()
        })
        .collect();
    let listed: BTreeSet<String> = rows
        .iter()
        .map(|row| format!("golden/{}", row[1]))
        .collect();
    let mut there: BTreeSet<String> = files("golden", "").into_iter().collect();
    assert!(there.remove("golden/README.md"));
    assert_eq!(listed, there);
    let sizes = there
        .iter()
        .map(|name| std::fs::metadata(root().join(name)).unwrap().len());
    let sizes: Vec<u64> = sizes.collect();
    // What every clone carries: no golden beyond 5 MB (the state of a flowing rig), 40 MB together.
    assert!(sizes.iter().all(|bytes| *bytes < 5_000_000) && sizes.iter().sum::<u64>() < 40_000_000);
    for row in &rows {
        assert!(row[2].len() > 5 && row[3].len() > 10, "{row:?}");
        let test = test_of(row[4]);
        let source = text(&test);
        let file = row[1].rsplit('/').next().unwrap();
        // Snapshots are named without their ending, series by a pattern of their name.
        let stem = file.split(".snap").next().unwrap();
        let stem = stem.split("Fr").next().unwrap();
        let stem = stem.trim_end_matches(".gz");
        assert!(source.contains(stem), "{test} does not read {file}");
        if row[3].starts_with("cargo test") {
            assert!(row[3].contains(&format!(" {}::", row[4])), "{row:?}");
        }
    }
}

/// `.ci/run debug` builds each of our crates with checks.
#[test]
fn every_crate_is_built_for_debugging() {
    let profiles: toml::Table = text(".ci/debug.toml").parse().unwrap();
    let packages = profiles["profile"]["release"]["package"]
        .as_table()
        .unwrap();
    let workspace: toml::Table = text("Cargo.toml").parse().unwrap();
    let members = workspace["workspace"]["members"].as_array().unwrap();
    let members = members.iter().map(|member| member.as_str().unwrap());
    for member in members.chain(["tests/rigs/capi"]) {
        let manifest: toml::Table = text(&format!("{member}/Cargo.toml")).parse().unwrap();
        let name = manifest["package"]["name"].as_str().unwrap();
        let profile = packages.get(name).unwrap_or_else(|| panic!("{name}"));
        for check in ["debug-assertions", "overflow-checks"] {
            assert_eq!(profile[check].as_bool(), Some(true), "{check} of {name}");
        }
    }
}

/// Laws and observables name their source; every public item is documented, by lint.
#[test]
fn physics_names_its_source() {
    assert!(text("Cargo.toml").contains("missing_docs = \"warn\""));
    assert!(text(".ci/run").contains("-D warnings"));
    let papers = ["Kumar 2018", "Guillard 2014"];
    let cites = |name: &str| papers.iter().any(|paper| text(name).contains(paper));
    let mut laws = files("kernel/src/contact", ".rs");
    laws.retain(|name| code(name).contains(" Law<R> for "));
    assert!(laws.len() >= 2);
    for name in &laws {
        let head: String = text(name)
            .lines()
            .take_while(|l| l.starts_with("//!"))
            .collect();
        assert!(
            papers.iter().any(|p| head.contains(p)) && head.contains("eq"),
            "{name}"
        );
    }
    for name in [
        "harness/sim/src/energy_budget/mod.rs",
        "harness/lab/src/bed/mod.rs",
        "harness/lab/src/bed/lid.rs",
        "harness/analysis/src/claims/fits.rs",
        "harness/analysis/src/claims/points.rs",
        "harness/sim/src/coefficients.rs",
        "harness/lab/src/flow.rs",
        "harness/sim/src/observe.rs",
        "harness/sim/src/histogram.rs",
        "harness/lab/src/scenario/plan.rs",
        "harness/lab/src/scenario/rig.rs",
        "harness/sim/src/law/time_step.rs",
    ] {
        assert!(cites(name), "{name}");
    }
    assert!(text("harness/sim/src/block_averaging.rs").contains("Flyvbjerg and Petersen"));
}

/// The file system is called in one place, so that tests can fail every call and none opens a pipe.
#[test]
fn files_are_touched_in_one_place() {
    let calls = [
        "fs::read",
        "fs::write",
        "fs::remove",
        "fs::rename",
        "fs::create",
        "fs::metadata",
        "fs::copy",
        "File::open",
        "File::create",
        "File::options",
        "OpenOptions",
        ".exists()",
        ".is_file()",
        ".is_dir()",
    ];
    let mut read = 0;
    for name in harness() {
        // The memory of a process is not a user's file.
        let disk = [
            "disk.rs",
            "below.rs",
            "disk/append.rs",
            "disk/folders.rs",
            "disk/lock.rs",
            "disk/watch.rs",
        ];
        let mut spared = disk.iter().chain(&["memory.rs"]);
        let spared = spared.any(|file| name.ends_with(&format!("src/{file}")));
        let code = code(&name);
        let found = calls.iter().find(|call| code.contains(**call));
        assert!(
            spared || found.is_none(),
            "{name} calls {found:?}: see harness/sim/src/disk.rs"
        );
        // Below a folder of results `below::Below` decides what is written.
        let results = ["run/", "campaign/", "bed/", "manifest/"];
        let mut results = results.iter().map(|folder| format!("lab/src/{folder}"));
        let within = results.any(|folder| name.contains(&folder));
        assert!(
            !within || !code.contains("write_whole"),
            "{name}: see below::Below"
        );
        read += 1;
    }
    assert!(read > 150, "{read}");
}

/// The program carries copies of two goldens, so that its crate can be packed.
#[test]
fn what_the_program_carries_is_golden() {
    let same = [
        ("harness/analysis/data/claims.toml", "golden/claims.toml"),
        (
            "harness/lab/data/reference.txt",
            "golden/digests/reference.snap.txt",
        ),
    ];
    for (copy, golden) in same {
        let read = |name: &str| std::fs::read(root().join(name)).unwrap();
        assert!(read(copy) == read(golden), "cp {golden} {copy}");
    }
}
