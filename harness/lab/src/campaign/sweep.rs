//! Runs what is left of a campaign: beds first, each once, then drags, the longest first.

mod jobs;
mod records;

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard};

use super::columns::Status;
use super::folder::{CampaignFolder, Failure};
use super::only::Only;
use super::plan::Plan;
use super::tasks;
use crate::bed::recipe::Recipe;
use crate::bed::{self, library::BedCache};
use crate::folder::{DirectoryLock, FAILURE, Folder, at_work, refuse_library};
use crate::manifest::{FolderKind, Ledger};
use crate::performance::StagePerformance;
use crate::progress::{Overall, Progress};
use crate::run::{self, SaveEvery, Setting, Taken, WriteReport, side_by_side};
use crate::scenario::{BedPlan, CheckedScenario};
use crate::summary::{BedSummary, parse_record};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;
use jobs::{Job, Slot, first_cause, jobs};

/// How a campaign is run; none of it changes a result.
pub struct Sweep<'a> {
    /// What is run.
    pub plan: &'a Plan,
    /// Which of its runs.
    pub only: &'a Only,
    /// The campaign's folder.
    pub out: &'a Path,
    /// The settled beds that runs share.
    pub library: &'a BedCache,
    /// Threads.
    pub threads: usize,
    /// Most stages at a time, which share the threads.
    pub jobs: usize,
    /// How often an unfinished stage is saved.
    pub save: SaveEvery,
    /// Whether runs that failed before are tried again.
    pub retry: bool,
    /// Whether only what workers did is put together: nothing is computed.
    pub merge: bool,
    /// Writes the report of a member whose drags are all done.
    pub write_report: WriteReport,
    /// Bars, lines and the request to stop.
    pub progress: &'a Progress,
}

/// How a campaign ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Runs that are done.
    pub done: usize,
    /// Runs that failed; their rows say why.
    pub failed: usize,
    /// Runs that are wanted and missing; none unless the campaign was only to be put together.
    pub missing: usize,
    /// The table.
    pub table: PathBuf,
    /// What was done for the stages of each member; of those that are missing here nothing.
    pub taken: Vec<Vec<Taken>>,
}

/// A campaign in progress.
struct Under<'a> {
    what: &'a Sweep<'a>,
    folder: CampaignFolder<'a>,
    ledger: Ledger,
    places: Vec<PathBuf>,
    /// The folders of its members.
    claims: Vec<DirectoryLock>,
    jobs: Vec<Job>,
    slots: Mutex<Vec<Slot>>,
    taken: Mutex<Vec<Vec<Taken>>>,
}

/// Runs a campaign into its folder, or what is left of it.
///
/// # Errors
/// If its folder is in use or cannot be written to, or it is interrupted; runs that fail are reported in the
/// table and stop nothing.
pub fn sweep(what: &Sweep<'_>) -> Result<Outcome> {
    let jobs = jobs(what.plan, what.only);
    let folder = CampaignFolder(what.out);
    refuse_library(what.library.folder(), what.out, FolderKind::Campaign)?;
    let claim = folder.claim(what.plan)?;
    if !claim.sure {
        what.progress.warn(&format!(
            "{} cannot be locked: make sure that no other campaign is running in it",
            what.out.display()
        ));
    }
    let members = &what.plan.members;
    let places: Vec<PathBuf> = members.iter().map(|m| folder.member(&m.name)).collect();
    let mut claims = Vec::new();
    for (member, place) in members.iter().zip(&places) {
        let claim = run::try_claim(&Folder(place), &member.scenario)?;
        claims.push(claim.ok_or_else(|| at_work(place))?);
    }
    for claim in claims.iter().chain([&claim]) {
        claim.warn_of_damage(what.progress);
    }
    what.progress.keep_pace(what.out);
    let taken = tasks::gather(folder, what.plan, &claims, what.progress)?;
    if let (Some(first), false) = (taken.first(), what.merge) {
        let problem = format!(
            "workers are at tasks of it ({first}): wait for them, or put together what is done with --merge"
        );
        return Err(Error::input(what.out.display().to_string(), problem));
    }
    let slots = jobs.iter().map(|_| None).collect();
    let taken = Mutex::new(vec![Vec::new(); places.len()]);
    let under = Under {
        what,
        folder,
        ledger: claim.ledger,
        places,
        claims,
        jobs,
        slots: Mutex::new(slots),
        taken,
    };
    under.take_up()?;
    if what.merge {
        if let Some(unfinished) = under.unfinished()? {
            return Ok(unfinished);
        }
    } else {
        under.check_library()?;
        under.go_on()?;
    }
    let outcome = under.conclude()?;
    if under.slots().iter().all(Option::is_some) {
        tasks::clear(folder, what.plan, what.progress)?;
    }
    Ok(outcome)
}

impl Under<'_> {
    fn setting<'b>(
        &'b self,
        member: usize,
        folder: &'b Folder<'b>,
        progress: &'b Progress,
    ) -> Setting<'b> {
        Setting {
            scenario: self.scenario(member),
            folder,
            library: self.what.library,
            // Stages are side by side already, each on its share of the threads.
            threads: 1,
            save: self.what.save,
            // Nobody looks at hundreds of them.
            frames: false,
            only: &[],
            write_report: self.what.write_report,
            progress,
        }
    }

    fn progress(&self, member: usize) -> Progress {
        self.what
            .progress
            .labelled(&self.what.plan.members[member].name)
    }

    fn slots(&self) -> MutexGuard<'_, Vec<Slot>> {
        self.slots.lock().expect("no job panics with it")
    }

    /// Keeps what was done for a stage of a member.
    fn took(&self, member: usize, stage: &str, done: &StagePerformance) {
        let mut taken = self.taken.lock().expect("no job panics with it");
        taken[member].push(Taken::new(stage, done));
    }

    fn scenario(&self, member: usize) -> &CheckedScenario {
        &self.what.plan.members[member].scenario
    }

    /// The manifest of a member.
    fn ledger_of(&self, member: usize) -> &Ledger {
        &self.claims[member].ledger
    }

    /// Whether a bed need not be poured.
    fn at_hand(&self, member: usize, bed: &BedPlan) -> bool {
        let here = Folder(&self.places[member]).bed(&bed.name);
        let recipe = Recipe::new(self.scenario(member), bed);
        self.ledger_of(member).vouches(&here) || self.what.library.has(&recipe)
    }

    /// Finds out now rather than after days of pouring whether beds can be kept.
    fn check_library(&self) -> Result<()> {
        let mut recipes = Vec::new();
        for member in self.open().into_iter().flatten() {
            let scenario = self.scenario(member);
            if scenario.source.is_none() {
                let missing = scenario
                    .beds()
                    .iter()
                    .filter(|bed| !self.at_hand(member, bed));
                recipes.extend(missing.map(|bed| Recipe::new(scenario, bed)));
            }
        }
        self.what.library.prepare(&recipes)
    }

    fn run_folder(&self, job: &Job) -> PathBuf {
        self.places[job.member].join("runs").join(&job.plan.name)
    }

    /// Finds the runs that came to their end before.
    fn take_up(&self) -> Result<()> {
        let ends: Vec<Slot> = self
            .jobs
            .iter()
            .map(|job| self.ended(job))
            .collect::<Result<_>>()?;
        *self.slots() = ends;
        self.write_table()
    }

    /// How a run ended before, if it did.
    fn ended(&self, job: &Job) -> Result<Slot> {
        let ledger = self.ledger_of(job.member);
        let beds = self.scenario(job.member).all_beds();
        let settled = beds.iter().all(|bed| ledger.is_finished(&bed.name));
        let damaged = ledger.damaged(&format!("runs/{}/", job.plan.name));
        for (path, over) in [
            (self.places[job.member].join(FAILURE), settled),
            (
                self.run_folder(job).join(FAILURE),
                // One that is gone on with has not failed yet.
                ledger.is_finished(&job.plan.name) || !(damaged.is_empty() || self.what.merge),
            ),
        ] {
            // What has come to a good end since did not fail.
            if self.what.retry || over && ledger.lists(&path) {
                ledger.remove(&path)?;
                ledger.save()?;
            }
            if !ledger.vouches(&path) || ledger.is_finished(&job.plan.name) {
                continue;
            }
            let failure = serde_json::from_slice::<Failure>(&disk::read(&path)?).ok();
            if let Some(failure) = failure.filter(|_| damaged.is_empty()) {
                return Ok(Some(Status::Failed(failure.reason)));
            }
        }
        let path = self.run_folder(job).join("summary.json");
        // What no manifest vouches for is not trusted.
        if !damaged.is_empty() || !ledger.is_finished(&job.plan.name) || !ledger.vouches(&path) {
            return Ok(None);
        }
        let record = parse_record(&read_text(&path)?, &path).ok();
        let folder = Folder(&self.places[job.member]);
        let inputs = folder.inputs(self.scenario(job.member));
        // Half a file, or another program's: the run goes on from its checkpoints.
        let whole =
            record.filter(|record| record.inputs == inputs && !record.run.plug.is_unknown());
        Ok(whole.map(|record| Status::Done(Box::new(record))))
    }

    /// The members of whose runs some are open, by the first of each recipe and the rest.
    fn open(&self) -> [Vec<usize>; 2] {
        let slots = self.slots();
        let mut recipes: Vec<String> = Vec::new();
        let mut open = [Vec::new(), Vec::new()];
        for member in 0..self.places.len() {
            let mut own = self.jobs.iter().zip(slots.iter());
            let damaged = !self.ledger_of(member).damaged("beds/").is_empty();
            if !damaged && !own.any(|(job, slot)| job.member == member && job.open(slot)) {
                continue;
            }
            let scenario = self.scenario(member);
            let digests = scenario
                .beds()
                .iter()
                .map(|bed| Recipe::new(scenario, bed).digest());
            let digests: Vec<String> = digests.collect();
            let again = digests.iter().any(|digest| recipes.contains(digest));
            open[usize::from(again)].push(member);
            recipes.extend(digests);
        }
        open
    }

    /// Makes the beds that are wanted, then does the drags that are open.
    fn go_on(&self) -> Result<()> {
        let open = self.open();
        let overall = self.overall(&open);
        let beds = self.beds(open, &overall)?;
        let open: Vec<usize> = {
            let slots = self.slots();
            (0..self.jobs.len())
                .filter(|&k| self.jobs[k].open(&slots[k]))
                .collect()
        };
        let work = |k: usize| self.jobs[open[k]].work;
        let ended = side_by_side(self.what.threads, self.what.jobs, open.len(), work, |k| {
            let job = &self.jobs[open[k]];
            let found = beds[job.member].as_ref().expect("its bed was made");
            let folder = Folder(&self.places[job.member]);
            let progress = self.progress(job.member);
            let setting = self.setting(job.member, &folder, &progress);
            let ledger = self.ledger_of(job.member);
            let dragged = run::drag(setting, ledger, &job.plan, &found[job.plan.bed]);
            let dragged = dragged.map(|(run, done)| {
                self.took(job.member, &run.name, &done);
                run
            });
            let ended = self.end(dragged, ledger, &self.run_folder(job))?;
            overall.run_ended(ended.is_err());
            self.record(open[k], ended, &found[job.plan.bed])
        })?;
        first_cause(ended).map(|_| ())
    }

    /// Makes beds, by member; of those that fail the runs do too.
    fn beds(
        &self,
        open: [Vec<usize>; 2],
        overall: &Overall,
    ) -> Result<Vec<Option<Vec<BedSummary>>>> {
        let mut beds: Vec<Option<Vec<BedSummary>>> = vec![None; self.places.len()];
        for members in open {
            let work = |k: usize| self.pouring(members[k]);
            let made = side_by_side(
                self.what.threads,
                self.what.jobs,
                members.len(),
                work,
                |k| {
                    let folder = Folder(&self.places[members[k]]);
                    let progress = self.progress(members[k]);
                    let setting = self.setting(members[k], &folder, &progress);
                    let planned = self.planned(members[k]);
                    let all: Vec<usize> = (0..setting.scenario.beds().len()).collect();
                    let ledger = self.ledger_of(members[k]);
                    let made = run::beds(setting, ledger, &all).map(|(beds, done)| {
                        done.iter()
                            .for_each(|bed| self.took(members[k], &bed.stage, bed));
                        beds
                    });
                    if let Ok(beds) = &made
                        && planned > 0
                    {
                        let steps = beds.iter().map(|bed| bed.steps * bed.grains as u64);
                        overall.took(planned, steps.sum());
                    }
                    self.end(made, ledger, &self.places[members[k]])
                },
            )?;
            for (member, made) in members.into_iter().zip(first_cause(made)?) {
                match made {
                    Ok(found) => beds[member] = Some(found),
                    Err(reason) => self.fail_all(member, &reason, overall)?,
                }
            }
        }
        Ok(beds)
    }

    /// Grain-steps that the beds of a member take about.
    fn pouring(&self, member: usize) -> u64 {
        let scenario = self.scenario(member);
        let one = |bed: &BedPlan| {
            bed::pouring_steps(scenario, bed) * scenario.grain_count(bed.diameter) as u64
        };
        scenario.beds().iter().map(one).sum()
    }

    /// The same, or 0 if they are at hand.
    fn planned(&self, member: usize) -> u64 {
        let scenario = self.scenario(member);
        let at_hand = |bed: &BedPlan| self.at_hand(member, bed);
        match scenario.source.is_some() || scenario.beds().iter().all(at_hand) {
            true => 0,
            false => self.pouring(member),
        }
    }

    /// The bar over all of it.
    fn overall(&self, open: &[Vec<usize>; 2]) -> Overall<'_> {
        let pouring: u64 = open[0].iter().map(|&member| self.planned(member)).sum();
        let slots = self.slots();
        let (mut before, mut ended, mut total) = (0, 0, pouring);
        let wanted = self.jobs.iter().filter(|job| job.wanted).count();
        for (job, slot) in self.jobs.iter().zip(slots.iter()) {
            if !job.wanted {
                continue;
            }
            total += job.work;
            if slot.is_some() {
                (before, ended) = (before + job.work, ended + 1);
            }
        }
        let name = &self.what.plan.campaign.name;
        self.what
            .progress
            .overall(name, total, before, wanted, ended)
    }

    /// A stage's end: its result, or why it failed, which is written down; anything else that stopped it stops
    /// the campaign.
    fn end<T>(
        &self,
        ended: Result<T>,
        ledger: &Ledger,
        place: &Path,
    ) -> Result<std::result::Result<T, String>> {
        let error = match ended {
            Ok(given) => return Ok(Ok(given)),
            Err(error) => error,
        };
        let failure = match Failure::of(error) {
            Ok(failure) => failure,
            Err(error) => {
                // Nothing more is begun, and unfinished stages are saved.
                self.what
                    .progress
                    .stop_flag()
                    .store(true, Ordering::Relaxed);
                return Err(error);
            }
        };
        failure.keep(ledger, place)?;
        let reason = failure.reason;
        self.what
            .progress
            .warn(&format!("{reason}; the others go on"));
        Ok(Err(reason))
    }

    fn fail_all(&self, member: usize, reason: &str, overall: &Overall) -> Result<()> {
        let mut slots = self.slots();
        for (job, slot) in self.jobs.iter().zip(slots.iter_mut()) {
            if job.member == member && slot.is_none() {
                *slot = Some(Status::Failed(reason.into()));
                if job.wanted {
                    overall.run_ended(true);
                }
            }
        }
        drop(slots);
        self.write_table()
    }
}
