//! Forces on obstacles and of obstacles on grains: the first part of every grain's sum. An obstacle's
//! own sum runs over grains by ascending id.

use crate::contact::kept::{Kept, MEMORY_MAX};
use crate::contact::law::Law;
use crate::contact::react::{Contact, Reaction, react};
use crate::forces::accumulate::{ContactForce, GrainRange, Partner};
use crate::forces::force_check::ForceCheck;
use crate::forces::mesh_histories::hand_on;
use crate::integrate::GrainMotion;
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::rows::{add_at, get_or_default, row, set, sub_at};
use crate::math::vec3::{Vec3, add, cross, head, scale, sub};
use crate::neighbors::memory::{MemoryColumns, has_room, put, taken};
use crate::neighbors::pair_list::{PLACE, TOUCHING, obstacle_of, surface_of};
use crate::state::facet::Facet;
use crate::state::grains::material_of;
use crate::state::obstacle::{Meeting, Obstacle};

/// Storage of the obstacle contacts: the list and the obstacles' own sums.
pub struct ObstacleContactRange<'a, R> {
    /// Place of each contact's grain.
    pub grain: &'a [u32],
    /// Number of its obstacle, with the touching bit.
    pub obstacle: &'a mut [u32],
    /// Its tangential spring.
    pub spring: &'a mut [Row<R>],
    /// The law's words.
    pub memory: MemoryColumns<'a, R>,
    /// Where to note what each contact takes from the sums of its obstacle, for a host of several worlds that adds
    /// them up itself with [`sum_on_obstacles`]; empty if that is not wanted.
    pub shares: &'a mut [ObstacleShare<R>],
    /// All obstacles.
    pub obstacles: &'a mut [Obstacle<R>],
    /// The triangles of all meshes.
    pub facets: &'a [Facet<R>],
}

/// What a contact takes from the force and the torque on its obstacle; zero if it does not touch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ObstacleShare<R> {
    /// Number of the obstacle.
    pub obstacle: u32,
    /// Force on the grain.
    pub force: Vec3<R>,
    /// Its moment about the obstacle's point.
    pub torque: Vec3<R>,
}

impl<R> ObstacleShare<R> {
    fn of(obstacle: u32, force: Vec3<R>, torque: Vec3<R>) -> Self {
        Self {
            obstacle,
            force,
            torque,
        }
    }
}

/// Sets the force and torque on each obstacle to the sum of these shares, which come in the order of the contract: by
/// ascending id of the grain, and then by obstacle.
pub fn sum_on_obstacles<R: Real>(
    obstacles: &mut [Obstacle<R>],
    shares: impl Iterator<Item = ObstacleShare<R>>,
) {
    for body in obstacles.iter_mut() {
        body.force = [R::ZERO; 3];
        body.torque = [R::ZERO; 3];
    }
    for share in shares {
        if let Some(body) = obstacles.get_mut(share.obstacle as usize) {
            body.force = sub(body.force, share.force);
            body.torque = sub(body.torque, share.torque);
        }
    }
}

/// Adds the obstacles' share to forces that are zero, by ascending grain and obstacle, and sets the
/// force and torque on each obstacle to the sum over the grains in the same order. Tells the first grain
/// and obstacle that overlap too deep, and the first obstacle whose sums are not finite. `watch` sees every contact and
/// cannot change one.
#[inline(always)]
pub fn obstacle_forces<R: Real, L: Law<R>>(
    part: &mut GrainRange<'_, R>,
    touch: &mut ObstacleContactRange<'_, R>,
    law: &L,
    mut watch: impl FnMut(ContactForce<R>),
) -> ForceCheck {
    let (grains, dt) = (&mut part.grains, part.dt);
    let mut deep = None;
    for body in touch.obstacles.iter_mut() {
        body.force = [R::ZERO; 3];
        body.torque = [R::ZERO; 3];
    }
    if !touch.facets.is_empty() {
        hand_on(
            grains,
            (touch.grain, touch.obstacle),
            (touch.spring, &mut touch.memory),
            (touch.obstacles, touch.facets),
        );
    }
    let facets = touch.facets;
    let listed = touch.grain.iter().zip(touch.obstacle.iter_mut());
    for (t, ((grain, obstacle), spring)) in listed.zip(touch.spring.iter_mut()).enumerate() {
        let i = *grain as usize;
        let (word, k) = (*obstacle & PLACE, obstacle_of(*obstacle));
        let Some(body) = touch.obstacles.get_mut(k as usize) else {
            continue;
        };
        let (contact, met) = obstacle_contact(grains, body, (surface_of(word), facets), i);
        let memory = match L::MEMORY > 0 {
            true => taken(&touch.memory, t),
            false => [R::ZERO; MEMORY_MAX],
        };
        if !contact.acts(law, memory) {
            *obstacle = word;
            *spring = [R::ZERO; 4];
            if L::MEMORY > 0 {
                put(&mut touch.memory, t, [R::ZERO; MEMORY_MAX]);
            }
            set(touch.shares, t, ObstacleShare::default());
            continue;
        }
        let kept = Kept {
            spring: head(*spring),
            memory,
        };
        let r = shared(react(law, &contact, kept, dt), met.share);
        let push = add(scale(contact.normal, r.normal), r.tangential);
        let couple = cross(contact.normal, r.tangential);
        // A ball's lever is the law's, as for two grains. Elsewhere the force acts where the grain's
        // lever ends, and its moment is about the obstacle's point.
        let mut moment = if contact.radius_j > R::ZERO {
            scale(couple, r.lever_arm_j)
        } else {
            cross(sub(met.offset, scale(contact.normal, r.lever_arm_i)), push)
        };
        *obstacle = word | TOUCHING;
        *spring = row(r.kept.spring);
        add_at(grains.force, i, &row(push));
        sub_at(grains.torque, i, &row(scale(couple, r.lever_arm_i)));
        if L::TURNS {
            add_at(grains.torque, i, &row(r.torque));
            moment = add(moment, r.torque);
        }
        if L::MEMORY > 0 {
            put(&mut touch.memory, t, r.kept.memory);
        }
        body.force = sub(body.force, push);
        body.torque = sub(body.torque, moment);
        set(touch.shares, t, ObstacleShare::of(k, push, moment));
        watch(ContactForce {
            i: i as u32,
            partner: Partner::Obstacle(k),
            surface: surface_of(word),
            overlap: contact.overlap,
            normal: contact.normal,
            normal_force: r.normal,
            tangential_force: r.tangential,
            torque: r.torque,
        });
        if contact.overlap > body.depth_allowed(contact.radius_i) && deep.is_none() {
            deep = Some((get_or_default(grains.id, i), k));
        }
    }
    ForceCheck {
        unsound: ForceCheck::of_obstacles(touch.obstacles),
        on_obstacle: deep,
        misfit: !has_room(&touch.memory, L::MEMORY, touch.grain.len()),
        ..ForceCheck::NONE
    }
}

/// The part of a reaction that counts; all of it but at a hollow crease of a mesh.
#[inline(always)]
fn shared<R: Real>(mut r: Reaction<R>, share: R) -> Reaction<R> {
    if share < R::ONE {
        r.normal = r.normal * share;
        r.tangential = scale(r.tangential, share);
        r.torque = scale(r.torque, share);
    }
    r
}

/// The contact of grain `i` on a surface of an obstacle, and where it meets it.
#[inline(always)]
fn obstacle_contact<R: Real>(
    grains: &GrainMotion<'_, R>,
    body: &Obstacle<R>,
    (surface, facets): (u32, &[Facet<R>]),
    i: usize,
) -> (Contact<R>, Meeting<R>) {
    let x = get_or_default(grains.position, i);
    let (v, w) = (
        get_or_default(grains.velocity, i),
        get_or_default(grains.spin, i),
    );
    let meeting = body.meet(surface, facets, grains.domain, head(x), x[3]);
    let flat = meeting.curvature == R::ZERO;
    let curved = (x[3] * meeting.curvature) / (x[3] + meeting.curvature);
    let (own, spin) = body.contact_motion(&meeting, x[3]);
    let contact = Contact {
        normal: meeting.normal,
        overlap: meeting.overlap,
        radius_i: x[3],
        radius_j: body.ball_radius(),
        radius_effective: if flat { x[3] } else { curved },
        mass_effective: R::ONE / (w[3] + body.inverse_mass),
        inverse_masses: [w[3], body.inverse_mass],
        materials: [material_of((grains.group, grains.groups), i), body.material],
        velocity: sub(head(v), own),
        spin_i: head(w),
        spin_j: spin,
        turning_j: body.angular_velocity,
    };
    (contact, meeting)
}
