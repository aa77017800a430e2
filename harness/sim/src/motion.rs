//! How an intruder and a bed move past each other: what measuring needs to know of an experiment.

use serde::{Deserialize, Serialize};

/// Which of bed and intruder moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Moves {
    /// The intruder, through a bed at rest on its base (Kumar 2018).
    #[default]
    Intruder,
    /// The bed, carried by its base and its lid past an intruder at rest (Guillard 2014).
    Bed,
}

impl Moves {
    /// Where the intruder goes along x as seen from the bed: 1 or -1.
    pub fn forward(self) -> f64 {
        match self {
            Moves::Intruder => 1.0,
            Moves::Bed => -1.0,
        }
    }
}

/// A motion at constant speed, along x or of the ends of a bar about z, and the steps over which means are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Which of the two moves.
    pub moves: Moves,
    /// Speed of one relative to the other, positive.
    pub speed: f64,
    /// Time step, positive.
    pub dt: f64,
    /// Mean diameter of the grains, in which distances are counted.
    pub grain_diameter: f64,
    /// First and last step that are averaged.
    pub window: [u64; 2],
    /// The last step of the motion; means may end before it.
    pub last: u64,
}

impl Motion {
    /// Steps of the whole motion.
    pub fn steps(&self) -> u64 {
        self.last
    }

    /// Travel of one past the other after `step` steps.
    pub fn travel(&self, step: u64) -> f64 {
        step as f64 * self.dt * self.speed
    }

    /// The same motion of `steps` steps, averaged from the first that ends beyond a travel of `discard`.
    #[must_use]
    pub fn averaged_beyond(mut self, discard: f64, steps: u64) -> Self {
        let mut first = (discard / (self.speed * self.dt)) as u64;
        while first > 0 && self.travel(first) > discard {
            first -= 1;
        }
        while self.travel(first) <= discard && first < steps {
            first += 1;
        }
        self.window = [first.max(1), steps];
        self.last = steps;
        self
    }

    /// The same motion with means that end with the last step whose travel is not beyond `travel`.
    #[must_use]
    pub fn averaged_up_to(mut self, travel: f64) -> Self {
        let mut end = (travel / (self.speed * self.dt)) as u64 + 1;
        while end > 0 && self.travel(end) > travel {
            end -= 1;
        }
        let end = if end < self.last { end } else { self.last };
        self.window[1] = end;
        self
    }
}
