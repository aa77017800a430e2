//! Janssen's silo: walls carry most of a high column (Janssen, Z. Ver. Dtsch. Ing. 39, 1045 (1895); Landry et al.,
//! Phys. Rev. E 67, 041303 (2003)).

use bitgrain::case::{BodyShape, Case, ObstacleSpec};
use bitgrain::law::{HertzTsujiParameters, LawSpec};
use bitgrain::random::{Purpose, uniforms};
use bitgrain::simulation::Simulation;
use bitgrain_kernel::Partner;
use bitgrain_tests::{ball, floor, open_case};

use crate::bodies::begin;

const RADIUS: f64 = 4.0;
const GRAINS: u32 = 1500;
const MU: f64 = 0.5;
const DT: f64 = 1e-3;
const MASS: f64 = core::f64::consts::FRAC_PI_6;
const AREA: f64 = core::f64::consts::PI * RADIUS * RADIUS;

/// Numbers of the obstacles.
const FLOOR: usize = 0;
const WALL: usize = 1;

/// Grains above each other in a cylinder with a floor.
fn poured() -> Simulation {
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 2e4,
        poisson: 0.3,
        restitution: 0.3,
        mu: MU,
        rolling: None,
    });
    let mut grains = Vec::new();
    let mut site = 0;
    while grains.len() < GRAINS as usize {
        let cell = [site % 7, site / 7 % 7, site / 49];
        site += 1;
        let place = cell.map(|s| 1.08 * f64::from(s));
        let (x, y) = (place[0] - 3.24, place[1] - 3.24);
        if (x * x + y * y).sqrt() > RADIUS - 0.55 {
            continue;
        }
        let id = grains.len() as u32 + 1;
        let shift = uniforms::<3>(1, Purpose::Shift, id).map(|u| 0.06 * (u - 0.5));
        let at = [x + shift[0], y + shift[1], 0.6 + place[2] + shift[2]];
        grains.push(ball(id, at, [0.0; 3]));
    }
    let wall = ObstacleSpec {
        shape: BodyShape::Drum,
        length: Some(400.0),
        ..ObstacleSpec::cylinder([0.0; 3], [0.0, 0.0, 1.0], 2.0 * RADIUS)
    };
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(law, DT, grains, vec![floor(), wall])
    };
    begin(&case)
}

/// What floor and wall carry is what the grains are pushed with, to the rounding of some thousand sums.
fn check_reaction(sim: &Simulation) {
    let on_grains: f64 = sim.force.iter().map(|f| f[2]).sum();
    let on_bodies = sim.obstacles[FLOOR].force[2] + sim.obstacles[WALL].force[2];
    let weight = f64::from(GRAINS) * MASS;
    assert!(
        (on_grains + on_bodies).abs() < 1e-11 * weight,
        "{on_grains} {on_bodies}"
    );
}

/// What is measured in slices of one diameter, from below; means over samples.
#[derive(Clone, Debug, Default)]
struct Profile {
    /// Upward force of the wall on grains.
    lift: Vec<f64>,
    /// Force of the wall towards the axis.
    press: Vec<f64>,
    /// Weight of grains.
    weight: Vec<f64>,
    /// Force on the floor.
    floor: f64,
}

/// Slices of a profile: more than the column is high.
const SLICES: usize = 40;

/// Goes on while the wall moves, and looks at each hundredth step.
fn measured(sim: &mut Simulation, samples: u32) -> Profile {
    let mut profile = Profile {
        lift: vec![0.0; SLICES],
        press: vec![0.0; SLICES],
        weight: vec![0.0; SLICES],
        floor: 0.0,
    };
    let part = 1.0 / f64::from(samples);
    for _ in 0..samples {
        sim.steps(99).expect("the wall moves");
        let mut seen = Vec::new();
        sim.step_seen(&mut seen).expect("the wall moves");
        check_reaction(sim);
        let wall = Partner::Obstacle(WALL as u32);
        for contact in seen.iter().filter(|c| c.partner == wall) {
            let slice = sim.position[contact.i as usize][2] as usize;
            profile.lift[slice] += part * contact.tangential_force[2];
            profile.press[slice] += part * contact.normal_force;
        }
        for x in &sim.position {
            profile.weight[x[2] as usize] += part * MASS;
        }
        profile.floor -= part * sim.obstacles[FLOOR].force[2];
    }
    profile
}

/// Stress at the lower end of each slice: the weight above less what the wall carries of it.
fn stresses(profile: &Profile) -> Vec<f64> {
    let slices = profile.weight.iter().zip(&profile.lift).rev();
    let above = slices.scan(0.0, |sum, (weight, lift)| {
        *sum += weight - lift;
        Some(*sum / AREA)
    });
    let mut stresses: Vec<f64> = above.collect();
    stresses.reverse();
    stresses
}

/// A column of 3.6 diameters of its cylinder whose wall goes up slowly, so that friction on it is the same at all
/// heights. The stress is Janssen's `rho g l (1 - exp(-z/l))` at the depth z, where the length l follows from what the
/// wall bears: shear over stress is q, and `l = R/(2 q)`. The cylinder is eight grains wide and the stress of a slice
/// scatters by some 5 % of its limit; 10 % is allowed.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn the_wall_of_a_silo_carries_the_grains() {
    let mut sim = poured();
    sim.steps(40_000).expect("it settles");
    check_reaction(&sim);
    let weight = f64::from(GRAINS) * MASS;
    let carried = -(sim.obstacles[FLOOR].force[2] + sim.obstacles[WALL].force[2]);
    // It is at rest but for a kinetic energy of 4e-6 of weight times diameter.
    assert!((carried / weight - 1.0).abs() < 1e-5, "{carried} {weight}");

    let histories = sim.contact_histories();
    sim.obstacles[WALL].velocity = [0.0, 0.0, 0.05];
    sim.resume(&histories).expect("it goes on");
    sim.steps(60_000).expect("the wall moves");
    let profile = measured(&mut sim, 200);
    let stresses = stresses(&profile);
    // What the floor bears is what is left at the lowest slice, but for the motion of the grains.
    assert!((stresses[0] * AREA / profile.floor - 1.0).abs() < 0.01);

    let filled: f64 = profile.weight[..20].iter().sum::<f64>() / AREA;
    let density = filled / 20.0;
    let top = weight / AREA / density;
    let shear: f64 = profile.lift[..20].iter().sum::<f64>() / (core::f64::consts::TAU * RADIUS);
    let q = shear / stresses[..20].iter().sum::<f64>();
    let length = 0.5 * RADIUS / q;
    let limit = density * length;
    let press: f64 = profile.press[..20].iter().sum();
    let ratio = press / (core::f64::consts::TAU * RADIUS) / stresses[..20].iter().sum::<f64>();
    println!(
        "l {:.2} R, K {ratio:.2}, friction {:.2}, floor {:.3} of the weight",
        length / RADIUS,
        q / ratio,
        profile.floor / weight
    );
    let mut worst: f64 = 0.0;
    for (k, stress) in stresses.iter().enumerate().take(top as usize) {
        let expected = limit * (1.0 - (-(top - k as f64) / length).exp());
        worst = worst.max((stress - expected).abs() / limit);
        assert!(
            (stress - expected).abs() < 0.1 * limit,
            "z = {k}: {stress} {expected}"
        );
    }
    println!("largest deviation {worst:.3} of the limit");
    // Most of the weight is on the wall; without friction all would be on the floor.
    assert!(
        profile.floor < 0.35 * weight,
        "{} of {weight}",
        profile.floor
    );
    // Grains that roll on the wall do not reach its friction of 0.5; the ratio of stresses is near one.
    assert!((0.7..1.4).contains(&ratio) && (0.15..MU).contains(&(q / ratio)));
}
