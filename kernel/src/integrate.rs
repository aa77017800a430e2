//! Motion: half kicks and drifts, each a pass over a range of grains.

use core::hint::cold_path;

use crate::error::Error;
use crate::math::real::{Real, larger};
use crate::math::rows::Row;
use crate::math::rows::{halves_mut, min, part, part_mut, plus, split_at, times};
use crate::math::vec3::{Vec3, dot, head, scale};
use crate::state::domain::Domain;
use crate::state::grains::{Grains, Group};

/// What a pass of motion reads and writes for some grains. Two pieces share nothing that is
/// written.
pub struct GrainMotion<'a, R> {
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
    pub force: &'a mut [Row<R>],
    /// Contact torques.
    pub torque: &'a mut [Row<R>],
    /// Velocities and masses.
    pub velocity: &'a mut [Row<R>],
    /// Spins and inverse contact masses.
    pub spin: &'a mut [Row<R>],
}

impl<'a, R: Real> GrainMotion<'a, R> {
    /// All grains.
    #[inline(always)]
    pub(crate) fn of_all(g: &'a mut Grains<'_, R>, domain: &'a Domain<R>, dt: R) -> Self {
        Self {
            domain,
            dt,
            id: g.id,
            group: g.group,
            groups: g.groups,
            position: g.position,
            image: g.image,
            force: g.force,
            torque: g.torque,
            velocity: g.velocity,
            spin: g.spin,
        }
    }

    /// The first `grains` grains of the range, and the others.
    pub fn split(self, grains: usize) -> (Self, Self) {
        let id = split_at(self.id, grains);
        let group = split_at(self.group, grains);
        let position = halves_mut(self.position, grains);
        let image = halves_mut(self.image, grains);
        let force = halves_mut(self.force, grains);
        let torque = halves_mut(self.torque, grains);
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

    /// How many grains have all their rows.
    #[inline(always)]
    pub fn count(&self) -> usize {
        let moving = min(self.position.len(), self.velocity.len());
        let pushed = min(self.force.len(), self.torque.len());
        min(min(moving, self.spin.len()), pushed)
    }

    /// The grains from `begin` to `end` of the range, lent.
    #[inline(always)]
    pub fn stretch(&mut self, begin: usize, end: usize) -> GrainMotion<'_, R> {
        GrainMotion {
            domain: self.domain,
            dt: self.dt,
            id: part(self.id, begin, end),
            group: part(self.group, begin, end),
            groups: self.groups,
            position: part_mut(self.position, begin, end),
            image: part_mut(self.image, begin, end),
            force: part_mut(self.force, begin, end),
            torque: part_mut(self.torque, begin, end),
            velocity: part_mut(self.velocity, begin, end),
            spin: part_mut(self.spin, begin, end),
        }
    }
}

/// Change of velocity and of spin in half a step: `(F/m + g) h` and `(T/I) h`, with `h = dt/2`, in that order, where
/// `F/m` is `F (1/m)` and `T/I` is `T (1/I)`; [`per_inertia`] stands in the last word of the torque. The last words of
/// the changes are zero.
#[inline(always)]
fn half_kick<R: Real>(
    gravity: Row<R>,
    per_mass: R,
    force: &Row<R>,
    torque: &Row<R>,
    half: R,
) -> (Row<R>, Row<R>) {
    let dv = times(&plus(&times(force, per_mass), &gravity), half);
    let mut dw = times(&times(torque, torque[3]), half);
    dw[3] = R::ZERO;
    (dv, dw)
}

/// One over the moment of inertia of a sphere: `(1/m) / (0.4 r^2)`. It is kept, so that no step divides.
#[inline(always)]
pub(crate) fn per_inertia<R: Real>(mass: R, radius: R) -> R {
    (R::ONE / mass) / ((radius * radius) * R::from_f64(0.4))
}

/// The velocity at which the first grain of a range drifts next, if this is the row of its velocity now.
pub(crate) fn next_velocity<R: Real>(m: &GrainMotion<'_, R>, v: &Row<R>) -> Vec3<R> {
    let pushes = m.force.first().zip(m.torque.first());
    let group = m
        .group
        .first()
        .and_then(|own| m.groups.get(usize::from(*own)));
    let (Some((force, torque)), Some(group)) = (pushes, group) else {
        return [R::ZERO; 3];
    };
    let (dv, _) = answered(group, v[3], force, torque, m.dt * R::HALF);
    head(plus(v, &dv))
}

/// A vector as a row that keeps the last word of a row it is added to: adding -0.0 changes no number.
#[inline(always)]
fn addend<R: Real>(v: Vec3<R>) -> Row<R> {
    [v[0], v[1], v[2], -R::ZERO]
}

/// How a group moves, as rows.
#[derive(Clone, Copy)]
struct Manner<R> {
    number: u8,
    gravity: Row<R>,
    /// Whether its grains answer all forces and torques, with the mass that they have in contacts.
    free: bool,
}

impl<R: Real> Manner<R> {
    #[inline(always)]
    fn of(number: u8, group: &Group<R>) -> Self {
        Self {
            number,
            gravity: addend(group.gravity),
            free: group.integrates == [true; 3] && group.spins && !group.infinite_mass,
        }
    }
}

/// The changes that a grain of any group answers to.
#[inline(never)]
fn answered<R: Real>(
    group: &Group<R>,
    mass: R,
    force: &Row<R>,
    torque: &Row<R>,
    half: R,
) -> (Row<R>, Row<R>) {
    let per_mass = R::ONE / mass;
    let (mut dv, dw) = half_kick(addend(group.gravity), per_mass, force, torque, half);
    for a in 0..3 {
        if !group.integrates[a] {
            dv[a] = R::ZERO;
        }
    }
    (dv, if group.spins { dw } else { [R::ZERO; 4] })
}

/// What a pass of motion found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionCheck<R> {
    /// Square of the highest speed of the drift that comes next, or that was done.
    pub speed2: R,
    /// [`Error::NotFinite`] or [`Error::TooFast`] (more than its own radius in one step) of the lowest
    /// id in the kicked state.
    pub unsound: Option<Error>,
    /// [`Error::Escaped`] with the lowest id that the drift took beyond a closed edge.
    pub escaped: Option<Error>,
    /// Whether a grain is behind the drain of the [`LossPolicy`](crate::LossPolicy): for a host of several worlds, see
    /// [`is_draining`](crate::phases::is_draining).
    pub draining: bool,
}

impl<R: Real> MotionCheck<R> {
    /// A pass over no grains.
    pub const NONE: Self = Self {
        speed2: R::ZERO,
        unsound: None,
        escaped: None,
        draining: false,
    };

    /// This pass and one over other grains.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self {
            speed2: larger(self.speed2, other.speed2),
            unsound: Error::first(self.unsound, other.unsound),
            escaped: Error::first(self.escaped, other.escaped),
            draining: self.draining || other.draining,
        }
    }
}

/// What a grain travels in a step at this square of a speed.
pub(crate) fn travel_at<R: Real>(speed2: R, dt: R) -> R {
    let speed2 = match R::FIXED_POINT {
        // Squares of slow speeds vanish.
        true => speed2 + (R::EPSILON + R::EPSILON),
        false => speed2,
    };
    speed2.sqrt() * dt
}

/// Which halves of a step's motion a pass does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionPhase {
    /// Nothing: only looks, before the first step.
    CheckOnly,
    /// Half a kick and a drift: the beginning of a step.
    Drift,
    /// Half a kick: the end of a step.
    Kick,
    /// The end of a step and the beginning of the next, over rows that are in the cache once.
    KickAndDrift,
}

/// One pass over a range of grains. Grains wrap straight after a drift, which also sets their forces
/// to zero for the sums to come.
#[inline(always)]
pub fn integrate<R: Real>(m: &mut GrainMotion<'_, R>, which: MotionPhase) -> MotionCheck<R> {
    let (dt, half) = (m.dt, m.dt * R::HALF);
    let drifts = matches!(which, MotionPhase::Drift | MotionPhase::KickAndDrift);
    let ends = matches!(which, MotionPhase::Kick | MotionPhase::KickAndDrift);
    let mut passed = MotionCheck::NONE;
    let Some(first) = m.groups.first() else {
        return passed;
    };
    let mut manner = Manner::of(0, first);
    let (lo, hi) = m.domain.rows();
    let places = m.position.iter_mut().zip(m.image.iter_mut());
    let speeds = m.velocity.iter_mut().zip(m.spin.iter_mut());
    let pushes = m.force.iter_mut().zip(m.torque.iter_mut());
    let names = m.group.iter().zip(m.id);
    for ((((x, image), (v, w)), (force, torque)), (group, id)) in
        places.zip(speeds).zip(pushes).zip(names)
    {
        if *group != manner.number
            && let Some(other) = m.groups.get(usize::from(*group))
        {
            manner = Manner::of(*group, other);
        }
        // Whole rows throughout; the last words of the changes are zero, and so those of mass and inverse mass
        // stay as they are.
        let (mut dv, mut dw) = half_kick(manner.gravity, w[3], force, torque, half);
        if !manner.free {
            cold_path();
            if let Some(group) = m.groups.get(usize::from(*group)) {
                (dv, dw) = answered(group, v[3], force, torque, half);
            }
        }
        let (now, turning) = if ends {
            (plus(v, &dv), plus(w, &dw))
        } else {
            (*v, *w)
        };
        let next = plus(&now, &dv);
        if which != MotionPhase::Drift {
            let speed2 = dot(head(next), head(next));
            // Comparisons with NaN are false, so what is not slow is everything that is not sound.
            let slow = if R::FIXED_POINT {
                // The square of a short time step would vanish.
                let way = scale(head(next), dt);
                // Without the square of a speed nobody knows how far bodies may approach.
                speed2.is_finite() && dot(way, way) < x[3] * x[3]
            } else {
                speed2 * (dt * dt) < x[3] * x[3]
            };
            let sound = if R::FIXED_POINT {
                [&turning, &*force, &*torque]
                    .iter()
                    .all(|row| row.iter().all(|x| x.is_finite()))
            } else {
                is_zero(&products_with_zero(&turning, force, torque))
            };
            if !(slow & sound) {
                cold_path();
                let fault = if speed2.is_finite() && sound {
                    Error::TooFast { id: *id }
                } else {
                    Error::not_finite::<R>(*id)
                };
                passed.unsound = passed.unsound.or(Some(fault));
            }
            passed.speed2 = larger(passed.speed2, speed2);
        }
        if drifts {
            *v = next;
            *w = plus(&turning, &dw);
            *force = [R::ZERO; 4];
            *torque = without_turn(torque);
            *x = plus(x, &times(&addend(head(next)), dt));
            // The last words are the radius and the number without limit.
            if !inside(&lo, x, &hi) {
                cold_path();
                let mut place = head(*x);
                if !m.domain.wrap(&mut place, image) {
                    passed.escaped = passed.escaped.or(Some(Error::Escaped { id: *id }));
                }
                *x = [place[0], place[1], place[2], x[3]];
            }
        } else if ends {
            *v = now;
            *w = turning;
        }
    }
    passed
}

/// The row of a torque that is zero: one over the moment of inertia stays.
#[inline(always)]
pub(crate) fn without_turn<R: Real>(torque: &Row<R>) -> Row<R> {
    [R::ZERO, R::ZERO, R::ZERO, torque[3]]
}

#[inline(always)]
fn is_zero<R: Real>(a: &Row<R>) -> bool {
    (a[0] == R::ZERO) & (a[1] == R::ZERO) & (a[2] == R::ZERO) & (a[3] == R::ZERO)
}

/// Whether `lo < x < hi` in every word, by the sign of one product. It may say no so near an edge
/// that the product vanishes; it never says yes outside.
#[inline(always)]
fn inside<R: Real>(lo: &Row<R>, x: &Row<R>, hi: &Row<R>) -> bool {
    if R::FIXED_POINT {
        let word = |a: usize| lo[a] < x[a] && x[a] < hi[a];
        return word(0) && word(1) && word(2);
    }
    let word = |a: usize| (x[a] - lo[a]) * (hi[a] - x[a]) > R::ZERO;
    word(0) & word(1) & word(2) & word(3)
}

/// Words that are zero if those of spin, force and torque are finite.
#[inline(always)]
fn products_with_zero<R: Real>(w: &Row<R>, force: &Row<R>, torque: &Row<R>) -> Row<R> {
    let zero = R::ZERO;
    let word = |a: usize| (w[a] * zero + force[a] * zero) + torque[a] * zero;
    [word(0), word(1), word(2), word(3)]
}
