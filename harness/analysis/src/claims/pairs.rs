//! Points with and without a pressure gradient at one effective depth, and their ratios.

use super::book::Claim;
use super::fits::same_depth;
use super::number::Found;
use super::points::{Group, Point, Spread};
use crate::analysis::Value;

/// Points with and without a gradient at one effective depth.
pub(super) fn pairs(group: &Group) -> Vec<(&Point, &Point)> {
    let with = group.with_gradient(true);
    let same = |a: &Point, b: &Point| same_depth(a.asked, b.asked);
    let partner = |b: &&'_ Point| with.iter().find(|a| same(a, b)).copied();
    let without = group.with_gradient(false).into_iter();
    without.filter_map(|b| Some((partner(&b)?, b))).collect()
}

pub(super) const NO_PAIR: &str = "no two runs with and without gradient have one effective depth";

/// A quantity of each pair, without a gradient over with it, and what is told of the point without.
pub(super) fn ratio(
    claim: &Claim,
    group: &Group,
    of: fn(&Point) -> Spread,
    told: impl Fn(&Point) -> String,
) -> Found {
    let over = |(with, without): &(&Point, &Point)| {
        let ratio = Value::from(of(without)).over(of(with).into());
        let depth = with.effective_depth / group.diameter;
        let more = told(without);
        (ratio, format!("h~/D = {depth:.0}, without over with{more}"))
    };
    claim.together(pairs(group).iter().map(over).collect(), NO_PAIR)
}
