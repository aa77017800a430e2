//! Several steps of a world over ranges of its grains, as threads would do them.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::phases::push_obstacles;
use bitgrain_kernel::phases::seal;
use bitgrain_kernel::phases::{After, Spill, no_fetch, spill, sum};
use bitgrain_kernel::phases::{Pass, Passed, pass};
use bitgrain_kernel::phases::{begin, drift, end, find_who_touches, finish, judge};
use bitgrain_kernel::{Fault, World};

/// Does `count` steps of a started world over the ranges that end at its cuts: each grain goes on to
/// the next step as soon as its sum is complete.
pub fn steps_cut(world: &mut World<'_, f64>, law: &impl Law<f64>, count: u64) -> Result<(), Fault> {
    if count == 0 {
        return Ok(());
    }
    let sealed = seal(&world.moving(), 0);
    begin(world, sealed)?;
    let passed = pass(&mut world.moving(), Pass::Drift);
    drift(world, passed)?;
    for n in 1..=count {
        find_who_touches(world)?;
        let after = if n < count { After::GoOn } else { After::Rest };
        let passed = one(world, law, after)?;
        finish(world, passed)?;
        if n < count {
            drift(world, passed)?;
        }
    }
    // In ranges, the last one first: a sum over grains is the same in any order.
    let cut = world.cuts.first().map_or(0, |&cut| cut as usize);
    let (mut left, mut right) = world.moving().split(cut);
    let middle = left.count();
    let sealed = seal(&right.stretch(0, right.count()), middle);
    let sealed = sealed.and(seal(&left.stretch(0, middle), 0));
    end(world, sealed)
}

fn one(
    world: &mut World<'_, f64>,
    law: &impl Law<f64>,
    after: After,
) -> Result<Passed<f64>, Fault> {
    let dt = world.dt;
    let (mut part, mut touch) = world.pushing(dt);
    let hit = push_obstacles(&mut part, &mut touch, law, |_| {});

    let (sight, across) = world.across();
    let mut spills = vec![Spill::default(); across.len()];
    let mut deep = spill(sight, across, law, &mut spills);
    let cuts = world.cuts;
    let (mut rest, _) = world.pushing(dt);
    let mut parts = Vec::new();
    let mut begin = 0;
    for &end in cuts {
        let (part, others) = rest.split(end as usize - begin);
        parts.push(part);
        (begin, rest) = (end as usize, others);
    }
    parts.push(rest);
    let mut all = Passed::NONE;
    // The last first: the order in which ranges are done must not matter.
    for part in parts.iter_mut().rev() {
        let grains = part.first..part.first + part.grains.count();
        let has = |place: u32| grains.contains(&(place as usize));
        let lower = spills.iter().filter(|one| has(one.j));
        let own: Vec<_> = spills.iter().copied().filter(|one| has(one.i)).collect();
        let (within, passed) = sum(part, law, lower, &own, |_| {}, no_fetch(), after);
        deep = within.or(deep);
        all = passed.and(all);
    }
    judge(world, hit, deep)?;
    Ok(all)
}
