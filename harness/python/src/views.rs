//! The memory of a world as numpy arrays, for as long as nothing can change it.
//!
//! A view of Python's side holds a [`Window`]. For each operation that window lends an array over the world's own
//! memory. The array owns a [`Lease`], which holds the world's lock for reading: until the last array is gone, whoever
//! wants to write is refused as busy.

use std::sync::Arc;

use numpy::ndarray::{ArrayView, ArrayView1, ArrayView2, Dimension, s};
use numpy::{Element, PyArray};
use parking_lot::{ArcRwLockReadGuard, ArcRwLockWriteGuard, RawRwLock, RwLock};
use pyo3::prelude::*;

use crate::errors::{busy, kernel, stale};
use crate::simulated::Core;

/// A world that handles, views and threads share.
pub type Shared = Arc<RwLock<Core>>;

/// Leave to read a world.
pub type Reading = ArcRwLockReadGuard<RawRwLock, Core>;

/// Leave to change a world.
pub type Writing = ArcRwLockWriteGuard<RawRwLock, Core>;

/// Leave to read; nobody waits for it, since whoever writes may do so for long.
///
/// # Errors
/// `Busy` if another thread changes the world.
pub fn read(shared: &Shared) -> PyResult<Reading> {
    shared.try_read_arc().ok_or_else(busy)
}

/// Leave to change.
///
/// # Errors
/// `Busy` if another thread, or an operation on a view, uses the world.
pub fn write(shared: &Shared) -> PyResult<Writing> {
    shared.try_write_arc().ok_or_else(busy)
}

/// What a view shows.
#[derive(Clone, Copy, Debug)]
pub enum Shown {
    /// Positions (n, 3).
    Positions,
    /// Radii (n,).
    Radii,
    /// Velocities (n, 3).
    Velocities,
    /// Masses (n,).
    Masses,
    /// Spins (n, 3).
    Spins,
    /// Forces (n, 3).
    Forces,
    /// Torques (n, 3).
    Torques,
    /// Crossings of periodic axes (n, 3).
    Images,
    /// Ids (n,).
    Ids,
    /// Numbers of groups (n,).
    Groups,
}

/// A part of a world's state at one moment; what a `View` looks through.
#[pyclass(frozen, module = "bitgrain._native")]
pub struct Window {
    shared: Shared,
    shown: Shown,
    generation: u64,
    grains: usize,
}

/// Keeps the memory that an array is over where it is and as it is.
#[pyclass(frozen, module = "bitgrain._native")]
struct Lease(Reading);

impl Window {
    /// Of the present state.
    ///
    /// # Errors
    /// `Busy`; `NotStarted` after a fault that stopped a step, but for what no step changes.
    pub fn of(shared: &Shared, shown: Shown) -> PyResult<Self> {
        let core = read(shared)?;
        match shown {
            Shown::Radii | Shown::Masses | Shown::Ids | Shown::Groups => {}
            _ => drop(core.state().map_err(kernel)?),
        }
        Ok(Self {
            shared: Arc::clone(shared),
            shown,
            generation: core.generation,
            grains: core.sim.count(),
        })
    }
}

#[pymethods]
impl Window {
    /// The shape of the array.
    ///
    /// Raises
    /// ------
    /// StaleView, Busy
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        if read(&self.shared)?.generation != self.generation {
            return Err(stale());
        }
        let n = self.grains;
        Ok(match self.shown {
            Shown::Radii | Shown::Masses | Shown::Ids | Shown::Groups => {
                (n,).into_pyobject(py)?.into_any()
            }
            _ => (n, 3).into_pyobject(py)?.into_any(),
        })
    }

    /// The type of its numbers.
    #[getter]
    fn dtype(&self) -> &'static str {
        match self.shown {
            Shown::Ids => "uint32",
            Shown::Groups => "uint8",
            Shown::Images => "int32",
            _ => "float64",
        }
    }

    /// A read-only array over the world's memory; as long as it lives the world cannot be stepped or edited.
    ///
    /// Raises
    /// ------
    /// StaleView, Busy
    fn lend<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let reading = read(&self.shared)?;
        if reading.generation != self.generation {
            return Err(stale());
        }
        let lease = &Bound::new(py, Lease(reading))?;
        let sim = &lease.get().0.sim;
        match self.shown {
            Shown::Positions => array(rows(&sim.position).slice(s![.., ..3]), lease),
            Shown::Radii => array(rows(&sim.position).slice(s![.., 3]), lease),
            Shown::Velocities => array(rows(&sim.velocity).slice(s![.., ..3]), lease),
            Shown::Masses => array(rows(&sim.velocity).slice(s![.., 3]), lease),
            Shown::Spins => array(rows(&sim.spin).slice(s![.., ..3]), lease),
            Shown::Forces => array(rows(&sim.force).slice(s![.., ..3]), lease),
            Shown::Torques => array(rows(&sim.torque).slice(s![.., ..3]), lease),
            Shown::Images => array(rows(&sim.image), lease),
            Shown::Ids => array(ArrayView1::from(&sim.id[..]), lease),
            Shown::Groups => array(ArrayView1::from(&sim.group[..]), lease),
        }
    }
}

/// Rows as an array of two dimensions.
fn rows<T, const N: usize>(rows: &[[T; N]]) -> ArrayView2<'_, T> {
    ArrayView2::from(rows)
}

/// A read-only numpy array over what the lease keeps.
fn array<'py, T: Element, D: Dimension>(
    view: ArrayView<'_, T, D>,
    lease: &Bound<'py, Lease>,
) -> PyResult<Bound<'py, PyAny>> {
    // SAFETY: the array's base is the lease, so the lease lives as long as any array over this memory. It holds the
    // lock for reading, so that until it is dropped the vectors of the world are neither freed, moved nor written to:
    // all that changes them takes the lock for writing. `view` borrows from the lease itself, as each
    // call in `lend` shows.
    #[allow(unsafe_code)]
    let array = unsafe { PyArray::borrow_from_array(&view, lease.clone().into_any()) };
    // The lease gives no buffer that could be written to, so numpy lets nobody set this back.
    array.call_method1("setflags", (false,))?;
    Ok(array.into_any())
}
