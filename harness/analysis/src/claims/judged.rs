//! A finding with its verdict, and what must hold before a steady value counts.

use super::points::Point;
use super::verdict::Statement;
use super::verdict::Verdict;
use bitgrain_sim::format::short;

/// Least speed of the far grains over the speed asked for in a bed that follows its base.
pub const FAR_FIELD_LEAST: f64 = 0.95;
/// Least travel of a window in grain diameters: of the paper's 40 cylinder diameters, 132 grain diameters
/// at D/d = 3.3, a little less than half (Guillard 2014, section III A).
pub const TRAVEL_LEAST: f64 = 60.0;

/// What was measured and how it compares.
pub(super) struct Judged {
    verdict: Verdict,
    measured: String,
    reason: String,
}

impl Judged {
    pub(super) fn new(
        verdict: Verdict,
        measured: impl Into<String>,
        reason: impl Into<String>,
    ) -> Self {
        Self {
            verdict,
            measured: measured.into(),
            reason: reason.into(),
        }
    }

    pub(super) fn unresolved(measured: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::new(Verdict::NotResolved, measured, reason)
    }

    /// NotResolved where one of the points it rests on slipped, or travelled too little for a steady value.
    pub(super) fn if_steady<'a>(self, points: impl Iterator<Item = &'a Point> + Clone) -> Self {
        let slowest = least(points.clone().map(|p| p.far_field));
        let shortest = least(points.map(|p| p.travel));
        let (follows, far) = (slowest >= FAR_FIELD_LEAST, shortest >= TRAVEL_LEAST);
        let why = if !follows {
            format!(
                "The bed did not follow its base: its far grains went at {} of the speed, less than \
                 {FAR_FIELD_LEAST}.",
                short(slowest)
            )
        } else if !far {
            format!(
                "A window holds only {} grain diameters of travel, less than {TRAVEL_LEAST}, which is \
                 too few for a steady value.",
                short(shortest)
            )
        } else {
            return self;
        };
        Self {
            verdict: Verdict::NotResolved,
            measured: self.measured,
            reason: why,
        }
    }

    pub(super) fn into_statement(self, subject: &str, expected: &str) -> Statement {
        Statement {
            subject: subject.into(),
            expected: expected.into(),
            measured: self.measured,
            verdict: self.verdict,
            reason: self.reason,
        }
    }
}

/// The verdict on several of a kind: one that differs makes all differ; of the others, those that are
/// resolved count.
pub(super) fn verdict_of(verdicts: &[Verdict]) -> Verdict {
    let any = |wanted| verdicts.contains(&wanted);
    if any(Verdict::Disagrees) {
        Verdict::Disagrees
    } else if any(Verdict::Agrees) {
        Verdict::Agrees
    } else {
        Verdict::NotResolved
    }
}

/// The least; NaN if one is no number, which is worse than any.
pub(super) fn least(values: impl Iterator<Item = f64>) -> f64 {
    let less = |a: f64, x: f64| if x < a || x.is_nan() { x } else { a };
    values.fold(f64::INFINITY, less)
}
