//! Checks of a case before it starts: its parts one by one, each with its key.

use super::keys::{Case, GrainSpec};
use super::law::CaseLaw;
use super::motion::MotionSpec;
use super::numbers::{Check, finite, positive};
use super::obstacle::ObstacleSpec;
use bitgrain_kernel::Domain;
use bitgrain_sim::law::{check_rayleigh, rayleigh_time};
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

/// Checks that the law has numbers for every two bodies of the case that can meet, and that the time step resolves
/// waves in the grains. The names of all materials are known to be right.
fn check_law(case: &Case) -> Check {
    let grains = case.grains.iter();
    let grains = grains.map(|g| (g, case.law.material(g.material.as_deref()).unwrap_or(0)));
    let grains: Vec<_> = grains.collect();
    let time = |g: &GrainSpec, material| match &case.law {
        CaseLaw::One(law) => law.rayleigh_time(0.5 * g.diameter, g.density),
        CaseLaw::Pairs(law) => {
            let moduli = law.moduli(material);
            moduli.map_or(f64::INFINITY, |moduli| {
                rayleigh_time(moduli, 0.5 * g.diameter, g.density)
            })
        }
    };
    let times = grains.iter().map(|(g, material)| time(g, *material));
    check_rayleigh(case.dt, times).map_err(|problem| ("dt".to_string(), problem))?;
    let CaseLaw::Pairs(law) = &case.law else {
        return Ok(());
    };
    let mut counts = vec![0usize; usize::from(case.law.materials())];
    for (_, material) in &grains {
        counts[usize::from(*material)] += 1;
    }
    let names = law.names();
    let bodies = case.obstacles.iter();
    let bodies = bodies.map(|body| case.law.material(body.material.as_deref()).unwrap_or(0));
    let bodies: Vec<u8> = bodies.collect();
    for a in (0..case.law.materials()).filter(|a| counts[usize::from(*a)] > 0) {
        for b in 0..case.law.materials() {
            let least = if a == b { 2 } else { 1 };
            let meet = counts[usize::from(b)] >= least || bodies.contains(&b);
            if meet && !law.has([a, b]) {
                let [a, b] = [a, b].map(|material| names[usize::from(material)]);
                let problem = format!(
                    "has no numbers for \"{a}\" on \"{b}\", which can meet; add {{\"between\": [\"{a}\", \
                     \"{b}\"], ...}}"
                );
                return Err(("law.pairs".into(), problem));
            }
        }
    }
    Ok(())
}
