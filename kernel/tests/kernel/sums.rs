//! The sums of a step: their order, Newton's third law, and any cut of a world into parts.

use crate::common::cases::cases;
use crate::common::crowd::{DENSE, PER_GRAIN, REDUCED, SI, Units, crowd, history, tsuji};
use crate::common::parts::{Ghosts, steps_in_parts};
use bitgrain_kernel::contact::Law;
use bitgrain_kernel::vec3::{Vec3, add, cross, dot, head, scale, sub};
use bitgrain_kernel::{
    ContactForce, Digest, Domain, Error, Group, Obstacle, Partner, Store, World, digest, start,
    step, step_watched,
};
use proptest::prelude::*;

type V = Vec3<f64>;

/// Steps of a world that is cut into parts.
const STEPS: u64 = 200;

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

/// The state of a crowd after these steps in parts, so many at a time, and between them one step as a whole.
fn after_steps_in_parts(
    seed: &[f64],
    owner: &[u8],
    ghosts: Ghosts,
    (skin, at_once): (f64, u64),
) -> Result<Digest, Error> {
    let law = history(0.5);
    let mut store = crowd(seed, &DENSE, &REDUCED, skin);
    store.set_outer_skin(skin);
    let mut world = store.world();
    start(&mut world, &law)?;
    while world.clock.step < STEPS {
        let left = STEPS - world.clock.step;
        steps_in_parts(&mut world, owner, ghosts, &law, at_once.min(left))?;
        if world.clock.step < STEPS {
            step(&mut world, &law)?;
        }
    }
    digest(&world)
}

/// The same by the definition of a step.
fn after_steps(seed: &[f64]) -> Result<Digest, Error> {
    let law = history(0.5);
    let mut store = crowd(seed, &DENSE, &REDUCED, 0.2);
    let mut world = store.world();
    start(&mut world, &law)?;
    for _ in 0..STEPS {
        step(&mut world, &law)?;
    }
    digest(&world)
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

    /// Whoever owns a grain, neighbours or not, and parts that own none.
    #[test]
    fn any_cut_into_parts_gives_the_same_steps(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        drawn in prop::collection::vec(any::<u8>(), 64),
        parts in 1..7u8,
    ) {
        let whole = after_steps(&seed);
        prop_assume!(whole.is_ok());
        let any: Vec<u8> = drawn.iter().map(|part| part % parts).collect();
        let runs: Vec<u8> = (0..64).map(|k| (k * usize::from(parts) / 64) as u8).collect();
        // Without a skin each step searches, and with a wide one the first does.
        for (owner, ghosts, skin, at_once) in [
            (&any, Ghosts::Near, 0.0, 1),
            (&any, Ghosts::All, 0.002, STEPS),
            (&runs, Ghosts::Near, 0.002, STEPS),
            (&any, Ghosts::Near, 0.1, 50),
        ] {
            let cut = after_steps_in_parts(&seed, owner, ghosts, (skin, at_once));
            prop_assert_eq!(cut, whole, "{:?} {} {}", ghosts, skin, at_once);
        }
    }
}
