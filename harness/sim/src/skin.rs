//! How far to list pairs: chosen from what it costs, while a simulation runs. It has no effect on any
//! bit.
//!
//! With a wider skin more pairs are evaluated that do not touch; with a narrower one the list is rebuilt
//! more often. If the number of those pairs grows with a power `p` of the skin and the steps that a
//! list lasts grow with the skin itself, the sum is least when picking costs `p` times as much as
//! the pairs that do not touch. The reach of the candidates likewise weighs searches against picking.

use std::time::{Duration, Instant};

use bitgrain_kernel::World;

/// Power of the skin that the number of near pairs grows with, in a bed that was shaken or sheared.
const POWER: f64 = 0.7;

/// A change of the skin at a time: small, so that a wrong time of a busy machine has little effect.
const CHANGE: f64 = 1.1;

fn change(wider: bool) -> f64 {
    if wider { CHANGE } else { 1.0 / CHANGE }
}

/// Skins are kept within these parts of a grain's radius.
const SKINS: [f64; 2] = [1e-4, 0.4];
/// So are reaches.
const OUTER_SKINS: [f64; 2] = [0.02, 1.0];

/// What is known of the costs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Skin {
    /// When stepping with the present list began.
    since: Option<Instant>,
    /// Time that picking took since the last search.
    picking: Duration,
}

/// The lists at a moment: what a renewal changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lists {
    outer_list_rebuilds: u64,
    prunes: u64,
    listed: usize,
    touching: usize,
}

impl Lists {
    pub fn of(world: &World<'_, f64>) -> Self {
        Self {
            outer_list_rebuilds: world.clock.outer_list_rebuilds(),
            prunes: world.clock.prunes(),
            listed: world.clock.listed(),
            touching: world.clock.listed_touching(),
        }
    }
}

impl Skin {
    /// Steps do not go on from here: what follows does not count towards the cost of a list.
    pub fn on_checkpoint(&mut self) {
        self.since = None;
    }

    /// Records a renewal, if there was one since `began`, when the lists were as `before`; changes
    /// skin and reach for the next one.
    pub fn learn(&mut self, world: &mut World<'_, f64>, before: Lists, began: Instant) {
        let now = Lists::of(world);
        if now.prunes == before.prunes {
            return;
        }
        let renewing = began.elapsed();
        if now.outer_list_rebuilds > before.outer_list_rebuilds {
            // Candidates grow with about the reach, and so do the candidates that are examined but not picked.
            let vain = self.picking.mul_f64(0.5);
            if !self.picking.is_zero() {
                world.outer_skin *= change(renewing > vain);
            }
            self.picking = Duration::ZERO;
        } else {
            self.picking += renewing;
            if let Some(since) = self.since {
                let stepping = began.saturating_duration_since(since);
                // A grain costs about as much as a pair.
                let idle = before.listed.saturating_sub(before.touching);
                let share = idle as f64 / (before.listed + world.grains.count()).max(1) as f64;
                let vain = stepping.mul_f64(POWER * share);
                world.skin *= change(renewing > vain);
            }
        }
        let radius = world.grains.position.first().map_or(0.0, |x| x[3]);
        world.skin = world.skin.clamp(SKINS[0] * radius, SKINS[1] * radius);
        world.outer_skin = world
            .outer_skin
            .clamp(OUTER_SKINS[0] * radius, OUTER_SKINS[1] * radius);
        self.since = Some(Instant::now());
    }
}
