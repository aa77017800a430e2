//! The lid: a square lattice of heavy grains on a settled bed (Guillard 2014, section III A).

use bitgrain_kernel::{Error as KernelError, Group, Obstacle};

use super::assemble::{Member, assemble};
use super::groups::{BASE, FREE, LID};
use super::survey;
use crate::scenario::{BedPlan, CheckedScenario, LidPlan};
use crate::summary::BedSummary;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::simulation::{Grain, Simulation};
use bitgrain_sim::spatial_order::spatial_order;

/// Gap between a grain of the lid and what it is laid on, in mean diameters: it is put down, not
/// dropped.
const GAP: f64 = 1e-3;

/// Least density of the lid's grains over that of the bed's: a lighter one is not a lid.
const LIGHTEST: f64 = 1.0;

/// Mass density of the lid's grains: as planned, or so that it gives the planned effective depth
/// `h + (pi d/6)(rho_lid/rho)`, with `h` and `rho = phi rho_g` as they are measured on the bare bed.
/// Without a pressure gradient the lid alone presses, and there is no `h`.
///
/// # Errors
/// [`Error::Unfit`] if the bed is deep enough without one.
pub fn lid_density(scenario: &CheckedScenario, plan: &LidPlan, bare: &BedSummary) -> Result<f64> {
    if let Some(density) = plan.density {
        return Ok(density);
    }
    let asked = plan.effective_depth.unwrap_or(0.0);
    let own = if plan.pressure_gradient {
        bare.depth
    } else {
        0.0
    };
    let bulk = bare.packing_fraction * scenario.bed.density;
    let density = (asked - own) / scenario.lid_depth(1.0, bulk);
    if density >= LIGHTEST * scenario.bed.density {
        return Ok(density);
    }
    let why = if plan.pressure_gradient {
        format!(
            "the intruder already lies {own:.5} below the surface of the settled bed, and the lid would \
             be lighter than the bed's grains: ask for more, raise the intruder, or leave the lid out"
        )
    } else {
        format!(
            "a lid at least as dense as the bed's grains gives {:.5} or more: ask for that",
            scenario.lid_depth(LIGHTEST * scenario.bed.density, bulk)
        )
    };
    let problem = format!("is {asked}, but {why}");
    let place = format!("scenario {}: `lid.effective_depth`", scenario.name);
    Err(Error::Unfit { place, problem })
}

/// Puts the lid on a bare bed: each of its grains on the highest point that the bed offers it. Without a
/// pressure gradient the bed's weight is switched off, and a plane at the box's top, moving with the
/// lid, holds in what floats out between the lid's grains. All grains are numbered in spatial order.
pub(super) fn cover(
    bare: &mut Simulation,
    scenario: &CheckedScenario,
    plan: &LidPlan,
    density: f64,
) -> std::result::Result<Simulation, KernelError> {
    let gravity = [0.0, 0.0, -scenario.gravity];
    let mut groups = bare.groups.clone();
    groups.truncate(usize::from(LID));
    groups.push(Group::free_along_z(gravity));
    if !plan.pressure_gradient {
        groups[usize::from(FREE)].gravity = [0.0; 3];
    }
    debug_assert!(bare.group.iter().all(|&g| g == FREE || g == BASE));
    let d = scenario.mean_diameter();
    let grains = sites(scenario).into_iter().map(|[x, y]| Grain {
        id: 0,
        group: LID,
        diameter: d,
        density,
        position: [x, y, rest_height(bare, [x, y], 0.5 * d) + GAP * d],
        velocity: [0.0; 3],
        spin: [0.0; 3],
    });
    let mut members: Vec<Member> = (0..bare.count())
        .map(|k| Member::Old(k, bare.group[k]))
        .collect();
    let mut places = bare.position.clone();
    for grain in grains {
        let [x, y, z] = grain.position;
        places.push([x, y, z, 0.5 * d]);
        members.push(Member::New(grain));
    }
    let order = spatial_order(&places, d);
    let members: Vec<Member> = order.into_iter().map(|k| members[k]).collect();
    let mut obstacles: Vec<_> = bare
        .obstacles
        .iter()
        .copied()
        .zip((0..).map(Some))
        .collect();
    if !plan.pressure_gradient {
        let top = [0.0, 0.0, scenario.bed.size[2]];
        obstacles.push((Obstacle::plane(top, [0.0, 0.0, -1.0]), None));
    }
    assemble(bare, &members, groups, obstacles)
}

/// Places of the lid's grains: the middles of squares of the mean diameter.
fn sites(scenario: &CheckedScenario) -> Vec<[f64; 2]> {
    let [nx, ny] = scenario.lid_sites();
    let step = [
        scenario.bed.size[0] / nx as f64,
        scenario.bed.size[1] / ny as f64,
    ];
    let at = |ix: usize, iy: usize| [(ix as f64 + 0.5) * step[0], (iy as f64 + 0.5) * step[1]];
    (0..ny)
        .flat_map(|iy| (0..nx).map(move |ix| at(ix, iy)))
        .collect()
}

/// Height at which a ball of this radius, let down at a place, first touches a grain or the intruder.
fn rest_height(sim: &Simulation, [x, y]: [f64; 2], radius: f64) -> f64 {
    let mut height = f64::NEG_INFINITY;
    let mut over = |dx: f64, dy: f64, z: f64, reach: f64| {
        let square = reach * reach - dx * dx - dy * dy;
        if square > 0.0 && z + square.sqrt() > height {
            height = z + square.sqrt();
        }
    };
    for p in &sim.position {
        let d = sim.domain.separation([x, y, 0.0], [p[0], p[1], 0.0]);
        over(d[0], d[1], p[2], radius + p[3]);
    }
    let body = &sim.obstacles[bitgrain_sim::observe::INTRUDER as usize];
    let d = sim.domain.separation([x, y, 0.0], body.point);
    let across = match body.shape {
        bitgrain_kernel::Shape::Cylinder { .. } => 0.0,
        _ => d[1],
    };
    over(d[0], across, body.point[2], radius + body.reach());
    height
}

/// Lays the lid of a plan on its bare bed and returns the state, not yet at rest.
///
/// # Errors
/// As [`lid_density`]; [`Error::Run`] if the kernel refuses the state.
pub(super) fn covered(
    bare: &mut Simulation,
    scenario: &CheckedScenario,
    plan: &BedPlan,
    lid: &LidPlan,
) -> Result<Simulation> {
    let found = survey(&plan.name, &scenario.measures(), bare)?;
    let density = lid_density(scenario, lid, &found)?;
    cover(bare, scenario, lid, density).map_err(|fault| {
        Error::run(
            format!("the lid of {}", plan.name),
            bare.step_count(),
            fault,
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario;
    use crate::summary::BedSummary;

    /// A settled bed of which only depth and packing matter.
    fn bare(depth: f64) -> BedSummary {
        BedSummary {
            name: String::new(),
            grains: 0,
            frozen: 0,
            steps: 0,
            surface: 0.0,
            depth,
            packing_fraction: 0.6,
            coordination_number: 0.0,
            overlap_max: 0.0,
            kinetic_energy_over_weight_d: 0.0,
            weight: 0.0,
            support: 0.0,
            chain: String::new(),
            digest: String::new(),
            rig: None,
        }
    }

    /// The density that is chosen gives the depth that was asked for, with and without the bed's own.
    #[test]
    fn the_density_follows_from_the_depth() {
        let scenario = scenario::load("guillard-2014", &[]).unwrap();
        let bulk = 0.6 * scenario.bed.density;
        for (asked, pressure_gradient, own) in [(0.12, true, 0.08), (0.12, false, 0.0)] {
            let plan = LidPlan {
                effective_depth: Some(asked),
                density: None,
                pressure_gradient,
            };
            let density = lid_density(&scenario, &plan, &bare(0.08)).unwrap();
            let depth = own + scenario.lid_depth(density, bulk);
            assert!((depth / asked - 1.0).abs() < 1e-14);
            let given = LidPlan {
                density: Some(1e5),
                ..plan
            };
            assert_eq!(lid_density(&scenario, &given, &bare(0.08)).unwrap(), 1e5);
        }
        let plan = |asked, pressure_gradient| LidPlan {
            effective_depth: Some(asked),
            density: None,
            pressure_gradient,
        };
        // The contribution of one grain's density decides: pi d/6 over the packing fraction.
        let least = scenario.lid_depth(scenario.bed.density, bulk);
        assert!((least - std::f64::consts::PI * 1.5e-3 / 6.0 / 0.6).abs() < 1e-15);
        let describe_at = [
            (0.08, true, "already lies 0.08000 below"),
            (0.0, false, "gives 0.00131 or more"),
        ];
        for (own, gradient, what) in describe_at {
            let light = plan(own + 0.99 * least, gradient);
            let unfit = lid_density(&scenario, &light, &bare(0.08)).unwrap_err();
            assert!(unfit.is_physical());
            let told = unfit.to_string();
            assert!(told.contains(what) && told.contains("grains"), "{told}");
            let heavy = plan(own + 1.01 * least, gradient);
            assert!(lid_density(&scenario, &heavy, &bare(0.08)).is_ok());
        }
    }
}
