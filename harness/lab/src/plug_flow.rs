//! Whether the bed above an intruder stays or slides along as a plug.
//!
//! In a box that is periodic along x and y only friction with what lies below holds the layers
//! above a dragged body back. How much of that is used up is shown by the drag over the weight of the bed
//! above the body's lowest point: the larger the ratio, the faster the layers drift, and the further the drag
//! may fall short of that in a wider box.
//!
//! **Measured** at Fr = 0.5 on D = 2 some 6 d deep over bases of 10 x 10, 12 x 12 and 14 x 14 (K_n = 2e5), ratio of
//! drag to weight, then drift over V with its standard error, then the drag; the first of each line is D = 2
//! 7 to 9 d deep over 28 x 14:
//!
//! | mu  | ratio: drift, drag                                                                           |
//! |-----|----------------------------------------------------------------------------------------------|
//! | 0   | 0.03: 0.02(1); 0.062: 0.04(1), 50(3); 0.079: 0.09(1), 48(2); 0.112: 0.11(2), 47(2)           |
//! | 0.1 | 0.06: 0.007(3); 0.113: 0.04(1), 95(5); 0.164: 0.10(1), 103(4); 0.227: 0.21(4), 99(4)         |
//! | 0.5 | 0.12: 0.017(4); 0.214: 0.092(8), 191(10); 0.265: 0.16(1), 174(6); 0.368: 0.25(2), 167(9)     |
//!
//! So the bounds below are ratios at which the layers drift by 2 % and by some 10 (mu = 0) to 20 % of the speed.
//!
//! That holds for slow drags. A fast one has a large ratio from the grains that it throws aside, and is over
//! before the layers above have gathered speed: at Fr = 10, 26 d over 28 x 14 and wider, ratios of 0.16 (mu = 0),
//! 0.22 (0.1) and 0.32 (0.5) go with drifts of 0.026, 0.031 and 0.045. So a bed beyond its bound slides only
//! if its layers are seen to drift by a tenth, and one whose layers drift by a fifth slides at any ratio.

use serde::{Deserialize, Serialize};

use bitgrain_sim::format::short;

/// What the ratio says of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlugFlow {
    /// The layers above stay.
    Sound,
    /// They drift by up to a fifth of the speed, and the drag may be low.
    Drifts,
    /// They slide along: the drag depends on the box as much as on the intruder.
    Slides,
    /// It was not judged: an older program wrote the summary.
    #[default]
    Unknown,
}

impl PlugFlow {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            PlugFlow::Sound => "sound",
            PlugFlow::Drifts => "drifts",
            PlugFlow::Slides => "slides",
            PlugFlow::Unknown => "unknown",
        }
    }

    /// Whether it was not judged.
    pub fn is_unknown(&self) -> bool {
        *self == PlugFlow::Unknown
    }
}

/// Up to which ratio of drag to weight a bed is sound, and beyond which it slides: measured at mu = 0, 0.1 and
/// 0.5, between and beyond them an exponential through these.
pub fn bounds(mu: f64) -> [f64; 2] {
    let rise = 1.0 - libm::exp(-mu / 0.13);
    [0.04 + 0.082 * rise, 0.12 + 0.184 * rise]
}

/// Drifts over V: below the first a bed does not slide, from the second on it does.
pub const DRIFTS: [f64; 2] = [0.1, 0.2];

/// What a ratio of drag to weight says, with the drift of the layers above over V if that was measured.
pub fn judge(mu: f64, ratio: f64, drift: Option<f64>) -> PlugFlow {
    let [sound, slides] = bounds(mu);
    let beyond = |least: f64| drift.is_some_and(|drift| drift.abs() >= least);
    let stays = drift.is_some() && !beyond(DRIFTS[0]);
    if !ratio.is_finite() || beyond(DRIFTS[1]) || ratio > slides && !stays {
        // A value that is not a number is not a sound bed either.
        PlugFlow::Slides
    } else if ratio <= sound && !beyond(DRIFTS[0]) {
        PlugFlow::Sound
    } else {
        PlugFlow::Drifts
    }
}

/// What was found of a bed that slides along, in words: the ratio beyond its bound, or the drift of its layers.
pub fn found(mu: f64, ratio: f64, drift: Option<f64>) -> String {
    let slides = bounds(mu)[1];
    let drift = drift.filter(|drift| drift.abs() >= DRIFTS[0]);
    let layers = drift.map(|drift| {
        format!(
            "the layers above the intruder drift at {} of its speed",
            short(drift)
        )
    });
    // A value that is not a number is beyond every bound.
    let beyond = ratio > slides || ratio.is_nan();
    match (beyond, layers) {
        (false, Some(layers)) => format!("{layers} (a bed slides from {} on)", DRIFTS[1]),
        (_, layers) => {
            let also = layers.map_or(String::new(), |layers| format!(", and {layers}"));
            format!(
                "the drag is {} of the weight of the bed above the intruder, more than friction can hold (up to {})\
                 {also}",
                short(ratio),
                short(slides)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_beds_are_judged_by_how_they_drifted() {
        let [sound, slides] = bounds(0.5);
        assert!((sound - 0.12).abs() < 0.001 && (slides - 0.3).abs() < 0.001);
        for (mu, ratio, drift, verdict) in [
            (0.0, 0.03, 0.02, PlugFlow::Sound),
            (0.0, 0.062, 0.04, PlugFlow::Drifts),
            (0.0, 0.112, 0.11, PlugFlow::Drifts),
            (0.1, 0.077, 0.016, PlugFlow::Sound),
            (0.1, 0.164, 0.1, PlugFlow::Drifts),
            (0.1, 0.227, 0.21, PlugFlow::Slides),
            (0.5, 0.118, 0.017, PlugFlow::Sound),
            (0.5, 0.265, 0.16, PlugFlow::Drifts),
            (0.5, 0.368, 0.25, PlugFlow::Slides),
            (0.5, 0.319, 0.045, PlugFlow::Drifts),
            (0.5, 0.1, 0.4, PlugFlow::Slides),
            (0.5, 0.1, -0.12, PlugFlow::Drifts),
            (0.5, f64::NAN, 0.01, PlugFlow::Slides),
        ] {
            assert_eq!(judge(mu, ratio, Some(drift)), verdict, "mu = {mu}, {ratio}");
        }
        assert_eq!(judge(0.5, 0.319, None), PlugFlow::Slides);
    }

    /// A bed that slides by its drift alone is not said to be held by too little friction.
    #[test]
    fn what_was_found_is_told() {
        let drift = found(0.5, 0.1, Some(0.4));
        assert!(drift.starts_with("the layers above the intruder drift at 0.4 of its speed"));
        assert!(
            !drift.contains("friction") && drift.contains("0.2"),
            "{drift}"
        );
        let ratio = found(0.5, 0.32, None);
        assert!(
            ratio.contains("0.32 of the weight") && ratio.contains("more than friction can hold")
        );
        let both = found(0.5, 0.368, Some(0.25));
        assert!(
            both.contains("0.368 of the weight") && both.contains("drift at 0.25"),
            "{both}"
        );
        assert!(found(0.5, f64::NAN, Some(0.01)).contains("more than friction can hold"));
    }
}
