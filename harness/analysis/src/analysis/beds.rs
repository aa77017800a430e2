//! Runs at one speed through several beds as one point. Blocks within a run do not know what one bed remembers of its
//! pouring; several beds do.

use super::exponents::near;
use super::point::{ErrorOf, Point, Within};
use super::value::Value;

/// The runs of a curve, in ascending order of the Froude number, as a point for each speed.
pub(super) fn over_beds(runs: &[Point]) -> Vec<Point> {
    let same = |a: &Point, b: &Point| near(a.froude, b.froude);
    runs.chunk_by(same).map(mean_point).collect()
}

/// The mean over beds: every bed counts alike.
fn mean_point(runs: &[Point]) -> Point {
    let first = &runs[0];
    if runs.len() == 1 {
        return first.clone();
    }
    let n = runs.len() as f64;
    let mean = |of: fn(&Point) -> f64| runs.iter().map(of).sum::<f64>() / n;
    let all = |of: fn(&Point) -> Option<Value>| -> Option<Value> {
        let values: Option<Vec<Value>> = runs.iter().map(of).collect();
        values.map(|values| larger(&values).0)
    };
    let drags: Vec<Value> = runs.iter().map(|p| p.drag).collect();
    let (drag, error_of) = larger(&drags);
    let travel = runs.iter().map(|p| p.by_travel.len()).min().unwrap_or(0);
    let along = |k: usize| runs.iter().map(|p| p.by_travel[k]).sum::<f64>() / n;
    let shares = runs.iter().map(|p| p.coordination.len()).min().unwrap_or(0);
    let share = |k: usize| runs.iter().map(|p| p.coordination[k]).sum::<f64>() / n;
    Point {
        beds: runs.len(),
        error_of,
        depth: mean(|p| p.depth),
        plug_ratio: mean(|p| p.plug_ratio),
        drag,
        uncut: all(|p| p.uncut),
        by_travel: (0..travel).map(along).collect(),
        angle: all(|p| p.angle),
        new_angle: all(|p| p.new_angle),
        kappa: all(|p| p.kappa),
        within: within(runs),
        floating: all(|p| p.floating),
        moving: all(|p| p.moving),
        drift: all(|p| p.drift),
        coordination: (0..shares).map(share).collect(),
        ..first.clone()
    }
}

/// Plain mean, with the larger of two errors: that of the errors given, and that of the scatter.
pub(super) fn larger(values: &[Value]) -> (Value, ErrorOf) {
    let n = values.len() as f64;
    let value = values.iter().map(|v| v.value).sum::<f64>() / n;
    let own = values.iter().map(|v| v.error * v.error).sum::<f64>().sqrt() / n;
    let squares = values.iter().map(|v| (v.value - value) * (v.value - value));
    let seen = (squares.sum::<f64>() / (n - 1.0).max(1.0) / n).sqrt();
    match seen > own {
        true => (Value::new(value, seen), ErrorOf::Beds),
        false => (Value::new(value, own), ErrorOf::Blocks),
    }
}

/// The means within each distance that all runs have.
fn within(runs: &[Point]) -> Vec<Within> {
    let at = |one: &Within| {
        let found = |p: &Point| p.within.iter().find(|w| w.reach == one.reach).copied();
        let all: Option<Vec<Within>> = runs.iter().map(found).collect();
        let all = all?;
        let of = |of: fn(&Within) -> Value| larger(&all.iter().map(of).collect::<Vec<_>>()).0;
        Some(Within {
            reach: one.reach,
            coordination: of(|w| w.coordination),
            floating: of(|w| w.floating),
            kappa: of(|w| w.kappa),
        })
    };
    runs[0].within.iter().filter_map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beds_that_differ_more_than_their_blocks_give_the_error() {
        let blocks = [
            Value::new(10.0, 2.0),
            Value::new(11.0, 2.0),
            Value::new(9.0, 2.0),
            Value::new(10.0, 2.0),
        ];
        let (mean, of) = larger(&blocks);
        assert_eq!((mean.value, mean.error, of), (10.0, 1.0, ErrorOf::Blocks));
        let beds = blocks.map(|v| Value::new(v.value, 0.1));
        let (mean, of) = larger(&beds);
        assert!((mean.error - (2.0f64 / 3.0 / 4.0).sqrt()).abs() < 1e-12 && of == ErrorOf::Beds);
        assert_eq!(larger(&blocks[..1]).0, blocks[0]);
    }
}
