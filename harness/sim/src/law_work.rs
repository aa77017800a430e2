//! What a simulation does under its law, whichever that is.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::{ContactForce, Error as KernelError, GrainState, World};
use bitgrain_kernel::{start_watched, step_watched, step_with};

use crate::isa::{Isa, Kernel};
use crate::law::{Sprung, WithLaw};

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

/// Force and torque on a grain.
pub type Push = ([f64; 3], [f64; 3]);

/// A step with forces of a host.
pub(crate) struct Pushed<'a, 'w> {
    pub world: World<'w, f64>,
    pub external: &'a mut dyn FnMut(&GrainState<f64>) -> Push,
    pub registers: Isa,
}

impl WithLaw for Pushed<'_, '_> {
    type Output = Result<(), KernelError>;

    fn run<L: Law<f64> + Sprung>(self, law: &L) -> Self::Output {
        self.registers.run(OneStep(self.world, law, self.external))
    }
}

/// The same with a law, for several instruction sets.
struct OneStep<'a, 'w, L>(
    World<'w, f64>,
    &'a L,
    &'a mut dyn FnMut(&GrainState<f64>) -> Push,
);

impl<L: Law<f64>> Kernel for OneStep<'_, '_, L> {
    type Output = Result<(), KernelError>;

    #[inline(always)]
    fn run(mut self) -> Self::Output {
        step_with(&mut self.0, self.1, self.2)
    }
}
