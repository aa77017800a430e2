//! A crowd in a small periodic box over a floor, with a driven ball, a bar and every kind of group.

use bitgrain_kernel::contact::{HertzHistory, HertzTsuji};
use bitgrain_kernel::{Domain, Facet, Group, Obstacle, Store, arrange};

/// The numbers that a world of one law is measured in.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    /// Mean diameter of a grain.
    pub length: f64,
    /// Mass density of a grain.
    pub density: f64,
    /// Time step.
    pub dt: f64,
    /// Acceleration of gravity.
    pub gravity: f64,
}

/// Density, diameter and gravity are 1, with [`history`].
pub const REDUCED: Units = Units {
    length: 1.0,
    density: 1.0,
    dt: 1e-4,
    gravity: 1.0,
};

/// Glass beads in SI units, with [`tsuji`].
pub const SI: Units = Units {
    length: 1.5e-3,
    density: 2500.0,
    dt: 1e-5,
    gravity: 9.81,
};

/// The law of Kumar 2018, softened, with this friction coefficient.
pub fn history(mu: f64) -> HertzHistory<f64> {
    HertzHistory {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 792.0,
        gamma_t: 792.0,
        mu,
    }
}

/// The law of Guillard 2014.
pub fn tsuji() -> HertzTsuji<f64> {
    HertzTsuji::new(5e6, 0.45, 0.6, 0.5)
}

/// Storage for a crowd of up to 64 grains, listed up to 0.6 diameters beyond touching, and for more words of a contact
/// than any law here keeps.
pub type Crowd = Store<f64, 64, 1024, 2048, 7, 4>;

/// Random numbers from 0 to 1 that one grain takes.
pub const PER_GRAIN: usize = 5;

fn ball_mass(diameter: f64, density: f64) -> f64 {
    density * (std::f64::consts::PI / 6.0 * (diameter * diameter * diameter))
}

/// How far apart the sites of a crowd are across, and how far grains are shaken off them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packing {
    /// Distance of sites along x and y (diameters).
    pub across: f64,
    /// Distance of sites along z (diameters).
    pub up: f64,
    /// Shaking along x and y (diameters).
    pub shake: f64,
    /// Shaking along z (diameters).
    pub lift: f64,
}

/// Grains pressed together: half of all neighbours touch from the start.
pub const DENSE: Packing = Packing {
    across: 1.0,
    up: 1.0,
    shake: 0.04,
    lift: 0.04,
};

/// Grains on the sites of a lattice, shaken and sized by `seed`; `skin` is in diameters.
pub fn crowd(seed: &[f64], packing: &Packing, units: &Units, skin: f64) -> Box<Crowd> {
    let scale = units.length;
    let side = 4.0 * packing.across * scale;
    let (lo, hi) = ([0.0, 0.0, -scale], [side, side, 40.0 * scale]);
    let domain = Domain::new(lo, hi, [true, true, false]).unwrap();
    let mut store = Box::new(Crowd::new(domain, units.dt, skin * scale));
    add_bodies(&mut store, seed, units);
    let mut motion = Vec::new();
    for (k, u) in seed.as_chunks::<PER_GRAIN>().0.iter().enumerate() {
        let site = [k % 4, k / 4 % 4, k / 16].map(|c| c as f64);
        let group = [0, 0, 1, 0, 2, 4, 0, 3][k % 8];
        let speed = 2.0 * scale.sqrt();
        let velocity = match group {
            1 => [0.0; 3],
            2 => [0.3 * scale, 0.0, 0.0],
            _ => [u[0] - 0.5, u[1] - 0.5, u[2] - 1.0].map(|v| v * speed),
        };
        let spin = if group == 0 || group == 4 {
            [u[3], u[4], u[0]].map(|w| 4.0 * w)
        } else {
            [0.0; 3]
        };
        let diameter = (0.9 + 0.2 * u[3]) * scale;
        let position = [
            (packing.across * site[0] + packing.shake * u[0] + 0.2) * scale,
            (packing.across * site[1] + packing.shake * u[1] + 0.2) * scale,
            (packing.up * site[2] + packing.lift * u[2] + 0.55) * scale,
        ];
        let mass = ball_mass(diameter, units.density);
        // Ids ascend but are not consecutive.
        let id = 3 * k as u32 + 2;
        store
            .add_grain(id, group, position, 0.5 * diameter, mass)
            .unwrap();
        motion.push((velocity, spin));
    }
    let world = store.world();
    for (k, (velocity, spin)) in motion.iter().enumerate() {
        world.grains.velocity[k][..3].copy_from_slice(velocity);
        world.grains.spin[k][..3].copy_from_slice(spin);
    }
    store
}

/// The five groups, the last without weight, of three materials that only a law of several tells apart, and a floor,
/// a ball with its own mass, a bar, a box that turns, and a
/// capsule and a short bar that move freely, and an uneven mesh that turns, which come down on the crowd.
fn add_bodies(store: &mut Crowd, seed: &[f64], units: &Units) {
    let scale = units.length;
    let down = |g: f64| [0.0, 0.0, -g * units.gravity];
    for group in [
        Group::free(down(1.0)),
        Group::frozen().of_material(1),
        Group::prescribed_velocity(),
        Group::free_along_z(down(2.0)).of_material(2),
        Group::free([0.0; 3]).of_material(1),
    ] {
        store.add_group(group).unwrap();
    }
    let facets: &'static [Facet<f64>] = uneven(scale).leak();
    store.set_facets(facets);
    let top = 1.05 * (seed.len() / (16 * PER_GRAIN)) as f64 * scale + 2.2 * scale;
    let bodies = [
        Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]),
        Obstacle {
            velocity: [0.5 * scale.sqrt(), 0.0, -1.5 * scale.sqrt()],
            inverse_mass: 1.0 / ball_mass(scale, units.density),
            ..Obstacle::sphere([2.5 * scale, 2.5 * scale, top], 0.6 * scale)
        },
        Obstacle {
            velocity: [0.0, 0.0, -scale.sqrt()],
            ..Obstacle::cylinder([0.5 * scale, 0.0, top], [0.0, 2.0, 0.0], 0.4 * scale)
        },
        Obstacle {
            velocity: [0.0, 0.3 * scale.sqrt(), -scale.sqrt()],
            angular_velocity: [1.0, -0.5, 2.0].map(|w| w / scale.sqrt()),
            ..Obstacle::cuboid(
                [1.5 * scale, 1.2 * scale, top + 0.8 * scale],
                [0.5, 0.4, 0.3].map(|h| h * scale),
            )
        },
        Obstacle {
            velocity: [0.0, 0.0, -2.0 * scale.sqrt()],
            angular_velocity: [3.0, 1.0, -2.0].map(|w| w / scale.sqrt()),
            ..Obstacle::capsule(
                [3.4 * scale, 0.9 * scale, top + 0.2 * scale],
                [1.0, 0.0, 0.0],
                0.3 * scale,
                0.5 * scale,
            )
            .free(units.density, down(1.0))
            .unwrap()
        },
        Obstacle {
            velocity: [0.0, 0.0, -scale.sqrt()],
            angular_velocity: [0.0, 1.0, 0.5].map(|w| w / scale.sqrt()),
            orientation: [0.8, 0.0, 0.6, 0.0],
            ..Obstacle::finite_cylinder(
                [0.6 * scale, 3.1 * scale, top + 0.4 * scale],
                [0.0, 0.0, 1.0],
                0.5 * scale,
                0.3 * scale,
            )
            .free(units.density, down(1.0))
            .unwrap()
        },
        Obstacle {
            velocity: [0.0, 0.0, -scale.sqrt()],
            angular_velocity: [0.1, -0.2, 0.4].map(|w| w / scale.sqrt()),
            orientation: [0.96, 0.0, 0.0, 0.28],
            ..Obstacle::mesh([2.6 * scale, 3.2 * scale, top + 0.6 * scale], facets, 0)
        },
    ];
    for (k, body) in bodies.into_iter().enumerate() {
        let material = (k % 3) as u8;
        store.add_obstacle(Obstacle { material, ..body }).unwrap();
    }
}

/// A square of nine smaller ones, each of two triangles, with hills and hollows.
pub fn uneven(scale: f64) -> Vec<Facet<f64>> {
    const HEIGHTS: [[f64; 4]; 4] = [
        [0.0, 0.1, -0.1, 0.05],
        [0.1, -0.15, 0.2, 0.0],
        [-0.02, 0.2, -0.2, 0.1],
        [0.0, 0.0, 0.1, -0.1],
    ];
    let corner = |x: usize, y: usize| {
        let flat = |k: usize| (k as f64 - 1.5) * 0.55 * scale;
        [flat(x), flat(y), HEIGHTS[x][y] * scale]
    };
    let squares = (0..9).map(|k| (k / 3, k % 3));
    let triangles = squares.flat_map(|(x, y)| {
        let [a, b, c, d] =
            [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| corner(x, y));
        [Facet::new([a, b, c]), Facet::new([a, c, d])]
    });
    let mut facets: Vec<_> = triangles.collect();
    arrange(&mut facets);
    facets
}
