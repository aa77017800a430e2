//! A run directory that this process owns: its content is compared with the scenario before anything is
//! written.

use std::path::{Path, PathBuf};

use super::files::{names, stages};
use crate::bed::PouringState;
use crate::bed::recipe::Recipe;
use crate::changes;
use crate::drag::Dragging;
use crate::folder::{DirectoryLock, Folder, RUN, at_work, refuse_among_results, refuse_others};
use crate::manifest::{FolderKind, Ledger, Manifest, When, is_marked, relative};
use crate::scenario::{BedPlan, CheckedScenario, Scenario};
use crate::summary::{DragRecord, Summary};
use bitgrain_sim::below::Below;
use bitgrain_sim::chain;
use bitgrain_sim::checkpoint::{self, StageState};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

/// Takes the folder for this scenario: a new one, or one that holds the same scenario. The file of an imported
/// bed is copied into it, so that the folder stands alone.
///
/// # Errors
/// [`Error::Input`] if it is not ours, holds another scenario's results, lies among those of another run or campaign,
/// or another run is at work in it; [`Error::Write`].
pub fn claim(folder: &Folder<'_>, scenario: &CheckedScenario) -> Result<DirectoryLock> {
    refuse_among_results(folder.0)?;
    try_claim(folder, scenario)?.ok_or_else(|| at_work(folder.0))
}

/// The same of a member or task of a campaign that has this place for it; `None` if another run is at work in it.
///
/// # Errors
/// As [`claim`], but for that.
pub(crate) fn try_claim(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
) -> Result<Option<DirectoryLock>> {
    let claim = DirectoryLock::try_take(folder.0, &RUN, &stages(scenario), |ledger| {
        survey(folder, scenario, ledger)?;
        let text = folder.scenario_text(scenario);
        ledger.write(&folder.scenario(), text.as_bytes())
    })?;
    let Some(claim) = claim else {
        return Ok(None);
    };
    if claim.sure {
        // Left by a killed process; nobody else writes here now.
        for own in folder.own_folders(scenario) {
            Below(folder.0).clear_partials(&own, |_| true);
        }
    }
    let inputs = folder.inputs(scenario);
    if let (Some(source), Some(file)) = (&scenario.source, &inputs.bed.file) {
        let copy = folder.0.join(file);
        if copy != *source {
            claim.ledger.write(&copy, &disk::read(source)?)?;
        } else if !claim.ledger.lists(&copy) {
            claim.ledger.write(&copy, &disk::read(&copy)?)?;
        }
    }
    claim.ledger.save()?;
    Ok(Some(claim))
}

/// Refuses a folder in which anything is of another scenario, or something of others has a place of this one.
fn survey(folder: &Folder<'_>, scenario: &CheckedScenario, ledger: &Ledger) -> Result<()> {
    refuse_other_kinds(folder, scenario)?;
    refuse_other_scenario(folder, scenario, ledger)?;
    let below = Below(folder.0);
    let each = Looking { below, ledger };
    for plan in scenario.all_beds() {
        let begins = match &scenario.bed.hash {
            Some(hash) if scenario.source.is_some() => Some(chain::beginning(hash)),
            _ => None,
        };
        for path in [folder.bed(&plan.name), folder.pouring(&plan.name)] {
            each.state(&path, |note| {
                is_bed(note, scenario, plan, begins.as_deref())
            })?;
        }
    }
    let inputs = folder.inputs(scenario);
    for plan in scenario.drags() {
        let key = scenario.key(&plan.name);
        let kept = plan.checkpoints.iter();
        let kept = kept.map(|&step| folder.checkpoint(&plan.name, step));
        for path in kept.chain([folder.latest(&plan.name)]) {
            each.state(&path, |note| Dragging::of(note).map(|drag| drag.key == key))?;
        }
        each.summary::<DragRecord<Scenario>>(
            &folder.of_run(&plan.name, "summary.json"),
            |record| record.inputs == *inputs,
        )?;
    }
    each.summary::<Summary<Scenario>>(&folder.summary(), |whole| whole.inputs == *inputs)?;
    for path in result_places(folder, scenario) {
        ledger.refuse_foreign(&path)?;
    }
    Ok(())
}

/// Paths of all results that a run may write, but for its scenario and for an imported bed that was taken from here.
fn result_places(folder: &Folder<'_>, scenario: &CheckedScenario) -> Vec<PathBuf> {
    let results = names(scenario).into_iter();
    let results = results.filter(|(_, when)| *when != When::Beside);
    let places = results.map(|(name, _)| folder.0.join(name));
    let known =
        |path: &PathBuf| *path == folder.scenario() || scenario.source.as_ref() == Some(path);
    places.filter(|path| !known(path)).collect()
}

/// Refuses a folder of a run in which a link or another kind of thing has a place of this scenario.
///
/// # Errors
/// [`Error::Input`].
pub(crate) fn refuse_other_kinds(folder: &Folder<'_>, scenario: &CheckedScenario) -> Result<()> {
    let below = Below(folder.0);
    for own in folder.own_folders(scenario) {
        below.check_folder(&own)?;
    }
    for name in names(scenario).keys() {
        below.check_file(&folder.0.join(name))?;
    }
    Ok(())
}

/// Refuses a folder of a run, whose kinds were looked at, in which a file of others has the name of a result or of a
/// state. What is listed is not read, and nothing is written: for a campaign, before it writes into any of its members.
///
/// # Errors
/// [`Error::Input`].
pub(crate) fn refuse_foreign_names(folder: &Folder<'_>, scenario: &CheckedScenario) -> Result<()> {
    refuse_others(folder.0, &RUN)?;
    let manifest = Manifest::of(folder.0).ok().flatten();
    let listed = |path: &Path| {
        let name = relative(folder.0, path).unwrap_or_default();
        manifest
            .as_ref()
            .is_some_and(|own| own.entry(&name).is_some())
    };
    let is_ours = |path: &Path| {
        let name = relative(folder.0, path).unwrap_or_default();
        disk::read(path).map(|bytes| is_marked(&name, &bytes))
    };
    for path in result_places(folder, scenario) {
        if disk::is_there(&path) && !listed(&path) {
            // Where the manifest was lost, what bears the mark of a result is one.
            if manifest.is_some() || !is_ours(&path)? {
                return Err(FolderKind::Run.foreign(&path));
            }
        }
    }
    for path in folder.states(scenario) {
        if disk::is_there(&path) && !is_ours(&path)? {
            return Err(FolderKind::Run.foreign(&path));
        }
    }
    Ok(())
}

/// Whether a state is one of this bed: by its recipe, or by the file it was imported from.
fn is_bed(
    note: &StageState,
    scenario: &CheckedScenario,
    plan: &BedPlan,
    begins: Option<&str>,
) -> std::result::Result<bool, String> {
    let course = PouringState::of(note)?;
    Ok(match begins {
        Some(begins) => course.chain().begins == begins,
        None => course.is_by(&Recipe::new(scenario, plan)),
    })
}

fn refuse_other_scenario(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
    ledger: &Ledger,
) -> Result<()> {
    let path = folder.scenario();
    let text = folder.scenario_text(scenario);
    let known = ledger.expects(&path, text.as_bytes());
    if known == Some(true) || !folder.has_results() {
        // A run that ended before it had any result does not count.
        return Ok(());
    }
    let old = match disk::kind(&path) {
        Some(_) => disk::read(&path)?,
        None => Vec::new(),
    };
    let old = String::from_utf8_lossy(&old).into_owned();
    let same_file = old == text || same_scenario(folder, &old, scenario);
    if known.is_none() && (old.is_empty() || same_file) {
        return Ok(());
    }
    let place = folder.0.display().to_string();
    if same_file {
        let problem = "holds the results of another scenario: its scenario.toml was changed since the run \
                       began. Restore it, choose another --out, or remove the folder";
        return Err(Error::input(place, problem));
    }
    Err(Error::input(
        place,
        format!(
            "holds the results of another scenario (its scenario.toml differs):\n{}\nchange it back, choose \
             another --out, or remove the folder",
            changes::list(&old, &text)
        ),
    ))
}

/// Whether the text of a folder's scenario means the same with other spaces or comments.
fn same_scenario(folder: &Folder<'_>, text: &str, scenario: &CheckedScenario) -> bool {
    let read = folder.parse_saved(text);
    read.is_ok_and(|read| folder.inputs(&read) == folder.inputs(scenario))
}

/// Checks the files that the manifest does not vouch for.
struct Looking<'a> {
    below: Below<'a>,
    ledger: &'a Ledger,
}

impl Looking<'_> {
    /// The bytes of a file that is to be checked; `None` if it is vouched for, or is not there.
    fn bytes(&self, path: &Path) -> Result<Option<Vec<u8>>> {
        if self.ledger.vouches(path) {
            return Ok(None);
        }
        self.below.check_file(path)?;
        disk::read_if_there(path)
    }

    /// A checkpoint, which must be what `belongs` says if it is whole; a damaged one is made again.
    fn state(
        &self,
        path: &Path,
        belongs: impl FnOnce(&StageState) -> std::result::Result<bool, String>,
    ) -> Result<()> {
        let Some(bytes) = self.bytes(path)? else {
            return Ok(());
        };
        let place = path.display().to_string();
        let note = match checkpoint::note(&bytes, &place) {
            Err(Error::Damaged { .. }) if checkpoint::begins(&bytes) => return Ok(()),
            Err(Error::Damaged { .. }) => {
                let problem = "has the name of a state that the run saves, and is none: it is not replaced; move it \
                               away, or choose another folder";
                return Err(Error::input(place, problem));
            }
            note => note?,
        };
        match belongs(&note) {
            Ok(false) => Err(of_others(place)),
            // Without its course it cannot be continued, and is made again.
            Ok(true) | Err(_) => Ok(()),
        }
    }

    /// A summary, which must be what `belongs` says if it can be read; else it is made again.
    fn summary<T: serde::de::DeserializeOwned>(
        &self,
        path: &Path,
        belongs: impl FnOnce(&T) -> bool,
    ) -> Result<()> {
        let Some(bytes) = self.bytes(path)? else {
            return Ok(());
        };
        match serde_json::from_slice(&bytes) {
            Ok(found) if !belongs(&found) => Err(of_others(path.display().to_string())),
            _ => Ok(()),
        }
    }
}

fn of_others(place: String) -> Error {
    let problem = "was saved by a run of another scenario or stage: was scenario.toml changed since? Restore it, \
                   choose another folder, or remove this file so that it is made again";
    Error::input(place, problem)
}
