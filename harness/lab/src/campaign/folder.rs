//! The folder of a campaign: where everything of it is.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::plan::{Member, Plan};
use super::written;
use crate::beside::{ANALYSIS, PERFORMANCE, REPORT};
use crate::changes;
use crate::folder::{
    Contents, DirectoryLock, FAILURE, Folder, SUBMITTED, refuse_among_results, refuse_others,
};
use crate::manifest::{self, FolderKind, Ledger, Planned, Vouched, When};
use crate::pace::Pace;
use crate::run::{refuse_foreign_names, refuse_other_kinds, stages};
use bitgrain_sim::below::Below;
use bitgrain_sim::disk::{self, Kind};
use bitgrain_sim::error::{Error, Result};

/// What the folder of a campaign holds.
pub const CAMPAIGN: Contents = Contents {
    of: FolderKind::Campaign,
    as_made: written::as_made,
    files: &[
        "campaign.toml",
        manifest::NAME,
        "results.csv",
        "results.parquet",
        PERFORMANCE,
        ANALYSIS,
        REPORT,
    ],
    folders: &["members", TASKS, SUBMITTED],
};

/// The folder of what workers do, until it is gathered.
const TASKS: &str = "tasks";

/// Why a run or a bed failed, kept so that it is not tried again with the same result.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Failure {
    pub(super) reason: String,
}

impl Failure {
    /// Of a stage that ended so; a fault of the machine is no result, and is returned as it is.
    pub(super) fn of(error: Error) -> Result<Self> {
        match error.is_physical() {
            true => Ok(Self {
                reason: error.to_string(),
            }),
            false => Err(error),
        }
    }

    /// Keeps it in the folder of what failed.
    pub(super) fn keep(&self, ledger: &Ledger, place: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).expect("a sentence is text");
        ledger.write(&place.join(FAILURE), format!("{text}\n").as_bytes())?;
        ledger.save()
    }
}

/// What lies beside a campaign's table.
pub struct Beside {
    /// Name of the campaign.
    pub name: String,
    /// Its file with its base written out.
    pub text: String,
    /// Runs that it plans.
    pub planned: usize,
    /// Members that have a report.
    pub reports: Vec<String>,
}

/// The folder of a campaign.
#[derive(Clone, Copy, Debug)]
pub struct CampaignFolder<'a>(pub &'a Path);

impl CampaignFolder<'_> {
    /// The campaign's file with its base written out.
    pub fn campaign(&self) -> PathBuf {
        self.0.join("campaign.toml")
    }

    /// What lies beside the table.
    ///
    /// # Errors
    /// [`Error::Input`] if the campaign's file is missing, not as it was written, or not a campaign.
    pub fn beside(&self, vouched: &Vouched) -> Result<Beside> {
        let path = self.campaign();
        let text = vouched.text(&path)?;
        let plan = written::parse(&text, &path.display().to_string(), self.0)?;
        let report = |member: &Member| self.member(&member.name).join("report.html");
        let reported = |member: &&Member| disk::kind(&report(member)) == Some(Kind::File);
        let reports = plan.members.iter().filter(reported);
        Ok(Beside {
            name: plan.campaign.name.clone(),
            planned: plan.members.iter().map(|m| m.scenario.drags().len()).sum(),
            reports: reports.map(|member| member.name.clone()).collect(),
            text,
        })
    }

    /// The table.
    pub fn table(&self) -> PathBuf {
        self.0.join("results.csv")
    }

    /// The same as Parquet.
    pub fn parquet(&self) -> PathBuf {
        self.0.join("results.parquet")
    }

    /// What the table says.
    pub fn analysis(&self) -> PathBuf {
        self.0.join(ANALYSIS)
    }

    /// The same as a page.
    pub fn report(&self) -> PathBuf {
        self.0.join(REPORT)
    }

    /// The run directory of a member.
    pub fn member(&self, name: &str) -> PathBuf {
        self.0.join("members").join(name)
    }

    /// What workers do, until it is gathered.
    pub fn tasks(&self) -> PathBuf {
        self.0.join(TASKS)
    }

    /// The run directory of one task.
    pub fn task(&self, member: &str, stage: &str) -> PathBuf {
        self.tasks().join(member).join(stage)
    }

    /// How fast its stages went on this machine, those of tasks included that were not gathered yet.
    pub fn pace(&self) -> Pace {
        let mut pace = Pace::read(self.0);
        let folders = |folder: &Path| {
            let found = disk::list(folder).unwrap_or_default();
            let found = found.into_iter().filter(|(_, kind)| *kind == Kind::Folder);
            found.map(|(name, _)| folder.join(name)).collect::<Vec<_>>()
        };
        for task in folders(&self.tasks())
            .iter()
            .flat_map(|member| folders(member))
        {
            pace.add(Pace::read(&task));
        }
        pace
    }

    /// Makes the folder one of this campaign, in which several processes may work, each in a folder of its own: all
    /// of them write the same file.
    ///
    /// # Errors
    /// [`Error::Input`] if it holds something else; [`Error::Write`].
    pub fn share(&self, plan: &Plan) -> Result<()> {
        self.refuse_others(plan)?;
        let (path, text) = (self.campaign(), self.text(plan));
        let old = disk::read_if_there(&path)?.unwrap_or_default();
        if old == text.as_bytes() || !old.is_empty() && self.has_begun() {
            return Ok(());
        }
        Below(self.0).write(&path, text.as_bytes())
    }

    /// Refuses a folder that holds something else; nothing is written.
    ///
    /// # Errors
    /// [`Error::Input`] with the difference.
    pub fn refuse_others(&self, plan: &Plan) -> Result<()> {
        refuse_among_results(self.0)?;
        refuse_others(self.0, &CAMPAIGN)?;
        self.refuse_other_kinds(plan)?;
        match self.has_begun() {
            true => self.refuse_another(plan, &self.text(plan)),
            false => Ok(()),
        }
    }

    /// Refuses a folder in which a link or another kind of thing has a place of a member or task.
    fn refuse_other_kinds(&self, plan: &Plan) -> Result<()> {
        let below = Below(self.0);
        for member in &plan.members {
            let place = self.member(&member.name);
            below.check_folder(&place)?;
            refuse_other_kinds(&Folder(&place), &member.scenario)?;
            for stage in stages(&member.scenario) {
                below.check_folder(&self.task(&member.name, &stage))?;
            }
        }
        Ok(())
    }

    /// Whether anything was made in it: a campaign that ended before that does not count.
    fn has_begun(&self) -> bool {
        let kinds = [self.tasks(), self.0.join("members")];
        kinds.iter().any(|kind| disk::is_there(kind))
    }

    fn text(&self, plan: &Plan) -> String {
        written::head() + &plan.text()
    }

    /// Its members, which are the stages of a campaign.
    pub fn stages(plan: &Plan) -> Vec<String> {
        plan.members
            .iter()
            .map(|member| member.name.clone())
            .collect()
    }

    /// What the folder is to hold, but for its members.
    pub(super) fn planned(plan: &Plan) -> Planned {
        let results =
            ["campaign.toml", "results.csv", "results.parquet"].map(|name| (name, When::Always));
        let beside = [manifest::NAME, PERFORMANCE, REPORT, ANALYSIS];
        let files = results
            .into_iter()
            .chain(beside.map(|name| (name, When::Beside)));
        Planned {
            of: FolderKind::Campaign,
            stages: Self::stages(plan),
            files: files.map(|(name, when)| (name.into(), when)).collect(),
        }
    }

    pub(super) fn claim(&self, plan: &Plan) -> Result<DirectoryLock> {
        let text = self.text(plan);
        refuse_among_results(self.0)?;
        let claim = DirectoryLock::take(self.0, &CAMPAIGN, &Self::stages(plan), |ledger| {
            self.refuse_other_kinds(plan)?;
            for member in &plan.members {
                let place = self.member(&member.name);
                refuse_foreign_names(&Folder(&place), &member.scenario)?;
            }
            self.survey(plan, &text, ledger)?;
            for own in [self.table(), self.parquet()] {
                ledger.refuse_foreign(&own)?;
            }
            ledger.write(&self.campaign(), text.as_bytes())
        })?;
        if claim.sure {
            // Workers write the campaign's file without a lock: one may begin now.
            let own = |name: &str| name != CAMPAIGN.of.marker();
            Below(self.0).clear_partials(self.0, own);
        }
        claim.ledger.save()?;
        Ok(claim)
    }

    /// Refuses a folder that holds another campaign.
    fn survey(&self, plan: &Plan, text: &str, ledger: &Ledger) -> Result<()> {
        let path = self.campaign();
        let known = ledger.expects(&path, text.as_bytes());
        if known == Some(true) || !self.has_begun() {
            return Ok(());
        }
        match known.is_none() {
            true => self.refuse_another(plan, text),
            false => Err(self.another(text)),
        }
    }

    /// Refuses a folder whose campaign does not mean the same as this one.
    fn refuse_another(&self, plan: &Plan, text: &str) -> Result<()> {
        let path = self.campaign();
        let old = disk::read_if_there(&path)?.unwrap_or_default();
        let old = String::from_utf8_lossy(&old).into_owned();
        let same = || {
            let read = written::parse(&old, &path.display().to_string(), self.0);
            old == text || read.is_ok_and(|read| read.text() == plan.text())
        };
        match old.is_empty() || same() {
            true => Ok(()),
            false => Err(self.another(text)),
        }
    }

    /// What is told to who brings another campaign.
    fn another(&self, text: &str) -> Error {
        let old = disk::read_if_there(&self.campaign()).ok().flatten();
        let old = old.unwrap_or_default();
        Error::input(
            self.0.display().to_string(),
            format!(
                "holds another campaign, or this one before it was changed:\n{}\nchange it back, choose \
                 another --out, or remove the folder",
                changes::list(&String::from_utf8_lossy(&old), text)
            ),
        )
    }
}
