//! What a run prints as it ends.

use std::fmt::Write;
use std::path::Path;

use super::channels::shown;
use bitgrain_analysis::present::series;
use bitgrain_analysis::released;
use bitgrain_analysis::remarks::remarks;
use bitgrain_lab::folder::Folder;
use bitgrain_lab::manifest::{FolderKind, Vouched};
use bitgrain_lab::published::Comparison;
use bitgrain_lab::run::Taken;
use bitgrain_lab::summary::{Summary, read_folder};
use bitgrain_sim::error::Result;
use bitgrain_sim::format::{number_with_error, short};

/// The drag of each run with its error, what to know before it is believed, the last link, the report, and what to
/// do next; and how the run stands to what was published of its scenario, if anything was.
///
/// # Errors
/// If the folder is not what the run left.
pub(super) fn describe(
    out: &Path,
    beds: &Path,
    published: Option<&Comparison>,
    executed: &[Taken],
) -> Result<String> {
    let vouched = Vouched::open(out, FolderKind::Run)?;
    let folder = Folder(out);
    let (_, summary) = read_folder(&folder, &vouched)?;
    let mut text = drags(&summary);
    text += &plain(&released::text(
        &summary,
        &series(&folder, &vouched, &summary)?,
    ));
    for remark in remarks(&summary) {
        let words = remark.words.replace('`', "");
        let _ = writeln!(text, "before you believe it: {}. {words}", remark.title);
    }
    if executed.iter().all(|taken| taken.steps == 0) {
        text += "nothing was executed: the run was complete already\n";
    }
    if let Some(last) = summary.runs.last() {
        let _ = writeln!(text, "last link of {}: {}", last.name, last.chain);
    }
    if let Some(found) = published {
        let _ = writeln!(text, "{}", beside_published(found));
    }
    let _ = writeln!(text, "settled beds: {} (--beds)", shown(beds));
    let _ = writeln!(text, "report: {}", shown(&folder.report()));
    let _ = writeln!(text, "closing hash: {}", vouched.manifest.closing);
    let _ = writeln!(text, "next: bitgrain verify {} --sample 3", shown(out));
    Ok(text)
}

/// How a run stands to what was published of its scenario.
fn beside_published(found: &Comparison) -> String {
    let (links, executed) = (found.links.all(), found.links.executed);
    if !found.differing.is_empty() {
        return format!("not as published: {}", found.differing.join(", "));
    }
    match executed == links {
        true => "as published: this machine keeps the contract".into(),
        false => format!(
            "not confirmed: the links are as published, and {executed} of {links} were executed by this call; \
             `bitgrain verify` executes the others"
        ),
    }
}

/// A line for each drag at constant speed, none of which the intruder answers a force; of a flowing bed the lift too.
fn drags(summary: &Summary) -> String {
    let force = &summary.units.force;
    let held = || summary.runs.iter().filter(|run| run.released.is_none());
    if held().next().is_none() {
        return String::new();
    }
    let flows = held().any(|run| run.flow.is_some());
    let width = held().map(|run| run.name.len()).max();
    let width = width.unwrap_or(0).max(3);
    let mut text = format!(
        "{:<width$} {:>8} {:>22}",
        "run",
        "Fr",
        format!("drag ({force})")
    );
    if flows {
        let _ = write!(text, " {:>22}", "lift (buoyancies)");
    }
    text.push('\n');
    for run in held() {
        let drag = with_error(run.drag.mean, run.drag.standard_error);
        let _ = write!(
            text,
            "{:<width$} {:>8} {drag:>22}",
            run.name,
            short(run.froude)
        );
        if let Some(flow) = &run.flow {
            let lift = with_error(flow.lift_over_buoyancy, flow.lift_over_buoyancy_error);
            let _ = write!(text, " {lift:>22}");
        }
        text.push('\n');
    }
    text
}

/// A number to the second digit of its error.
fn with_error(value: f64, error: f64) -> String {
    plain(&number_with_error(value, error))
}

/// In characters that every terminal has.
fn plain(text: &str) -> String {
    text.replace('\u{a0}', " ")
        .replace('\u{b1}', "+-")
        .replace('\u{2212}', "-")
}
