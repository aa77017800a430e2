//! What shipped scenarios come to on every machine that keeps the contract: the last link of each of their stages.

use crate::bisect::chain_of;
use crate::folder::Folder;
use crate::run::{Links, Taken};
use crate::scenario::{self, CheckedScenario};
use bitgrain_sim::error::{Error, Result};

/// Lines of `SCENARIO,STAGE,LINK`.
const PUBLISHED: &str = include_str!("../data/published.csv");

/// Stages of a shipped scenario, and the last link of each; none if nothing was published of it.
pub fn links(scenario: &str) -> Vec<(&'static str, &'static str)> {
    let rows = PUBLISHED.lines().filter_map(|line| {
        let (name, rest) = line.split_once(',')?;
        (name == scenario).then_some(rest)
    });
    rows.filter_map(|rest| rest.split_once(',')).collect()
}

/// A run beside what was published of its scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Stages that end with another link.
    pub differing: Vec<String>,
    /// Links of its stages.
    pub links: Links,
}

/// Compares a finished run with what was published, if its scenario is a shipped one with nothing changed; `executed`
/// are its stages and what the call did for them.
///
/// # Errors
/// If a chain of digests cannot be read.
pub fn compare(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
    executed: &[Taken],
) -> Result<Option<Comparison>> {
    let wanted = links(&scenario.name);
    let shipped = |name: &str| scenario::load(name, &[]).map(|shipped| shipped.to_toml());
    if wanted.is_empty() || shipped(&scenario.name)? != scenario.to_toml() {
        return Ok(None);
    }
    let mut found = Comparison::default();
    for (stage, link) in wanted {
        let chain = chain_of(folder.0, stage)?.ok_or_else(|| {
            Error::input(folder.0.display().to_string(), format!("has no {stage}"))
        })?;
        if chain.end() != link {
            found.differing.push(stage.into());
        }
        found.links += Taken::of(executed, stage).links(&chain);
    }
    Ok(Some(found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_kernel::Digest;
    use bitgrain_sim::chain::Chain;

    /// Links are counted from the step on at which the call took a stage up; other links than those published are
    /// named; changed scenarios are compared with nothing.
    #[test]
    fn links_are_counted_and_differences_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = Folder(folder.path());
        let zeros = [0; 32];
        let state = Digest {
            positions: zeros,
            velocities: zeros,
            spins: zeros,
            histories: zeros,
            forces: zeros,
            obstacles: zeros,
            whole: zeros,
        };
        for (stage, _) in links("quick") {
            let mut chain = Chain::new("0".repeat(64), 100);
            for step in [0, 100, 200] {
                chain.add(step, &state);
            }
            let path = match stage {
                "bed" => at.bed_chain(stage),
                _ => at.chain(stage),
            };
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, chain.text()).unwrap();
        }
        let quick = scenario::load("quick", &[]).unwrap();
        let taken = |stage: &str, how: &str, steps| Taken {
            stage: stage.into(),
            how: how.into(),
            steps,
        };
        let steps = [
            taken("bed", "reused", 0),
            taken("run-1", "dragged", 200),
            taken("run-2", "resumed", 199),
            taken("run-3", "resumed", 100),
        ];
        let found = compare(&at, &quick, &steps).unwrap().unwrap();
        assert_eq!(found.differing, ["bed", "run-1", "run-2", "run-3"]);
        let links = Links {
            executed: 3 + 2 + 1,
            library: 3,
            found: 1 + 2,
        };
        assert_eq!((found.links, links.all()), (links, 12));
        let changed = scenario::load("quick", &["law.mu=0.4".into()]).unwrap();
        assert_eq!(compare(&at, &changed, &steps).unwrap(), None);
    }
}
