//! What a simulation does under its law, whichever that is.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::phases::{After, check_forces};
use bitgrain_kernel::{ContactForce, Error as KernelError, GrainState, World};
use bitgrain_kernel::{start_watched, step_summed, step_watched};

use crate::isa::Isa;
use crate::law::{Sprung, WithLaw};
use crate::pass::Forces;

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
        let (mut world, registers) = (self.world, self.registers);
        let sum = |world: &mut World<'_, f64>| {
            let after = After::Stay;
            let (shares, notes) = (&mut [][..], None);
            let (found, _) = registers.run(Forces {
                world,
                law,
                shares,
                notes,
                after,
            });
            check_forces(world, found)
        };
        step_summed(&mut world, sum, self.external)
    }
}
