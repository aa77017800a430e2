//! A block of contacts evaluated together, in columns: rows of grains in, forces in rows out.
//!
//! Each step of the evaluation is a separate loop over the block, short enough for a compiler to
//! put into the widest registers it may use, and with short chains of operations, so that a
//! processor need not wait for one root or division before it begins the next. The results of a loop
//! for the next one lie in columns that stay in the nearest cache. Nothing here branches on the data:
//! a pair that does not touch is evaluated too and gives +0.0, which changes no sum.

pub(crate) use crate::contact::columns::{BLOCK, Bodies};
use crate::contact::columns::{Column, Columns, NormalForces, Rows, STRIDE, put, taken};
use crate::contact::kept::{ContactMemory, MEMORY_MAX};
use crate::contact::law::{
    Law, NormalForce, NormalState, TangentialState, TurningState, has_torque,
};
use crate::contact::slide::{slide, surface_spin};
use crate::math::real::{Real, smaller};
use crate::math::rows::Row;
use crate::math::rows::{copy, get_or_default, less, min, part, part_mut, prefix, row};
use crate::math::vec3::{Vec3, add, cross, dot, either, head, scale};
use crate::state::domain::Domain;
use crate::state::grains::material_of;

/// The columns of a block.
#[cfg_attr(
    not(any(target_arch = "arm", target_arch = "riscv32")),
    repr(align(64))
)]
pub(crate) struct Block<R> {
    count: usize,
    /// Places of the lower grains, and of the higher ones.
    place: [[u32; BLOCK]; 2],
    /// Position of the lower grain less that of the higher one; the last word is unused.
    apart: Rows<R>,
    /// Velocity likewise.
    relative: Rows<R>,
    radius: [Column<R>; 2],
    /// Zeros if the law tells none apart.
    material: [[u8; BLOCK]; 2],
    /// Spins and inverse contact masses.
    spin: [Rows<R>; 2],
    normal: Columns<R>,
    overlap: Column<R>,
    speed: Column<R>,
    /// Which contacts act; only if the law says so itself.
    acts: [bool; BLOCK],
    normal_force: NormalForces<R>,
    sliding: Columns<R>,
    length2: Column<R>,
    /// Tangential springs, advanced and then left.
    spring: Columns<R>,
    tangential: Columns<R>,
    /// Force on the lower grain; the last word is zero.
    force: Rows<R>,
    /// Normal crossed with the tangential force.
    couple: Rows<R>,
    /// Torque on the lower grain beside that; zero if the law has none.
    torque: Rows<R>,
    /// The law's words, as they were and then as they are left; only as many columns as it has are used.
    memory: [Column<R>; MEMORY_MAX],
}

impl<R: Real> Block<R> {
    #[inline(always)]
    pub fn new() -> Self {
        let column = [R::ZERO; BLOCK];
        let columns = [column; 3];
        let rows = [[R::ZERO; 4]; BLOCK];
        Self {
            count: 0,
            place: [[0; BLOCK]; 2],
            apart: rows,
            relative: rows,
            radius: [column; 2],
            material: [[0; BLOCK]; 2],
            spin: [rows; 2],
            normal: columns,
            overlap: column,
            speed: column,
            acts: [false; BLOCK],
            normal_force: NormalForces {
                force: column,
                contact_radius: column,
                damping: column,
                lever_arm_i: column,
                lever_arm_j: column,
            },
            sliding: columns,
            length2: column,
            spring: columns,
            tangential: columns,
            force: rows,
            couple: rows,
            torque: rows,
            memory: [column; MEMORY_MAX],
        }
    }

    /// How many columns a loop runs over.
    #[inline(always)]
    fn whole(&self) -> usize {
        let whole = self.count.wrapping_add(STRIDE - 1) / STRIDE * STRIDE;
        if whole < BLOCK { whole } else { BLOCK }
    }

    /// Forgets its pairs.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// How many more pairs it can take.
    #[inline(always)]
    pub fn room(&self) -> usize {
        BLOCK - min(self.count, BLOCK)
    }

    /// Takes up the rows of these pairs, as many as there is room for, and what the law `L` has kept of them.
    #[inline(always)]
    pub fn fill<L: Law<R>>(
        &mut self,
        bodies: Bodies<'_, R>,
        lower: &[u32],
        partner: &[u32],
        (spring, memory): ([&[R]; 3], [&[R]; MEMORY_MAX]),
    ) {
        let begin = min(self.count, BLOCK);
        // One length for all rows, so that a place is checked once for all of them.
        let grains = min(bodies.position.len(), bodies.velocity.len());
        let grains = min(grains, bodies.spin.len());
        let position = prefix(bodies.position, grains);
        let velocity = prefix(bodies.velocity, grains);
        let spin = prefix(bodies.spin, grains);
        let end = begin + lower.len();
        copy(part_mut(&mut self.place[0], begin, end), lower);
        copy(part_mut(&mut self.place[1], begin, end), partner);
        let mut filled = begin;
        for (k, (i, j)) in (begin..).zip(lower.iter().zip(partner)) {
            if k >= BLOCK {
                break;
            }
            let i = *i as usize;
            let j = *j as usize;
            let (Some(x), Some(y)) = (position.get(i), position.get(j)) else {
                break;
            };
            let (Some(v), Some(u)) = (velocity.get(i), velocity.get(j)) else {
                break;
            };
            let (Some(w), Some(z)) = (spin.get(i), spin.get(j)) else {
                break;
            };
            // Whole rows, so that each is one wide load, subtraction and store.
            self.apart[k] = less(x, y);
            self.relative[k] = less(v, u);
            self.radius[0][k] = x[3];
            self.radius[1][k] = y[3];
            self.spin[0][k] = *w;
            self.spin[1][k] = *z;
            filled = k + 1;
        }
        self.count = filled;
        if L::KNOWS_MATERIALS {
            for (column, places) in self.material.iter_mut().zip([lower, partner]) {
                for (to, place) in part_mut(column, begin, end).iter_mut().zip(places) {
                    *to = material_of(bodies.group, *place as usize);
                }
            }
        }
        for (column, spring) in self.spring.iter_mut().zip(spring) {
            copy(part_mut(column, begin, begin + spring.len()), spring);
        }
        for (column, words) in self.memory.iter_mut().zip(memory).take(L::MEMORY) {
            copy(part_mut(column, begin, begin + words.len()), words);
        }
    }

    /// Evaluates the block; springs advance by `dt`.
    #[inline(always)]
    pub fn evaluate<L: Law<R>>(&mut self, domain: &Domain<R>, law: &L, dt: R) {
        self.meet(domain);
        self.normal_force(law);
        self.advance_springs(dt);
        self.tangential_force(law);
        if const { has_torque::<R, L>() } {
            self.torque(law, dt);
        }
        self.push::<L>();
    }

    /// Separation to the nearest image, distance, normal `d (1/r)` and overlap `(r_i + r_j) - r`.
    #[inline(always)]
    fn meet(&mut self, domain: &Domain<R>) {
        for k in 0..self.whole() {
            let d = domain.nearest(head(self.apart[k]));
            let distance = dot(d, d).sqrt();
            put(&mut self.normal, k, scale(d, R::ONE / distance));
            self.overlap[k] = (self.radius[0][k] + self.radius[1][k]) - distance;
        }
    }

    #[inline(always)]
    fn normal_force<L: Law<R>>(&mut self, law: &L) {
        for k in 0..self.whole() {
            self.speed[k] = dot(head(self.relative[k]), taken(&self.normal, k));
            let contact = self.along_normal::<L>(k);
            if L::ACTS_APART {
                self.acts[k] = law.acts(&contact);
            }
            let normal_force = law.normal_force(&contact);
            self.normal_force.force[k] = normal_force.force;
            self.normal_force.contact_radius[k] = normal_force.contact_radius;
            self.normal_force.damping[k] = normal_force.damping;
            self.normal_force.lever_arm_i[k] = normal_force.lever_arm_i;
            self.normal_force.lever_arm_j[k] = normal_force.lever_arm_j;
        }
    }

    #[inline(always)]
    fn advance_springs(&mut self, dt: R) {
        for k in 0..self.whole() {
            let (wi, wj) = (self.spin[0][k], self.spin[1][k]);
            let turn = surface_spin(
                head(wi),
                self.normal_force.lever_arm_i[k],
                head(wj),
                self.normal_force.lever_arm_j[k],
            );
            let normal = taken(&self.normal, k);
            let velocity = head(self.relative[k]);
            let spring = taken(&self.spring, k);
            let slide = slide(normal, velocity, self.speed[k], turn, spring, dt);
            put(&mut self.sliding, k, slide.velocity);
            put(&mut self.spring, k, slide.spring);
            self.length2[k] = slide.length2;
        }
    }

    #[inline(always)]
    fn tangential_force<L: Law<R>>(&mut self, law: &L) {
        for k in 0..self.whole() {
            let normal_force = self.normal_force_of(k);
            let state = TangentialState {
                contact: self.along_normal::<L>(k),
                velocity: taken(&self.sliding, k),
                spring: taken(&self.spring, k),
                length2: self.length2[k],
            };
            let tangential_force = law.tangential_force(&normal_force, &state);
            put(&mut self.tangential, k, tangential_force.force);
            // Only whether a contact acts opens or erases a history, not whether it is listed.
            let left = either(self.acts::<L>(k), tangential_force.spring, [R::ZERO; 3]);
            put(&mut self.spring, k, left);
        }
    }

    #[inline(always)]
    fn torque<L: Law<R>>(&mut self, law: &L, dt: R) {
        for k in 0..self.whole() {
            let state = TurningState {
                contact: self.along_normal::<L>(k),
                normal: taken(&self.normal, k),
                velocity: taken(&self.sliding, k),
                tangential: taken(&self.tangential, k),
                spin_i: head(self.spin[0][k]),
                spin_j: head(self.spin[1][k]),
                dt,
            };
            let acts = self.acts::<L>(k);
            let turned = law.torque(&self.normal_force_of(k), &state);
            let torque = either(acts, turned.torque, [R::ZERO; 3]);
            self.torque[k] = row(torque);
            for (column, word) in self.memory.iter_mut().zip(turned.memory).take(L::MEMORY) {
                column[k] = if acts { word } else { R::ZERO };
            }
        }
    }

    #[inline(always)]
    fn push<L: Law<R>>(&mut self) {
        for k in 0..self.whole() {
            let (normal, tangential) = (taken(&self.normal, k), taken(&self.tangential, k));
            let touches = self.acts::<L>(k);
            let force = add(scale(normal, self.normal_force.force[k]), tangential);
            let force = either(touches, force, [R::ZERO; 3]);
            let couple = either(touches, cross(normal, tangential), [R::ZERO; 3]);
            self.force[k] = [force[0], force[1], force[2], R::ZERO];
            self.couple[k] = [couple[0], couple[1], couple[2], R::ZERO];
        }
    }

    /// A contact along its normal.
    #[inline(always)]
    fn along_normal<L: Law<R>>(&self, k: usize) -> NormalState<R> {
        let (ri, rj) = (self.radius[0][k], self.radius[1][k]);
        let inverse_masses = [self.spin[0][k][3], self.spin[1][k][3]];
        NormalState {
            overlap: self.overlap[k],
            speed: self.speed[k],
            radius_i: ri,
            radius_j: rj,
            radius_effective: (ri * rj) / (ri + rj),
            mass_effective: R::ONE / (inverse_masses[0] + inverse_masses[1]),
            inverse_masses,
            materials: [self.material[0][k], self.material[1][k]],
            memory: self.memory_of::<L>(k),
        }
    }

    #[inline(always)]
    fn memory_of<L: Law<R>>(&self, k: usize) -> ContactMemory<R> {
        let mut memory = [R::ZERO; MEMORY_MAX];
        for (word, column) in memory.iter_mut().zip(&self.memory).take(L::MEMORY) {
            *word = column[k];
        }
        memory
    }

    #[inline(always)]
    fn normal_force_of(&self, k: usize) -> NormalForce<R> {
        NormalForce {
            force: self.normal_force.force[k],
            contact_radius: self.normal_force.contact_radius[k],
            damping: self.normal_force.damping[k],
            lever_arm_i: self.normal_force.lever_arm_i[k],
            lever_arm_j: self.normal_force.lever_arm_j[k],
        }
    }

    /// Whether a contact acts.
    #[inline(always)]
    fn acts<L: Law<R>>(&self, k: usize) -> bool {
        match L::ACTS_APART {
            true => self.acts[k],
            false => self.overlap[k] > R::ZERO,
        }
    }

    /// The places of the grains of each pair.
    #[inline(always)]
    pub fn places(&self) -> impl Iterator<Item = (&u32, &u32)> {
        let lower = prefix(&self.place[0], self.count).iter();
        lower.zip(&self.place[1])
    }

    /// The places of the grains of one pair.
    #[inline(always)]
    pub fn places_of(&self, k: usize) -> (u32, u32) {
        (
            get_or_default(&self.place[0], k),
            get_or_default(&self.place[1], k),
        )
    }

    /// What each pair of the block gives, in order: force on the lower grain, couple, and the levers of
    /// both grains.
    #[inline(always)]
    pub fn shares(&self) -> impl Iterator<Item = (&Row<R>, &Row<R>, R, R)> {
        let rows = prefix(&self.force, self.count).iter().zip(&self.couple);
        let arms = self
            .normal_force
            .lever_arm_i
            .iter()
            .zip(&self.normal_force.lever_arm_j);
        rows.zip(arms)
            .map(|((force, couple), (lever_arm_i, lever_arm_j))| {
                (force, couple, *lever_arm_i, *lever_arm_j)
            })
    }

    /// The torque on the lower grain of each pair beside that of the tangential force, in order.
    #[inline(always)]
    pub fn torques(&self) -> &[Row<R>] {
        prefix(&self.torque, self.count)
    }

    /// Puts what the law has left of its pairs from `from` on back among the pairs.
    #[inline(always)]
    pub fn keep<L: Law<R>>(
        &self,
        from: usize,
        springs: [&mut [R]; 3],
        memory: [&mut [R]; MEMORY_MAX],
    ) {
        let words = memory.into_iter().zip(&self.memory).take(L::MEMORY);
        for (to, left) in springs.into_iter().zip(&self.spring).chain(words) {
            let end = from + to.len();
            copy(to, part(left, from, end));
        }
    }

    /// The first pair of the block that overlaps by more than half the smaller radius.
    #[inline(always)]
    pub fn deepest(&self) -> Option<usize> {
        let too_deep = |k: usize| {
            let least = smaller(self.radius[0][k], self.radius[1][k]);
            self.overlap[k] > least * R::HALF
        };
        let mut any = 0u64;
        for k in 0..self.whole() {
            any |= u64::from(too_deep(k));
        }
        // Columns beyond the count hold an earlier block's pairs, which were judged then.
        if any == 0 {
            return None;
        }
        let count = min(self.count, BLOCK);
        (0..count).find(|&k| too_deep(k))
    }

    /// Place in the block, overlap, normal, normal force, tangential force and torque of each pair that acts.
    #[inline(always)]
    pub fn seen<L: Law<R>>(&self, mut show: impl FnMut(usize, R, Vec3<R>, R, [Vec3<R>; 2])) {
        let count = min(self.count, BLOCK);
        for k in 0..count {
            if self.acts::<L>(k) {
                let torque = match const { has_torque::<R, L>() } {
                    true => head(self.torque[k]),
                    false => [R::ZERO; 3],
                };
                show(
                    k,
                    self.overlap[k],
                    taken(&self.normal, k),
                    self.normal_force.force[k],
                    [taken(&self.tangential, k), torque],
                );
            }
        }
    }
}
