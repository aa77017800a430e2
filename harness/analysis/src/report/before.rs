//! The top of a run's page: what to know before its numbers are believed, and where they come from.

use super::page::{remark, row};
use super::table::folded;
use super::text::escape;
use crate::remarks::remarks as found;
use bitgrain_lab::summary::Summary;

/// The remarks on the numbers, as HTML.
pub(super) fn remarks(summary: &Summary) -> Vec<String> {
    let all = found(summary).into_iter();
    all.map(|one| remark(&escape(&one.title), &keys(&one.words)))
        .collect()
}

/// Text whose keys stand between backticks.
fn keys(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let each = parts.map(|(k, part)| match k % 2 {
        0 => escape(part),
        _ => format!("<code>{}</code>", escape(part)),
    });
    each.collect()
}

/// Where the numbers come from: command, versions, links, and the files beside the page. The closing hash is there
/// once the run is finished.
pub(super) fn about(summary: &Summary, closing: &str) -> String {
    let mut out = row(
        "Made by",
        &format!(
            "bitgrain {}, BITS_VERSION {}: <code>bitgrain run scenario.toml</code> gives the same bits on any machine",
            escape(&summary.version),
            summary.bits_version
        ),
    );
    let expect = |link: &str| {
        let command = format!("bitgrain verify . --expect {}", escape(link));
        folded(link, &command)
    };
    if !closing.is_empty() {
        out += &row("Closing hash", &expect(closing));
    }
    if let Some(last) = summary.runs.last() {
        let name = escape(&last.name);
        out += &row(&format!("Last link of {name}"), &expect(&last.chain));
    }
    out += &row(
        "Check it",
        "<code>bitgrain verify .</code> in the folder of this page runs all of it again and compares every link; \
         <code>--expect</code> with the closing hash checks that it is this run, with a last link that drag",
    );
    out + &row("Files", &files(summary))
}

/// The files beside the page.
fn files(summary: &Summary) -> String {
    let link = |path: &str, name: &str| format!("<a href=\"{path}\">{name}</a>");
    let runs = summary.runs.iter().map(|run| {
        let name = escape(&run.name);
        link(&format!("runs/{name}/forces.csv"), &name)
    });
    let runs: Vec<String> = runs.collect();
    let series = match runs.is_empty() {
        true => String::new(),
        false => format!("; forces at each row: {}", runs.join(", ")),
    };
    let shown = match summary.inputs.measure.snapshots {
        0 => "",
        _ => {
            "; <code>runs/&hellip;/snapshots</code>: grains and contacts for OVITO (dump) and ParaView (vtk)"
        }
    };
    format!(
        "{}: every number; {}: the inputs{series}{shown}; <code>beds</code>: the settled beds, as checkpoints and as \
         LAMMPS data",
        link("summary.json", "summary.json"),
        link("scenario.toml", "scenario.toml"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_set_apart_and_nothing_is_taken_for_html() {
        assert_eq!(keys("a <b> `x.y` c"), "a &lt;b&gt; <code>x.y</code> c");
    }
}
