//! The folder of a campaign: where everything of it is.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::plan::{Member, Plan};
use super::written;
use crate::changes;
use crate::folder::{Contents, DirectoryLock};
use crate::manifest::{self, FolderKind, Ledger, Vouched};
use bitgrain_sim::disk::{self, Kind};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::bits;

/// Name of the file that says why a run or a bed failed.
pub(super) const FAILURE: &str = "failure.json";

/// What the folder of a campaign holds.
pub const CAMPAIGN: Contents = Contents {
    of: FolderKind::Campaign,
    marker: "campaign.toml",
    names: &[
        "campaign.toml",
        manifest::NAME,
        "members",
        "results.csv",
        "results.parquet",
        super::pace::NAME,
        "analysis.json",
        "report.html",
    ],
};

/// Why a run or a bed failed, kept so that it is not tried again with the same result.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Failure {
    pub(super) reason: String,
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
        self.0.join("analysis.json")
    }

    /// The same as a page.
    pub fn report(&self) -> PathBuf {
        self.0.join("report.html")
    }

    /// The run directory of a member.
    pub fn member(&self, name: &str) -> PathBuf {
        self.0.join("members").join(name)
    }

    /// Its members, which are the stages of a campaign.
    pub fn stages(plan: &Plan) -> Vec<String> {
        plan.members
            .iter()
            .map(|member| member.name.clone())
            .collect()
    }

    pub(super) fn claim(&self, plan: &Plan) -> Result<DirectoryLock> {
        let text = format!("# {}\n{}", bits(), plan.text());
        let claim = DirectoryLock::take(self.0, &CAMPAIGN, &Self::stages(plan), |ledger| {
            self.survey(plan, &text, ledger)?;
            ledger.write(&self.campaign(), text.as_bytes())
        })?;
        if claim.sure {
            disk::clear_partials(self.0);
        }
        claim.ledger.save()?;
        Ok(claim)
    }

    /// Refuses a folder that holds another campaign.
    fn survey(&self, plan: &Plan, text: &str, ledger: &Ledger) -> Result<()> {
        let path = self.campaign();
        let known = ledger.expects(&path, text.as_bytes());
        if known == Some(true) || !disk::is_there(&self.0.join("members")) {
            // One that ended before it had any result does not count.
            return Ok(());
        }
        let old = disk::read_if_there(&path)?.unwrap_or_default();
        let old = String::from_utf8_lossy(&old).into_owned();
        let same = |old: &str| {
            let read = written::parse(old, &path.display().to_string(), self.0);
            old == text || read.is_ok_and(|read| read.text() == plan.text())
        };
        if known.is_none() && (old.is_empty() || same(&old)) {
            return Ok(());
        }
        Err(Error::input(
            self.0.display().to_string(),
            format!(
                "holds another campaign, or this one before it was changed:\n{}\nchange it back, choose \
                 another --out, or remove the folder",
                changes::list(&old, text)
            ),
        ))
    }
}
