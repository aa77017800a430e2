//! Handles of obstacles.

use std::sync::Arc;

use bitgrain::body::{body_mass, orientation};
use bitgrain_kernel::{FreeMotion, Motion, Obstacle as Body, Shape};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{fixed, vector};
use crate::errors::{input, kernel};
use crate::simulated::Core;
use crate::views::{Shared, read, write};

type Vector<'py> = PyResult<Bound<'py, PyArray1<f64>>>;

/// A rigid body that pushes grains and moves as it is told, or freely; `World.sphere`, `cylinder`, `capsule`, `cuboid`,
/// `drum`, `mesh` and `plane` make them. Forces and torques on it are results.
#[pyclass(frozen, module = "bitgrain")]
pub struct Obstacle {
    shared: Shared,
    number: usize,
}

/// A body with the contact mass that its shape has by a density, if there is one.
///
/// # Errors
/// `InputError` for a density that is none, or of a shape without a volume.
pub fn weighed(mut body: Body<f64>, density: Option<f64>) -> PyResult<Body<f64>> {
    let Some(density) = density else {
        return Ok(body);
    };
    if !(density > 0.0 && density.is_finite()) {
        let problem = format!("is {density}; expected a positive number");
        return Err(input("density", problem));
    }
    let problem = "is given for a shape without a volume; leave it out";
    let mass = body_mass(&body.shape, density).ok_or_else(|| input("density", problem))?;
    body.inverse_mass = 1.0 / mass;
    Ok(body)
}

/// The orientation that four numbers name; upright without.
pub fn turned(numbers: Option<[f64; 4]>) -> PyResult<[f64; 4]> {
    let numbers = numbers.unwrap_or([1.0, 0.0, 0.0, 0.0]);
    orientation(numbers).map_err(|problem| input("orientation", problem))
}

/// Steps of a drive that takes so long.
pub fn steps_over(core: &Core, over: f64) -> PyResult<u64> {
    let dt = core.sim.dt;
    let steps = (over / dt).round();
    match (1.0..=1e15).contains(&steps) {
        true => Ok(steps as u64),
        false => Err(input(
            "over",
            format!(
                "is {over}; expected at least half a time step, {}",
                0.5 * dt
            ),
        )),
    }
}

impl Obstacle {
    /// The handle of an obstacle of a world.
    pub fn of(shared: &Shared, number: usize) -> Self {
        let shared = Arc::clone(shared);
        Self { shared, number }
    }

    /// The world that it is in.
    pub fn shared(&self) -> &Shared {
        &self.shared
    }

    fn body(&self) -> PyResult<Body<f64>> {
        Ok(read(&self.shared)?.sim.obstacles[self.number])
    }

    /// The body as it moves, in a world that has a state.
    fn moving(&self) -> PyResult<Body<f64>> {
        let core = read(&self.shared)?;
        Ok(core.state().map_err(kernel)?.obstacles[self.number])
    }

    fn free_motion(&self) -> PyResult<Option<FreeMotion<f64>>> {
        Ok(match self.body()?.motion {
            Motion::Free(free) => Some(free),
            Motion::Prescribed => None,
        })
    }

    fn push(&self, name: &str, change: impl FnOnce(&mut FreeMotion<f64>)) -> PyResult<()> {
        match &mut write(&self.shared)?.sim.obstacles[self.number].motion {
            Motion::Free(free) => {
                change(free);
                Ok(())
            }
            Motion::Prescribed => {
                let problem = "is of an obstacle that forces do not move; call its set_free first";
                Err(input(name, problem))
            }
        }
    }
}

#[pymethods]
impl Obstacle {
    /// Its number: errors name obstacles by it.
    #[getter]
    pub fn number(&self) -> usize {
        self.number
    }

    /// Its shape: "sphere", "cylinder", "plane", "finite_cylinder", "capsule", "box", "drum" or "mesh".
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
            Shape::Mesh { .. } => "mesh",
        })
    }

    /// Centre, a point of the axis or a point of the plane (length), in the box, as a read-only array of shape (3,).
    ///
    /// Set it to move the obstacle there at once: contacts that still touch keep their histories, and the others end.
    /// The velocity stays, but that of a drive, which ends.
    ///
    /// Raises
    /// ------
    /// BadObstacle
    ///     It does not fit the box there.
    /// InputError, Busy
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.moving()?.point)
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
        fixed(py, self.moving()?.velocity)
    }

    #[setter]
    fn set_velocity(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocity = vector(value, "velocity")?;
        write(&self.shared)?.move_obstacle(self.number, velocity);
        Ok(())
    }

    /// Angular velocity in the axes of the world (radians / time) as a read-only array of shape (3,); set it to turn
    /// the obstacle from the next step on.
    ///
    /// Raises
    /// ------
    /// BadObstacle
    ///     It is endless and would tilt.
    /// InputError, Busy
    #[getter]
    fn angular_velocity<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.moving()?.angular_velocity)
    }

    #[setter]
    fn set_angular_velocity(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let spin = vector(value, "angular_velocity")?;
        write(&self.shared)?
            .turn_obstacle(self.number, spin)
            .map_err(kernel)
    }

    /// Unit quaternion (w, x, y, z) from its own axes to those of the world, as a read-only array of shape (4,). Set it
    /// to turn the obstacle there at once; contacts are as of `point`.
    ///
    /// Raises
    /// ------
    /// BadObstacle
    ///     It does not fit the box so.
    /// InputError, Busy
    #[getter]
    fn orientation<'py>(&self, py: Python<'py>) -> Vector<'py> {
        let array = PyArray1::from_slice(py, &self.moving()?.orientation);
        array.call_method1("setflags", (false,))?;
        Ok(array)
    }

    #[setter]
    fn set_orientation(&self, value: [f64; 4]) -> PyResult<()> {
        let turned = turned(Some(value))?;
        let turn = |body: &mut Body<f64>| body.orientation = turned;
        write(&self.shared)?
            .change_obstacle(self.number, turn)
            .map_err(kernel)
    }

    /// Lets forces, and the world's gravity, move it from now on; it needs a density, or none of them would.
    ///
    /// Parameters
    /// ----------
    /// along : tuple of bool
    ///     Along which axes of the world it answers forces; along the others its velocity stays.
    /// turns : bool
    ///     Whether it answers torques.
    /// inertia : array_like, shape (3,), optional
    ///     Its moments of inertia about its own axes (mass length^2); those of its shape without.
    ///
    /// Raises
    /// ------
    /// BadObstacle
    ///     It cannot move so: it has no mass, or is endless.
    /// InputError, Busy
    #[pyo3(signature = (along=(true, true, true), turns=true, inertia=None))]
    fn set_free(
        &self,
        along: (bool, bool, bool),
        turns: bool,
        inertia: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let body = self.body()?;
        let inertia = match inertia {
            Some(inertia) => vector(inertia, "inertia")?,
            // Of a body that does not turn it says nothing.
            None if !turns => [1.0; 3],
            None => body.own_inertia().unwrap_or_default(),
        };
        let mut core = write(&self.shared)?;
        let free = FreeMotion {
            integrates: [along.0, along.1, along.2],
            spins: turns,
            ..FreeMotion::new(inertia, core.gravity)
        };
        let change = |body: &mut Body<f64>| body.motion = Motion::Free(free);
        core.change_obstacle(self.number, change).map_err(kernel)
    }

    /// Whether forces move it.
    #[getter]
    fn is_free(&self) -> PyResult<bool> {
        Ok(self.free_motion()?.is_some())
    }

    /// A force on a free obstacle besides its contacts and its weight, shape (3,); zero if it is not free. What is set
    /// acts from the next step on.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     It is not free.
    /// Busy
    #[getter]
    fn applied_force<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.free_motion()?.map_or([0.0; 3], |free| free.force))
    }

    #[setter]
    fn set_applied_force(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let force = vector(value, "applied_force")?;
        self.push("applied_force", |free| free.force = force)
    }

    /// A torque on it, likewise.
    #[getter]
    fn applied_torque<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.free_motion()?.map_or([0.0; 3], |free| free.torque))
    }

    #[setter]
    fn set_applied_torque(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let torque = vector(value, "applied_torque")?;
        self.push("applied_torque", |free| free.torque = torque)
    }

    /// Force of the grains on it after the last step, shape (3,).
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.moving()?.force)
    }

    /// Torque of that force about `point`, shape (3,).
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> Vector<'py> {
        fixed(py, self.moving()?.torque)
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

    /// Moves it at constant velocity, so that it is at a place after `over`, and rests from then on; turns it likewise,
    /// if an orientation is given.
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
    /// orientation : array_like, shape (4,), optional
    ///     Unit quaternion (w, x, y, z) to turn to, the shorter way round; without one it does not turn.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     `over` is not positive, or too short.
    /// BadObstacle
    ///     It is endless and would tilt.
    /// Busy
    #[pyo3(signature = (pos, over, orientation=None))]
    fn drive(
        &self,
        pos: &Bound<'_, PyAny>,
        over: f64,
        orientation: Option<[f64; 4]>,
    ) -> PyResult<()> {
        let point = vector(pos, "pos")?;
        let orientation = orientation.map(|one| turned(Some(one))).transpose()?;
        let mut core = write(&self.shared)?;
        let steps = steps_over(&core, over)?;
        core.drive(&[(self.number, point, orientation)], steps)
            .map_err(kernel)
    }

    /// Steps that a drive still takes; 0 if there is none.
    #[getter]
    fn steps_left(&self) -> PyResult<u64> {
        Ok(read(&self.shared)?.driven[self.number].left)
    }

    fn __repr__(&self) -> PyResult<String> {
        let place = match read(&self.shared)?.state() {
            Ok(sim) => {
                let [x, y, z] = sim.obstacles[self.number].point;
                format!("at ({x:?}, {y:?}, {z:?})")
            }
            Err(_) => "of a stopped world".to_owned(),
        };
        let (number, shape) = (self.number, self.shape()?);
        Ok(format!("<bitgrain.Obstacle {number}: {shape} {place}>"))
    }
}
