//! Drag by travel: the mean over each diameter of the way, from which means over any part of it follow.

use bitgrain_sim::block_averaging::BlockSums;
use bitgrain_sim::motion::Motion;

use crate::series::SeriesRow;

/// Mean drag over each whole mean diameter of travel, from the first. The mean of a row counts for all of its steps.
pub(crate) fn drag_by_travel(series: &[SeriesRow], motion: &Motion) -> Vec<f64> {
    let diameter = motion.grain_diameter / (motion.speed * motion.dt);
    let last = series.last().map_or(0, |row| row.step) as f64;
    // A drag ends with the step that is nearest to its distance.
    let whole = ((last + 0.5) / diameter) as usize;
    let mut all = Vec::with_capacity(whole);
    let mut rows = series.iter();
    // Steps up to which everything is summed, and the row that goes on from there.
    let (mut at, mut row) = (0.0, rows.next());
    for k in 1..=whole {
        let end = (k as f64 * diameter).min(last);
        let (from, mut sum) = (at, 0.0);
        while let Some(open) = row {
            let ends = open.step as f64;
            let to = if ends < end { ends } else { end };
            sum += open.force_mean[0] * (to - at);
            at = to;
            if ends > end {
                break;
            }
            row = rows.next();
        }
        all.push(sum / (end - from));
    }
    all
}

/// Standard error of the mean drag with nothing cut, from blocks of the rows; `None` of fewer than 16 rows.
pub(crate) fn uncut_error(series: &[SeriesRow]) -> Option<f64> {
    let mut sums = BlockSums::default();
    series.iter().for_each(|row| sums.add(row.force_mean[0]));
    Some(sums.mean()?.standard_error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_sim::motion::Moves;

    fn motion(speed: f64, dt: f64) -> Motion {
        Motion {
            moves: Moves::Intruder,
            speed,
            dt,
            grain_diameter: 1.0,
            window: [1, 1],
            last: 1,
        }
    }

    fn rows(ends: &[u64], drag: impl Fn(u64) -> f64) -> Vec<SeriesRow> {
        let row = |&step| SeriesRow {
            step,
            force_mean: [drag(step), 0.0, 0.0],
            ..SeriesRow::default()
        };
        ends.iter().map(row).collect()
    }

    #[test]
    fn rows_are_split_where_a_diameter_ends() {
        // A diameter is 10 steps; the rows end at 4, 8, ..., the last at 22.
        let series = rows(&[4, 8, 12, 16, 20, 22], |step| step as f64);
        let found = drag_by_travel(&series, &motion(0.1, 1.0));
        let first = (4.0 * 4.0 + 8.0 * 4.0 + 12.0 * 2.0) / 10.0;
        let second = (12.0 * 2.0 + 16.0 * 4.0 + 20.0 * 4.0) / 10.0;
        assert_eq!(found, [first, second]);
    }

    #[test]
    fn a_row_over_several_diameters_counts_in_each() {
        let found = drag_by_travel(&rows(&[25, 30], |step| step as f64), &motion(0.1, 1.0));
        assert_eq!(found, [25.0, 25.0, 27.5]);
    }

    #[test]
    fn the_mean_of_whole_diameters_is_the_uncut_mean() {
        // 20 diameters of 1000/3 steps, rows of 7 steps.
        let steps = 6667;
        let ends: Vec<u64> = (1..=steps / 7).map(|k| 7 * k).chain([steps]).collect();
        let series = rows(&ends, |step| libm::sin(step as f64));
        let found = drag_by_travel(&series, &motion(0.3, 0.01));
        assert_eq!(found.len(), 20);
        let mut before = 0;
        let all: f64 = series
            .iter()
            .map(|row| {
                row.force_mean[0] * (row.step - std::mem::replace(&mut before, row.step)) as f64
            })
            .sum();
        let mean = found.iter().sum::<f64>() / 20.0;
        // A third of the last step is beyond them.
        assert!((mean - all / steps as f64).abs() < 1e-4, "{mean}");
        assert!(uncut_error(&series).is_some() && uncut_error(&series[..15]).is_none());
    }
}
