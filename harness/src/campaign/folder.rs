//! The folder of a campaign: where everything of it is.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::changes;
use super::plan::{self, Member, Plan};
use crate::error::{Error, Result};
use crate::files::{bits, read_text, write_whole};
use crate::folder::Claim;

/// Name of the file that says why a run or a bed failed.
pub(super) const FAILURE: &str = "failure.json";

/// Why a run or a bed failed, kept so that it is not tried again with the same end.
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
    /// [`Error::Input`] where the campaign's file is not there or is none.
    pub fn beside(&self) -> Result<Beside> {
        let path = self.campaign();
        let text = read_text(&path)?;
        let plan = plan::parse(&text, &path.display().to_string(), &[], self.0)?;
        let reported = |member: &&Member| self.member(&member.name).join("report.html").exists();
        let reports = plan.members.iter().filter(reported);
        Ok(Beside {
            name: plan.campaign.name.clone(),
            planned: plan.members.iter().map(|m| m.scenario.runs().len()).sum(),
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

    /// The same to look at.
    pub fn report(&self) -> PathBuf {
        self.0.join("report.html")
    }

    /// The run directory of a member.
    pub fn member(&self, name: &str) -> PathBuf {
        self.0.join("members").join(name)
    }

    pub(super) fn claim(&self, plan: &Plan) -> Result<Claim> {
        Claim::take(self.0, &self.campaign(), || {
            let text = format!("# {}\n{}", bits(), plan.text());
            let path = self.campaign();
            if !path.exists() {
                return write_whole(&path, text.as_bytes());
            }
            let old = read_text(&path)?;
            if old == text {
                return Ok(());
            }
            if !self.0.join("members").exists() {
                // It ended before it had any result.
                return write_whole(&path, text.as_bytes());
            }
            Err(Error::input(
                self.0.display().to_string(),
                format!(
                    "holds another campaign, or this one before it was changed:\n{}\nchange it back, choose \
                     another --out, or remove the folder",
                    changes::list(&old, &text)
                ),
            ))
        })
    }
}
