//! The sums of a step: their order, Newton's third law, and any cut of the grains into ranges.

use crate::common::cases::cases;
use crate::common::crowd::{DENSE, PER_GRAIN, REDUCED, SI, Units, crowd, history, tsuji};
use crate::common::range_bounds::steps_cut;
use bitgrain_kernel::contact::Law;
use bitgrain_kernel::vec3::{Vec3, add, cross, dot, head, scale, sub};
use bitgrain_kernel::{
    ContactForce, Digest, Domain, Error, Group, NEIGHBORS, Obstacle, Partner, Store, StretchList,
    World, digest, start, step, step_watched,
};
use proptest::prelude::*;

type V = Vec3<f64>;

/// What one contact gives one of its bodies.
#[derive(Clone, Copy)]
struct Share {
    /// An obstacle by number, or a grain by place: obstacles come first.
    from: (u8, u32),
    force: V,
    torque: V,
}

/// The lever of a contact's tangential force about a grain of this radius.
type Lever = fn(&ContactForce<f64>, f64) -> f64;

/// The contract's sums: from +0.0, over obstacles by number, then over neighbours by ascending
/// place (so by id), or all of that backwards.
fn by_definition(
    world: &World<'_, f64>,
    seen: &[ContactForce<f64>],
    lever: Lever,
    backwards: bool,
) -> Vec<[u64; 6]> {
    let mut shares: Vec<Vec<Share>> = vec![Vec::new(); world.grains.count()];
    for p in seen {
        let push = add(scale(p.normal, p.normal_force), p.tangential_force);
        let couple = cross(p.normal, p.tangential_force);
        let mut give = |to: u32, from: (u8, u32), sign: f64| {
            let arm = lever(p, world.grains.position[to as usize][3]);
            shares[to as usize].push(Share {
                from,
                force: scale(push, sign),
                torque: scale(couple, -arm),
            });
        };
        match p.partner {
            Partner::Obstacle(k) => give(p.i, (0, k), 1.0),
            Partner::Grain(j) => {
                give(p.i, (1, j), 1.0);
                give(j, (1, p.i), -1.0);
            }
        }
    }
    let total = |mut of: Vec<Share>| {
        of.sort_by_key(|share| share.from);
        if backwards {
            of.reverse();
        }
        let zero = ([0.0; 3], [0.0; 3]);
        let (f, t) = of.iter().fold(zero, |(f, t), share| {
            (add(f, share.force), add(t, share.torque))
        });
        [f[0], f[1], f[2], t[0], t[1], t[2]].map(f64::to_bits)
    };
    shares.into_iter().map(total).collect()
}

fn held(world: &World<'_, f64>) -> Vec<[u64; 6]> {
    let g = &world.grains;
    let rows = g.force.iter().zip(g.torque.iter());
    rows.map(|(f, t)| [f[0], f[1], f[2], t[0], t[1], t[2]].map(f64::to_bits))
        .collect()
}

/// Steps a crowd and compares what it holds with the sums over the contacts that were seen.
fn follow(
    seed: &[f64],
    units: &Units,
    law: impl Law<f64>,
    lever: Lever,
) -> Result<(), TestCaseError> {
    let mut store = crowd(seed, &DENSE, units, 0.1);
    let mut world = store.world();
    prop_assume!(start(&mut world, &law).is_ok());
    let mut order_matters = false;
    for n in 0..300 {
        let mut seen = Vec::new();
        if step_watched(&mut world, &law, |p| seen.push(p)).is_err() {
            // A driven body went too deep: compared up to here.
            break;
        }
        let sums = by_definition(&world, &seen, lever, false);
        prop_assert_eq!(held(&world), &*sums, "step {}", n);
        order_matters |= sums != by_definition(&world, &seen, lever, true);
        on_obstacles(&world, &seen)?;
        nothing_is_left_over(&world, &seen)?;
    }
    prop_assume!(order_matters, "no order could be told from another");
    Ok(())
}

/// The force on an obstacle is the sum over its grains by ascending place.
fn on_obstacles(world: &World<'_, f64>, seen: &[ContactForce<f64>]) -> Result<(), TestCaseError> {
    for (k, body) in world.obstacles.iter().enumerate() {
        let mut own: Vec<_> = seen
            .iter()
            .filter(|p| p.partner == Partner::Obstacle(k as u32))
            .collect();
        own.sort_by_key(|p| p.i);
        let force = own.iter().fold([0.0; 3], |f, p| {
            sub(f, add(scale(p.normal, p.normal_force), p.tangential_force))
        });
        prop_assert_eq!(body.force.map(f64::to_bits), force.map(f64::to_bits));
    }
    Ok(())
}

/// Forces come in opposite pairs, so all of them together are nothing but rounding: half a unit in
/// the last place of the largest partial sum for each of fewer than a thousand additions.
fn nothing_is_left_over(
    world: &World<'_, f64>,
    seen: &[ContactForce<f64>],
) -> Result<(), TestCaseError> {
    let grains = world.grains.force.iter().map(|f| head(*f));
    let bodies = world.obstacles.iter().map(|o| o.force);
    let rest = grains.chain(bodies).fold([0.0; 3], add);
    let size = |v: V| dot(v, v).sqrt();
    let strength: f64 = seen
        .iter()
        .map(|p| p.normal_force.abs() + size(p.tangential_force))
        .sum();
    prop_assert!(
        size(rest) <= 1000.0 * f64::EPSILON * strength,
        "{:?} is left over",
        rest
    );
    Ok(())
}

/// A grain pressed into a corner of three walls by a ball. Fewer than three obstacles would not
/// tell one order from another.
fn corner(deep: V, velocity: V, spin: V) -> Result<(), TestCaseError> {
    let mut store = Store::<f64, 1, 16, 4, 4>::new(Domain::open(), 1e-4, 0.1);
    store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    for axis in 0..3 {
        let mut normal = [0.0; 3];
        normal[axis] = 1.0;
        let wall = Obstacle::plane([0.0; 3], normal);
        store.add_obstacle(wall).unwrap();
    }
    let ball = Obstacle::sphere([1.05; 3], 0.5);
    store.add_obstacle(ball).unwrap();
    let place = deep.map(|d| 0.5 - d);
    store.add_grain(1, 0, place, 0.5, 0.5).unwrap();
    let mut world = store.world();
    world.grains.velocity[0][..3].copy_from_slice(&velocity);
    world.grains.spin[0][..3].copy_from_slice(&spin);
    start(&mut world, &history(0.5)).unwrap();
    let mut order_matters = false;
    for n in 0..20 {
        let mut seen = Vec::new();
        step_watched(&mut world, &history(0.5), |p| seen.push(p)).unwrap();
        let sums = by_definition(&world, &seen, |_, radius| radius, false);
        prop_assert_eq!(held(&world), &*sums, "step {}", n);
        order_matters |= sums != by_definition(&world, &seen, |_, radius| radius, true);
    }
    prop_assume!(order_matters, "no order could be told from another");
    Ok(())
}

/// The state of a crowd after 200 steps over ranges that end at `range_bounds`, so many at a time.
fn after_cut_steps(seed: &[f64], range_bounds: &[u32], at_once: u64) -> Result<Digest, Error> {
    let law = history(0.5);
    let mut store = crowd(seed, &DENSE, &REDUCED, 0.2);
    let mut world = store.world();
    world.range_bounds = range_bounds;
    let (mut words, mut numbers) = ([0; 12 * (4 + NEIGHBORS) + 2], [0.0; 36]);
    world.stretches = StretchList::new(&mut words, &mut numbers);
    start(&mut world, &law)?;
    while world.clock.step < 200 {
        steps_cut(&mut world, &law, at_once)?;
    }
    Ok(digest(&world))
}

/// The same by the definition of a step.
fn after_steps(seed: &[f64]) -> Result<Digest, Error> {
    let law = history(0.5);
    let mut store = crowd(seed, &DENSE, &REDUCED, 0.2);
    let mut world = store.world();
    start(&mut world, &law)?;
    for _ in 0..200 {
        step(&mut world, &law)?;
    }
    Ok(digest(&world))
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn a_grain_in_a_corner_hears_obstacles_by_number(
        deep in prop::array::uniform3(0.01..0.03f64),
        velocity in prop::array::uniform3(-0.2..0.2f64),
        spin in prop::array::uniform3(-0.5..0.5f64),
    ) {
        corner(deep, velocity, spin)?;
    }

    /// The lever is the radius.
    #[test]
    fn forces_are_summed_in_the_contracts_order_hertz_history(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
    ) {
        follow(&seed, &REDUCED, history(0.5), |_, radius| radius)?;
    }

    /// The lever is the radius less half the overlap.
    #[test]
    fn forces_are_summed_in_the_contracts_order_hertz_tsuji(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 48),
    ) {
        follow(&seed, &SI, tsuji(), |p, radius| radius - p.overlap * 0.5)?;
    }

    #[test]
    fn any_cut_into_ranges_gives_the_same_steps(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        range_bounds in prop::collection::btree_set(1..64u32, 1..12),
    ) {
        let whole = after_steps(&seed);
        prop_assume!(whole.is_ok());
        let range_bounds: Vec<u32> = range_bounds.into_iter().collect();
        for (range_bounds, at_once) in [(&[][..], 1), (&[], 50), (&range_bounds, 1), (&range_bounds, 200)] {
            prop_assert_eq!(after_cut_steps(&seed, range_bounds, at_once), whole);
        }
    }
}
