//! Summaries read from files, which anyone may have written: parsed, and checked before anything else sees them.

use std::path::Path;

use super::record::{DragRecord, Summary};
use crate::folder::Folder;
use crate::json;
use crate::manifest::Vouched;
use crate::scenario::Scenario;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;

/// Reads `summary.json` of a run directory.
///
/// # Errors
/// [`Error::Input`] if it is missing or not a sound summary.
pub fn read_summary(path: &Path) -> Result<Summary> {
    parse_summary(&read_text(path)?, path)
}

/// The summary that `text`, read from `path`, says: its inputs are those of a scenario that would be run, its beds
/// and drags are some of those that the scenario plans, each once, and their numbers can be such a drag's.
///
/// # Errors
/// [`Error::Input`] with the line or the key that is wrong, and what was expected.
pub fn parse_summary(text: &str, path: &Path) -> Result<Summary> {
    let place = path.display().to_string();
    let summary: Summary<Scenario> = json::parse(text, &place)?;
    summary.checked().map_err(|wrong| refused(&place, wrong))
}

/// The same of the summary of one drag.
///
/// # Errors
/// As [`parse_summary`].
pub fn parse_record(text: &str, path: &Path) -> Result<DragRecord> {
    let place = path.display().to_string();
    let record: DragRecord<Scenario> = json::parse(text, &place)?;
    record.checked().map_err(|wrong| refused(&place, wrong))
}

fn refused(place: &str, (key, problem): (String, String)) -> Error {
    Error::input(
        format!("{place}: `{key}`"),
        format!("{problem}; was the file changed? The run that made it writes it again"),
    )
}

/// The summary of a run directory, and what it was read from: `summary.json`, or if a run has not come to its
/// end those of the drags that have.
///
/// # Errors
/// [`Error::Input`] if there is none, or one is not sound or not as it was written.
pub fn read_folder(folder: &Folder, vouched: &Vouched) -> Result<(String, Summary)> {
    let whole = folder.summary();
    if vouched.lists(&whole) {
        let text = vouched.text(&whole)?;
        let summary = parse_summary(&text, &whole)?;
        return Ok((text, summary));
    }
    let mut records = Vec::new();
    for stage in &vouched.manifest.stages {
        let name = &stage.name;
        let path = folder.of_run(name, "summary.json");
        if !stage.finished || !vouched.lists(&path) {
            continue;
        }
        let text = vouched.text(&path)?;
        let record = parse_record(&text, &path)?;
        if record.run.name != *name {
            let problem = format!(
                "is `{}`, in the folder of `{name}`: put the file back in its place",
                record.run.name
            );
            return Err(Error::input(
                format!("{}: `run.name`", path.display()),
                problem,
            ));
        }
        records.push((text, record));
    }
    let Some((_, first)) = records.first() else {
        let problem = "holds no drag that has come to its end: go on with `bitgrain run --resume`";
        return Err(Error::input(folder.0.display().to_string(), problem));
    };
    let (inputs, mut summary) = (first.inputs.clone(), first.whole());
    let order = inputs.drags();
    records.sort_by_key(|(_, record)| order.iter().position(|plan| plan.name == record.run.name));
    let mut text = String::new();
    for (own, record) in records {
        if record.inputs != inputs {
            let problem = "holds drags of several scenarios: put back those of one";
            return Err(Error::input(folder.0.display().to_string(), problem));
        }
        match summary.beds.iter().find(|bed| bed.name == record.bed.name) {
            Some(bed) if *bed != record.bed => {
                let problem = format!(
                    "holds drags that contradict each other about `{}`: put back those of one run",
                    bed.name
                );
                return Err(Error::input(folder.0.display().to_string(), problem));
            }
            Some(_) => {}
            None => summary.beds.push(record.bed),
        }
        summary.runs.push(record.run);
        text.push_str(&own);
    }
    Ok((text, summary))
}
