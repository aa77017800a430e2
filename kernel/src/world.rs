//! A world: everything one step needs, borrowed from whoever owns it.

use crate::domain::Domain;
use crate::fault::Fault;
use crate::grains::Grains;
use crate::motion::Moving;
use crate::obstacle::Obstacle;
use crate::pairs::{Bond, Pairs, TOUCHING};
use crate::push::{Part, Sight};
use crate::real::{Real, larger, magnitude};
use crate::rows::{at, front, front_mut};
use crate::search::Cells;
use crate::touch::TouchPart;
use crate::vec3::{Vec3, dot, head};

/// Units in the last place of the largest coordinate that a step must move by.
const RESOLVED: f64 = 16.0;

/// Where a world is in time and how long its pair list holds. Everything but `step` is about the
/// search and has no effect on any result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock<R> {
    /// Steps done; time is `step * dt`.
    pub step: u64,
    pub(crate) searches: u64,
    pub(crate) listed: usize,
    pub(crate) touches: usize,
    /// The smallest grain radius: what an obstacle may move in one step.
    pub(crate) radius_min: R,
    /// Travel that the pair list still allows (length).
    pub(crate) budget: R,
    /// Bound of the next step's travel (length).
    pub(crate) next_travel: R,
    /// What rounding may add to it.
    pub(crate) rounding: R,
    pub(crate) started: bool,
}

impl<R: Real> Clock<R> {
    /// Before the first step.
    pub(crate) const ZERO: Self = Self {
        step: 0,
        searches: 0,
        listed: 0,
        touches: 0,
        radius_min: R::ZERO,
        budget: R::ZERO,
        next_travel: R::ZERO,
        rounding: R::ZERO,
        started: false,
    };

    /// Searches done.
    pub fn searches(&self) -> u64 {
        self.searches
    }

    /// Grain pairs listed.
    pub fn listed(&self) -> usize {
        self.listed
    }

    /// Obstacle contacts listed.
    pub fn touches(&self) -> usize {
        self.touches
    }
}

/// A world of grains and obstacles, in any consistent units.
///
/// It is made anew for each stretch of steps from storage that its owner keeps; making one costs
/// nothing. After changing a state by hand, call [`crate::start`] or [`crate::resume`] again; only the
/// velocity of an obstacle may change between steps without, but is not checked then.
pub struct World<'a, R> {
    /// The box.
    pub domain: &'a Domain<R>,
    /// Time step, positive.
    pub dt: R,
    /// How far beyond touching a pair is listed (length, zero or more): a matter of speed only.
    pub skin: R,
    /// The grains.
    pub grains: Grains<'a, R>,
    /// The obstacles, by number.
    pub obstacles: &'a mut [Obstacle<R>],
    /// The pair list.
    pub pairs: Pairs<'a, R>,
    /// Storage for the next list; its pair and obstacle entries bound how many can be listed.
    pub spare: Pairs<'a, R>,
    /// Storage of the search.
    pub cells: Cells<'a>,
    /// Time, and how long the list holds.
    pub clock: &'a mut Clock<R>,
}

impl<R: Real> World<'_, R> {
    /// The contacts that touched in the last evaluation, by places; see [`Pairs::bonds`].
    pub fn bonds(&self) -> impl Iterator<Item = Bond<R>> + '_ {
        self.pairs.bonds(self.clock.touches)
    }

    /// What the passes of motion read and write, for all grains.
    #[inline(always)]
    pub fn moving(&mut self) -> Moving<'_, R> {
        let g = &mut self.grains;
        Moving {
            domain: self.domain,
            dt: self.dt,
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

    /// What the force phase reads, and what it writes for all obstacle contacts and all grains;
    /// `dt` is the time by which springs advance.
    #[inline(always)]
    pub fn pushing(&mut self, dt: R) -> (Sight<'_, R>, TouchPart<'_, R>, Part<'_, R>) {
        let (rows, touches) = (0..self.grains.count(), self.clock.touches);
        let (g, pairs) = (&mut self.grains, &mut self.pairs);
        let sight = Sight {
            domain: self.domain,
            position: g.position,
            velocity: g.velocity,
            spin: g.spin,
            row: pairs.row,
            dt,
        };
        let touch = TouchPart {
            grain: front(pairs.touch_grain, touches),
            obstacle: front_mut(pairs.touch_obstacle, touches),
            spring: front_mut(pairs.touch_spring, touches),
            obstacles: self.obstacles,
        };
        let part = Part {
            rows,
            force: g.force,
            torque: g.torque,
            partner: pairs.partner,
            spring: pairs.spring,
        };
        (sight, touch, part)
    }

    /// Checks that the lent slices fit together: what a step relies on.
    #[inline(always)]
    pub(crate) fn check_storage(&self) -> Result<(), Fault> {
        let n = self.grains.count();
        let lists = self.pairs.is_whole(n)
            && self.spare.is_whole(n)
            && self.pairs.partner.len() >= self.spare.partner.len()
            && self.pairs.touch_grain.len() >= self.spare.touch_grain.len()
            && self.pairs.partner.len() >= self.clock.listed
            && self.pairs.touch_grain.len() >= self.clock.touches;
        let cells = self.cells.start.len() >= 2 && self.cells.grain.len() >= n;
        let countable = n < TOUCHING as usize;
        if self.grains.is_whole() && lists && cells && countable {
            Ok(())
        } else {
            Err(Fault::BadStorage)
        }
    }

    /// Checks storage, ids, grains, obstacles and box.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        let n = self.grains.count();
        self.check_storage()?;
        if !(self.dt > R::ZERO && self.dt.is_finite() && self.skin >= R::ZERO) {
            return Err(Fault::BadTimeStep);
        }
        let g = &self.grains;
        for i in 0..n {
            let id = at(g.id, i);
            if i > 0 && at(g.id, i - 1) >= id {
                return Err(Fault::BadOrder { id });
            }
            let numbers = [at(g.position, i), at(g.velocity, i), at(g.spin, i)];
            let [[.., radius], [.., mass], _] = numbers;
            let sized = radius > R::ZERO && radius.is_finite();
            let heavy = mass > R::ZERO && mass.is_finite() && (R::ONE / mass).is_finite();
            if usize::from(at(g.group, i)) >= g.groups.len() || !sized || !heavy {
                return Err(Fault::BadGrain { id });
            }
            let finite = numbers
                .iter()
                .all(|row| head(*row).iter().all(|x| x.is_finite()));
            if !finite {
                return Err(Fault::NotFinite { id });
            }
            let mut place = head(at(g.position, i));
            let mut image = [0; 3];
            if !self.domain.wrap(&mut place, &mut image) || image != [0; 3] {
                return Err(Fault::Escaped { id });
            }
        }
        for (number, body) in self.obstacles.iter().enumerate() {
            body.check(self.domain, number as u32)?;
        }
        self.check_periods()?;
        self.check_resolution()
    }

    /// What is carried, what moves as prescribed and what falls must move by [`RESOLVED`] units in
    /// the last place in a step, or rounding would rule its speed: the valid range of a number type.
    fn check_resolution(&self) -> Result<(), Fault> {
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
        let least = extent * (R::EPSILON * R::from_f64(RESOLVED));
        let moves = |v: &Vec3<R>| v.iter().any(|x| *x != R::ZERO);
        let lost = |v: &Vec3<R>, speed: R| moves(v) && speed * self.dt < least;
        for (k, body) in self.obstacles.iter().enumerate() {
            if lost(&body.velocity, dot(body.velocity, body.velocity).sqrt()) {
                return Err(Fault::ObstacleTooSlow { obstacle: k as u32 });
            }
        }
        let g = &self.grains;
        for (i, (x, v)) in g.position.iter().zip(g.velocity.iter()).enumerate() {
            let number = at(g.group, i);
            let Some(group) = g.groups.get(usize::from(number)) else {
                continue;
            };
            let mut carried = [R::ZERO; 3];
            let mut pull = [R::ZERO; 3];
            for a in 0..3 {
                if group.integrates[a] {
                    pull[a] = group.gravity[a];
                } else {
                    carried[a] = v[a];
                }
            }
            if lost(&carried, dot(carried, carried).sqrt()) {
                return Err(Fault::TooSlow { id: at(g.id, i) });
            }
            if lost(&pull, (dot(pull, pull).sqrt() * x[3]).sqrt()) {
                return Err(Fault::GravityTooWeak { group: number });
            }
        }
        Ok(())
    }

    /// Every period must be longer than twice the largest contact distance, or a grain could touch
    /// two images of one body.
    fn check_periods(&self) -> Result<(), Fault> {
        let mut radius = R::ZERO;
        for x in self.grains.position.iter() {
            radius = larger(radius, x[3]);
        }
        let mut widest = radius + radius;
        for body in self.obstacles.iter() {
            widest = larger(widest, radius + body.reach());
        }
        let (lo, hi) = (self.domain.lo(), self.domain.hi());
        for a in 0..3 {
            if self.domain.periodic()[a] && hi[a] - lo[a] <= widest + widest {
                return Err(Fault::PeriodTooShort { axis: a as u8 });
            }
        }
        Ok(())
    }
}
