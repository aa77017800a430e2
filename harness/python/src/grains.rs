//! Grains from arrays, and their groups.

use bitgrain::law::material_number;
use bitgrain::simulation::Grain;
use bitgrain_kernel::{Cause, Departure, Group as Motion};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{column, ids, rows};
use crate::errors::{input, kernel};
use crate::kinds::{KINDS, Kind};
use crate::simulated::Core;
use crate::views::{Shared, read, write};

/// How grains move; `World.group` makes one.
#[pyclass(frozen, module = "bitgrain")]
pub struct Group {
    /// Whose it is.
    pub shared: Shared,
    /// Its place among the groups.
    pub number: u8,
}

#[pymethods]
impl Group {
    /// Its number, as `World.groups` has it.
    #[getter]
    fn number(&self) -> u8 {
        self.number
    }

    fn __repr__(&self) -> String {
        format!("<bitgrain.Group {}>", self.number)
    }
}

/// A grain that was taken out of a world, as it was when it left.
#[pyclass(frozen, get_all, module = "bitgrain")]
pub struct Departed {
    /// Its id.
    pub id: u32,
    /// Why: "escaped" from the box, "drained", or too deep in an "obstacle" or in a "grain".
    pub cause: &'static str,
    /// Number of that obstacle, or id of that grain.
    pub partner: Option<u32>,
    /// Centre (length).
    pub position: (f64, f64, f64),
    /// Velocity (length / time).
    pub velocity: (f64, f64, f64),
    /// Spin (radians / time).
    pub spin: (f64, f64, f64),
    /// Radius (length).
    pub radius: f64,
    /// Mass.
    pub mass: f64,
}

impl From<&Departure<f64>> for Departed {
    fn from(departure: &Departure<f64>) -> Self {
        let Departure { grain, cause } = departure;
        let (cause, partner) = match *cause {
            Cause::Escaped => ("escaped", None),
            Cause::Drained => ("drained", None),
            Cause::ObstacleTooDeep { obstacle } => ("obstacle", Some(obstacle)),
            Cause::OverlapTooDeep { with } => ("grain", Some(with)),
            // A later kernel may have more causes.
            _ => ("other", None),
        };
        Self {
            id: grain.id,
            cause,
            partner,
            position: grain.position.into(),
            velocity: grain.velocity.into(),
            spin: grain.spin.into(),
            radius: grain.radius,
            mass: grain.mass,
        }
    }
}

#[pymethods]
impl Departed {
    fn __repr__(&self) -> String {
        let Self { id, cause, .. } = self;
        format!("<bitgrain.Departed: grain {id}, {cause}>")
    }
}

/// The arrays that grains are made from, as users give them.
pub struct Given<'a, 'py> {
    /// Positions.
    pub positions: &'a Bound<'py, PyAny>,
    /// Radii.
    pub radii: &'a Bound<'py, PyAny>,
    /// Densities.
    pub density: &'a Bound<'py, PyAny>,
    /// Velocities.
    pub velocities: Option<&'a Bound<'py, PyAny>>,
    /// Spins.
    pub spins: Option<&'a Bound<'py, PyAny>>,
    /// Ids.
    pub ids: Option<&'a Bound<'py, PyAny>>,
}

/// The arrays of grains, checked against each other.
pub struct Arrays {
    positions: Vec<[f64; 3]>,
    radii: Vec<f64>,
    densities: Vec<f64>,
    velocities: Vec<[f64; 3]>,
    spins: Vec<[f64; 3]>,
    ids: Option<Vec<u32>>,
}

impl Given<'_, '_> {
    /// The arrays as vectors of equal lengths.
    ///
    /// # Errors
    /// `InputError` with the array that is wrong.
    pub fn arrays(&self) -> PyResult<Arrays> {
        let positions = rows(self.positions, "positions", None)?;
        let n = positions.len();
        let optional = |value: Option<&Bound<'_, PyAny>>, name| match value {
            Some(value) => rows(value, name, Some(n)),
            None => Ok(vec![[0.0; 3]; n]),
        };
        let ids = self.ids.map(|value| ids(value, "ids")).transpose()?;
        if let Some(ids) = ids.as_ref().filter(|ids| ids.len() != n) {
            return Err(input(
                "ids",
                format!("has {} ids for {n} grains", ids.len()),
            ));
        }
        Ok(Arrays {
            radii: sized(self.radii, "radii", n)?,
            densities: sized(self.density, "density", n)?,
            velocities: optional(self.velocities, "velocities")?,
            spins: optional(self.spins, "spins")?,
            positions,
            ids,
        })
    }
}

/// Positive numbers.
fn sized(value: &Bound<'_, PyAny>, name: &str, count: usize) -> PyResult<Vec<f64>> {
    let numbers = column(value, name, count)?;
    match numbers.iter().position(|x| *x <= 0.0) {
        None => Ok(numbers),
        Some(k) => Err(input(
            name,
            format!("holds {} in row {k}; expected positive numbers", numbers[k]),
        )),
    }
}

impl Arrays {
    /// The grains, in the box of a world, with ids that no grain of it has had.
    ///
    /// # Errors
    /// `InputError` for a position outside the box or ids that do not ascend.
    pub fn grains(self, core: &Core, group: u8) -> PyResult<Vec<Grain>> {
        let n = self.positions.len();
        let ids = self.ids.unwrap_or_else(|| {
            (0..n as u32)
                .map(|k| core.next_id.saturating_add(k))
                .collect()
        });
        let mut next = core.next_id;
        for (k, id) in ids.iter().enumerate() {
            if *id < next || *id == u32::MAX {
                let problem = format!(
                    "holds {id} in row {k}; expected ids that ascend, from {} on: the ids before are or were those of \
                     other grains",
                    core.next_id
                );
                return Err(input("ids", problem));
            }
            next = *id + 1;
        }
        let mut grains = Vec::with_capacity(n);
        for k in 0..n {
            let mut position = self.positions[k];
            // A coordinate within one period outside a periodic axis is another name of one in the box.
            if !core.sim.domain.wrap(&mut position, &mut [0; 3]) {
                let (lo, hi) = (core.sim.domain.lo(), core.sim.domain.hi());
                let problem = format!(
                    "row {k} is at {:?}, outside the box from {lo:?} to {hi:?}",
                    self.positions[k]
                );
                return Err(input("positions", problem));
            }
            grains.push(Grain {
                id: ids[k],
                group,
                diameter: 2.0 * self.radii[k],
                density: self.densities[k],
                position,
                velocity: self.velocities[k],
                spin: self.spins[k],
            });
        }
        Ok(grains)
    }
}

/// The number of a group that is given by its handle or by its kind; without one, free grains.
///
/// # Errors
/// `InputError` for a group of another world or an unknown kind.
pub fn group_number(group: Option<&Bound<'_, PyAny>>, shared: &Shared) -> PyResult<u8> {
    let Some(group) = group else {
        return kind_number(Kind::Free, None, shared);
    };
    if let Ok(handle) = group.cast::<Group>() {
        let handle = handle.get();
        return match std::sync::Arc::ptr_eq(&handle.shared, shared) {
            true => Ok(handle.number),
            false => Err(input(
                "group",
                "is of another world; make it with this world's group()",
            )),
        };
    }
    let word: String = group
        .extract()
        .map_err(|_| unknown(&format!("{group:?}")))?;
    kind_number(kind_of(&word)?, None, shared)
}

/// The number of a world's group of a kind and a material under the world's gravity. A world that lacks it gets it.
///
/// # Errors
/// `InputError` if there are as many groups as are possible, or of a material as [`material`]; `Busy`.
pub fn kind_number(kind: Kind, name: Option<&str>, shared: &Shared) -> PyResult<u8> {
    let material = material(name, shared)?;
    let found = read(shared)?.group_of(kind, material);
    match found {
        Some(number) => Ok(number),
        None => {
            let mut core = write(shared)?;
            let group = kind.group(core.gravity, material);
            added_group(group, &mut core)
        }
    }
}

/// The number of a world's material.
///
/// # Errors
/// `InputError` for a name that is none of its materials, or without one if it has several; `Busy`.
pub fn material(name: Option<&str>, shared: &Shared) -> PyResult<u8> {
    let number = material_number(&read(shared)?.materials, name);
    number.map_err(|problem| match name {
        None => input(
            "material",
            format!("{problem}; of grains, pass group=world.group(kind, material=...)"),
        ),
        Some(_) => input("material", problem),
    })
}

/// Adds a group to a world and returns its number.
///
/// # Errors
/// `InputError` if there are as many groups as are possible.
pub fn added_group(group: Motion<f64>, core: &mut Core) -> PyResult<u8> {
    let Ok(number) = u8::try_from(core.sim.groups.len()) else {
        let problem = "there are 256 groups already, and no more are possible";
        return Err(input("group", problem));
    };
    core.rearrange(|sim| sim.groups.push(group))
        .map_err(kernel)?;
    Ok(number)
}

/// The kind of a name.
///
/// # Errors
/// `InputError` for an unknown kind.
pub fn kind_of(word: &str) -> PyResult<Kind> {
    let found = KINDS.iter().find(|(_, name)| *name == word);
    found
        .map(|(kind, _)| *kind)
        .ok_or_else(|| unknown(&format!("{word:?}")))
}

fn unknown(found: &str) -> PyErr {
    let names: Vec<String> = KINDS.iter().map(|(_, name)| format!("{name:?}")).collect();
    input(
        "group",
        format!("is {found}; expected {} or a Group", names.join(", ")),
    )
}

/// The ids of grains as an array.
pub fn ids_of<'py>(py: Python<'py>, grains: &[Grain]) -> Bound<'py, PyArray1<u32>> {
    PyArray1::from_iter(py, grains.iter().map(|grain| grain.id))
}
