//! How many of everything a scenario may ask for, looked at before anything is made of it; and what is asked of
//! one that comes from a file of results.

use super::keys::values;
use super::refusal::{Check, refuse};
use super::{IntruderMotion, IntruderShape, OneOrMany, Scenario};

/// Travel over D before a cylinder's steady state (Guillard 2014, section III A).
pub(super) const STEADY: f64 = 2.0;

/// Most values of one list.
const VALUES_MAX: usize = 1000;

/// Most drags of one scenario: a campaign takes more.
const RUNS_MAX: usize = 1000;

/// Most snapshots of one drag: a guard of the disk against typing errors.
const SNAPSHOTS_MAX: u64 = 100_000;

/// Most checkpoints kept of one drag: the same for larger files.
const CHECKPOINTS_MAX: u64 = 1000;

/// Most distances within which coordination numbers are measured: each has six columns of a campaign's table.
const REACHES_MAX: usize = 16;

/// Most snapshots and checkpoints of all drags together.
const STOPS_MAX: u64 = 10_000_000;

/// Most grains of a bed.
pub(super) const GRAINS_MAX: usize = 100_000_000;

/// Where the file of an imported bed lies in a run directory.
const IMPORTED: &str = "beds/imported/";

/// How many values a key has that may be left out.
fn count(key: &Option<OneOrMany>) -> usize {
    values(key).len()
}

impl Scenario {
    /// Lists that are too long, or too many drags: nothing has been made of them yet.
    pub(super) fn check_counts(&self) -> Check {
        if self.measure.snapshots > SNAPSHOTS_MAX {
            let problem = format!("expected at most {SNAPSHOTS_MAX} for each drag");
            return refuse("measure.snapshots", problem);
        }
        if !(1..=CHECKPOINTS_MAX).contains(&self.measure.checkpoints) {
            let problem = format!("expected 1 to {CHECKPOINTS_MAX} for each drag");
            return refuse("measure.checkpoints", problem);
        }
        let reaches = &self.measure.reaches;
        let ascend = reaches.windows(2).all(|pair| pair[0] < pair[1]);
        let lengths = reaches.iter().all(|x| x.is_finite() && *x > 0.0);
        if reaches.len() > REACHES_MAX || !ascend || !lengths {
            let problem =
                format!("is {reaches:?}; expected at most {REACHES_MAX} ascending lengths");
            return refuse("measure.reaches", problem);
        }
        let (i, lid) = (&self.intruder, self.lid.as_ref());
        let places = [&i.height, &i.depth].map(count);
        let speeds = [&i.speed, &i.froude].map(count);
        let timed = [&i.drop_height, &i.force].map(count);
        let lids = lid.map_or([0; 2], |lid| {
            [&lid.effective_depth, &lid.density].map(count)
        });
        let lists = [
            ("seeds", self.seeds.len()),
            ("intruder.diameter", i.diameter.values().len()),
            ("intruder.height", places[0]),
            ("intruder.depth", places[1]),
            ("intruder.speed", speeds[0]),
            ("intruder.froude", speeds[1]),
            ("lid.effective_depth", lids[0]),
            ("lid.density", lids[1]),
            ("intruder.drop_height", timed[0]),
            ("intruder.force", timed[1]),
            ("drag.distance", self.drag.distance.values().len()),
            ("drag.duration", count(&self.drag.duration)),
        ];
        if let Some((key, n)) = lists.iter().find(|(_, n)| *n > VALUES_MAX) {
            return refuse(
                key,
                format!("has {n} values; expected at most {VALUES_MAX}"),
            );
        }
        let each = 1 + usize::from(i.motion == IntruderMotion::Floating);
        // A lid is given with and without a pressure gradient at most.
        let factors = [
            self.seeds.len().max(1),
            i.diameter.values().len(),
            (places[0] + places[1]).max(1),
            // One that floats is dragged twice at each speed.
            each * (speeds[0] + speeds[1]) + timed[0] + timed[1],
            lid.map_or(1, |_| 2 * (lids[0] + lids[1])),
        ];
        let runs = factors
            .iter()
            .fold(1usize, |n, factor| n.saturating_mul(*factor));
        if runs > RUNS_MAX {
            let problem = format!(
                "makes about {runs} drags with its speeds, sizes and places, lids and seeds; expected at most \
                 {RUNS_MAX}: give fewer values, or make a campaign of them"
            );
            return refuse("intruder", problem);
        }
        let stops = self.measure.snapshots + self.measure.checkpoints;
        if stops.saturating_mul(runs as u64) > STOPS_MAX {
            let problem = format!(
                "makes too many with those of all {runs} drags; expected at most {STOPS_MAX}, checkpoints counted"
            );
            return refuse("measure.snapshots", problem);
        }
        Ok(())
    }

    /// The same rules as for a scenario's file, of inputs as a file of results has them: with every default
    /// written out, and the file of an imported bed in the run directory. No file is looked at.
    ///
    /// # Errors
    /// The key that is wrong, and what is wrong with it.
    pub(super) fn check_written_out(&self) -> Check {
        self.check_all()?;
        if self.intruder.shape == IntruderShape::Sphere && self.intruder.density.is_none() {
            return refuse("intruder.density", "is missing");
        }
        let Some(file) = &self.bed.file else {
            return Ok(());
        };
        let name = file.strip_prefix(IMPORTED).unwrap_or_default();
        if name.is_empty() || name == ".." || name == "." || name.contains(['/', '\\', '\0']) {
            return refuse(
                "bed.file",
                format!("expected a file in {IMPORTED}, its place in a run directory"),
            );
        }
        let hash = self.bed.hash.as_deref().unwrap_or_default();
        if hash.len() != 64 || !hash.bytes().all(|c| c.is_ascii_hexdigit()) {
            return refuse("bed.hash", "expected the 64 hex digits of that file's hash");
        }
        match self.bed.grains {
            Some(_) => Ok(()),
            None => refuse("bed.grains", "is missing"),
        }
    }
}
