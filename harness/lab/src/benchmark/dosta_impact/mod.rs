//! Dosta et al. 2024, the impact: a steel ball hits a shallow bed of glass-like grains in a steel box at 5 m/s.
//!
//! The two public set-ups of it take g = 9.8 and 9.81 m/s^2; both are run. They give no result curves, so nothing is
//! compared; theory fixes the fall before the ball meets the bed.

mod impact;
mod start;

use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::law::{AnyLaw, Elasticity, HertzTsujiPair, HertzTsujiTable, LawTable};

use super::Request;
use super::result::Benchmark;
use impact::Course;

/// Grains of the smallest of the three published cases.
const GRAINS: u32 = 25_000;

/// Diameter (m) and mass density (kg/m^3) of a grain, of the material M1.
const DIAMETER: f64 = 0.002;
const DENSITY: f64 = 2500.0;

/// Of the ball, of steel, with its place (m) and velocity (m/s) as it begins.
const BALL: f64 = 0.02;
const STEEL: f64 = 7200.0;
const ABOVE: [f64; 3] = [0.0, 0.0, 0.06];
const VELOCITY: [f64; 3] = [0.0, 0.0, -5.0];

/// Inner faces of the box, which is open above (m).
const HALF: [f64; 2] = [0.049, 0.03];
const FLOOR: f64 = -0.090_243_1;

/// Steps in a second, the time step, and time in all (s).
const STEPS: f64 = 2e6;
const DT: f64 = 1.0 / STEPS;
const UNTIL: f64 = 0.1;

/// Both values of g (m/s^2), the more exact one first.
const GRAVITIES: [f64; 2] = [9.81, 9.8];

/// Numbers of the materials.
const M1_NUMBER: u8 = 0;
const STEEL_NUMBER: u8 = 1;

const REMARKS: [(&str, &str); 3] = [
    (
        "The ball is a body",
        "Bodies push grains and not each other. A ball that came to the floor or to a wall itself would end the run \
         with an error.",
    ),
    (
        "Both values of g",
        "Of the two public set-ups one has g = 9.81 m/s^2 and one 9.8. Both are run. Neither stores a result curve: \
         heights and speeds are given without a comparison.",
    ),
    (
        "A chaotic bed",
        "The same start gives the same bits, at any number of threads. From another start the height of the ball is the \
         same within 0.3 mm until it bounces off the grains that it jams against the floor, after 30 ms. How fast it \
         leaves depends on them: 1.8 to 2.1 m/s in four runs.",
    ),
];

/// The law, a fraction as stiff and with this restitution of grains in place of its own.
fn law(softened: f64, restitution: Option<f64>) -> Result<AnyLaw> {
    let elasticity = |young: f64| Elasticity {
        young: young * softened,
        poisson: 0.2,
    };
    let pair = |a: &str, b: &str, e: f64, mu: f64| HertzTsujiPair {
        between: [a.into(), b.into()],
        restitution: restitution.unwrap_or(e),
        mu,
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

/// Runs the impact at both values of g.
pub(super) fn run(request: &Request) -> Result<Benchmark> {
    let until = request.until.unwrap_or(UNTIL);
    if !(until > 0.0 && until <= 10.0) {
        let problem = format!("is {until}; expected a time above 0 and at most 10 s");
        return Err(Error::input("--until", problem));
    }
    let (places, from) = match request.start {
        Some(file) => (start::read(file)?, format!("as in {}", file.display())),
        None => {
            let grains = request.grains.unwrap_or(GRAINS);
            (start::pour(grains, request)?, "poured here".to_owned())
        }
    };
    let courses = GRAVITIES.map(|gravity| Course::follow(&places, gravity, until, request));
    let (mut tests, mut performance) = (Vec::new(), Vec::new());
    for (number, course) in (1..).zip(courses) {
        let course = course?;
        tests.push(course.test(number, &from));
        performance.push(course.performance);
    }
    Ok(Benchmark {
        name: "dosta-impact",
        title: "Benchmark of an impact by Dosta and others",
        source: "M. Dosta et al., Computer Physics Communications 296, 109066 (2024)",
        published: "none: neither public set-up stores a curve".into(),
        remarks: REMARKS.to_vec(),
        tests,
        performance,
    })
}
