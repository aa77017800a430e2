//! Several steps of a world cut into parts, which take turns at each phase as threads would do it side by side.

use std::collections::BTreeMap;

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::parts::{
    GONE, GhostMotion, drift_own, is_search_due, listed_obstacle_contacts, listed_pairs, renumber,
    restore, search_and_list, take_in, take_lists,
};
use bitgrain_kernel::phases::{
    After, Extent, ForceCheck, MotionCheck, NotedForces, accumulate, begin, check_forces, drift,
    end, ensure_pair_list, finish, is_draining, measure, no_fetch, obstacle_forces, seal,
    sum_on_obstacles,
};
use bitgrain_kernel::vec3::{dot, head};
use bitgrain_kernel::{
    ContactForce, ContactHistory, Error, LossPolicy, Obstacle, Partner, Real, World,
};

use super::part::{Frame, Inner, Part, Seen};

/// Which foreign grains a part holds as ghosts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ghosts {
    /// All.
    All,
    /// Those that may come near an own one before the next search.
    Near,
}

/// Does `count` steps of a started world in parts: `owner` says for each grain which part owns it. A world that begins
/// to lose grains stops there.
pub fn steps_in_parts<R: Real>(
    world: &mut World<'_, R>,
    owner: &[u8],
    ghosts: Ghosts,
    law: &impl Law<R>,
    count: u64,
) -> Result<(), Error> {
    if count == 0 {
        return Ok(());
    }
    let sealed = seal(&world.grain_motion(), 0);
    begin(world, sealed)?;
    let mut parts = Parts::of(world, owner, ghosts);
    let went = parts.steps(law, count, &mut |_| ());
    parts.rejoin(world)?;
    went?;
    let sealed = seal(&world.grain_motion(), 0);
    end(world, sealed)
}

/// Rows as words, of which those that are no numbers are equal too.
fn words<R: Real>(rows: Seen<R>) -> [[(u32, Option<u32>); 4]; 3] {
    rows.map(|row| row.map(Real::to_words))
}

/// A world in parts.
pub struct Parts<R> {
    /// Whether overlaps that are too deep are faults.
    pub checks_forces: bool,
    frame: Frame<R>,
    ghosts: Ghosts,
    parts: Vec<Part<R>>,
    /// The rows of every grain, as its owner last moved it.
    shown: Vec<Seen<R>>,
    /// The obstacles with the sums over all parts.
    obstacles: Vec<Obstacle<R>>,
}

impl<R: Real> Parts<R> {
    /// The parts of a world that has begun.
    pub fn of(world: &World<'_, R>, owner: &[u8], ghosts: Ghosts) -> Self {
        let g = &world.grains;
        assert_eq!(owner.len(), g.count(), "each grain has an owner");
        let frame = Frame {
            domain: *world.domain,
            dt: world.dt,
            skin: world.skin,
            outer_skin: world.outer_skin,
            policy: world.policy,
            groups: g.groups.to_vec(),
            id: g.id.to_vec(),
            group: g.group.to_vec(),
            owner: owner.to_vec(),
            facets: world.facets.to_vec(),
        };
        let shown = |k: usize| [g.position[k], g.velocity[k], g.spin[k]];
        let rows = |k: usize| (shown(k), (g.force[k], g.torque[k], g.image[k]));
        let count = owner.iter().max().map_or(1, |last| last + 1);
        let parts = (0..count).map(|number| {
            let own = (0..owner.len()).filter(|k| owner[*k] == number);
            let home: Vec<u32> = own.map(|k| k as u32).collect();
            let clock = world.clock.of_part(home.len());
            let mut part = Part::new(owner.len(), world.obstacles, &clock);
            part.settle(&frame, number, home, rows);
            let is_own = |i: &u32| owner[*i as usize] == number;
            let histories = world.kept_contacts().filter(|one| match &one.history {
                ContactHistory::Pair { i, j, .. } => is_own(i) || is_own(j),
                ContactHistory::Obstacle { i, .. } => is_own(i),
            });
            part.histories = histories.collect();
            part
        });
        Self {
            checks_forces: true,
            parts: parts.collect(),
            shown: (0..owner.len()).map(shown).collect(),
            obstacles: world.obstacles.to_vec(),
            ghosts,
            frame,
        }
    }

    /// Steps; `watch` sees each contact once, by places in the whole world.
    pub fn steps(
        &mut self,
        law: &impl Law<R>,
        count: u64,
        watch: &mut impl FnMut(ContactForce<R>),
    ) -> Result<(), Error> {
        if count > 0 {
            self.drift()?;
        }
        for n in 1..=count {
            self.list()?;
            // Grains that leave do so at the end of a step, before the next one moves any.
            let pauses = n == count || self.frame.policy != LossPolicy::STOP;
            let after = match pauses {
                true => After::Rest,
                false => After::FinishAndBegin,
            };
            let passed = self.push(law, after, watch)?;
            self.joint(|world| finish(world, passed))?;
            if n == count || self.parts[0].clock.is_losing() {
                return Ok(());
            }
            match pauses {
                true => self.drift()?,
                false => self.joint(|world| drift(world, passed))?,
            }
        }
        Ok(())
    }

    /// The motion that begins a step. The last part comes first: their order must not matter.
    fn drift(&mut self) -> Result<(), Error> {
        let mut all = MotionCheck::NONE;
        for part in self.parts.iter_mut().rev() {
            all = drift_own(&mut part.world(&self.frame)).and(all);
        }
        self.show();
        self.joint(|world| drift(world, all))
    }

    /// Lists what may touch.
    fn list(&mut self) -> Result<(), Error> {
        let mut due = self.parts.iter_mut();
        let mut due = due
            .by_ref()
            .map(|part| is_search_due(&part.world(&self.frame)));
        let is_due = due.next().unwrap_or_default();
        assert!(due.all(|other| other == is_due), "parts search together");
        if !is_due {
            return self.joint(ensure_pair_list);
        }
        let extents = self.parts.iter_mut();
        let extents = extents.map(|part| measure(&part.world(&self.frame)));
        let extent = extents.reduce(Extent::and).expect("a part at least");
        for number in 0..self.parts.len() {
            self.renumber(number, &extent)?;
        }
        self.joint(|world| search_and_list(world, &extent))?;
        for part in &mut self.parts {
            let mut histories = std::mem::take(&mut part.histories);
            for one in &mut histories {
                let (ContactHistory::Pair { i, .. } | ContactHistory::Obstacle { i, .. }) =
                    &mut one.history;
                *i = part.place_of(*i).unwrap_or(GONE);
                if let ContactHistory::Pair { j, .. } = &mut one.history {
                    *j = part.place_of(*j).unwrap_or(GONE);
                }
            }
            restore(&mut part.world(&self.frame), histories)?;
        }
        Ok(())
    }

    /// Gives a part the ghosts that it needs now.
    fn renumber(&mut self, number: usize, extent: &Extent<R>) -> Result<(), Error> {
        let part = &mut self.parts[number];
        let owns = |k: usize| usize::from(self.frame.owner[k]) == number;
        let own: Vec<Seen<R>> = part.own().map(|place| part.seen(place)).collect();
        let room = extent.largest + extent.reach + self.frame.skin + self.frame.outer_skin;
        let margin = room * (R::EPSILON * R::from_f64(256.0));
        let reach = extent.radius + extent.radius + self.frame.skin + self.frame.outer_skin;
        let is_near = |k: usize| {
            own.iter().any(|[x, ..]| {
                let d = self
                    .frame
                    .domain
                    .separation(head(*x), head(self.shown[k][0]));
                let far = dot(d, d).sqrt();
                // A distance that is no number may be any.
                !far.is_finite() || far <= reach + margin
            })
        };
        let all = (0..self.frame.owner.len()).filter(|k| match self.ghosts {
            Ghosts::All => true,
            Ghosts::Near => owns(*k) || is_near(*k),
        });
        let home: Vec<u32> = all.map(|k| k as u32).collect();
        let place = |old: &u32| home.binary_search(old).map_or(GONE, |place| place as u32);
        let places: Vec<u32> = part.home.iter().map(place).collect();
        renumber(&mut part.world(&self.frame), &places, home.len())?;
        let inner: BTreeMap<usize, Inner<R>> = part
            .own()
            .map(|place| (part.home[place] as usize, part.inner(place)))
            .collect();
        let shown = &self.shown;
        let rows = |k: usize| {
            let nothing = ([R::ZERO; 4], [R::ZERO; 4], [0; 3]);
            (shown[k], inner.get(&k).copied().unwrap_or(nothing))
        };
        part.settle(&self.frame, number as u8, home, rows);
        Ok(())
    }

    /// The forces and what follows them. What was found comes back, and ghosts are where their owners moved them.
    fn push(
        &mut self,
        law: &impl Law<R>,
        after: After,
        watch: &mut impl FnMut(ContactForce<R>),
    ) -> Result<MotionCheck<R>, Error> {
        let (mut found, mut all) = (ForceCheck::NONE, MotionCheck::NONE);
        for (number, part) in self.parts.iter_mut().enumerate().rev() {
            let home = part.home.clone();
            let mut seen = |mut one: ContactForce<R>| {
                one.i = home[one.i as usize];
                if let Partner::Grain(j) = &mut one.partner {
                    *j = home[*j as usize];
                }
                // A pair of two parts is evaluated in both.
                if usize::from(self.frame.owner[one.i as usize]) == number {
                    watch(one);
                }
            };
            let mut shares = std::mem::take(&mut part.shares);
            shares.resize(part.clock.obstacle_contacts(), Default::default());
            let runs = part.owned.as_chunks().0.iter();
            let own: Vec<u32> = runs.flat_map(|[from, to]| *from..*to).collect();
            let mut forces = vec![[R::ZERO; 4]; own.len()];
            let mut world = part.world(&self.frame);
            let (mut range, mut touch) = world.force_ranges(self.frame.dt);
            touch.shares = &mut shares;
            range.noted = NotedForces {
                place: &own,
                force: &mut forces,
            };
            let hit = obstacle_forces(&mut range, &mut touch, law, &mut seen);
            let fetch = no_fetch::<R>();
            let (deep, mut passed) = accumulate(&mut range, law, &mut seen, fetch, after);
            for (place, force) in own.iter().zip(&forces) {
                // The next step begins with sums of zero.
                let row = &world.grains.force[*place as usize];
                assert!(
                    after != After::Rest || row.map(Real::to_words) == force.map(Real::to_words)
                );
                assert!(after != After::FinishAndBegin || *row == [R::ZERO; 4]);
            }
            passed.draining = after == After::Rest && is_draining(&world);
            (found, all) = (found.and(hit).and(deep), passed.and(all));
            part.shares = shares;
            for (place, k) in part.home.iter().enumerate() {
                let is_ghost = usize::from(self.frame.owner[*k as usize]) != number;
                let left = !is_ghost || words(part.seen(place)) == words(self.shown[*k as usize]);
                assert!(left, "a ghost moves as its owner moves it");
            }
        }
        self.sum_on_obstacles();
        let finite =
            |body: &Obstacle<R>| body.force.iter().chain(&body.torque).all(|f| f.is_finite());
        let unsound = self.obstacles.iter().position(|body| !finite(body));
        found.unsound = unsound.map(|k| k as u32);
        if self.checks_forces {
            self.joint(|world| check_forces(world, found))?;
        }
        self.show();
        Ok(all)
    }

    /// The forces on obstacles, from the shares of all parts.
    fn sum_on_obstacles(&mut self) {
        let mut all = Vec::new();
        for part in &mut self.parts {
            let (home, shares) = (part.home.clone(), part.shares.clone());
            let world = part.world(&self.frame);
            let grains = world.pairs.obstacle_contact_grain.iter();
            all.extend(grains.map(|i| home.get(*i as usize).copied()).zip(shares));
        }
        all.sort_by_key(|(home, _)| *home);
        self.obstacles.clone_from(&self.parts[0].obstacles);
        sum_on_obstacles(&mut self.obstacles, all.into_iter().map(|(_, share)| share));
    }

    /// Shows all parts how each has moved its own grains.
    fn show(&mut self) {
        for part in &self.parts {
            for place in part.own() {
                self.shown[part.home[place] as usize] = part.seen(place);
            }
        }
        for (number, part) in self.parts.iter_mut().enumerate() {
            let is_ghost = |k: u32| usize::from(self.frame.owner[k as usize]) != number;
            let places = (0..part.home.len() as u32).zip(&part.home);
            let places = places.filter(|(_, k)| is_ghost(**k));
            let moved = |k: &u32| self.shown[*k as usize].map(head);
            let (places, ghosts): (Vec<u32>, Vec<GhostMotion<R>>) =
                places.map(|(place, k)| (place, moved(k))).unzip();
            take_in(&mut part.world(&self.frame), &places, &ghosts);
        }
    }

    /// Does the same in all parts, which must end alike.
    fn joint(&mut self, act: impl Fn(&mut World<'_, R>) -> Result<(), Error>) -> Result<(), Error> {
        let parts = self.parts.iter_mut();
        let all: Vec<_> = parts
            .map(|part| act(&mut part.world(&self.frame)))
            .collect();
        assert!(
            all.iter().all(|one| *one == all[0]),
            "parts differ: {all:?}"
        );
        all[0]
    }

    /// Puts the grains, the forces on obstacles and the springs back.
    ///
    /// # Errors
    /// A full list: with more room it can be called again.
    pub fn rejoin(&mut self, world: &mut World<'_, R>) -> Result<(), Error> {
        for part in &self.parts {
            for place in part.own() {
                let (k, (force, torque, image)) = (part.home[place] as usize, part.inner(place));
                let g = &mut world.grains;
                [g.position[k], g.velocity[k], g.spin[k]] = part.seen(place);
                (g.force[k], g.torque[k], g.image[k]) = (force, torque, image);
            }
        }
        let bodies = self.parts[0].obstacles.iter().zip(&self.obstacles);
        for (to, (moved, summed)) in world.obstacles.iter_mut().zip(bodies) {
            let (force, torque) = (summed.force, summed.torque);
            *to = Obstacle {
                force,
                torque,
                ..*moved
            };
        }
        let (mut pairs, mut contacts) = (BTreeMap::new(), BTreeMap::new());
        for (number, part) in self.parts.iter_mut().enumerate() {
            let home = part.home.clone();
            let name = |place: u32| home[place as usize];
            let is_own = |k: u32| usize::from(self.frame.owner[k as usize]) == number;
            let part = part.world(&self.frame);
            let listed = listed_pairs(&part).map(|(i, j, kept)| ((name(i), name(j)), kept));
            pairs.extend(listed.filter(|((i, _), _)| is_own(*i)));
            for (grain, word, kept) in listed_obstacle_contacts(&part) {
                let number = word & !bitgrain_kernel::TOUCHING;
                contacts.insert((name(grain), number), (word, kept));
            }
        }
        let clock = &self.parts[0].clock;
        let (searches, prunes) = (clock.outer_list_rebuilds(), clock.prunes());
        world.clock.rejoin(clock, searches, prunes);
        let pairs = pairs.into_iter().map(|((i, j), kept)| (i, j, kept));
        let contacts = contacts.into_iter();
        let contacts = contacts.map(|((grain, _), (word, kept))| (grain, word, kept));
        take_lists(world, pairs, contacts)
    }
}
