//! Motion: half kicks and drifts, each a pass over a range of grains.

use crate::domain::Domain;
use crate::fault::Fault;
use crate::grains::{Group, Row};
use crate::real::Real;
use crate::vec3::{dot, head};

/// What a kick reads and writes for a range of grains.
pub struct Kick<'a, R> {
    /// Names, for faults.
    pub id: &'a [u32],
    /// Group of each grain.
    pub group: &'a [u8],
    /// The groups.
    pub groups: &'a [Group<R>],
    /// Positions and radii.
    pub position: &'a [Row<R>],
    /// Contact forces.
    pub force: &'a [Row<R>],
    /// Contact torques.
    pub torque: &'a [Row<R>],
    /// Velocities and masses.
    pub velocity: &'a mut [Row<R>],
    /// Spins and inverse masses.
    pub spin: &'a mut [Row<R>],
}

/// Change of velocity and of spin in half a step: `(F/m + g) h` and `(T/m) / (0.4 r^2) h`, with
/// `1/m` stored and `h = dt/2`, in that order.
#[inline(always)]
fn half_kick<R: Real>(
    group: &Group<R>,
    mass: R,
    radius: R,
    force: Row<R>,
    torque: Row<R>,
    half: R,
) -> ([R; 3], [R; 3]) {
    let per_mass = R::ONE / mass;
    let per_inertia = per_mass / ((radius * radius) * R::from_f64(0.4));
    let mut dv = [R::ZERO; 3];
    let mut dw = [R::ZERO; 3];
    for a in 0..3 {
        let pull = (force[a] * per_mass + group.gravity[a]) * half;
        let turn = (torque[a] * per_inertia) * half;
        dv[a] = if group.integrates[a] { pull } else { R::ZERO };
        dw[a] = if group.spins { turn } else { R::ZERO };
    }
    (dv, dw)
}

/// Gives each grain its first half kick of a step.
#[inline(always)]
pub fn begin_kick<R: Real>(k: &mut Kick<'_, R>, half: R) {
    for i in 0..k.velocity.len() {
        let group = &k.groups[k.group[i] as usize];
        let (v, w) = (k.velocity[i], k.spin[i]);
        let (dv, dw) = half_kick(group, v[3], k.position[i][3], k.force[i], k.torque[i], half);
        k.velocity[i] = [v[0] + dv[0], v[1] + dv[1], v[2] + dv[2], v[3]];
        k.spin[i] = [w[0] + dw[0], w[1] + dw[1], w[2] + dw[2], w[3]];
    }
}

/// Gives each grain its second half kick and returns the square of the highest speed that the next
/// step will drift with, so that a search can come before anything moves.
///
/// # Errors
/// [`Fault::NotFinite`] or [`Fault::TooFast`] (more than its own radius in one step), the lowest id
/// first.
#[inline(always)]
pub fn end_kick<R: Real>(k: &mut Kick<'_, R>, half: R, dt: R, apply: bool) -> Result<R, Fault> {
    let mut fastest = R::ZERO;
    let mut sound = true;
    for i in 0..k.velocity.len() {
        let group = &k.groups[k.group[i] as usize];
        let (v, w) = (k.velocity[i], k.spin[i]);
        let radius = k.position[i][3];
        let (dv, dw) = half_kick(group, v[3], radius, k.force[i], k.torque[i], half);
        let mut full = v;
        let mut spun = w;
        if apply {
            full = [v[0] + dv[0], v[1] + dv[1], v[2] + dv[2], v[3]];
            spun = [w[0] + dw[0], w[1] + dw[1], w[2] + dw[2], w[3]];
        }
        k.velocity[i] = full;
        k.spin[i] = spun;
        let next = [full[0] + dv[0], full[1] + dv[1], full[2] + dv[2]];
        let speed2 = dot(next, next);
        let spin2 = dot(head(spun), head(spun));
        let (force, torque) = (head(k.force[i]), head(k.torque[i]));
        let pushed2 = dot(force, force) + dot(torque, torque);
        // Comparisons with NaN are false, so these find everything that is not sound.
        let slow = speed2 * (dt * dt) < radius * radius;
        sound = sound && slow && spin2 + pushed2 <= R::MAX;
        fastest = if speed2 > fastest { speed2 } else { fastest };
    }
    if sound {
        Ok(fastest)
    } else {
        Err(blame(k, half, dt))
    }
}

#[cold]
fn blame<R: Real>(k: &Kick<'_, R>, half: R, dt: R) -> Fault {
    for i in 0..k.velocity.len() {
        let id = k.id[i];
        let group = &k.groups[k.group[i] as usize];
        let (v, w, radius) = (k.velocity[i], k.spin[i], k.position[i][3]);
        let (dv, _) = half_kick(group, v[3], radius, k.force[i], k.torque[i], half);
        let next = [v[0] + dv[0], v[1] + dv[1], v[2] + dv[2]];
        let (speed2, spin2) = (dot(next, next), dot(head(w), head(w)));
        let (force, torque) = (head(k.force[i]), head(k.torque[i]));
        let pushed2 = dot(force, force) + dot(torque, torque);
        if !speed2.is_finite() || !(spin2 + pushed2).is_finite() {
            return Fault::NotFinite { id };
        }
        let slow = speed2 * (dt * dt) < radius * radius;
        if !slow {
            return Fault::TooFast { id };
        }
    }
    // Unreachable: the pass above found one of these.
    Fault::NotFinite { id: 0 }
}

/// Moves each grain by one step and wraps it.
///
/// # Errors
/// [`Fault::Escaped`] with the lowest id that is outside a closed edge.
#[inline(always)]
pub fn drift<R: Real>(
    domain: &Domain<R>,
    id: &[u32],
    position: &mut [Row<R>],
    image: &mut [[i32; 3]],
    velocity: &[Row<R>],
    dt: R,
) -> Result<(), Fault> {
    let mut escaped = None;
    for i in 0..position.len() {
        let (x, v) = (position[i], velocity[i]);
        let mut to = [x[0] + v[0] * dt, x[1] + v[1] * dt, x[2] + v[2] * dt];
        let inside = domain.wrap(&mut to, &mut image[i]);
        position[i] = [to[0], to[1], to[2], x[3]];
        if !inside && escaped.is_none() {
            escaped = Some(id[i]);
        }
    }
    escaped.map_or(Ok(()), |id| Err(Fault::Escaped { id }))
}
