//! What hosts of parts of a world do.

use bitgrain_kernel::contact::Kept;
use bitgrain_kernel::parts::{
    GhostMotion, drift_own, is_search_due, listed_obstacle_contacts, listed_pairs, renumber,
    restore, search_and_list, take_in, take_lists,
};
use bitgrain_kernel::phases::{
    Extent, MotionCheck, ObstacleShare, Owned, measure, sum_on_obstacles,
};
use bitgrain_kernel::{
    Clock, ContactHistory, Error as KernelError, KeptContact, Obstacle, Real, World,
};

type Ended = Result<(), KernelError>;
type Pairs<'l, R> = &'l mut dyn Iterator<Item = (u32, u32, Kept<R>)>;
type Contacts<'l, R> = &'l mut dyn Iterator<Item = (u32, u32, Kept<R>)>;

/// Functions over one number type.
pub struct Parts<R: Real + 'static> {
    drift_own: fn(&mut World<'_, R>) -> MotionCheck<R>,
    owns: for<'b> fn(Owned<'b>, usize) -> bool,
    owned: for<'b> fn(&'b [u32]) -> Owned<'b>,
    of_part: fn(&Clock<R>, usize) -> Clock<R>,
    rejoin: fn(&mut Clock<R>, &Clock<R>, u64, u64),
    take_in: fn(&mut World<'_, R>, &[u32], &[GhostMotion<R>]),
    is_search_due: fn(&World<'_, R>) -> bool,
    measure: fn(&World<'_, R>) -> Extent<R>,
    and: fn(Extent<R>, Extent<R>) -> Extent<R>,
    renumber: fn(&mut World<'_, R>, &[u32], usize) -> Ended,
    search_and_list: fn(&mut World<'_, R>, &Extent<R>) -> Ended,
    restore: fn(&mut World<'_, R>, &[ContactHistory<R>]) -> Ended,
    restore_any: fn(&mut World<'_, R>, &mut dyn Iterator<Item = KeptContact<R>>) -> Ended,
    listed_pairs: fn(&World<'_, R>, &mut dyn FnMut((u32, u32, Kept<R>))),
    listed_obstacle_contacts: fn(&World<'_, R>, &mut dyn FnMut((u32, u32, Kept<R>))),
    take_lists: fn(&mut World<'_, R>, Pairs<'_, R>, Contacts<'_, R>) -> Ended,
    sum_on_obstacles: fn(&mut [Obstacle<R>], &[ObstacleShare<R>]),
    sum_any: fn(&mut [Obstacle<R>], &mut dyn Iterator<Item = ObstacleShare<R>>),
}

impl<R: Real + 'static> Parts<R> {
    /// Each of them.
    pub const ALL: Self = Self {
        drift_own,
        owns: |owned, place| owned.has(place),
        owned: |bounds| Owned::new(bounds),
        of_part: Clock::of_part,
        rejoin: Clock::rejoin,
        take_in,
        is_search_due,
        measure,
        and: Extent::and,
        renumber,
        search_and_list,
        restore: |world, histories| restore(world, histories.iter().copied()),
        restore_any: |world, histories| restore(world, histories),
        listed_pairs: |world, show| listed_pairs(world).for_each(show),
        listed_obstacle_contacts: |world, show| listed_obstacle_contacts(world).for_each(show),
        take_lists: |world, pairs, contacts| take_lists(world, pairs, contacts),
        sum_on_obstacles: |bodies, shares| sum_on_obstacles(bodies, shares.iter().copied()),
        sum_any: |bodies, shares| sum_on_obstacles(bodies, shares),
    };
}
