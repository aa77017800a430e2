//! Checks of a case before it starts: its parts one by one, each with its key.

use super::keys::{Case, GrainSpec, ObstacleSpec};
use super::motion::MotionSpec;

/// Nothing, or the key that is wrong and what is wrong with it.
type Check = Result<(), (String, String)>;

pub(super) fn check(case: &Case) -> Check {
    case.law
        .build()
        .map_err(|(key, problem)| (format!("law.{key}"), problem))?;
    if case.grains.is_empty() {
        return Err((
            "grains".into(),
            "is empty; expected at least one grain".into(),
        ));
    }
    finite("gravity", &case.gravity)?;
    for (k, g) in case.grains.iter().enumerate() {
        check_grain(g, &format!("grains[{k}]"))?;
    }
    let mut ids: Vec<u32> = case.grains.iter().map(|g| g.id).collect();
    ids.sort_unstable();
    if let Some(pair) = ids.windows(2).find(|p| p[0] == p[1]) {
        let problem = format!("id {} appears twice; ids must differ", pair[0]);
        return Err(("grains".into(), problem));
    }
    for (k, o) in case.obstacles.iter().enumerate() {
        check_obstacle(o, &format!("obstacles[{k}]"))?;
    }
    let sizes = case.grains.iter().map(|g| (0.5 * g.diameter, g.density));
    case.law
        .check_time_step(case.dt, sizes)
        .map_err(|p| ("dt".to_string(), p))
}

fn check_grain(g: &GrainSpec, place: &str) -> Check {
    if g.id == 0 {
        return Err((format!("{place}.id"), "is 0; ids begin at 1".into()));
    }
    positive(&format!("{place}.diameter"), g.diameter)?;
    positive(&format!("{place}.density"), g.density)?;
    finite(&format!("{place}.position"), &g.position)?;
    finite(&format!("{place}.velocity"), &g.velocity)?;
    finite(&format!("{place}.spin"), &g.spin)?;
    let rests = g.velocity == [0.0; 3] && g.spin == [0.0; 3];
    match g.motion {
        MotionSpec::Free | MotionSpec::Weightless => Ok(()),
        MotionSpec::Lid(v) => {
            finite(&format!("{place}.motion.lid"), &[v[0], v[1], 0.0])?;
            let along = [g.velocity[0], g.velocity[1]];
            if along == [0.0; 2] || along == v {
                return Ok(());
            }
            let problem = "a lid's grain has a velocity along x or y besides the one that carries \
                           it; give 0 for both";
            Err((place.into(), problem.into()))
        }
        MotionSpec::Frozen if rests => Ok(()),
        MotionSpec::Frozen => Err((
            place.into(),
            "a frozen grain has a velocity or spin; leave them out or make it free".into(),
        )),
        MotionSpec::Carried(v) => {
            finite(&format!("{place}.motion.carried"), &v)?;
            if g.spin == [0.0; 3] && (g.velocity == [0.0; 3] || g.velocity == v) {
                Ok(())
            } else {
                let problem = "a carried grain has a spin or a further velocity; leave them out";
                Err((place.into(), problem.into()))
            }
        }
    }
}

fn check_obstacle(o: &ObstacleSpec, place: &str) -> Check {
    let at = |key: &str| format!("{place}.{key}");
    match o {
        ObstacleSpec::Plane {
            point,
            normal,
            velocity,
        } => {
            finite(&at("point"), point)?;
            direction(&at("normal"), normal)?;
            finite(&at("velocity"), velocity)
        }
        ObstacleSpec::Sphere {
            center,
            diameter,
            density,
            velocity,
        } => {
            finite(&at("center"), center)?;
            positive(&at("diameter"), *diameter)?;
            if let Some(density) = density {
                positive(&at("density"), *density)?;
            }
            finite(&at("velocity"), velocity)
        }
        ObstacleSpec::Cylinder {
            center,
            axis,
            diameter,
            velocity,
        } => {
            finite(&at("center"), center)?;
            direction(&at("axis"), axis)?;
            positive(&at("diameter"), *diameter)?;
            finite(&at("velocity"), velocity)
        }
    }
}

fn positive(key: &str, value: f64) -> Check {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err((
        key.into(),
        format!("is {value}; expected a positive number"),
    ))
}

fn finite(key: &str, v: &[f64; 3]) -> Check {
    if v.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err((key.into(), "has a component that is not finite".into()))
}

fn direction(key: &str, v: &[f64; 3]) -> Check {
    finite(key, v)?;
    let squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if squared.is_normal() {
        return Ok(());
    }
    Err((
        key.into(),
        "has no length; expected a direction such as [0, 0, 1]".into(),
    ))
}
