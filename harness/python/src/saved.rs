//! Worlds as bytes.

use std::sync::Arc;

use bitgrain::simulation::Simulation;
use parking_lot::RwLock;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::{PyBytes, PyType};

use crate::errors::{input, kernel};
use crate::settings::{processors, registers};
use crate::simulated::Core;
use crate::views::write;
use crate::world::World;

#[pymethods]
impl World {
    /// The world as bytes, from which `load` goes on with the same bits, on any machine; the function `bg_save` of C
    /// writes the same bytes of the same world. Starts the world, if it has not started.
    ///
    /// Box, time step, contact law, `lose` and `drain`, groups, obstacles, grains, contacts with their histories,
    /// forces and the number of steps are in it; threads, instructions, means and `departures` are not. Nor are ids
    /// of grains that left: after `load` ids go on behind the highest that is there.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An obstacle is on its way to a place (`Obstacle.drive`), which the bytes cannot hold.
    /// KernelError
    ///     The world cannot be started, or an error of the motion has stopped it (`NotStarted`).
    /// Busy
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut core = write(&self.shared)?;
        if let Some(number) = core.driven.iter().position(|one| one.left > 0) {
            let problem = format!(
                "obstacle {number} is driven for {} steps more, and the bytes hold the world as it is now, not what \
                 stops it later: save before or after that, or set its velocity",
                core.driven[number].left
            );
            return Err(input("save", problem));
        }
        let bytes = py.detach(|| {
            core.start()?;
            core.sim.save()
        });
        Ok(PyBytes::new(py, &bytes.map_err(kernel)?))
    }

    /// The world that `save`, or `bg_save` of C, wrote.
    ///
    /// `gravity` is that of the first group of free grains. "free", "frozen", "carried" and "lid" are the first groups
    /// that move so under it; a world of C that lacks one gets it when it is named.
    ///
    /// Parameters
    /// ----------
    /// data : bytes
    ///     What was saved.
    /// threads, instructions, strict
    ///     As of `World`.
    ///
    /// Raises
    /// ------
    /// BadSave
    ///     The bytes are not as they were written.
    /// OtherVersion
    ///     Another version, with other bits, wrote them.
    /// InputError
    #[classmethod]
    #[pyo3(signature = (data, *, threads=None, instructions=None, strict=false))]
    fn load(
        _cls: &Bound<'_, PyType>,
        py: Python<'_>,
        data: PyBackedBytes,
        threads: Option<usize>,
        instructions: Option<&str>,
        strict: bool,
    ) -> PyResult<Self> {
        let threads = processors(threads)?;
        let registers = registers(instructions)?;
        let mut sim = py.detach(|| Simulation::load(&data)).map_err(kernel)?;
        sim.stepping.registers = registers;
        let mut core = Core::loaded(sim, threads);
        core.watch.strict = strict;
        let gravity = core.gravity;
        Ok(Self {
            shared: Arc::new(RwLock::new(core)),
            gravity,
        })
    }
}
