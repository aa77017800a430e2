//! Steps over ranges of grains, one for each thread, with the machine's widest instructions. The phases are the
//! kernel's and any partition into ranges gives the bits of one range, so nothing here can change a result.

use std::time::Instant;

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::phases::{
    After, CrossRangeForce, ExcessiveOverlap, GrainMotion, GrainRange, GrainView, MotionCheck,
    MotionPhase, ObstacleContactRange, PairRange, Sealed, accumulate, begin, check_overlaps,
    cross_range, drift, end, ensure_pair_list, finish, first_excessive_overlap, integrate,
    obstacle_forces, seal,
};
use bitgrain_kernel::{Error as KernelError, LossPolicy, Row, World};
use prefetch_index::prefetch_index;

use crate::isa::{Isa, Kernel};
use crate::modes::{Fallible, Modes};
use crate::skin::Skin;
use crate::threads::{Split, awake, each};

/// Fewest grains of a range: handing over less costs more than it saves.
const RANGE_MIN: usize = 500;

/// Grains of a range whose rows, 160 bytes each, stay in the cache: hints would cost about a twentieth of a step,
/// and save a fifth of one if rows come from memory.
const NEAR: usize = 30_000;

/// How a simulation steps: speed only, never a bit.
#[derive(Debug)]
pub struct Stepping {
    /// Instructions.
    pub registers: Isa,
    /// Fewest grains of a thread's range.
    pub range_min: usize,
    /// Whether skin and reach are adjusted to what they cost while it steps.
    pub tunes: bool,
    skin: Skin,
    /// Whether the owner began the present stretch, and will end it.
    held: bool,
    /// What pairs of two ranges give.
    cross_forces: Vec<CrossRangeForce<f64>>,
}

/// A copy has the settings; what is fitted to a pair list stays with that list.
impl Clone for Stepping {
    fn clone(&self) -> Self {
        Self {
            registers: self.registers,
            range_min: self.range_min,
            tunes: self.tunes,
            ..Self::default()
        }
    }
}

impl Default for Stepping {
    fn default() -> Self {
        Self {
            registers: Isa::best(),
            range_min: RANGE_MIN,
            tunes: true,
            skin: Skin::default(),
            held: false,
            cross_forces: Vec::new(),
        }
    }
}

impl Stepping {
    /// Advances a world to step `last`, on the threads of the pool that this is called in, one for each of
    /// its ranges.
    ///
    /// Rows are fetched once a step: as soon as the force on a grain is complete, the pass that summed it
    /// ends the grain's step and begins the next one.
    pub(crate) fn steps<L: Law<f64>>(
        &mut self,
        world: &mut World<'_, f64>,
        law: &L,
        last: u64,
    ) -> Fallible<()> {
        if world.range_bounds.is_empty() {
            self.steps_here(world, law, last)
        } else {
            awake(|| self.steps_here(world, law, last))
        }
    }

    /// [`Stepping::steps`], on threads that are awake.
    fn steps_here<L: Law<f64>>(
        &mut self,
        world: &mut World<'_, f64>,
        law: &L,
        last: u64,
    ) -> Fallible<()> {
        if world.clock.step >= last {
            return Ok(());
        }
        if world.clock.is_losing() {
            return Err(KernelError::GrainsLeaving);
        }
        if world.clock.rests() {
            self.begin(world)?;
            self.held = false;
        }
        // A full list may have interrupted these steps.
        if world.clock.has_begun() {
            let passed = self.drifted(world)?;
            drift(world, passed)?;
        }
        while world.clock.step < last {
            self.refresh_pair_list(world)?;
            let is_last = world.clock.step + 1 == last;
            // Grains that leave do so at the end of a step, before the next one moves any.
            let pauses = is_last || world.policy != LossPolicy::STOP;
            let passed = self.push_and_move(world, law, pauses)?;
            self.skin.stepped(world);
            finish(world, passed)?;
            if world.clock.is_losing() {
                if !self.held {
                    self.end(world)?;
                }
                return if is_last {
                    Ok(())
                } else {
                    Err(KernelError::GrainsLeaving)
                };
            }
            if !is_last {
                let passed = match pauses {
                    true => self.drifted(world)?,
                    false => passed,
                };
                drift(world, passed)?;
            }
        }
        match self.held {
            true => Ok(()),
            false => self.end(world),
        }
    }

    /// The motion that begins a step, each range by its own thread.
    fn drifted(&self, world: &mut World<'_, f64>) -> Fallible<MotionCheck<f64>> {
        let (with, range_bounds, modes) = (self.registers, world.range_bounds, Modes::of(world));
        let work = |m| modes.after(with.run(Move(m, MotionPhase::Drift)));
        let passed = each(
            world.grain_motion(),
            0,
            range_bounds,
            &work,
            &MotionCheck::and,
        );
        modes.check(world)?;
        Ok(passed)
    }

    /// Begins a stretch of steps, if nothing was written to since the last one.
    pub(crate) fn begin(&mut self, world: &mut World<'_, f64>) -> Fallible<()> {
        let sealed = self.sealed(world);
        begin(world, sealed)?;
        self.held = true;
        Ok(())
    }

    /// Ends a stretch of steps.
    pub(crate) fn end(&mut self, world: &mut World<'_, f64>) -> Fallible<()> {
        self.held = false;
        let sealed = self.sealed(world);
        end(world, sealed)
    }

    /// The seal of all grains, each range by its own thread.
    fn sealed(&self, world: &mut World<'_, f64>) -> Sealed {
        let (with, range_bounds) = (self.registers, world.range_bounds);
        let work = |grains| with.run(grains);
        each(
            Seal(world.grain_motion(), 0),
            0,
            range_bounds,
            &work,
            &Sealed::and,
        )
    }

    /// Renews the pair list if it is too old, and measures what that costs.
    fn refresh_pair_list(&mut self, world: &mut World<'_, f64>) -> Fallible<()> {
        if !self.tunes {
            return self.registers.run(Renew(world));
        }
        let (searches, began) = (world.clock.outer_list_rebuilds(), Instant::now());
        self.registers.run(Renew(world))?;
        self.skin.listed(world, searches, began);
        Ok(())
    }

    /// Forces and sums of one step, and the motion that follows them.
    fn push_and_move<L: Law<f64>>(
        &mut self,
        world: &mut World<'_, f64>,
        law: &L,
        last: bool,
    ) -> Fallible<MotionCheck<f64>> {
        let (with, range_bounds, modes) = (self.registers, world.range_bounds, Modes::of(world));
        let (part, touch) = world.force_ranges(world.dt);
        let hit = with.run(Touch(part, touch, law));

        let count = world.clock.listed_across();
        if self.cross_forces.len() < count {
            self.cross_forces
                .resize(count + count / 8, CrossRangeForce::default());
        }
        let cross_forces = &mut self.cross_forces[..count];
        let mut deep = None;
        if count > 0 {
            let (view, pairs) = world.cross_range_pairs();
            let sending = Sending(view, pairs, cross_forces);
            deep = share(sending, range_bounds.len() + 1, &|s| {
                modes.after(with.run(Across(s, law)))
            });
        }

        let cross_forces = &*cross_forces;
        let (part, _) = world.force_ranges(world.dt);
        let work = |part| modes.after(with.run(Sum(part, law, cross_forces, last)));
        let join = |(a, p): (ExcessiveOverlap, MotionCheck<f64>), (b, q)| {
            (first_excessive_overlap(a, b), p.and(q))
        };
        let (within, passed) = each(part, 0, range_bounds, &work, &join);
        modes.check(world)?;
        check_overlaps(world, hit, first_excessive_overlap(deep, within))?;
        Ok(passed)
    }
}

/// Evaluates the pairs of two ranges in as many shares as there are ranges, side by side.
fn share(
    piece: Sending<'_>,
    shares: usize,
    work: &(impl Fn(Sending<'_>) -> ExcessiveOverlap + Sync),
) -> ExcessiveOverlap {
    if shares <= 1 {
        return work(piece);
    }
    let lower = shares / 2;
    let pairs = piece.1.len() * lower / shares;
    let (left, right) = piece.split(pairs);
    let (left, right) = rayon::join(
        || share(left, lower, work),
        || share(right, shares - lower, work),
    );
    first_excessive_overlap(left, right)
}

impl Split for GrainMotion<'_, f64> {
    fn split(self, grains: usize) -> (Self, Self) {
        GrainMotion::split(self, grains)
    }
}

impl Split for GrainRange<'_, f64> {
    fn split(self, grains: usize) -> (Self, Self) {
        GrainRange::split(self, grains)
    }
}

/// Pairs of two ranges, what they read, and what they give.
struct Sending<'a>(
    GrainView<'a, f64>,
    PairRange<'a, f64>,
    &'a mut [CrossRangeForce<f64>],
);

impl Sending<'_> {
    /// The first `pairs` of them, and the others.
    fn split(self, pairs: usize) -> (Self, Self) {
        let (left, right) = self.1.split(pairs);
        let (out, others) = self.2.split_at_mut(pairs);
        (Self(self.0, left, out), Self(self.0, right, others))
    }
}

/// A range and the place of its first grain.
struct Seal<'a>(GrainMotion<'a, f64>, usize);

impl Split for Seal<'_> {
    fn split(self, grains: usize) -> (Self, Self) {
        let (left, right) = self.0.split(grains);
        (Self(left, self.1), Self(right, self.1 + grains))
    }
}

impl Kernel for Seal<'_> {
    type Output = Sealed;

    #[inline(always)]
    fn run(self) -> Sealed {
        seal(&self.0, self.1)
    }
}

struct Move<'a>(GrainMotion<'a, f64>, MotionPhase);

impl Kernel for Move<'_> {
    type Output = MotionCheck<f64>;

    #[inline(always)]
    fn run(mut self) -> Self::Output {
        integrate(&mut self.0, self.1)
    }
}

struct Renew<'a, 'w>(&'a mut World<'w, f64>);

impl Kernel for Renew<'_, '_> {
    type Output = Fallible<()>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        ensure_pair_list(self.0)
    }
}

/// All obstacle contacts at once: an obstacle's sum runs over all grains.
struct Touch<'a, L>(GrainRange<'a, f64>, ObstacleContactRange<'a, f64>, &'a L);

impl<L: Law<f64>> Kernel for Touch<'_, L> {
    type Output = ExcessiveOverlap;

    #[inline(always)]
    fn run(mut self) -> ExcessiveOverlap {
        obstacle_forces(&mut self.0, &mut self.1, self.2, |_| {})
    }
}

struct Across<'a, L>(Sending<'a>, &'a L);

impl<L: Law<f64>> Kernel for Across<'_, L> {
    type Output = ExcessiveOverlap;

    #[inline(always)]
    fn run(self) -> ExcessiveOverlap {
        let Across(Sending(view, pairs, out), law) = self;
        cross_range(view, pairs, law, out)
    }
}

/// The hint.
#[inline(always)]
fn near(rows: &[Row<f64>], place: usize) {
    prefetch_index(rows, place);
}

/// A range, what pairs across it give, and whether this is the last of several steps.
struct Sum<'a, L>(GrainRange<'a, f64>, &'a L, &'a [CrossRangeForce<f64>], bool);

impl<L: Law<f64>> Kernel for Sum<'_, L> {
    type Output = (ExcessiveOverlap, MotionCheck<f64>);

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Sum(mut part, law, cross_forces, last) = self;
        let grains = part.first..part.first + part.grains.position.len();
        let place = |i: usize| cross_forces.partition_point(|one| (one.i as usize) < i);
        let own = &cross_forces[place(grains.start)..place(grains.end)];
        let lower = cross_forces[..place(grains.start)].iter();
        let lower = lower.filter(|one| grains.contains(&(one.j as usize)));
        let after = if last {
            After::Rest
        } else {
            After::FinishAndBegin
        };
        let fetch = (part.grains.position.len() > NEAR).then_some(near);
        accumulate(&mut part, law, lower, own, |_| {}, fetch, after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{AnyLaw, Grain, Simulation};
    use crate::threads::on_threads;
    use bitgrain_kernel::contact::HertzHistory;
    use bitgrain_kernel::{Domain, Group};

    /// Eight grains in a row along x, of diameter 1 and 2 apart, that move along z or x as given.
    fn row(velocity: impl Fn(u32) -> [f64; 3]) -> Simulation {
        let law = HertzHistory {
            kn: 2e5,
            kt: 2e5,
            gamma_n: 0.0,
            gamma_t: 0.0,
            mu: 0.5,
        };
        let domain = Domain::new([0.0; 3], [20.0, 4.0, 4.0], [false; 3]).unwrap();
        let grain = |id: u32| Grain {
            id,
            group: 0,
            diameter: 1.0,
            density: 1.0,
            position: [2.0 * f64::from(id), 2.0, 2.0],
            velocity: velocity(id),
            spin: [0.0; 3],
        };
        let grains: Vec<Grain> = (1..=8).map(grain).collect();
        let groups = vec![Group::free([0.0; 3])];
        let mut sim = Simulation::new(
            AnyLaw::HertzHistory(law),
            domain,
            1e-3,
            groups,
            &grains,
            vec![],
        );
        sim.stepping.range_min = 1;
        sim.start().unwrap();
        sim
    }

    /// The fault that ends a row, and after how many steps, on this many threads.
    fn end(threads: usize, velocity: impl Fn(u32) -> [f64; 3]) -> (Option<KernelError>, u64) {
        let mut sim = row(velocity);
        let ended = on_threads(threads, || sim.steps(2000)).unwrap();
        (ended.err(), sim.step_count())
    }

    /// A search comes when the fastest grain of any range needs it: else grains would end past each other.
    #[test]
    fn a_fast_grain_of_any_range_is_heard() {
        for fast in 2..=8 {
            let mut states = Vec::new();
            for threads in [1, 2, 3, 8] {
                let mut sim = row(|id| [if id == fast { -30.0 } else { 0.0 }, 0.0, 0.0]);
                on_threads(threads, || sim.steps(60)).unwrap().unwrap();
                let left = sim.velocity[fast as usize - 2][0];
                assert!(left < -20.0, "grain {fast} hits the one before it: {left}");
                states.push(sim.digest());
            }
            assert!(states.iter().all(|state| *state == states[0]), "{fast}");
        }
    }

    /// Of several faults in one step the lowest grain's is reported, whichever range finds it.
    #[test]
    fn faults_are_those_of_one_range() {
        // Grains 3, 5 and 8 leave the box through the top at the same step.
        let leaves = |id: u32| [0.0, 0.0, if [3, 5, 8].contains(&id) { 10.0 } else { 0.0 }];
        // Grains 4 and 7 hit the ones before them too fast for their stiffness.
        let hits = |id: u32| [if [4, 7].contains(&id) { -300.0 } else { 0.0 }, 0.0, 0.0];
        let (first, second) = (end(1, leaves), end(1, hits));
        assert_eq!(first.0, Some(KernelError::Escaped { id: 3 }));
        assert_eq!(second.0, Some(KernelError::OverlapTooDeep { i: 3, j: 4 }));
        for threads in [2, 3, 5, 8] {
            assert_eq!(end(threads, leaves), first);
            assert_eq!(end(threads, hits), second);
        }
    }
}
