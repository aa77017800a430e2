//! How fast and how stiff contacts are: what a host needs to choose a time step, here or of a simulator beside this
//! one.

use bitgrain::law::{AnyLaw, HertzHistoryParameters, LawSpec};
use bitgrain::simulation::Simulation;
use bitgrain_kernel::Partner;
use pyo3::prelude::*;

use crate::errors::{input, kernel};
use crate::laws::law as law_of;
use crate::obstacles::Obstacle;
use crate::views::{read, write};
use crate::world::World;

/// Hertz' law with the stiffest springs that a law has between any two materials; it has no dampers.
fn stiffest(law: &AnyLaw) -> LawSpec {
    let materials = 0..law.materials();
    let pairs = materials
        .clone()
        .flat_map(|a| materials.clone().map(move |b| [a, b]));
    let kn = pairs.map(|pair| law.springs(pair).kn);
    let kn = kn.fold(0.0, |most, kn| if kn > most { kn } else { most });
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn,
        kt: 0.0,
        gamma_n: 0.0,
        gamma_t: 0.0,
        mu: 0.0,
        rolling: None,
    })
}

fn positive(name: &str, value: f64) -> PyResult<f64> {
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(input(
            name,
            format!("is {value}; expected a positive number"),
        )),
    }
}

/// Radius and density of a grain, by its place.
fn size(sim: &Simulation, i: usize) -> (f64, f64) {
    let (radius, mass) = (sim.position[i][3], sim.velocity[i][3]);
    let volume = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
    (radius, mass / volume)
}

/// Duration of a collision of two equal grains that meet head on, without damping: a time step should be a tenth of it
/// at most. It is proportional to the radius and falls with the fifth root of the speed.
///
/// Parameters
/// ----------
/// law : HertzHistory, HertzTsuji or dict
///     Contact law, as of `World`; of several materials the stiffest pair counts.
/// speed : float
///     Relative speed (length / time), positive.
/// radius : float
///     Radius of each (length), positive.
/// density : float
///     Mass density of each (mass / length^3), positive.
///
/// Raises
/// ------
/// InputError
#[pyfunction]
pub fn contact_duration(
    law: &Bound<'_, PyAny>,
    speed: f64,
    radius: f64,
    density: f64,
) -> PyResult<f64> {
    let speed = positive("speed", speed)?;
    let (radius, density) = (positive("radius", radius)?, positive("density", density)?);
    let (law, _) = law_of(law)?;
    Ok(stiffest(&law).contact_duration(speed, radius, density))
}

#[pymethods]
impl World {
    /// Duration of the shortest collision of two equal grains of this world that meet at `speed` (length / time,
    /// positive), without damping; infinite in a world without grains. See the function `contact_duration`.
    ///
    /// Raises
    /// ------
    /// InputError, Busy
    fn contact_duration(&self, speed: f64) -> PyResult<f64> {
        let speed = positive("speed", speed)?;
        let core = read(&self.shared)?;
        let sizes = (0..core.sim.count()).map(|i| size(&core.sim, i));
        Ok(stiffest(&core.sim.law).shortest_contact(speed, sizes))
    }
}

#[pymethods]
impl Obstacle {
    /// Stiffness of its contacts together (force / length): the sum over all grains that touch it of
    /// `1.5 |F_n| / overlap`, which is how fast Hertz' force grows with the overlap. No direction is stiffer.
    ///
    /// It is that of the next step, which is done with a copy of the world: for a look now and then, not for every
    /// step. Starts the world, if it has not started.
    ///
    /// Raises
    /// ------
    /// KernelError
    ///     What stopped that step.
    /// Busy
    fn contact_stiffness(&self, py: Python<'_>) -> PyResult<f64> {
        let number = self.number() as u32;
        let mut core = write(self.shared())?;
        let summed = py.detach(|| {
            core.start()?;
            let mut stiffness = 0.0;
            core.sim.clone().step_watched(|contact| {
                if contact.partner == Partner::Obstacle(number) {
                    stiffness += 1.5 * contact.normal_force.abs() / contact.overlap;
                }
            })?;
            Ok(stiffness)
        });
        summed.map_err(kernel)
    }
}
