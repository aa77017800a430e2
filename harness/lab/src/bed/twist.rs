//! Twist: the spin of a grain about the normal of its only contact, which no law here resists.
//!
//! Without resistance to rolling such a grain rolls on, and the next grain that it meets takes its twist. With it the
//! grain stays on its one contact, on a floor or on another grain, and twists for ever, however still the bed is.

use bitgrain_kernel::vec3::{Vec3, dot, head, scale, sub};
use bitgrain_kernel::{ContactHistory, Error as KernelError, obstacle_of, surface_of};

use bitgrain_sim::simulation::Simulation;

/// A grain that twists, by its place, and the part of its spin along the normal of its only contact.
pub(super) struct Twist {
    grain: usize,
    spin: Vec3<f64>,
}

/// The grains that twist. Those with several contacts slide on all but one of them, which resist.
pub(super) fn twists(sim: &mut Simulation) -> Vec<Twist> {
    // How many contacts a grain has, and a vector along the normal of the last of them.
    let mut touched = vec![(0, [0.0; 3]); sim.count()];
    let mut touch = |grain: u32, along: Vec3<f64>| {
        let (count, normal) = &mut touched[grain as usize];
        (*count, *normal) = (*count + 1, along);
    };
    let histories = sim.contact_histories();
    let place = |grain: u32| head(sim.position[grain as usize]);
    for contact in histories.contacts() {
        match *contact {
            ContactHistory::Pair { i, j, .. } => {
                let apart = sim.domain.separation(place(i), place(j));
                touch(i, apart);
                touch(j, apart);
            }
            ContactHistory::Obstacle { i, obstacle, .. } => {
                let body = &sim.obstacles[obstacle_of(obstacle) as usize];
                let radius = sim.position[i as usize][3];
                let surface = surface_of(obstacle);
                let met = body.meet(surface, &sim.facets, &sim.domain, place(i), radius);
                touch(i, met.normal);
            }
        }
    }
    let ones = touched.into_iter().enumerate();
    let ones = ones.filter(|(_, (count, _))| *count == 1);
    let twist = |(grain, (_, along)): (usize, (u32, Vec3<f64>))| {
        let share = dot(head(sim.spin[grain]), along) / dot(along, along);
        let spin = scale(along, share);
        (share != 0.0).then_some(Twist { grain, spin })
    };
    ones.filter_map(twist).collect()
}

/// Kinetic energy of twists.
pub(super) fn energy(sim: &Simulation, twists: &[Twist]) -> f64 {
    let of = |twist: &Twist| {
        let (mass, radius) = (sim.velocity[twist.grain][3], sim.position[twist.grain][3]);
        0.5 * mass * (0.4 * radius * radius * dot(twist.spin, twist.spin))
    };
    twists.iter().map(of).sum()
}

/// Stops them; whatever else moves goes on, with all contacts and forces.
pub(super) fn stop(sim: &mut Simulation, twists: &[Twist]) -> Result<(), KernelError> {
    let histories = sim.contact_histories();
    for Twist { grain, spin } in twists {
        let row = &mut sim.spin[*grain];
        let [x, y, z] = sub(head(*row), *spin);
        *row = [x, y, z, row[3]];
    }
    sim.resume(&histories)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_kernel::{Domain, Group, Obstacle};
    use bitgrain_sim::law::{HertzTsujiParameters, LawSpec, RollingSpec};
    use bitgrain_sim::simulation::Grain;

    /// Grains of diameter 1 that lie on a floor, spinning, under a law with resistance to rolling.
    fn lying(places: &[[f64; 3]], spin: [f64; 3]) -> Simulation {
        let law = LawSpec::HertzTsuji(HertzTsujiParameters {
            young: 1e5,
            poisson: 0.3,
            restitution: 0.5,
            mu: 0.5,
            rolling: Some(RollingSpec::Sds {
                k: 60.0,
                gamma: 0.3,
                mu: 0.1,
            }),
        });
        let grain = |(k, position): (usize, &[f64; 3])| Grain {
            id: k as u32 + 1,
            group: 0,
            diameter: 1.0,
            density: 1.0,
            position: *position,
            velocity: [0.0; 3],
            spin,
        };
        let grains: Vec<Grain> = places.iter().enumerate().map(grain).collect();
        let domain = Domain::new([0.0; 3], [8.0; 3], [true, true, false]).unwrap();
        let groups = vec![Group::free([0.0, 0.0, -1.0])];
        let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
        let law = law.build().unwrap();
        let mut sim = Simulation::new(law, domain, 1e-3, groups, &grains, vec![floor]);
        sim.start().unwrap();
        sim
    }

    /// A grain alone on the floor, and one on top of a pair that lies there, twist; the pair slides, and what flies
    /// touches nothing.
    #[test]
    fn a_grain_twists_about_its_only_contact() {
        let low = 0.4995;
        let top = low + 0.9995;
        let places = [
            [1.0, 1.0, low],
            [4.0, 4.0, low],
            [4.999, 4.0, low],
            [4.0, 4.0, top],
            [6.0, 1.0, 3.0],
        ];
        let mut sim = lying(&places, [0.2, 0.0, 3.0]);
        let found = twists(&mut sim);
        let grains: Vec<usize> = found.iter().map(|twist| twist.grain).collect();
        assert_eq!(grains, [0, 3]);
        let along_z =
            |twist: &Twist| (twist.spin[2] - 3.0).abs() < 1e-12 && twist.spin[..2] == [0.0; 2];
        assert!(found.iter().all(along_z));
        // Two fifths of m r^2, and a half of it times the spin's square.
        let mass = sim.velocity[0][3];
        let each = 0.5 * 0.4 * mass * 0.25 * 9.0;
        assert!((energy(&sim, &found) / (2.0 * each) - 1.0).abs() < 1e-12);
        let before = sim.kinetic_energy();
        stop(&mut sim, &found).unwrap();
        assert!((before - sim.kinetic_energy() - 2.0 * each).abs() < 1e-12);
        let [x, y, z] = head(sim.spin[0]);
        assert!(x == 0.2 && y == 0.0 && z.abs() < 1e-12, "{x} {y} {z}");
        assert_eq!(sim.spin[1][2], 3.0);
        // Of what is stopped rounding is left.
        let left = twists(&mut sim);
        assert!(energy(&sim, &left) < 1e-24);
    }

    /// What is stopped is what no step takes.
    #[test]
    fn nothing_resists_twist() {
        let mut sim = lying(&[[1.0, 1.0, 0.4995]], [0.2, 0.0, 3.0]);
        sim.steps(20_000).unwrap();
        let [x, y, z, _] = sim.spin[0];
        assert!(
            x.abs() < 1e-3 && y.abs() < 1e-3 && (z - 3.0).abs() < 1e-9,
            "{x} {y} {z}"
        );
        let all = twists(&mut sim);
        assert!(energy(&sim, &all) > 0.999 * sim.kinetic_energy());
    }
}
