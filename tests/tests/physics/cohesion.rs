//! The guide's law of one's own, which pulls, beside LAMMPS' `jkr`; and cohesion on top of a shipped law, beside
//! LIGGGHTS' `sjkr`. Tolerances as in `peers`.

use bitgrain_kernel::contact::{
    HertzTsuji, Law, NormalForce, NormalState, TangentialForce, TangentialState,
};
use bitgrain_kernel::{Domain, Group, Obstacle, Store, start, step};
use bitgrain_tests::{json, largest, number, numbers, triple};
use serde_json::Value;

use crate::peers::{PeerRow, STEP_0, TRAJECTORY, trajectory};

#[allow(dead_code)]
#[path = "../../../kernel/examples/cohesion.rs"]
mod example;

use example::Jkr;

/// Room for two grains, one wall and a word of each contact.
type Room = Store<f64, 2, 8, 4, 2, 1>;

/// The case of a reference code in the kernel's own storage; grains that it moves keep their velocity.
fn begin(c: &Value, first: &[PeerRow]) -> Box<Room> {
    let mut store = Box::new(Room::new(Domain::open(), number(&c["dt"]), 1e-5));
    store.add_group(Group::free([0.0; 3])).unwrap();
    store.add_group(Group::prescribed_velocity()).unwrap();
    for wall in c["walls"].as_array().into_iter().flatten() {
        let [point, normal] = ["point", "normal"].map(|key| triple(&numbers(&wall[key]), 0));
        store.add_obstacle(Obstacle::plane(point, normal)).unwrap();
    }
    for (i, row) in first.iter().enumerate() {
        let (radius, mass) = (0.5 * number(&c["diameter"][i]), number(&c["mass"][i]));
        let group = u8::from(c["role"][i] == "moved");
        let place = triple(row, 1);
        store
            .add_grain(i as u32 + 1, group, place, radius, mass)
            .unwrap();
        let grains = store.world().grains;
        grains.velocity[i][..3].copy_from_slice(&triple(row, 4));
        grains.spin[i][..3].copy_from_slice(&triple(row, 7));
    }
    store
}

/// Follows a case, and returns at how many samples there was a force at a distance.
fn follow(c: &Value, law: &impl Law<f64>) -> usize {
    let name = c["name"].as_str().expect("a name");
    let traj = trajectory(c);
    let mut store = begin(c, &traj[0]);
    let mut world = store.world();
    start(&mut world, law).unwrap();
    let all = |at: usize| largest(traj.iter().flatten().flat_map(|row| triple(row, at)));
    let radius = 0.5 * number(&c["diameter"][0]);
    let (v, f) = (all(4), all(10));
    let scales = [
        all(1),
        v,
        all(7).max(v / radius),
        f,
        all(13).max(f * radius),
    ];
    let mut apart = 0;
    for sample in &traj {
        let at = sample[0][0] as u64;
        while world.clock.step < at {
            step(&mut world, law).unwrap();
        }
        let tolerance = if at == 0 { STEP_0 } else { TRAJECTORY };
        for (i, row) in sample.iter().enumerate() {
            let g = &world.grains;
            let ours = [
                g.position[i],
                g.velocity[i],
                g.spin[i],
                g.force[i],
                g.torque[i],
            ];
            for (q, ours) in ours.iter().enumerate() {
                let theirs = triple(row, 1 + 3 * q);
                let off = largest((0..3).map(|a| ours[a] - theirs[a]));
                assert!(
                    off <= tolerance * scales[q],
                    "{name}: quantity {q} of sphere {i} at step {at} is off by {off:e} of {:e}",
                    scales[q]
                );
            }
        }
        let gap = match &world.grains.position[..] {
            [a, b] => gap_between(a, b),
            _ => 0.0,
        };
        apart += usize::from(gap > 0.0 && world.grains.force[0] != [0.0; 4]);
    }
    apart
}

/// Distance of two surfaces.
fn gap_between(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let squares = (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k]));
    squares.sum::<f64>().sqrt() - (a[3] + b[3])
}

/// Damping over critical damping for LAMMPS' `e`, by its polynomial.
fn tsuji_damping(e: f64) -> f64 {
    let powers = [1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218];
    powers.iter().rev().fold(0.0, |sum, c| sum * e + c)
}

/// A collision and a slow pull, along the whole branch on which grains hold each other although they have parted.
#[test]
fn lammps_jkr() {
    let file = json("peers/cohesion_lammps.json.gz");
    let cases = file["cases"].as_array().expect("cases").iter();
    // Its spins cannot be ours: see `materials`.
    let straight: Vec<_> = cases.filter(|c| c["name"] != "jkr_oblique").collect();
    assert_eq!(straight.len(), 2);
    let mut apart = 0;
    for c in straight {
        let of = &c["params"]["pair"]["11"];
        let [young, poisson, e, energy, mu, xt] =
            ["E", "nu", "e", "coh", "mu", "xt"].map(|key| number(&of[key]));
        let radius = 0.5 * number(&c["diameter"][0]);
        let law = Jkr::new([young, poisson], energy, [tsuji_damping(e), xt], mu, radius);
        apart += follow(c, &law);
    }
    assert!(apart > 20, "they hold each other at a distance: {apart}");
}

/// A chain breaks at its uppermost contact, at the pull of the theory: 12 % more is what the grains take to part while
/// the pull grows.
#[test]
fn a_chain_hangs_on_jkr() {
    let (load, holds) = example::hang().unwrap();
    assert!(load > 1.0 && load < 1.12 && holds, "{load} {holds}");
}

/// A shipped law with a pull in proportion to the area of the contact, after friction.
#[derive(Clone, Copy)]
struct Sjkr {
    law: HertzTsuji<f64>,
    /// Pull over area (pressure).
    density: f64,
}

impl Sjkr {
    /// The lens that two balls have in common, or a ball and a wall.
    fn area(c: &NormalState<f64>) -> f64 {
        let (r, o) = (c.radius_i, c.overlap);
        let distance = r + c.radius_j - o;
        let other = c.radius_j;
        let along = (distance * distance + r * r - other * other) / (2.0 * distance);
        let on_wall = c.radius_j == 0.0;
        let half = if on_wall { r - o } else { along };
        std::f64::consts::PI * (r * r - half * half)
    }
}

impl Law<f64> for Sjkr {
    const ACTS_APART: bool = true;

    /// LIGGGHTS counts bodies that barely touch, as the sphere does at step 5 of its case on a wall.
    fn acts(&self, c: &NormalState<f64>) -> bool {
        c.overlap >= 0.0
    }

    fn normal_force(&self, c: &NormalState<f64>) -> NormalForce<f64> {
        let own = self.law.normal_force(c);
        NormalForce {
            force: own.force - self.density * Self::area(c),
            ..own
        }
    }

    fn tangential_force(
        &self,
        normal: &NormalForce<f64>,
        state: &TangentialState<f64>,
    ) -> TangentialForce<f64> {
        // Friction does not know of the pull.
        let bare = NormalForce {
            force: normal.force + self.density * Self::area(&state.contact),
            ..*normal
        };
        self.law.tangential_force(&bare, state)
    }
}

#[test]
fn liggghts_sjkr() {
    let file = json("peers/cohesion_liggghts.json.gz");
    let cases = file["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 2);
    for c in cases {
        let (params, species) = (&c["params"], &c["params"]["species"][0]);
        let of = |key: &str| number(&params[key]["11"]);
        let law = HertzTsuji::new(
            number(&species["E"]),
            number(&species["nu"]),
            of("e"),
            of("mu"),
        );
        let density = of("ced");
        follow(c, &Sjkr { law, density });
    }
}
