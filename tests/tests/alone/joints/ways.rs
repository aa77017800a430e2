//! A scenario with its choices made: asked for, run undisturbed, run in pieces, verified.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

use bitgrain::bed::library::BedCache;
use bitgrain::campaign::folder::CampaignFolder;
use bitgrain::campaign::only::Only;
use bitgrain::campaign::plan::{self, Plan};
use bitgrain::campaign::sweep::{Sweep, sweep};
use bitgrain::campaign::tasks::{Ended, Worker, missing, perform};
use bitgrain::campaign::verify as campaigns;
use bitgrain::disk::{self, Call, CallOutcome, Watch};
use bitgrain::error::{Error, Result};
use bitgrain::folder::Folder;
use bitgrain::present::write_report;
use bitgrain::progress::Progress;
use bitgrain::rerun::RunArchive;
use bitgrain::run::{SaveEvery, Setting, run_in};
use bitgrain::scenario::{self, CheckedScenario};
use bitgrain::verify::{Scope, verify};
use bitgrain_tests::{assert_named, differing, results};
use toml::{Table, Value};

use super::options::{self, Choice, NO_FRAMES, ONLY, SWEEP};

/// What was asked for and not refused.
pub struct Asked {
    what: What,
    frames: bool,
    only: bool,
}

enum What {
    Run(Box<CheckedScenario>),
    Campaign(Box<Plan>),
}

/// The name of the file that choices of a bed's file name.
const FILE: &str = "bed.data";

/// A folder in which such a file lies: the bed of the scenario without any choice.
static DESK: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let desk = tempfile::tempdir().unwrap();
    let text = toml::to_string(&options::scenario(&[])).unwrap();
    let plain = scenario::parse(&text, "joint.toml", &[], Path::new("")).unwrap();
    let asked = Asked {
        what: What::Run(Box::new(plain)),
        frames: false,
        only: false,
    };
    let room = tempfile::tempdir().unwrap();
    let library = BedCache::new(room.path().join("beds"));
    let out = room.path().join("out");
    asked.go(&out, &library, 1, &Progress::new(false)).unwrap();
    std::fs::copy(out.join("beds/bed.data"), desk.path().join(FILE)).unwrap();
    desk
});

/// Checks a scenario with these choices as the command does before it writes anything.
pub fn ask(choices: &[&Choice]) -> std::result::Result<Asked, String> {
    let has = |name: &str| choices.iter().any(|choice| choice.name == name);
    let table = options::scenario(choices);
    let asked = match has(SWEEP) {
        true => campaign(table).map(|plan| What::Campaign(Box::new(plan))),
        false => {
            let text = toml::to_string(&table).unwrap();
            scenario::parse(&text, "joint.toml", &[], DESK.path()).map(|s| What::Run(Box::new(s)))
        }
    };
    match asked {
        Ok(what) => Ok(Asked {
            what,
            frames: !has(NO_FRAMES),
            only: has(ONLY),
        }),
        Err(error) => {
            assert_eq!(error.exit_status(), 2, "{error}");
            let folder = format!("{}/", DESK.path().display());
            let told = error.to_string().replace(&folder, "");
            // Without the name of the file, but with that of the key.
            let key = ["joint.toml: ", "joints.toml: member `one`: "];
            let key = key.iter().find_map(|place| told.strip_prefix(place));
            Err(key.map_or(told.clone(), |key| key.replacen("`: ", "` ", 1)))
        }
    }
}

/// A campaign of one member, which the scenario is.
fn campaign(base: Table) -> Result<Plan> {
    let grid = Table::from_iter([("name".to_string(), Value::from("one"))]);
    let file = Table::from_iter([
        ("name".to_string(), Value::from("joints")),
        ("base".to_string(), Value::Table(base)),
        ("grid".to_string(), Value::from(vec![grid])),
    ]);
    plan::parse(
        &toml::to_string(&file).unwrap(),
        "joints.toml",
        &[],
        DESK.path(),
    )
}

/// Steps between saves.
const OFTEN: u64 = 300;

impl Asked {
    /// How many drags it has.
    pub fn drags(&self) -> usize {
        match &self.what {
            What::Run(scenario) => scenario.drags().len(),
            What::Campaign(plan) => plan.members[0].scenario.drags().len(),
        }
    }

    /// Runs it, or what is left of it.
    fn go(
        &self,
        out: &Path,
        library: &BedCache,
        threads: usize,
        progress: &Progress,
    ) -> Result<()> {
        let save = SaveEvery::Steps(OFTEN);
        let plan = match &self.what {
            What::Campaign(plan) => plan,
            What::Run(scenario) => {
                let first = [scenario.drags()[0].name.clone()];
                let setting = Setting {
                    scenario,
                    folder: &Folder(out),
                    library,
                    threads,
                    save,
                    frames: self.frames,
                    only: &[],
                    write_report,
                    progress,
                };
                if self.only {
                    run_in(Setting {
                        only: &first,
                        ..setting
                    })?;
                }
                return run_in(setting).map(|_| ());
            }
        };
        let outcome = sweep(&Sweep {
            plan,
            only: &Only::default(),
            out,
            library,
            threads,
            jobs: threads,
            save,
            retry: false,
            merge: false,
            write_report,
            progress,
        })?;
        match outcome.failed + outcome.missing {
            0 => Ok(()),
            n => Err(Error::input("sweep", format!("{n} drags failed"))),
        }
    }

    /// The same in pieces: a campaign's tasks first.
    fn go_in_pieces(&self, out: &Path, library: &BedCache, progress: &Progress) -> Result<()> {
        if let What::Campaign(plan) = &self.what
            && !out.join("results.csv").exists()
        {
            let worker = Worker {
                plan,
                out,
                library,
                threads: 3,
                save: SaveEvery::Steps(OFTEN),
                retry: false,
                progress,
            };
            let left = missing(plan, &Only::default(), out, library, false)?;
            for task in left.beds.iter().chain(&left.drags) {
                let ended = perform(&worker, task)?;
                if !matches!(ended, Ended::Done | Ended::Already) {
                    return Err(Error::input(task, format!("{ended:?}")));
                }
            }
        }
        self.go(out, library, 3, progress)
    }

    /// Runs it as it comes, on one thread; then from nothing on three, interrupted in the midst of a bed and of a
    /// drag, which must end with the same bytes in every file; and verifies it. Returns how often it was interrupted.
    ///
    /// # Errors
    /// What went wrong, in a line.
    pub fn holds(&self, library: &BedCache) -> std::result::Result<usize, String> {
        let room = tempfile::tempdir().unwrap();
        let [whole, pieces] = ["whole", "pieces"].map(|name| room.path().join(name));
        let quiet = Progress::new(false);
        let told = |what: &'static str| move |error: Error| format!("{what}: {error}");
        self.go(&whole, library, 1, &quiet).map_err(told("run"))?;
        let own = BedCache::new(room.path().join("beds"));
        let mut stops = 0;
        for ending in PASSING {
            let progress = Progress::new(false);
            let stopper = Stopper {
                stop: progress.stop_flag(),
                ending,
                saves: AtomicUsize::new(0),
            };
            disk::watch(Some(Arc::new(stopper)));
            let ended = self.go_in_pieces(&pieces, &own, &progress);
            disk::watch(None);
            match ended {
                Ok(()) => {}
                Err(Error::Interrupted { .. }) => stops += 1,
                Err(error) => return Err(format!("run in pieces: {error}")),
            }
        }
        self.go_in_pieces(&pieces, &own, &quiet)
            .map_err(told("resume"))?;
        let wrong = differing(&results(&whole), &results(&pieces));
        if !wrong.is_empty() {
            return Err(format!(
                "{} differ after --resume on 3 threads",
                wrong.join(", ")
            ));
        }
        self.verify(&whole, &quiet).map_err(told("verify"))?;
        Ok(stops)
    }

    fn verify(&self, out: &Path, progress: &Progress) -> Result<()> {
        let all = Scope::default();
        let mut found = String::new();
        let mut say = |line: &str| {
            found = found.clone() + line + "; ";
            Ok(())
        };
        let verified = match &self.what {
            What::Campaign(_) => {
                campaigns::verify(&CampaignFolder(out), &all, &[], 1, progress, &mut say)
            }
            What::Run(_) => {
                assert_named(out);
                let folder = Folder(out);
                let archive = RunArchive::open(&folder)?;
                verify(&archive, &all, &[], 1, progress, &mut say)
            }
        };
        verified.map_err(|error| Error::input(error.to_string(), found))
    }
}

/// Endings of the files that only an unfinished bed or drag has.
const PASSING: [&str; 2] = [".pouring.safetensors", "latest.safetensors"];

/// Asks to stop as an unfinished stage is saved the second time.
struct Stopper {
    stop: Arc<AtomicBool>,
    ending: &'static str,
    saves: AtomicUsize,
}

impl Watch for Stopper {
    fn before(&self, call: &Call<'_>) -> CallOutcome {
        if let Call::Rename(_, to) = call
            && to.to_string_lossy().ends_with(self.ending)
            && self.saves.fetch_add(1, Ordering::Relaxed) == 1
        {
            self.stop.store(true, Ordering::Relaxed);
        }
        CallOutcome::Go
    }
}
