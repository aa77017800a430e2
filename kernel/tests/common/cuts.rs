//! The forces of a world evaluated over ranges of its grains, as threads would.

use bitgrain_kernel::law::Law;
use bitgrain_kernel::push::{Spill, spill, sum};
use bitgrain_kernel::touch::push_obstacles;
use bitgrain_kernel::{Fault, World};

/// Evaluates forces, torques and springs of a started world over the ranges that end at `cuts`
/// (ascending, below the number of grains) and the one after the last, `W` contacts at once.
pub fn evaluate<const W: usize>(
    world: &mut World<'_, f64>,
    law: &impl Law<f64>,
    cuts: &[usize],
) -> Result<(), Fault> {
    let dt = world.dt;
    let (sight, mut touch, mut rest) = world.pushing(dt);
    push_obstacles(sight, &mut touch, rest.force, rest.torque, law, |_| {});
    let mut parts = Vec::new();
    let mut begin = 0;
    for &end in cuts {
        let (part, others) = rest.split(end - begin, sight.row);
        parts.push(part);
        (begin, rest) = (end, others);
    }
    parts.push(rest);
    let mut spills: Vec<Vec<Spill<f64>>> = Vec::new();
    for part in &mut parts {
        let mut out = vec![Spill::default(); part.spills(sight.row)];
        let (count, _) = spill::<_, _, W>(sight, part, law, &mut out)?;
        out.truncate(count);
        spills.push(out);
    }
    // The last first: the order in which ranges are done must not matter.
    for k in (0..parts.len()).rev() {
        let lower = spills[..k].iter().flatten();
        sum::<_, _, W>(sight, &mut parts[k], law, lower, &spills[k], |_| {});
    }
    Ok(())
}
