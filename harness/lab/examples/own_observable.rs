//! The quick scenario with another friction coefficient, and a custom observable as a table: how many grains
//! the intruder carries along. `cargo run --release -p bitgrain-lab --example own_observable > carried.csv`
//!
//! Arguments change further keys, as in `bed.grains=2000`.

use bitgrain_kernel::ContactForce;
use bitgrain_lab::drag::drag;
use bitgrain_lab::progress::Stage;
use bitgrain_lab::{bed, scenario};
use bitgrain_sim::error::Result;
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::{Role, Simulation};

/// Counts grains that go at half the intruder's speed or faster.
struct Carried {
    speed: f64,
    every: u64,
    rows: Vec<(u64, usize)>,
}

impl Observer for Carried {
    fn wants_step(&self, step: u64) -> bool {
        step.is_multiple_of(self.every)
    }

    fn wants_contacts(&self, _step: u64) -> bool {
        false
    }

    fn on_step(&mut self, step: u64, sim: &mut Simulation, _: &[ContactForce<f64>]) -> Result<()> {
        let free = (0..sim.count()).filter(|&i| sim.role(i) == Role::Free);
        let fast = free.filter(|&i| sim.velocity[i][0] >= 0.5 * self.speed);
        self.rows.push((step, fast.count()));
        Ok(())
    }
}

/// # Errors
/// What is wrong with the keys, or with a step.
pub fn carried(keys: &[String]) -> Result<Vec<(u64, usize)>> {
    let mut sets = vec!["law.mu=0.2".to_string()];
    sets.extend_from_slice(keys);
    let quick = scenario::load("quick", &sets)?;
    let mut sim = bed::pour(&quick, &quick.beds()[0], &mut Stage::silent())?;
    let plan = &quick.drags()[0];
    let mut carried = Carried {
        speed: plan.motion.speed,
        every: quick.measure.every,
        rows: Vec::new(),
    };
    let (means, _) = drag(&mut sim, plan, &mut carried)?;
    eprintln!(
        "{}: drag {:.2} +- {:.2}",
        plan.name, means.drag.mean, means.drag.standard_error
    );
    Ok(carried.rows)
}

/// # Errors
/// As [`carried`].
pub fn main() -> Result<()> {
    let keys: Vec<String> = std::env::args().skip(1).collect();
    println!("step,carried");
    for (step, count) in carried(&keys)? {
        println!("{step},{count}");
    }
    Ok(())
}
