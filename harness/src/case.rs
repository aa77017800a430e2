//! Case files: a whole state and its law in one JSON file, the smallest unit of work to hand around.

use std::path::Path;

use bitgrain_kernel::{Domain, Fault, Group, Obstacle};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::law::LawSpec;
use crate::sim::{Grain, Sim, sphere_mass};

/// A case as its file spells it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Contact law.
    pub law: LawSpec,
    /// The box; open space where it is missing.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub bounds: Option<BoxSpec>,
    /// Acceleration of gravity on free grains.
    #[serde(default)]
    pub gravity: [f64; 3],
    /// Time step.
    pub dt: f64,
    /// Obstacles, numbered from 0 in this order.
    #[serde(default)]
    pub obstacles: Vec<ObstacleSpec>,
    /// Grains, in any order.
    pub grains: Vec<GrainSpec>,
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Lower edges.
    pub lo: [f64; 3],
    /// Upper edges.
    pub hi: [f64; 3],
    /// Which axes are periodic.
    pub periodic: [bool; 3],
}

/// An obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case", deny_unknown_fields)]
pub enum ObstacleSpec {
    /// A wall through `point`; grains live where `normal` points.
    Plane {
        /// A point of the wall.
        point: [f64; 3],
        /// Direction out of the wall, of any length.
        normal: [f64; 3],
        /// Velocity.
        #[serde(default)]
        velocity: [f64; 3],
    },
    /// A ball; with a density its own mass enters its contacts, without one it is infinitely heavy.
    Sphere {
        /// Centre.
        center: [f64; 3],
        /// Diameter.
        diameter: f64,
        /// Mass density; a null is no way to leave it out.
        #[serde(
            default,
            deserialize_with = "number",
            skip_serializing_if = "Option::is_none"
        )]
        density: Option<f64>,
        /// Velocity.
        #[serde(default)]
        velocity: [f64; 3],
    },
    /// An endless, infinitely heavy bar.
    Cylinder {
        /// A point of its axis.
        center: [f64; 3],
        /// Direction of its axis, of any length.
        axis: [f64; 3],
        /// Diameter.
        diameter: f64,
        /// Velocity.
        #[serde(default)]
        velocity: [f64; 3],
    },
}

/// How a grain moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionSpec {
    /// By forces and gravity.
    #[default]
    Free,
    /// Not at all; infinitely heavy in a contact.
    Frozen,
    /// At this velocity, without spin.
    Carried([f64; 3]),
}

/// A grain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrainSpec {
    /// Name, from 1.
    pub id: u32,
    /// Diameter.
    pub diameter: f64,
    /// Mass density.
    pub density: f64,
    /// Position of the centre.
    pub position: [f64; 3],
    /// Velocity.
    #[serde(default)]
    pub velocity: [f64; 3],
    /// Spin.
    #[serde(default)]
    pub spin: [f64; 3],
    /// How it moves.
    #[serde(default)]
    pub motion: MotionSpec,
}

fn number<'de, D: serde::Deserializer<'de>>(from: D) -> std::result::Result<Option<f64>, D::Error> {
    f64::deserialize(from).map(Some)
}

/// Reads and checks a case file.
///
/// # Errors
/// [`Error::Input`] with line or key, and what was expected.
pub fn read(path: &Path) -> Result<Case> {
    let text = crate::files::read_text(path)?;
    parse(&text, &path.display().to_string())
}

/// Parses the text of a case file; `name` is what errors call it.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, name: &str) -> Result<Case> {
    let mut json = serde_json::Deserializer::from_str(text);
    let case: Case = serde_path_to_error::deserialize(&mut json).map_err(|e| {
        let (line, key) = (e.inner().line(), e.path().to_string());
        let place = if line > 0 {
            format!("{name}:{line}")
        } else {
            name.to_string()
        };
        let key = if key == "." {
            String::new()
        } else {
            format!("`{key}`: ")
        };
        Error::input(
            place,
            format!("{key}{}", crate::error::teach(&e.inner().to_string())),
        )
    })?;
    json.end().map_err(|e| {
        let place = format!("{name}:{}", e.line());
        Error::input(
            place,
            "text after the end of the case; expected one JSON object",
        )
    })?;
    check(&case).map_err(|(key, problem)| Error::input(format!("{name}: `{key}`"), problem))?;
    Ok(case)
}

type Refusal = (String, String);

fn check(case: &Case) -> std::result::Result<(), Refusal> {
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

fn check_grain(g: &GrainSpec, place: &str) -> std::result::Result<(), Refusal> {
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
        MotionSpec::Free => Ok(()),
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
                let problem = "a carried grain has a spin or another velocity; leave them out";
                Err((place.into(), problem.into()))
            }
        }
    }
}

fn check_obstacle(o: &ObstacleSpec, place: &str) -> std::result::Result<(), Refusal> {
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

fn positive(key: &str, value: f64) -> std::result::Result<(), Refusal> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err((
        key.into(),
        format!("is {value}; expected a positive number"),
    ))
}

fn finite(key: &str, v: &[f64; 3]) -> std::result::Result<(), Refusal> {
    if v.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err((key.into(), "has a component that is not finite".into()))
}

fn direction(key: &str, v: &[f64; 3]) -> std::result::Result<(), Refusal> {
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

impl ObstacleSpec {
    fn build(&self) -> Obstacle<f64> {
        match *self {
            ObstacleSpec::Plane {
                point,
                normal,
                velocity,
            } => Obstacle {
                velocity,
                ..Obstacle::plane(point, normal)
            },
            ObstacleSpec::Sphere {
                center,
                diameter,
                density,
                velocity,
            } => Obstacle {
                velocity,
                inverse_mass: density.map_or(0.0, |d| 1.0 / sphere_mass(diameter, d)),
                ..Obstacle::sphere(center, 0.5 * diameter)
            },
            ObstacleSpec::Cylinder {
                center,
                axis,
                diameter,
                velocity,
            } => Obstacle {
                velocity,
                ..Obstacle::cylinder(center, axis, 0.5 * diameter)
            },
        }
    }
}

impl Case {
    /// The case as a simulation that has evaluated its forces at step 0.
    ///
    /// A coordinate within one period outside a periodic axis is wrapped into the box.
    ///
    /// # Errors
    /// [`Error::Input`] where grains, obstacles and box do not fit together; [`Error::Run`] where
    /// grains overlap too deep to begin with.
    pub fn start(
        &self,
        name: &str,
        watch: impl FnMut(bitgrain_kernel::Pushed<f64>),
    ) -> Result<Sim> {
        let law = self
            .law
            .build()
            .map_err(|(k, p)| Error::input(format!("{name}: `law.{k}`"), p))?;
        let domain = match &self.bounds {
            None => Domain::open(),
            Some(b) => Domain::new(b.lo, b.hi, b.periodic).map_err(|_| {
                let problem = "edges are not in order; expected lo below hi on every axis";
                Error::input(format!("{name}: `box`"), problem)
            })?,
        };
        let mut grains = Vec::with_capacity(self.grains.len());
        for g in &self.grains {
            let mut position = g.position;
            domain.wrap(&mut position, &mut [0; 3]);
            let (group, velocity) = match g.motion {
                MotionSpec::Free => (0, g.velocity),
                MotionSpec::Frozen => (1, g.velocity),
                MotionSpec::Carried(v) => (2, v),
            };
            grains.push(Grain {
                id: g.id,
                group,
                diameter: g.diameter,
                density: g.density,
                position,
                velocity,
                spin: g.spin,
            });
        }
        grains.sort_by_key(|g| g.id);
        let mut obstacles: Vec<Obstacle<f64>> = self.obstacles.iter().map(|o| o.build()).collect();
        for body in &mut obstacles {
            domain.wrap(&mut body.point, &mut [0; 3]);
        }
        let groups = vec![Group::free(self.gravity), Group::frozen(), Group::carried()];
        let mut sim = Sim::new(law, domain, self.dt, groups, &grains, obstacles);
        sim.start_watched(watch).map_err(|fault| {
            refuse(name, fault, |id| {
                let at = self.grains.iter().position(|g| g.id == id).unwrap_or(0);
                format!(
                    "grain {id} (`grains[{at}]`, at {:?})",
                    self.grains[at].position
                )
            })
        })?;
        Ok(sim)
    }
}

/// What the kernel finds before the first step is the input's fault, except overlaps: those are the
/// first step of a run that went wrong.
pub(crate) fn refuse(name: &str, fault: Fault, place_of: impl Fn(u32) -> String) -> Error {
    let problem = match fault {
        Fault::Escaped { id } => format!("{} lies outside the box", place_of(id)),
        Fault::PeriodTooShort { axis } => format!(
            "the periodic box is too short along {}: a grain could touch two images of one body; \
             make it longer than twice the largest contact distance",
            ["x", "y", "z"][axis as usize]
        ),
        Fault::BadObstacle { obstacle } => format!(
            "obstacle {obstacle} does not fit the box: a ball or bar must have its centre inside \
             and be no larger; a plane may not face along a periodic axis; with periodic axes a \
             cylinder must lie along x, y or z; and its mass must be a sound number"
        ),
        Fault::ObstacleTooFast { .. } => format!("{fault}; shorten dt"),
        Fault::TooFast { id } => format!(
            "{} would move more than its own radius in one step; shorten dt",
            place_of(id)
        ),
        Fault::NotFinite { id } => format!(
            "{} has a velocity, spin or force too large to compute with",
            place_of(id)
        ),
        Fault::OverlapTooDeep { .. } | Fault::ObstacleTooDeep { .. } => {
            return Error::run(name, 0, fault);
        }
        other => other.to_string(),
    };
    Error::input(name, problem)
}
