//! Checks of a case before it starts: its parts one by one, each with its key.

use super::keys::{Case, GrainSpec};
use super::law::CaseLaw;
use super::motion::MotionSpec;
use super::numbers::{Check, finite, positive};
use super::obstacle::ObstacleSpec;
use bitgrain_kernel::Domain;
use bitgrain_sim::law::{check_rayleigh, rayleigh_time};
use bitgrain_sim::owned_world::OwnedWorld;

pub(super) fn check(case: &Case, most: f64) -> Check {
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
        check_obstacle(o, case.gravity, &format!("obstacles[{k}]"))?;
    }
    check_law(case, &case.materials()?, most)
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

/// Checks that the time step is at most so much of the shortest Rayleigh time of the grains, and that the law has
/// numbers for every two bodies of the case that can meet, of which these are the materials.
fn check_law(case: &Case, [grains, bodies]: &[Vec<u8>; 2], most: f64) -> Check {
    let too_long = |problem| ("dt".to_string(), problem);
    let sizes = case.grains.iter().map(|g| (0.5 * g.diameter, g.density));
    let law = match &case.law {
        CaseLaw::One(law) => {
            let times = sizes.map(|(radius, density)| law.rayleigh_time(radius, density));
            return check_rayleigh(case.dt, times, most).map_err(too_long);
        }
        CaseLaw::Pairs(law) => law,
    };
    let (names, pairs) = (law.names(), law.pairs());
    let all = 0..case.law.materials();
    let moduli: Vec<_> = all.clone().map(|material| law.moduli(material)).collect();
    let times = grains
        .iter()
        .zip(sizes)
        .filter_map(|(material, (radius, density))| {
            let moduli = moduli[usize::from(*material)]?;
            Some(rayleigh_time(moduli, radius, density))
        });
    check_rayleigh(case.dt, times, most).map_err(too_long)?;
    let mut counts = vec![0; names.len()];
    grains.iter().for_each(|of| counts[usize::from(*of)] += 1);
    let count = |material: u8| counts[usize::from(material)];
    for [a, b] in all.clone().flat_map(|a| all.clone().map(move |b| [a, b])) {
        let least = if a == b { 2 } else { 1 };
        let meet = count(a) > 0 && (count(b) >= least || bodies.contains(&b));
        if meet && !pairs.contains(&[a, b]) && !pairs.contains(&[b, a]) {
            let [a, b] = [a, b].map(|material| names[usize::from(material)]);
            let problem = format!(
                "has no numbers for \"{a}\" on \"{b}\", which can meet; add {{\"between\": [\"{a}\", \
                 \"{b}\"], ...}}"
            );
            return Err(("law.pairs".into(), problem));
        }
    }
    Ok(())
}
