//! Motion: half kicks and drifts, each a pass over a range of grains.

use crate::domain::Domain;
use crate::fault::Fault;
use crate::grains::{Group, Row};
use crate::real::Real;
use crate::rows::{halves, halves_mut};
use crate::vec3::{Vec3, dot, head};

/// What a pass of motion reads and writes for a range of grains; ranges share nothing that is
/// written.
pub struct Moving<'a, R> {
    /// The box.
    pub domain: &'a Domain<R>,
    /// Time step.
    pub dt: R,
    /// Names, for faults.
    pub id: &'a [u32],
    /// Group of each grain.
    pub group: &'a [u8],
    /// The groups.
    pub groups: &'a [Group<R>],
    /// Positions and radii.
    pub position: &'a mut [Row<R>],
    /// Crossings of the periodic axes.
    pub image: &'a mut [[i32; 3]],
    /// Contact forces.
    pub force: &'a [Row<R>],
    /// Contact torques.
    pub torque: &'a [Row<R>],
    /// Velocities and masses.
    pub velocity: &'a mut [Row<R>],
    /// Spins and inverse contact masses.
    pub spin: &'a mut [Row<R>],
}

impl<'a, R: Real> Moving<'a, R> {
    /// The first `grains` grains of the range, and the others.
    pub fn split(self, grains: usize) -> (Self, Self) {
        let id = halves(self.id, grains);
        let group = halves(self.group, grains);
        let position = halves_mut(self.position, grains);
        let image = halves_mut(self.image, grains);
        let force = halves(self.force, grains);
        let torque = halves(self.torque, grains);
        let velocity = halves_mut(self.velocity, grains);
        let spin = halves_mut(self.spin, grains);
        let left = Self {
            domain: self.domain,
            dt: self.dt,
            id: id.0,
            group: group.0,
            groups: self.groups,
            position: position.0,
            image: image.0,
            force: force.0,
            torque: torque.0,
            velocity: velocity.0,
            spin: spin.0,
        };
        let right = Self {
            domain: self.domain,
            dt: self.dt,
            id: id.1,
            group: group.1,
            groups: self.groups,
            position: position.1,
            image: image.1,
            force: force.1,
            torque: torque.1,
            velocity: velocity.1,
            spin: spin.1,
        };
        (left, right)
    }
}

/// Change of velocity and of spin in half a step: `(F/m + g) h` and `(T/m) / (0.4 r^2) h`, with
/// `h = dt/2`, in that order.
#[inline(always)]
fn half_kick<R: Real>(
    group: &Group<R>,
    mass: R,
    radius: R,
    force: &Row<R>,
    torque: &Row<R>,
    half: R,
) -> (Vec3<R>, Vec3<R>) {
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

#[inline(always)]
fn kicked<R: Real>(row: Row<R>, by: Vec3<R>) -> Row<R> {
    [row[0] + by[0], row[1] + by[1], row[2] + by[2], row[3]]
}

/// Half a kick and a drift: the first half of a step. Grains wrap straight after the drift.
///
/// # Errors
/// [`Fault::Escaped`] with the lowest id that is outside a closed edge; every grain has moved.
#[inline(always)]
pub fn kick_and_drift<R: Real>(m: &mut Moving<'_, R>) -> Result<(), Fault> {
    let (dt, half) = (m.dt, m.dt * R::HALF);
    let mut escaped = None;
    let places = m.position.iter_mut().zip(m.image.iter_mut());
    let speeds = m.velocity.iter_mut().zip(m.spin.iter_mut());
    let pushes = m.force.iter().zip(m.torque);
    let names = m.group.iter().zip(m.id);
    for ((((x, image), (v, w)), (force, torque)), (group, id)) in
        places.zip(speeds).zip(pushes).zip(names)
    {
        let Some(group) = m.groups.get(usize::from(*group)) else {
            continue;
        };
        let (dv, dw) = half_kick(group, v[3], x[3], force, torque, half);
        *v = kicked(*v, dv);
        *w = kicked(*w, dw);
        let mut to = [x[0] + v[0] * dt, x[1] + v[1] * dt, x[2] + v[2] * dt];
        let inside = m.domain.wrap(&mut to, image);
        *x = [to[0], to[1], to[2], x[3]];
        if !inside && escaped.is_none() {
            escaped = Some(*id);
        }
    }
    escaped.map_or(Ok(()), |id| Err(Fault::Escaped { id }))
}

/// The second half kick; returns the square of the highest speed that the next step will drift
/// with, so that a search can come before anything moves.
///
/// # Errors
/// [`Fault::NotFinite`] or [`Fault::TooFast`] (more than its own radius in one step), the lowest id
/// first.
#[inline(always)]
pub fn kick<R: Real>(m: &mut Moving<'_, R>) -> Result<R, Fault> {
    look_ahead(m, true)
}

/// What [`kick`] returns, of grains that stay as they are: before the first step.
///
/// # Errors
/// As [`kick`].
pub fn foresee<R: Real>(m: &mut Moving<'_, R>) -> Result<R, Fault> {
    look_ahead(m, false)
}

#[inline(always)]
fn look_ahead<R: Real>(m: &mut Moving<'_, R>, apply: bool) -> Result<R, Fault> {
    let (dt, half) = (m.dt, m.dt * R::HALF);
    let mut fastest = R::ZERO;
    let mut sound = true;
    let speeds = m.velocity.iter_mut().zip(m.spin.iter_mut());
    let pushes = m.force.iter().zip(m.torque);
    let bodies = m.group.iter().zip(m.position.iter());
    for (((v, w), (force, torque)), (group, x)) in speeds.zip(pushes).zip(bodies) {
        let Some(group) = m.groups.get(usize::from(*group)) else {
            continue;
        };
        let (dv, dw) = half_kick(group, v[3], x[3], force, torque, half);
        if apply {
            *v = kicked(*v, dv);
            *w = kicked(*w, dw);
        }
        let (speed2, slow) = next_speed(*v, dv, x[3], dt);
        sound = sound && slow && others(*w, force, torque) <= R::MAX;
        fastest = if speed2 > fastest { speed2 } else { fastest };
    }
    if sound { Ok(fastest) } else { Err(blame(m)) }
}

/// Square of the speed of the next drift, and whether that stays below a radius a step. Comparisons
/// with NaN are false, so what is not slow is everything that is not sound.
#[inline(always)]
fn next_speed<R: Real>(v: Row<R>, dv: Vec3<R>, radius: R, dt: R) -> (R, bool) {
    let next = head(kicked(v, dv));
    let speed2 = dot(next, next);
    (speed2, speed2 * (dt * dt) < radius * radius)
}

/// Squares of spin, force and torque together: finite where all of them are.
#[inline(always)]
fn others<R: Real>(w: Row<R>, force: &Row<R>, torque: &Row<R>) -> R {
    let (force, torque) = (head(*force), head(*torque));
    let pushed2 = dot(force, force) + dot(torque, torque);
    dot(head(w), head(w)) + pushed2
}

#[cold]
fn blame<R: Real>(m: &Moving<'_, R>) -> Fault {
    let (dt, half) = (m.dt, m.dt * R::HALF);
    let speeds = m.velocity.iter().zip(m.spin.iter());
    let pushes = m.force.iter().zip(m.torque);
    let bodies = m.group.iter().zip(m.position.iter()).zip(m.id);
    for (((v, w), (force, torque)), ((group, x), id)) in speeds.zip(pushes).zip(bodies) {
        let Some(group) = m.groups.get(usize::from(*group)) else {
            continue;
        };
        let (dv, _) = half_kick(group, v[3], x[3], force, torque, half);
        let (speed2, slow) = next_speed(*v, dv, x[3], dt);
        if !speed2.is_finite() || !others(*w, force, torque).is_finite() {
            return Fault::NotFinite { id: *id };
        }
        if !slow {
            return Fault::TooFast { id: *id };
        }
    }
    // Unreachable: the pass above found one of these.
    Fault::NotFinite { id: 0 }
}
