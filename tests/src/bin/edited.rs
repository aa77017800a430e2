//! A host that puts grains into a bed and takes them out as it goes, in however many processes it was started: what
//! tests of ranks run. It prints the digest after each edit, and saves the bed at the end.
//!
//! `edited THREADS CHECKPOINT`

use std::path::Path;

use bitgrain::checkpoint;
use bitgrain::simulation::{Grain, Simulation, hex};
use bitgrain::threads::on_threads;
use bitgrain_kernel::{Error as KernelError, LossPolicy};
use bitgrain_tests::settled_bed;

/// Edits.
const ROUNDS: u32 = 6;

/// Steps between two edits.
const STEPS: u64 = 150;

/// How far below the top of the box grains are put in.
const RAIN: f64 = 0.8;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [threads, file] = words.as_slice() else {
        panic!("edited THREADS CHECKPOINT");
    };
    let threads = threads.parse().expect("a number of threads");
    let work = || {
        let edited = on_threads(threads, || edit(Path::new(file)));
        edited.expect("threads").expect("a sound bed");
        0
    };
    std::process::exit(i32::from(bitgrain::ranks::once(work)));
}

fn edit(file: &Path) -> Result<(), KernelError> {
    let mut sim = settled_bed();
    sim.policy = LossPolicy {
        takes_out: true,
        drain: None,
    };
    sim.start()?;
    for round in 0..ROUNDS {
        let rained = rain(&mut sim, round)?;
        let buried: Vec<u32> = buried(&sim, round).collect();
        sim.remove(&buried)?;
        // One flies out of the box halfway to the next edit.
        let speed = RAIN / (0.5 * STEPS as f64 * sim.dt);
        sim.nudge(rained, [0.0, 0.0, speed], [0.0; 3])?;
        let mut left = 0;
        sim.steps_losing(STEPS, |_| left += 1)?;
        assert!(left > 0 && !buried.is_empty(), "grains come and go");
        let digest = hex(&sim.digest()?.whole);
        println!("{round}: {} grains, {left} left, {digest}", sim.count());
    }
    checkpoint::write(file, &mut sim).expect("a file can be written");
    Ok(())
}

/// Puts a row of grains in, and returns the id of the first.
fn rain(sim: &mut Simulation, round: u32) -> Result<u32, KernelError> {
    let first = 1 + sim.id.iter().max().expect("there are grains");
    let [lo, hi] = [sim.domain.lo(), sim.domain.hi()];
    let group = sim
        .groups
        .iter()
        .position(|group| group.integrates == [true; 3]);
    let group = group.expect("some grains are free") as u8;
    let grain = |k: u32| Grain {
        id: first + k,
        group,
        diameter: 1.0,
        density: 1.0,
        position: [
            lo[0] + 1.0 + 1.5 * f64::from(k),
            lo[1] + 1.0 + 1.2 * f64::from(round),
            hi[2] - RAIN,
        ],
        velocity: [0.3, 0.1, -2.0],
        spin: [0.0, 1.0, 0.0],
    };
    sim.insert(&(0..6).map(grain).collect::<Vec<_>>())?;
    Ok(first)
}

/// Some grains of the bed, free ones and those of its base.
fn buried(sim: &Simulation, round: u32) -> impl Iterator<Item = u32> + '_ {
    let ids = sim.id.iter().copied();
    ids.take(2000).filter(move |id| id % 97 == round)
}
