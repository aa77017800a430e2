//! The forces of a world evaluated over ranges of its grains, as threads would.

use bitgrain_kernel::law::Law;
use bitgrain_kernel::motion::{Pass, pass};
use bitgrain_kernel::push::{After, Spill, no_fetch, spill, sum};
use bitgrain_kernel::step::{drift, find_who_touches, finish, judge};
use bitgrain_kernel::touch::push_obstacles;
use bitgrain_kernel::{Fault, World};

/// Does one step of a started world over the ranges that end at its cuts.
pub fn step_cut(world: &mut World<'_, f64>, law: &impl Law<f64>) -> Result<(), Fault> {
    let dt = world.dt;
    let passed = pass(&mut world.moving(), Pass::Drift);
    drift(world, passed)?;
    find_who_touches(world)?;
    let (mut part, mut touch) = world.pushing(dt);
    let hit = push_obstacles(&mut part, &mut touch, law, |_| {});

    let (sight, across) = world.across();
    let mut spills = vec![Spill::default(); across.len()];
    spill(sight, across, law, &mut spills);
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
    let mut deep = None;
    // The last first: the order in which ranges are done must not matter.
    for part in parts.iter_mut().rev() {
        let grains = part.first..part.first + part.grains.position.len();
        let lower = spills
            .iter()
            .filter(|one| grains.contains(&(one.j as usize)));
        let own: Vec<_> = spills
            .iter()
            .copied()
            .filter(|one| grains.contains(&(one.i as usize)))
            .collect();
        deep = sum(part, law, lower, &own, |_| {}, no_fetch(), After::Stay)
            .0
            .or(deep);
    }
    judge(world, hit, deep)?;
    let passed = pass(&mut world.moving(), Pass::Kick);
    finish(world, passed)
}
