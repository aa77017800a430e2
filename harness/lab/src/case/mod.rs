//! Case files: a whole state and its law in one JSON file, the smallest unit of work to exchange.

use std::path::Path;

use bitgrain_kernel::{Domain, Error as KernelError, Group};

use bitgrain_sim::error::{Error, FULL, Result};
use bitgrain_sim::law::RAYLEIGH_FRACTION_MAX;
use bitgrain_sim::mesh::read_stl;
use bitgrain_sim::simulation::{Grain, Simulation};

mod check;
mod keys;
mod law;
mod motion;
mod numbers;
mod obstacle;

pub use keys::{BoxSpec, Case, GrainSpec};
pub use law::CaseLaw;
pub use motion::MotionSpec;
pub use obstacle::{BodyMotion, BodyShape, ObstacleSpec};

/// Reads and checks a case file.
///
/// # Errors
/// [`Error::Input`] with line or key, and what was expected.
pub fn read(path: &Path) -> Result<Case> {
    read_up_to(path, RAYLEIGH_FRACTION_MAX)
}

/// [`read`], with a time step up to `most` of the shortest Rayleigh time of the grains.
///
/// # Errors
/// As [`read`].
pub fn read_up_to(path: &Path, most: f64) -> Result<Case> {
    let text = bitgrain_sim::files::read_text(path)?;
    let name = path.display().to_string();
    let mut case: Case = crate::json::parse(&text, &name)?;
    for body in &mut case.obstacles {
        if let Some(file) = body.file.take() {
            let folder = path.parent().unwrap_or(Path::new(""));
            body.triangles = Some(read_stl(&folder.join(file))?);
        }
    }
    checked(case, &name, most)
}

/// Parses the text of a case file that names no other file; `name` is what errors call it.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, name: &str) -> Result<Case> {
    checked(crate::json::parse(text, name)?, name, RAYLEIGH_FRACTION_MAX)
}

fn checked(case: Case, name: &str, most: f64) -> Result<Case> {
    check::check(&case, most)
        .map_err(|(key, problem)| Error::input(format!("{name}: `{key}`"), problem))?;
    Ok(case)
}

/// The ways in which grains of a case move: the groups of each material.
const MOTIONS: u8 = 5;

impl Case {
    /// The case as a simulation that has evaluated its forces at step 0.
    ///
    /// A coordinate within one period outside a periodic axis is wrapped into the box.
    ///
    /// # Errors
    /// [`Error::Input`] if grains, obstacles and box do not fit together; [`Error::Run`] if
    /// grains overlap too deep to begin with.
    pub fn start(
        &self,
        name: &str,
        watch: impl FnMut(bitgrain_kernel::ContactForce<f64>),
    ) -> Result<Simulation> {
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
        let materials = self.materials();
        let [of_grains, of_bodies] = materials
            .map_err(|(key, problem)| Error::input(format!("{name}: `{key}`"), problem))?;
        let mut grains = Vec::with_capacity(self.grains.len());
        for (g, material) in self.grains.iter().zip(of_grains) {
            let mut position = g.position;
            domain.wrap(&mut position, &mut [0; 3]);
            let (motion, velocity) = match g.motion {
                MotionSpec::Free => (0, g.velocity),
                MotionSpec::Frozen => (1, g.velocity),
                MotionSpec::Carried(v) => (2, v),
                MotionSpec::Weightless => (3, g.velocity),
                MotionSpec::Lid([x, y]) => (4, [x, y, g.velocity[2]]),
            };
            grains.push(Grain {
                id: g.id,
                group: MOTIONS * material + motion,
                diameter: g.diameter,
                density: g.density,
                position,
                velocity,
                spin: g.spin,
            });
        }
        grains.sort_by_key(|g| g.id);
        let motions: [_; MOTIONS as usize] = [
            Group::free(self.gravity),
            Group::frozen(),
            Group::prescribed_velocity(),
            Group::free([0.0; 3]),
            Group::free_along_z(self.gravity),
        ];
        let materials = 0..self.law.materials();
        let groups =
            materials.flat_map(|material| motions.map(|group| group.of_material(material)));
        let groups = groups.collect();
        let mut sim = Simulation::new(law, domain, self.dt, groups, &grains, Vec::new());
        for (k, body) in self.obstacles.iter().enumerate() {
            let body = body.build(self.gravity, &mut sim);
            let mut body = body.map_err(|(key, problem)| {
                Error::input(format!("{name}: `obstacles[{k}].{key}`"), problem)
            })?;
            domain.wrap(&mut body.point, &mut [0; 3]);
            body.material = of_bodies[k];
            sim.obstacles.push(body);
        }
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
/// first step of a run that failed.
pub fn refuse(name: &str, fault: KernelError, place_of: impl Fn(u32) -> String) -> Error {
    let problem = match fault {
        KernelError::Escaped { id } => format!("{} lies outside the box", place_of(id)),
        KernelError::PeriodTooShort { axis } => format!(
            "the periodic box is too short along {}: a grain could touch two images of one body; \
             make it longer than twice the largest contact distance",
            ["x", "y", "z"][axis as usize]
        ),
        KernelError::ObstacleTooFast { .. } => format!("{fault}; shorten dt"),
        KernelError::TooFast { id } => format!(
            "{} would move more than its own radius in one step; shorten dt",
            place_of(id)
        ),
        KernelError::NotFinite { id } => format!(
            "{} has a velocity, spin or force too large to compute with",
            place_of(id)
        ),
        KernelError::OverlapTooDeep { .. }
        | KernelError::ObstacleTooDeep { .. }
        | KernelError::Arithmetic { .. } => {
            return Error::run(name, 0, fault);
        }
        KernelError::PairListFull { .. }
        | KernelError::OuterListFull { .. }
        | KernelError::ObstacleContactsFull { .. } => {
            format!("{fault}{FULL}")
        }
        other => other.to_string(),
    };
    Error::input(name, problem)
}
