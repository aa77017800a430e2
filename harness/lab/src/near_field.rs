//! What is measured of the grains round an intruder, beside the force on it: where they touch it, how
//! many contacts they have, and how much of the bed moves along.

use bitgrain_kernel::{Domain, Motion, Obstacle};
use serde::{Deserialize, Serialize};

use bitgrain_sim::block_averaging::{BlockSums, Mean};
use bitgrain_sim::contact_count::ContactCount;
use bitgrain_sim::histogram::{Angles, Coordination};
use bitgrain_sim::motion::Moves;
use bitgrain_sim::notes::ObstacleNote;
use bitgrain_sim::observe::{self, INTRUDER};
use bitgrain_sim::simulation::{Role, Simulation};

/// Grains whose centres lie within this many mean diameters of the intruder's surface are its
/// neighbourhood (Kumar 2018, Fig. 7).
pub const NEAR: f64 = 2.0;

/// Grains that go at this part of the intruder's speed or faster count as moving with it (Kumar
/// 2018, Fig. 9, does not define "comparable").
pub const ALONG: f64 = 0.5;

/// Sums over the averaging window, and what one step hands to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NearField {
    /// Places of the grains that touched the intruder after the last step.
    touching: Vec<u32>,
    angle: BlockSums,
    new_angle: BlockSums,
    coordination: BlockSums,
    floating: BlockSums,
    moving: BlockSums,
    drift: BlockSums,
    /// The grains within other distances; none in the states of runs that measured none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    reaches: Vec<Within>,
}

/// Sums over the grains within a distance of the intruder's surface.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Within {
    reach: f64,
    coordination: BlockSums,
    floating: BlockSums,
}

/// Means over the grains within a distance of the intruder's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinMeans {
    /// The distance.
    pub reach: f64,
    /// Contacts of a grain.
    pub coordination: Mean,
    /// Share of the grains that have none.
    pub floating: Mean,
}

/// Means over the averaging window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NearFieldMeans {
    /// Contact angle, over all contacts of the samples.
    pub contact_angle: Option<Mean>,
    /// Contact angle of contacts as they begin, over all that began.
    pub new_contact_angle: Option<Mean>,
    /// Contacts of a grain near the intruder, over all such grains of the samples.
    pub coordination: Option<Mean>,
    /// Share of these grains that have none.
    pub floating: Option<Mean>,
    /// Free grains that go at [`ALONG`] of the intruder's speed or faster; none if the bed moves.
    pub moving: Option<Mean>,
    /// Speed along x of the free grains above the intruder's top, over the intruder's; none if the bed
    /// moves, or nothing is above.
    pub drift: Option<Mean>,
}

/// What one sample says of single moments, for the series.
pub struct Sample {
    /// Mean contact angle; none without a contact.
    pub angle: Option<f64>,
    /// Mean number of contacts of a grain near the intruder; none without grains.
    pub coordination: Option<f64>,
}

impl NearField {
    /// Nothing yet; `reaches` are the distances within which coordination is measured besides [`NEAR`].
    pub fn new(reaches: &[f64]) -> Self {
        let within = |&reach: &f64| Within {
            reach,
            ..Within::default()
        };
        Self {
            reaches: reaches.iter().map(within).collect(),
            ..Self::default()
        }
    }

    /// After every step: contacts that began with it, which are summed if the step is `counted`.
    pub fn touched(
        &mut self,
        domain: &Domain<f64>,
        intruder: &ObstacleNote,
        moves: Moves,
        counted: bool,
        angles: &mut Angles,
    ) {
        let now = intruder.touching.iter().map(|(grain, _)| *grain).collect();
        let before = std::mem::replace(&mut self.touching, now);
        if !counted {
            return;
        }
        for (grain, place) in &intruder.touching {
            // Both lists ascend.
            if before.binary_search(grain).is_err() {
                let body = &intruder.body;
                let angle = observe::contact_angle(domain, body, *place, moves.forward());
                self.new_angle.add(angle);
                angles.add_new(angle);
            }
        }
    }

    /// At a row of the series: the whole neighbourhood; its numbers are summed if it is `counted`.
    pub fn sample(
        &mut self,
        sim: &Simulation,
        contacts: &ContactCount,
        moves: Moves,
        mean_diameter: f64,
        counted: Option<(&mut Angles, &mut Coordination)>,
    ) -> Sample {
        let own = NEAR * mean_diameter;
        let reaches = self.reaches.iter().map(|within| within.reach);
        let farthest = reaches.fold(own, |a, b| if b > a { b } else { a });
        let found = observe::neighbourhood(sim, contacts, farthest, moves.forward());
        let near: Vec<f64> = found.contacts(own).collect();
        let angles = &found.angles;
        let sample = Sample {
            angle: mean(angles),
            coordination: mean(&near),
        };
        let Some((all_angles, all_near)) = counted else {
            return sample;
        };
        // Every contact and every grain counts alike, in whichever sample.
        angles.iter().for_each(|x| self.angle.add(*x));
        for &contacts in &near {
            self.coordination.add(contacts);
            self.floating.add(f64::from(u8::from(contacts == 0.0)));
        }
        for within in &mut self.reaches {
            for contacts in found.contacts(within.reach) {
                within.coordination.add(contacts);
                within.floating.add(f64::from(u8::from(contacts == 0.0)));
            }
        }
        all_angles.add(angles);
        all_near.add(&near);
        let body = sim.obstacles[INTRUDER as usize];
        let speed = body.velocity[0];
        // What goes along is judged by a speed that no force changes.
        let answers = matches!(body.motion, Motion::Free(free) if free.integrates[0]);
        if moves == Moves::Intruder && !answers && speed != 0.0 {
            let (moving, drift) = going_along(sim, &body);
            self.moving.add(moving as f64);
            drift.into_iter().for_each(|v| self.drift.add(v / speed));
        }
        sample
    }

    /// The means of what was summed.
    pub fn means(&self) -> NearFieldMeans {
        NearFieldMeans {
            contact_angle: self.angle.mean(),
            new_contact_angle: self.new_angle.mean(),
            coordination: self.coordination.mean(),
            floating: self.floating.mean(),
            moving: self.moving.mean(),
            drift: self.drift.mean(),
        }
    }

    /// The means of what was summed within other distances; those that have too few grains are left out.
    pub fn within(&self) -> Vec<WithinMeans> {
        let means = |within: &Within| {
            Some(WithinMeans {
                reach: within.reach,
                coordination: within.coordination.mean()?,
                floating: within.floating.mean()?,
            })
        };
        self.reaches.iter().filter_map(means).collect()
    }
}

/// How many free grains move along with the intruder, and the mean speed along x of those above its top.
fn going_along(sim: &Simulation, body: &Obstacle<f64>) -> (usize, Option<f64>) {
    let top = body.point[2] + body.reach();
    let least = ALONG * body.velocity[0].abs();
    let (mut moving, mut above, mut sum) = (0, 0u64, 0.0);
    for i in (0..sim.count()).filter(|&i| sim.role(i) == Role::Free) {
        let [x, y, z, _] = sim.velocity[i];
        moving += usize::from(x * x + y * y + z * z >= least * least);
        if sim.position[i][2] > top {
            above += 1;
            sum += x;
        }
    }
    (moving, (above > 0).then(|| sum / above as f64))
}

/// The mean in the order given; `None` if there are no values.
fn mean(values: &[f64]) -> Option<f64> {
    match values.len() {
        0 => None,
        n => Some(values.iter().sum::<f64>() / n as f64),
    }
}
