//! A host with its own threads: a world in two parts, a thread for each, gives the bits of one thread.
//! `cargo run -p bitgrain-kernel --example threaded_host`

use std::{sync::Barrier, sync::Mutex, thread};

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::parts::{
    GhostMotion, drift_own, is_search_due, restore, search_and_list, take_in, take_lists,
};
use bitgrain_kernel::phases::{
    After, Extent, ForceCheck, MotionCheck, ObstacleShare, accumulate, begin, check_forces, drift,
    end, ensure_pair_list, finish, measure, no_fetch, obstacle_forces, seal, sum_on_obstacles,
};
use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{
    ContactHistory, Domain, Error, Group, Obstacle, Store, TOUCHING, World, conformance, digest,
    start, step,
};

const GRAINS: usize = 64;
/// Room enough: a list that was full in one part alone would leave the other one waiting.
type Bed = Store<f64, GRAINS, 1024, 128, 1>;

/// Sixty-four grains of three sizes over a floor.
fn bed() -> Result<Box<Bed>, Error> {
    let domain = Domain::new([0.0; 3], [5.0, 5.0, 20.0], [true, true, false])?;
    let mut bed = Box::new(Bed::new(domain, 5e-4, 0.05));
    bed.set_outer_skin(0.2);
    let (down, up) = ([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]);
    bed.add_group(Group::free(down)).expect("room");
    let floor = Obstacle::plane([0.0; 3], up);
    bed.add_obstacle(floor).expect("room");
    for k in 0..GRAINS as u32 {
        let [x, y, z] = [k % 4, k / 4 % 4, k / 16].map(|n| 0.6 + 1.2 * f64::from(n));
        let radius = 0.4 + 0.05 * f64::from(k % 3);
        bed.add_grain(k + 1, 0, [x, y, z], radius, 4.0 * radius * radius * radius)?;
    }
    Ok(bed)
}

/// Places of a part's own grains, one half of them, or of its ghosts: in a large world only those near own ones.
fn places(part: usize, own: bool) -> Vec<u32> {
    let is_own = |k: &u32| (k % 4 / 2) as usize == part;
    (0..GRAINS as u32).filter(|k| is_own(k) == own).collect()
}

/// What a part found, and how far its grains reach.
type Found = (MotionCheck<f64>, ForceCheck, Extent<f64>);

type Shown = Mutex<Option<(Found, Vec<GhostMotion<f64>>)>>;
/// Where two threads show each other what they found and how their grains move.
struct Board(Barrier, [Shown; 2]);

impl Board {
    /// Shows what a part has, and takes in the ghosts that the other one shows. What both found comes back.
    fn exchange(
        &self,
        (part, world): (usize, &mut World<'_, f64>),
        (moved, found): (MotionCheck<f64>, ForceCheck),
    ) -> Found {
        let g = &world.grains;
        let all = [&g.position, &g.velocity, &g.spin];
        let motion = |k: &u32| all.map(|rows| head(rows[*k as usize]));
        let mine = (moved, found, measure(world));
        let ghosts = places(part, true).iter().map(motion).collect();
        *self.1[part].lock().unwrap() = Some((mine, ghosts));
        self.0.wait();
        let shown = self.1[1 - part].lock().unwrap().take();
        let (other, ghosts) = shown.expect("both have shown theirs");
        // Nobody shows something else before all have seen this.
        self.0.wait();
        take_in(world, &places(part, false), &ghosts);
        (moved.and(other.0), found.and(other.1), mine.2.and(other.2))
    }
}

/// The steps of one part. What its contacts took from the forces on obstacles in the last one comes back, by grains.
fn steps_of_part(
    (part, world): (usize, &mut World<'_, f64>),
    histories: &[ContactHistory<f64>],
    board: &Board,
    law: &impl Law<f64>,
    count: u64,
) -> Result<Vec<(u32, ObstacleShare<f64>)>, Error> {
    let (mut all, moved) = (Vec::new(), drift_own(world));
    let (mut moved, _, mut extent) = board.exchange((part, world), (moved, ForceCheck::NONE));
    for n in 1..=count {
        drift(world, moved)?;
        match is_search_due(world) {
            true => search_and_list(world, &extent)?,
            false => ensure_pair_list(world)?,
        }
        if n == 1 {
            restore(world, histories.iter().copied())?;
        }
        let after = [After::FinishAndBegin, After::Rest][usize::from(n == count)];
        let (mut grains, mut touch) = world.force_ranges(world.dt);
        let mut shares = vec![ObstacleShare::default(); touch.grain.len()];
        touch.shares = &mut shares;
        let hit = obstacle_forces(&mut grains, &mut touch, law, |_| {});
        let (deep, own) = accumulate(&mut grains, law, |_| {}, no_fetch::<f64>(), after);
        let taken = touch.shares.iter().copied();
        all = touch.grain.iter().copied().zip(taken).collect();
        let found;
        (moved, found, extent) = board.exchange((part, world), (own, hit.and(deep)));
        check_forces(world, found)?;
        finish(world, moved)?;
    }
    Ok(all)
}

/// Several steps of a world, in two parts with a thread for each; `beds` is storage for them.
fn steps_on_threads(
    world: &mut World<'_, f64>,
    beds: &mut [Box<Bed>; 2],
    law: &impl Law<f64>,
    count: u64,
) -> Result<(), Error> {
    let sealed = seal(&world.grain_motion(), 0);
    begin(world, sealed)?;
    let histories: Vec<_> = world.contact_histories().collect();
    let board = Board(Barrier::new(2), Default::default());
    // Runs of own grains are two grains long here.
    let run = |[a, b]: &[u32; 2]| [*a, b + 1];
    let runs = |own: Vec<u32>| own.as_chunks().0.iter().flat_map(run).collect::<Vec<_>>();
    let owned = [0, 1].map(|part| runs(places(part, true)));
    let mut parts = beds.each_mut().map(|bed| bed.world());
    for (part, runs) in parts.iter_mut().zip(&owned) {
        part.owned = runs;
        (0..GRAINS).for_each(|k| copy_rows(world, part, k));
        part.obstacles.copy_from_slice(world.obstacles);
        *part.clock = world.clock.of_part(GRAINS);
    }
    let [left, right] = &mut parts;
    let work = |part, world| steps_of_part((part, world), &histories, &board, law, count);
    let (left, right) = thread::scope(|scope| {
        let other = scope.spawn(|| work(1, right));
        (work(0, left), other.join().expect("a part does not panic"))
    });
    let mut shares = [left?, right?].concat();
    shares.sort_by_key(|(grain, _)| *grain);
    let (mut pairs, mut contacts) = (Vec::new(), Vec::new());
    for (number, part) in parts.iter_mut().enumerate() {
        let own = places(number, true);
        own.iter().for_each(|k| copy_rows(part, world, *k as usize));
        for contact in part.kept_contacts() {
            let kept = contact.kept();
            match contact.history {
                ContactHistory::Pair { i, j, .. } => pairs.push((i, j, kept)),
                // The floor is obstacle 0.
                ContactHistory::Obstacle { i, .. } => contacts.push((i, TOUCHING, kept)),
            }
        }
    }
    pairs.sort_by_key(|(i, j, _)| (*i, *j));
    // Both parts have evaluated a pair of one grain of each.
    pairs.dedup_by_key(|(i, j, _)| (*i, *j));
    contacts.sort_by_key(|(i, ..)| *i);
    world.obstacles.copy_from_slice(parts[0].obstacles);
    sum_on_obstacles(world.obstacles, shares.into_iter().map(|(_, share)| share));
    world.clock.rejoin(parts[0].clock, 0, 0);
    take_lists(world, pairs.into_iter(), contacts.into_iter())?;
    let sealed = seal(&world.grain_motion(), 0);
    end(world, sealed)
}

/// Copies all that moves of a grain.
fn copy_rows(from: &World<'_, f64>, to: &mut World<'_, f64>, k: usize) {
    let (from, to) = (&from.grains, &mut to.grains);
    to.position[k] = from.position[k];
    to.velocity[k] = from.velocity[k];
    to.spin[k] = from.spin[k];
    to.force[k] = from.force[k];
    to.torque[k] = from.torque[k];
    to.image[k] = from.image[k];
}

/// # Errors
/// What the kernel refuses.
pub fn main() -> Result<(), Error> {
    let law = conformance::history(100.0);
    let (mut one, mut two, mut parts) = (bed()?, bed()?, [bed()?, bed()?]);
    let (mut alone, mut shared) = (one.world(), two.world());
    start(&mut alone, &law)?;
    start(&mut shared, &law)?;
    for _ in 0..4 {
        (0..500).try_for_each(|_| step(&mut alone, &law))?;
        steps_on_threads(&mut shared, &mut parts, &law, 500)?;
        assert_eq!(digest(&alone)?, digest(&shared)?);
    }
    println!("{:02x?} after 2000 steps", digest(&alone)?.whole);
    Ok(())
}
