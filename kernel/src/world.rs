//! A world: everything one step needs, borrowed from whoever owns it.

pub use crate::clock::Clock;
pub(crate) use crate::clock::Stage;
use crate::error::Error;
use crate::forces::accumulate::{GrainRange, NotedForces, PairRange};
use crate::forces::obstacle_contacts::ObstacleContactRange;
use crate::forces::stretch_range::StretchRange;
use crate::integrate::GrainMotion;
use crate::math::real::{Real, larger, magnitude};
use crate::math::rows::{front_mut, get_or_default, prefix, shorten};
use crate::math::vec3::{Vec3, head, length_bound};
use crate::neighbors::cell_list::CellList;
use crate::neighbors::outer_list::OuterList;
use crate::neighbors::pair_list::{ContactHistory, KeptContact, OBSTACLES_MAX, PairList, TOUCHING};
use crate::neighbors::stretch::StretchList;
use crate::state::domain::Domain;
use crate::state::facet::Facet;
use crate::state::grains::Grains;
use crate::state::losses::LossPolicy;
use crate::state::motion::Motion;
use crate::state::obstacle::Obstacle;
use crate::state::owned::Owned;

/// Units in the last place of the largest coordinate that a step must move by.
const RESOLVED: f64 = 16.0;

/// A world of grains and obstacles, in any consistent units.
///
/// It is rebuilt for each stretch of steps from storage that its owner keeps; building one costs
/// nothing. All that a step reads is read-only between steps: after changing it by hand, call
/// [`crate::start`] or [`crate::resume`], or the next step is refused with [`Error::Edited`]. Free to change
/// at any time are skin and reach, the number of steps done, the policy, and the velocity and
/// angular velocity of an obstacle and the host's force and torque on it, which are not checked then.
pub struct World<'a, R> {
    /// The box.
    pub domain: &'a Domain<R>,
    /// Time step, positive.
    pub dt: R,
    /// How far beyond touching a pair is listed (length, zero or more): a matter of speed only.
    pub skin: R,
    /// How far beyond the skin a pair is a candidate for the list (length, zero or more): a matter of
    /// speed only.
    pub outer_skin: R,
    /// Where runs of own grains begin and end, by turns, ascending; empty if all are own, `[0, 0]` if none is. The
    /// others are ghosts: see [`crate::parts`].
    pub owned: &'a [u32],
    /// What becomes of grains that leave: a part of the physics, which may change between steps.
    pub policy: LossPolicy<R>,
    /// The grains.
    pub grains: Grains<'a, R>,
    /// The obstacles, by number.
    pub obstacles: &'a mut [Obstacle<R>],
    /// The triangles of all meshes; empty if there are none.
    pub facets: &'a [Facet<R>],
    /// The pair list.
    pub pairs: PairList<'a, R>,
    /// Storage for the next list; its pair and obstacle entries bound how many can be listed.
    pub spare: PairList<'a, R>,
    /// Storage of the stretches of grains that renew their pairs together; one at least. About one for
    /// each 64 grains is fastest.
    pub stretches: StretchList<'a, R>,
    /// Storage of the candidates.
    pub candidates: OuterList<'a>,
    /// Storage of the search.
    pub cells: CellList<'a>,
    /// Time, and how long the list holds.
    pub clock: &'a mut Clock<R>,
}

impl<R: Real> World<'_, R> {
    /// The contacts that touched in the last evaluation, by places: grain pairs by `(i, j)`, then obstacle
    /// contacts by grain and obstacle.
    pub fn contact_histories(&self) -> impl Iterator<Item = ContactHistory<R>> + '_ {
        self.kept_contacts().map(|contact| contact.history)
    }

    /// [`World::contact_histories`], with the words that the law keeps of each.
    pub fn kept_contacts(&self) -> impl Iterator<Item = KeptContact<R>> + '_ {
        let (domain, position) = (self.domain, &*self.grains.position);
        self.pairs
            .kept_contacts(&self.stretches, self.clock.listed, domain, position)
    }

    /// The listed pairs, lower grain and partner, by places and in order.
    pub fn listed_pairs(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let listed = self.pairs.in_order(&self.stretches, self.clock.listed);
        listed.map(|(i, j, _)| (i, j))
    }

    /// The place of the grain with this id among the rows, by halving.
    pub fn place_of(&self, id: u32) -> Option<usize> {
        prefix(self.grains.id, self.clock.count)
            .binary_search(&id)
            .ok()
    }

    /// Shortens the world to its first grains.
    pub(crate) fn shrink(&mut self, count: usize) {
        self.grains.shrink(count);
        shorten(&mut self.candidates.row, count.saturating_add(1));
        self.clock.count = count;
    }

    /// What the passes of motion read and write, for all grains.
    #[inline(always)]
    pub fn grain_motion(&mut self) -> GrainMotion<'_, R> {
        GrainMotion::of_all(&mut self.grains, self.domain, self.dt)
    }

    /// All grains and their pairs, and the obstacle contacts; `dt` is the time by
    /// which springs advance.
    #[inline(always)]
    pub fn force_ranges(&mut self, dt: R) -> (GrainRange<'_, R>, ObstacleContactRange<'_, R>) {
        let listed = self.clock.listed;
        let pairs = &mut self.pairs;
        let touch = ObstacleContactRange {
            grain: prefix(pairs.obstacle_contact_grain, listed.obstacle_contacts),
            shares: &mut [],
            obstacle: front_mut(pairs.obstacle_contact_obstacle, listed.obstacle_contacts),
            spring: front_mut(pairs.obstacle_contact_spring, listed.obstacle_contacts),
            memory: pairs
                .obstacle_contact_memory
                .each_mut()
                .map(|word| front_mut(word, listed.obstacle_contacts)),
            obstacles: self.obstacles,
            facets: self.facets,
        };
        let range = PairRange {
            lower: prefix(pairs.lower, listed.end),
            partner: prefix(pairs.partner, listed.end),
            spring: pairs.spring.each_mut().map(|s| front_mut(s, listed.end)),
            memory: pairs.memory.each_mut().map(|s| front_mut(s, listed.end)),
        };
        let part = GrainRange {
            owned: Owned::new(self.owned),
            grains: GrainMotion::of_all(&mut self.grains, self.domain, self.dt),
            pairs: range,
            noted: NotedForces::default(),
            stretches: StretchRange {
                place: prefix(self.stretches.place, listed.stretches + 1),
                begin: prefix(self.stretches.begin, listed.stretches + 1),
                pairs: prefix(self.stretches.pairs, listed.stretches),
                travel: front_mut(self.stretches.travel, listed.stretches),
            },
            reach: self.clock.reach,
            dt,
        };
        (part, touch)
    }

    /// Checks that the lent slices fit together: what a step relies on.
    #[inline(always)]
    pub(crate) fn check_storage(&self) -> Result<(), Error> {
        let n = self.grains.count();
        let lists = self.pairs.is_whole()
            && self.spare.is_whole()
            && self.pairs.partner.len() >= self.spare.partner.len()
            && self.pairs.words() == self.spare.words()
            && self.pairs.obstacle_contact_grain.len() >= self.spare.obstacle_contact_grain.len()
            && self.pairs.holds(self.clock.listed)
            && self.candidates.row.len() == n + 1
            && self.stretches.is_whole()
            && self.stretches.holds(self.clock.listed.stretches);
        let cells = self.cells.start.len() >= 2 && self.cells.grain.len() >= n;
        let countable = n < TOUCHING as usize;
        if self.grains.is_whole() && lists && cells && countable {
            Ok(())
        } else {
            Err(Error::BadStorage)
        }
    }

    /// Checks storage, ids, grains, obstacles and box; obstacles that have moved may be beyond it.
    pub(crate) fn check(&self, has_moved: bool) -> Result<(), Error> {
        let n = self.grains.count();
        self.check_storage()?;
        if !(self.dt > R::ZERO
            && self.dt.is_finite()
            && self.skin >= R::ZERO
            && self.clock.reach >= R::ZERO
            && self.clock.reach.is_finite()
            && self.outer_skin >= R::ZERO)
        {
            return Err(Error::BadTimeStep);
        }
        let g = &self.grains;
        for i in 0..n {
            let id = get_or_default(g.id, i);
            if i > 0 && get_or_default(g.id, i - 1) >= id {
                return Err(Error::BadOrder { id });
            }
            let numbers = [
                get_or_default(g.position, i),
                get_or_default(g.velocity, i),
                get_or_default(g.spin, i),
            ];
            let [[.., radius], [.., mass], _] = numbers;
            let sized = radius > R::ZERO && radius.is_finite();
            let heavy = mass > R::ZERO && mass.is_finite() && (R::ONE / mass).is_finite();
            // In fixed point the square of a small radius may vanish.
            let turns = || (R::ONE / mass) / ((radius * radius) * R::from_f64(0.4));
            let sized = sized && (!R::FIXED_POINT || turns().is_finite());
            if usize::from(get_or_default(g.group, i)) >= g.groups.len() || !sized || !heavy {
                return Err(Error::BadGrain { id });
            }
            let finite = numbers
                .iter()
                .all(|row| head(*row).iter().all(|x| x.is_finite()));
            if !finite {
                return Err(Error::not_finite::<R>(id));
            }
            let mut place = head(get_or_default(g.position, i));
            let mut image = [0; 3];
            if !self.domain.wrap(&mut place, &mut image) || image != [0; 3] {
                return Err(Error::Escaped { id });
            }
        }
        let count = self.obstacles.len();
        if count > OBSTACLES_MAX {
            let [count, most] = [count as u32, OBSTACLES_MAX as u32];
            return Err(Error::TooManyObstacles { count, most });
        }
        for (number, body) in self.obstacles.iter().enumerate() {
            let obstacle = number as u32;
            body.check_place(self.domain, obstacle, has_moved)?;
            if !body.has_facets(self.facets) {
                return Err(Error::OtherFacets { obstacle });
            }
        }
        self.check_periods()
    }

    /// What is carried, what moves as prescribed and what falls must move by [`RESOLVED`] units in
    /// the last place in a step, or rounding would rule its speed: the valid range of a number type.
    pub(crate) fn check_resolution(&self) -> Result<(), Error> {
        let least = self.least_way();
        for (k, body) in self.obstacles.iter().enumerate() {
            let turn = length_bound(body.angular_velocity) * self.dt;
            let turns = body.angular_velocity != [R::ZERO; 3];
            let moves_freely = matches!(body.motion, Motion::Free(_));
            if !moves_freely
                && (self.is_lost(body.velocity, length_bound(body.velocity), least)
                    || turns && turn < R::EPSILON * R::from_f64(RESOLVED))
            {
                return Err(Error::ObstacleTooSlow { obstacle: k as u32 });
            }
        }
        let velocities = self.grains.velocity.iter().enumerate();
        for (place, v) in velocities {
            self.check_resolution_of(place, head(*v), least)?;
        }
        Ok(())
    }

    /// The least way of a step that counts as a motion: of the largest coordinate.
    pub(crate) fn least_way(&self) -> R {
        let mut extent = R::ZERO;
        for a in 0..3 {
            for x in self.grains.position.iter() {
                extent = larger(extent, magnitude(x[a]));
            }
            for body in self.obstacles.iter().filter(|body| body.reach() > R::ZERO) {
                extent = larger(extent, magnitude(body.point[a]));
            }
            if self.domain.periodic()[a] {
                let (lo, hi) = (self.domain.lo()[a], self.domain.hi()[a]);
                extent = larger(extent, larger(magnitude(lo), magnitude(hi)));
            }
        }
        let extent = if R::FIXED_POINT { R::ONE } else { extent };
        extent * (R::EPSILON * R::from_f64(RESOLVED))
    }

    /// Whether a motion in this direction at this speed would be lost to rounding.
    fn is_lost(&self, direction: Vec3<R>, speed: R, least: R) -> bool {
        direction.iter().any(|x| *x != R::ZERO) && speed * self.dt < least
    }

    /// The same of one grain that has this velocity.
    pub(crate) fn check_resolution_of(
        &self,
        place: usize,
        velocity: Vec3<R>,
        least: R,
    ) -> Result<(), Error> {
        let g = &self.grains;
        let number = get_or_default(g.group, place);
        let Some(group) = g.groups.get(usize::from(number)) else {
            return Ok(());
        };
        let mut carried = [R::ZERO; 3];
        let mut pull = [R::ZERO; 3];
        for a in 0..3 {
            if group.integrates[a] {
                pull[a] = group.gravity[a];
            } else {
                carried[a] = velocity[a];
            }
        }
        if self.is_lost(carried, length_bound(carried), least) {
            let id = get_or_default(g.id, place);
            return Err(Error::TooSlow { id });
        }
        let radius = get_or_default(g.position, place)[3];
        if self.is_lost(pull, (length_bound(pull) * radius).sqrt(), least) {
            return Err(Error::GravityTooWeak { group: number });
        }
        Ok(())
    }

    /// Every period must be longer than twice the largest contact distance, or a grain could touch
    /// two images of one body.
    fn check_periods(&self) -> Result<(), Error> {
        let (mut radius, mut largest) = (R::ZERO, 0);
        for (x, id) in self.grains.position.iter().zip(self.grains.id.iter()) {
            if x[3] > radius {
                (radius, largest) = (x[3], *id);
            }
        }
        let mut widest = radius + radius;
        for body in self.obstacles.iter() {
            widest = larger(widest, radius + body.reach());
        }
        widest = widest + self.clock.reach;
        // In fixed point: the square of every distance at which bodies touch must be a number.
        let square = (widest + self.skin) * (widest + self.skin);
        if R::FIXED_POINT && !square.is_finite() {
            return Err(Error::Overflow { id: largest });
        }
        let (lo, hi) = (self.domain.lo(), self.domain.hi());
        for a in 0..3 {
            if self.domain.periodic()[a] && hi[a] - lo[a] <= widest + widest {
                return Err(Error::PeriodTooShort { axis: a as u8 });
            }
        }
        Ok(())
    }
}
