//! Means of the drag over the same path for every speed, with the start-up and without it (Kumar 2018, Fig. 4, averages
//! from the start).

use super::Value;
use super::point::Point;

/// Fewest diameters of travel, or blocks of several, that an error comes from.
const BLOCKS_MIN: usize = 4;

/// Drags of one point over a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnPath {
    /// Mean over the path without the travel that the averaging window leaves out.
    pub cut: Value,
    /// Mean over the whole path.
    pub uncut: Value,
}

/// The longest path in whole mean diameters that all points went; `None` if one of them does not say how its drag
/// went.
pub(super) fn common<'a>(points: impl Iterator<Item = &'a Point>) -> Option<usize> {
    points
        .map(|p| p.by_travel.len())
        .min()
        .filter(|path| *path > 0)
}

/// Drags over the first `path` diameters of travel; `None` if too few are left for an error.
pub(super) fn on_path(point: &Point, path: usize) -> Option<OnPath> {
    let drags = point.by_travel.get(..path)?;
    // What is left out is rounded up to a whole diameter.
    let from = libm::ceil(point.discard - 1e-9) as usize;
    Some(OnPath {
        cut: mean(drags.get(from..)?)?,
        uncut: mean(drags)?,
    })
}

/// The mean and the largest error of blocks of one diameter, two, four and so on, as long as four blocks are left: too
/// short a block gives too small an error.
fn mean(drags: &[f64]) -> Option<Value> {
    if drags.len() < BLOCKS_MIN {
        return None;
    }
    let mut worst = 0.0;
    let mut size = 1;
    while drags.len() / size >= BLOCKS_MIN {
        let blocks: Vec<f64> = drags
            .chunks_exact(size)
            .map(|block| block.iter().sum::<f64>() / size as f64)
            .collect();
        let n = blocks.len() as f64;
        let middle = blocks.iter().sum::<f64>() / n;
        let squares: f64 = blocks.iter().map(|b| (b - middle) * (b - middle)).sum();
        let error = (squares / (n - 1.0) / n).sqrt();
        if error > worst {
            worst = error;
        }
        size *= 2;
    }
    Some(Value::new(
        drags.iter().sum::<f64>() / drags.len() as f64,
        worst,
    ))
}

#[cfg(test)]
mod tests {
    use super::super::point::ErrorOf;
    use super::*;

    fn point(by_travel: &[f64], discard: f64) -> Point {
        Point {
            name: "m/r".into(),
            beds: 1,
            error_of: ErrorOf::Blocks,
            digest: String::new(),
            speed: 1.0,
            froude: 1.0,
            depth: 8.0,
            drag: Value::new(1.0, 0.1),
            uncut: None,
            by_travel: by_travel.to_vec(),
            discard,
            plug_ratio: 0.1,
            angle: None,
            new_angle: None,
            kappa: None,
            within: vec![],
            floating: None,
            moving: None,
            drift: None,
            coordination: vec![],
        }
    }

    #[test]
    fn a_start_is_in_one_mean_and_not_in_the_other() {
        let one = point(&[50.0, 20.0, 10.0, 12.0, 10.0, 12.0, 30.0], 1.5);
        let found = on_path(&one, 6).unwrap();
        assert_eq!((found.cut.value, found.uncut.value), (11.0, 19.0));
        // Of two values each way from the mean, four in all.
        assert!((found.cut.error - (4.0f64 / 3.0 / 4.0).sqrt()).abs() < 1e-12);
        assert!(on_path(&one, 5).is_none() && on_path(&one, 8).is_none());
        assert_eq!(common([&one, &point(&[1.0; 4], 1.0)].into_iter()), Some(4));
        assert_eq!(common([&one, &point(&[], 1.0)].into_iter()), None);
    }

    #[test]
    fn blocks_of_what_is_remembered_give_the_larger_error() {
        let drags: Vec<f64> = (0..16)
            .map(|k| if k / 4 % 2 == 0 { 9.0 } else { 11.0 })
            .collect();
        let value = mean(&drags).unwrap();
        assert_eq!(
            (value.value, value.error),
            (10.0, (4.0f64 / 3.0 / 4.0).sqrt())
        );
    }
}
