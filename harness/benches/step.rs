//! Whole steps of settled beds: sizes from 3,200 to a million grains, one thread and two, both laws.
//! `cargo bench -p bitgrain`; a part of it with `cargo bench -p bitgrain -- "3200"`.

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use bitgrain::bench::{read_bed, tiled};
use bitgrain::simulation::{AnyLaw, Simulation};
use bitgrain::threads::on_threads;
use bitgrain_kernel::contact::HertzTsuji;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// The golden bed of 200 grains, repeated along x and along y, started and stepped so that its lists
/// and their skin have settled.
fn bed(tiles: usize, law: Option<AnyLaw>) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../golden/peers/bed200.data");
    let one = read_bed(&path).expect("the golden bed is sound");
    let mut sim = tiled(&one, tiles).expect("a box");
    sim.law = law.unwrap_or(sim.law);
    sim.start().expect("the tiled bed is sound");
    sim.steps(200).expect("the tiled bed is settled");
    sim
}

/// Some steps in one call, as a run does them, on this many threads.
fn stepped(sim: &mut Simulation, threads: usize, calls: u64) -> Duration {
    let steps = || {
        let began = Instant::now();
        black_box(&mut *sim).steps(calls).expect("a settled bed");
        began.elapsed()
    };
    on_threads(threads, steps).expect("threads")
}

fn sizes(c: &mut Criterion) {
    let mut group = c.benchmark_group("step, hertz_history, per grain");
    group.sample_size(10);
    for tiles in [4, 7, 16, 32, 71] {
        let mut sim = bed(tiles, None);
        group.throughput(Throughput::Elements(sim.count() as u64));
        for threads in [1, 2] {
            let name = BenchmarkId::new(format!("{threads} thread(s)"), sim.count());
            group.bench_function(name, |b| {
                b.iter_custom(|calls| stepped(&mut sim, threads, calls));
            });
        }
    }
    group.finish();
}

fn other_law(c: &mut Criterion) {
    // About as stiff as the other.
    let law = AnyLaw::HertzTsuji(HertzTsuji::new(2e5, 0.3, 0.6, 0.5));
    let mut sim = bed(7, Some(law));
    let mut group = c.benchmark_group("step, hertz_tsuji, per grain");
    group.sample_size(10);
    group.throughput(Throughput::Elements(sim.count() as u64));
    let name = BenchmarkId::new("1 thread(s)", sim.count());
    group.bench_function(name, |b| {
        b.iter_custom(|calls| stepped(&mut sim, 1, calls));
    });
    group.finish();
}

criterion_group!(benches, sizes, other_law);
criterion_main!(benches);
