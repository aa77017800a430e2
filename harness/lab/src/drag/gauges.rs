//! What is summed of the force on an intruder, step by step, and the means that come of it.

use serde::{Deserialize, Serialize};

use crate::flow::FlowMeans;
use crate::near_field::NearFieldMeans;
use bitgrain_sim::block_averaging::{BlockSums, Mean};
use bitgrain_sim::notes::ObstacleNote;

/// Means over the averaging window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means {
    /// Force against the motion.
    pub drag: Mean,
    /// Upward force.
    pub lift: Mean,
    /// Force along y.
    pub side: Mean,
    /// Grains that touch the intruder.
    pub contacts: Mean,
    /// The grains round it.
    pub around: NearFieldMeans,
    /// Drag over all steps.
    pub drag_uncut: f64,
    /// Steps in the window.
    pub window_steps: u64,
    /// How a bed flowed that has a lid, a cylinder in it, or moves.
    pub flow: Option<FlowMeans>,
}

/// Sums of one window of steps.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sums {
    force: [f64; 3],
    steps: u64,
}

impl Sums {
    fn add(&mut self, force: [f64; 3]) {
        for a in 0..3 {
            self.force[a] += force[a];
        }
        self.steps += 1;
    }

    pub fn mean(&self) -> [f64; 3] {
        self.force.map(|f| f / self.steps as f64)
    }
}

/// All that is measured of the intruder during the drag.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Gauges {
    force: [BlockSums; 3],
    contacts: BlockSums,
    pub since_row: Sums,
    pub all: Sums,
}

impl Gauges {
    /// Sums the force of a step, and if it is `counted` the quantities of the means.
    pub fn read(&mut self, intruder: &ObstacleNote, force: [f64; 3], counted: bool) {
        self.since_row.add(force);
        self.all.add(force);
        if counted {
            for a in 0..3 {
                self.force[a].add(force[a]);
            }
            self.contacts.add(intruder.touching.len() as f64);
        }
    }

    pub fn means(&self, window_steps: u64) -> Option<Means> {
        Some(Means {
            drag: self.force[0].mean()?,
            lift: self.force[1].mean()?,
            side: self.force[2].mean()?,
            contacts: self.contacts.mean()?,
            around: NearFieldMeans::default(),
            drag_uncut: self.all.mean()[0],
            window_steps,
            flow: None,
        })
    }
}
