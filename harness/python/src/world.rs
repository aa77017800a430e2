//! The world of grains.

use std::sync::Arc;

use bitgrain::simulation::Simulation;
use bitgrain_kernel::{Drain, LossPolicy, Obstacle as Body};
use numpy::PyArray1;
use parking_lot::RwLock;
use pyo3::prelude::*;

use crate::arrays::vector;
use crate::edits::Edit;
use crate::errors::{input, kernel};
use crate::geometry::{corners, direction, domain, or_zero};
use crate::grains::{
    Given, Group, added_group, group_number, ids_of, kind_number, kind_of,
    material as material_number,
};
use crate::laws::law as law_of;
use crate::obstacles::{Obstacle, turned, weighed};
use crate::settings::{processors, registers};
use crate::simulated::Core;
use crate::views::{Shared, read, write};

/// A world of grains and obstacles that is stepped with the same bits on any machine and any number of threads.
///
/// Parameters
/// ----------
/// box : array_like or None
///     Lengths of the box, whose lower corner is the origin, shape (3,); or its two corners, shape (2, 3). None is open
///     space. Grains must stay inside on axes that are not periodic, so give the box room above a bed.
/// gravity : array_like, shape (3,)
///     Acceleration of free grains (length / time^2).
/// dt : float
///     Time step, positive. A fifth of the Rayleigh time and a tenth of the duration of a collision are short enough:
///     see `strict`.
/// law : HertzHistory or HertzTsuji
///     Contact law.
/// periodic : tuple of three bool
///     Which axes are periodic.
/// threads : int or None
///     Threads to step on, 1 to 1024; None is one for each processor. Worlds below 1,000 grains step on one. No bit
///     depends on it.
/// instructions : str or None
///     "plain", "avx2" or "avx512"; None is the widest set that this machine has. No bit depends on it.
///
/// lose : bool
///     Whether a grain that leaves the box, or overlaps another body by more than a quarter of the smaller diameter, is
///     taken out after the step in which it does; of two grains the one with the higher id. Else it stops the world.
/// drain : tuple of two array_like of shape (3,), optional
///     A point (length) and a normal of a plane: a grain whose centre comes behind it, on the side that the normal
///     points away from, is taken out.
/// strict : bool
///     Whether a time step is refused (`LongTimeStep`) that is above a fifth of the shortest Rayleigh time of a grain
///     or a free body, or a tenth of the shortest collision at the largest difference of velocities. Else `step` warns
///     of it, once. A world is looked at before its first step, after changes, and every 1,000 steps.
///
/// Units are free, as long as they fit together. Numbers are copied from arrays that are given.
///
/// Raises
/// ------
/// InputError, BadDomain
///
/// Examples
/// --------
/// >>> import bitgrain
/// >>> law = bitgrain.HertzTsuji(young=2e4, poisson=0.3, restitution=0.6, mu=0.5)
/// >>> w = bitgrain.World(box=(6, 6, 40), gravity=(0, 0, -1), dt=5e-4, law=law, periodic=(True, True, False))
/// >>> floor = w.plane(point=(0, 0, 0), normal=(0, 0, 1))
/// >>> w.add([[3, 3, 0.5], [3, 3, 1.5]], radii=0.5, density=1.0)
/// array([1, 2], dtype=uint32)
/// >>> w.step(40_000)
/// >>> round(float(floor.force[2]), 3)
/// -1.047
#[pyclass(frozen, weakref, module = "bitgrain")]
pub struct World {
    /// Its state.
    pub shared: Shared,
    /// Acceleration of free grains.
    pub gravity: [f64; 3],
}

#[pymethods]
impl World {
    #[new]
    #[pyo3(signature = (r#box, gravity, dt, law, *, periodic=(false, false, false), threads=None, instructions=None,
        lose=false, drain=None, strict=false))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        r#box: Option<&Bound<'_, PyAny>>,
        gravity: &Bound<'_, PyAny>,
        dt: f64,
        law: &Bound<'_, PyAny>,
        periodic: (bool, bool, bool),
        threads: Option<usize>,
        instructions: Option<&str>,
        lose: bool,
        drain: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
        strict: bool,
    ) -> PyResult<Self> {
        let gravity = vector(gravity, "gravity")?;
        let domain = domain(r#box, periodic.into())?;
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(input("dt", format!("is {dt}; expected a positive number")));
        }
        let threads = processors(threads)?;
        let (law, materials) = law_of(law)?;
        let mut sim = Simulation::new(law, domain, dt, Vec::new(), &[], Vec::new());
        sim.stepping.registers = registers(instructions)?;
        let drain = drain.map(|(point, normal)| {
            let (point, normal) = (vector(&point, "drain")?, direction(&normal, "drain")?);
            PyResult::Ok(Drain { point, normal })
        });
        sim.policy = LossPolicy {
            takes_out: lose,
            drain: drain.transpose()?,
        };
        let mut core = Core::new(sim, gravity, threads, materials);
        core.watch.strict = strict;
        let shared = Arc::new(RwLock::new(core));
        Ok(Self { shared, gravity })
    }

    /// Adds grains and returns their ids, shape (n,).
    ///
    /// A started world goes on with its contacts; the new grains must touch nothing deeper than a quarter of the
    /// smaller diameter.
    ///
    /// Parameters
    /// ----------
    /// positions : array_like, shape (n, 3)
    ///     Centres (length), inside the box; on a periodic axis within one period of it.
    /// radii : array_like, shape (n,), or float
    ///     Radii (length), positive.
    /// density : array_like, shape (n,), or float
    ///     Mass density (mass / length^3), positive.
    /// velocities : array_like, shape (n, 3), optional
    ///     Velocities (length / time); zero by default.
    /// spins : array_like, shape (n, 3), optional
    ///     Spins (radians / time); zero by default.
    /// group : Group or str, optional
    ///     How they move: "free" (the default), "frozen", "carried" (at the velocity that they have), "lid" (so along x
    ///     and y, free along z), or what `group` returned.
    /// ids : array_like of int, shape (n,), optional
    ///     Ids, ascending, above all that were used in this world; by default the next ones, from 1 on.
    ///
    /// Raises
    /// ------
    /// InputError, OverlapTooDeep, ObstacleTooDeep, Busy
    #[pyo3(signature = (positions, radii, density, velocities=None, spins=None, group=None, ids=None))]
    #[allow(clippy::too_many_arguments)]
    fn add<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        radii: &Bound<'py, PyAny>,
        density: &Bound<'py, PyAny>,
        velocities: Option<&Bound<'py, PyAny>>,
        spins: Option<&Bound<'py, PyAny>>,
        group: Option<&Bound<'py, PyAny>>,
        ids: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let given = Given {
            positions,
            radii,
            density,
            velocities,
            spins,
            ids,
        };
        let arrays = given.arrays()?;
        let group = group_number(group, &self.shared)?;
        let mut core = write(&self.shared)?;
        let grains = arrays.grains(&core, group)?;
        core.put(&grains).map_err(kernel)?;
        Ok(ids_of(py, &grains))
    }

    /// Adds a sphere that moves as it is told, or freely: see `Obstacle.set_free`.
    ///
    /// Parameters
    /// ----------
    /// radius : float
    ///     Radius (length), positive.
    /// point : array_like, shape (3,)
    ///     Centre (length), inside the box.
    /// velocity : array_like, shape (3,)
    ///     Velocity (length / time).
    /// density : float, optional
    ///     Mass density with which its mass enters its contacts; without one it is infinitely heavy.
    /// material : str, optional
    ///     Name of its material, if the law has several; likewise of all other obstacles.
    ///
    /// Raises
    /// ------
    /// BadObstacle, InputError, Busy
    #[pyo3(signature = (radius, point=None, velocity=None, density=None, material=None))]
    fn sphere(
        &self,
        radius: f64,
        point: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        density: Option<f64>,
        material: Option<&str>,
    ) -> PyResult<Obstacle> {
        let body = Body::sphere(or_zero(point, "point")?, radius);
        self.obstacle(body, velocity, density, material)
    }

    /// Adds a round bar, endless or with flat ends.
    ///
    /// Parameters
    /// ----------
    /// radius : float
    ///     Radius (length), positive.
    /// axis : array_like, shape (3,)
    ///     Direction of the bar, of any length but zero; an endless one along x, y or z if the box is periodic.
    /// point : array_like, shape (3,)
    ///     Its centre, or a point of its axis (length), inside the box.
    /// velocity : array_like, shape (3,)
    ///     Velocity (length / time).
    /// length : float, optional
    ///     Its length; endless without.
    /// density : float, optional
    ///     As of a sphere; of a bar with a length.
    /// orientation : array_like, shape (4,), optional
    ///     Unit quaternion (w, x, y, z) by which it is turned from there; likewise of a capsule, a box and a mesh.
    ///
    /// Raises
    /// ------
    /// BadObstacle, InputError, Busy
    #[pyo3(signature = (radius, axis, point=None, velocity=None, length=None, density=None, material=None,
        orientation=None))]
    #[allow(clippy::too_many_arguments)]
    fn cylinder(
        &self,
        radius: f64,
        axis: &Bound<'_, PyAny>,
        point: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        length: Option<f64>,
        density: Option<f64>,
        material: Option<&str>,
        orientation: Option<[f64; 4]>,
    ) -> PyResult<Obstacle> {
        let (axis, point) = (direction(axis, "axis")?, or_zero(point, "point")?);
        let mut body = match length {
            Some(length) => Body::finite_cylinder(point, axis, radius, 0.5 * length),
            None => Body::cylinder(point, axis, radius),
        };
        body.orientation = turned(orientation)?;
        self.obstacle(body, velocity, density, material)
    }

    /// Adds a round bar with half balls as ends, by their radius and half the distance between their centres (length);
    /// the rest as of a cylinder.
    ///
    /// Raises
    /// ------
    /// BadObstacle, InputError, Busy
    #[pyo3(signature = (radius, axis, half_length, point=None, velocity=None, density=None, material=None,
        orientation=None))]
    #[allow(clippy::too_many_arguments)]
    fn capsule(
        &self,
        radius: f64,
        axis: &Bound<'_, PyAny>,
        half_length: f64,
        point: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        density: Option<f64>,
        material: Option<&str>,
        orientation: Option<[f64; 4]>,
    ) -> PyResult<Obstacle> {
        let (axis, point) = (direction(axis, "axis")?, or_zero(point, "point")?);
        let mut body = Body::capsule(point, axis, radius, half_length);
        body.orientation = turned(orientation)?;
        self.obstacle(body, velocity, density, material)
    }

    /// Adds a box by the halves of its edges (length), shape (3,); the rest as of a sphere.
    ///
    /// Raises
    /// ------
    /// BadObstacle, InputError, Busy
    #[pyo3(signature = (half, point=None, velocity=None, density=None, material=None, orientation=None))]
    #[allow(clippy::too_many_arguments)]
    fn cuboid(
        &self,
        half: &Bound<'_, PyAny>,
        point: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        density: Option<f64>,
        material: Option<&str>,
        orientation: Option<[f64; 4]>,
    ) -> PyResult<Obstacle> {
        let mut body = Body::cuboid(or_zero(point, "point")?, vector(half, "half")?);
        body.orientation = turned(orientation)?;
        self.obstacle(body, velocity, density, material)
    }

    /// Adds the inside of a cylinder with ends, in which grains live, by its inner radius and length; the rest as of a
    /// cylinder. Turn it by its `angular_velocity`.
    ///
    /// Raises
    /// ------
    /// BadObstacle, InputError, Busy
    #[pyo3(signature = (radius, axis, length, point=None, material=None))]
    fn drum(
        &self,
        radius: f64,
        axis: &Bound<'_, PyAny>,
        length: f64,
        point: Option<&Bound<'_, PyAny>>,
        material: Option<&str>,
    ) -> PyResult<Obstacle> {
        let (axis, point) = (direction(axis, "axis")?, or_zero(point, "point")?);
        let body = Body::drum(point, axis, radius, 0.5 * length);
        self.obstacle(body, None, None, material)
    }

    /// Adds a mesh of triangles that moves as it is told; grains touch both sides.
    ///
    /// Parameters
    /// ----------
    /// triangles : array_like, shape (n, 3, 3), or str
    ///     Corners (length) from the point of the mesh, in any order; or the path of an STL file of them.
    /// point : array_like, shape (3,)
    ///     Where that point is (length).
    /// velocity : array_like, shape (3,)
    ///     Velocity (length / time).
    ///
    /// Raises
    /// ------
    /// BadObstacle, InputError, Busy
    #[pyo3(signature = (triangles, point=None, velocity=None, material=None, orientation=None))]
    fn mesh(
        &self,
        triangles: &Bound<'_, PyAny>,
        point: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        material: Option<&str>,
        orientation: Option<[f64; 4]>,
    ) -> PyResult<Obstacle> {
        let corners = corners(triangles)?;
        let (point, velocity) = (or_zero(point, "point")?, or_zero(velocity, "velocity")?);
        let material = material_number(material, &self.shared)?;
        let orientation = turned(orientation)?;
        let mut core = write(&self.shared)?;
        let number = core.add_mesh((point, orientation), velocity, material, &corners);
        let number = number.map_err(kernel)?;
        Ok(Obstacle::of(&self.shared, number))
    }

    /// Adds a flat wall that moves as it is told.
    ///
    /// Parameters
    /// ----------
    /// normal : array_like, shape (3,)
    ///     Direction to the grains, of any length but zero; without a part along a periodic axis.
    /// point : array_like, shape (3,)
    ///     A point of the wall (length).
    /// velocity : array_like, shape (3,)
    ///     Velocity (length / time).
    ///
    /// Raises
    /// ------
    /// BadObstacle, InputError, Busy
    #[pyo3(signature = (normal, point=None, velocity=None, material=None))]
    fn plane(
        &self,
        normal: &Bound<'_, PyAny>,
        point: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        material: Option<&str>,
    ) -> PyResult<Obstacle> {
        let normal = direction(normal, "normal")?;
        let body = Body::plane(or_zero(point, "point")?, normal);
        self.obstacle(body, velocity, None, material)
    }

    /// Makes a group of grains with a gravity or a material of its own, for `group=`.
    ///
    /// Parameters
    /// ----------
    /// kind : str
    ///     "free", "frozen", "carried" or "lid".
    /// gravity : array_like, shape (3,), optional
    ///     Acceleration of its grains (length / time^2), if they are free along an axis; the world's by default.
    /// material : str, optional
    ///     Name of their material, if the law has several.
    ///
    /// Raises
    /// ------
    /// InputError, Busy
    #[pyo3(signature = (kind, gravity=None, material=None))]
    fn group(
        &self,
        kind: &str,
        gravity: Option<&Bound<'_, PyAny>>,
        material: Option<&str>,
    ) -> PyResult<Group> {
        let kind = kind_of(kind)?;
        let shared = Arc::clone(&self.shared);
        let number = match gravity {
            None => kind_number(kind, material, &self.shared)?,
            Some(gravity) => {
                let material = material_number(material, &self.shared)?;
                let group = kind.group(vector(gravity, "gravity")?, material);
                added_group(group, &mut *write(&self.shared)?)?
            }
        };
        Ok(Group { shared, number })
    }

    /// Edits grains within `with world.edit() as edit:`; starts the world, if it has not started. See `Edit`.
    fn edit(&self) -> Edit {
        Edit::of(&self.shared)
    }

    /// How many grains there are.
    fn __len__(&self) -> PyResult<usize> {
        Ok(read(&self.shared)?.sim.count())
    }

    /// A world is true, also without grains.
    fn __bool__(&self) -> bool {
        true
    }

    fn __repr__(&self) -> PyResult<String> {
        let core = read(&self.shared)?;
        let (grains, obstacles) = (core.sim.count(), core.driven.len());
        let steps = core.sim.step_count();
        Ok(format!(
            "<bitgrain.World: {grains} grains, {obstacles} obstacles, {steps} steps>"
        ))
    }
}

impl World {
    fn obstacle(
        &self,
        body: Body<f64>,
        velocity: Option<&Bound<'_, PyAny>>,
        density: Option<f64>,
        material: Option<&str>,
    ) -> PyResult<Obstacle> {
        let mut body = weighed(body, density)?;
        body.velocity = or_zero(velocity, "velocity")?;
        body.material = material_number(material, &self.shared)?;
        let number = write(&self.shared)?.add_obstacle(body).map_err(kernel)?;
        Ok(Obstacle::of(&self.shared, number))
    }
}
