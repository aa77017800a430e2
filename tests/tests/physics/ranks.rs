//! Worlds that several ranks share, which are threads here that hand each other messages, late and at random times: the
//! same bits for any number of ranks and threads of each, whatever grain is where.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use bitgrain::law::{HertzTsujiParameters, LawSpec, RollingSpec};
use bitgrain::notes::Watch;
use bitgrain::parts::{Carrier, Channels, Cutting, Message, Ranks, Sharing, on_ranks};
use bitgrain::simulation::Simulation;
use bitgrain::threads::on_threads;
use bitgrain_kernel::{Error as KernelError, LossPolicy};
use bitgrain_tests::{bed_that_loses_a_grain, settled_bed};

/// A rank that takes messages out late, at random.
struct Late {
    channels: Channels,
    seed: u64,
}

impl Carrier for Late {
    fn rank(&self) -> usize {
        self.channels.rank()
    }

    fn ranks(&self) -> usize {
        self.channels.ranks()
    }

    fn carry(&mut self, out: Vec<(usize, Message)>, arrived: &mut dyn FnMut(usize, Message)) {
        let seed = &mut self.seed;
        self.channels.carry(out, &mut |from, message| {
            *seed = seed.wrapping_mul(0x5851_f42d_4c95_7f2d) | 1;
            if *seed >> 60 == 0 {
                thread::sleep(Duration::from_micros(*seed >> 52 & 0xff));
            }
            arrived(from, message);
        });
    }

    fn give_up(&mut self, why: &str) -> ! {
        self.channels.give_up(why)
    }
}

/// Does `job` as the first of so many ranks.
fn on_these<T>(count: usize, late: bool, job: impl FnOnce(&Arc<Ranks>) -> T) -> T {
    let carrier = |channels: Channels| -> Box<dyn Carrier> {
        let seed = 2 * channels.rank() as u64 + 1;
        match late {
            true => Box::new(Late { channels, seed }),
            false => Box::new(channels),
        }
    };
    let carriers = Channels::between(count).into_iter().map(carrier);
    let ranks = carriers.map(|carrier| Ranks::new(carrier, Sharing::default()));
    on_ranks(ranks.collect(), job)
}

/// A simulation in parts at these ranks.
fn shared(mut sim: Simulation, ranks: &Arc<Ranks>, cutting: Cutting) -> Simulation {
    sim.stepping.divide_always();
    sim.stepping.cutting = cutting;
    sim.stepping.ranks = Some(Arc::clone(ranks));
    sim
}

const WAYS: [(usize, usize, Cutting, bool); 8] = [
    (1, 2, Cutting::Planes, false),
    (2, 1, Cutting::Planes, false),
    (2, 2, Cutting::Planes, true),
    (3, 1, Cutting::Planes, true),
    (4, 2, Cutting::Planes, false),
    (8, 1, Cutting::Planes, false),
    (3, 1, Cutting::Scattered(1), false),
    (2, 3, Cutting::Scattered(2), true),
];

fn steps(release: u64) -> u64 {
    if cfg!(debug_assertions) {
        (release / 20).max(4)
    } else {
        release
    }
}

/// Calls of several steps, digests, edits of rows and copies in between.
/// Ten seconds, because every cut of the world and two laws are gone through with all threads of one process.
#[test]
fn ranks_change_no_bit() {
    for rolls in [false, true] {
        let mut sim = settled_bed();
        if rolls {
            let rolling = RollingSpec::Epsd2 { mu: 0.1 };
            let law = LawSpec::HertzTsuji(HertzTsujiParameters {
                young: 2e5,
                poisson: 0.3,
                restitution: 0.6,
                mu: 0.5,
                rolling: Some(rolling),
            });
            sim.law = law.build().unwrap();
        }
        change_no_bit(sim);
    }
}

fn change_no_bit(mut plain: Simulation) {
    plain.start().unwrap();
    let begin = plain.clone();
    let watch = Watch {
        obstacles: vec![1, 0],
        grains: vec![3, 1, 2],
    };
    let go = |sim: &mut Simulation| {
        let mut seen = Vec::new();
        let mut notes = Vec::new();
        for count in [1, 7, steps(120), 2] {
            sim.steps_noted(count, &watch, |note| notes.push(note.clone()))
                .unwrap();
            seen.push((
                sim.digest().unwrap(),
                sim.touching(0),
                sim.obstacles.clone(),
            ));
            sim.steps(steps(60)).unwrap();
            let mut copy = sim.clone();
            copy.steps(3).unwrap();
            seen.push((copy.digest().unwrap(), copy.touching(0), Vec::new()));
        }
        (seen, notes)
    };
    let expected = go(&mut plain);
    for (ranks, threads, cutting, late) in WAYS {
        let told = on_these(ranks, late, |ranks| {
            let mut sim = shared(begin.clone(), ranks, cutting);
            let told = on_threads(threads, || go(&mut sim)).unwrap();
            assert_eq!(sim.stepping.parts(), ranks.count() * threads);
            told
        });
        assert_eq!(
            told, expected,
            "{ranks} ranks, {threads} threads, {cutting:?}"
        );
    }
}

/// A fault, and a grain that leaves, are those of one process, and the world can be stepped on after the latter.
#[test]
fn faults_and_losses_are_those_of_one_process() {
    let (begin, id) = bed_that_loses_a_grain();
    let go = |mut sim: Simulation, takes_out: bool| {
        sim.policy = LossPolicy {
            takes_out,
            drain: None,
        };
        sim.start().unwrap();
        let ended = sim.steps(steps(200).max(20));
        if takes_out {
            sim.take_out(|_| ()).unwrap();
            sim.steps(20).unwrap();
        }
        (
            ended,
            sim.step_count(),
            takes_out.then(|| sim.digest().unwrap()),
        )
    };
    let expected = [false, true].map(|takes_out| go(begin.clone(), takes_out));
    assert_eq!(expected[0].0, Err(KernelError::Escaped { id }));
    assert_eq!(expected[1].0, Err(KernelError::GrainsLeaving));
    for (ranks, threads, cutting, late) in WAYS {
        let told = on_these(ranks, late, |ranks| {
            let job = || [false, true].map(|out| go(shared(begin.clone(), ranks, cutting), out));
            on_threads(threads, job).unwrap()
        });
        assert_eq!(
            told, expected,
            "{ranks} ranks, {threads} threads, {cutting:?}"
        );
    }
}

/// Two worlds may share the ranks, in turn.
#[test]
fn worlds_take_turns() {
    let (mut one, mut other) = (settled_bed(), settled_bed());
    other.obstacles[0].velocity = [-1.0, 0.5, 0.0];
    one.start().unwrap();
    other.start().unwrap();
    let mut plain = [one.clone(), other.clone()];
    let expected = plain.each_mut().map(|sim| {
        sim.steps(steps(80)).unwrap();
        sim.digest()
    });
    on_these(3, false, |ranks| {
        let mut sims = [one, other].map(|sim| shared(sim, ranks, Cutting::Planes));
        for _ in 0..4 {
            for sim in &mut sims {
                sim.steps(steps(80) / 4).unwrap();
            }
        }
        assert_eq!(sims.each_mut().map(|sim| sim.digest()), expected);
    });
}

/// A rank that does not answer is named.
#[test]
#[should_panic(expected = "rank 1 did not answer")]
fn a_silent_rank_is_named() {
    // Nobody serves the other one.
    let carrier = Channels::between(2).remove(0);
    let sharing = Sharing {
        patience: Duration::from_millis(200),
        ..Sharing::default()
    };
    let ranks = Ranks::new(Box::new(carrier), sharing);
    let mut sim = settled_bed();
    sim.start().unwrap();
    let mut sim = shared(sim, &ranks, Cutting::Planes);
    let _ = sim.steps(10);
}
