//! Checks of the arithmetic of several threads.

use std::sync::OnceLock;

use bitgrain_kernel::{Error as KernelError, World, check_arithmetic};

/// What a call of the kernel gives.
pub(crate) type Fallible<T> = std::result::Result<T, KernelError>;

/// Whether the threads of several ranges compute by the bit contract: each has its own processor modes,
/// and a library may change them at any time. The thread of a single range is checked when the
/// steps end, and a check costs as much as a few contacts.
pub(crate) struct Modes {
    looks: bool,
    found: OnceLock<KernelError>,
}

impl Modes {
    pub fn of(world: &World<'_, f64>) -> Self {
        Self {
            looks: !world.range_bounds.is_empty(),
            found: OnceLock::new(),
        }
    }

    /// The result of a share of a phase, after a check of the thread that did it.
    pub fn after<T>(&self, done: T) -> T {
        if self.looks
            && let Err(fault) = check_arithmetic::<f64>()
        {
            self.found.get_or_init(|| fault);
        }
        done
    }

    /// Stops the world if any of the checks found something.
    pub fn check(&self, world: &mut World<'_, f64>) -> Fallible<()> {
        let Some(fault) = self.found.get() else {
            return Ok(());
        };
        world.clock.stop();
        Err(*fault)
    }
}
