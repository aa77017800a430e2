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

/// Steps between two changes of the skin.
const STEPS: u32 = 64;

fn change(wider: bool) -> f64 {
    if wider { CHANGE } else { 1.0 / CHANGE }
}

/// Skins are kept within these parts of the smallest radius of the whole world, so that whatever the clock says asks
/// for no list that is refused: no more than some 85 larger grains have room so near a grain.
const SKINS: [f64; 2] = [1e-4, 0.4];
/// So are reaches.
const OUTER_SKINS: [f64; 2] = [0.02, 1.0];

/// Keeps what was tuned within its bounds; none is wanted in open space without grains.
fn bound(world: &mut World<'_, f64>) {
    let radius = match world.clock.radius_min() {
        f64::MAX => 0.0,
        radius => radius,
    };
    let within = |[least, most]: [f64; 2], skin: f64| skin.clamp(least * radius, most * radius);
    world.skin = within(SKINS, world.skin);
    world.outer_skin = within(OUTER_SKINS, world.outer_skin);
}

/// What is known of the costs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Skin {
    /// When the forces of the present step began.
    since: Option<Instant>,
    /// Steps since the skin was changed.
    steps: u32,
    /// Time that picking took in them.
    picking: Duration,
    /// Time that all else took in them.
    stepping: Duration,
    /// Time that picking took since the last search.
    picking_since_search: Duration,
}

impl Skin {
    /// Records that the pair list was looked at since `began`, when so many searches were done: the forces of a step
    /// begin.
    pub fn listed(&mut self, world: &mut World<'_, f64>, searches: u64, began: Instant) {
        let now = Instant::now();
        let took = now.saturating_duration_since(began);
        if world.clock.outer_list_rebuilds() > searches {
            // Candidates grow with about the reach, and so do the candidates that are examined but not picked.
            let vain = self.picking_since_search.mul_f64(0.5);
            if !self.picking_since_search.is_zero() {
                world.outer_skin *= change(took > vain);
                bound(world);
            }
            self.picking_since_search = Duration::ZERO;
        } else {
            self.picking_since_search += took;
            self.picking += took;
        }
        self.since = Some(now);
    }

    /// Records that the forces of a step are done, and changes the skin after some steps.
    pub fn stepped(&mut self, world: &mut World<'_, f64>) {
        let Some(since) = self.since.take() else {
            return;
        };
        self.stepping += since.elapsed();
        self.steps += 1;
        if self.steps < STEPS {
            return;
        }
        // A grain costs about as much as a pair.
        let (listed, touching) = (world.clock.listed(), world.clock.listed_touching());
        let idle = listed.saturating_sub(touching);
        let share = idle as f64 / (listed + world.grains.count()).max(1) as f64;
        let vain = self.stepping.mul_f64(POWER * share);
        world.skin *= change(self.picking > vain);
        (self.steps, self.picking, self.stepping) = (0, Duration::ZERO, Duration::ZERO);
        bound(world);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::owned_world::OwnedWorld;
    use bitgrain_kernel::{Domain, Group};

    /// Times as a busy or odd machine may take them: searches that cost far more than all picking, or far less.
    #[test]
    fn no_time_asks_for_more_than_the_bounds() {
        let mut owned = OwnedWorld::new(Domain::open(), 1e-3);
        owned.groups.push(Group::free([0.0; 3]));
        owned.add(1, 0, [0.0, 0.0, 0.0, 2.0], [0.0, 0.0, 0.0, 1.0], [0.0; 3]);
        owned.add(2, 0, [9.0, 0.0, 0.0, 0.5], [0.0, 0.0, 0.0, 1.0], [0.0; 3]);
        owned.fit_search();
        owned.reserve(8, 8, 8).unwrap();
        let law = bitgrain_kernel::contact::HertzTsuji::new(1e4, 0.3, 0.5, 0.5);
        bitgrain_kernel::start(&mut owned.world(), &law).unwrap();
        let long_ago = Instant::now() - Duration::from_secs(1);
        for (searched, picked) in [(long_ago, Instant::now()), (Instant::now(), long_ago)] {
            let mut skin = Skin::default();
            for _ in 0..500 {
                let mut world = owned.world();
                let searches = world.clock.outer_list_rebuilds();
                skin.listed(&mut world, searches, picked);
                skin.stepped(&mut world);
                skin.listed(&mut world, searches - 1, searched);
                let (inner, outer) = (world.skin, world.outer_skin);
                // Of the smaller radius.
                assert!((0.0..=0.2).contains(&inner) && (0.0..=0.5).contains(&outer));
                (owned.skin, owned.outer_skin) = (inner, outer);
            }
        }
    }
}
