//! One contact over many steps, by either law, on every obstacle.

use bitgrain::case::{self, BoxSpec, Case, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::law::RAYLEIGH_FRACTION_MAX;

use super::bytes::{Bytes, unit};
use super::finite::assert_finite;

/// Steps of one contact: enough for it to open, slide and close again.
const CONTACT_STEPS: u8 = 200;

/// One contact over many steps, under parameters drawn from the bytes: two grains, the first at an
/// obstacle or not, in open space or across a periodic edge, twice with different skins.
pub fn contact(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    let drawn = contact_case(&mut bytes);
    let text = serde_json::to_string(&drawn).expect("a case can be written");
    if text.contains("null") {
        // A drawn number is not finite, which JSON cannot say.
        return false;
    }
    let Ok(read) = case::parse(&text, "fuzz") else {
        return false;
    };
    assert_eq!(read, drawn, "a case changes on the way through JSON");
    let Ok(mut sim) = read.start("fuzz", |_| {}) else {
        return false;
    };
    let mut twin = sim.clone();
    let wider = [0.0, 0.3, 3.0][bytes.below(3)];
    (twin.skin, twin.outer_skin) = (twin.skin * wider, twin.outer_skin * wider);
    twin.start().expect("the same start with another skin");
    let steps = 1 + bytes.byte() % CONTACT_STEPS;
    for step in 0..steps {
        let (one, other) = (sim.steps(1), twin.steps(1));
        assert_eq!(one, other, "a fault depends on the skin");
        if one.is_err() {
            return step > 0;
        }
        assert_finite(&sim);
    }
    assert_eq!(sim.digest(), twin.digest(), "a bit depends on the skin");
    true
}

/// `from + direction * distance`.
fn beyond(from: [f64; 3], direction: [f64; 3], distance: f64) -> [f64; 3] {
    std::array::from_fn(|a| from[a] + direction[a] * distance)
}

/// Two grains about to touch or touching, the first with an obstacle beside it or not.
fn contact_case(bytes: &mut Bytes) -> Case {
    let law = bytes.law();
    let size = bytes.scale(-4.0, 4.0);
    let density = bytes.scale(-3.0, 4.0);
    let sizes = [size, size * bytes.between(0.2, 5.0)];
    let body = size * bytes.between(0.2, 10.0);
    let smallest = 0.5 * sizes[0].min(sizes[1]);
    let dt =
        RAYLEIGH_FRACTION_MAX * law.rayleigh_time(smallest, density) * bytes.between(0.01, 1.0);
    // Up to one and a half radii a step.
    let speed = bytes.scale(-7.0, 0.2) * smallest / dt;
    let length = 4.0 * (body + sizes[0] + sizes[1]);
    let axis_periodic = [bytes.below(2) == 0, bytes.below(2) == 0, false];
    let bounds = (bytes.below(3) > 0).then_some(BoxSpec {
        lo: [0.0; 3],
        hi: [length, length, 2.0 * length],
        periodic: axis_periodic,
    });
    let centre = [
        length * bytes.between(0.0, 0.999),
        length * bytes.between(0.0, 0.999),
        length,
    ];
    let (obstacle, normal, radius) = obstacle(bytes, &bounds, centre, body, speed);
    let overlap = bytes.between(-0.1, 0.3) * sizes[0];
    let first = beyond(centre, normal, radius + 0.5 * sizes[0] - overlap);
    let overlap = bytes.between(-0.1, 0.3) * smallest;
    let second = beyond(
        first,
        bytes.direction(),
        0.5 * (sizes[0] + sizes[1]) - overlap,
    );
    let mut grain = |id: u32, diameter: f64, position: [f64; 3]| {
        let motion = bytes.motion(speed);
        // Along which axes it may have its own velocity, and whether it may spin.
        let (moves, spins) = match motion {
            MotionSpec::Free | MotionSpec::Weightless => ([1.0; 3], 1.0),
            MotionSpec::Lid(_) => ([0.0, 0.0, 1.0], 1.0),
            MotionSpec::Frozen | MotionSpec::Carried(_) => ([0.0; 3], 0.0),
        };
        let mut drawn = |scale: f64, may: [f64; 3]| -> [f64; 3] {
            let v = bytes.vector();
            std::array::from_fn(|a| v[a] * scale * may[a])
        };
        GrainSpec {
            id,
            diameter,
            density,
            position,
            velocity: drawn(speed, moves),
            spin: drawn(speed / diameter, [spins; 3]),
            motion,
            material: None,
        }
    };
    let grains = vec![grain(1, sizes[0], first), grain(7, sizes[1], second)];
    Case {
        law: law.into(),
        bounds,
        gravity: [0.0, 0.0, -bytes.zero_or_scale(-3.0, 2.0)],
        dt,
        obstacles: obstacle.into_iter().collect(),
        grains,
    }
}

/// An obstacle of each shape or none, the direction from it to the first grain, and its radius.
fn obstacle(
    bytes: &mut Bytes,
    bounds: &Option<BoxSpec>,
    center: [f64; 3],
    diameter: f64,
    speed: f64,
) -> (Option<ObstacleSpec>, [f64; 3], f64) {
    let shape = bytes.below(4);
    let velocity = bytes.vector().map(|v| v * speed);
    let direction = bytes.direction();
    // In a box with periodic axes planes face up and bars lie along an axis.
    let upright = bounds.is_some_and(|b| b.periodic.contains(&true));
    match shape {
        0 => {
            let normal = if upright { [0.0, 0.0, 1.0] } else { direction };
            let plane = ObstacleSpec {
                velocity,
                ..ObstacleSpec::plane(center, normal)
            };
            (Some(plane), normal, 0.0)
        }
        1 => {
            let density = (bytes.below(2) == 0).then(|| bytes.scale(-3.0, 4.0));
            let sphere = ObstacleSpec {
                density,
                velocity,
                ..ObstacleSpec::sphere(center, diameter)
            };
            (Some(sphere), direction, 0.5 * diameter)
        }
        2 => {
            let lying = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][bytes.below(3)];
            let axis = if upright { lying } else { bytes.direction() };
            let along = (0..3).map(|a| direction[a] * axis[a]).sum::<f64>();
            let across = unit(beyond(direction, axis, -along));
            let cylinder = ObstacleSpec {
                velocity,
                ..ObstacleSpec::cylinder(center, axis, diameter)
            };
            (Some(cylinder), across, 0.5 * diameter)
        }
        _ => (None, direction, 0.0),
    }
}
