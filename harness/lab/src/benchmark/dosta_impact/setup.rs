//! The set-up: sizes, materials, the box, and the grains in it.

use bitgrain_kernel::{Domain, Obstacle};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::law::{AnyLaw, Elasticity, HertzTsujiPair, HertzTsujiTable, LawTable};
use bitgrain_sim::simulation::Grain;
use bitgrain_sim::spatial_order::spatial_order;

/// Diameter (m) and mass density (kg/m^3) of a grain, of the material M1.
pub(super) const DIAMETER: f64 = 0.002;
pub(super) const DENSITY: f64 = 2500.0;

/// Of the ball, of steel, with its place (m) and velocity (m/s) as it begins.
pub(super) const BALL: f64 = 0.02;
pub(super) const STEEL: f64 = 7200.0;
pub(super) const ABOVE: [f64; 3] = [0.0, 0.0, 0.06];
pub(super) const VELOCITY: [f64; 3] = [0.0, 0.0, -5.0];

/// Inner faces of the box, which is open above (m).
pub(super) const HALF: [f64; 2] = [0.049, 0.03];
pub(super) const FLOOR: f64 = -0.090_243_1;

/// Steps in a second, and the time step (s).
pub(super) const STEPS: f64 = 2e6;
pub(super) const DT: f64 = 1.0 / STEPS;

/// Numbers of the materials.
pub(super) const M1_NUMBER: u8 = 0;
pub(super) const STEEL_NUMBER: u8 = 1;

/// The law, a fraction as stiff and with this restitution of grains in place of its own.
pub(super) fn law(softened: f64, restitution: Option<f64>) -> Result<AnyLaw> {
    let elasticity = |young: f64| Elasticity {
        young: young * softened,
        poisson: 0.2,
    };
    let pair = |a: &str, b: &str, e: f64, mu: f64| HertzTsujiPair {
        between: [a.into(), b.into()],
        restitution: restitution.unwrap_or(e),
        mu,
        rolling: None,
    };
    let table = LawTable::HertzTsuji(HertzTsujiTable {
        materials: [("M1", 1e9), ("steel", 2.1e11)]
            .map(|(name, young)| (name.into(), elasticity(young)))
            .into(),
        pairs: vec![pair("M1", "M1", 0.5, 0.3), pair("M1", "steel", 0.4, 0.2)],
    });
    let wrong = |(key, problem): (String, String)| Error::input(format!("law.{key}"), problem);
    table.build().map_err(wrong)
}

/// A box round all that happens, so that what flies off far is noticed.
pub(super) fn bounds() -> Domain<f64> {
    let [x, y] = HALF.map(|half| half + 0.01);
    Domain::new([-x, -y, FLOOR - 0.01], [x, y, 2.0], [false; 3]).expect("edges in order")
}

/// Floor and four walls of steel.
pub(super) fn walls() -> Vec<Obstacle<f64>> {
    let [x, y] = HALF;
    let wall = |point, normal| Obstacle {
        material: STEEL_NUMBER,
        ..Obstacle::plane(point, normal)
    };
    vec![
        wall([0.0, 0.0, FLOOR], [0.0, 0.0, 1.0]),
        wall([-x, 0.0, 0.0], [1.0, 0.0, 0.0]),
        wall([x, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        wall([0.0, -y, 0.0], [0.0, 1.0, 0.0]),
        wall([0.0, y, 0.0], [0.0, -1.0, 0.0]),
    ]
}

/// The grains at these places, numbered as they come, at rest.
pub(super) fn grains(places: &[[f64; 3]]) -> Vec<Grain> {
    (1..)
        .zip(places)
        .map(|(id, position)| Grain {
            id,
            group: 0,
            diameter: DIAMETER,
            density: DENSITY,
            position: *position,
            velocity: [0.0; 3],
            spin: [0.0; 3],
        })
        .collect()
}

/// These places in spatial order.
pub(super) fn ordered(places: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let rows: Vec<[f64; 4]> = places.iter().map(|[x, y, z]| [*x, *y, *z, 0.0]).collect();
    let order = spatial_order(&rows, DIAMETER);
    order.into_iter().map(|k| places[k]).collect()
}
