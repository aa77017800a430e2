//! Case files: a whole state and its law in one JSON file, the smallest unit of work to hand around.

use std::path::Path;

use bitgrain_kernel::{Domain, Fault, Group, Obstacle};
use serde::{Deserialize, Serialize};

use crate::error::{Error, FULL, Result};
use crate::law::LawSpec;
use crate::sim::{Grain, Sim, sphere_mass};

mod check;
mod motion;

pub use motion::MotionSpec;

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
    let case: Case = crate::json::parse(text, name)?;
    check::check(&case)
        .map_err(|(key, problem)| Error::input(format!("{name}: `{key}`"), problem))?;
    Ok(case)
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
                MotionSpec::Weightless => (3, g.velocity),
                MotionSpec::Lid([x, y]) => (4, [x, y, g.velocity[2]]),
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
        let groups = vec![
            Group::free(self.gravity),
            Group::frozen(),
            Group::carried(),
            Group::free([0.0; 3]),
            Group::lid(self.gravity),
        ];
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
        Fault::OverlapTooDeep { .. } | Fault::ObstacleTooDeep { .. } | Fault::Arithmetic { .. } => {
            return Error::run(name, 0, fault);
        }
        Fault::PairsFull { .. } | Fault::CandidatesFull { .. } | Fault::TouchesFull { .. } => {
            format!("{fault}{FULL}")
        }
        other => other.to_string(),
    };
    Error::input(name, problem)
}
