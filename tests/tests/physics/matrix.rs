//! Every setting that must not change a bit, on beds in motion, step by step: threads, lanes and
//! instructions, skins and search schedules, what is watched and saved, and how much storage is lent.
//! Run in debug and in release. The beds are one of 300 grains, `bed-2500/settled.safetensors.gz` and
//! `peers/bedA_D4.data.gz`.

use std::path::Path;

use bitgrain::bed;
use bitgrain::bench::read_bed;
use bitgrain::checkpoint;
use bitgrain::compare::first_difference;
use bitgrain::isa::Isa;
use bitgrain::law::{HertzTsujiParameters, LawSpec, RollingSpec};
use bitgrain::parts::Cutting;
use bitgrain::progress::Stage;
use bitgrain::scenario;
use bitgrain::simulation::{AnyLaw, Simulation};
use bitgrain::threads::on_threads;
use bitgrain_kernel::Digest;
use bitgrain_kernel::contact::HertzTsuji;
use bitgrain_tests::{SMALL, golden, settled_bed};

/// A settled bed of 10,000 grains round a ball that moves.
fn large() -> Simulation {
    let mut sim = read_bed(&golden("peers/bedA_D4.data.gz")).expect("the golden bed is sound");
    sim.start().expect("the golden bed is sound");
    sim
}

/// The same grains under the other law, without history, about as stiff.
fn tsuji(mut sim: Simulation) -> Simulation {
    sim.law = AnyLaw::HertzTsuji(HertzTsuji::new(2e5, 0.3, 0.6, 0.5));
    sim.start().expect("the golden bed is sound");
    sim
}

/// The same with resistance to rolling.
fn rolling(mut sim: Simulation) -> Simulation {
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 2e5,
        poisson: 0.3,
        restitution: 0.6,
        mu: 0.5,
        rolling: Some(RollingSpec::Sds {
            k: 2e3,
            gamma: 1.0,
            mu: 0.1,
        }),
    });
    sim.law = law.build().expect("a sound law");
    sim.start().expect("the golden bed is sound");
    sim
}

/// One way to step. The rest is as by default.
#[derive(Clone, Copy, Debug)]
struct Way {
    threads: usize,
    registers: Isa,
    /// Over the skin and reach that the simulation chose.
    skin: f64,
    /// Watches every second step and saves every third.
    interrupted: bool,
    /// Entries of the lists and cells for each grain.
    room: usize,
    /// Which thread has which grains.
    cutting: Cutting,
}

/// All settings one by one, and then several at once.
fn ways() -> Vec<Way> {
    let registers = Isa::best();
    let plain = Way {
        threads: 1,
        registers,
        skin: 1.0,
        interrupted: false,
        room: 4,
        cutting: Cutting::Planes,
    };
    let mut ways = vec![plain];
    ways.extend([2, 3, 8].map(|threads| Way { threads, ..plain }));
    ways.extend([2, 5].map(|threads| Way {
        threads,
        cutting: Cutting::Scattered(7),
        ..plain
    }));
    let every = Isa::all();
    ways.extend(every.iter().map(|&registers| Way { registers, ..plain }));
    ways.extend([0.0, 0.3, 4.0].map(|skin| Way { skin, ..plain }));
    ways.extend([0, 1, 60].map(|room| Way { room, ..plain }));
    let interrupted = true;
    ways.push(Way {
        interrupted,
        ..plain
    });
    for (k, registers) in every.into_iter().enumerate() {
        ways.push(Way {
            threads: [2, 3, 8][k % 3],
            registers,
            skin: [0.0, 2.0][k % 2],
            interrupted,
            room: k,
            cutting: Cutting::Planes,
        });
    }
    ways
}

impl Way {
    fn prepare(&self, sim: &mut Simulation) {
        sim.stepping.registers = self.registers;
        // Beds of fewer grains must also be cut into as many parts as there are threads.
        sim.stepping.divide_always();
        sim.stepping.cutting = self.cutting;
        let histories = sim.contact_histories();
        sim.skin *= self.skin;
        sim.outer_skin *= self.skin;
        sim.lend(self.room * sim.count());
        sim.resume(&histories).expect("the state is sound");
    }

    fn step(&self, sim: &mut Simulation, n: usize) {
        if self.interrupted && !n.is_multiple_of(2) {
            sim.step_watched(|_| {}).expect("a sound bed");
        } else {
            sim.steps(1).expect("a sound bed");
            assert_eq!(sim.stepping.parts(), self.threads);
        }
        if self.interrupted && n.is_multiple_of(3) {
            assert!(!checkpoint::bytes(sim, "").unwrap().is_empty());
        }
    }
}

/// Steps a simulation by the kernel's own step and then in every way, and compares each step.
fn compare(name: &str, steps: usize, begin: &Simulation) {
    let mut sim = begin.clone();
    let first = sim.digest().unwrap();
    let mut digests: Vec<Digest> = Vec::new();
    for _ in 0..steps {
        sim.step_watched(|_| {}).expect("a sound bed");
        digests.push(sim.digest().unwrap());
    }
    assert_ne!(first, sim.digest().unwrap());
    for way in ways() {
        let mut sim = begin.clone();
        way.prepare(&mut sim);
        let step = |n: usize| {
            way.step(&mut sim, n);
            sim.digest().unwrap()
        };
        let seen = on_threads(way.threads, || (0..steps).map(step).collect::<Vec<_>>());
        let seen = seen.expect("so many threads");
        let wrong = seen.iter().zip(&digests).position(|(a, b)| a != b);
        if let Some(n) = wrong {
            panic!("{name}: {way:?}: {}", explain(&way, n, begin, begin));
        }
    }
}

/// The first step, part, grain and component that differ: the one way from the one state and the
/// kernel's own step from the other.
fn explain(way: &Way, step: usize, begin: &Simulation, plain: &Simulation) -> String {
    let (mut plain, mut other) = (plain.clone(), begin.clone());
    way.prepare(&mut other);
    let stepped = on_threads(way.threads, || {
        (0..=step).for_each(|n| way.step(&mut other, n));
    });
    stepped.expect("so many threads");
    for _ in 0..=step {
        plain.step_watched(|_| {}).expect("a sound bed");
    }
    let found = first_difference(&mut plain, &mut other);
    found.map_or("a second try was the same".into(), |difference| {
        format!("step {}: {difference}", step + 1)
    })
}

/// Debug builds take a hundred times as long a step.
fn steps(release: usize) -> usize {
    if cfg!(debug_assertions) {
        (release / 30).max(4)
    } else {
        release
    }
}

/// The bed of a small scenario, its ball set in motion.
fn small() -> Simulation {
    let text = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-1", 1);
    let scenario = scenario::parse(&text, "small", &[], Path::new("")).expect("it is sound");
    let mut sim =
        bed::pour(&scenario, &scenario.beds()[0], &mut Stage::silent()).expect("it settles");
    sim.obstacles[0].velocity = [2.0, 0.0, 0.0];
    sim
}

/// Every knob; what grows with the number of grains alone, such as parts that are wider than what crosses their cuts,
/// is seen by the tests below.
#[test]
fn no_knob_changes_a_bit_of_a_small_bed() {
    let begin = small();
    compare("small", steps(240), &begin);
    compare("small, hertz_tsuji", steps(240), &tsuji(begin.clone()));
    compare("small, rolling", steps(240), &rolling(begin));
}

#[test]
#[ignore = "a minute of a processor: `.ci/run long`"]
fn no_knob_changes_a_bit_of_a_bed() {
    compare("bed", steps(240), &settled_bed());
    compare("bed, hertz_tsuji", steps(240), &tsuji(settled_bed()));
    compare("bed, rolling", steps(240), &rolling(settled_bed()));
}

/// In calls of several steps, each on another number of threads, with other grains for each thread after every search.
#[test]
fn threads_and_grains_that_change_all_the_time_change_no_bit() {
    let mut plain = settled_bed();
    let mut other = plain.clone();
    other.stepping.divide_always();
    other.outer_skin *= 0.05;
    other.stepping.tunes = false;
    let before = other.list_counts().0;
    for (k, threads) in [3, 2, 1, 8, 5, 2, 4, 1, 3, 6].into_iter().enumerate() {
        let count = steps(30) as u64 + k as u64;
        plain.steps(count).expect("a sound bed");
        other.stepping.cutting = match k % 3 {
            0 => Cutting::Planes,
            _ => Cutting::Scattered(k as u64),
        };
        let stepped = on_threads(threads, || other.steps(count));
        stepped.expect("so many threads").expect("a sound bed");
        assert_eq!(other.stepping.parts(), threads);
        let same = first_difference(&mut plain, &mut other);
        assert!(same.is_none(), "call {k}: {same:?}");
    }
    let searches = other.list_counts().0 - before;
    assert!(searches > 20, "{searches} searches: more than calls");
}

#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn no_knob_changes_a_bit_of_ten_thousand_grains() {
    compare("large", steps(45), &large());
    compare("large, hertz_tsuji", steps(45), &tsuji(large()));
}

/// Threads may come and go between steps: parts are cut again, and nothing is left of the old ones.
#[test]
fn the_number_of_threads_may_change_at_any_step() {
    let (mut plain, mut other) = (settled_bed(), settled_bed());
    other.stepping.divide_always();
    for n in 0..steps(240) {
        plain.step_watched(|_| {}).expect("a sound bed");
        let threads = [3, 1, 2, 8, 1][n % 5];
        on_threads(threads, || other.steps(1)).unwrap().unwrap();
        assert_eq!(first_difference(&mut plain, &mut other), None, "step {n}");
    }
}

/// The finding on a state that is off by one unit in the last place.
#[test]
fn a_difference_is_named() {
    let plain = settled_bed();
    let mut other = plain.clone();
    let y = &mut other.position[7][1];
    *y = y.next_up();
    let told = explain(&ways()[0], 0, &other, &plain);
    let expected = format!("step 1: positions of grain {}, y: ", plain.id[7]);
    assert!(told.starts_with(&expected), "{told}");
    assert_eq!(told.matches("(0x").count(), 2, "{told}");
}
