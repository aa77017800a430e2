//! The run directory: where everything of a run is.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::files::{bits, clear_partials, make_folder, read_text, write_whole};
use crate::scenario::{self, Scenario};

/// A run directory.
#[derive(Clone, Copy, Debug)]
pub struct Folder<'a>(pub &'a Path);

/// A run directory that is this process's as long as this lives.
#[derive(Debug)]
pub struct Claim {
    locks: Vec<File>,
    /// Whether the file system could lock: else another run may be at work.
    pub sure: bool,
}

impl Claim {
    /// Takes a folder whose `file` says what it is for, and which `settle` writes or refuses.
    ///
    /// # Errors
    /// [`Error::Input`] where another process is at work in it, what `settle` returns, [`Error::Write`].
    pub fn take(folder: &Path, file: &Path, settle: impl FnOnce() -> Result<()>) -> Result<Self> {
        make_folder(folder)?;
        let mut claim = Claim {
            locks: Vec::new(),
            sure: false,
        };
        // Before anything is written: what another process wrote is not to be replaced. The folder holds
        // where its file is replaced, and the file where a network file system cannot lock folders.
        claim.lock(folder, File::open(folder))?;
        let open = || File::options().append(true).open(file);
        let held = claim.locks.len();
        if file.exists() {
            claim.lock(folder, open())?;
        }
        settle()?;
        // It may be another file now; a second lock on the same one would wait for the first.
        claim.locks.truncate(held);
        claim.lock(folder, open())?;
        Ok(claim)
    }

    fn lock(&mut self, folder: &Path, opened: std::io::Result<File>) -> Result<()> {
        let held = self.locks.len();
        let locked = opened.map(|file| (file.try_lock(), file));
        match locked {
            Ok((Ok(()), file)) => self.locks.push(file),
            Ok((Err(TryLockError::WouldBlock), _)) => {
                return Err(Error::input(
                    folder.display().to_string(),
                    "another run is under way in it; wait for that, or choose another --out",
                ));
            }
            _ => {}
        }
        self.sure = self.locks.len() > held;
        Ok(())
    }
}

impl Folder<'_> {
    /// The scenario with every default written out.
    pub fn scenario(&self) -> PathBuf {
        self.0.join("scenario.toml")
    }

    /// The checkpoint of a settled bed.
    pub fn bed(&self, bed: &str) -> PathBuf {
        self.0.join("beds").join(format!("{bed}.safetensors"))
    }

    /// The checkpoint of a bed that is not yet settled.
    pub fn pouring(&self, bed: &str) -> PathBuf {
        self.0
            .join("beds")
            .join(format!("{bed}.pouring.safetensors"))
    }

    /// The chain of digests of a bed.
    pub fn bed_chain(&self, bed: &str) -> PathBuf {
        self.0.join("beds").join(format!("{bed}.chain.csv"))
    }

    /// The bed as a LAMMPS data file.
    pub fn bed_data(&self, bed: &str) -> PathBuf {
        self.0.join("beds").join(format!("{bed}.data"))
    }

    /// A file of one drag.
    pub fn of_run(&self, run: &str, file: &str) -> PathBuf {
        self.0.join("runs").join(run).join(file)
    }

    /// The force series of a drag.
    pub fn series(&self, run: &str) -> PathBuf {
        self.of_run(run, "forces.csv")
    }

    /// The force series of a drag that was stopped or went wrong.
    pub fn partial_series(&self, run: &str) -> PathBuf {
        self.of_run(run, "forces.partial.csv")
    }

    /// The chain of digests of a drag.
    pub fn chain(&self, run: &str) -> PathBuf {
        self.of_run(run, "chain.csv")
    }

    /// A checkpoint that is kept of a drag.
    pub fn checkpoint(&self, run: &str, step: u64) -> PathBuf {
        self.of_run(run, &format!("checkpoints/{step:012}.safetensors"))
    }

    /// The checkpoint that a drag goes on from where it is stopped; gone when it has come to its end.
    pub fn latest(&self, run: &str) -> PathBuf {
        self.of_run(run, "latest.safetensors")
    }

    /// A snapshot of a drag: `kind` is `grains` or `contacts`. The number keeps files in order and
    /// makes one animation of them in OVITO and ParaView.
    pub fn snapshot(&self, run: &str, kind: &str, step: u64, ending: &str) -> PathBuf {
        self.of_run(run, &format!("snapshots/{kind}.{step:012}.{ending}"))
    }

    /// All numbers.
    pub fn summary(&self) -> PathBuf {
        self.0.join("summary.json")
    }

    /// The report.
    pub fn report(&self) -> PathBuf {
        self.0.join("report.html")
    }

    /// Timings and other facts of the machine.
    pub fn performance(&self) -> PathBuf {
        self.0.join("performance.json")
    }

    /// Takes the folder for this scenario: a new one, or one that holds the same scenario. The file of
    /// an imported bed is copied into it, so that the folder stands alone.
    ///
    /// # Errors
    /// [`Error::Input`] where it holds another scenario's results or another run is at work in it,
    /// [`Error::Write`].
    pub fn claim(&self, scenario: &Scenario) -> Result<Claim> {
        let inputs = self.inputs(scenario);
        let claim = Claim::take(self.0, &self.scenario(), || {
            self.claim_text(&format!("# {}\n{}", bits(), inputs.to_toml()))
        })?;
        if claim.sure {
            // What a killed process was writing; nobody else writes here now.
            clear_partials(self.0);
        }
        if let (Some(source), Some(file)) = (&scenario.source, &inputs.bed.file) {
            let copy = self.0.join(file);
            if copy != *source {
                let bytes = std::fs::read(source).map_err(|e| Error::read(source, &e))?;
                write_whole(&copy, &bytes)?;
            }
        }
        Ok(claim)
    }

    /// The scenario of the run that this folder holds.
    ///
    /// # Errors
    /// [`Error::Input`] where it holds none, a wrong one, or one of another arithmetic.
    pub fn saved_scenario(&self) -> Result<Scenario> {
        let path = self.scenario();
        let place = || path.display().to_string();
        if !path.exists() {
            return Err(Error::input(
                place(),
                "is not there: the folder holds no run that could go on",
            ));
        }
        let text = read_text(&path)?;
        let made = text.lines().next().unwrap_or_default();
        if made != format!("# {}", bits()) {
            let made = made.trim_start_matches("# ");
            return Err(Error::input(
                place(),
                format!(
                    "begins with `{made}`, and this program has {}: go on with the program that began \
                     the run, or choose another folder",
                    bits()
                ),
            ));
        }
        scenario::load(&place(), &[])
    }

    /// The scenario as this folder holds it: the file of an imported bed lies in it.
    pub fn inputs(&self, scenario: &Scenario) -> Scenario {
        let mut inputs = scenario.clone();
        if let Some(source) = inputs.source.take() {
            let name = source.file_name().unwrap_or_default();
            inputs.bed.file = Some(format!("beds/imported/{}", name.to_string_lossy()));
        }
        inputs
    }

    fn has_results(&self) -> bool {
        let kinds = ["beds", "runs", "summary.json"];
        kinds.iter().any(|kind| self.0.join(kind).exists())
    }

    fn claim_text(&self, text: &str) -> Result<()> {
        let path = self.scenario();
        match std::fs::read_to_string(&path) {
            // A run that ended before it had any result binds nobody.
            Ok(old) if old != text && !self.has_results() => write_whole(&path, text.as_bytes()),
            Ok(old) if old != text => Err(Error::input(
                self.0.display().to_string(),
                "holds the results of another scenario (its scenario.toml differs); choose another \
                 --out or remove the folder",
            )),
            Ok(_) => Ok(()),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                write_whole(&path, text.as_bytes())
            }
            Err(e) => Err(Error::write(&path, e)),
        }
    }
}
