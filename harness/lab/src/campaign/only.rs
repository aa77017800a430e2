//! Which runs of a campaign are wanted, if not all are.

use super::plan::Plan;
use bitgrain_sim::error::{Error, Result};

/// Names of members, or of their runs as `MEMBER/RUN`; all runs if there is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Only(Vec<String>);

impl Only {
    /// Checks the names against a plan.
    ///
    /// # Errors
    /// [`Error::Input`] with a name that nothing in the plan has.
    pub fn new(names: Vec<String>, plan: &Plan) -> Result<Self> {
        let known = |name: &String| {
            let mut members = plan.members.iter();
            members.any(|m| {
                m.name == *name
                    || m.scenario
                        .drags()
                        .iter()
                        .any(|run| *name == of(&m.name, &run.name))
            })
        };
        if let Some(name) = names.iter().find(|name| !known(name)) {
            let members: Vec<&str> = plan.members.iter().map(|m| &m.name[..]).collect();
            let problem = format!(
                "`{name}` is neither a member of the campaign nor a run of one, such as {}/run-1; members are {}",
                members[0],
                members.join(", ")
            );
            return Err(Error::input("--only", problem));
        }
        Ok(Self(names))
    }

    /// Whether a run is wanted.
    pub fn wants(&self, member: &str, run: &str) -> bool {
        let named = |name: &String| name == member || *name == of(member, run);
        self.0.is_empty() || self.0.iter().any(named)
    }
}

fn of(member: &str, run: &str) -> String {
    format!("{member}/{run}")
}
