//! The passes of a step, compiled for several instruction sets: over a whole world or a part of one.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::parts::{drift_own, search_and_list};
use bitgrain_kernel::phases::{
    After, Extent, ForceCheck, MotionCheck, ObstacleShare, accumulate, ensure_pair_list,
    obstacle_forces,
};
use bitgrain_kernel::{Error as KernelError, Row, World};
use prefetch_index::prefetch_index;

use crate::isa::Kernel;
use crate::notes::Notebook;

/// What a call of the kernel gives.
pub(crate) type Fallible<T> = Result<T, KernelError>;

/// Grains whose rows, 160 bytes each, stay in the cache: hints would cost about a twentieth of a step, and save a
/// fifth of one if rows come from memory.
const NEAR: usize = 30_000;

/// The motion that begins a step, of own grains.
pub(crate) struct Drift<'a, 'w>(pub &'a mut World<'w, f64>);

impl Kernel for Drift<'_, '_> {
    type Output = MotionCheck<f64>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        drift_own(self.0)
    }
}

/// The renewal of pairs that are too old.
pub(crate) struct Renew<'a, 'w>(pub &'a mut World<'w, f64>);

impl Kernel for Renew<'_, '_> {
    type Output = Fallible<()>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        ensure_pair_list(self.0)
    }
}

/// The search of a part.
pub(crate) struct Search<'a, 'w>(pub &'a mut World<'w, f64>, pub &'a Extent<f64>);

impl Kernel for Search<'_, '_> {
    type Output = Fallible<()>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        search_and_list(self.0, self.1)
    }
}

/// Forces and sums of a step, and the motion that follows them; notes what each obstacle contact takes from its
/// obstacle, if there is room for it, and what the host wants to know of the step.
pub(crate) struct Forces<'a, 'w, L> {
    pub world: &'a mut World<'w, f64>,
    pub law: &'a L,
    pub shares: &'a mut [ObstacleShare<f64>],
    pub notes: Option<&'a mut Notebook>,
    pub after: After,
}

/// The hint.
#[inline(always)]
fn near(rows: &[Row<f64>], place: usize) {
    prefetch_index(rows, place);
}

impl<L: Law<f64>> Kernel for Forces<'_, '_, L> {
    type Output = (ForceCheck, MotionCheck<f64>);

    #[inline(always)]
    fn run(self) -> Self::Output {
        let (dt, step) = (self.world.dt, self.world.clock.step + 1);
        let (mut grains, mut touch) = self.world.force_ranges(dt);
        touch.shares = self.shares;
        let hit = obstacle_forces(&mut grains, &mut touch, self.law, |_| {});
        if let Some(notes) = self.notes {
            notes.begin(step, &touch, grains.grains.position);
            notes.lend(&mut grains);
        }
        let fetch = (grains.grains.count() > NEAR).then_some(near);
        let (deep, passed) = accumulate(&mut grains, self.law, |_| {}, fetch, self.after);
        (hit.and(deep), passed)
    }
}
