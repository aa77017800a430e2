//! A ball falls on a floor, bounces and comes to rest; `cargo run -p bitgrain-kernel --example drop_a_ball`.
//!
//! Units: diameter, density and gravity are 1.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{Domain, Error, Group, Obstacle, Store, digest, start, step};

const DT: f64 = 1e-4;
const MASS: f64 = std::f64::consts::FRAC_PI_6;

/// # Errors
/// What the kernel refuses.
pub fn main() -> Result<(), Error> {
    // Room for 1 grain, 4 pairs, 1 obstacle contact, 1 obstacle and 1 group.
    let mut store = Store::<f64, 1, 4, 1, 1>::new(Domain::open(), DT, 0.1);
    store
        .add_group(Group::free([0.0, 0.0, -1.0]))
        .expect("room for a group");
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    store.add_obstacle(floor).expect("room for a floor");
    store
        .add_grain(1, 0, [0.0, 0.0, 1.5], 0.5, MASS)
        .expect("room for a grain");
    let law = HertzHistory {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 792.0,
        gamma_t: 792.0,
        mu: 0.5,
    };

    let mut world = store.world();
    start(&mut world, &law)?;
    for n in 0..=300_000u32 {
        if n % 20_000 == 0 {
            println!(
                "t = {:4.1}  height {:.4}",
                f64::from(n) * DT,
                world.grains.position[0][2]
            );
        }
        step(&mut world, &law)?;
    }
    // It rests, and the floor carries its weight.
    assert!(world.grains.velocity[0][2].abs() < 1e-6);
    assert!((world.obstacles[0].force[2] + MASS).abs() < 1e-6);
    println!("digest {:02x?}", &digest(&world)?.whole[..8]);
    Ok(())
}
