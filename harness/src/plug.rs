//! Whether the bed above an intruder stays or slides along as a plug.
//!
//! In a box that is periodic along x and y nothing but friction with what lies below holds the layers
//! above a dragged body back. How much of that is used up is told by the drag over the weight of the bed
//! above the body's lowest point; beyond a part of the bed's bulk friction the layers drift, and the drag
//! falls short of that in a wider box.

use serde::{Deserialize, Serialize};

/// What the ratio says of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Plug {
    /// The layers above stay.
    Sound,
    /// They drift by some hundredths of the speed, and the drag may be low by as much.
    Drifts,
    /// They slide along: the drag is the box's as much as the intruder's.
    Slides,
    /// It was not judged: the summary is an older program's.
    #[default]
    Unknown,
}

impl Plug {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Plug::Sound => "sound",
            Plug::Drifts => "drifts",
            Plug::Slides => "slides",
            Plug::Unknown => "unknown",
        }
    }

    /// Whether it was not judged.
    pub fn is_unknown(&self) -> bool {
        *self == Plug::Unknown
    }
}

/// Bulk friction of a bed of spheres with this friction coefficient between two of them.
pub fn bulk_friction(mu: f64) -> f64 {
    0.1 + 0.27 * (1.0 - libm::exp(-mu / 0.12))
}

/// Up to which ratio of drag to weight a bed is sound, and beyond which it slides.
pub fn bounds(mu: f64) -> [f64; 2] {
    let friction = bulk_friction(mu);
    [SOUND * friction, SLIDES * friction]
}

/// Parts of the bulk friction that bound the ratio.
const SOUND: f64 = 0.33;
const SLIDES: f64 = 0.82;

/// What a ratio of drag to weight says.
pub fn judge(mu: f64, ratio: f64) -> Plug {
    let [sound, slides] = bounds(mu);
    if ratio <= sound {
        Plug::Sound
    } else if ratio <= slides {
        Plug::Drifts
    } else {
        // What is no number is no sound bed either.
        Plug::Slides
    }
}
