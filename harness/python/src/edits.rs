//! Edits of grains within a `with` block.

use std::sync::{Arc, Mutex};

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{ids, rows, vector};
use crate::changes::{Change, apply};
use crate::errors::{input, kernel};
use crate::grains::{Given, group_number, ids_of};
use crate::simulated::Core;
use crate::views::{Shared, write};

/// Changes of grains that are made all together as the `with` block of `World.edit` is left, or not at all.
///
/// Contacts that stay keep their histories. Grains are named by ids: a number or an array of shape (n,).
#[pyclass(frozen, module = "bitgrain")]
pub struct Edit {
    shared: Shared,
    /// `None` before the block is entered and after it is left.
    changes: Mutex<Option<Open>>,
}

/// What was asked for within a block.
#[derive(Default)]
struct Open {
    changes: Vec<Change>,
    /// The next id before its grains got theirs, and after that.
    ids: Option<[u32; 2]>,
}

impl Open {
    /// Gives ids back that its grains do not need, unless others were given out since.
    fn give_back(&self, core: &mut Core) {
        if let Some([before, after]) = self.ids
            && core.next_id == after
        {
            core.next_id = before;
        }
    }
}

impl Edit {
    /// An edit of a world.
    pub fn of(shared: &Shared) -> Self {
        let shared = Arc::clone(shared);
        Self {
            shared,
            changes: Mutex::new(None),
        }
    }

    fn add(&self, change: Change) -> PyResult<()> {
        match self.changes().as_mut() {
            Some(open) => {
                open.changes.push(change);
                Ok(())
            }
            None => Err(input(
                "edit",
                "is not open; use it within `with world.edit() as edit:`",
            )),
        }
    }

    fn changes(&self) -> std::sync::MutexGuard<'_, Option<Open>> {
        // Nothing that is done under the lock can panic.
        self.changes
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// A row for each id; one row may stand for all.
fn rows_for(ids: &[u32], value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[f64; 3]>> {
    match vector(value, name) {
        Ok(row) => Ok(vec![row; ids.len()]),
        Err(_) => rows(value, name, Some(ids.len())),
    }
}

#[pymethods]
impl Edit {
    /// Begins the block; starts the world, if it has not started.
    fn __enter__(slf: PyRef<'_, Self>) -> PyResult<PyRef<'_, Self>> {
        write(&slf.shared)?.start().map_err(kernel)?;
        *slf.changes() = Some(Open::default());
        Ok(slf)
    }

    /// Ends the block: makes all changes, or none if one is refused or the block was left by an exception.
    fn __exit__(
        &self,
        py: Python<'_>,
        exception: Option<&Bound<'_, PyAny>>,
        _value: Option<&Bound<'_, PyAny>>,
        _traceback: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<bool> {
        let open = self.changes().take().unwrap_or_default();
        if open.changes.is_empty() {
            return Ok(false);
        }
        if exception.is_some() {
            // Of a world that is in use the ids stay used.
            let _ = write(&self.shared).map(|mut core| open.give_back(&mut core));
            return Ok(false);
        }
        let mut core = write(&self.shared)?;
        let mut all = open.changes.iter();
        let done = py.detach(|| core.edit(|sim| all.try_for_each(|change| apply(sim, change))));
        if done.is_err() {
            open.give_back(&mut core);
        }
        done.map(|()| false).map_err(kernel)
    }

    /// Gives grains other velocities (length / time), shape (n, 3) or (3,) for all of them.
    #[pyo3(signature = (ids, velocities))]
    fn set_velocities(
        &self,
        ids: &Bound<'_, PyAny>,
        velocities: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let ids = named(ids)?;
        let rows = rows_for(&ids, velocities, "velocities")?;
        self.add(Change::Velocities(ids, rows))
    }

    /// Gives grains other spins (radians / time), shape (n, 3) or (3,) for all of them.
    #[pyo3(signature = (ids, spins))]
    fn set_spins(&self, ids: &Bound<'_, PyAny>, spins: &Bound<'_, PyAny>) -> PyResult<()> {
        let ids = named(ids)?;
        let rows = rows_for(&ids, spins, "spins")?;
        self.add(Change::Spins(ids, rows))
    }

    /// Adds grains and returns their ids; parameters as `World.add`.
    #[pyo3(signature = (positions, radii, density, velocities=None, spins=None, group=None, ids=None))]
    #[allow(clippy::too_many_arguments)]
    fn insert<'py>(
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
        let ids = ids_of(py, &grains);
        let before = core.next_id;
        self.add(Change::Insert(grains.clone()))?;
        core.use_ids(&grains);
        if let Some(open) = self.changes().as_mut() {
            let first = open.ids.filter(|[_, after]| *after == before);
            open.ids = Some([first.map_or(before, |[first, _]| first), core.next_id]);
        }
        Ok(ids)
    }

    /// Removes grains.
    #[pyo3(signature = (ids))]
    fn remove(&self, ids: &Bound<'_, PyAny>) -> PyResult<()> {
        self.add(Change::Remove(ascending(named(ids)?)))
    }

    /// Puts grains into another group: a `Group`, or one of "free", "frozen", "carried" and "lid".
    ///
    /// Frozen and carried grains keep the velocity that they have: set it to zero for grains that shall stay where they
    /// are.
    #[pyo3(signature = (ids, group))]
    fn set_group(&self, ids: &Bound<'_, PyAny>, group: &Bound<'_, PyAny>) -> PyResult<()> {
        let group = group_number(Some(group), &self.shared)?;
        self.add(Change::Group(ascending(named(ids)?), group))
    }
}

fn named(value: &Bound<'_, PyAny>) -> PyResult<Vec<u32>> {
    ids(value, "ids")
}

/// Each id once, in the order that the kernel asks for.
fn ascending(mut ids: Vec<u32>) -> Vec<u32> {
    ids.sort_unstable();
    ids.dedup();
    ids
}
