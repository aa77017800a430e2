//! The beds that the live page begins with: glass beads, softened, that fell round a body and came to rest.
//!
//! Lengths in metres, masses in kilograms, times in seconds.

use bitgrain::case::{BoxSpec, Case, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::law::{HertzTsujiParameters, LawSpec};
use bitgrain::random::{Purpose, uniforms};
use bitgrain::simulation::Simulation;
use bitgrain_kernel::vec3::head;

/// Names of the bodies.
pub const BODIES: [&str; 2] = ["ball", "cylinder"];

/// How many grains there are.
pub const GRAINS: u32 = 2000;

/// Mean diameter.
const D: f64 = 0.003;
/// Twenty by ten diameters, and as high as the lattice from which the grains fall.
const BOX: [f64; 3] = [0.06, 0.03, 0.12];
/// Sites of a layer of that lattice along x and y: 1.1 mean diameters apart at least, so that none touch.
const SITES: [u32; 2] = [17, 8];
/// Speed of the body along x in the case that the page opens.
const SPEED: f64 = 0.1;
/// Grains whose centres come to rest below it become the base, which does not move.
const BASE: f64 = 0.6 * D;
/// Steps until the fall is over and the last motion is damped: 1.2 s.
const FALL: u64 = 60_000;

fn law(restitution: f64) -> LawSpec {
    // A thousand times softer than glass, as the numbers of steps a second ask for.
    LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 4e6,
        poisson: 0.3,
        restitution,
        mu: 0.5,
        rolling: None,
    })
}

fn body(kind: &str) -> ObstacleSpec {
    // Four diameters wide, a third of it above the surface.
    match kind {
        "ball" => ObstacleSpec::sphere([0.015, 0.015, 0.026], 4.0 * D),
        _ => ObstacleSpec::cylinder([0.015, 0.015, 0.026], [0.0, 1.0, 0.0], 4.0 * D),
    }
}

/// A number with so many decimals, as a file shows it.
fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

/// The grains before they fall, in order of height.
fn lattice(body: &ObstacleSpec) -> Vec<GrainSpec> {
    let apart = [
        BOX[0] / f64::from(SITES[0]),
        BOX[1] / f64::from(SITES[1]),
        1.15 * D,
    ];
    let center = body.center.expect("a ball or a cylinder has a centre");
    let is_round = body.axis.is_none();
    let mut grains = Vec::new();
    for site in 0.. {
        if grains.len() == GRAINS as usize {
            break;
        }
        let column = site % (SITES[0] * SITES[1]);
        let layer = site / (SITES[0] * SITES[1]);
        let at = [column % SITES[0], column / SITES[0], layer].map(f64::from);
        let shift: [f64; 3] = uniforms(1, Purpose::Shift, site);
        let [size] = uniforms(1, Purpose::Diameter, site);
        // Sites are 3.45 mm apart and grains at most 3.3 mm wide.
        let position: [f64; 3] = std::array::from_fn(|a| {
            rounded(apart[a] * (at[a] + 0.5) + 1e-4 * (shift[a] - 0.5), 1e7)
        });
        let off: [f64; 3] = std::array::from_fn(|a| position[a] - center[a]);
        let across = if is_round { off[1] } else { 0.0 };
        let square = off[0] * off[0] + across * across + off[2] * off[2];
        // The body lies in the lattice: half of its width, half of the widest grain.
        if square < (2.0 * D + 0.55 * D) * (2.0 * D + 0.55 * D) {
            continue;
        }
        grains.push(GrainSpec {
            id: grains.len() as u32 + 1,
            diameter: rounded(D * (0.9 + 0.2 * size), 1e5),
            density: 2500.0,
            position,
            velocity: [0.0; 3],
            spin: [0.0; 3],
            motion: MotionSpec::Free,
            material: None,
        });
    }
    grains
}

fn after(case: &Case, steps: u64) -> Simulation {
    let mut sim = case
        .start("the bed of the page", |_| {})
        .expect("a sound case");
    sim.steps(steps).expect("nothing stops a fall");
    sim
}

/// The case that the page opens: a bed at rest round a body, one of [`BODIES`], that moves along x.
pub fn start(kind: &str) -> Case {
    let body = body(kind);
    let floor = ObstacleSpec::plane([0.0; 3], [0.0, 0.0, 1.0]);
    let mut case = Case {
        law: law(0.1).into(),
        bounds: Some(BoxSpec {
            lo: [0.0; 3],
            hi: BOX,
            periodic: [true, true, false],
        }),
        gravity: [0.0, 0.0, -9.81],
        dt: 2e-5,
        grains: lattice(&body),
        obstacles: vec![floor, body],
    };
    // Twice: grains of the base are frozen where they came to rest, and the others settle on them.
    for _ in 0..2 {
        let sim = after(&case, FALL);
        for (grain, row) in case.grains.iter_mut().zip(&sim.position) {
            // A ten-thousandth of a millimetre is a hundredth of the overlaps at rest.
            grain.position = head(*row).map(|x| rounded(x, 1e7));
            if grain.position[2] < BASE {
                grain.motion = MotionSpec::Frozen;
            }
        }
    }
    case.law = law(0.6).into();
    case.obstacles[1].velocity = [SPEED, 0.0, 0.0];
    case
}
