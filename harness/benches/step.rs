//! Whole steps of a settled bed: `cargo bench -p bitgrain`.

use std::hint::black_box;
use std::path::Path;

use bitgrain::bench::read_bed;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn steps(c: &mut Criterion) {
    let bed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../golden/peers/bed200.data");
    let mut sim = read_bed(&bed).expect("the golden bed is sound");
    sim.start().expect("the golden bed is sound");
    sim.steps(500).expect("the golden bed is sound");
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(sim.count() as u64));
    group.bench_function("bed of 200, hertz_history", |b| {
        b.iter(|| black_box(&mut sim).steps(1).expect("a settled bed"));
    });
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
