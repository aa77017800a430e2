//! The laboratory's commands as functions: what they take and what they do is what the command takes and does.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;

use bitgrain::bed::library::BedCache;
use bitgrain::campaign;
use bitgrain::campaign::folder::CampaignFolder;
use bitgrain::cli;
use bitgrain::confirm;
use bitgrain::error::{Error, Result};
use bitgrain::folder::Folder;
use bitgrain::manifest::{FolderKind, Manifest, Vouched};
use bitgrain::progress::Progress;
use bitgrain::rerun::RunArchive;
use bitgrain::run::{SaveEvery, Setting};
use bitgrain::summary::read_folder;
use bitgrain::threads::builder;
use bitgrain::verify::{Scope, Segment};
use bitgrain::{present, scenario};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::{input, laboratory};

/// Time between two looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);

/// Does a job on a thread of its own, while this one looks for Ctrl-C, which asks the job to stop.
fn interruptible<T: Send>(
    py: Python<'_>,
    progress: &Progress,
    job: impl FnOnce() -> Result<T> + Send,
) -> PyResult<T> {
    let stop = progress.stop_flag();
    let (done, interrupt) = py.detach(|| {
        std::thread::scope(|scope| {
            let thread = builder();
            let running = thread.spawn_scoped(scope, job);
            let running = running.expect("a thread for the job");
            let mut interrupt = None;
            while !running.is_finished() {
                std::thread::sleep(LOOK);
                if let Err(signal) = Python::attach(|py| py.check_signals()) {
                    stop.store(true, Ordering::Relaxed);
                    interrupt.get_or_insert(signal);
                }
            }
            let done = running
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (done, interrupt)
        })
    });
    match (done, interrupt) {
        // It was done before it was asked to stop.
        (Ok(_), Some(signal)) => Err(signal),
        (done, _) => done.map_err(|error| laboratory(&error)),
    }
}

/// Threads: so many as asked for, or one for each processor.
fn processors(asked: Option<u16>) -> PyResult<usize> {
    match asked {
        Some(0 | 1025..) => Err(input("threads", "is not a number from 1 to 1024")),
        asked => Ok(asked.map_or_else(bitgrain::threads::processors, usize::from)),
    }
}

/// Runs a scenario, or goes on with the run in a folder; returns the folder, whether all of it is done, and whether a
/// step was executed.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn run(
    py: Python<'_>,
    name: Option<String>,
    sets: Vec<String>,
    out: Option<PathBuf>,
    beds: Option<PathBuf>,
    threads: Option<u16>,
    save_every: Option<&str>,
    only: Vec<String>,
    expect: Vec<String>,
    verbose: bool,
) -> PyResult<(PathBuf, bool, bool)> {
    if !only.is_empty() && !expect.is_empty() {
        let problem = "cannot go with only: what is expected is compared with all of a run";
        return Err(input("expect", problem));
    }
    let threads = processors(threads)?;
    let save = save_every.map(str::parse::<SaveEvery>).transpose();
    let save = save
        .map_err(|wrong| input("save_every", wrong.to_string()))?
        .unwrap_or_default();
    let progress = Progress::new(verbose);
    let progress = &progress;
    interruptible(py, progress, move || {
        let (scenario, out) = match (&name, out) {
            (None, Some(out)) => (Folder(&out).saved_scenario()?, out),
            (name, out) => {
                let scenario = scenario::load(name.as_deref().unwrap_or_default(), &sets)?;
                let own = PathBuf::from("out").join(&scenario.name);
                (scenario, out.unwrap_or(own))
            }
        };
        let library = BedCache::new(beds.unwrap_or_else(cli::own_beds));
        let done = bitgrain::run::run_in(Setting {
            scenario: &scenario,
            folder: &Folder(&out),
            library: &library,
            threads,
            save,
            frames: true,
            only: &only,
            write_report: present::write_report,
            progress,
        })?;
        if let Some(done) = done.as_ref().filter(|_| !expect.is_empty()) {
            let mut quiet = |_: &str| Ok(());
            confirm::check_folder(&out, &mut quiet)?;
            confirm::execute_found(&out, &done.executed, threads, progress, quiet)?;
            confirm::check_expected(&out, &expect)?;
        }
        let executed = done
            .as_ref()
            .is_none_or(|done| done.executed.iter().any(|taken| taken.steps > 0));
        Ok((out, done.is_some(), executed))
    })
}

/// Verifies a run or a campaign; returns the lines that the command prints.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn verify(
    py: Python<'_>,
    folder: PathBuf,
    expect: Vec<String>,
    segments: Vec<String>,
    sample: Option<u16>,
    seed: u64,
    threads: Option<u16>,
) -> PyResult<Vec<String>> {
    let threads = processors(threads)?;
    let segments = segments
        .iter()
        .map(|text| text.parse::<Segment>().map_err(|wrong| (text, wrong)));
    let segments = segments.collect::<std::result::Result<Vec<_>, _>>();
    let segments =
        segments.map_err(|(text, wrong)| input("segments", format!("{text:?}: {wrong}")))?;
    let scope = Scope {
        segments,
        sample: sample.map(|count| (usize::from(count), seed)),
    };
    let progress = Progress::new(false);
    let mut lines = Vec::new();
    let told = &mut lines;
    let done = interruptible(py, &progress, || {
        let say = |line: &str| {
            told.push(line.to_string());
            Ok(())
        };
        if campaign_at(&folder)? {
            let folder = CampaignFolder(&folder);
            return campaign::verify::verify(&folder, &scope, &expect, threads, &progress, say);
        }
        let folder = Folder(&folder);
        let archive = RunArchive::open(&folder)?;
        bitgrain::verify::verify(&archive, &scope, &expect, threads, &progress, say)
    });
    match done {
        Ok(()) => Ok(lines),
        Err(error) => {
            error.value(py).setattr("lines", lines)?;
            Err(error)
        }
    }
}

fn campaign_at(folder: &Path) -> Result<bool> {
    Ok(Manifest::of(folder)?.is_some_and(|manifest| manifest.of == FolderKind::Campaign))
}

/// Finds where two runs part; returns what is found as JSON, and the lines that the command prints on the way.
#[pyfunction]
pub fn bisect(
    py: Python<'_>,
    folders: [PathBuf; 2],
    programs: [PathBuf; 2],
    prefix: bool,
) -> PyResult<(Option<String>, Vec<String>)> {
    let [a, b] = folders;
    let [program_a, program_b] = programs;
    let sides = [(a, program_a), (b, program_b)];
    let sides = sides.map(|(folder, program)| bitgrain::bisect::Side { folder, program });
    let mut lines = Vec::new();
    let told = &mut lines;
    // Its programs hear of Ctrl-C by themselves, and end.
    let found = interruptible(py, &Progress::new(false), || {
        bitgrain::bisect::bisect(&sides, prefix, |line| {
            told.push(line.to_string());
            Ok(())
        })
    })?;
    let text = found.map(|found| {
        json!({
            "stage": found.stage,
            "equal": found.equal,
            "step": found.step,
            "parts": found.parts,
            "number": found.number.as_ref().map(ToString::to_string),
            "contact": found.contact,
            "text": found.to_string(),
        })
        .to_string()
    });
    Ok((text, lines))
}

/// What is in the folder of a run or of a campaign, as JSON: kind, closing hash, files; of a run its summary.
#[pyfunction]
pub fn check(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    let found = py.detach(|| {
        let of = if campaign_at(&folder)? { FolderKind::Campaign } else { FolderKind::Run };
        let vouched = Vouched::open(&folder, of)?;
        let summary = match of {
            FolderKind::Run => {
                let (_, summary) = read_folder(&Folder(&folder), &vouched)?;
                Some(serde_json::to_value(summary).map_err(|e| Error::Output(e.into()))?)
            }
            FolderKind::Campaign => None,
        };
        let manifest = vouched.manifest;
        let files: Vec<&str> = manifest.files.iter().map(|file| &file.path[..]).collect();
        let found = json!({
            "kind": of.word(), "closing": manifest.closing, "finished": manifest.finished, "files": files,
            "summary": summary,
        });
        Ok(found.to_string())
    });
    found.map_err(|error: Error| laboratory(&error))
}

/// The text of a file of a run or campaign, if it is as its manifest says.
#[pyfunction]
pub fn text(py: Python<'_>, folder: PathBuf, name: &str) -> PyResult<String> {
    let text = py.detach(|| {
        let of = if campaign_at(&folder)? {
            FolderKind::Campaign
        } else {
            FolderKind::Run
        };
        Vouched::open(&folder, of)?.text(&folder.join(name))
    });
    text.map_err(|error| laboratory(&error))
}

/// Runs the command with these words, the first of which is its name; `this` is the program that does its work again.
/// Returns the exit status.
#[pyfunction]
pub fn command(py: Python<'_>, words: Vec<OsString>, this: Option<PathBuf>) -> PyResult<u8> {
    // Python looks for signals between its own instructions alone; the command has its own handler.
    let this = this
        .map_or_else(std::env::current_exe, Ok)
        .map_err(|e| PyOSError::new_err(e.to_string()))?;
    Ok(py.detach(|| cli::main_of(words, &cli::own_beds(), &this)))
}
