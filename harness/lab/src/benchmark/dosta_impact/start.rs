//! Where the grains lie before the impact: from a file, or poured.

use std::path::Path;

use bitgrain_kernel::Group;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::{finite, read_text};
use bitgrain_sim::random::{Purpose, uniforms};
use bitgrain_sim::simulation::Simulation;

use super::setup::{ABOVE, BALL, DIAMETER, FLOOR, HALF, bounds, grains, law, ordered, walls};
use crate::benchmark::request::Request;

/// Most grains that are poured.
const GRAINS_MAX: u32 = 1_000_000;

/// Distance of the sites that grains fall from (diameters), and the seed of their shifts off them.
const SPACING: f64 = 1.05;
const SEED: u64 = 2024;

/// Steps between two looks whether the grains are at rest.
const LOOK: u64 = 500;

/// A stage of the pouring, from rest.
struct Stage {
    name: &'static str,
    /// How stiff the grains are, over their own stiffness.
    softened: f64,
    /// Time step (s).
    dt: f64,
    /// Most steps.
    most: u64,
}

/// Kinetic energy per grain, over its weight times its diameter, at which a stage ends. Grains that roll on each other
/// come to rest slowly; what is left, some mm/s, is stopped.
const REST: f64 = 1e-3;

/// Soft grains fall, then become as stiff as they are, in two leaps, each of which lifts them a little.
const STAGES: [Stage; 3] = [
    Stage {
        name: "pour",
        softened: 0.01,
        dt: 5e-6,
        most: 200_000,
    },
    Stage {
        name: "stiffen",
        softened: 0.1,
        dt: 1.5e-6,
        most: 200_000,
    },
    Stage {
        name: "harden",
        softened: 1.0,
        dt: 5e-7,
        most: 400_000,
    },
];

/// The restitution of all contacts until then.
const DAMPED: f64 = 0.1;

/// The centres of the grains in a file of the benchmark: a line of radius, x, y and z (m) for each. A first line of
/// words, and a line of six numbers, the ball, are passed over.
pub(super) fn read(path: &Path) -> Result<Vec<[f64; 3]>> {
    parse(&read_text(path)?, &path.display().to_string())
}

fn parse(text: &str, name: &str) -> Result<Vec<[f64; 3]>> {
    let mut places = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let numbers: Option<Vec<f64>> = words.iter().map(|word| finite(word)).collect();
        let wrong = |problem: String| Err(Error::input(format!("{name}:{}", k + 1), problem));
        match numbers.as_deref() {
            Some([]) => (),
            Some([radius, x, y, z]) => {
                if (2.0 * radius / DIAMETER - 1.0).abs() > 1e-9 {
                    let expected = 0.5 * DIAMETER;
                    return wrong(format!(
                        "has a grain of radius {radius}; expected {expected} m"
                    ));
                }
                let reach = 0.5 * DIAMETER;
                let inside = x.abs() < HALF[0] && y.abs() < HALF[1] && *z > FLOOR;
                if !inside || *z > ABOVE[2] - 0.5 * BALL - reach {
                    return wrong("has a grain outside the box, or above the ball".into());
                }
                places.push([*x, *y, *z]);
            }
            Some([_, _, _, _, _, _]) => (),
            None if k == 0 => (),
            _ => return wrong("is no grain: expected radius, x, y and z".into()),
        }
    }
    match places.is_empty() {
        false => Ok(places),
        true => Err(Error::input(
            name,
            "has no grains: expected lines of radius, x, y and z",
        )),
    }
}

/// So many grains that have fallen into the box and come to rest: soft ones first, which allow a longer step.
pub(super) fn pour(count: u32, request: &Request) -> Result<Vec<[f64; 3]>> {
    if !(1..=GRAINS_MAX).contains(&count) {
        let problem = format!("is {count}; expected 1 to {GRAINS_MAX}");
        return Err(Error::input("--grains", problem));
    }
    let mut places = lattice(count);
    for stage in &STAGES {
        places = settled(&places, stage, request)?;
    }
    Ok(places)
}

/// Where grains come to rest that are let go at these places.
fn settled(places: &[[f64; 3]], stage: &Stage, request: &Request) -> Result<Vec<[f64; 3]>> {
    let name = stage.name;
    let group = Group::free([0.0, 0.0, -9.81]);
    let law = law(stage.softened, Some(DAMPED))?;
    let grains = grains(&ordered(places));
    let mut sim = Simulation::new(law, bounds(), stage.dt, vec![group], &grains, walls());
    sim.start().map_err(|fault| Error::run(name, 0, fault))?;
    let shown = request.progress.stage(name, stage.most);
    let weight = 9.81 * sim.velocity.iter().map(|v| v[3]).sum::<f64>();
    let rest = REST * weight * DIAMETER;
    while sim.step_count() < stage.most {
        sim.steps(LOOK)
            .map_err(|fault| Error::run(name, sim.step_count() + 1, fault))?;
        let energy = sim.kinetic_energy() / rest;
        let message = format!("{energy:.1e} times the kinetic energy at rest");
        shown.at(sim.step_count(), sim.count(), &message)?;
        if energy < 1.0 {
            break;
        }
    }
    shown.finish();
    Ok(sim.position.iter().map(|x| [x[0], x[1], x[2]]).collect())
}

/// Sites on a loose lattice over the floor, each grain shifted within its cell.
fn lattice(count: u32) -> Vec<[f64; 3]> {
    let cell = SPACING * DIAMETER;
    let fit = HALF.map(|half| (2.0 * half / cell) as u32);
    let play = cell - DIAMETER;
    let place = |k: u32| {
        let site = [k % fit[0], k / fit[0] % fit[1], k / (fit[0] * fit[1])];
        let shift: [f64; 3] = uniforms(SEED, Purpose::Shift, k);
        let along = |a: usize| (f64::from(site[a]) + 0.5) * cell + (shift[a] - 0.5) * play;
        [along(0) - HALF[0], along(1) - HALF[1], along(2) + FLOOR]
    };
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_grains_is_read_with_its_heading_and_its_ball() {
        let text = "Radius[m]\tPosX[m] PosY[m] PosZ[m]\n 0.001 -0.039 0.008 -0.080\n0.001 0 0 -0.07\n\
                    5 0.01 0.01 0 0 0.06\n\n";
        let places = parse(text, "start.txt").unwrap();
        assert_eq!(places, [[-0.039, 0.008, -0.08], [0.0, 0.0, -0.07]]);
        for (wrong, place) in [
            ("", "start.txt"),
            ("0.001 0 0 -0.08\n0.001 0 0\n", "start.txt:2"),
            ("0.001 0 0 -0.08\nx y z r\n", "start.txt:2"),
            ("0.002 0 0 -0.08\n", "start.txt:1"),
            ("0.001 0.05 0 -0.08\n", "start.txt:1"),
            ("0.001 0 0 0.06\n", "start.txt:1"),
        ] {
            let refused = parse(wrong, "start.txt").unwrap_err().to_string();
            assert!(refused.starts_with(place), "{refused}");
        }
    }

    #[test]
    fn grains_fall_from_apart_and_within_the_box() {
        let places = lattice(3000);
        for (k, a) in places.iter().enumerate() {
            assert!(
                a[0].abs() <= HALF[0] - 0.5 * DIAMETER && a[1].abs() <= HALF[1] - 0.5 * DIAMETER
            );
            assert!(a[2] >= FLOOR + 0.5 * DIAMETER);
            for b in &places[..k] {
                let d: f64 = (0..3).map(|x| (a[x] - b[x]) * (a[x] - b[x])).sum();
                assert!(d >= DIAMETER * DIAMETER);
            }
        }
    }
}
