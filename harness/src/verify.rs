//! Verification: pieces of a run are executed again, and every link of their chains of digests, the states
//! at their ends and the tables made from them are held against what the run wrote.

use std::fmt::Write;

use bitgrain_kernel::{PARTS, Pushed};

use crate::bed::Course;
use crate::chain::{Link, differing};
use crate::checkpoint;
use crate::drag::Dragging;
use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::random::{Purpose, uniforms};
use crate::rerun::{Part, Past};
use crate::run::{self, DragPlan, side_by_side};
use crate::scenario::{BedPlan, RunPlan};
use crate::sim::Sim;
use crate::witness::Witness;

/// A stage, or a stretch of its steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Name of the stage.
    pub stage: String,
    /// First and last step.
    pub steps: Option<(u64, u64)>,
}

impl std::str::FromStr for Segment {
    type Err = String;

    /// `run-1`, or `run-1:20000-40000`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let Some((stage, steps)) = text.split_once(':') else {
            return Ok(Self {
                stage: text.into(),
                steps: None,
            });
        };
        let ends = steps
            .split_once('-')
            .and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
        match ends {
            Some((from, to)) if from < to => Ok(Self {
                stage: stage.into(),
                steps: Some((from, to)),
            }),
            _ => Err("expected STAGE or STAGE:FROM-TO, as in run-1:20000-40000".into()),
        }
    }
}

/// What to verify.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Stages, or stretches of them; all where there are none.
    pub segments: Vec<Segment>,
    /// How many pieces, chosen at random by a seed, of these.
    pub sample: Option<(usize, u64)>,
}

/// Steps between two states that were kept, or a whole bed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Piece<'a> {
    Bed(&'a BedPlan),
    Drag(&'a RunPlan, u64, u64),
}

impl Piece<'_> {
    fn name(&self) -> &str {
        match self {
            Piece::Bed(plan) => &plan.name,
            Piece::Drag(plan, ..) => &plan.name,
        }
    }

    fn is_in(&self, segment: &Segment) -> bool {
        let overlap = match (self, segment.steps) {
            (Piece::Drag(_, from, to), Some((first, last))) => first < *to && *from < last,
            _ => true,
        };
        segment.stage == self.name() && overlap
    }
}

/// What a piece gave: how many links held, and what does not.
struct Finding {
    text: String,
    links: usize,
    holds: bool,
}

/// Verifies a run and tells of each piece as a line of `say`.
///
/// # Errors
/// [`Error::Unverified`] where something does not hold, after all was told; [`Error::Input`] where there is
/// nothing to verify.
pub fn verify(
    past: &Past<'_>,
    scope: &Scope,
    threads: usize,
    progress: &Progress,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let pieces = pieces(past, scope)?;
    let length = |k: usize| match pieces[k] {
        Piece::Bed(plan) => crate::bed::pouring_steps(&past.scenario, plan),
        Piece::Drag(_, from, to) => to - from,
    };
    let found = side_by_side(threads, threads, pieces.len(), length, |k| {
        again(past, pieces[k], progress)
    })?;
    let (mut links, mut wrong) = (0, 0);
    let all = scope.segments.is_empty() && scope.sample.is_none();
    for (piece, found) in pieces.iter().zip(found) {
        // A damaged file is a finding, a wish to stop is none.
        let finding = match found {
            Err(e @ (Error::Interrupted { .. } | Error::Contract { .. })) => return Err(e),
            Err(e) => Finding {
                text: format!("{}: cannot be run again: {e}", piece.name()),
                links: 0,
                holds: false,
            },
            Ok(finding) => finding,
        };
        say(&finding.text)?;
        links += finding.links;
        wrong += usize::from(!finding.holds);
    }
    let count = pieces.len();
    if all && wrong == 0 && past.folder.summary().exists() {
        let path = past.folder.summary();
        if std::fs::read_to_string(&path).ok() != Some(summary_text(past)?) {
            let place = path.display();
            return Err(Error::Unverified {
                problem: format!("{place}: not what the checkpoints give"),
            });
        }
    }
    if wrong > 0 {
        let place = past.folder.0.display().to_string();
        return Err(Error::Unverified {
            problem: format!("{place}: {wrong} of {count} pieces do not hold"),
        });
    }
    say(&format!("all {links} links of {count} pieces hold"))
}

/// The run's own summary, made from its beds and the last checkpoints of its drags.
fn summary_text(past: &Past<'_>) -> Result<String> {
    let plans = past.scenario.beds();
    let mut beds = Vec::with_capacity(plans.len());
    for plan in &plans {
        beds.push(past.bed(plan)?);
    }
    let mut runs = Vec::new();
    for plan in &past.runs {
        let drag = past.drag(plan, &beds[plan.bed]);
        let (mut sim, dragging) = past.state(drag, plan.steps)?;
        runs.push(run::results(drag, &dragging, &mut sim)?.1);
    }
    let whole = run::whole_summary(past.folder, &past.scenario, beds, runs);
    run::json_text(&past.folder.summary(), &whole)
}

/// The pieces that are asked for.
fn pieces<'a>(past: &'a Past<'_>, scope: &Scope) -> Result<Vec<Piece<'a>>> {
    for segment in &scope.segments {
        past.part(&segment.stage)?;
    }
    let mut pieces = Vec::new();
    for part in past.parts() {
        match part {
            // Of what has come to its end nothing may be missing.
            Part::Bed(plan) => {
                if past.folder.bed(&plan.name).exists() || past.folder.summary().exists() {
                    pieces.push(Piece::Bed(plan));
                }
            }
            Part::Drag(plan) => {
                let mut from = 0;
                let ended = past.folder.of_run(&plan.name, "summary.json").exists()
                    || past.folder.summary().exists();
                let kept = |n: u64| past.folder.checkpoint(&plan.name, n).exists();
                let there = |n: &&u64| ended || kept(**n);
                for &to in plan.checkpoints.iter().filter(there) {
                    pieces.push(Piece::Drag(plan, from, to));
                    from = to;
                }
            }
        }
    }
    if !scope.segments.is_empty() {
        pieces.retain(|piece| scope.segments.iter().any(|segment| piece.is_in(segment)));
    }
    if let Some((count, seed)) = scope.sample {
        // Beds are whole pieces: a sample is of the drags, unless beds were asked for.
        if scope.segments.is_empty() {
            pieces.retain(|piece| matches!(piece, Piece::Drag(..)));
        }
        for k in 0..pieces.len().saturating_sub(count) {
            let [x] = uniforms(seed, Purpose::Sample, k as u32);
            pieces.remove((x * pieces.len() as f64) as usize);
        }
    }
    if pieces.is_empty() {
        let place = past.folder.0.display().to_string();
        let problem = "holds no kept checkpoint of what was asked for: nothing can be verified yet";
        return Err(Error::input(place, problem));
    }
    Ok(pieces)
}

fn again(past: &Past<'_>, piece: Piece<'_>, progress: &Progress) -> Result<Finding> {
    match piece {
        Piece::Bed(plan) => bed_again(past, plan, progress),
        Piece::Drag(plan, from, to) => drag_again(past, plan, [from, to], progress),
    }
}

/// Holds links against the recorded ones, and stops at the first that does not hold; holds snapshots
/// against those that were written.
struct Check<'a> {
    drag: Option<DragPlan<'a>>,
    recorded: &'a [Link],
    ends: u64,
    held: usize,
    broken: Option<String>,
}

impl<'a> Check<'a> {
    fn new(recorded: &'a [Link], ends: u64) -> Self {
        Self {
            drag: None,
            recorded,
            ends,
            held: 0,
            broken: None,
        }
    }
}

impl Witness for Check<'_> {
    fn linked(&mut self, link: &Link) -> Result<()> {
        let recorded = self.recorded.iter().find(|one| one.step == link.step);
        match recorded {
            Some(one) if one == link => self.held += 1,
            Some(one) => {
                let parts = differing(&one.parts, &link.parts);
                let parts = match parts.len() {
                    0 => "a link before it".to_string(),
                    n if n == PARTS.len() => "every part".into(),
                    _ => parts.join(", "),
                };
                let text = format!(
                    "the link at step {} does not hold: {parts} differ",
                    link.step
                );
                self.broken = Some(text);
            }
            None => self.broken = Some(format!("no link was recorded at step {}", link.step)),
        }
        Ok(())
    }

    fn looks_at(&self, step: u64) -> bool {
        let shown = |drag: &DragPlan<'_>| drag.plan.snapshots.binary_search(&step).is_ok();
        self.drag.as_ref().is_some_and(shown)
    }

    fn look(&mut self, step: u64, sim: &mut Sim, contacts: &[Pushed<f64>]) -> Result<()> {
        let Some(drag) = self.drag else {
            return Ok(());
        };
        for (path, bytes) in drag.snapshot_files(step, sim, contacts)? {
            if std::fs::read(&path).ok() != Some(bytes) {
                let name = path.display();
                self.broken = Some(format!("{name} is missing or not as it was written"));
            }
        }
        Ok(())
    }

    fn ends(&self) -> u64 {
        if self.broken.is_some() { 0 } else { self.ends }
    }
}

impl Check<'_> {
    /// What to say of the piece, whose last state was found `same`.
    fn finding(&self, name: &str, [from, to]: [u64; 2], same: bool, more: &str) -> Finding {
        let mut text = format!("{name}: steps {from} to {to}: ");
        let links = |n: usize| format!("{n} link{}", if n == 1 { "" } else { "s" });
        let holds = match &self.broken {
            Some(broken) => {
                let _ = write!(text, "{broken}; {} before it hold", links(self.held));
                false
            }
            None if !same => {
                let _ = write!(
                    text,
                    "{} hold, but the state at the end, or what was measured on the way, is not what \
                     was written",
                    links(self.held)
                );
                false
            }
            None => {
                let _ = write!(text, "{} hold{more}", links(self.held));
                true
            }
        };
        Finding {
            text,
            links: self.held,
            holds,
        }
    }
}

/// Pours a bed again, or takes it over again.
fn bed_again(past: &Past<'_>, plan: &BedPlan, progress: &Progress) -> Result<Finding> {
    let path = past.folder.bed(&plan.name);
    let bytes = std::fs::read(&path).map_err(|e| Error::read(&path, &e))?;
    let name = path.display().to_string();
    let (settled, note) = checkpoint::unpack(&bytes, &name)?;
    let course = Course::of(&note).map_err(|problem| Error::Damaged {
        place: name,
        problem,
    })?;
    let chain = past.folder.bed_chain(&plan.name);
    let text = std::fs::read_to_string(&chain).unwrap_or_default();
    let (data, bytes_of_data) = run::data_file(past.folder, &past.scenario, plan, &settled)?;
    // A bed below a lid is for nobody else.
    let exported =
        !past.scenario.beds().contains(plan) || std::fs::read(data).ok() == Some(bytes_of_data);
    let written = text == course.chain().text() && exported;
    let mut check = Check::new(&course.chain().links, u64::MAX);
    let first = course.chain().links.first().map_or(0, |link| link.step);
    let steps = [first, settled.step_count()];
    let mut bed = run::begin_bed(past.folder, &past.scenario, plan)?;
    // Its first link was made as it began.
    check.linked(&bed.course.chain().links[0])?;
    let mut stage = progress.stage(&plan.name, settled.step_count());
    let settled = bed.go_on(&past.scenario, plan, &mut stage, &mut check)?;
    let note = bed.course.note();
    let same = settled && checkpoint::pack(&mut bed.sim, &note) == bytes && written;
    let more = match past.scenario.source {
        Some(_) => " (taken over again)",
        None => "",
    };
    Ok(check.finding(&plan.name, steps, same, more))
}

/// Drags again from one kept state to the next.
fn drag_again(
    past: &Past<'_>,
    plan: &RunPlan,
    steps: [u64; 2],
    progress: &Progress,
) -> Result<Finding> {
    let [from, to] = steps;
    let bed = past.bed_of(plan)?;
    let drag = past.drag(plan, &bed);
    let path = past.folder.checkpoint(&plan.name, to);
    let bytes = std::fs::read(&path).map_err(|e| Error::read(&path, &e))?;
    let (_, recorded) = run::read(drag, &path)?;
    let (mut sim, mut dragging) = past.state(drag, from)?;
    let mut check = Check::new(&recorded.chain.links, to);
    check.drag = Some(drag);
    // What the checkpoint that it begins from says of the way up to there.
    let before = dragging.chain.links.last().map_or(0, |link| link.step);
    let same = |one: &Dragging, other: &Dragging| {
        let until = |d: &Dragging| {
            d.chain
                .links
                .iter()
                .take_while(|l| l.step <= before)
                .count()
        };
        one.chain.links[..until(one)] == other.chain.links[..until(other)]
    };
    if !same(&dragging, &recorded) {
        check.broken = Some(format!("its checkpoints do not agree about step {before}"));
    } else if from == 0 {
        check.held += 1;
    }
    let mut stage = progress.stage(&format!("{} from {from}", plan.name), to);
    stage.resume(from);
    dragging.go_on(&mut sim, &past.scenario, plan, &stage, &mut check)?;
    let note = dragging.note();
    let mut same = checkpoint::pack(&mut sim, &note) == bytes;
    let mut more = String::new();
    if same && check.broken.is_none() && to == plan.steps {
        let (tables, summary) = run::results(drag, &dragging, &mut sim)?;
        let place = past.folder.of_run(&plan.name, "summary.json");
        let summary = run::json_text(
            &place,
            &run::record(drag.folder, drag.scenario, drag.bed, &summary),
        )?;
        let tables = tables.into_iter().chain([("summary.json", summary)]);
        let wrong: Vec<&str> = tables
            .filter(|(file, text)| {
                let written = std::fs::read_to_string(past.folder.of_run(&plan.name, file));
                written.ok().as_ref() != Some(text)
            })
            .map(|(file, _)| file)
            .collect();
        if wrong.is_empty() {
            more = ", and its tables are as written".into();
        } else {
            let files = wrong.join(", ");
            check.broken = Some(format!(
                "{files} of its folder: missing or not as it was written"
            ));
            same = false;
        }
    }
    Ok(check.finding(&plan.name, steps, same, &more))
}
