//! The lift on a cylinder: its plateau, whether it still grows, and what is left of it without a pressure gradient
//! (Guillard 2014, section III B, Fig. 8).

use super::book::Claim;
use super::fits::{is_deep, plateau};
use super::means::means_of;
use super::number::{Found, Number};
use super::pairs::{pairs, ratio};
use super::points::{DEEP, Group, Point, SEEDS};
use crate::analysis::Value;
use crate::fit::Datum;
use crate::fit::power::power;
use bitgrain_lab::summary::Summary;

fn seeds(points: &[&Point]) -> Result<(), String> {
    match Group::seeds(points) {
        n if n < SEEDS => Err(format!(
            "a lift is told from {SEEDS} seeds or more; there are {n}"
        )),
        _ => Ok(()),
    }
}

/// The plateau, or the deepest points if they are deep enough for one.
pub(super) fn lift(group: &Group) -> Found {
    let points = group.with_gradient(true);
    seeds(&points)?;
    if let Some(flat) = plateau(&points) {
        let note = format!("plateau of {} points", flat.points);
        return Ok(Number::one(Value::new(flat.lift, flat.error), note));
    }
    let deepest = points.last().ok_or("no run has a gradient")?;
    let over = deepest.effective_depth / group.diameter;
    if over < DEEP {
        return Err(format!(
            "no plateau can be told, and the deepest run is at h~/D = {over:.0}, not {DEEP}"
        ));
    }
    Ok(Number::one(
        deepest.lift.into(),
        format!("at h~/D = {over:.0}"),
    ))
}

/// How the lift over the buoyancy grows with the effective depth from where it is to be saturated on: the exponent of
/// a power of the depth, 0 if it stays and 1 if it grows in proportion.
pub(super) fn saturation(group: &Group) -> Found {
    let mut deep = group.with_gradient(true);
    seeds(&deep)?;
    deep.retain(|p| is_deep(p.asked / group.diameter));
    let data: Vec<Datum> = deep
        .iter()
        .map(|p| Value::from(p.lift).at(p.effective_depth / group.diameter))
        .collect();
    let fit = power(&data, "h~/D").map_err(|why| why.to_string())?;
    let exponent = fit.parameter("p").expect("a power has an exponent");
    let lifts = data.iter().map(|d| format!("{:.1} at {:.0} D", d.y, d.x));
    let note = format!("lifts {}", lifts.collect::<Vec<_>>().join(", "));
    Ok(Number::one(exponent.into(), note))
}

pub(super) fn no_lift(claim: &Claim, group: &Group) -> Found {
    let pairs = pairs(group);
    let points: Vec<&Point> = pairs.iter().flat_map(|(a, b)| [*a, *b]).collect();
    seeds(&points)?;
    let axis = |p: &Point| format!(", axis {}", p.place.words(group.diameter));
    ratio(claim, group, |p| p.lift, axis)
}

/// The lift without a gradient with the axis in the middle of the bed, as in the paper. Base and surface may make one
/// of their own: the note has it with the axis at other places, too, where it would change sign with their distances.
pub(super) fn no_lift_in_the_middle(claim: &Claim, summary: &Summary, groups: &[Group]) -> Found {
    let all: Vec<(&Group, &Point)> = groups
        .iter()
        .flat_map(|group| {
            let own = group.with_gradient(false).into_iter();
            own.map(move |point| (group, point))
        })
        .collect();
    if all.iter().any(|(_, point)| !point.lift.mean.is_finite()) {
        return Err("a lift is not a finite number".into());
    }
    let told = |(group, point): &(&Group, &Point)| {
        let odd = means_of(summary, group, point)
            .odd
            .map_or(String::new(), |odd| {
                format!(
                    ", odd part {:.1} +- {:.1} of eq. 4's curve,",
                    odd.value, odd.error
                )
            });
        format!(
            "{:.1} +- {:.1}{odd} with the axis {} at h~/D = {:.0}",
            point.lift.mean,
            point.lift.error,
            point.place.words(group.diameter),
            point.effective_depth / group.diameter
        )
    };
    let words = || all.iter().map(told).collect::<Vec<_>>().join("; ");
    let middle = all
        .iter()
        .filter(|(group, point)| point.place.is_middle(group.diameter));
    let middle: Vec<&Point> = middle.map(|(_, point)| *point).collect();
    match (all.len(), middle.len()) {
        (0, _) => return Err("no run is without a pressure gradient".into()),
        (_, 0) => {
            return Err(format!(
                "no axis lies in the middle of the bed: {}",
                words()
            ));
        }
        _ => {}
    }
    seeds(&middle)?;
    let lifts = middle.iter().map(|p| (p.lift.into(), words()));
    claim.together(lifts.collect(), "no lift was measured")
}

#[cfg(test)]
mod tests {
    use super::super::guillard::measure;
    use super::super::synthetic::{self, Asked};

    /// Lifts that stay have the exponent 0, lifts that grow with the depth 1.
    #[test]
    fn a_lift_saturates_or_grows() {
        let exponent = |lift: fn(f64) -> f64| {
            let asked = Asked {
                lift,
                ..Asked::default()
            };
            let summary = synthetic::summary(&asked);
            measure(&synthetic::shipped("guillard-lift-saturates"), &summary).unwrap()
        };
        let flat = exponent(|_| 30.0).unwrap();
        assert!(flat.value.value.abs() < 1e-9, "{flat:?}");
        assert!(flat.note.contains("30.0 at 32 D"), "{flat:?}");
        let growing = exponent(|depth| 300.0 * depth).unwrap();
        assert!((growing.value.value - 1.0).abs() < 1e-9, "{growing:?}");
    }

    /// A lift that base and surface make, 400 buoyancies for a metre off the middle: the claim's number is that of the
    /// axis in the middle, the note has the others.
    #[test]
    fn the_lift_without_a_gradient_is_that_of_the_middle() {
        let at = |heights: &[f64], seeds| {
            let asked = Asked {
                heights: heights.to_vec(),
                depths: vec![0.099],
                lift_without: |height| 400.0 * (height - 0.5 * synthetic::SURFACE),
                seeds,
                ..Asked::default()
            };
            let claim = synthetic::shipped("guillard-no-lift-middle");
            measure(&claim, &synthetic::summary(&asked)).unwrap()
        };
        let found = at(&[0.024, 0.03, 0.036], 2).unwrap();
        let (value, note) = (found.value, found.note);
        assert!(value.value.abs() < 1e-12 && value.error > 0.1, "{value:?}");
        for part in [
            "0.0 +- 0.6 with the axis 6.1 D above the floor and 6.1 D below the surface at h~/D = 20",
            "-2.4 +- 0.6 with the axis 4.8 D above the floor and 7.3 D below",
            "2.4 +- 0.6 with the axis 7.3 D above the floor and 4.8 D below",
        ] {
            assert!(note.contains(part), "{part}: {note}");
        }
        assert!(at(&[0.03], 1).unwrap_err().contains("2 seeds"));
        let why = at(&[0.024], 2).unwrap_err();
        assert!(
            why.contains("in the middle") && why.contains("-2.4 +- 0.6"),
            "{why}"
        );
    }

    /// Of several places the one nearest to the middle is measured, and none is paired with another.
    #[test]
    fn claims_are_about_the_place_nearest_to_the_middle() {
        let asked = Asked {
            heights: vec![0.024, 0.031],
            lift_without: |height| if height < 0.03 { 15.0 } else { 3.0 },
            ..Asked::default()
        };
        let claim = synthetic::shipped("guillard-no-lift");
        let found = measure(&claim, &synthetic::summary(&asked))
            .unwrap()
            .unwrap();
        let (value, note) = (found.value, found.note);
        // The shallowest has a lift of 20 with a gradient.
        assert!((value.value - 3.0 / 20.0).abs() < 1e-9, "{value:?}");
        assert!(note.contains("axis 6.3 D above the floor"), "{note}");
    }
}
