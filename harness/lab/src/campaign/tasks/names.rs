//! Tasks and their names.

use crate::bed::recipe::Recipe;
use crate::campaign::plan::Plan;
use crate::scenario::{BedPlan, CheckedScenario};
use bitgrain_sim::error::{Error, Result};

/// A task of a plan.
#[derive(Clone, Copy)]
pub(super) struct Task {
    /// Place of its member.
    pub member: usize,
    /// What is done of it.
    pub stage: Stage,
}

/// What it does, by place among the beds or drags of its member.
#[derive(Clone, Copy)]
pub(super) enum Stage {
    /// A bed.
    Bed(usize),
    /// A drag.
    Drag(usize),
}

/// The name of a task.
pub(super) fn name_of(member: &str, stage: &str) -> String {
    format!("{member}/{stage}")
}

/// The task of a name.
pub(super) fn parse(plan: &Plan, name: &str) -> Result<Task> {
    for (k, member) in plan.members.iter().enumerate() {
        let stage = name
            .strip_prefix(&member.name[..])
            .and_then(|rest| rest.strip_prefix('/'));
        let Some(stage) = stage else { continue };
        let scenario = &member.scenario;
        let bed = scenario.all_beds().iter().position(|bed| bed.name == stage);
        let drag = scenario.drags().iter().position(|drag| drag.name == stage);
        if let Some(stage) = bed.map(Stage::Bed).or(drag.map(Stage::Drag)) {
            return Ok(Task { member: k, stage });
        }
    }
    let first = &plan.members[0];
    let problem = format!(
        "`{name}` is not a task of the campaign, as {}/{} is one; --tasks lists those that are left",
        first.name,
        first.scenario.drags()[0].name
    );
    Err(Error::input("--task", problem))
}

/// The bed below the lid of one, if it has a lid.
pub(super) fn below<'a>(scenario: &'a CheckedScenario, bed: &BedPlan) -> Option<&'a BedPlan> {
    bed.lid?;
    let recipe = Recipe::new(scenario, &bed.bare());
    let mut bare = scenario.bare_beds().iter();
    bare.find(|other| Recipe::new(scenario, other) == recipe)
}

/// The first member whose beds have this recipe, and that bed: in its folder it is poured for all.
pub(super) fn owner<'a>(plan: &'a Plan, recipe: &Recipe) -> (usize, &'a BedPlan) {
    let mut members = plan.members.iter().enumerate();
    let found = members.find_map(|(k, member)| {
        let mut beds = member.scenario.all_beds().into_iter();
        let bed = beds.find(|bed| Recipe::new(&member.scenario, bed) == *recipe);
        bed.map(|bed| (k, bed))
    });
    found.expect("the recipe is that of a member")
}
