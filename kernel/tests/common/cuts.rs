//! The forces of a world evaluated over ranges of its grains, as threads would.

use bitgrain_kernel::law::Law;
use bitgrain_kernel::push::{Part, Sight, Spill, TouchPart, push_obstacles, spill, sum};
use bitgrain_kernel::{Fault, World};

/// Evaluates forces, torques and springs of a started world over the ranges that end at `cuts`
/// (ascending, below the number of grains) and the one after the last.
pub fn evaluate(
    world: &mut World<'_, f64>,
    law: &impl Law<f64>,
    cuts: &[usize],
) -> Result<(), Fault> {
    let n = world.grains.count();
    let touches = world.clock.touches();
    let g = &mut world.grains;
    let sight = Sight {
        domain: world.domain,
        position: g.position,
        velocity: g.velocity,
        spin: g.spin,
        row: world.pairs.row,
        dt: world.dt,
    };
    let mut touch = TouchPart {
        grain: &world.pairs.touch_grain[..touches],
        obstacle: &mut world.pairs.touch_obstacle[..touches],
        spring: &mut world.pairs.touch_spring[..touches],
        obstacles: world.obstacles,
    };
    push_obstacles(sight, &mut touch, g.force, g.torque, law, |_| {});
    let mut parts = Vec::new();
    let (mut force, mut torque) = (&mut *g.force, &mut *g.torque);
    let (mut partner, mut spring) = (&mut *world.pairs.partner, &mut *world.pairs.spring);
    let mut begin = 0;
    for &end in cuts.iter().chain([&n]) {
        let pairs = (sight.row[end] - sight.row[begin]) as usize;
        let (f, t, p, s);
        (f, force) = force.split_at_mut(end - begin);
        (t, torque) = torque.split_at_mut(end - begin);
        (p, partner) = partner.split_at_mut(pairs);
        (s, spring) = spring.split_at_mut(pairs);
        parts.push(Part {
            rows: begin..end,
            force: f,
            torque: t,
            partner: p,
            spring: s,
        });
        begin = end;
    }
    let mut spills: Vec<Vec<Spill<f64>>> = Vec::new();
    for part in &mut parts {
        let mut out = vec![Spill::default(); part.partner.len()];
        let (count, _) = spill(sight, part, law, &mut out)?;
        out.truncate(count);
        spills.push(out);
    }
    // The last first: the order in which ranges are done must not matter.
    for k in (0..parts.len()).rev() {
        let lower: Vec<&[Spill<f64>]> = spills[..k].iter().map(Vec::as_slice).collect();
        sum(sight, &mut parts[k], law, &lower, &spills[k], |_| {});
    }
    Ok(())
}
