//! Whole steps of settled beds: sizes from 3,200 to a million grains, one thread and two, both laws, several materials,
//! rolling. `cargo bench -p bitgrain --features benches`, and for a part of it `-- "3200"` behind that.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bitgrain::bench::{read_bed, tiled};
use bitgrain::law::Pairs;
use bitgrain::simulation::{AnyLaw, Simulation};
use bitgrain::threads::on_threads;
use bitgrain_kernel::contact::{HertzTsuji, RollingResistance, RollingSpring};
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

/// The other law, and both with the numbers of one material and of three.
fn laws(c: &mut Criterion) {
    let mut group = c.benchmark_group("step, 1 thread, per grain");
    group.sample_size(10);
    // About as stiff as the bed's.
    let tsuji = HertzTsuji::new(2e5, 0.3, 0.6, 0.5);
    let AnyLaw::HertzHistory(history) = bed(1, None).law else {
        panic!("the golden bed is of hertz_history");
    };
    let laws = [
        ("hertz_history", AnyLaw::HertzHistory(history)),
        (
            "hertz_history, 3 materials",
            AnyLaw::HertzHistoryPairs(table(history)),
        ),
        ("hertz_tsuji", AnyLaw::HertzTsuji(tsuji)),
        (
            "hertz_tsuji, 3 materials",
            AnyLaw::HertzTsujiPairs(table(tsuji)),
        ),
    ];
    let rolling = |spring| {
        let resistance = RollingResistance {
            spring,
            k: 2e3,
            gamma: 1.0,
            mu: 0.1,
        };
        let one = Pairs::new(1, vec![tsuji]).expect("one law");
        AnyLaw::HertzTsujiRolling(Arc::new(one.rolling(&[resistance])))
    };
    let laws = laws.into_iter().chain([
        ("hertz_tsuji, sds", rolling(RollingSpring::Sds)),
        ("hertz_tsuji, epsd2", rolling(RollingSpring::Epsd2)),
    ]);
    for (name, law) in laws {
        let mut sim = bed(7, Some(law));
        group.throughput(Throughput::Elements(sim.count() as u64));
        group.bench_function(BenchmarkId::new(name, sim.count()), |b| {
            b.iter_custom(|calls| stepped(&mut sim, 1, calls));
        });
    }
    group.finish();
}

/// Three materials with the same numbers, so that the bed is the same.
fn table<L: Copy>(law: L) -> Arc<Pairs<L>> {
    Arc::new(Pairs::new(3, vec![law; 6]).expect("six pairs"))
}

criterion_group!(benches, sizes, laws);
criterion_main!(benches);
