//! A host with its own threads: two ranges of grains, a thread for each, give the bits of one range.
//! `cargo run -p bitgrain-kernel --example threaded_host`

use std::thread;

use bitgrain_kernel::contact::{HertzHistory, Law};
use bitgrain_kernel::phases::{
    After, CrossRangeForce, MotionCheck, MotionPhase, accumulate, begin, check_overlaps,
    cross_range, drift, end, ensure_pair_list, finish, integrate, no_fetch, obstacle_forces, seal,
};
use bitgrain_kernel::{
    Domain, Error, Group, NEIGHBORS, Obstacle, Store, StretchList, World, digest, start, step,
};

const GRAINS: usize = 64;
type Bed = Store<f64, GRAINS, 1024, 128, 1>;

/// Sixty-four grains of three sizes over a floor.
fn bed() -> Result<Bed, Error> {
    let domain = Domain::new([0.0; 3], [5.0, 5.0, 20.0], [true, true, false])?;
    let mut bed = Bed::new(domain, 5e-4, 0.2);
    bed.add_group(Group::free([0.0, 0.0, -1.0]))
        .expect("room for a group");
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    bed.add_obstacle(floor).expect("room for a floor");
    for k in 0..GRAINS as u32 {
        let [x, y, z] = [k % 4, k / 4 % 4, k / 16].map(|n| 0.6 + 1.2 * f64::from(n));
        let radius = 0.4 + 0.05 * f64::from(k % 3);
        let mass = 4.1888 * radius * radius * radius;
        bed.add_grain(k + 1, 0, [x, y, z], radius, mass)
            .expect("room for a grain");
    }
    Ok(bed)
}

/// One step of a world over the ranges that its `range_bounds` make, a thread for each.
fn step_on_threads(world: &mut World<'_, f64>, law: &impl Law<f64>) -> Result<(), Error> {
    let sealed = seal(&world.grain_motion(), 0);
    begin(world, sealed)?;
    let moved = integrate(&mut world.grain_motion(), MotionPhase::Drift);
    drift(world, moved)?;
    ensure_pair_list(world)?;

    let dt = world.dt;
    let (mut all, mut touching) = world.force_ranges(dt);
    let hit = obstacle_forces(&mut all, &mut touching, law, |_| {});
    // Pairs of two ranges are evaluated once; each range then adds its own share of them, in the written order.
    let (view, pairs) = world.cross_range_pairs();
    let mut between = vec![CrossRangeForce::default(); pairs.len()];
    let deep = cross_range(view, pairs, law, &mut between);

    let middle = world.range_bounds[0] as usize;
    let (all, _) = world.force_ranges(dt);
    let (left, right) = all.split(middle);
    let sums = thread::scope(|scope| {
        let threads = [left, right].map(|mut range| {
            let between = &between;
            scope.spawn(move || {
                let own = range.first..range.first + range.grains.count();
                let has = |place: u32| own.contains(&(place as usize));
                let lower = between.iter().filter(|force| has(force.j));
                let upper: Vec<_> = between
                    .iter()
                    .copied()
                    .filter(|force| has(force.i))
                    .collect();
                accumulate(
                    &mut range,
                    law,
                    lower,
                    &upper,
                    |_| {},
                    no_fetch(),
                    After::Rest,
                )
            })
        });
        threads.map(|thread| thread.join().expect("a range does not panic"))
    });
    let (mut deepest, mut moved) = (deep, MotionCheck::NONE);
    for (within, range) in sums {
        (deepest, moved) = (within.or(deepest), moved.and(range));
    }
    check_overlaps(world, hit, deepest)?;
    finish(world, moved)?;
    let sealed = seal(&world.grain_motion(), 0);
    end(world, sealed)
}

/// # Errors
/// What the kernel refuses.
pub fn main() -> Result<(), Error> {
    let law = HertzHistory {
        kn: 2e4,
        kt: 2e4,
        gamma_n: 100.0,
        gamma_t: 100.0,
        mu: 0.5,
    };
    let (mut one, mut two) = (bed()?, bed()?);
    let (mut alone, mut shared) = (one.world(), two.world());
    shared.range_bounds = &[30];
    // No stretch of grains is in two ranges, so there are two at least.
    let (mut words, mut numbers) = ([0; 2 * (4 + NEIGHBORS) + 2], [0.0; 6]);
    shared.stretches = StretchList::new(&mut words, &mut numbers);
    start(&mut alone, &law)?;
    start(&mut shared, &law)?;
    for _ in 0..2000 {
        step(&mut alone, &law)?;
        step_on_threads(&mut shared, &law)?;
    }
    assert_eq!(digest(&alone), digest(&shared));
    println!(
        "the same bits after 2000 steps: {:02x?}",
        &digest(&alone).whole[..8]
    );
    Ok(())
}
