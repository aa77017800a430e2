//! Histograms of a drag, as CSV files: contact angles on the intruder (Kumar 2018, Fig. 6) and the
//! coordination numbers of the grains near it (Fig. 7).

use serde::{Deserialize, Serialize};

use crate::table::{Cell, Table, column};

/// Bins of the contact angle between 0 and pi: five degrees each.
pub const ANGLE_BINS: usize = 36;

/// A bin of contact angles, as a table has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleBin {
    /// From this angle (radians).
    pub low: f64,
    /// To this one.
    pub high: f64,
    /// Contacts of all of the window's samples together.
    pub contacts: u64,
    /// Contacts that began in the window.
    pub new: u64,
}

/// Contact angles.
pub const ANGLES: Table<AngleBin> = Table(&[
    column("angle_low", |r| Cell::Real(&mut r.low)),
    column("angle_high", |r| Cell::Real(&mut r.high)),
    column("contacts", |r| Cell::Whole(&mut r.contacts)),
    column("new_contacts", |r| Cell::Whole(&mut r.new)),
]);

/// Contact angles counted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Angles {
    /// Contacts in each of [`ANGLE_BINS`] bins; bin `k` is from `k` to `k + 1` times `pi / 36`.
    pub bins: Vec<u64>,
    /// The same of contacts as they begin.
    pub new: Vec<u64>,
}

impl Default for Angles {
    fn default() -> Self {
        Self {
            bins: vec![0; ANGLE_BINS],
            new: vec![0; ANGLE_BINS],
        }
    }
}

impl Angles {
    /// Whether it has all its bins.
    pub fn is_whole(&self) -> bool {
        self.bins.len() == ANGLE_BINS && self.new.len() == ANGLE_BINS
    }

    /// Counts angles (radians, 0 to pi).
    pub fn add(&mut self, angles: &[f64]) {
        angles.iter().for_each(|angle| self.bins[bin(*angle)] += 1);
    }

    /// Counts the angle of a contact that begins.
    pub fn add_new(&mut self, angle: f64) {
        self.new[bin(angle)] += 1;
    }

    /// Their file: [`ANGLES`].
    pub fn text(&self) -> String {
        let edge = |k: usize| k as f64 * (std::f64::consts::PI / ANGLE_BINS as f64);
        let counts = self.bins.iter().zip(&self.new).enumerate();
        let bin = |(k, (&contacts, &new))| AngleBin {
            low: edge(k),
            high: edge(k + 1),
            contacts,
            new,
        };
        ANGLES.text("", &counts.map(bin).collect::<Vec<AngleBin>>())
    }
}

/// The bin of an angle.
fn bin(angle: f64) -> usize {
    let bin = (angle * (ANGLE_BINS as f64 / std::f64::consts::PI)) as usize;
    bin.min(ANGLE_BINS - 1)
}

/// Contacts of a grain, and the number of grains that have so many in all of the window's samples together.
pub const COORDINATION: Table<(u64, u64)> = Table(&[
    column("contacts", |r| Cell::Whole(&mut r.0)),
    column("grains", |r| Cell::Whole(&mut r.1)),
]);

/// Coordination numbers counted.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coordination {
    /// Grains with this many contacts, from none.
    pub grains: Vec<u64>,
}

impl Coordination {
    /// Counts the grains of one sample by their numbers of contacts.
    pub fn add(&mut self, numbers: &[f64]) {
        for &number in numbers {
            let number = number as usize;
            if number >= self.grains.len() {
                self.grains.resize(number + 1, 0);
            }
            self.grains[number] += 1;
        }
    }

    /// Shares of the grains with 0, 1, 2, ... contacts; empty if no grain was counted.
    pub fn shares(&self) -> Vec<f64> {
        let all: u64 = self.grains.iter().sum();
        self.grains.iter().map(|&n| n as f64 / all as f64).collect()
    }

    /// Their file: [`COORDINATION`].
    pub fn text(&self) -> String {
        let rows = (0..).zip(self.grains.iter().copied());
        COORDINATION.text("", &rows.collect::<Vec<(u64, u64)>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_fall_into_their_bins() {
        let mut angles = Angles::default();
        let pi = std::f64::consts::PI;
        angles.add(&[0.0, 0.01, 0.5 * pi + 0.01, pi]);
        assert_eq!(
            (angles.bins[0], angles.bins[18], angles.bins[35]),
            (2, 1, 1)
        );
        angles.add_new(0.5 * pi);
        assert_eq!((angles.new[18], angles.new.iter().sum::<u64>()), (1, 1));
        assert_eq!(angles.text().lines().count(), 38);
        let mut numbers = Coordination::default();
        numbers.add(&[0.0, 4.0, 4.0]);
        let third = 1.0 / 3.0;
        assert_eq!(numbers.shares(), [third, 0.0, 0.0, 0.0, 2.0 / 3.0]);
        let text = numbers.text();
        let (_, rows) = text.split_once('\n').unwrap();
        assert_eq!(rows, "contacts,grains\n0,1\n1,0\n2,0\n3,0\n4,2\n");
    }
}
