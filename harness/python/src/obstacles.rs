//! Handles of obstacles.

use std::sync::Arc;

use bitgrain_kernel::{Obstacle as Body, Shape};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{fixed, vector};
use crate::errors::{input, kernel};
use crate::views::{Shared, read, write};

type Vector<'py> = PyResult<Bound<'py, PyArray1<f64>>>;

/// A sphere, a cylinder or a plane that pushes grains and moves as it is told; `World.sphere`, `World.cylinder` and
/// `World.plane` make them. Forces and torques on it are results.
#[pyclass(frozen, module = "bitgrain")]
pub struct Obstacle {
    shared: Shared,
    number: usize,
}

impl Obstacle {
    /// The handle of an obstacle of a world.
    pub fn of(shared: &Shared, number: usize) -> Self {
        let shared = Arc::clone(shared);
        Self { shared, number }
    }

    fn body(&self) -> PyResult<Body<f64>> {
        Ok(read(&self.shared)?.sim.obstacles[self.number])
    }
}

#[pymethods]
impl Obstacle {
    /// Its number: errors name obstacles by it.
    #[getter]
    fn number(&self) -> usize {
        self.number
    }

    /// Its shape: "sphere", "cylinder" or "plane".
    #[getter]
    fn shape(&self) -> PyResult<&'static str> {
        Ok(match self.body()?.shape {
            Shape::Sphere { .. } => "sphere",
            Shape::Cylinder { .. } => "cylinder",
            Shape::Plane { .. } => "plane",
            Shape::FiniteCylinder { .. } => "finite_cylinder",
            Shape::Capsule { .. } => "capsule",
            Shape::Box { .. } => "box",
            Shape::Drum { .. } => "drum",
        })
    }

    /// Centre, a point of the axis or a point of the plane (length), in the box, as a read-only array of shape (3,).
    ///
    /// Set it to move the obstacle there at once; its contacts keep their histories. The velocity stays, but that of a
    /// drive, which ends.
    ///
    /// Raises
    /// ------
    /// BadObstacle
    ///     It does not fit the box there.
    /// InputError, Busy
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.body()?.point)
    }

    #[setter]
    fn set_point(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let point = vector(value, "point")?;
        write(&self.shared)?
            .place_obstacle(self.number, point)
            .map_err(kernel)
    }

    /// Velocity (length / time) as a read-only array of shape (3,); set it to move the obstacle from the next step on.
    /// Setting it ends a drive.
    ///
    /// Raises
    /// ------
    /// InputError, Busy
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.body()?.velocity)
    }

    #[setter]
    fn set_velocity(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocity = vector(value, "velocity")?;
        write(&self.shared)?.move_obstacle(self.number, velocity);
        Ok(())
    }

    /// Force of the grains on it after the last step, shape (3,).
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.body()?.force)
    }

    /// Torque of that force about `point`, shape (3,).
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.body()?.torque)
    }

    /// Mean of `force` over the steps of the last `World.step`, shape (3,); NaN before the first.
    #[getter]
    fn mean_force<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, read(&self.shared)?.means(self.number)[0])
    }

    /// Mean of `torque` over the steps of the last `World.step`, shape (3,); NaN before the first.
    #[getter]
    fn mean_torque<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, read(&self.shared)?.means(self.number)[1])
    }

    /// Moves it at constant velocity, so that it is at a place after `over`, and rests from then on.
    ///
    /// The obstacle moves during the next `round(over / dt)` steps, however they are shared among calls of
    /// `World.step`. Where it arrives is `pos` to the rounding of that many additions. On a periodic axis it goes by
    /// `pos - point`, which may be more than a period.
    ///
    /// Parameters
    /// ----------
    /// pos : array_like, shape (3,)
    ///     Where to (length).
    /// over : float
    ///     How long it takes (time); at least half a time step.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     `over` is not positive, or too short.
    /// Busy
    #[pyo3(signature = (pos, over))]
    fn drive(&self, pos: &Bound<'_, PyAny>, over: f64) -> PyResult<()> {
        let point = vector(pos, "pos")?;
        let mut core = write(&self.shared)?;
        let steps = (over / core.sim.dt).round();
        if !(1.0..=1e15).contains(&steps) {
            let dt = core.sim.dt;
            let problem = format!(
                "is {over}; expected at least half a time step, {}",
                0.5 * dt
            );
            return Err(input("over", problem));
        }
        core.drive(self.number, point, steps as u64);
        Ok(())
    }

    /// Steps that a drive still takes; 0 if there is none.
    #[getter]
    fn steps_left(&self) -> PyResult<u64> {
        Ok(read(&self.shared)?.driven[self.number].left)
    }

    fn __repr__(&self) -> PyResult<String> {
        let body = self.body()?;
        let [x, y, z] = body.point;
        Ok(format!(
            "<bitgrain.Obstacle {}: {} at ({x:?}, {y:?}, {z:?})>",
            self.number,
            self.shape()?
        ))
    }
}
