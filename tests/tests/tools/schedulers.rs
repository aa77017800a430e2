//! The guide's page about many machines as it stands: GNU parallel, HyperQueue and Snakemake run the tasks of a
//! campaign, and its table is that of one process.
//!
//! `cargo test -p bitgrain-tests --release --test tools schedulers:: -- --ignored` needs Debian's `parallel` and
//! `snakemake`, and Python with hyperqueue (the variable `PYTHON` names it if it is not `python3`).

use std::collections::BTreeMap;
use std::process::Command;

use bitgrain_tests::{CAMPAIGN, SMALL, output, results, root};

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

/// Does a campaign in a folder of its own by a command line, in which `bitgrain` is the one under test; returns its
/// files.
fn by(line: &str, file: (&str, &str)) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("small.toml", SMALL);
    write("my-campaign.toml", CAMPAIGN);
    write(file.0, file.1);
    std::fs::create_dir(folder.path().join("bin")).unwrap();
    std::os::unix::fs::symlink(PROGRAM, folder.path().join("bin/bitgrain")).unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", folder.path().join("bin").display());
    let mut command = Command::new("sh");
    command.args(["-c", line]).current_dir(folder.path());
    let out = command.env("PATH", path).output().unwrap();
    let told = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{line}: {told}");
    let merge = ["sweep", "my-campaign.toml", "--merge"];
    assert!(
        output(PROGRAM, folder.path(), &merge).status.success(),
        "{line}"
    );
    results(&folder.path().join("out/camp"))
}

/// The first block of the page below a heading.
fn block(page: &str, heading: &str) -> String {
    let (_, below) = page.split_once(&format!("## {heading}\n")).unwrap();
    let (_, block) = below.split_once("```").unwrap();
    let (_, block) = block.split_once('\n').unwrap();
    block.split("```").next().unwrap().to_string()
}

#[test]
#[ignore = "needs parallel, snakemake and hyperqueue: `.ci/run slurm`"]
fn the_guides_schedulers_run_a_campaign() {
    let page = root().join("harness/guide/src/many-machines.md");
    let page = std::fs::read_to_string(page).unwrap();
    let alone = by("bitgrain sweep my-campaign.toml", ("none", ""));
    assert!(alone.contains_key("results.csv"));
    let same = |what: &str, files: BTreeMap<String, Vec<u8>>| {
        assert!(files == alone, "{what}");
        println!("{what}: the bytes of one process");
    };
    same(
        "GNU parallel",
        by(&block(&page, "GNU parallel"), ("none", "")),
    );
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let script = block(&page, "HyperQueue");
    same(
        "HyperQueue",
        by(&format!("'{python}' queue.py"), ("queue.py", &script)),
    );
    let file = block(&page, "Snakemake");
    same("Snakemake", by("snakemake --cores 8", ("Snakefile", &file)));
}
