//! The phases of a step one by one: contact block, picking of near pairs, search, motion; on a
//! lattice of 8,000 grains that all touch. `cargo bench -p bitgrain-sim --features benches`.

use std::hint::black_box;

use bitgrain_kernel::conformance::{self, Room};
use bitgrain_kernel::contact::{HertzHistory, HertzTsuji, Law};
use bitgrain_kernel::fixed_point::I32F32;
use bitgrain_kernel::phases::{
    After, GrainRange, MotionPhase, accumulate, begin, ensure_pair_list_ahead, integrate, no_fetch,
    seal,
};
use bitgrain_kernel::{ContactHistory, Domain, Group, Real, World};
use bitgrain_kernel::{resume, start, step};
use bitgrain_sim::owned_world::OwnedWorld;
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use multiversion::multiversion;

/// Grains along each side of the lattice, a little closer than their diameter of 1.
const SIDE: usize = 20;
const SPACING: f64 = 0.999;
const GRAINS: usize = SIDE * SIDE * SIDE;
/// Entries lent to the lists: each grain touches six others, and a half list has three of them.
const ENTRIES: usize = 12 * GRAINS;

const HISTORY: HertzHistory<f64> = HertzHistory {
    kn: 2e5,
    kt: 2.45e5,
    gamma_n: 792.0,
    gamma_t: 792.0,
    mu: 0.5,
};

/// The lattice, moving a little, not yet started.
fn lattice(skin: f64, reach: f64) -> OwnedWorld<f64> {
    let length = SIDE as f64 * SPACING;
    let domain = Domain::new([0.0; 3], [length; 3], [true; 3]).expect("a box");
    let mut bed = OwnedWorld::new(domain, 1e-4);
    (bed.skin, bed.outer_skin) = (skin, reach);
    bed.groups.push(Group::free([0.0; 3]));
    for k in 0..GRAINS {
        let place = |k: usize| (k as f64 + 0.5) * SPACING;
        let [x, y, z] = [k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)].map(place);
        // Small motions that differ from grain to grain.
        let wobble = |k: usize| [0.01 * (k % 7) as f64, 0.01 * (k % 5) as f64, 0.0];
        let [u, v, w] = wobble(k);
        bed.add(
            k as u32 + 1,
            0,
            [x, y, z, 0.5],
            [u, v, w, 0.5],
            wobble(k + 3),
        );
    }
    bed.cell_start.resize(2 * GRAINS, 0);
    bed.cell_grain.resize(GRAINS, 0);
    bed.candidate_row.resize(GRAINS + 1, 0);
    bed.reserve(ENTRIES, ENTRIES, ENTRIES)
        .expect("room for a lattice");
    bed
}

/// A started bed and how many pairs it lists, which all touch.
fn started() -> (OwnedWorld<f64>, usize) {
    let mut bed = lattice(0.01, 0.1);
    let mut world = bed.world();
    start(&mut world, &HISTORY).expect("a sound lattice");
    let pairs = world.clock.listed();
    assert_eq!(pairs, 3 * GRAINS, "six neighbours each");
    assert_eq!(world.contact_histories().count(), pairs, "and all touch");
    (bed, pairs)
}

// As in a host: one monomorphic copy for each law and instruction set.
#[multiversion(targets("x86_64+avx2"))]
fn sum_history(part: &mut GrainRange<'_, f64>, law: &HertzHistory<f64>) {
    sum_all(part, law);
}

#[multiversion(targets("x86_64+avx2"))]
fn sum_tsuji(part: &mut GrainRange<'_, f64>, law: &HertzTsuji<f64>) {
    sum_all(part, law);
}

/// Evaluates and sums all pairs of a world.
#[inline(always)]
fn sum_all<L: Law<f64>>(part: &mut GrainRange<'_, f64>, law: &L) {
    black_box(accumulate(part, law, |_| {}, no_fetch(), After::Stay));
}

#[multiversion(targets("x86_64+avx2"))]
fn move_all(world: &mut World<'_, f64>) {
    black_box(integrate(
        &mut world.grain_motion(),
        MotionPhase::KickAndDrift,
    ));
}

/// Filling, law and sums of pairs that all touch; springs do not advance, so that every call does the
/// same.
fn contact_block(c: &mut Criterion) {
    let (mut bed, pairs) = started();
    let mut group = c.benchmark_group("contact block, per contact");
    group.throughput(Throughput::Elements(pairs as u64));
    let mut world = bed.world();
    group.bench_function("hertz_history", |b| {
        b.iter(|| sum_history(black_box(&mut world.force_ranges(0.0).0), &HISTORY));
    });
    let tsuji = HertzTsuji::new(2e5, 0.3, 0.6, 0.5);
    group.bench_function("hertz_tsuji", |b| {
        b.iter(|| sum_tsuji(black_box(&mut world.force_ranges(0.0).0), &tsuji));
    });
    group.finish();
}

/// Near pairs picked from the candidates: without a skin every step does so.
fn picking(c: &mut Criterion) {
    let mut bed = lattice(0.0, 0.5);
    let mut world = bed.world();
    start(&mut world, &HISTORY).expect("a sound lattice");
    let candidates = world.candidates.row[GRAINS];
    let mut group = c.benchmark_group("picking, per candidate");
    group.throughput(Throughput::Elements(u64::from(candidates)));
    let before = world.clock.outer_list_rebuilds();
    let sealed = seal(&world.grain_motion(), 0);
    begin(&mut world, sealed).expect("a world at rest");
    group.bench_function("near pairs", |b| {
        b.iter(|| ensure_pair_list_ahead(black_box(&mut world)).expect("room enough"));
        assert!(world.clock.prunes() > 1, "and pairs were picked");
    });
    assert_eq!(world.clock.outer_list_rebuilds(), before, "candidates held");
    group.finish();
}

/// The search; with it, as always on taking up a state, the checks.
fn rebuild(c: &mut Criterion) {
    let (mut bed, _) = started();
    let mut group = c.benchmark_group("rebuild, per grain");
    group.throughput(Throughput::Elements(GRAINS as u64));
    let mut world = bed.world();
    let no_histories: [ContactHistory<f64>; 0] = [];
    group.bench_function("search", |b| {
        b.iter(|| resume(black_box(&mut world), no_histories).expect("a sound state"));
    });
    group.finish();
}

/// The end of a step and the beginning of the next, of grains that nothing pushes.
fn motion(c: &mut Criterion) {
    let (mut bed, _) = started();
    let mut group = c.benchmark_group("motion, per grain");
    group.throughput(Throughput::Elements(GRAINS as u64));
    let mut world = bed.world();
    group.bench_function("kick and drift", |b| {
        b.iter(|| move_all(black_box(&mut world)));
    });
    group.finish();
}

/// A step of the reference bed, by number type.
fn types(c: &mut Criterion) {
    let mut group = c.benchmark_group("number types, per grain");
    group.throughput(Throughput::Elements(21));
    of_type::<f64>(&mut group);
    of_type::<f32>(&mut group);
    of_type::<I32F32>(&mut group);
    group.finish();
}

fn of_type<R: Real>(group: &mut BenchmarkGroup<'_, WallTime>) {
    let mut room = Box::new(Room::<R>::vacant());
    let laid = conformance::World::Bed.lay(&mut room);
    laid.expect("a reference world fits");
    let law = conformance::history::<R>(300.0);
    let mut world = room.world();
    start(&mut world, &law).expect("a sound state");
    group.bench_function(R::NAME, |b| {
        b.iter(|| step(black_box(&mut world), &law).expect("a sound step"));
    });
}

criterion_group!(benches, contact_block, picking, rebuild, motion, types);
criterion_main!(benches);
