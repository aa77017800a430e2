//! Every command and every file in the README, the guide and the help runs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::{LazyLock, Mutex};
use std::time::Instant;

use bitgrain_tests::wee::copy_all;
use bitgrain_tests::{CAMPAIGN, SMALL, golden, output, root};

use crate::PROGRAM;

/// The README, the contributor's page and the chapters of the guide: names and texts.
fn pages() -> Vec<(String, String)> {
    let mut names: Vec<String> = ["README.md", "CONTRIBUTING.md", "SECURITY.md"]
        .map(String::from)
        .to_vec();
    let guide = std::fs::read_dir(root().join("harness/guide/src")).unwrap();
    let chapters = guide.map(|item| item.unwrap().file_name().into_string().unwrap());
    let chapters = chapters.filter(|name| name.ends_with(".md"));
    names.extend(chapters.map(|name| format!("harness/guide/src/{name}")));
    names.sort();
    let text = |name: &String| std::fs::read_to_string(root().join(name)).unwrap();
    let texts: Vec<String> = names.iter().map(text).collect();
    names.into_iter().zip(texts).collect()
}

/// The fenced blocks of a page: what each is in, and its text.
fn blocks(page: &str) -> Vec<(&str, String)> {
    let mut found: Vec<(&str, String)> = Vec::new();
    let mut within = false;
    for line in page.lines() {
        match (line.strip_prefix("```"), within) {
            (Some(kind), false) => {
                found.push((kind, String::new()));
                within = true;
            }
            (Some(_), true) => within = false,
            (None, true) => {
                let text = &mut found.last_mut().expect("a block has begun").1;
                *text += line;
                *text += "\n";
            }
            (None, false) => assert!(!line.starts_with("    "), "an indented block: {line}"),
        }
    }
    assert!(!within, "a block without an end");
    found
}

/// Commands of a page's blocks, in their order.
fn page_commands(page: &str) -> Vec<String> {
    let shell = blocks(page).into_iter().filter(|(kind, _)| *kind == "sh");
    let mut lines = Vec::new();
    for (_, text) in shell {
        for line in text.lines() {
            let line = line.split(" #").next().unwrap_or("").trim();
            // What ranks would share, one process does here; `.ci/run ranks` starts ranks.
            let mpirun = line.strip_prefix("mpirun ");
            let line = mpirun.map_or(line, |shared| &shared[shared.find("bitgrain ").unwrap()..]);
            lines.push(line.to_string());
        }
    }
    // `.ci/run` installs the packages.
    lines.retain(|line| {
        !line.is_empty() && !line.starts_with('#') && !line.starts_with("apt-get install ")
    });
    lines
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

/// Commands that write nothing and that were run.
static ONCE: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// What the commands of the documents work on: a bed, a run with as many steps as examples speak of, twice, a
/// finished campaign, and its table.
static MADE: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    // As many steps as the documents speak of, of few grains.
    let few = "box = [5.0, 4.0, 6.0]\ngrains = 90\nsettled = 1e-2";
    let text = SMALL.replacen("box = [8.0, 6.0, 6.0]\ngrains = 300", few, 1);
    std::fs::write(place("my-bed.toml"), text).unwrap();
    for out in ["made", "out/quick", "out/other"] {
        let set = if out == "made" { "0.6" } else { "0.3" };
        let set = format!("intruder.speed={set}");
        let args = ["run", "my-bed.toml", "--out", out, "--set", &set];
        assert!(output(PROGRAM, folder.path(), &args).status.success());
    }
    copy_all(&place("out/quick"), &place("out/kumar-system-2"));
    let campaign = CAMPAIGN.replace("small.toml", "my-bed.toml");
    let campaign = campaign.replace("\"camp\"", "\"kumar-small\"");
    std::fs::write(place("my-campaign.toml"), campaign).unwrap();
    let out = output(PROGRAM, folder.path(), &["sweep", "my-campaign.toml"]);
    assert!(out.status.success());
    std::fs::copy(place("out/kumar-small/results.csv"), place("results.csv")).unwrap();
    std::fs::copy(golden("claims.toml"), place("claims.toml")).unwrap();
    std::fs::copy(golden("cases/collapse.json"), place("case.json")).unwrap();
    for name in ["one", "two", "other"] {
        let frames = "step 0\narray x u8 2\nabdone\nend\n";
        std::fs::write(place(&format!("{name}.frames")), frames).unwrap();
        let asked = "#!/bin/sh\nwhile read -r _ step; do printf 'step %s\\narray x u8 1\\nadone\\n' $step; done\n";
        std::fs::write(place(name), asked).unwrap();
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
        std::fs::set_permissions(place(name), mode).unwrap();
    }
    folder
});

/// A copy of it, in which the goldens are at hand.
fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy_all(MADE.path(), folder.path());
    let place = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(place("target/release")).unwrap();
    let link = |from: &Path, to: &str| std::os::unix::fs::symlink(from, place(to)).unwrap();
    link(&golden(""), "golden");
    link(&place("out"), "elsewhere");
    link(Path::new(PROGRAM), "bitgrain-of-last-week");
    link(Path::new(PROGRAM), "target/release/bitgrain");
    folder
}

/// Runs commands of a document in their own folder. Those that take days are only planned.
fn run_commands(lines: Vec<String>) {
    let folder = desk();
    let mut seen = BTreeSet::new();
    for line in lines.into_iter().filter(|line| seen.insert(line.clone())) {
        let line = match line.strip_prefix("cargo run --release -- ") {
            Some(rest) => format!("bitgrain {rest}"),
            None => line,
        };
        if let Some(cargo) = line.strip_prefix("cargo ") {
            cargo_command(cargo);
            continue;
        }
        // What the commands of a pipe or of a list do, they do in the shell.
        let in_shell = line.strip_prefix("bitgrain ");
        let in_shell = in_shell.filter(|line| line.contains(" < ") || line.contains(" | "));
        if let Some(words) = in_shell {
            let line = format!("'{PROGRAM}' {words}");
            let out = output("sh", folder.path(), &["-c", &line]);
            let error = String::from_utf8_lossy(&out.stderr);
            assert!(out.status.success(), "{line}: {error}");
            continue;
        }
        // The bed has another name, and a small scenario does for two builds.
        let line = line.replace("db7e", &bed_name(folder.path()));
        let line = line.replace("--scenario quick", "--scenario my-bed.toml");
        let line = line.replace("--book golden/claims.toml", "--book claims.toml");
        // Its own bed would be poured first.
        let line = match line.as_str() {
            "bitgrain bench --steps 2000" => {
                "bitgrain bench --steps 2000 --bed golden/peers/bed200.data".to_string()
            }
            _ => line,
        };
        let mut args = words(&line);
        let program = args.remove(0);
        if program != "bitgrain" {
            assert!(
                ["ls", "cp", "cat", "diff"].contains(&&program[..]),
                "{line}"
            );
            let args: Vec<&str> = args.iter().map(String::as_str).collect();
            let out = output(&program, folder.path(), &args);
            assert!(out.status.success(), "{line}");
            continue;
        }
        // Placeholders in capitals stand for what the text explains.
        let stands = |w: &String| w.len() > 1 && w.chars().all(|c| c.is_ascii_uppercase());
        if args.iter().any(stands) || line.contains(['[', '…']) && !line.contains('\'') {
            continue;
        }
        let mine = line.contains("my-bed") || line.contains("--resume");
        let planned = args[0] == "sweep" || args[0] == "run" && !mine;
        if planned && !line.contains("--dry-run") && !line.contains("--merge") {
            args.insert(1, "--dry-run".into());
        }
        // A command that writes nothing prints the same in every folder.
        let file = |word: &String| word.contains(['/', '.']);
        let writes_nothing = args.iter().any(|word| word == "--dry-run")
            && !args.iter().take(3).any(file)
            || ["bench", "selftest"].contains(&args[0].as_str());
        if writes_nothing && !ONCE.lock().unwrap().insert(args.join(" ")) {
            continue;
        }
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let began = Instant::now();
        let out = output(PROGRAM, folder.path(), &args);
        println!("{:.1} s: {line}", began.elapsed().as_secs_f64());
        let error = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{line}: {error}");
    }
}

/// A quarter of a minute, because each example of each `--help` is given to the program.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn commands_of_every_help_run() {
    let commands: [&[&str]; 20] = [
        &["run"],
        &["sweep"],
        &["analyse"],
        &["claims"],
        &["bed"],
        &["bed", "list"],
        &["bed", "show"],
        &["bed", "remove"],
        &["bench"],
        &["benchmark"],
        &["replay"],
        &["verify"],
        // What it records is compared next.
        &["record"],
        &["bisect"],
        &["selftest"],
        &["new"],
        &["completions"],
        &["man"],
        &[],
        &["help", "run"],
    ];
    let mut lines = Vec::new();
    for command in &commands[..18] {
        lines.extend(help_commands(command));
    }
    for command in &commands[18..] {
        let help: Vec<&str> = if command.is_empty() {
            vec!["--help"]
        } else {
            command.to_vec()
        };
        assert!(output(PROGRAM, Path::new("."), &help).status.success());
    }
    // Commands that remove beds come last.
    lines.sort_by_key(|line| line.contains("remove"));
    lines.sort_by_key(|line| line.contains("remove --all"));
    run_commands(lines);
}

/// Every command of the pages whose names begin so.
fn pages_run(choose: impl Fn(&str) -> bool) {
    let mut count = 0;
    for (name, page) in pages().iter().filter(|(name, _)| choose(name)) {
        let lines = page_commands(page);
        count += lines.len();
        println!("{name}: {} commands", lines.len());
        run_commands(lines);
    }
    assert!(count > 10, "{count} commands");
}

/// The name of a chapter's file.
fn chapter(name: &str) -> Option<&str> {
    name.strip_prefix("harness/guide/src/")
}

/// Ten seconds, because each command of the README and the guide is given to the program.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn commands_of_the_pages_run() {
    pages_run(|name| chapter(name).is_none_or(|chapter| chapter < "f"));
}

#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn commands_of_the_other_chapters_run() {
    pages_run(|name| chapter(name).is_some_and(|chapter| chapter >= "f"));
}

/// Scenarios, campaigns and pieces of scenarios in the documents are read; cases are replayed. Blocks of other
/// kinds are Rust, which is compiled as tests of the documentation, and text.
#[test]
fn files_in_the_documents_are_read() {
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    let pages = pages();
    for (name, page) in &pages {
        for (kind, text) in blocks(page) {
            *kinds.entry(kind).or_default() += 1;
            match kind {
                // Python is run by the tests of its package, and by the test `recordings` of `tools`.
                "sh" | "text" | "rust" | "yaml" | "python" | "c" => {}
                "toml" => is_read(name, &text),
                "json" => is_replayed(name, &text),
                other => panic!("{name}: a block of {other:?}"),
            }
        }
    }
    assert!(
        kinds["toml"] >= 4 && kinds["json"] >= 1 && kinds["rust"] >= 4,
        "{kinds:?}"
    );
}

/// A scenario, a campaign, or tables that a small scenario gets instead of its own.
fn is_read(name: &str, text: &str) {
    let block: toml::Table = text
        .parse()
        .unwrap_or_else(|e| panic!("{name}: {e}\n{text}"));
    let folder = tempfile::tempdir().unwrap();
    let small = folder.path().join("small.toml");
    std::fs::write(&small, SMALL).unwrap();
    let path = folder.path().join("it.toml");
    let args = if block.contains_key("base") {
        std::fs::write(&path, text).unwrap();
        ["sweep", "it.toml", "--dry-run"]
    } else {
        let mut whole: toml::Table = SMALL.parse().unwrap();
        let complete = block.contains_key("bed") && block.contains_key("law");
        if complete {
            whole = block;
        } else {
            let bed = block.get("bed").and_then(toml::Value::as_table);
            if bed.is_some_and(|bed| bed.contains_key("fill_height")) {
                whole["bed"].as_table_mut().unwrap().remove("grains");
            }
            for (key, value) in block {
                match (whole.get_mut(&key), value) {
                    (Some(toml::Value::Table(old)), toml::Value::Table(new)) => old.extend(new),
                    (_, value) => {
                        whole.insert(key, value);
                    }
                }
            }
        }
        std::fs::write(&path, whole.to_string()).unwrap();
        ["run", "it.toml", "--dry-run"]
    };
    let out = output(PROGRAM, folder.path(), &args);
    let error = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{name}: {error}\n{text}");
}

fn is_replayed(name: &str, text: &str) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("it.json"), text).unwrap();
    let out = output(
        PROGRAM,
        folder.path(),
        &["replay", "it.json", "--steps", "50"],
    );
    let error = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{name}: {error}");
    // The first state and the last.
    assert_eq!(out.stdout.iter().filter(|&&b| b == b'\n').count(), 2);
}

/// Links between the pages lead somewhere, every chapter is in the book, and the README is short.
#[test]
fn pages_lead_somewhere() {
    let pages = pages();
    let book = &pages
        .iter()
        .find(|(name, _)| name.ends_with("SUMMARY.md"))
        .unwrap()
        .1;
    for (name, page) in &pages {
        let above = root().join(name).parent().unwrap().to_path_buf();
        for link in page.split("](").skip(1) {
            let link = link.split(')').next().unwrap();
            let file = link.split('#').next().unwrap();
            let outside = link.starts_with("http") || file.is_empty();
            assert!(outside || above.join(file).exists(), "{name}: {link}");
        }
        if let Some(chapter) = chapter(name).filter(|chapter| *chapter != "SUMMARY.md") {
            assert!(
                book.contains(&format!("({chapter})")),
                "{chapter} is not in the book"
            );
            assert!(
                page.lines().nth(2).unwrap().starts_with("For: "),
                "{name} says for whom it is"
            );
        }
    }
    let readme = &pages
        .iter()
        .find(|(name, _)| name == "README.md")
        .unwrap()
        .1;
    let (lines, words) = (readme.lines().count(), readme.split_whitespace().count());
    assert!(
        lines <= 150 && words <= 1000,
        "{lines} lines, {words} words"
    );
}

/// The beginning of the name of a bed in the folder's library.
fn bed_name(folder: &Path) -> String {
    let mut beds = std::fs::read_dir(folder.join("beds")).into_iter().flatten();
    let bed = beds.next().map(|bed| bed.unwrap().file_name());
    bed.map_or(String::new(), |name| {
        name.to_string_lossy()[..8].to_string()
    })
}

/// A cargo command of the documents: what it names exists.
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
    let known = ["build", "test", "bench", "run", "+nightly", "install"];
    assert!(known.contains(&words[0]), "{line}");
}
