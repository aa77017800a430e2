//! A world in static memory, as in firmware: nothing is allocated, and the size is known when it is built.
//! `cargo run -p bitgrain-kernel --example static_firmware_world`
//!
//! On a microcontroller the lock is that of its critical section, and the loop is its timer's interrupt.

use std::sync::Mutex;

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{Domain, Error, Group, Obstacle, Store, start, step};

/// Eight grains, 40 listed pairs, 16 obstacle contacts, a floor and a group, in single precision.
type Tray = Store<f32, 8, 40, 16, 1>;

const MASS: f32 = std::f32::consts::FRAC_PI_6;

static TRAY: Mutex<Tray> = Mutex::new(Tray::vacant());

/// # Errors
/// What the kernel refuses.
pub fn main() -> Result<(), Error> {
    let mut tray = TRAY.lock().expect("nobody panics with it");
    let domain = Domain::new([0.0; 3], [4.0, 4.0, 8.0], [true, true, false])?;
    tray.clear(domain, 1e-3, 0.2);
    tray.add_group(Group::free([0.0, 0.0, -1.0]))
        .expect("room for a group");
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    tray.add_obstacle(floor).expect("room for a floor");
    for k in 0..8u8 {
        let (x, y) = (f32::from(k % 2), f32::from(k / 2 % 2));
        let place = [1.0 + 2.0 * x, 1.0 + 2.0 * y, 1.0 + 1.5 * f32::from(k / 4)];
        tray.add_grain(u32::from(k) + 1, 0, place, 0.5, MASS)
            .expect("room for a grain");
    }
    let law = HertzHistory {
        kn: 2e3,
        kt: 2e3,
        gamma_n: 200.0,
        gamma_t: 200.0,
        mu: 0.5,
    };

    let mut world = tray.world();
    start(&mut world, &law)?;
    for _ in 0..40_000 {
        step(&mut world, &law)?;
    }
    let heights: Vec<f32> = world.grains.position.iter().map(|x| x[2]).collect();
    println!("heights {heights:.3?} in {} bytes", size_of::<Tray>());
    // The upper four stand on the lower four, and the floor carries all of them.
    let carried = -world.obstacles[0].force[2];
    assert!((carried - 8.0 * MASS).abs() < 1e-3, "{carried}");
    Ok(())
}
