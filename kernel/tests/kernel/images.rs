//! Periodic axes: where the box is cut, and how often a body went round, has no effect.
//!
//! Places here are whole multiples of 2^-16 in boxes of a few units, so that shifting and wrapping
//! them is exact and two worlds can be compared to the bit.

use crate::common::cases::cases;
use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::vec3::{Vec3, head};
use bitgrain_kernel::{Domain, Group, Obstacle, Store, World, start, start_watched, step};
use bitgrain_kernel::{Partner, step_watched};
use proptest::prelude::*;

type V = Vec3<f64>;
type Box64 = Box<Store<f64, 64, 512, 128, 2>>;

const LAW: HertzHistory<f64> = HertzHistory {
    kn: 2e5,
    kt: 2.45e5,
    gamma_n: 792.0,
    gamma_t: 792.0,
    mu: 0.5,
};

/// The grid of exact places.
const GRID: f64 = 1.0 / 65536.0;

/// Side of the periodic box: four grains fill it, so contacts reach across every edge.
const SIDE: f64 = 4.0;

/// Grains pressed together in a periodic box round one ball, everything shifted by `shift` in
/// [`GRID`] units and wrapped into the box.
fn pressed(jitter: &[[i32; 3]], speed: &[V], shift: [i32; 3]) -> Box64 {
    let domain = Domain::new([0.0; 3], [SIDE; 3], [true; 3]).unwrap();
    let mut store = Box64::new(Store::new(domain, 1e-4, 0.1));
    store.add_group(Group::free([0.0; 3])).unwrap();
    let place = |k: usize| {
        let site = [k % 4, k / 4 % 4, k / 16];
        let mut x = core::array::from_fn(|a| {
            let steps = (site[a] as i32) * 65536 + jitter[k][a] + shift[a];
            f64::from(steps) * GRID
        });
        let inside = domain.wrap(&mut x, &mut [0; 3]);
        assert!(inside, "a shift of at most one period");
        x
    };
    store.add_obstacle(Obstacle::sphere(place(0), 0.5)).unwrap();
    for k in 1..64 {
        let radius = 0.5 + 0.01 * f64::from(jitter[k][0] & 3);
        store.add_grain(k as u32, 0, place(k), radius, 0.5).unwrap();
    }
    let world = store.world();
    for k in 1..64 {
        world.grains.velocity[k - 1][..3].copy_from_slice(&speed[k]);
        world.grains.spin[k - 1][..3].copy_from_slice(&speed[k - 1]);
    }
    store
}

fn forces(world: &World<'_, f64>) -> Vec<[u64; 3]> {
    let g = &world.grains;
    let grains = g.force.iter().chain(g.torque.iter()).map(|row| head(*row));
    let bodies = world.obstacles.iter().flat_map(|o| [o.force, o.torque]);
    grains.chain(bodies).map(|v| v.map(f64::to_bits)).collect()
}

proptest! {
    #![proptest_config(cases(32))]

    /// At step 0 places are exact, so forces are equal to the bit. Later each place is rounded
    /// where it lies, 1e-15 or less a step; two hundred steps are a few periods of a contact's
    /// oscillation and let that grow by less than a factor of a thousand.
    #[test]
    fn where_the_box_is_cut_does_not_matter(
        jitter in prop::collection::vec(prop::array::uniform3(0..1500i32), 64),
        speed in prop::collection::vec(prop::array::uniform3(-0.2..0.2f64), 64),
        shift in prop::array::uniform3(-262_144..262_144i32 - 200_000),
    ) {
        let mut here = pressed(&jitter, &speed, [0; 3]);
        let mut there = pressed(&jitter, &speed, shift);
        let (mut a, mut b) = (here.world(), there.world());
        let mut contacts = 0;
        start_watched(&mut a, &LAW, |_| contacts += 1).unwrap();
        start(&mut b, &LAW).unwrap();
        prop_assume!(contacts > 100, "the box is full of contacts: {}", contacts);
        prop_assert_eq!(forces(&a), forces(&b));
        for _ in 0..200 {
            step(&mut a, &LAW).unwrap();
            step(&mut b, &LAW).unwrap();
        }
        let away = |w: &World<'_, f64>, k: usize| {
            w.domain.separation(head(w.grains.position[k]), w.obstacles[0].point)
        };
        for k in 0..63 {
            let (p, q) = (away(&a, k), away(&b, k));
            for axis in 0..3 {
                // Two images are equally near at half a period, so compare modulo the period.
                let off = (p[axis] - q[axis]).abs();
                prop_assert!(off.min((off - SIDE).abs()) < 1e-12, "grain {} by {:e}", k + 1, off);
            }
        }
    }

    /// A place in the box and its crossings give back the way that was gone, without rounding.
    #[test]
    fn places_and_crossings_give_the_path(
        from in prop::collection::vec(prop::array::uniform3(0..262_144i32), 3),
        per_step in prop::collection::vec(prop::array::uniform3(-6000..6000i32), 3),
    ) {
        let domain = Domain::new([0.0; 3], [SIDE; 3], [true; 3]).unwrap();
        let dt = 1.0 / 1024.0;
        let mut store = Store::<f64, 2, 16, 2, 1>::new(domain, dt, 0.1);
        store.add_group(Group::prescribed_velocity()).unwrap();
        let exact = |steps: [i32; 3], unit: f64| steps.map(|s| f64::from(s) * unit);
        for k in 0..2 {
            store.add_grain(k as u32, 0, exact(from[k], GRID), 0.25, 1.0).unwrap();
        }
        store
            .add_obstacle(Obstacle {
                velocity: exact(per_step[2], GRID / dt),
                ..Obstacle::sphere(exact(from[2], GRID), 0.25)
            })
            .unwrap();
        let mut world = store.world();
        for k in 0..2 {
            let velocity = exact(per_step[k], GRID / dt);
            world.grains.velocity[k][..3].copy_from_slice(&velocity);
        }
        // Nothing pushes hard: the bodies pass through each other, and only their ways matter.
        let soft = HertzHistory { kn: 1e-9, kt: 0.0, gamma_n: 0.0, gamma_t: 0.0, mu: 0.0 };
        prop_assume!(start(&mut world, &soft).is_ok());
        for n in 1..=300 {
            if step(&mut world, &soft).is_err() {
                // They met too deep to go on.
                break;
            }
            let grains = (0..2).map(|k| (head(world.grains.position[k]), world.grains.image[k]));
            let ball = (world.obstacles[0].point, world.obstacles[0].image);
            for (k, (x, image)) in grains.chain([ball]).enumerate() {
                for a in 0..3 {
                    let gone = x[a] + f64::from(image[a]) * SIDE;
                    let way = from[k][a] + n * per_step[k][a];
                    prop_assert_eq!(gone, f64::from(way) * GRID, "body {} at step {}", k, n);
                    prop_assert!((0.0..SIDE).contains(&x[a]), "body {} is at {:?}", k, x);
                }
            }
        }
    }
}

/// One evaluated contact: its partner, overlap, forces and the springs held after it.
type Passing = (u64, Partner, Vec<u64>);

/// A grain carried round a periodic box past a frozen grain and a ball: the second round is the
/// first again to the bit, because whoever parted has forgotten.
#[test]
fn a_contact_that_parted_begins_anew() {
    let period = 4096;
    for skin in [0.0, 0.1, 3.5] {
        let domain = Domain::new([0.0; 3], [8.0; 3], [true, false, false]).unwrap();
        // A step of 1/512 along x: 8 units take 4096 steps, and every place is exact.
        let mut store = Store::<f64, 2, 16, 4, 2>::new(domain, 1.0 / 4096.0, skin);
        store.add_group(Group::frozen()).unwrap();
        store.add_group(Group::prescribed_velocity()).unwrap();
        store.add_grain(1, 0, [3.0, 4.0, 4.0], 0.5, 0.5).unwrap();
        store
            .add_grain(2, 1, [1.0, 4.96875, 4.0], 0.5, 0.5)
            .unwrap();
        store
            .add_obstacle(Obstacle::sphere([6.0, 5.9375, 4.0], 0.5))
            .unwrap();
        let mut world = store.world();
        world.grains.velocity[1][0] = 8.0;
        start(&mut world, &LAW).unwrap();
        let mut rounds: [Vec<Passing>; 2] = Default::default();
        for round in &mut rounds {
            for n in 0..period {
                let mut seen = Vec::new();
                step_watched(&mut world, &LAW, |p| seen.push(p)).unwrap();
                let springs = world.contact_histories().flat_map(|bond| match bond {
                    bitgrain_kernel::ContactHistory::Pair { spring, .. }
                    | bitgrain_kernel::ContactHistory::Obstacle { spring, .. } => spring,
                });
                let springs: Vec<f64> = springs.collect();
                for p in seen {
                    let numbers = [p.overlap, p.normal_force].into_iter();
                    let numbers = numbers.chain(p.tangential_force).chain(springs.clone());
                    round.push((n, p.partner, numbers.map(f64::to_bits).collect()));
                }
            }
        }
        let met = |partner| rounds[0].iter().filter(|p| p.1 == partner).count();
        assert!(met(Partner::Grain(1)) > 100, "the grains met");
        assert!(met(Partner::Obstacle(0)) > 100, "the ball was met");
        assert_eq!(world.grains.image[1], [2, 0, 0], "it went round twice");
        assert!(rounds[0] == rounds[1], "skin {skin}: the rounds differ");
    }
}
