//! The phases of a step one by one, beside the whole step: filter, contacts, sums and search, on a
//! settled bed of 3,200 grains. `cargo bench -p bitgrain --bench phases`.

use std::hint::black_box;
use std::path::Path;

use bitgrain::bench::{read_bed, soft_law};
use bitgrain::sim::{AnyLaw, Grain, Sim};
use bitgrain_kernel::law::{Contact, HertzHistory, HertzTsuji, Law, Reaction};
use bitgrain_kernel::push::{LANES, Part, Sight, Spill, spill, sum};
use bitgrain_kernel::vec3::{Vec3, dot, head, scale, sub};
use bitgrain_kernel::{Bond, Domain, World};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use multiversion::multiversion;

/// Copies of the golden bed side by side, along x and along y.
const TILES: [usize; 2] = [4, 4];

/// The golden bed of 200 grains, repeated across its periods and stretched by `stretch`, without
/// its intruder; started and stepped `steps` times.
fn bed(stretch: f64, steps: u64) -> Sim {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../golden/peers/bed200.data");
    let one = read_bed(&path).expect("the golden bed is sound");
    let (lo, hi) = (one.domain.lo(), one.domain.hi());
    let mut grains = Vec::new();
    for tile in 0..TILES[0] * TILES[1] {
        let tile = [tile % TILES[0], tile / TILES[0]];
        for i in 0..one.count() {
            let x = one.position[i];
            let across = |a: usize| x[a] + tile[a] as f64 * (hi[a] - lo[a]);
            let radius = x[3];
            let volume = std::f64::consts::PI / 0.75 * (radius * radius * radius);
            grains.push(Grain {
                id: grains.len() as u32 + 1,
                group: one.group[i],
                diameter: 2.0 * radius,
                density: one.velocity[i][3] / volume,
                position: scale([across(0), across(1), x[2]], stretch),
                velocity: head(one.velocity[i]),
                spin: head(one.spin[i]),
            });
        }
    }
    let far = |a: usize| lo[a] + TILES[a] as f64 * (hi[a] - lo[a]);
    let (lo, hi) = (scale(lo, stretch), scale([far(0), far(1), hi[2]], stretch));
    let domain = Domain::new(lo, hi, one.domain.periodic()).expect("a sound box");
    let mut sim = Sim::new(one.law, domain, one.dt, one.groups, &grains, Vec::new());
    sim.start().expect("the tiled bed is sound");
    sim.steps(steps).expect("the tiled bed is settled");
    sim
}

/// The softened law of Kumar 2018.
fn history() -> HertzHistory<f64> {
    match soft_law().build() {
        Ok(AnyLaw::HertzHistory(law)) => law,
        other => panic!("the soft law is of this kind, not {other:?}"),
    }
}

/// The law of Guillard 2014, about as stiff.
fn tsuji() -> HertzTsuji<f64> {
    HertzTsuji::new(2e5, 0.3, 0.6, 0.5)
}

/// Evaluates and sums all listed pairs. Springs do not advance, so that every call does the same.
#[inline(always)]
fn sum_pairs<L: Law<f64>>(world: &mut World<'_, f64>, law: &L) {
    let (sight, _, mut part) = world.pushing(0.0);
    // What the obstacles' pass does where there are none.
    part.force.fill([0.0; 4]);
    part.torque.fill([0.0; 4]);
    let none = std::iter::empty();
    black_box(sum::<f64, L, LANES>(
        sight,
        &mut part,
        law,
        none,
        &[],
        |_| {},
    ));
}

/// The law alone, over an array of contacts.
#[inline(always)]
fn react_all<L: Law<f64>>(
    law: &L,
    contacts: &[(Contact<f64>, Vec3<f64>)],
    out: &mut [Reaction<f64>],
) {
    for ((contact, spring), reaction) in contacts.iter().zip(out) {
        *reaction = law.react(contact, *spring, 0.0);
    }
}

// As in the simulation: one monomorphic copy for each law and instruction set.
#[multiversion(targets("x86_64+avx2"))]
fn sum_history(world: &mut World<'_, f64>, law: &HertzHistory<f64>) {
    sum_pairs(world, law);
}

#[multiversion(targets("x86_64+avx2"))]
fn sum_tsuji(world: &mut World<'_, f64>, law: &HertzTsuji<f64>) {
    sum_pairs(world, law);
}

#[multiversion(targets("x86_64+avx2"))]
fn react_history(
    law: &HertzHistory<f64>,
    contacts: &[(Contact<f64>, Vec3<f64>)],
    out: &mut [Reaction<f64>],
) {
    react_all(law, contacts, out);
}

#[multiversion(targets("x86_64+avx2"))]
fn react_tsuji(
    law: &HertzTsuji<f64>,
    contacts: &[(Contact<f64>, Vec3<f64>)],
    out: &mut [Reaction<f64>],
) {
    react_all(law, contacts, out);
}

/// Pairs that are listed and never touch, so that nothing passes the filter.
fn filter(c: &mut Criterion) {
    let mut sim = bed(1.04, 0);
    assert_eq!(sim.bonds().len(), 0, "the stretched bed has no contacts");
    let listed = sim.search_counts().1;
    assert!(listed > 2 * sim.count(), "but {listed} pairs are listed");
    let mut group = c.benchmark_group("filter, per listed pair");
    group.throughput(Throughput::Elements(listed as u64));
    let law = history();
    group.bench_function("none touches", |b| {
        let mut world = sim.world();
        b.iter(|| sum_history(black_box(&mut world), &law));
    });
    group.finish();
}

/// The touching pairs of a world as the law sees them, with their springs.
fn contacts(sim: &mut Sim) -> Vec<(Contact<f64>, Vec3<f64>)> {
    let bonds = sim.bonds();
    let pairs = bonds.iter().filter_map(|bond| match *bond {
        Bond::Pair { i, j, spring } => Some((i as usize, j as usize, spring)),
        Bond::Touch { .. } => None,
    });
    let contact = |(i, j, spring): (usize, usize, Vec3<f64>)| {
        let (x, y) = (sim.position[i], sim.position[j]);
        let d = sim.domain.separation(head(x), head(y));
        let distance = dot(d, d).sqrt();
        let contact = Contact {
            normal: scale(d, 1.0 / distance),
            overlap: (x[3] + y[3]) - distance,
            radius_i: x[3],
            radius_j: y[3],
            radius_effective: (x[3] * y[3]) / (x[3] + y[3]),
            mass_effective: 1.0 / (sim.spin[i][3] + sim.spin[j][3]),
            velocity: sub(head(sim.velocity[i]), head(sim.velocity[j])),
            spin_i: head(sim.spin[i]),
            spin_j: head(sim.spin[j]),
        };
        (contact, spring)
    };
    // Contacts may open in the last drift of all: the law is not asked about those.
    pairs.map(contact).filter(|c| c.0.overlap > 0.0).collect()
}

/// The law alone, and whole blocks: filter, gather, law and sums of pairs that nearly all touch.
fn contact_block(c: &mut Criterion) {
    let mut sim = bed(1.0, 500);
    let touching = contacts(&mut sim);
    let mut group = c.benchmark_group("contact, per contact");
    group.throughput(Throughput::Elements(touching.len() as u64));
    let nothing = Reaction {
        normal: 0.0,
        tangential: [0.0; 3],
        spring: [0.0; 3],
        arm_i: 0.0,
        arm_j: 0.0,
    };
    let mut out = vec![nothing; touching.len()];
    let (kumar, guillard) = (history(), tsuji());
    group.bench_function("law alone, hertz_history", |b| {
        b.iter(|| react_history(&kumar, black_box(&touching), black_box(&mut out)));
    });
    group.bench_function("law alone, hertz_tsuji", |b| {
        b.iter(|| react_tsuji(&guillard, black_box(&touching), black_box(&mut out)));
    });
    // Listed again without a skin, so that hardly a pair is listed that does not touch.
    let bonds = sim.bonds();
    sim.skin = 0.0;
    sim.resume(&bonds).expect("the same state");
    group.throughput(Throughput::Elements(bonds.len() as u64));
    group.bench_function("whole block, hertz_history", |b| {
        let mut world = sim.world();
        b.iter(|| sum_history(black_box(&mut world), &kumar));
    });
    group.bench_function("whole block, hertz_tsuji", |b| {
        let mut world = sim.world();
        b.iter(|| sum_tsuji(black_box(&mut world), &guillard));
    });
    group.finish();
}

/// Every contact of a world as a spill: each grain is a range of its own.
fn spills(world: &mut World<'_, f64>, law: &HertzHistory<f64>) -> Vec<Spill<f64>> {
    let (sight, _, mut rest) = world.pushing(0.0);
    let mut all = Vec::new();
    while !rest.rows.is_empty() {
        let (mut part, others) = rest.split(1, sight.row);
        let mut out = vec![Spill::default(); part.spills(sight.row)];
        let spilt = spill::<_, _, LANES>(sight, &mut part, law, &mut out);
        let (count, _) = spilt.expect("as many as pairs");
        all.extend_from_slice(&out[..count]);
        rest = others;
    }
    all
}

/// Forces of contacts that were evaluated before, gathered into their two grains.
fn sums(c: &mut Criterion) {
    let mut sim = bed(1.0, 500);
    let law = history();
    let mut world = sim.world();
    let all = spills(&mut world, &law);
    assert!(all.len() > world.grains.count(), "a settled bed touches");
    let no_rows = vec![0; world.grains.count() + 1];
    let mut group = c.benchmark_group("sums, per contact");
    group.throughput(Throughput::Elements(all.len() as u64));
    group.bench_function("gather spills", |b| {
        b.iter(|| gather(black_box(&mut world), &law, &no_rows, &all));
    });
    group.finish();
}

#[multiversion(targets("x86_64+avx2"))]
fn gather(
    world: &mut World<'_, f64>,
    law: &HertzHistory<f64>,
    no_rows: &[u32],
    all: &[Spill<f64>],
) {
    let g = &mut world.grains;
    g.force.fill([0.0; 4]);
    g.torque.fill([0.0; 4]);
    let sight = Sight {
        domain: world.domain,
        position: g.position,
        velocity: g.velocity,
        spin: g.spin,
        row: no_rows,
        dt: 0.0,
    };
    let mut part = Part {
        rows: 0..g.position.len(),
        force: g.force,
        torque: g.torque,
        partner: &mut [],
        spring: &mut [],
    };
    // To the higher grains as from lower ranges, to the lower grains as their own.
    black_box(sum::<_, _, LANES>(
        sight,
        &mut part,
        law,
        all.iter(),
        all,
        |_| {},
    ));
}

/// The search of a settled bed; with it, as always on taking up a state, the checks.
fn rebuild(c: &mut Criterion) {
    let mut sim = bed(1.0, 500);
    let mut group = c.benchmark_group("rebuild, per grain");
    group.throughput(Throughput::Elements(sim.count() as u64));
    group.bench_function("search", |b| {
        b.iter(|| black_box(&mut sim).resume(&[]).expect("a sound state"));
    });
    group.finish();
}

/// All of it, for comparison.
fn whole_step(c: &mut Criterion) {
    let mut sim = bed(1.0, 500);
    let mut group = c.benchmark_group("step, per grain");
    group.throughput(Throughput::Elements(sim.count() as u64));
    group.bench_function("whole step, hertz_history", |b| {
        b.iter(|| black_box(&mut sim).steps(1).expect("a settled bed"));
    });
    group.finish();
}

criterion_group!(benches, filter, contact_block, sums, rebuild, whole_step);
criterion_main!(benches);
