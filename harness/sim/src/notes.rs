//! Notes of every step of a stretch, for a host that wants to know some numbers of each step and the rows only at the
//! end: forces on obstacles, where grains touch them, and forces on some grains.
//!
//! A part of a world notes what its own grains do (`Notebook`); joined by ascending place, the notes are those of the
//! whole world (`join`).

use bitgrain_kernel::phases::{
    GrainRange, NotedForces, ObstacleContactRange, ObstacleShare, sum_on_obstacles,
};
use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{Obstacle, Row, TOUCHING};
use serde::{Deserialize, Serialize};

/// What is noted.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Watch {
    /// Numbers of obstacles.
    pub obstacles: Vec<u32>,
    /// Places of grains.
    pub grains: Vec<u32>,
}

/// One step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Note {
    /// Its number.
    pub step: u64,
    /// The obstacles of [`Watch::obstacles`], in its order.
    pub obstacles: Vec<ObstacleNote>,
    /// Forces on the grains of [`Watch::grains`], in its order.
    pub forces: Vec<[f64; 3]>,
}

/// An obstacle in one step.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleNote {
    /// The obstacle with its place and the force and torque on it.
    pub body: Obstacle<f64>,
    /// The grains that touch it, by ascending place, and where their centres are.
    pub touching: Vec<(u32, [f64; 3])>,
}

/// The notes of a call.
pub(crate) struct Taken<'w> {
    pub watch: &'w Watch,
    pub notes: Vec<Note>,
}

impl<'w> Taken<'w> {
    /// None yet.
    pub fn new(watch: &'w Watch) -> Self {
        Self {
            watch,
            notes: Vec::new(),
        }
    }
}

/// What the grains of a world, or the own grains of a part, do in the steps of a stretch.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Notebook {
    #[serde(skip)]
    watch: Watch,
    /// Places here of the watched grains that are own, ascending, and their numbers in the watch.
    #[serde(skip)]
    place: Vec<u32>,
    #[serde(skip)]
    number: Vec<u32>,
    /// Their forces in the present step.
    #[serde(skip)]
    force: Vec<Row<f64>>,
    pages: Vec<Page>,
}

/// One step.
#[derive(Debug, Serialize, Deserialize)]
struct Page {
    step: u64,
    /// Those that are watched, as they stand.
    obstacles: Vec<Obstacle<f64>>,
    touches: Vec<Touch>,
    forces: Vec<(u32, [f64; 3])>,
}

/// A grain that touches a watched obstacle.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Touch {
    grain: u32,
    position: [f64; 3],
    share: ObstacleShare<f64>,
}

impl Notebook {
    /// Empty.
    pub fn new(watch: &Watch) -> Self {
        Self {
            watch: watch.clone(),
            ..Self::default()
        }
    }

    /// Finds the watched grains among own ones: `place` tells where a grain of the whole world is here.
    pub fn find(&mut self, place: impl Fn(u32) -> Option<u32>) {
        let numbered = (0u32..).zip(&self.watch.grains);
        let here = numbered.filter_map(|(number, grain)| Some((place(*grain)?, number)));
        let mut here: Vec<(u32, u32)> = here.collect();
        here.sort_unstable();
        (self.place, self.number) = here.into_iter().unzip();
        self.force.clear();
        self.force.resize(self.place.len(), [0.0; 4]);
    }

    /// Begins a step, whose obstacle contacts are summed.
    pub fn begin(&mut self, step: u64, touch: &ObstacleContactRange<'_, f64>, at: &[Row<f64>]) {
        let listed = touch.grain.iter().zip(touch.obstacle.iter());
        let touches = listed.zip(touch.shares.iter());
        let touches = touches.filter(|((_, word), share)| {
            **word & TOUCHING != 0 && self.watch.obstacles.contains(&share.obstacle)
        });
        let touches = touches.map(|((grain, _), share)| Touch {
            grain: *grain,
            position: head(at[*grain as usize]),
            share: *share,
        });
        let touches = touches.collect();
        let obstacle = |k: &u32| touch.obstacles[*k as usize];
        self.pages.push(Page {
            step,
            obstacles: self.watch.obstacles.iter().map(obstacle).collect(),
            touches,
            forces: Vec::new(),
        });
    }

    /// Lends itself for the forces on grains.
    pub fn lend<'a>(&'a mut self, grains: &mut GrainRange<'a, f64>) {
        grains.noted = NotedForces {
            place: &self.place,
            force: &mut self.force,
        };
    }

    /// Ends a step, whose forces are noted; `home` tells the place in the whole world.
    pub fn end(&mut self, home: impl Fn(u32) -> u32) {
        let Some(page) = self.pages.last_mut() else {
            return;
        };
        for touch in &mut page.touches {
            touch.grain = home(touch.grain);
        }
        let forces = self.number.iter().zip(&self.force);
        page.forces
            .extend(forces.map(|(number, force)| (*number, head(*force))));
    }
}

/// The notes of all parts up to step `last`, which is finished.
pub(crate) fn join(watch: &Watch, books: impl Iterator<Item = Notebook>, last: u64) -> Vec<Note> {
    let mut pages: Vec<_> = books.map(|book| book.pages.into_iter()).collect();
    let mut notes = Vec::new();
    loop {
        let step: Vec<Page> = pages.iter_mut().filter_map(Iterator::next).collect();
        match step.first() {
            Some(page) if page.step <= last => notes.push(whole(watch, &step)),
            _ => return notes,
        }
    }
}

/// What parts have of grains, by ascending grain. Stable: what there is of a grain is in one part, in order.
pub(crate) fn by_grain<'p, T: Copy + 'p>(
    parts: impl Iterator<Item = &'p Vec<T>>,
    grain: impl Fn(&T) -> u32,
) -> Vec<T> {
    let mut all: Vec<T> = parts.flatten().copied().collect();
    all.sort_by_key(grain);
    all
}

/// One step of all parts.
fn whole(watch: &Watch, pages: &[Page]) -> Note {
    let touches = by_grain(pages.iter().map(|page| &page.touches), |touch| touch.grain);
    let of = |k: u32| {
        touches
            .iter()
            .filter(move |touch| touch.share.obstacle == k)
    };
    let obstacles = watch.obstacles.iter().zip(&pages[0].obstacles);
    let obstacles = obstacles.map(|(k, body)| {
        let mut body = [*body];
        // By itself it is number 0.
        let shares = of(*k).map(|touch| ObstacleShare {
            obstacle: 0,
            ..touch.share
        });
        sum_on_obstacles(&mut body, shares);
        ObstacleNote {
            body: body[0],
            touching: of(*k).map(|touch| (touch.grain, touch.position)).collect(),
        }
    });
    let mut forces = vec![[0.0; 3]; watch.grains.len()];
    for (number, force) in pages.iter().flat_map(|page| &page.forces) {
        forces[*number as usize] = *force;
    }
    Note {
        step: pages[0].step,
        obstacles: obstacles.collect(),
        forces,
    }
}
