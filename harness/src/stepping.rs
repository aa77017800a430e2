//! Steps over ranges of grains, one for each thread, with the machine's widest registers. The phases
//! are the kernel's and any cut into ranges gives the bits of one range, so nothing here can change
//! a result.

use bitgrain_kernel::law::Law;
use bitgrain_kernel::motion::{Moving, kick, kick_and_drift};
use bitgrain_kernel::push::{Deep, Part, Sight, Spill, first_deep, spill, sum};
use bitgrain_kernel::step::{find_who_may_touch, finish, judge};
use bitgrain_kernel::touch::{TouchPart, push_obstacles};
use bitgrain_kernel::{Fault, World, check_arithmetic};

use rayon::ThreadPoolBuilder;

use crate::error::{Error, Result};
use crate::registers::{Job, Registers};

type Fallible<T> = std::result::Result<T, Fault>;

/// Fewest grains of a range: handing over less costs more than it saves.
const RANGE_MIN: usize = 500;

/// How a simulation steps: speed only, never a bit.
#[derive(Debug)]
pub struct Stepping {
    /// Lanes and instructions.
    pub registers: Registers,
    /// Fewest grains of a thread's range.
    pub range_min: usize,
    /// Where ranges end, but for the last.
    cuts: Vec<usize>,
    /// What each range sends to later ones.
    outboxes: Vec<Outbox>,
    /// The list that ranges and outboxes were fitted to: number of its search, grains, pairs; and the
    /// threads and the least range.
    fitted: Option<[usize; 5]>,
}

/// A copy has the knobs; what is fitted to a pair list stays with that list.
impl Clone for Stepping {
    fn clone(&self) -> Self {
        Self {
            registers: self.registers,
            range_min: self.range_min,
            ..Self::default()
        }
    }
}

/// The spills of a range: storage, and how many there are in this step.
#[derive(Clone, Debug, Default)]
struct Outbox {
    spills: Vec<Spill<f64>>,
    count: usize,
}

impl Outbox {
    fn sent(&self) -> &[Spill<f64>] {
        &self.spills[..self.count]
    }
}

impl Default for Stepping {
    fn default() -> Self {
        Self {
            registers: Registers::best(),
            range_min: RANGE_MIN,
            cuts: Vec::new(),
            outboxes: Vec::new(),
            fitted: None,
        }
    }
}

/// Threads of the pool that this is called in; 1 outside of any.
fn threads() -> usize {
    if rayon::current_thread_index().is_some() {
        rayon::current_num_threads()
    } else {
        1
    }
}

/// Does a job on this many threads: those of a pool round it, or, for one, where it is called.
///
/// # Errors
/// [`Error::Input`] where so many cannot be started, [`Error::Contract`] where one of them computes
/// otherwise than the bit contract has it.
pub fn on_threads<T: Send>(threads: usize, job: impl FnOnce() -> T + Send) -> Result<T> {
    if threads <= 1 {
        return Ok(job());
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| no_threads(threads, &e))?;
    // Each thread has a rounding mode of its own.
    for checked in pool.broadcast(|_| check_arithmetic::<f64>()) {
        checked.map_err(|fault| Error::run("a thread", 0, fault))?;
    }
    Ok(pool.install(job))
}

/// The refusal of a number of threads.
pub(crate) fn no_threads(threads: usize, why: &dyn std::error::Error) -> Error {
    let problem = format!("{threads} threads cannot be started: {why}");
    Error::input("--threads", problem)
}

impl Stepping {
    /// Advances a world by `count` steps, on the threads of the pool that this is called in.
    pub(crate) fn steps<L: Law<f64>>(
        &mut self,
        world: &mut World<'_, f64>,
        law: &L,
        count: u64,
    ) -> Fallible<()> {
        let threads = threads();
        for _ in 0..count {
            self.step(world, law, threads)?;
        }
        Ok(())
    }

    /// Ranges of the step before: how many threads had a part in it.
    pub fn ranges(&self) -> usize {
        self.cuts.len() + 1
    }

    /// The kernel's step, phase by phase over ranges.
    fn step<L: Law<f64>>(
        &mut self,
        world: &mut World<'_, f64>,
        law: &L,
        threads: usize,
    ) -> Fallible<()> {
        let with = self.registers;
        find_who_may_touch(world)?;
        self.fit(world, threads);

        let cuts = &self.cuts;

        each(
            world.moving(),
            cuts,
            &|m, _| with.run(Drift(m)),
            &Fallible::and,
        )?;

        let (sight, touch, part) = world.pushing(world.dt);
        let hit = with.run(Touch(Summing(sight, part), touch, law));
        let mut sent = None;
        if !cuts.is_empty() {
            let (sight, _, part) = world.pushing(world.dt);
            let sending = Sending(Summing(sight, part), &mut self.outboxes);
            sent = each(
                sending,
                cuts,
                &|s, _| with.run(Spilling(s, law)),
                &first_deep,
            );
        }
        let (sight, _, part) = world.pushing(world.dt);
        let outboxes = &self.outboxes;
        let add = |s, range| with.run(Sum(s, law, outboxes, range));
        let summed = each(Summing(sight, part), cuts, &add, &first_deep);
        judge(world, hit, first_deep(sent, summed))?;

        let fastest = each(world.moving(), cuts, &|m, _| with.run(Kick(m)), &faster)?;
        finish(world, fastest);
        Ok(())
    }

    /// Cuts the grains into ranges of about equal work, and makes room for what they send, whenever
    /// the pair list is new.
    fn fit(&mut self, world: &mut World<'_, f64>, threads: usize) {
        let n = world.grains.count();
        let search = world.clock.searches() as usize;
        let now = Some([search, n, world.clock.listed(), threads, self.range_min]);
        if self.fitted == now {
            return;
        }
        self.fitted = now;
        let ranges = threads.min(n / self.range_min.max(1)).max(1);
        let (sight, _, mut rest) = world.pushing(0.0);
        // A grain costs about as much as a listed pair.
        let work = |i: usize| i + sight.row[i] as usize;
        self.cuts.clear();
        for i in 1..n {
            let done = self.cuts.len() + 1;
            if done < ranges && work(i) * ranges >= work(n) * done {
                self.cuts.push(i);
            }
        }
        self.outboxes.resize_with(ranges, Outbox::default);
        for outbox in &mut self.outboxes {
            // What was sent over other ranges is no part of the next sum.
            outbox.count = 0;
        }
        let mut begin = 0;
        for (&end, outbox) in self.cuts.iter().zip(&mut self.outboxes) {
            let (part, others) = rest.split(end - begin, sight.row);
            let needed = part.spills(sight.row);
            if outbox.spills.len() < needed {
                outbox.spills.resize(needed + needed / 8, Spill::default());
            }
            (begin, rest) = (end, others);
        }
    }
}

/// The larger of two speeds; of faults the lower range's.
fn faster(a: Fallible<f64>, b: Fallible<f64>) -> Fallible<f64> {
    let (a, b) = (a?, b?);
    Ok(if b > a { b } else { a })
}

/// Something for a stretch of grains that splits into two stretches.
trait Split: Sized + Send {
    /// The first `grains` grains, which are `ranges` ranges, and the others.
    fn split(self, grains: usize, ranges: usize) -> (Self, Self);
}

/// Does `work` for each range, side by side, and joins what it returns, lower ranges left. `work` is
/// told the number of its range.
fn each<P: Split, T: Send>(
    piece: P,
    cuts: &[usize],
    work: &(impl Fn(P, usize) -> T + Sync),
    join: &(impl Fn(T, T) -> T + Sync),
) -> T {
    halve(piece, cuts, 0, 0, work, join)
}

/// [`each`] for the ranges from number `range`, which begins at grain `begin`.
fn halve<P: Split, T: Send>(
    piece: P,
    cuts: &[usize],
    begin: usize,
    range: usize,
    work: &(impl Fn(P, usize) -> T + Sync),
    join: &(impl Fn(T, T) -> T + Sync),
) -> T {
    let middle = cuts.len() / 2;
    let Some(&cut) = cuts.get(middle) else {
        return work(piece, range);
    };
    let (left, right) = piece.split(cut - begin, middle + 1);
    let (left, right) = rayon::join(
        || halve(left, &cuts[..middle], begin, range, work, join),
        || {
            halve(
                right,
                &cuts[middle + 1..],
                cut,
                range + middle + 1,
                work,
                join,
            )
        },
    );
    join(left, right)
}

impl Split for Moving<'_, f64> {
    fn split(self, grains: usize, _: usize) -> (Self, Self) {
        Moving::split(self, grains)
    }
}

/// A stretch whose forces are summed.
struct Summing<'a>(Sight<'a, f64>, Part<'a, f64>);

impl Split for Summing<'_> {
    fn split(self, grains: usize, _: usize) -> (Self, Self) {
        let (left, right) = self.1.split(grains, self.0.row);
        (Self(self.0, left), Self(self.0, right))
    }
}

/// A stretch that sends its spills, with an outbox for each of its ranges.
struct Sending<'a>(Summing<'a>, &'a mut [Outbox]);

impl Split for Sending<'_> {
    fn split(self, grains: usize, ranges: usize) -> (Self, Self) {
        let (left, right) = Split::split(self.0, grains, ranges);
        let (out, others) = self.1.split_at_mut(ranges);
        (Self(left, out), Self(right, others))
    }
}

struct Drift<'a>(Moving<'a, f64>);

impl Job for Drift<'_> {
    type Output = Fallible<()>;

    #[inline(always)]
    fn run<const W: usize>(mut self) -> Self::Output {
        kick_and_drift(&mut self.0)
    }
}

struct Kick<'a>(Moving<'a, f64>);

impl Job for Kick<'_> {
    type Output = Fallible<f64>;

    #[inline(always)]
    fn run<const W: usize>(mut self) -> Self::Output {
        kick(&mut self.0)
    }
}

/// All obstacle contacts at once: an obstacle's sum runs over all grains.
struct Touch<'a, L>(Summing<'a>, TouchPart<'a, f64>, &'a L);

impl<L: Law<f64>> Job for Touch<'_, L> {
    type Output = Deep;

    #[inline(always)]
    fn run<const W: usize>(mut self) -> Deep {
        let Summing(sight, part) = self.0;
        push_obstacles(sight, &mut self.1, part.force, part.torque, self.2, |_| {})
    }
}

struct Spilling<'a, L>(Sending<'a>, &'a L);

impl<L: Law<f64>> Job for Spilling<'_, L> {
    type Output = Deep;

    #[inline(always)]
    fn run<const W: usize>(self) -> Deep {
        let Spilling(Sending(Summing(sight, mut part), outboxes), law) = self;
        let [outbox, ..] = outboxes else {
            return None;
        };
        let sent = spill::<f64, L, W>(sight, &mut part, law, &mut outbox.spills);
        let (count, deep) = sent.expect("outboxes fit the list");
        outbox.count = count;
        deep
    }
}

struct Sum<'a, L>(Summing<'a>, &'a L, &'a [Outbox], usize);

impl<L: Law<f64>> Job for Sum<'_, L> {
    type Output = Deep;

    #[inline(always)]
    fn run<const W: usize>(self) -> Deep {
        let Sum(Summing(sight, mut part), law, outboxes, range) = self;
        let lower = outboxes[..range].iter().flat_map(Outbox::sent);
        let own = outboxes.get(range).map_or(&[][..], Outbox::sent);
        sum::<f64, L, W>(sight, &mut part, law, lower, own, |_| {})
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{AnyLaw, Grain, Sim};
    use bitgrain_kernel::law::HertzHistory;
    use bitgrain_kernel::{Domain, Group};

    /// Eight grains in a row along x, of diameter 1 and 2 apart, that move along z or x as told.
    fn row(velocity: impl Fn(u32) -> [f64; 3]) -> Sim {
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
        let mut sim = Sim::new(
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

    /// The fault that ends a row, and after how many steps, on so many threads.
    fn end(threads: usize, velocity: impl Fn(u32) -> [f64; 3]) -> (Option<Fault>, u64) {
        let mut sim = row(velocity);
        let ended = on_threads(threads, || sim.steps(2000)).unwrap();
        (ended.err(), sim.step_count())
    }

    /// The search comes when the fastest grain of any range needs it: a missed contact would end
    /// with grains in each other or past each other.
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

    /// Of several faults in one step the lowest grain's is told, whichever range finds it.
    #[test]
    fn faults_are_those_of_one_range() {
        // Grains 3, 5 and 8 leave the box through the top at the same step.
        let leaves = |id: u32| [0.0, 0.0, if [3, 5, 8].contains(&id) { 10.0 } else { 0.0 }];
        // Grains 4 and 7 hit the ones before them too fast for their stiffness.
        let hits = |id: u32| [if [4, 7].contains(&id) { -300.0 } else { 0.0 }, 0.0, 0.0];
        let (first, second) = (end(1, leaves), end(1, hits));
        assert_eq!(first.0, Some(Fault::Escaped { id: 3 }));
        assert_eq!(second.0, Some(Fault::OverlapTooDeep { i: 3, j: 4 }));
        for threads in [2, 3, 5, 8] {
            assert_eq!(end(threads, leaves), first);
            assert_eq!(end(threads, hits), second);
        }
    }
}
