//! Several steps of a world over ranges of its grains, as threads would do them.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::phases::obstacle_forces;
use bitgrain_kernel::phases::seal;
use bitgrain_kernel::phases::{After, CrossRangeForce, accumulate, cross_range, no_fetch};
use bitgrain_kernel::phases::{MotionCheck, MotionPhase, integrate};
use bitgrain_kernel::phases::{begin, check_overlaps, drift, end, ensure_pair_list, finish};
use bitgrain_kernel::{Error, World};

/// Does `count` steps of a started world over the ranges that end at its range_bounds: each grain goes on to
/// the next step as soon as its sum is complete.
pub fn steps_cut(world: &mut World<'_, f64>, law: &impl Law<f64>, count: u64) -> Result<(), Error> {
    if count == 0 {
        return Ok(());
    }
    let sealed = seal(&world.grain_motion(), 0);
    begin(world, sealed)?;
    let passed = integrate(&mut world.grain_motion(), MotionPhase::Drift);
    drift(world, passed)?;
    for n in 1..=count {
        ensure_pair_list(world)?;
        let after = if n < count {
            After::FinishAndBegin
        } else {
            After::Rest
        };
        let passed = one(world, law, after)?;
        finish(world, passed)?;
        if n < count {
            drift(world, passed)?;
        }
    }
    // In ranges, the last one first: a sum over grains is the same in any order.
    let cut = world.range_bounds.first().map_or(0, |&cut| cut as usize);
    let (mut left, mut right) = world.grain_motion().split(cut);
    let middle = left.count();
    let sealed = seal(&right.stretch(0, right.count()), middle);
    let sealed = sealed.and(seal(&left.stretch(0, middle), 0));
    end(world, sealed)
}

fn one(
    world: &mut World<'_, f64>,
    law: &impl Law<f64>,
    after: After,
) -> Result<MotionCheck<f64>, Error> {
    let dt = world.dt;
    let (mut part, mut touch) = world.force_ranges(dt);
    let hit = obstacle_forces(&mut part, &mut touch, law, |_| {});

    let (sight, across) = world.cross_range_pairs();
    let mut spills = vec![CrossRangeForce::default(); across.len()];
    let mut deep = cross_range(sight, across, law, &mut spills);
    let range_bounds = world.range_bounds;
    let (mut rest, _) = world.force_ranges(dt);
    let mut parts = Vec::new();
    let mut begin = 0;
    for &end in range_bounds {
        let (part, others) = rest.split(end as usize - begin);
        parts.push(part);
        (begin, rest) = (end as usize, others);
    }
    parts.push(rest);
    let mut all = MotionCheck::NONE;
    // The last first: the order in which ranges are done must not matter.
    for part in parts.iter_mut().rev() {
        let grains = part.first..part.first + part.grains.count();
        let has = |place: u32| grains.contains(&(place as usize));
        let lower = spills.iter().filter(|one| has(one.j));
        let own: Vec<_> = spills.iter().copied().filter(|one| has(one.i)).collect();
        let (within, passed) = accumulate(part, law, lower, &own, |_| {}, no_fetch(), after);
        deep = within.or(deep);
        all = passed.and(all);
    }
    check_overlaps(world, hit, deep)?;
    Ok(all)
}
