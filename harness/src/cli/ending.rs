//! What a run says as it ends.

use std::fmt::Write;
use std::path::Path;

use super::channels::shown;
use crate::error::Result;
use crate::folder::Folder;
use crate::manifest::{Manifest, Of, Vouched};
use crate::plug::Plug;
use crate::report::short;
use crate::summary::{RunSummary, Summary, read_folder};

/// The drag of each run with its error, what to know before it is believed, the last link, the report, and what to
/// do next.
///
/// # Errors
/// Where the folder is not what the run left.
pub(super) fn told(out: &Path) -> Result<(String, Manifest)> {
    let vouched = Vouched::open(out, Of::Run)?;
    let folder = Folder(out);
    let (_, summary) = read_folder(&folder, &vouched)?;
    let mut text = drags(&summary);
    for warning in warnings(&summary.runs) {
        let _ = writeln!(text, "before you believe it: {warning}");
    }
    if let Some(last) = summary.runs.last() {
        let _ = writeln!(text, "last link of {}: {}", last.name, last.chain);
    }
    let _ = writeln!(text, "report: {}", shown(&folder.report()));
    let _ = writeln!(text, "closing hash: {}", vouched.manifest.closing);
    let _ = writeln!(text, "next: bitgrain verify {} --sample 3", shown(out));
    Ok((text, vouched.manifest))
}

/// A line for each run; of a flowing bed the lift too.
fn drags(summary: &Summary) -> String {
    let force = &summary.units.force;
    let flows = summary.runs.iter().any(|run| run.flow.is_some());
    let width = summary.runs.iter().map(|run| run.name.len()).max();
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
    for run in &summary.runs {
        let drag = format!(
            "{} +- {}",
            short(run.drag.mean),
            short(run.drag.standard_error)
        );
        let _ = write!(
            text,
            "{:<width$} {:>8} {drag:>22}",
            run.name,
            short(run.froude)
        );
        if let Some(flow) = &run.flow {
            let lift = short(flow.lift_over_buoyancy);
            let lift = format!("{lift} +- {}", short(flow.lift_over_buoyancy_error));
            let _ = write!(text, " {lift:>22}");
        }
        text.push('\n');
    }
    text
}

/// What is to be known before numbers are believed.
fn warnings(runs: &[RunSummary]) -> Vec<String> {
    let names = |choose: &dyn Fn(&RunSummary) -> bool| {
        let chosen = runs.iter().filter(|run| choose(run));
        chosen
            .map(|run| &run.name[..])
            .collect::<Vec<_>>()
            .join(", ")
    };
    let open = names(&|run| !run.drag.converged);
    let slides = names(&|run| run.plug == Plug::Slides);
    let mut found = Vec::new();
    if !open.is_empty() {
        found.push(format!(
            "the error of the drag is not converged (drag longer: drag.distance): {open}"
        ));
    }
    if !slides.is_empty() {
        found.push(format!(
            "the bed above the intruder slides along with it (make bed.box wider): {slides}"
        ));
    }
    found
}
