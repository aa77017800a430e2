//! Parts of a world, for hosts that share one among threads or machines.
//!
//! A host cuts a world that [has begun](crate::phases::begin) into parts, each of which is a world by itself: own
//! grains, which are of no other part, and as ghosts copies of all grains that may come near them, in one order of ids.
//! [`World::owned`] says which are own, and [`Clock::of_part`] makes the clock. A part does the phases of a step on its
//! own grains, and between them the parts tell each other what they need to decide alike:
//!
//! 1. After a drift, which for the first step is [`drift_own`], each looks whether [`is_search_due`]. If so, all
//!    exchange what [`measure`](crate::phases::measure) says and the grains near other parts; [`renumber`] keeps the
//!    histories, and [`search_and_list`] is done in the place of `ensure_pair_list`. After the first search of a part,
//!    [`restore`] puts in the histories of its grains.
//! 2. After the forces, each joins with `and` what all have found, and takes the rows of its ghosts with [`take_in`].
//!    Then it calls [`check_forces`](crate::phases::check_forces), [`finish`](crate::phases::finish) and
//!    [`drift`](crate::phases::drift). With a drain plane,
//!    [`MotionCheck::draining`](crate::phases::MotionCheck::draining) must be set by
//!    [`is_draining`](crate::phases::is_draining) before it is joined, or the parts would not stop together.
//! 3. The forces on obstacles in a part are partial. Whoever wants them collects the
//!    [`ObstacleShare`](crate::phases::ObstacleShare)s of all parts in the order of grains, and calls
//!    [`sum_on_obstacles`](crate::phases::sum_on_obstacles).
//! 4. At the end the rows of own grains go back to the whole world, and the springs with [`take_lists`];
//!    [`Clock::rejoin`] takes over the step and the numbers of searches and renewals done since the last time.
//!
//! A pair of two parts is evaluated in both, from the same numbers in the same orientation. So any cut gives the bits
//! of the whole world.

use crate::contact::kept::Kept;
use crate::edit::renumber::{NewPlaces, renumber_contacts};
use crate::error::Error;
use crate::integrate::{MotionCheck, MotionPhase, integrate, travel_at};
use crate::math::real::{Real, larger};
use crate::math::rows::{min, prefix, set};
use crate::math::vec3::{Vec3, dot};
use crate::neighbors::extent::Extent;
use crate::neighbors::pair_list::{KeptContact, Listed};
use crate::phases::{cut_anew, refresh_here};
use crate::state::owned::Owned;
use crate::world::{Clock, Stage, World};

pub use crate::edit::renumber::GONE;

/// How a grain of another part moves: position (length), velocity (length / time) and spin (radians / time).
pub type GhostMotion<R> = [Vec3<R>; 3];

impl<R: Real> Clock<R> {
    /// The clock of a part with so many grains, ghosts included, of the world that has begun by this clock. Nothing is
    /// listed in it, so a search is due.
    #[must_use]
    pub fn of_part(&self, grains: usize) -> Self {
        Self {
            outer_list_rebuilds: 0,
            prunes: 0,
            picked: 0,
            listed: Listed::NONE,
            far: -R::ONE,
            seal: 0,
            count: grains,
            ..*self
        }
    }

    /// Takes over how far the parts of a world have come, by the clock of one of them, and the numbers of a search if
    /// it did one. What the world itself lists is old.
    pub fn rejoin(&mut self, part: &Self, searches: u64, prunes: u64) {
        self.step = part.step;
        self.next_travel = part.next_travel;
        self.losing = part.losing;
        self.stage = part.stage;
        self.slack = part.slack;
        self.rounding = part.rounding;
        self.reach = part.reach;
        // A caller may give any numbers.
        self.outer_list_rebuilds = self.outer_list_rebuilds.saturating_add(searches);
        self.prunes = self.prunes.saturating_add(prunes);
        self.far = -R::ONE;
    }
}

/// The motion of own grains that begins a step: [`integrate`] over each run of them.
#[inline(always)]
pub fn drift_own<R: Real>(world: &mut World<'_, R>) -> MotionCheck<R> {
    let mut runs = Owned::new(world.owned).runs();
    let mut grains = world.grain_motion();
    let all = grains.count();
    let mut passed = MotionCheck::NONE;
    while let Some(run) = runs.next_before(all) {
        let mut own = grains.stretch(run.start, run.end);
        passed = passed.and(integrate(&mut own, MotionPhase::Drift));
    }
    passed
}

/// Moves the ghosts at these places, which ascend, to where other parts have moved them. Radii and masses stay. Then
/// their speed counts in what the pairs of a stretch may approach.
pub fn take_in<R: Real>(world: &mut World<'_, R>, places: &[u32], ghosts: &[GhostMotion<R>]) {
    let stretches = world.clock.listed.stretches;
    let mut s = 0;
    for (place, [x, v, w]) in places.iter().zip(ghosts) {
        while s + 1 < stretches && world.stretches.grains(s).end <= *place as usize {
            s += 1;
        }
        let place = *place as usize;
        let rows = [
            (&mut world.grains.position, x),
            (&mut world.grains.velocity, v),
            (&mut world.grains.spin, w),
        ];
        for (rows, [x, y, z]) in rows {
            if let Some(row) = rows.get_mut(place) {
                *row = [*x, *y, *z, row[3]];
            }
        }
        let way = travel_at(dot(*v, *v), world.dt);
        if let Some(travel) = world.stretches.travel.get_mut(s) {
            *travel = larger(*travel, way);
        }
    }
}

/// Whether the candidates of the last search no longer reach as far as they must, after a drift: the same in all parts
/// that have the same skin.
pub fn is_search_due<R: Real>(world: &World<'_, R>) -> bool {
    // A caller may have set any number.
    world.clock.far < larger(world.skin, R::ZERO)
}

/// Gives the grains of a part new places, by a table of one for each that it had, which is [`GONE`] for ghosts that are
/// none any more; the others ascend. It will have so many grains. Listed pairs keep their springs; the caller moves the
/// rows, and then a search is due.
///
/// # Errors
/// [`Error::BadStorage`] of a table of another length.
pub fn renumber<R: Real>(
    world: &mut World<'_, R>,
    places: &[u32],
    grains: usize,
) -> Result<(), Error> {
    if places.len() != world.clock.count {
        return Err(Error::BadStorage);
    }
    if world.clock.listed.stretches > 0 {
        renumber_contacts(world, NewPlaces(places), grains);
    }
    world.clock.count = grains;
    world.clock.far = -R::ONE;
    Ok(())
}

/// Searches for candidates within the extent of all parts and lists the pairs, after a drift.
///
/// # Errors
/// A full list: enlarge the storage and call again. A world that has not drifted.
#[inline(always)]
pub fn search_and_list<R: Real>(world: &mut World<'_, R>, extent: &Extent<R>) -> Result<(), Error> {
    if world.clock.stage != Stage::Drifted {
        return Err(Error::NotStarted);
    }
    world.check_storage()?;
    if world.clock.listed.stretches == 0 {
        // Nothing was listed yet.
        cut_anew(world);
    }
    refresh_here(world, None, Some(*extent))?;
    world.clock.stage = Stage::Listed;
    Ok(())
}

/// Puts histories of a world into a list that was just made. Bodies that are not listed have parted in the drift, and
/// theirs end.
///
/// # Errors
/// A world whose pairs were not just listed.
pub fn restore<R: Real>(
    world: &mut World<'_, R>,
    histories: impl IntoIterator<Item = impl Into<KeptContact<R>>>,
) -> Result<(), Error> {
    if world.clock.stage != Stage::Listed {
        return Err(Error::NotStarted);
    }
    let listed = world.clock.listed;
    for history in histories {
        // A spring that is not finite is found by the forces, as in the whole world.
        world
            .pairs
            .restore(&world.stretches, &history.into(), listed);
    }
    Ok(())
}

/// The listed pairs by lower grain and partner, with what the law has kept of them.
pub fn listed_pairs<'w, R: Real>(
    world: &'w World<'_, R>,
) -> impl Iterator<Item = (u32, u32, Kept<R>)> + 'w {
    let listed = world.pairs.in_order(&world.stretches, world.clock.listed);
    listed.map(|(i, j, p)| (i, j, world.pairs.kept(p)))
}

/// The listed obstacle contacts by grain and obstacle, with the word of the obstacle as
/// [`PairList`](crate::PairList) holds it, and what the law has kept of them.
pub fn listed_obstacle_contacts<'w, R: Real>(
    world: &'w World<'_, R>,
) -> impl Iterator<Item = (u32, u32, Kept<R>)> + 'w {
    let pairs = &world.pairs;
    let count = world.clock.listed.obstacle_contacts;
    let listed = prefix(pairs.obstacle_contact_grain, count);
    let listed = listed.iter().zip(&*pairs.obstacle_contact_obstacle);
    let listed = listed.enumerate();
    listed.map(|(t, (grain, word))| (*grain, *word, pairs.kept_on_obstacle(t)))
}

/// Takes the pairs of all parts, by lower grain and partner, and all obstacle contacts by grain and obstacle, each as
/// [`listed_pairs`] and [`listed_obstacle_contacts`] tell it, in the place of what the world has listed. The next step
/// searches.
///
/// # Errors
/// A full list: enlarge the storage and call again.
pub fn take_lists<R: Real>(
    world: &mut World<'_, R>,
    pairs: impl Iterator<Item = (u32, u32, Kept<R>)>,
    contacts: impl Iterator<Item = (u32, u32, Kept<R>)>,
) -> Result<(), Error> {
    let list = &mut world.pairs;
    let (mut count, mut on_obstacles) = (0, 0);
    for (i, j, kept) in pairs {
        set(list.lower, count, i);
        set(list.partner, count, j);
        list.keep(count, kept);
        count += 1;
    }
    for (grain, obstacle, kept) in contacts {
        set(list.obstacle_contact_grain, on_obstacles, grain);
        set(list.obstacle_contact_obstacle, on_obstacles, obstacle);
        list.keep_on_obstacle(on_obstacles, kept);
        on_obstacles += 1;
    }
    let clock = &mut *world.clock;
    clock.far = -R::ONE;
    clock.listed = Listed::NONE;
    if count > min(list.lower.len(), world.spare.lower.len()) {
        return Err(Error::PairListFull { needed: count });
    }
    let contacts = list.obstacle_contact_grain.len();
    if on_obstacles > min(contacts, world.spare.obstacle_contact_grain.len()) {
        return Err(Error::ObstacleContactsFull {
            needed: on_obstacles,
        });
    }
    let lower = prefix(list.lower, count);
    clock.listed = Listed {
        stretches: world.stretches.divide(lower, -R::ONE, clock.count),
        end: count,
        pairs: count,
        touching: 0,
        obstacle_contacts: on_obstacles,
    };
    world.stretches.travel_alike(clock.next_travel);
    Ok(())
}
