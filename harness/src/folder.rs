//! The run directory: where everything of a run is.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::files::{bits, make_folder, write_whole};
use crate::scenario::Scenario;

/// A run directory.
#[derive(Clone, Copy, Debug)]
pub struct Folder<'a>(pub &'a Path);

impl Folder<'_> {
    /// The scenario with every default written out.
    pub fn scenario(&self) -> PathBuf {
        self.0.join("scenario.toml")
    }

    /// The checkpoint of a settled bed.
    pub fn bed(&self, bed: &str) -> PathBuf {
        self.0.join("beds").join(format!("{bed}.safetensors"))
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
    ///
    /// It is this process's as long as the returned file lives.
    pub fn claim(&self, scenario: &Scenario) -> Result<File> {
        let inputs = self.inputs(scenario);
        self.claim_text(&format!("# {}\n{}", bits(), inputs.to_toml()))?;
        let path = self.scenario();
        let lock = File::open(&path).map_err(|e| Error::read(&path, &e))?;
        if matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) {
            return Err(Error::input(
                self.0.display().to_string(),
                "another run is under way in it; wait for that, or choose another --out",
            ));
        }
        if let (Some(source), Some(file)) = (&scenario.source, &inputs.bed.file) {
            let bytes = std::fs::read(source).map_err(|e| Error::read(source, &e))?;
            write_whole(&self.0.join(file), &bytes)?;
        }
        Ok(lock)
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
                make_folder(self.0)?;
                write_whole(&path, text.as_bytes())
            }
            Err(e) => Err(Error::write(&path, e)),
        }
    }
}
