//! `bitgrain benchmark`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::channels::{print, shown};
use bitgrain_analysis::report::benchmark_page;
use bitgrain_lab::benchmark::{self, Check, Test};
use bitgrain_sim::disk::{is_folder, is_partial, list, make_folder, write_whole};
use bitgrain_sim::error::{Error, Result};

/// The names of summary and page.
const SUMMARY: &str = "summary.json";
const PAGE: &str = "report.html";

/// What `bitgrain benchmark` takes.
#[derive(Args)]
pub(super) struct Benchmark {
    /// Which benchmark [default: none; those there are are listed].
    name: Option<String>,
    /// Folder for tables, summary and page [default: out/NAME].
    #[arg(long, value_name = "FOLDER", requires = "name")]
    out: Option<PathBuf>,
}

/// Runs a benchmark, or lists them.
pub(super) fn run(what: Benchmark) -> Result<()> {
    let Some(name) = what.name else {
        let line = |(name, about)| format!("{name:<12} {about}\n");
        return print(&benchmark::list().map(line).collect::<String>());
    };
    let folder = what.out.unwrap_or_else(|| Path::new("out").join(&name));
    check_folder(&folder)?;
    let done = benchmark::run(&name)?;
    write(&done, &folder)?;
    let lines: String = done.tests.iter().map(line).collect();
    print(&format!("{lines}report: {}\n", shown(&folder.join(PAGE))))?;
    let failed: Vec<&Check> = done.checks().filter(|check| !check.holds).collect();
    let Some(first) = failed.first() else {
        return Ok(());
    };
    let problem = format!(
        "{} of {} checks against theory do not hold, the first of them of {}: {} is {} and should be {}",
        failed.len(),
        done.checks().count(),
        first.material,
        first.what,
        first.measured,
        first.expected,
    );
    let hint = "this build computes contacts wrongly; `bitgrain selftest` checks the machine";
    Err(Error::Unverified { problem, hint })
}

/// Refuses a folder with files that no benchmark writes: its summary and page would be overwritten.
fn check_folder(folder: &Path) -> Result<()> {
    let is_table = |name: &str| name.starts_with("test-") && name.ends_with(".csv");
    let ours = |name: &str| is_table(name) || [SUMMARY, PAGE].contains(&name) || is_partial(name);
    let held = if is_folder(folder) {
        list(folder)?
    } else {
        Vec::new()
    };
    match held.iter().find(|(name, _)| !ours(name)) {
        None => Ok(()),
        Some((other, _)) => {
            let problem = format!(
                "holds {other}, which is no file of a benchmark; choose another folder (--out)"
            );
            Err(Error::input(shown(folder), problem))
        }
    }
}

/// Writes tables, summary and page.
fn write(done: &benchmark::Benchmark, folder: &Path) -> Result<()> {
    let summary = serde_json::to_string_pretty(done).map_err(|e| Error::Output(e.into()))?;
    let tables = done.tests.iter().map(|test| {
        let name = format!("test-{}.csv", test.number);
        (name, test.table.clone())
    });
    let mut files: Vec<(String, String)> = tables.collect();
    files.push((SUMMARY.into(), summary + "\n"));
    files.push((PAGE.into(), benchmark_page(done)));
    make_folder(folder)?;
    for (name, text) in files {
        write_whole(&folder.join(name), text.as_bytes())?;
    }
    Ok(())
}

/// What came of a test.
fn line(test: &Test) -> String {
    let held = test.checks.iter().filter(|check| check.holds).count();
    let worst = test.checks.iter().map(|check| check.deviation);
    let worst = worst.fold(0.0, |a: f64, b| if b <= a { a } else { b });
    format!(
        "test {}: {held} of {} checks hold, largest deviation {worst:.1e}: {}\n",
        test.number,
        test.checks.len(),
        test.title
    )
}
