//! What a simulation does under its law, whichever that is.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::{ContactForce, Error as KernelError, World, start_watched, step_watched};

use crate::law::{Sprung, WithLaw};
use crate::stepping::Stepping;

/// A start or a step that shows its contacts.
pub(crate) struct Watched<'a, 'w> {
    pub world: World<'w, f64>,
    pub watch: &'a mut dyn FnMut(ContactForce<f64>),
    pub starts: bool,
}

impl WithLaw for Watched<'_, '_> {
    type Output = Result<(), KernelError>;

    fn run<L: Law<f64> + Sprung>(mut self, law: &L) -> Self::Output {
        match self.starts {
            true => start_watched(&mut self.world, law, self.watch),
            false => step_watched(&mut self.world, law, self.watch),
        }
    }
}

/// Steps to an end.
pub(crate) struct Steps<'a, 'w> {
    pub world: &'a mut World<'w, f64>,
    pub stepping: &'a mut Stepping,
    pub end: u64,
}

impl WithLaw for Steps<'_, '_> {
    type Output = Result<(), KernelError>;

    fn run<L: Law<f64> + Sprung>(self, law: &L) -> Self::Output {
        self.stepping.steps(self.world, law, self.end)
    }
}
