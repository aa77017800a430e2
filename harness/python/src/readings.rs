//! What a world shows of its state: views of its grains, digests, obstacles, time.

use bitgrain::simulation::hex;
use bitgrain_kernel::{Domain, PARTS};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::fixed;
use crate::errors::kernel;
use crate::grains::Departed;
use crate::obstacles::Obstacle;
use crate::views::{Shown, Window, read, write};
use crate::world::World;

#[pymethods]
impl World {
    /// Digest of the whole state, 64 hexadecimal digits: the same on every machine, and that of the command for the
    /// same state.
    ///
    /// Raises
    /// ------
    /// Arithmetic
    ///     Something changed the processor's modes, as a library built with fast-math does.
    /// NotStarted
    ///     An error of the motion has stopped the world: it has no state.
    /// Busy
    #[getter]
    fn digest(&self) -> PyResult<String> {
        let digest = write(&self.shared)?.sim.digest().map_err(kernel)?;
        Ok(hex(&digest.whole))
    }

    /// Digests of the parts of the state by name: positions, velocities, spins, histories, forces, obstacles.
    #[getter]
    fn digests<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let digest = write(&self.shared)?.sim.digest().map_err(kernel)?;
        let parts = PyDict::new(py);
        for (name, part) in PARTS.iter().zip(digest.parts()) {
            parts.set_item(name, hex(part))?;
        }
        Ok(parts)
    }

    /// Positions of the centres (length), in the box, as a `View` of shape (n, 3).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Positions)
    }

    /// Radii (length) as a `View` of shape (n,).
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Radii)
    }

    /// Velocities (length / time) as a `View` of shape (n, 3).
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Velocities)
    }

    /// Masses as a `View` of shape (n,).
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Masses)
    }

    /// Spins (radians / time) as a `View` of shape (n, 3).
    #[getter]
    fn spins<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Spins)
    }

    /// Forces of the last step, of contacts and of `force`, without weight, as a `View` of shape (n, 3).
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Forces)
    }

    /// Torques of the last step about the centres, as a `View` of shape (n, 3).
    #[getter]
    fn torques<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Torques)
    }

    /// How often each grain crossed each periodic axis, as a `View` of shape (n, 3).
    #[getter]
    fn images<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Images)
    }

    /// Ids, ascending, as a `View` of shape (n,).
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Ids)
    }

    /// Numbers of the groups as a `View` of shape (n,): 0 free, 1 frozen, 2 carried, 3 lid, then those of `group`.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.view(py, Shown::Groups)
    }

    /// The grains that were taken out in the steps of the last call of `step`, in the order in which they left.
    #[getter]
    fn departures(&self) -> PyResult<Vec<Departed>> {
        Ok(read(&self.shared)?
            .lost
            .iter()
            .map(Departed::from)
            .collect())
    }

    /// Obstacles by number.
    #[getter]
    fn obstacles(&self) -> PyResult<Vec<Obstacle>> {
        let count = read(&self.shared)?.driven.len();
        Ok((0..count)
            .map(|number| Obstacle::of(&self.shared, number))
            .collect())
    }

    /// Lower and upper corner of the box (length), as two arrays of shape (3,); None of open space.
    #[getter]
    fn r#box<'py>(&self, py: Python<'py>) -> PyResult<Option<[Bound<'py, PyArray1<f64>>; 2]>> {
        let domain = read(&self.shared)?.sim.domain;
        if domain == Domain::open() {
            return Ok(None);
        }
        Ok(Some([fixed(py, domain.lo())?, fixed(py, domain.hi())?]))
    }

    /// Which axes are periodic.
    #[getter]
    fn periodic(&self) -> PyResult<(bool, bool, bool)> {
        Ok(read(&self.shared)?.sim.domain.periodic().into())
    }

    /// Acceleration of free grains (length / time^2), shape (3,).
    #[getter]
    fn gravity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        fixed(py, self.gravity)
    }

    /// Time step.
    #[getter]
    fn dt(&self) -> PyResult<f64> {
        Ok(read(&self.shared)?.sim.dt)
    }

    /// Steps done.
    #[getter]
    fn step_count(&self) -> PyResult<u64> {
        Ok(read(&self.shared)?.sim.step_count())
    }

    /// Time: steps done times the time step.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        let core = read(&self.shared)?;
        Ok(core.sim.step_count() as f64 * core.sim.dt)
    }

    /// Kinetic energy of all grains, of translation and rotation (mass length^2 / time^2).
    #[getter]
    fn kinetic_energy(&self) -> PyResult<f64> {
        let core = read(&self.shared)?;
        Ok(core.state().map_err(kernel)?.kinetic_energy())
    }
}

impl World {
    fn view<'py>(&self, py: Python<'py>, shown: Shown) -> PyResult<Bound<'py, PyAny>> {
        let window = Window::of(&self.shared, shown)?;
        py.import("bitgrain.view")?
            .getattr("View")?
            .call1((window,))
    }
}
