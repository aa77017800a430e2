//! From what was measured to the numbers of the summary.

use bitgrain_kernel::PARTS;

use crate::drag::{Dragging, Means};
use crate::flow::FlowMeans;
use crate::plug_flow::{self, PlugFlow};
use crate::scenario::{BedPlan, CheckedScenario, DragPlan, Release};
use crate::summary::{BedSummary, DragSummary, Flow, LARGE_OVERLAP, Reach, Rig, Tank};
use crate::tank::TankGauge;
use crate::travel;
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::coarse_graining::disturbed_zone::disturbance;
use bitgrain_sim::coarse_graining::{IntruderOutline, intruder_outline};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::observe::{INTRUDER, overlaps_beyond, pressure_at};
use bitgrain_sim::simulation::{Role, Simulation, hex};

/// Layers next to base and lid that do not count as the bed's, in mean diameters.
const EDGE: f64 = 2.0;

/// The further numbers of a settled bed that flows or is in a tank.
pub(super) fn rig(
    scenario: &CheckedScenario,
    plan: &BedPlan,
    bed: &BedSummary,
    sim: &Simulation,
) -> Rig {
    let lid: Vec<usize> = (0..sim.count())
        .filter(|&i| sim.role(i) == Role::Lid)
        .collect();
    let lid_density = lid.first().map_or(0.0, |&i| {
        let (mass, radius) = (sim.velocity[i][3], sim.position[i][3]);
        mass / bitgrain_sim::simulation::sphere_mass(2.0 * radius, 1.0)
    });
    let bulk_density = bed.packing_fraction * scenario.bed.density;
    let body = &sim.obstacles[INTRUDER as usize];
    let buoyancy = bulk_density * scenario.gravity * scenario.intruder_volume(plan.diameter);
    let pressure_gradient = plan.lid.is_none_or(|lid| lid.pressure_gradient);
    let mut rig = Rig {
        seed: plan.seed,
        diameter: plan.diameter,
        length: scenario.intruder_length(plan.diameter),
        pressure_gradient,
        lid_grains: lid.len(),
        lid_density,
        bulk_density,
        effective_depth: 0.0,
        pressure: pressure_at(sim, body.point[2]),
        reaction_over_buoyancy: body.force[2] / buoyancy,
    };
    rig.effective_depth = effective_depth(scenario, &rig, bed.depth, bulk_density);
    rig
}

/// `h + (pi d/6)(rho_lid/rho)`, without h if the bed has no weight (Guillard 2014, section III A).
fn effective_depth(scenario: &CheckedScenario, rig: &Rig, depth: f64, bulk_density: f64) -> f64 {
    let own = if rig.pressure_gradient { depth } else { 0.0 };
    own + scenario.lid_depth(rig.lid_density, bulk_density)
}

/// Forces over what they scale with: `rho g h~ D L` for the drag and the buoyancy for the lift, `rho`
/// with the packing fraction of the run (Guillard 2014, eq. 2 and Fig. 8).
fn flow(
    scenario: &CheckedScenario,
    plan: &DragPlan,
    bed: &BedSummary,
    means: &Means,
    measured: &FlowMeans,
    dragging: &Dragging,
    hole: IntruderOutline,
) -> Option<Flow> {
    let (record, fields) = (&dragging.record, dragging.fields.as_ref());
    let rig = bed.rig.as_ref()?;
    let bulk_density = measured.packing * scenario.bed.density;
    let effective_depth = effective_depth(scenario, rig, bed.depth, bulk_density);
    let pressure = bulk_density * scenario.gravity * effective_depth;
    let buoyancy = bulk_density * scenario.gravity * scenario.intruder_volume(rig.diameter);
    let scale = pressure * rig.diameter * rig.length;
    // Layers cut by the base or by the surface hold few grains.
    let d = scenario.mean_diameter();
    let layers = record
        .flow
        .as_ref()
        .map_or(vec![], |flow| flow.profile.speeds());
    let inside = layers
        .iter()
        .filter(|(low, high, _)| *low >= scenario.bed.base + d && *high <= bed.surface - d);
    let least = inside.fold(
        f64::INFINITY,
        |a, (.., speed)| if *speed < a { *speed } else { a },
    );
    Some(Flow {
        pressure_gradient: rig.pressure_gradient,
        packing_fraction: measured.packing,
        bulk_density,
        effective_depth,
        pressure,
        pressure_measured: measured.pressure,
        buoyancy,
        drag_coefficient: means.drag.mean / scale,
        drag_coefficient_error: means.drag.standard_error / scale,
        lift_over_buoyancy: means.lift.mean / buoyancy,
        lift_over_buoyancy_error: means.lift.standard_error / buoyancy,
        far_field: measured.far_field,
        far_field_least: if least.is_finite() {
            least
        } else {
            measured.far_field
        },
        carried_by_base: measured.base / measured.drag,
        carried_by_lid: measured.lid / measured.drag,
        inertia: measured.inertia / measured.drag,
        floating: measured.floating,
        travel: (plan.distance - plan.discard) / d,
        drag_halves: measured.drag_halves,
        lift_halves: measured.lift_halves.map(|lift| lift / buoyancy),
        load: fields.and_then(|f| f.load(hole, rig.length)),
        disturbance: fields.and_then(|f| {
            let (below, above) = (hole.height, bed.surface - hole.height);
            let reach = if below < above { below } else { above } - EDGE * d;
            disturbance(&f.plane(hole), hole, plan.motion.speed, reach)
        }),
    })
}

/// Forces on a bar over what they scale with, and by half turn (Guillard 2014, eqs. 2 and 3).
fn tank(
    scenario: &CheckedScenario,
    plan: &DragPlan,
    bed: &BedSummary,
    means: &Means,
    gauge: &TankGauge,
) -> Option<Tank> {
    let (rig, half_turn) = (bed.rig.as_ref()?, plan.half_turn?);
    let pressure = rig.bulk_density * scenario.gravity * bed.depth;
    let buoyancy = rig.bulk_density * scenario.gravity * scenario.intruder_volume(rig.diameter);
    let scale = pressure * rig.diameter * rig.length;
    Some(Tank {
        diameter: scenario.bed.size[0],
        length: rig.length,
        turning_rate: scenario.turning_rate(plan.motion.speed),
        turns: 0.5 * plan.distance / half_turn,
        centrifugal: scenario.centrifugal(plan.motion.speed),
        bulk_density: rig.bulk_density,
        pressure,
        buoyancy,
        drag_coefficient: means.drag.mean / scale,
        drag_coefficient_error: means.drag.standard_error / scale,
        lift_over_buoyancy: means.lift.mean / buoyancy,
        lift_over_buoyancy_error: means.lift.standard_error / buoyancy,
        direct: gauge.direct(),
        half_turns: gauge.half_turns(),
    })
}

/// Normalised coordination number and its standard error, of an intruder this many grains wide (Kumar 2018,
/// eq. 8); `None` if nothing touches it.
fn kappa(bulk: Mean, own: Mean, diameter: f64) -> Option<(f64, f64)> {
    let shape = (diameter + 1.0) * (diameter + 1.0) / (2.0 * 3f64.sqrt());
    let kappa = bulk.mean / own.mean * shape;
    let parts = [
        bulk.standard_error / bulk.mean,
        own.standard_error / own.mean,
    ];
    let relative = (parts[0] * parts[0] + parts[1] * parts[1]).sqrt();
    (kappa.is_finite() && relative.is_finite()).then_some((kappa, kappa * relative))
}

/// How fast and how far an intruder went: as planned, or as measured.
struct Way {
    speed: f64,
    froude: f64,
    /// Travel in all.
    distance: f64,
    /// Travel as averaging began and ended.
    window: [f64; 2],
}

fn way(scenario: &CheckedScenario, plan: &DragPlan, diameter: f64, dragging: &Dragging) -> Way {
    let planned = Way {
        speed: plan.motion.speed,
        froude: plan.froude,
        distance: plan.distance,
        window: [plan.discard, plan.window_end],
    };
    match (plan.release, dragging.released()) {
        (Release::Dropped { .. }, Some(known)) => Way {
            distance: known.begin[2] - known.end[2],
            window: [0.0, known.begin[2] - known.end[2]],
            ..planned
        },
        (Release::Pulled { .. }, Some(known)) => {
            let window = [known.window_begin, known.end].map(|at| at[0] - known.begin[0]);
            // From the last row before the window, at which it was seen.
            let seen = (plan.motion.window[0] - 1) / plan.every * plan.every;
            let time = (plan.steps() - seen) as f64 * plan.motion.dt;
            let speed = (window[1] - window[0]) / time;
            Way {
                speed,
                froude: scenario.froude(speed, diameter),
                distance: window[1],
                window,
            }
        }
        _ => planned,
    }
}

pub(super) fn summarise(
    scenario: &CheckedScenario,
    plan: &DragPlan,
    bed: &BedSummary,
    means: &Means,
    dragging: &Dragging,
    sim: &mut Simulation,
) -> Result<DragSummary> {
    let wrong = |fault| Error::run(&plan.name, plan.steps(), fault);
    let digest = sim.digest().map_err(wrong)?;
    let diameter = scenario.beds()[plan.bed].diameter;
    let weight = bed.packing_fraction * scenario.bed.density * scenario.gravity;
    let above = weight * scenario.bed_area() * (bed.depth + 0.5 * diameter);
    let ratio = means.drag.mean / above;
    let around = means.around;
    let d = scenario.mean_diameter();
    let kappa_of = |coordination: Mean| kappa(coordination, means.contacts, diameter / d);
    let kappa = around.coordination.and_then(kappa_of);
    let reaches = dragging.within().into_iter().map(|within| {
        let kappa = kappa_of(within.coordination);
        Reach {
            reach: within.reach,
            coordination: within.coordination,
            floating: within.floating,
            kappa: kappa.map(|k| k.0),
            kappa_error: kappa.map(|k| k.1),
        }
    });
    let series = &dragging.record.series;
    let way = way(scenario, plan, diameter, dragging);
    Ok(DragSummary {
        name: plan.name.clone(),
        bed: bed.name.clone(),
        froude: way.froude,
        speed: way.speed,
        diameter,
        depth: bed.depth,
        distance: way.distance,
        steps: plan.steps(),
        window_start: way.window[0],
        window_end: way.window[1],
        window_steps: means.window_steps,
        drag: means.drag,
        lift: means.lift,
        side: means.side,
        contacts: means.contacts,
        contact_angle: around.contact_angle,
        coordination: around.coordination,
        new_contact_angle: around.new_contact_angle,
        floating: around.floating,
        coordination_shares: dragging.record.coordination.shares(),
        kappa: kappa.map(|k| k.0),
        kappa_error: kappa.map(|k| k.1),
        reaches: reaches.collect(),
        moving: around.moving,
        drift: around.drift,
        drag_uncut: means.drag_uncut,
        drag_uncut_error: travel::uncut_error(series),
        drag_by_travel: match plan.release.is_timed() {
            true => Vec::new(),
            false => travel::drag_by_travel(series, &plan.motion),
        },
        plug_ratio: ratio,
        plug: match scenario.has_rig() {
            true => PlugFlow::Sound,
            false => plug_flow::judge(scenario.law.mu(), ratio, around.drift.map(|d| d.mean)),
        },
        flow: means.flow.and_then(|m| {
            flow(
                scenario,
                plan,
                bed,
                means,
                &m,
                dragging,
                intruder_outline(sim),
            )
        }),
        tank: dragging
            .record
            .tank
            .as_ref()
            .and_then(|gauge| tank(scenario, plan, bed, means, gauge)),
        overlap_max: dragging.record.deepest / d,
        large_overlaps: overlaps_beyond(sim, LARGE_OVERLAP * d),
        released: dragging.released(),
        energy: dragging.record.energy.last().copied(),
        chain: dragging.chain.end().to_string(),
        digest: hex(&digest.whole),
        digest_parts: PARTS
            .iter()
            .zip(digest.parts())
            .map(|(name, part)| (name.to_string(), hex(part)))
            .collect(),
    })
}
