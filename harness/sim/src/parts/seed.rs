//! A part before it begins: own grains and histories, cut out of a whole world, here or for another process.

use std::sync::Arc;

use bitgrain_kernel::{Clock, Domain, Facet, Group, LossPolicy, Obstacle};
use serde::{Deserialize, Serialize};

use super::ghosts::Ghosts;
use super::part::{Errand, Part};
use super::rows::Rows;
use crate::histories::Histories;
use crate::owned_world::OwnedWorld;

/// What a part is made of.
#[derive(Serialize, Deserialize)]
pub(super) struct Seed {
    domain: Domain<f64>,
    dt: f64,
    skins: [f64; 2],
    groups: Vec<Group<f64>>,
    obstacles: Vec<Obstacle<f64>>,
    #[serde(with = "facets")]
    facets: Arc<Vec<Facet<f64>>>,
    policy: LossPolicy<f64>,
    clock: Clock<f64>,
    rows: Rows,
    /// Places of its grains in the whole world, ascending.
    places: Vec<u32>,
    /// Histories in places of the whole world.
    pub histories: Histories,
    /// Words of the law of each contact.
    words: usize,
}

impl Seed {
    /// The grains at these places of a world that has begun, without histories.
    pub fn of(home: &OwnedWorld<f64>, places: Vec<u32>) -> Self {
        let mut rows = Rows::default();
        for place in &places {
            rows.add_own(home, *place as usize);
        }
        rows.end();
        Self {
            domain: home.domain,
            dt: home.dt,
            skins: [home.skin, home.outer_skin],
            groups: home.groups.clone(),
            obstacles: home.obstacles.clone(),
            facets: Arc::clone(&home.facets),
            policy: home.policy,
            clock: home.clock.of_part(places.len()),
            rows,
            places,
            histories: Histories::default(),
            words: home.words(),
        }
    }

    /// Places of its grains in the whole world.
    pub fn places(&self) -> &[u32] {
        &self.places
    }

    /// The part of this number of so many.
    pub fn grow(mut self, number: usize, parts: usize, errand: &Errand) -> Part {
        let mut world = OwnedWorld {
            skin: self.skins[0],
            outer_skin: self.skins[1],
            groups: self.groups,
            obstacles: self.obstacles,
            facets: self.facets,
            policy: self.policy,
            clock: self.clock,
            ..OwnedWorld::new(self.domain, self.dt)
        };
        self.rows.swap_with(&mut world);
        let n = self.places.len();
        // What is too short grows later, or says that it cannot.
        let _ = world.reserve(3 * n + 64, 4 * n + 64, n / 8 + 64);
        let _ = world.keep_words(self.words);
        let ghosts = Ghosts::none(number, self.places, parts);
        let mut part = Part::new(number, world, ghosts, errand.clone());
        part.histories = self.histories;
        part
    }
}

/// Triangles that parts of one process share, written out for another one.
mod facets {
    use super::{Arc, Facet};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(all: &Arc<Vec<Facet<f64>>>, to: S) -> Result<S::Ok, S::Error> {
        all.as_slice().serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Arc<Vec<Facet<f64>>>, D::Error> {
        Vec::deserialize(from).map(Arc::new)
    }
}
