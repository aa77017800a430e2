//! The run directory: where everything of a run is, and which process owns it during a run.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use crate::beside::{ANALYSIS, PERFORMANCE, REPORT, refuse_foreign};
pub(crate) use crate::manifest::FAILURE;
use crate::manifest::{self, FolderKind, Ledger, Manifest};
use crate::progress::Progress;
use crate::scenario::{self, BedFile, CheckedScenario};
use bitgrain_sim::below::Below;
use bitgrain_sim::checkpoint::{self, StageState};
use bitgrain_sim::disk::{self, Kind, make_folder};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::{bits, read_text};
use bitgrain_sim::simulation::Simulation;

/// A run directory.
#[derive(Clone, Copy, Debug)]
pub struct Folder<'a>(pub &'a Path);

/// What a folder is for: how it is recognised, and which names are used in it.
pub struct Contents {
    pub(crate) of: FolderKind,
    /// The text of a marker as it is written that says what these bytes do, if they say something.
    pub(crate) as_made: fn(&[u8]) -> Option<String>,
    /// Names of files that may be written directly below it.
    pub(crate) files: &'static [&'static str],
    /// Names of folders that may be made there.
    pub(crate) folders: &'static [&'static str],
}

/// What a run directory holds.
pub(crate) const RUN: Contents = Contents {
    of: FolderKind::Run,
    as_made: scenario::as_made,
    files: &[
        "scenario.toml",
        manifest::NAME,
        "summary.json",
        REPORT,
        PERFORMANCE,
        ANALYSIS,
    ],
    folders: &["beds", "runs", SUBMITTED],
};

/// The folder with the job scripts that were submitted: of the machine, not of the results.
pub const SUBMITTED: &str = "slurm";

/// A folder that this process owns as long as this value lives, and its manifest.
#[derive(Debug)]
pub struct DirectoryLock {
    _locks: Vec<File>,
    /// Whether the file system could lock: else another run may be at work.
    pub sure: bool,
    /// The manifest in progress.
    pub ledger: Ledger,
    damage: Option<Error>,
}

impl DirectoryLock {
    /// Takes a folder for the stages of a run or campaign. `settle` checks what lies in it and writes the
    /// marker, or refuses; before it nothing is written.
    ///
    /// # Errors
    /// [`Error::Input`] if the folder is not ours, or another process is at work in it; what `settle`
    /// returns; [`Error::Write`].
    pub(crate) fn take(
        folder: &Path,
        contents: &Contents,
        stages: &[String],
        settle: impl FnOnce(&Ledger) -> Result<()>,
    ) -> Result<Self> {
        Self::try_take(folder, contents, stages, settle)?.ok_or_else(|| at_work(folder))
    }

    /// The same; `None` if another process is at work in it.
    ///
    /// # Errors
    /// As [`DirectoryLock::take`], but for that.
    pub(crate) fn try_take(
        folder: &Path,
        contents: &Contents,
        stages: &[String],
        settle: impl FnOnce(&Ledger) -> Result<()>,
    ) -> Result<Option<Self>> {
        refuse_others(folder, contents)?;
        make_folder(folder)?;
        // Before anything is written: what another process wrote is not to be replaced.
        let Some(mut held) = hold(folder, contents) else {
            return Ok(None);
        };
        let (ledger, damage) = Ledger::open(folder, contents.of, stages)?;
        settle(&ledger)?;
        // It may be another file now; a second lock on the same one would wait for the first.
        held.marker = None;
        let Some(marker) = lock(disk::open_to_lock(&folder.join(contents.of.marker()))) else {
            return Ok(None);
        };
        Ok(Some(Self {
            sure: marker.is_some(),
            _locks: held.folder.into_iter().chain(marker).collect(),
            ledger,
            damage,
        }))
    }

    /// Warns of what was wrong with the manifest that was there.
    pub fn warn_of_damage(&self, progress: &Progress) {
        if let Some(damage) = &self.damage {
            progress.warn(&format!(
                "{damage}; what it vouched for counts as missing now"
            ));
        }
    }
}

/// What a process is told that wants a folder in which another is at work.
pub(crate) fn at_work(folder: &Path) -> Error {
    let problem = "another run is at work in it; wait for it to end, or choose another --out";
    Error::input(folder.display().to_string(), problem)
}

/// The locks of a folder, as far as its file system can lock.
pub(crate) struct Held {
    folder: Option<File>,
    marker: Option<File>,
}

impl Held {
    /// Whether no other process can be at work in the folder.
    pub(crate) fn is_sure(&self) -> bool {
        self.folder.is_some() || self.marker.is_some()
    }
}

/// Locks a folder and its marker, and reads and writes nothing; `None` if another process has. The lock of the folder
/// holds if its marker is replaced, that of the marker if a network file system cannot lock folders.
pub(crate) fn hold(folder: &Path, contents: &Contents) -> Option<Held> {
    let marker = folder.join(contents.of.marker());
    let folder = lock(disk::open_folder(folder))?;
    let marker = match disk::kind(&marker) {
        Some(Kind::File) => lock(disk::open_to_lock(&marker))?,
        _ => None,
    };
    Some(Held { folder, marker })
}

/// A lock, or none if the file system has no locks; `None` if another process has it.
fn lock(opened: std::io::Result<File>) -> Option<Option<File>> {
    match opened.map(|file| (file.try_lock(), file)) {
        Ok((Ok(()), file)) => Some(Some(file)),
        Ok((Err(TryLockError::WouldBlock), _)) => None,
        _ => Some(None),
    }
}

/// Refuses a folder that a user names, by whatever path, within the results of a run or campaign, where every file is
/// taken for one of them. A member or task that is there already is a run of its own.
///
/// # Errors
/// [`Error::Input`].
pub fn refuse_among_results(folder: &Path) -> Result<()> {
    let full = disk::resolved(folder)?;
    let within = |of: FolderKind| {
        let mut above = full.ancestors().skip(1);
        above.find(|above| is_among(&full, above, of) && is_of(above, of))
    };
    if let Some(above) = within(FolderKind::Run) {
        return Err(among(folder, above, FolderKind::Run));
    }
    match within(FolderKind::Campaign) {
        Some(above) if !is_of(&full, FolderKind::Run) => {
            Err(among(folder, above, FolderKind::Campaign))
        }
        _ => Ok(()),
    }
}

/// Refuses a library of beds within the results of a run or campaign, also of that which is to be in `out`.
///
/// # Errors
/// [`Error::Input`].
pub(crate) fn refuse_library(library: &Path, out: &Path, of: FolderKind) -> Result<()> {
    refuse_among_results(library)?;
    match is_among(&disk::resolved(library)?, &disk::resolved(out)?, of) {
        true => Err(among(library, out, of)),
        false => Ok(()),
    }
}

/// Whether a path, resolved as `above` is, lies where a folder of this kind has its results.
fn is_among(full: &Path, above: &Path, of: FolderKind) -> bool {
    let mut places = of.places().into_iter();
    places.any(|own| full.starts_with(above.join(own)))
}

fn among(path: &Path, above: &Path, of: FolderKind) -> Error {
    let problem = format!(
        "lies among the results of the {} in {}; choose another folder (--out, --beds)",
        of.word(),
        above.display()
    );
    Error::input(path.display().to_string(), problem)
}

/// Refuses a folder that is not of this kind and holds a name that would be written.
pub(crate) fn refuse_others(folder: &Path, contents: &Contents) -> Result<()> {
    let place = || folder.display().to_string();
    if is_of(folder, contents.of) {
        return refuse_other_kinds(folder, contents);
    }
    let taken = |name: &&&str| disk::is_there(&folder.join(name));
    match contents.files.iter().chain(contents.folders).find(taken) {
        None => Ok(()),
        // Another process of the same campaign has made it meanwhile.
        Some(_) if is_of(folder, contents.of) => Ok(()),
        Some(name) => {
            let kind = contents.of.word();
            let problem = format!(
                "holds `{name}`, which a {kind} would write, and is not the folder of a {kind}: choose another \
                 --out, or move it away"
            );
            Err(Error::input(place(), problem))
        }
    }
}

/// Refuses a folder of ours with something of another kind, a page or facts of others, or a marker that somebody wrote,
/// in the place of what is written directly below it.
fn refuse_other_kinds(folder: &Path, contents: &Contents) -> Result<()> {
    for name in contents.folders {
        Below(folder).check_folder(&folder.join(name))?;
    }
    for name in contents.files {
        Below(folder).check_file(&folder.join(name))?;
        refuse_foreign(&folder.join(name))?;
    }
    let name = contents.of.marker();
    let marker = folder.join(name);
    let Some(text) = disk::read_if_there(&marker)? else {
        return Ok(());
    };
    let manifest = Manifest::of(folder).ok().flatten();
    let entry = manifest.as_ref().and_then(|it| it.entry(name));
    let said = String::from_utf8_lossy(&text);
    let same = |made: String| said.split_whitespace().eq(made.split_whitespace());
    if entry.is_some_and(|entry| entry.is_of(&text)) || (contents.as_made)(&text).is_some_and(same)
    {
        return Ok(());
    }
    let problem = "would be replaced, and is neither as bitgrain writes it nor as the manifest lists it: move it away \
                   or give it another name, or choose another --out";
    Err(Error::input(marker.display().to_string(), problem))
}

/// Whether a folder is one of a run or campaign.
pub(crate) fn has_run(folder: &Path) -> bool {
    is_of(folder, FolderKind::Run) || is_of(folder, FolderKind::Campaign)
}

/// Whether a folder is one of this kind, by its marker or its manifest.
pub fn is_of(folder: &Path, of: FolderKind) -> bool {
    let marker = folder.join(of.marker());
    let marked = || {
        let text = disk::read(&marker).ok()?;
        Some(text.starts_with(b"# BITS_VERSION "))
    };
    disk::kind(&marker) == Some(Kind::File) && marked() == Some(true)
        || Manifest::of(folder).is_ok_and(|found| found.is_some_and(|one| one.of == of))
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

    /// The force series of a drag that was stopped or failed.
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

    /// The frames of a drag up to a checkpoint that is kept, from the one before it on.
    pub fn frames(&self, run: &str, step: u64) -> PathBuf {
        self.of_run(run, &format!("frames/{step:012}.csv"))
    }

    /// The checkpoint from which a stopped drag goes on; gone when the drag is finished.
    pub fn latest(&self, run: &str) -> PathBuf {
        self.of_run(run, "latest.safetensors")
    }

    /// A snapshot of a drag: `kind` is `grains`, `contacts` or `bodies`. The number keeps files in order and
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
        self.0.join(REPORT)
    }

    /// Timings and other facts of the machine.
    pub fn performance(&self) -> PathBuf {
        self.0.join(PERFORMANCE)
    }

    /// The scenario of the run that this folder holds.
    ///
    /// # Errors
    /// [`Error::Input`] if it holds none, an invalid one, or one of another arithmetic.
    pub fn saved_scenario(&self) -> Result<CheckedScenario> {
        let path = self.scenario();
        let place = || path.display().to_string();
        if !disk::is_there(&path) {
            return Err(Error::input(
                place(),
                "is missing: the folder holds no run that could go on",
            ));
        }
        Below(self.0).check_file(&path)?;
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
        self.parse_saved(&text)
    }

    /// A state that lies in it, and what its checkpoint holds besides.
    ///
    /// # Errors
    /// As [`checkpoint::read_noted`]; [`Error::Input`] if the way there leads through a link.
    pub(crate) fn state(&self, path: &Path) -> Result<(Simulation, StageState)> {
        Below(self.0).check_file(path)?;
        checkpoint::read_noted(path)
    }

    /// Reads the text of a scenario that lies in this folder, and no file elsewhere that it names.
    ///
    /// # Errors
    /// [`Error::Input`] if it is none, or the folder has no copy of the file of its bed.
    pub(crate) fn parse_saved(&self, text: &str) -> Result<CheckedScenario> {
        let place = self.scenario().display().to_string();
        scenario::parse_from(text, &place, &[], BedFile::CopiedIn(self.0))
    }

    /// The scenario as this folder holds it: the file of an imported bed lies in it.
    pub fn inputs(&self, scenario: &CheckedScenario) -> CheckedScenario {
        let Some(source) = &scenario.source else {
            return scenario.clone();
        };
        let name = source.file_name().unwrap_or_default();
        scenario.with_bed_file(format!("beds/imported/{}", name.to_string_lossy()))
    }

    /// Where states to go on from are saved, which no manifest lists.
    pub(crate) fn states(&self, scenario: &CheckedScenario) -> Vec<PathBuf> {
        let beds = scenario.all_beds().into_iter();
        let beds = beds.map(|bed| self.pouring(&bed.name));
        let drags = scenario.drags().iter();
        beds.chain(drags.map(|drag| self.latest(&drag.name)))
            .collect()
    }

    /// Whether anything was made in it.
    pub fn has_results(&self) -> bool {
        let kinds = ["beds", "runs", "summary.json"];
        kinds.iter().any(|kind| disk::is_there(&self.0.join(kind)))
    }

    /// The text of `scenario.toml` of a run of this scenario.
    pub fn scenario_text(&self, scenario: &CheckedScenario) -> String {
        format!("# {}\n{}", bits(), self.inputs(scenario).to_toml())
    }

    /// The folders that files of a run are written to.
    pub fn own_folders(&self, scenario: &CheckedScenario) -> Vec<PathBuf> {
        let mut own = vec![
            self.0.to_path_buf(),
            self.0.join("beds"),
            self.0.join("beds/imported"),
        ];
        for run in scenario.drags() {
            let runs = ["forces.csv", "checkpoints/0", "snapshots/0", "frames/0"];
            let files = runs.map(|file| self.of_run(&run.name, file));
            own.extend(
                files
                    .iter()
                    .filter_map(|file| file.parent().map(Path::to_path_buf)),
            );
        }
        own
    }
}
