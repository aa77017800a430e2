//! What is done under a law.

use bitgrain_kernel::contact::{Contact, Law, Press, Reaction, Shear, Slide, Squeeze};
use bitgrain_kernel::phases::Passed;
use bitgrain_kernel::phases::{After, Deep, Part, Sight, Span, Spill, no_fetch, spill, sum};
use bitgrain_kernel::phases::{TouchPart, push_obstacles};
use bitgrain_kernel::{Fault, Pushed, Real, Row, World, start, start_watched, step, step_watched};

type Watch<'w, R> = &'w mut dyn FnMut(Pushed<R>);
type Ended = Result<(), Fault>;
type Summed<R> = (Deep, Passed<R>);

/// Functions of the kernel that take a law.
pub struct Calls<R: Real, L: Law<R>> {
    start: fn(&mut World<'_, R>, &L) -> Ended,
    start_watched: fn(&mut World<'_, R>, &L, Watch<'_, R>) -> Ended,
    step: fn(&mut World<'_, R>, &L) -> Ended,
    step_watched: fn(&mut World<'_, R>, &L, Watch<'_, R>) -> Ended,
    push_obstacles: fn(&mut Part<'_, R>, &mut TouchPart<'_, R>, &L, Watch<'_, R>) -> Deep,
    spill: fn(Sight<'_, R>, Span<'_, R>, &L, &mut [Spill<R>]) -> Deep,
    sum: fn(&mut Part<'_, R>, &L, &[Spill<R>], &[Spill<R>], After) -> Summed<R>,
    sum_watched: fn(
        &mut Part<'_, R>,
        &L,
        [&[Spill<R>]; 2],
        Watch<'_, R>,
        fn(&[Row<R>], usize),
        After,
    ) -> Summed<R>,
    press: fn(&L, &Squeeze<R>) -> Press<R>,
    shear: fn(&L, &Press<R>, &Slide<R>) -> Shear<R>,
    react: fn(&L, &Contact<R>, [R; 3], R) -> Reaction<R>,
}

impl<R: Real, L: Law<R>> Calls<R, L> {
    /// Each of them.
    pub const ALL: Self = Self {
        start,
        start_watched: |world, law, watch| start_watched(world, law, watch),
        step,
        step_watched: |world, law, watch| step_watched(world, law, watch),
        push_obstacles: |part, touch, law, watch| push_obstacles(part, touch, law, watch),
        spill,
        sum: |part, law, lower, own, after| {
            sum(part, law, lower.iter(), own, |_| {}, no_fetch::<R>(), after)
        },
        sum_watched: |part, law, [lower, own], watch, fetch, after| {
            sum(part, law, lower.iter(), own, watch, Some(fetch), after)
        },
        press: L::press,
        shear: L::shear,
        react: L::react,
    };
}
