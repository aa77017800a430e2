//! Spheres dragged along x and free along z, beside the same drag with the sphere held in its height: the lift on the
//! held one against the weight of the free one, and whether it rose.

use super::runs::FreeRun;
use bitgrain_lab::scenario::Release;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::block_averaging::Mean;

/// Standard errors by which the lift must differ from the weight to foretell anything.
const SURE: f64 = 2.0;

/// Change of height, in mean diameters, from which a sphere rose or sank.
const MOVED: f64 = 0.1;

/// Upward, downward or neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Upward.
    Rises,
    /// Downward.
    Sinks,
    /// Neither, as far as can be told.
    Open,
}

impl Way {
    fn of(value: f64, bound: f64) -> Self {
        match () {
            () if value > bound => Way::Rises,
            () if value < -bound => Way::Sinks,
            () => Way::Open,
        }
    }

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Way::Rises => "rises",
            Way::Sinks => "sinks",
            Way::Open => "neither",
        }
    }
}

/// A floating drag and its twin.
#[derive(Clone, Debug, PartialEq)]
pub struct Float {
    /// Name of its run.
    pub name: String,
    /// Name of the drag with the sphere held in its height.
    pub twin: String,
    /// Speed along x.
    pub speed: f64,
    /// Weight of the sphere.
    pub weight: f64,
    /// Weight of as much of the bed as it displaces, at the bulk density of the settled bed.
    pub buoyancy: f64,
    /// Lift on the held sphere.
    pub lift: Mean,
    /// What lift and weight foretell, whatever the error of the lift.
    pub points: Way,
    /// The same if the lift differs from the weight by two standard errors.
    pub foretold: Way,
    /// Change of height of the free sphere, from its beginning to its end.
    pub rise: f64,
    /// What that is.
    pub found: Way,
    /// Drag on the held and on the free sphere.
    pub drags: [Mean; 2],
    /// Depth of its centre below the free surface at its end.
    pub depth: f64,
}

/// The floating drags of a run directory.
pub fn floats(summary: &Summary, runs: &[FreeRun<'_>]) -> Vec<Float> {
    let inputs = &summary.inputs;
    let float = |free: &FreeRun<'_>| {
        let Release::Floating { .. } = free.release else {
            return None;
        };
        let (run, released) = (free.run, free.released);
        let twin = summary.runs.iter().find(|other| {
            (other.released.is_none(), &other.bed, other.speed) == (true, &run.bed, run.speed)
        })?;
        let bed = summary.beds.iter().find(|bed| bed.name == run.bed)?;
        let weight = released.mass * inputs.gravity;
        let bulk = bed.packing_fraction * inputs.bed.density;
        let rise = released.end[2] - released.begin[2];
        let lift = twin.lift;
        Some(Float {
            name: run.name.clone(),
            twin: twin.name.clone(),
            speed: run.speed,
            weight,
            buoyancy: bulk * inputs.gravity * inputs.intruder_volume(run.diameter),
            lift,
            points: Way::of(lift.mean - weight, 0.0),
            foretold: Way::of(lift.mean - weight, SURE * lift.standard_error),
            rise,
            found: Way::of(rise, MOVED * inputs.mean_diameter()),
            drags: [twin.drag, run.drag],
            depth: released.surface - released.end[2],
        })
    };
    runs.iter().filter_map(float).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_is_told_beyond_its_bound() {
        assert_eq!(Way::of(0.3, 0.2), Way::Rises);
        assert_eq!(Way::of(-0.3, 0.2), Way::Sinks);
        assert_eq!(Way::of(0.1, 0.2), Way::Open);
        assert_eq!(Way::of(f64::NAN, 0.2), Way::Open);
    }
}
