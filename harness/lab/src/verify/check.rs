//! One piece executed again, compared with what was recorded of it.

use std::fmt::Write;

use bitgrain_kernel::{ContactForce, PARTS};

use crate::frames;
use crate::run::DragTask;
use bitgrain_sim::chain::{Link, differing};
use bitgrain_sim::disk;
use bitgrain_sim::error::Result;
use bitgrain_sim::format::plural;
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;

/// The result of a piece: how many links held, and what does not.
pub(super) struct Finding {
    pub text: String,
    pub links: usize,
    pub holds: bool,
    /// The last link of its stage, if it is its last piece and holds.
    pub end: Option<String>,
}

impl Finding {
    /// The same of the last piece of a stage, which ends with this link.
    pub fn ending_with(mut self, link: &str) -> Self {
        self.end = self.holds.then(|| link.to_string());
        self
    }
}

/// Compares links with the recorded ones, and stops at the first that does not hold; compares snapshots
/// with those that were written.
pub(super) struct Check<'a> {
    pub drag: Option<DragTask<'a>>,
    pub frames: String,
    pub frames_after: u64,
    pub recorded: &'a [Link],
    pub ends: u64,
    pub held: usize,
    pub broken: Option<String>,
}

impl<'a> Check<'a> {
    pub fn new(recorded: &'a [Link], ends: u64) -> Self {
        Self {
            drag: None,
            frames: String::new(),
            frames_after: 0,
            recorded,
            ends,
            held: 0,
            broken: None,
        }
    }
}

impl Observer for Check<'_> {
    fn on_digest(&mut self, link: &Link) -> Result<()> {
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

    fn wants_step(&self, step: u64) -> bool {
        let shown = |drag: DragTask<'_>| drag.shows(step) || drag.films(step);
        self.drag.is_some_and(shown)
    }

    fn wants_contacts(&self, step: u64) -> bool {
        self.drag.is_some_and(|drag| drag.shows(step))
    }

    fn on_step(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        contacts: &[ContactForce<f64>],
    ) -> Result<()> {
        let Some(drag) = self.drag else {
            return Ok(());
        };
        // A file begins after the planned checkpoint before its own, also if that one is lost.
        if drag.films(step) && step > self.frames_after {
            self.frames += &frames::rows(sim, &drag.plan.motion, step);
        }
        if !drag.shows(step) {
            return Ok(());
        }
        for (path, bytes) in drag.snapshot_files(step, sim, contacts)? {
            if disk::read(&path).ok() != Some(bytes) {
                let name = path.display();
                self.broken = Some(format!("{name} is missing or not as it was written"));
            }
        }
        Ok(())
    }

    fn last_step(&self) -> u64 {
        if self.broken.is_some() { 0 } else { self.ends }
    }
}

impl Check<'_> {
    /// What to say of the piece, whose last state was found `same`.
    pub fn finding(&self, name: &str, [from, to]: [u64; 2], same: bool, more: &str) -> Finding {
        let mut text = format!("{name}: steps {from} to {to}: ");
        let links = |n: usize| plural(n, "link");
        let holds = match &self.broken {
            Some(broken) => {
                let _ = write!(text, "{broken}; {} before it hold", links(self.held));
                false
            }
            None if !same => {
                let _ = write!(
                    text,
                    "{} hold, but the state at the end, or what was measured before it, is not what \
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
            end: None,
        }
    }
}
