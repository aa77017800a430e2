//! A simulation from arrays: stepped, watched, saved and resumed.
//! `cargo run --release -p bitgrain-sim --example from_arrays`

use std::error::Error;

use bitgrain_kernel::contact::HertzTsuji;
use bitgrain_kernel::{Domain, Group, Obstacle};
use bitgrain_sim::simulation::{AnyLaw, Grain, Simulation, hex};
use bitgrain_sim::{checkpoint, observe};

/// Two hundred grains over a floor, in units of their diameter, density and gravity.
fn poured() -> Result<Simulation, Box<dyn Error>> {
    let law = AnyLaw::HertzTsuji(HertzTsuji::new(2e4, 0.3, 0.6, 0.5));
    let domain = Domain::new([0.0; 3], [6.0, 6.0, 40.0], [true, true, false])?;
    let grain = |k: u32| Grain {
        id: k + 1,
        group: 0,
        diameter: 0.9 + 0.05 * f64::from(k % 5),
        density: 1.0,
        position: [k % 5, k / 5 % 5, k / 25].map(|n| 0.6 + 1.2 * f64::from(n)),
        velocity: [0.1, 0.0, 0.0],
        spin: [0.0; 3],
    };
    let grains: Vec<Grain> = (0..200).map(grain).collect();
    let groups = vec![Group::free([0.0, 0.0, -1.0])];
    let floor = vec![Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0])];
    let mut sim = Simulation::new(law, domain, 5e-4, groups, &grains, floor);
    sim.start()?;
    Ok(sim)
}

/// # Errors
/// What is refused, and what cannot be written.
pub fn main() -> Result<(), Box<dyn Error>> {
    let mut sim = poured()?;
    sim.steps(5000)?;
    let mut deepest: f64 = 0.0;
    sim.step_watched(|contact| deepest = deepest.max(contact.overlap))?;
    let surface = observe::surface_height(&sim, 1.0);
    println!("deepest overlap {deepest:.4}, surface at {surface:.2}");

    let file = std::env::temp_dir().join(format!("bed-{}.safetensors", std::process::id()));
    checkpoint::write(&file, &mut sim)?;
    let mut again = checkpoint::read(&file)?;
    std::fs::remove_file(&file)?;
    sim.steps(2000)?;
    again.steps(2000)?;
    let digests = [sim.digest()?, again.digest()?].map(|digest| hex(&digest.whole));
    println!("after step {}: {}", sim.step_count(), digests[0]);
    assert_eq!(
        digests[0], digests[1],
        "a resumed simulation has the same bits"
    );
    Ok(())
}
