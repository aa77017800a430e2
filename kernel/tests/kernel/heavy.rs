//! Grains that are infinitely heavy in contacts and yet move: their own mass says how.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{Domain, Group, Store, start, step};

/// Velocity along z changes by `(F/m + g) h` with the force before the step, and by that with the force after it.
#[test]
fn a_grain_that_is_heavy_in_contacts_yields_by_its_mass() {
    let (dt, mass, gravity): (f64, f64, f64) = (1e-4, 0.7, -1.0);
    let law = HertzHistory {
        kn: 2e5,
        kt: 2e5,
        gamma_n: 10.0,
        gamma_t: 10.0,
        mu: 0.5,
    };
    let mut store = Store::<f64, 2, 8, 1, 2>::new(Domain::open(), dt, 0.1);
    let light = store.add_group(Group::free([0.0; 3])).unwrap();
    let mut group = Group::free([0.0, 0.0, gravity]);
    group.infinite_mass = true;
    let heavy = store.add_group(group).unwrap();
    store.add_grain(1, heavy, [0.0; 3], 0.5, mass).unwrap();
    store
        .add_grain(2, light, [0.0, 0.0, 0.99], 0.5, 0.4)
        .unwrap();
    let mut world = store.world();
    start(&mut world, &law).unwrap();
    let mut speed = 0.0;
    for _ in 0..10 {
        let kick = |force: f64| (force * (1.0 / mass) + gravity) * (dt * 0.5);
        let before = kick(world.grains.force[0][2]);
        step(&mut world, &law).unwrap();
        assert!(
            world.grains.force[0][2] < 0.0,
            "the other one pushes it down"
        );
        speed = (speed + before) + kick(world.grains.force[0][2]);
        assert_eq!(world.grains.velocity[0][2], speed);
    }
}
