//! Several obstacles at once, for a host that moves many of them often.

use std::sync::Arc;

use bitgrain_kernel::Obstacle as Body;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::rows;
use crate::drives::Drive;
use crate::errors::{input, kernel};
use crate::obstacles::{Obstacle, steps_over, turned};
use crate::views::{Shared, read, write};
use crate::world::World;

type Rows<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

/// Some obstacles of a world, in an order; `World.select` makes it. Arrays have one row an obstacle; what stands in
/// them is as of an `Obstacle`.
#[pyclass(frozen, module = "bitgrain")]
pub struct Obstacles {
    shared: Shared,
    numbers: Vec<usize>,
}

/// Vectors as an array of shape (n, 3).
fn array<'py>(py: Python<'py>, vectors: Vec<[f64; 3]>) -> Rows<'py> {
    PyArray1::from_vec(py, vectors.as_flattened().to_vec()).reshape([vectors.len(), 3])
}

impl Obstacles {
    fn bodies<'py>(&self, py: Python<'py>, of: impl Fn(&Body<f64>) -> [f64; 3]) -> Rows<'py> {
        let core = read(&self.shared)?;
        let sim = core.state().map_err(kernel)?;
        let vectors = self.numbers.iter().map(|k| of(&sim.obstacles[*k]));
        array(py, vectors.collect())
    }

    fn means<'py>(&self, py: Python<'py>, which: usize) -> Rows<'py> {
        let core = read(&self.shared)?;
        let vectors = self.numbers.iter().map(|k| core.means(*k)[which]);
        array(py, vectors.collect())
    }
}

#[pymethods]
impl Obstacles {
    /// Their numbers.
    #[getter]
    fn numbers(&self) -> Vec<usize> {
        self.numbers.clone()
    }

    /// Centres (length), in the box, shape (n, 3).
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Rows<'py> {
        self.bodies(py, |body| body.point)
    }

    /// Forces of the grains on them after the last step, shape (n, 3).
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> Rows<'py> {
        self.bodies(py, |body| body.force)
    }

    /// Torques of those forces about `points`, shape (n, 3).
    #[getter]
    fn torques<'py>(&self, py: Python<'py>) -> Rows<'py> {
        self.bodies(py, |body| body.torque)
    }

    /// Means of `forces` over the steps of the last `World.step`, shape (n, 3); NaN before the first.
    #[getter]
    fn mean_forces<'py>(&self, py: Python<'py>) -> Rows<'py> {
        self.means(py, 0)
    }

    /// Means of `torques` likewise, shape (n, 3).
    #[getter]
    fn mean_torques<'py>(&self, py: Python<'py>) -> Rows<'py> {
        self.means(py, 1)
    }

    /// Moves and turns all of them at constant velocities: `Obstacle.drive` of each.
    ///
    /// Parameters
    /// ----------
    /// pos : array_like, shape (n, 3)
    ///     Where to (length).
    /// over : float
    ///     How long it takes (time); at least half a time step.
    /// orientations : array_like, shape (n, 4)
    ///     Unit quaternions (w, x, y, z) to turn to.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     `over` is not positive, or too short. None of them moves.
    /// BadObstacle
    ///     One is endless and would tilt. None of them moves.
    /// Busy
    fn drive(
        &self,
        pos: &Bound<'_, PyAny>,
        over: f64,
        orientations: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let count = Some(self.numbers.len());
        let points = rows(pos, "pos", count)?;
        let orientations = rows::<4>(orientations, "orientations", count)?;
        let orientations = orientations.into_iter().map(|one| turned(Some(one)));
        let orientations = orientations.collect::<PyResult<Vec<_>>>()?;
        let mut core = write(&self.shared)?;
        let steps = steps_over(&core, over)?;
        let rows = self.numbers.iter().zip(points).zip(orientations);
        let drives: Vec<Drive> = rows
            .map(|((number, point), orientation)| (*number, point, Some(orientation)))
            .collect();
        core.drive(&drives, steps).map_err(kernel)
    }
}

#[pymethods]
impl World {
    /// Some of its obstacles together, in this order.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     One is of another world.
    fn select(&self, obstacles: Vec<PyRef<'_, Obstacle>>) -> PyResult<Obstacles> {
        for (row, obstacle) in obstacles.iter().enumerate() {
            if !Arc::ptr_eq(obstacle.shared(), &self.shared) {
                let problem = format!("holds one of another world in row {row}");
                return Err(input("obstacles", problem));
            }
        }
        Ok(Obstacles {
            shared: Arc::clone(&self.shared),
            numbers: obstacles.iter().map(|one| one.number()).collect(),
        })
    }
}
