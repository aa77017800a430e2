//! A custom contact law: a linear spring and a dashpot, and a spring with a friction limit along the contact.
//! `cargo run -p bitgrain-kernel --example own_contact_law`

use bitgrain_kernel::contact::{Law, NormalForce, NormalState, TangentialForce, TangentialState};
use bitgrain_kernel::vec3::{dot, scale};
use bitgrain_kernel::{Domain, Error, Group, Obstacle, Real, Store, start, step};

/// Force `kn delta - cn v` along the normal, never a pull; `kt` times the tangential spring, at most `mu` times that.
#[derive(Clone, Copy)]
struct SpringDashpot<R> {
    kn: R,
    cn: R,
    kt: R,
    mu: R,
}

impl<R: Real> Law<R> for SpringDashpot<R> {
    fn normal_force(&self, c: &NormalState<R>) -> NormalForce<R> {
        let force = self.kn * c.overlap - self.cn * c.speed;
        NormalForce {
            force: if force > R::ZERO { force } else { R::ZERO },
            contact_radius: R::ONE,
            damping: R::ZERO,
            lever_arm_i: c.radius_i,
            lever_arm_j: c.radius_j,
        }
    }

    fn tangential_force(
        &self,
        normal: &NormalForce<R>,
        c: &TangentialState<R>,
    ) -> TangentialForce<R> {
        let pull = self.kt * dot(c.spring, c.spring).sqrt();
        let cap = self.mu * normal.force;
        let left = if pull > cap { cap / pull } else { R::ONE };
        let spring = scale(c.spring, left);
        TangentialForce {
            force: scale(spring, -self.kt),
            spring,
        }
    }
}

/// # Errors
/// What the kernel refuses.
pub fn main() -> Result<(), Error> {
    const DT: f64 = 1e-5;
    const MASS: f64 = std::f64::consts::FRAC_PI_6;
    let law = SpringDashpot {
        kn: 1e4,
        cn: 10.0,
        kt: 5e3,
        mu: 0.5,
    };
    let mut store = Store::<f64, 1, 4, 1, 1>::new(Domain::open(), DT, 0.1);
    store
        .add_group(Group::free([0.0; 3]))
        .expect("room for a group");
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    store.add_obstacle(floor).expect("room for a floor");
    store
        .add_grain(1, 0, [0.0, 0.0, 0.51], 0.5, MASS)
        .expect("room for a grain");

    let mut world = store.world();
    world.grains.velocity[0][2] = -1.0;
    start(&mut world, &law)?;
    for _ in 0..6000 {
        step(&mut world, &law)?;
    }
    // A damped oscillator: e = exp(-pi beta / sqrt(1 - beta^2)) with beta = cn / (2 sqrt(kn m)). A force that does
    // not pull lets go a little earlier.
    let beta = law.cn / (2.0 * (law.kn * MASS).sqrt());
    let expected = (-std::f64::consts::PI * beta / (1.0 - beta * beta).sqrt()).exp();
    let restitution = world.grains.velocity[0][2];
    println!("restitution {restitution:.4}, of the damped oscillator {expected:.4}");
    assert!((restitution - expected).abs() < 0.02);
    Ok(())
}
