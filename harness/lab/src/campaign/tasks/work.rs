//! A worker, which does one task of a campaign.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use super::ended::{Found, failure, look};
use super::names::{Stage, below, name_of, owner, parse};
use crate::bed::library::BedCache;
use crate::bed::recipe::Recipe;
use crate::campaign::folder::{CampaignFolder, Failure};
use crate::campaign::plan::{Member, Plan};
use crate::folder::{DirectoryLock, FAILURE, Folder, refuse_library};
use crate::manifest::FolderKind;
use crate::progress::Progress;
use crate::run::{self, SaveEvery, Setting, side_by_side};
use crate::scenario::{BedPlan, DragPlan};
use bitgrain_sim::error::{Error, Result};

/// How long a worker waits before it looks again for a bed that another one pours.
const WAIT: Duration = Duration::from_millis(500);

/// How a task is done; none of it changes a result.
pub struct Worker<'a> {
    /// The campaign.
    pub plan: &'a Plan,
    /// Its folder.
    pub out: &'a Path,
    /// The settled beds that all workers share.
    pub library: &'a BedCache,
    /// Threads.
    pub threads: usize,
    /// How often the unfinished stage is saved.
    pub save: SaveEvery,
    /// Whether a task that failed before is tried again.
    pub retry: bool,
    /// Bars, lines and the request to stop.
    pub progress: &'a Progress,
}

/// How a task ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It is done.
    Done,
    /// It was done before.
    Already,
    /// Another worker is at it.
    Taken,
    /// It failed, now or before, for this reason.
    Failed(String),
}

/// A bed that is made, or that failed for a reason.
type Made = std::result::Result<(), String>;

/// Does the task of this name, as [`missing`](super::missing) gives it, or what is left of it. Its folder then holds a
/// drag with its bed, or why it failed; a bed is then in the cache.
///
/// # Errors
/// [`Error::Input`] if there is no such task, or the folder holds another campaign; if it is interrupted; if files
/// cannot be written.
pub fn perform(worker: &Worker<'_>, name: &str) -> Result<Ended> {
    let task = parse(worker.plan, name)?;
    let member = &worker.plan.members[task.member];
    let library = worker.library.folder();
    refuse_library(library, worker.out, FolderKind::Campaign)?;
    CampaignFolder(worker.out).share(worker.plan)?;
    match task.stage {
        Stage::Bed(place) => worker.bed_task(member, member.scenario.all_beds()[place]),
        Stage::Drag(place) => worker.drag_task(member, &member.scenario.drags()[place]),
    }
}

impl Worker<'_> {
    fn setting<'b>(
        &'b self,
        member: &'b Member,
        folder: &'b Folder<'b>,
        progress: &'b Progress,
    ) -> Setting<'b> {
        Setting {
            scenario: &member.scenario,
            folder,
            library: self.library,
            threads: self.threads,
            save: self.save,
            // As in a campaign that one process runs.
            frames: false,
            only: &[],
            write_report: |_| Ok(()),
            progress,
        }
    }

    /// A folder of a task; `None` if another worker has it.
    fn take(&self, member: &Member, place: &Path) -> Result<Option<DirectoryLock>> {
        let claim = run::try_claim(&Folder(place), &member.scenario)?;
        if let Some(claim) = &claim {
            self.progress.keep_pace(place);
            claim.warn_of_damage(self.progress);
            if !claim.sure {
                self.progress.warn(&format!(
                    "{} cannot be locked: if another worker does the same, both write the same bytes",
                    place.display()
                ));
            }
        }
        Ok(claim)
    }

    fn drag_task(&self, member: &Member, drag: &DragPlan) -> Result<Ended> {
        let folder = CampaignFolder(self.out);
        let place = folder.task(&member.name, &drag.name);
        let before = || {
            let places = [folder.member(&member.name), place.clone()];
            let found = places.map(|place| look(&place, &member.scenario, &drag.name));
            let mut ends = found.into_iter().filter_map(|found| match found {
                Found::Done(_) => Some(Ended::Already),
                Found::Failed(_, reason) if !self.retry => Some(Ended::Failed(reason)),
                _ => None,
            });
            ends.next()
        };
        if let Some(ended) = before() {
            return Ok(ended);
        }
        // Before the folder is taken: who waits for a bed holds nothing that another worker may want.
        let made = match member.scenario.source {
            Some(_) => Ok(()),
            None => self.bed(member, &member.scenario.beds()[drag.bed])?,
        };
        let Some(claim) = self.take(member, &place)? else {
            return Ok(Ended::Taken);
        };
        if let Some(ended) = before() {
            return Ok(ended);
        }
        let (ledger, own) = (&claim.ledger, Folder(&place));
        let of_drag = place.join("runs").join(&drag.name);
        for at in [&place, &of_drag] {
            ledger.remove(&at.join(FAILURE))?;
        }
        if let Err(reason) = made {
            Failure {
                reason: reason.clone(),
            }
            .keep(ledger, &place)?;
            return Ok(Ended::Failed(reason));
        }
        let progress = self.progress.labelled(&member.name);
        let setting = self.setting(member, &own, &progress);
        let beds = match run::beds(setting, ledger, &[drag.bed]) {
            Ok((beds, _)) => beds,
            Err(error) => return failed(error, &claim, &place),
        };
        let dragged = self.on_threads(|| run::drag(setting, ledger, drag, &beds[0]))?;
        match dragged {
            Ok(_) => Ok(Ended::Done),
            Err(error) => failed(error, &claim, &of_drag),
        }
    }

    fn bed_task(&self, member: &Member, bed: &BedPlan) -> Result<Ended> {
        let recipe = Recipe::new(&member.scenario, bed);
        if member.scenario.source.is_some() || self.library.has(&recipe) {
            return Ok(Ended::Already);
        }
        if let Some(bare) = below(&member.scenario, bed)
            && let Err(reason) = self.bed(member, bare)?
        {
            return Ok(Ended::Failed(reason));
        }
        let (owner, bed) = owner(self.plan, &recipe);
        let made = self.pour(&self.plan.members[owner], bed, &recipe, self.retry)?;
        Ok(match made {
            None => Ended::Taken,
            Some(Ok(())) => Ended::Done,
            Some(Err(reason)) => Ended::Failed(reason),
        })
    }

    /// Sees that a bed is in the cache: pours it, or waits for another worker that pours it.
    fn bed(&self, member: &Member, bed: &BedPlan) -> Result<Made> {
        let recipe = Recipe::new(&member.scenario, bed);
        if self.library.has(&recipe) {
            return Ok(Ok(()));
        }
        if let Some(bare) = below(&member.scenario, bed)
            && let Err(reason) = self.bed(member, bare)?
        {
            return Ok(Err(reason));
        }
        let (owner, bed) = owner(self.plan, &recipe);
        let owner = &self.plan.members[owner];
        let mut told = false;
        loop {
            if let Some(made) = self.pour(owner, bed, &recipe, false)? {
                return Ok(made);
            }
            let name = name_of(&owner.name, &bed.name);
            if self.progress.stop_flag().load(Ordering::Relaxed) {
                return Err(Error::Interrupted {
                    stage: format!("waiting for {name}"),
                    step: 0,
                    saved: false,
                });
            }
            if !told {
                let waits = format!("another worker pours {name}: this one waits for it");
                self.progress.line(&waits);
            }
            told = true;
            std::thread::sleep(WAIT);
        }
    }

    /// Pours a bed in the folder of its task; `None` if another worker does.
    fn pour(
        &self,
        owner: &Member,
        bed: &BedPlan,
        recipe: &Recipe,
        retry: bool,
    ) -> Result<Option<Made>> {
        let place = CampaignFolder(self.out).task(&owner.name, &bed.name);
        let before = || match (self.library.has(recipe), failure(&place, None)) {
            (true, _) => Some(Ok(())),
            (false, Some(reason)) if !retry => Some(Err(reason)),
            _ => None,
        };
        if let Some(made) = before() {
            return Ok(Some(made));
        }
        let Some(claim) = self.take(owner, &place)? else {
            return Ok(None);
        };
        // It may have been made since.
        if let Some(made) = before() {
            return Ok(Some(made));
        }
        self.library.prepare(std::slice::from_ref(recipe))?;
        claim.ledger.remove(&place.join(FAILURE))?;
        let (own, progress) = (Folder(&place), self.progress.labelled(&owner.name));
        let setting = self.setting(owner, &own, &progress);
        let poured = self.on_threads(|| run::bed(setting, &claim.ledger, bed))?;
        Ok(Some(match poured {
            Ok(()) => Ok(()),
            Err(error) => match failed(error, &claim, &place)? {
                Ended::Failed(reason) => Err(reason),
                _ => Ok(()),
            },
        }))
    }

    /// Does one thing on all threads.
    fn on_threads<T: Send>(&self, job: impl Fn() -> Result<T> + Sync) -> Result<Result<T>> {
        let done = side_by_side(self.threads, self.threads, 1, |_| 1, |_| job())?;
        Ok(done.into_iter().next().expect("there is one job"))
    }
}

/// Keeps why a stage failed; what stopped it otherwise is returned.
fn failed(error: Error, claim: &DirectoryLock, place: &Path) -> Result<Ended> {
    let failure = Failure::of(error)?;
    failure.keep(&claim.ledger, place)?;
    Ok(Ended::Failed(failure.reason))
}
