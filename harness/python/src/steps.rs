//! Starting and stepping a world.

use bitgrain::threads::ThreadsError;
use bitgrain_kernel::Error as KernelError;
use pyo3::prelude::*;

use crate::arrays::rows;
use crate::changes::Push;
use crate::errors::{input, kernel, laboratory, long_step, warn_long_step};
use crate::simulated::Core;
use crate::views::{Writing, read, write};
use crate::watch::LOOK;
use crate::world::World;

/// Grain-steps between two looks for Ctrl-C: some tenth of a second.
const UNINTERRUPTED: u64 = 500_000;

#[pymethods]
impl World {
    /// Starts the world: checks it, empties the contact histories and evaluates the forces of the state as it is. The
    /// first step does so by itself. A world that has started stays as it is.
    ///
    /// Raises
    /// ------
    /// KernelError
    ///     What is wrong with the world, as `OverlapTooDeep` with the ids of two grains.
    /// Busy
    fn start(&self, py: Python<'_>) -> PyResult<()> {
        let mut core = write(&self.shared)?;
        py.detach(|| core.start()).map_err(kernel)
    }

    /// Advances by `n` steps. Other threads of Python run meanwhile; Ctrl-C stops it between two steps.
    ///
    /// Parameters
    /// ----------
    /// n : int
    ///     How many steps.
    /// force, torque : array_like, shape (n_grains, 3), or callable, optional
    ///     Force and torque on each grain, in the order of `ids`, beside those of its contacts, in each of these steps.
    ///     A callable is called with this world before each step, and returns the array for it: it sees the state
    ///     before the step. What is given acts in the half kick that ends a step and in the one that begins the next,
    ///     and stands in `forces` and in the digest.
    ///
    /// In a world that takes out grains (`lose`, `drain`), those that left are in `departures`, and what was given for
    /// them goes with them.
    ///
    /// A call of `n` steps gives the bits of `n` calls of one. A force of zero gives the bits of none.
    ///
    /// Raises
    /// ------
    /// KernelError
    ///     What stopped a step, as `Escaped` with the id of the grain; `step_count` says how many were done. After an
    ///     error of the motion the world is stopped and has no state: whatever reads one or goes on raises
    ///     `NotStarted`.
    /// InputError
    ///     Forces have another shape, or the world was stepped or edited while they were made into arrays.
    /// LongTimeStep
    ///     The world is `strict`, and its time step too long; no step was done since.
    /// Busy
    ///
    /// Warns
    /// -----
    /// LongTimeStepWarning
    ///     The time step is too long (see `strict` of `World`); once for each world.
    #[pyo3(signature = (n=1, *, force=None, torque=None))]
    fn step(
        slf: &Bound<'_, Self>,
        n: u64,
        force: Option<&Bound<'_, PyAny>>,
        torque: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (py, shared) = (slf.py(), &slf.get().shared);
        let (grains, generation) = begin(py, &mut *write(shared)?)?;
        let given = [(force, "force"), (torque, "torque")];
        if !given
            .iter()
            .any(|(value, _)| value.is_some_and(|value| value.is_callable()))
        {
            let push = push(given, grains, |value| Ok(value.clone()))?;
            return advance(py, write(shared)?, n, (push, generation));
        }
        for _ in 0..n {
            let pushed = {
                // Whoever is asked may look, but not step.
                let reading = read(shared)?;
                let push = push(given, reading.sim.count(), |value| {
                    match value.is_callable() {
                        true => value.call1((slf,)),
                        false => Ok(value.clone()),
                    }
                })?;
                (push, reading.generation)
            };
            advance(py, write(shared)?, 1, pushed)?;
        }
        Ok(())
    }
}

/// Starts a world before its first step, and its threads; returns how many grains there are, and of which state.
fn begin(py: Python<'_>, core: &mut Core) -> PyResult<(usize, u64)> {
    let threads: Result<(), ThreadsError> = core.start_threads();
    threads.map_err(|why| laboratory(&why.into()))?;
    py.detach(|| core.start()).map_err(kernel)?;
    core.begin_call();
    Ok((core.sim.count(), core.generation))
}

/// Steps without the interpreter's lock, but for looks for Ctrl-C and at the time step; with forces that were given for
/// the grains of this state.
fn advance(
    py: Python<'_>,
    mut core: Writing,
    n: u64,
    (mut push, generation): (Option<Push>, u64),
) -> PyResult<()> {
    if push.is_some() && core.generation != generation {
        let problem = "the world was stepped or edited while its forces were made into arrays, by them or by another \
                       thread: give arrays of its present grains";
        return Err(input("step", problem));
    }
    let many = (UNINTERRUPTED / (core.sim.count() as u64 + 1) + 1).min(LOOK);
    let mut left = n;
    while left > 0 {
        if let Some(problem) = core.long_step() {
            match core.watch.strict {
                true => return Err(long_step(&problem)),
                false => warn_long_step(py, &problem)?,
            }
        }
        let now = left.min(many);
        let done: Result<(), KernelError> = py.detach(|| core.steps(now, &mut push));
        done.map_err(kernel)?;
        left -= now;
        py.check_signals()?;
    }
    Ok(())
}

/// Forces and torques as vectors; `None` if neither is given.
fn push<'py>(
    given: [(Option<&Bound<'py, PyAny>>, &str); 2],
    grains: usize,
    ask: impl Fn(&Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>>,
) -> PyResult<Option<Push>> {
    if given.iter().all(|(value, _)| value.is_none()) {
        return Ok(None);
    }
    let of = |(value, name): (Option<&Bound<'py, PyAny>>, &str)| match value {
        None => Ok(vec![[0.0; 3]; grains]),
        Some(value) => rows(&ask(value)?, name, Some(grains)),
    };
    let [force, torque] = given;
    Ok(Some(Push {
        force: of(force)?,
        torque: of(torque)?,
    }))
}
