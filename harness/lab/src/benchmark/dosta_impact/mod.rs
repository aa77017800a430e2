//! Dosta et al. 2024, the impact: a steel ball hits a shallow bed of glass-like grains in a steel box at 5 m/s.
//!
//! The two public set-ups of it take g = 9.8 and 9.81 m/s^2; both are run. They give no result curves, so nothing is
//! compared; theory fixes the fall before the ball meets the bed.

mod impact;
mod setup;
mod start;

use bitgrain_sim::error::{Error, Result};

use super::request::Request;
use super::result::Benchmark;
use impact::Course;

/// Grains of the smallest of the three published cases.
const GRAINS: u32 = 25_000;

/// Time in all (s).
const UNTIL: f64 = 0.1;

/// Both values of g (m/s^2), the more exact one first.
const GRAVITIES: [f64; 2] = [9.81, 9.8];

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
        "The same start gives the same bits, at any number of threads. From another start the height of the ball is \
         the same within 0.3 mm until it bounces off the grains that it jams against the floor, after 30 ms. How fast \
         it leaves depends on them: 1.8 to 2.1 m/s in four runs.",
    ),
];

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
