//! What is done under a law.

use bitgrain_kernel::contact::{
    Contact, ContactMemory, Kept, Law, Materials, NormalForce, NormalState, Reaction,
    TangentialForce, TangentialState, Torque, TurningState, react,
};
use bitgrain_kernel::phases::{
    After, ForceCheck, GrainRange, MotionCheck, ObstacleContactRange, accumulate, no_fetch,
    obstacle_forces,
};
use bitgrain_kernel::time_step::{ShortestTimes, shortest_times};
use bitgrain_kernel::{
    ContactForce, Error as KernelError, GrainState, Real, Row, World, start, start_watched, step,
    step_summed, step_watched, step_with,
};

type External<'w, R> = &'w mut dyn FnMut(&GrainState<R>) -> ([R; 3], [R; 3]);
type Watch<'w, R> = &'w mut dyn FnMut(ContactForce<R>);
type Ended = Result<(), KernelError>;
type Summed<R> = (ForceCheck, MotionCheck<R>);

/// Functions of the kernel that take a law.
pub struct Calls<R: Real, L: Law<R>> {
    start: fn(&mut World<'_, R>, &L) -> Ended,
    start_watched: fn(&mut World<'_, R>, &L, Watch<'_, R>) -> Ended,
    step: fn(&mut World<'_, R>, &L) -> Ended,
    step_watched: fn(&mut World<'_, R>, &L, Watch<'_, R>) -> Ended,
    step_with: fn(&mut World<'_, R>, &L, External<'_, R>) -> Ended,
    step_summed: fn(&mut World<'_, R>, External<'_, R>) -> Ended,
    obstacle_forces: fn(
        &mut GrainRange<'_, R>,
        &mut ObstacleContactRange<'_, R>,
        &L,
        Watch<'_, R>,
    ) -> ForceCheck,
    sum: fn(&mut GrainRange<'_, R>, &L, After) -> Summed<R>,
    sum_watched:
        fn(&mut GrainRange<'_, R>, &L, Watch<'_, R>, fn(&[Row<R>], usize), After) -> Summed<R>,
    press: fn(&L, &NormalState<R>) -> NormalForce<R>,
    shear: fn(&L, &NormalForce<R>, &TangentialState<R>) -> TangentialForce<R>,
    acts: fn(&L, &NormalState<R>) -> bool,
    contact_acts: fn(&Contact<R>, &L, ContactMemory<R>) -> bool,
    torque: fn(&L, &NormalForce<R>, &TurningState<R>) -> Torque<R>,
    seen_by_partner: fn(&L, ContactMemory<R>) -> ContactMemory<R>,
    tells: fn(&L, Materials) -> (usize, R, Option<[R; 2]>),
    shortest_times: fn(&World<'_, R>, &L) -> ShortestTimes,
    react: fn(&L, &Contact<R>, Kept<R>, R) -> Reaction<R>,
}

impl<R: Real, L: Law<R>> Calls<R, L> {
    /// Each of them.
    pub const ALL: Self = Self {
        start,
        start_watched: |world, law, watch| start_watched(world, law, watch),
        step,
        step_watched: |world, law, watch| step_watched(world, law, watch),
        step_with: |world, law, external| step_with(world, law, external),
        step_summed: |world, external| step_summed(world, |_| Ok(()), external),
        obstacle_forces: |part, touch, law, watch| obstacle_forces(part, touch, law, watch),
        sum: |part, law, after| accumulate(part, law, |_| {}, no_fetch::<R>(), after),
        sum_watched: |part, law, watch, fetch, after| {
            accumulate(part, law, watch, Some(fetch), after)
        },
        press: L::normal_force,
        shear: L::tangential_force,
        acts: L::acts,
        contact_acts: |contact, law, memory| contact.acts(law, memory),
        torque: L::torque,
        seen_by_partner: L::seen_by_partner,
        tells: |law, pair| (law.materials(), law.reach(), law.stiffness(pair)),
        shortest_times,
        react: react::<R, L>,
    };
}
