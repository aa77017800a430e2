//! Checks of a case before it starts: its parts one by one, each with its key.

use super::keys::{Case, GrainSpec};
use super::law::check_law;
use super::motion::MotionSpec;
use super::numbers::{Check, finite, positive};
use super::obstacle::ObstacleSpec;
use bitgrain_kernel::Domain;
use bitgrain_sim::owned_world::OwnedWorld;

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
        let place = format!("grains[{k}]");
        check_grain(g, &place)?;
        check_material(case, g.material.as_deref(), &place)?;
    }
    let mut ids: Vec<u32> = case.grains.iter().map(|g| g.id).collect();
    ids.sort_unstable();
    if let Some(pair) = ids.windows(2).find(|p| p[0] == p[1]) {
        let problem = format!("id {} appears twice; ids must differ", pair[0]);
        return Err(("grains".into(), problem));
    }
    for (k, o) in case.obstacles.iter().enumerate() {
        let place = format!("obstacles[{k}]");
        check_obstacle(o, case.gravity, &place)?;
        check_material(case, o.material.as_deref(), &place)?;
    }
    check_law(case)
}

fn check_material(case: &Case, name: Option<&str>, place: &str) -> Check {
    let material = case.law.material(name);
    material.map_err(|problem| (format!("{place}.material"), problem))?;
    Ok(())
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

fn check_obstacle(o: &ObstacleSpec, gravity: [f64; 3], place: &str) -> Check {
    let at = |key: &str| format!("{place}.{key}");
    finite(&at("velocity"), &o.velocity)?;
    let vectors = [
        ("angular_velocity", o.angular_velocity),
        ("applied_force", o.applied_force),
        ("applied_torque", o.applied_torque),
    ];
    for (key, vector) in vectors {
        finite(&at(key), &vector.unwrap_or([0.0; 3]))?;
    }
    let built = o.build(gravity, &mut OwnedWorld::new(Domain::open(), 1.0));
    built.map_err(|(key, problem)| (at(&key), problem))?;
    Ok(())
}
