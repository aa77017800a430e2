//! What is built from grains as a bed is poured: the world they fall in, its frozen base, the rest over the intruder.

use super::assemble::{Member, assemble};
use super::groups::*;
use super::intruder::intruder;
use super::lattice::Lattice;
use crate::scenario::{BedPlan, CheckedScenario, PouringOrder as Order};
use bitgrain_kernel::{Domain, Error as KernelError, Group, Obstacle, Row, Shape as Body};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::motion::Moves;
use bitgrain_sim::observe;
use bitgrain_sim::simulation::Simulation;
use bitgrain_sim::spatial_order::spatial_order;

/// The group of a grain of a bed that has come to rest: frozen if its centre lies below the base's height, or in a tank
/// as near to its wall.
fn settled_group(scenario: &CheckedScenario, [x, y, z, _]: Row<f64>) -> u8 {
    let radius = 0.5 * scenario.bed.size[0];
    let off = [x - radius, y - radius];
    let inner = radius - scenario.bed.base;
    let at_wall = scenario.is_tank() && off[0] * off[0] + off[1] * off[1] > inner * inner;
    match at_wall || z < scenario.bed.base {
        true => BASE,
        false => FREE,
    }
}

/// Freezes the grains of the base, takes the floor away if the bed has none, and numbers all grains in spatial order.
pub(super) fn freeze_base(
    old: &mut Simulation,
    scenario: &CheckedScenario,
) -> std::result::Result<Simulation, KernelError> {
    let members = in_order(old)
        .map(|k| Member::Old(k, settled_group(scenario, old.position[k])))
        .collect::<Vec<_>>();
    let mut obstacles: Vec<_> = old.obstacles.iter().copied().zip((0..).map(Some)).collect();
    if !scenario.bed.floor {
        obstacles.retain(|(body, _)| !matches!(body.shape, Body::Plane { .. }));
    }
    let groups = old.groups.clone();
    assemble(old, &members, groups, obstacles)
}

/// Numbers all grains in spatial order; in a tank those that were poured last become the wall's where they touch it.
pub(super) fn renumbered(
    old: &mut Simulation,
    scenario: &CheckedScenario,
) -> std::result::Result<Simulation, KernelError> {
    let group = |k: usize| match scenario.is_tank() {
        true => settled_group(scenario, old.position[k]),
        false => old.group[k],
    };
    let members: Vec<Member> = in_order(old).map(|k| Member::Old(k, group(k))).collect();
    let obstacles = old.obstacles.iter().copied().zip((0..).map(Some)).collect();
    let groups = old.groups.clone();
    assemble(old, &members, groups, obstacles)
}

/// The grains in spatial order.
pub(super) fn in_order(sim: &Simulation) -> impl Iterator<Item = usize> + use<> {
    let mean = 2.0 * sim.position.iter().map(|x| x[3]).sum::<f64>() / sim.count().max(1) as f64;
    spatial_order(&sim.position, mean).into_iter()
}

/// Puts the intruder into a bed that reaches up to it, and lets the rest of the grains go above; those
/// whose place it takes are among them. Returns the height they fall from, too.
pub(super) fn buried(
    lower: &mut Simulation,
    scenario: &CheckedScenario,
    plan: &BedPlan,
    count: usize,
) -> std::result::Result<(Simulation, f64), KernelError> {
    let body = intruder(scenario, plan);
    let clear = |k: usize| {
        let x = lower.position[k];
        let off = observe::offset(&lower.domain, &body, [x[0], x[1], x[2]]);
        observe::length(off) > observe::girth(&body) + x[3]
    };
    let mut members: Vec<Member> = (0..lower.count())
        .filter(|&k| clear(k))
        .map(|k| Member::Old(k, lower.group[k]))
        .collect();
    let top = lower.position.iter().map(|x| x[2] + x[3]);
    let top = top.fold(0.0, |a, b| if b > a { b } else { a });
    let rest = Lattice::new(scenario, count - members.len(), top, Some(plan));
    let first = lower.count() as u32;
    members.extend(
        rest.grains(scenario, plan, first)
            .into_iter()
            .map(Member::New),
    );
    let mut obstacles = vec![(body, None)];
    obstacles.extend(lower.obstacles.iter().copied().zip((0..).map(Some)));
    let groups = lower.groups.clone();
    Ok((assemble(lower, &members, groups, obstacles)?, rest.top))
}

/// The grains of a lattice as a world: with the intruder if all are poured at once.
pub(super) fn dropped(
    scenario: &CheckedScenario,
    plan: &BedPlan,
    lattice: &Lattice,
) -> Result<Simulation> {
    let [x, y, z] = scenario.bed.size;
    let refuse = |what: String| Error::input(format!("scenario {}", scenario.name), what);
    let law = scenario.pouring_law();
    // Grains thrown up by a fast intruder fall back; only one that leaves this far is an error.
    let ceiling = 2.0 * (if lattice.top > z { lattice.top } else { z });
    let floor = if scenario.bed.floor {
        0.0
    } else {
        -scenario.bed.diameters[1]
    };
    let lowest = floor - scenario.bed.diameters[1];
    let across = !scenario.is_tank();
    let domain = Domain::new([0.0, 0.0, lowest], [x, y, ceiling], [across, across, false])
        .map_err(|f| refuse(f.to_string()))?;
    let gravity = [0.0, 0.0, -scenario.gravity];
    let mut obstacles = match scenario.pouring_order() {
        Order::AtOnce => vec![intruder(scenario, plan)],
        Order::InTurn => vec![],
    };
    // A bed without a floor is poured on one nevertheless: the base is frozen from it.
    let up = [0.0, 0.0, 1.0];
    obstacles.push(match scenario.is_tank() {
        true => {
            let middle = [0.5 * x, 0.5 * y, 0.5 * ceiling];
            Obstacle::drum(middle, up, 0.5 * x, 0.5 * ceiling)
        }
        false => Obstacle::plane([0.0; 3], up),
    });
    let base = match scenario.drag.moves {
        Moves::Intruder => Group::frozen(),
        Moves::Bed => Group::prescribed_velocity(),
    };
    let groups = vec![Group::free(gravity), base];
    let grains = lattice.grains(scenario, plan, 0);
    Ok(Simulation::new(
        law,
        domain,
        scenario.drag.dt,
        groups,
        &grains,
        obstacles,
    ))
}
