//! The commands of the README and of every `--help` run.

use std::collections::BTreeSet;
use std::path::Path;

use bitgrain::bench::{SOFT_TIME_STEP, soft_law};
use bitgrain_tests::{CAMPAIGN, SMALL, golden, hertz_history, output, root};

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

/// Commands in the README's blocks, tables and text.
fn readme_commands() -> Vec<String> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let blocks = readme.lines().filter_map(|line| line.strip_prefix("    "));
    let inline = readme.lines().filter(|line| !line.starts_with("    "));
    let inline = inline.flat_map(|line| line.split('`').skip(1).step_by(2));
    let all = blocks
        .chain(inline)
        .map(|line| line.split(" #").next().unwrap_or("").trim());
    let ours = |line: &&str| line.starts_with("bitgrain ") || line.starts_with("cargo ");
    all.filter(ours).map(str::to_string).collect()
}

/// Examples at the end of a command's help.
fn help_commands(command: &[&str]) -> Vec<String> {
    let args: Vec<&str> = command.iter().copied().chain(["--help"]).collect();
    let help = output(PROGRAM, Path::new("."), &args);
    let help = String::from_utf8(help.stdout).unwrap().replace("\\\n", " ");
    let lines = help.lines().map(str::trim);
    let found: Vec<String> = lines
        .filter(|line| line.starts_with("bitgrain "))
        .map(str::to_string)
        .collect();
    assert!(!found.is_empty(), "{command:?} --help shows no example");
    found
}

/// Words of a command line; single quotes hold words together.
fn words(line: &str) -> Vec<String> {
    let mut out = vec![];
    for (k, part) in line.split('\'').enumerate() {
        if k % 2 == 1 {
            out.push(part.to_string());
        } else {
            out.extend(part.split_whitespace().map(str::to_string));
        }
    }
    out
}

/// A folder in which every command of the documents can run: the goldens are at hand, a bed, and a run
/// with as many steps as examples speak of, twice.
fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    std::os::unix::fs::symlink(root().join("golden"), place("golden")).unwrap();
    let text = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    std::fs::write(place("my-bed.toml"), text).unwrap();
    let out = output(
        PROGRAM,
        folder.path(),
        &["run", "my-bed.toml", "--out", "made"],
    );
    assert!(out.status.success());
    for out in ["out/quick", "out/other"] {
        let set = "intruder.speed=0.3";
        let args = ["run", "my-bed.toml", "--out", out, "--set", set];
        assert!(output(PROGRAM, folder.path(), &args).status.success());
    }
    // A campaign that has come to its end, its table, and a book of claims to write into.
    let campaign = CAMPAIGN.replace("small.toml", "my-bed.toml");
    let campaign = campaign.replace("\"camp\"", "\"kumar-small\"");
    std::fs::write(place("my-campaign.toml"), campaign).unwrap();
    let out = output(PROGRAM, folder.path(), &["sweep", "my-campaign.toml"]);
    assert!(out.status.success());
    std::fs::copy(place("out/kumar-small/results.csv"), place("results.csv")).unwrap();
    std::fs::copy(place("golden/claims.toml"), place("claims.toml")).unwrap();
    std::fs::create_dir_all(place("target/release")).unwrap();
    let link = |from: &Path, to: &str| std::os::unix::fs::symlink(from, place(to)).unwrap();
    link(&place("out"), "elsewhere");
    link(Path::new(PROGRAM), "bitgrain-of-last-week");
    link(Path::new(PROGRAM), "target/release/bitgrain");
    std::fs::copy(place("golden/cases/collapse.json"), place("case.json")).unwrap();
    folder
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn documented_commands_run() {
    let mut lines = readme_commands();
    assert!(lines.len() > 15, "{lines:?}");
    let commands: [&[&str]; 15] = [
        &["run"],
        &["sweep"],
        &["analyse"],
        &["claims"],
        &["bed"],
        &["bed", "list"],
        &["bed", "show"],
        &["bed", "remove"],
        &["bench"],
        &["replay"],
        &["verify"],
        &["bisect"],
        &["selftest"],
        &[],
        &["help", "run"],
    ];
    for command in &commands[..13] {
        lines.extend(help_commands(command));
    }
    for command in &commands[13..] {
        let help: Vec<&str> = if command.is_empty() {
            vec!["--help"]
        } else {
            command.to_vec()
        };
        assert!(output(PROGRAM, Path::new("."), &help).status.success());
    }
    let mut seen = BTreeSet::new();
    // What takes beds away comes last.
    lines.sort_by_key(|line| line.contains("remove --all"));
    let mut folder = desk();
    for line in lines.into_iter().filter(|line| seen.insert(line.clone())) {
        let line = match line.strip_prefix("cargo run --release -- ") {
            Some(rest) => format!("bitgrain {rest}"),
            None => line,
        };
        if let Some(cargo) = line.strip_prefix("cargo ") {
            cargo_command(cargo);
            continue;
        }
        // The bed has another name, and a small scenario does for two builds.
        let line = line.replace("4f1c", &bed_name(folder.path()));
        let line = line.replace("--scenario quick", "--scenario my-bed.toml");
        let line = line.replace("--book golden/claims.toml", "--book claims.toml");
        let mut args = words(&line);
        args.remove(0);
        // Placeholders in capitals stand for what the text explains.
        let stands = |w: &String| w.len() > 1 && w.chars().all(|c| c.is_ascii_uppercase());
        if args.iter().any(stands) || line.contains(['[', '…']) && !line.contains('\'') {
            continue;
        }
        // Days of work are planned here, not done; the quick scenario has a test of its own.
        let planned = args[0] == "sweep" || args[0] == "run" && !line.contains("my-bed");
        if planned {
            args.push("--dry-run".into());
            args.dedup_by(|a, b| a == b);
        }
        if line.starts_with("bitgrain bed remove") {
            folder = desk();
        }
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let out = output(PROGRAM, folder.path(), &args);
        let error = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{line}: {error}");
    }
}

/// The beginning of the name of a bed in the folder's library.
fn bed_name(folder: &Path) -> String {
    let mut beds = std::fs::read_dir(folder.join("beds")).into_iter().flatten();
    let bed = beds.next().map(|bed| bed.unwrap().file_name());
    bed.map_or(String::new(), |name| {
        name.to_string_lossy()[..8].to_string()
    })
}

/// A cargo command of the documents: what it names is there.
fn cargo_command(line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let after = |flag: &str| words.iter().position(|w| *w == flag).map(|k| words[k + 1]);
    if let Some(test) = after("--test") {
        let folder = root().join("tests/tests").join(test);
        assert!(folder.join("main.rs").exists(), "{line}");
        // A filter begins with the name of a module.
        if let Some((module, _)) = words.iter().find_map(|word| word.split_once("::")) {
            assert!(folder.join(format!("{module}.rs")).exists(), "{line}");
        }
    }
    if let Some(bin) = after("--bin") {
        let source = format!("tests/src/bin/{bin}.rs");
        assert!(root().join(source).exists(), "{line}");
    }
    if let Some(bench) = after("--bench") {
        assert!(
            root().join(format!("harness/benches/{bench}.rs")).exists(),
            "{line}"
        );
    }
    if words[..2] == ["+nightly", "fuzz"] {
        let target = words[3];
        assert!(
            root()
                .join(format!("fuzz/fuzz_targets/{target}.rs"))
                .exists(),
            "{line}"
        );
    }
    let known = ["test", "bench", "run", "+nightly", "install"];
    assert!(known.contains(&words[0]), "{line}");
}

/// The README tells the reference digest and sizes of firmware that lie within the golden ranges.
#[test]
fn the_readme_has_the_goldens_numbers() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let lines = std::fs::read_to_string(golden("digests/reference.snap.txt")).unwrap();
    let digest = lines.split_whitespace().last().unwrap();
    assert!(readme.contains(&format!("`{digest}`")), "{digest}");
    let ranges = std::fs::read_to_string(golden("firmware.csv")).unwrap();
    for (board, row) in [
        ("cortex-m4f", "| Cortex-M4F | "),
        ("cortex-m0", "| Cortex-M0 | "),
    ] {
        let row = readme.lines().find(|line| line.starts_with(row)).unwrap();
        let cells = row
            .split('|')
            .skip(2)
            .map(|cell| cell.trim().replace(',', ""));
        let told: Vec<u32> = cells.filter_map(|cell| cell.parse().ok()).collect();
        let held = ranges
            .lines()
            .filter(|line| line.starts_with(&format!("{board},")));
        let held: Vec<(u32, u32)> = held
            .map(|line| {
                let mut words = line.split(',').skip(2).map(|word| word.parse().unwrap());
                (words.next().unwrap(), words.next().unwrap())
            })
            .collect();
        assert_eq!((told.len(), held.len()), (3, 3), "{row}");
        let within = told
            .iter()
            .zip(&held)
            .all(|(t, (least, most))| least <= t && t <= most);
        assert!(within, "{row} in {held:?}");
    }
}

/// The peers are timed under the law and the time step that `bitgrain bench` takes.
#[test]
fn the_peers_inputs_have_our_numbers() {
    let [kn, kt, gamma_n, gamma_t, mu] = hertz_history(&soft_law());
    assert_eq!((kn, kt, mu), (2e5, 1.225 * 2e5, 0.5));
    // The same power, but for how it was rounded.
    let gamma = 50000.0 * (kn / 2e8f64).powf(0.6);
    assert!([gamma_n, gamma_t].map(|g| (g / gamma - 1.0).abs() < 1e-15) == [true; 2]);
    let lammps = std::fs::read_to_string(golden("peers/speed.lmp")).unwrap();
    for line in [
        "variable    kn equal 2.0e5",
        "variable    kt equal 1.225*${kn}",
        "variable    gamma equal 50000.0*(${kn}/2.0e8)^0.6",
        "gran/hertz/history ${kn} ${kt} ${gamma} ${gamma} 0.5 1",
    ] {
        assert!(lammps.contains(line), "{line}");
    }
    let liggghts = std::fs::read_to_string(golden("peers/speed.liggghts")).unwrap();
    let material = |name: &str| -> f64 {
        let line = liggghts.lines().find(|line| line.contains(name)).unwrap();
        let mut words = line
            .split_whitespace()
            .skip_while(|word| *word != "peratomtype");
        words.nth(1).unwrap().parse().unwrap()
    };
    // K_n = (2/3) E / (1 - nu^2), and K_t / K_n = 3 (1 - nu) / (2 - nu), within 1 %.
    let (young, poisson) = (material("youngsModulus"), material("poissonsRatio"));
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
    assert!(near(2.0 / 3.0 * young / (1.0 - poisson * poisson), kn));
    assert!(near(3.0 * (1.0 - poisson) / (2.0 - poisson), kt / kn));
    for input in [lammps, liggghts] {
        assert!(input.contains("timestep    1.5e-4"));
    }
    assert_eq!(SOFT_TIME_STEP, 1.5e-4);
}
