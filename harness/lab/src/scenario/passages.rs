//! The drags of a bed: at which speeds, by which forces or from which heights, how far or for how long, and which
//! steps are averaged.

use super::keys::values;
use super::plan::STEPS_MAX;
use super::refusal::{Check, positive, refuse};
use super::rig::HIGHER;
use super::{IntruderMotion, IntruderShape, OneOrMany, PouringOrder, Release, Scenario};
use bitgrain_sim::format::short;
use bitgrain_sim::motion::{Motion, Moves};

/// A drag of some bed, before it has a name.
pub(super) struct Passage {
    pub release: Release,
    /// Of one that is timed, the speed is a scale: that of the fall's end, or sqrt(g d).
    pub motion: Motion,
    pub froude: f64,
    /// Travel at that speed.
    pub distance: f64,
    /// The same where averaging begins.
    pub discard: f64,
    /// The same where it ends.
    pub window_end: f64,
}

/// The value for the k-th of several, of one for all or one for each.
fn of(values: &[f64], k: usize) -> f64 {
    let last = values.len().saturating_sub(1);
    values.get(k.min(last)).copied().unwrap_or(f64::NAN)
}

impl Scenario {
    /// Whether the intruder begins above the bed, which is poured without it.
    pub fn is_dropped(&self) -> bool {
        self.intruder.motion == IntruderMotion::Dropped
    }

    /// How the grains are released; a bed below an intruder is poured up to it.
    pub fn pouring_order(&self) -> PouringOrder {
        match self.is_dropped() {
            true => PouringOrder::InTurn,
            false => self.bed.pouring,
        }
    }

    /// The drags of a bed with an intruder of this diameter, in their order: at each speed, and then by each force or
    /// from each height. One that floats is held in its height first.
    pub(super) fn passages(&self, diameter: f64) -> Vec<Passage> {
        let intruder = &self.intruder;
        let spins = intruder.spins;
        let speeds = self.speeds(diameter).into_iter().enumerate();
        let mut all: Vec<Passage> = Vec::new();
        for (k, speed) in speeds {
            all.push(self.dragged(Release::Dragged, speed, k, diameter));
            if intruder.motion == IntruderMotion::Floating {
                all.push(self.dragged(Release::Floating { spins }, speed, k, diameter));
            }
        }
        let heights = values(&intruder.drop_height).into_iter();
        let drops = heights.map(|height| Release::Dropped { height });
        let forces = values(&intruder.force).into_iter();
        let rises = intruder.rises;
        let pulls = forces.map(|force| Release::Pulled {
            force,
            rises,
            spins,
        });
        let timed = drops.chain(pulls).enumerate();
        all.extend(timed.map(|(k, release)| self.timed(release, k, diameter)));
        all
    }

    /// The k-th drag at a speed along x.
    fn dragged(
        &self,
        release: Release,
        (speed, froude): (f64, f64),
        k: usize,
        diameter: f64,
    ) -> Passage {
        let distance = of(&self.drag.distance.values(), k);
        let default = self.default_discard(diameter, distance);
        let discard = self.drag.discard.unwrap_or(default);
        let steps = (distance / (speed * self.drag.dt)).round() as u64;
        let window_end = self.window_end(distance);
        let motion = self.motion(speed, steps);
        // For an endless drag, which is refused, nothing is counted step by step.
        let sane = steps <= STEPS_MAX && (speed * self.drag.dt).is_normal();
        Passage {
            release,
            motion: match sane {
                true if window_end < distance => motion
                    .averaged_beyond(discard, steps)
                    .averaged_up_to(window_end),
                true => motion.averaged_beyond(discard, steps),
                false => motion,
            },
            froude,
            distance,
            discard,
            window_end,
        }
    }

    /// The k-th drop or pull. Of a drop all steps are averaged, of a pull the second half.
    fn timed(&self, release: Release, k: usize, diameter: f64) -> Passage {
        let scale = match release {
            Release::Dropped { height } => 2.0 * height,
            _ => self.mean_diameter(),
        };
        let speed = (self.gravity * scale).sqrt();
        let duration = of(&values(&self.drag.duration), k);
        let steps = (duration / self.drag.dt).round() as u64;
        let motion = self.motion(speed, steps);
        let before = match release {
            Release::Dropped { .. } => 0,
            _ => steps / 2,
        };
        Passage {
            release,
            motion: Motion {
                window: [before + 1, steps],
                ..motion
            },
            froude: self.froude(speed, diameter),
            distance: motion.travel(steps),
            discard: motion.travel(before),
            window_end: motion.travel(steps),
        }
    }

    fn motion(&self, speed: f64, steps: u64) -> Motion {
        Motion {
            moves: self.drag.moves,
            speed,
            dt: self.drag.dt,
            grain_diameter: self.mean_diameter(),
            window: [steps, steps],
            last: steps,
        }
    }

    /// Speeds, forces or heights, and how far or how long: what each motion needs, and nothing else.
    pub(super) fn check_motion(&self) -> Check {
        let (i, drag) = (&self.intruder, &self.drag);
        let motion = i.motion;
        let needs = |only: IntruderMotion, key: &str, list: &Option<OneOrMany>, word: &str| match (
            motion == only,
            list,
        ) {
            (false, Some(_)) => refuse(
                key,
                format!("is of an intruder that is {word}; leave it out"),
            ),
            (true, None) => refuse(
                key,
                format!("is missing; an intruder that is {word} needs it"),
            ),
            (true, Some(list)) if list.values().is_empty() => {
                refuse(key, "is empty; expected at least one value")
            }
            (true, Some(list)) => list.values().iter().try_for_each(|x| positive(key, *x)),
            (false, None) => Ok(()),
        };
        use IntruderMotion::{Dragged, Dropped, Pulled};
        needs(Dropped, "intruder.drop_height", &i.drop_height, "dropped")?;
        needs(Pulled, "intruder.force", &i.force, "pulled")?;
        if i.rises && motion != Pulled {
            return refuse(
                "intruder.rises",
                "is of an intruder that is pulled; leave it out",
            );
        }
        if i.spins && matches!(motion, Dragged | Dropped) {
            let why = match motion {
                Dropped => "is true of every intruder that is dropped; leave it out",
                _ => "is of an intruder that is pulled or floats; leave it out",
            };
            return refuse("intruder.spins", why);
        }
        self.check_speeds()?;
        if motion == Dragged {
            return Ok(());
        }
        let others = [
            (
                i.shape != IntruderShape::Sphere,
                "intruder.shape",
                "is of a wall, infinitely heavy, and only a sphere has a mass that forces move; leave it out",
            ),
            (
                self.lid.is_some(),
                "lid",
                "carries the bed past an intruder at constant speed, and one that forces move has none; leave it out",
            ),
            (
                drag.moves == Moves::Bed,
                "drag.moves",
                "is \"bed\", which goes past an intruder that is held, and forces move this one; leave it out",
            ),
            (
                self.measure.fields.is_some(),
                "measure.fields",
                "are means round an intruder at constant speed, and one that forces move has none; leave it out",
            ),
        ];
        match others.iter().find(|(given, ..)| *given) {
            Some((_, key, why)) => refuse(key, *why),
            None => self.check_dropped(),
        }
    }

    /// The speeds along x of what has some.
    fn check_speeds(&self) -> Check {
        let i = &self.intruder;
        match (&i.speed, &i.froude) {
            (Some(_), Some(_)) => {
                return refuse("intruder.speed", "give speed or froude, not both");
            }
            (None, None)
                if matches!(i.motion, IntruderMotion::Dragged | IntruderMotion::Floating) =>
            {
                return refuse("intruder.speed", "give speed or froude");
            }
            (None, None) => return Ok(()),
            _ => {}
        }
        let key = if i.speed.is_some() {
            "intruder.speed"
        } else {
            "intruder.froude"
        };
        if self.is_dropped() {
            return refuse(
                key,
                "is of an intruder that goes along x, and this one is dropped; leave it out",
            );
        }
        let diameter = i.diameter.values()[0];
        let speeds = self.speeds(diameter);
        if speeds.is_empty() {
            return refuse(key, "is empty; expected at least one value");
        }
        speeds
            .iter()
            .try_for_each(|&(v, froude)| positive(key, if i.speed.is_some() { v } else { froude }))
    }

    /// One distance for all speeds, or one for each; one duration for all drops or pulls, or one for each.
    pub(super) fn check_lengths(&self) -> Check {
        let i = &self.intruder;
        let speeds = self.speeds(i.diameter.values()[0]).len();
        let timed = values(&i.drop_height).len() + values(&i.force).len();
        let given = [
            (
                "drag.distance",
                self.drag.distance.values(),
                speeds,
                "speeds",
            ),
            (
                "drag.duration",
                values(&self.drag.duration),
                timed,
                "drops or pulls",
            ),
        ];
        for (key, lengths, n, of_what) in given {
            match (lengths.len(), n) {
                (0, 0) => continue,
                (0, _) => {
                    return refuse(
                        key,
                        format!("is missing; expected one for all {of_what}, or one for each"),
                    );
                }
                (_, 0) => {
                    let problem = format!("is given, but there are no {of_what}; leave it out");
                    return refuse(key, problem);
                }
                (found, n) if found != 1 && found != n => {
                    return refuse(
                        key,
                        format!(
                            "has {found} values for {n} {of_what}; expected one, or one for each"
                        ),
                    );
                }
                _ => lengths.iter().try_for_each(|x| positive(key, *x))?,
            }
        }
        Ok(())
    }

    /// A drop needs a bed that is poured, and room above it.
    fn check_dropped(&self) -> Check {
        if !self.is_dropped() {
            return Ok(());
        }
        if self.bed.file.is_some() {
            return refuse(
                "bed.file",
                "holds an intruder in its place; one that is dropped needs a bed that is poured",
            );
        }
        if self.intruder.height.is_some() || self.intruder.depth.is_some() {
            let key = self.height_key();
            return refuse(
                key,
                "is of an intruder in the bed, and this one is dropped; leave it out",
            );
        }
        if self.drag.discard.is_some() {
            return refuse(
                "drag.discard",
                "is of drags along x, and of a drop every step counts; leave it out",
            );
        }
        let z = self.bed.size[2];
        match self.intruder.diameter.values().iter().find(|d| **d > z) {
            Some(d) => refuse(
                "bed.box",
                format!("has a height of {z}; expected D or more, {d}"),
            ),
            None => Ok(()),
        }
    }

    /// Room in the box between the bed and the place where an intruder that is dropped waits, over the box.
    pub(super) fn check_room_above(&self, surface: f64) -> Check {
        let (z, d) = (self.bed.size[2], self.mean_diameter());
        let needed = (1.0 + HIGHER) * surface + d;
        if needed <= z {
            return Ok(());
        }
        refuse(
            "bed.box",
            format!(
                "has a height of {z}, but a bed that a sphere is dropped on needs {}: make it higher",
                short(needed)
            ),
        )
    }
}
