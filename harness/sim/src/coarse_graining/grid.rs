//! Points of a regular grid about an intruder, periodic along x and y.

use serde::{Deserialize, Serialize};

/// Where the points are: each in the middle of its cell.
///
/// Along x and y places are measured from the intruder, which is in the middle of the box; along z from the floor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// How many points along each axis.
    pub counts: [usize; 3],
    /// Lengths of the box that they divide.
    pub size: [f64; 3],
}

impl Grid {
    /// How many points there are.
    pub fn points(&self) -> usize {
        self.counts[0] * self.counts[1] * self.counts[2]
    }

    /// Length of a cell along each axis.
    pub fn step(&self) -> [f64; 3] {
        [0, 1, 2].map(|a| self.size[a] / self.counts[a] as f64)
    }

    /// The lower corner.
    pub fn low(&self) -> [f64; 3] {
        [-0.5 * self.size[0], -0.5 * self.size[1], 0.0]
    }

    /// Place of the points with this number along an axis.
    pub fn at(&self, axis: usize, k: usize) -> f64 {
        self.low()[axis] + (k as f64 + 0.5) * self.step()[axis]
    }

    /// Numbers of the points along an axis within `reach` of a place, and how far each lies from it. Along x
    /// and y they wrap round the box, of which `reach` is at most half.
    pub fn near(
        &self,
        axis: usize,
        place: f64,
        reach: f64,
    ) -> impl Iterator<Item = (usize, f64)> + Clone + use<> {
        let (step, low) = (self.step()[axis], self.low()[axis]);
        let (count, periodic) = (self.counts[axis] as i64, axis < 2);
        let number = |x: f64| (x - low) / step - 0.5;
        let (mut first, mut last) = (
            number(place - reach).ceil() as i64,
            number(place + reach).floor() as i64,
        );
        if !periodic {
            (first, last) = (first.max(0), last.min(count - 1));
        }
        // At exactly half the box the two ends are one point.
        last = last.min(first + count - 1);
        (first..=last).map(move |k| {
            let at = low + (k as f64 + 0.5) * step;
            (k.rem_euclid(count) as usize, at - place)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid {
        counts: [4, 2, 5],
        size: [8.0, 2.0, 10.0],
    };

    #[test]
    fn points_lie_in_the_middle_of_their_cells() {
        assert_eq!(GRID.points(), 40);
        assert_eq!([0, 3].map(|k| GRID.at(0, k)), [-3.0, 3.0]);
        assert_eq!([0, 4].map(|k| GRID.at(2, k)), [1.0, 9.0]);
    }

    #[test]
    fn points_near_a_place_go_round_the_box_but_not_through_the_floor() {
        let near = |axis, place, reach| GRID.near(axis, place, reach).collect::<Vec<_>>();
        assert_eq!(near(0, 3.5, 2.0), [(3, -0.5), (0, 1.5)]);
        assert_eq!(near(0, -3.9, 1.5), [(3, -1.1), (0, 0.8999999999999999)]);
        assert_eq!(near(2, 0.5, 2.6), [(0, 0.5), (1, 2.5)]);
        assert_eq!(near(2, 9.9, 1.0), [(4, -0.9000000000000004)]);
        assert_eq!(near(0, 0.0, 4.0).len(), 4);
        assert_eq!(near(1, 0.1, 0.2), []);
    }
}
