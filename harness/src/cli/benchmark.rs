//! `bitgrain benchmark`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::channels::{print, processors, shown, stoppable};
use bitgrain_analysis::report::benchmark_page;
use bitgrain_kernel::BITS_VERSION;
use bitgrain_lab::benchmark::{self, Check, Test};
use bitgrain_lab::folder::refuse_among_results;
use bitgrain_lab::json::json_text;
use bitgrain_lab::performance::{Performance, StagePerformance};
use bitgrain_sim::disk::{is_partial, make_folder, other_than, write_whole};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::threads::on_threads;

/// The names of summary and page.
const SUMMARY: &str = "summary.json";
const PAGE: &str = "report.html";

/// Times, which are no result.
const PERFORMANCE: &str = "performance.json";

/// What `bitgrain benchmark` takes.
#[derive(Args)]
pub(super) struct Benchmark {
    /// Which benchmark [default: none; those there are are listed].
    name: Option<String>,
    /// Folder for tables, summary and page [default: out/NAME].
    #[arg(long, value_name = "FOLDER", requires = "name")]
    out: Option<PathBuf>,
    /// Of dosta-impact: a file of the benchmark with radius, x, y and z of each grain [default: a bed is poured].
    #[arg(
        long,
        value_name = "FILE",
        requires = "name",
        conflicts_with = "grains"
    )]
    start: Option<PathBuf>,
    /// Of dosta-impact: how many grains are poured [default: 25000].
    #[arg(long, value_name = "COUNT", requires = "name")]
    grains: Option<u32>,
    /// Of dosta-impact: the time at which it ends, in s [default: 0.1].
    #[arg(long, value_name = "SECONDS", requires = "name")]
    until: Option<f64>,
    /// Threads [default: one for each processor].
    #[arg(long, requires = "name", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print lines if standard error is not a terminal: each minute of dosta-impact.
    #[arg(short, long, requires = "name")]
    verbose: bool,
}

/// Runs a benchmark, or lists them.
pub(super) fn run(what: Benchmark) -> Result<()> {
    let Some(name) = what.name else {
        let line = |(name, about)| format!("{name:<12} {about}\n");
        return print(&benchmark::list().map(line).collect::<String>());
    };
    let folder = what.out.unwrap_or_else(|| Path::new("out").join(&name));
    refuse_among_results(&folder)?;
    check_folder(&folder)?;
    let (threads, progress) = (processors(what.threads), stoppable(what.verbose));
    let request = benchmark::Request {
        name: &name,
        start: what.start.as_deref(),
        grains: what.grains,
        until: what.until,
        progress: &progress,
    };
    let done = on_threads(threads, || benchmark::run(&request))??;
    let performance = Performance {
        bits_version: BITS_VERSION,
        threads,
        seconds: done.performance.iter().map(|part| part.seconds).sum(),
        stages: done.performance.clone(),
        pace: None,
    };
    write(&done, &performance, &folder)?;
    let lines: String = done.tests.iter().map(line).collect();
    let times = done.performance.iter().map(|part| time(part, threads));
    let lines = lines + &times.collect::<String>();
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
    let mark = |name: &str| match name {
        SUMMARY => Some("\"published\": "),
        PAGE => Some("Before you believe these numbers"),
        PERFORMANCE => Some("\"bits_version\": "),
        name if name.starts_with("test-") && name.ends_with(".csv") => Some("BITS_VERSION "),
        name => is_partial(name).then_some(""),
    };
    match other_than(folder, mark)? {
        None => Ok(()),
        Some(other) => {
            let problem = format!(
                "holds {other}, which is no file of a benchmark; choose another folder (--out)"
            );
            Err(Error::input(shown(folder), problem))
        }
    }
}

/// Writes tables, summary and page.
fn write(done: &benchmark::Benchmark, performance: &Performance, folder: &Path) -> Result<()> {
    let summary = serde_json::to_string_pretty(done).map_err(|e| Error::Output(e.into()))?;
    let tables = done.tests.iter().map(|test| {
        let name = format!("test-{}.csv", test.number);
        (name, test.table.clone())
    });
    let mut files: Vec<(String, String)> = tables.collect();
    files.push((SUMMARY.into(), summary + "\n"));
    files.push((PAGE.into(), benchmark_page(done)));
    if !done.performance.is_empty() {
        let path = folder.join(PERFORMANCE);
        files.push((PERFORMANCE.into(), json_text(&path, performance)?));
    }
    make_folder(folder)?;
    for (name, text) in files {
        write_whole(&folder.join(name), text.as_bytes())?;
    }
    Ok(())
}

/// Time to solution.
fn time(part: &StagePerformance, threads: usize) -> String {
    format!(
        "{}: {:.0} s on {threads} thread(s), {:.1} million grain-steps/s\n",
        part.stage,
        part.seconds,
        1e-6 * part.grain_steps_per_s
    )
}

/// What came of a test.
fn line(test: &Test) -> String {
    let held = test.checks.iter().filter(|check| check.holds).count();
    let worst = test.checks.iter().map(|check| check.deviation);
    let worst = worst.fold(0.0, |a: f64, b| if b <= a { a } else { b });
    let line = format!(
        "test {}: {held} of {} checks hold, largest deviation {worst:.1e}: {}\n",
        test.number,
        test.checks.len(),
        test.title
    );
    match test.outcome.is_empty() {
        true => line,
        false => format!("{line}  {}\n", test.outcome),
    }
}
