//! A part that adds up what all parts said: a letter that is lost, read twice or mixed up is seen in its sum.

use super::exchange::Exchange;
use super::letter::Letter;

/// What a part is to do.
#[derive(Clone, Copy)]
pub(super) struct Errand {
    /// Legs with a letter at their end.
    pub legs: u64,
    /// The part that panics, and in which leg.
    pub fatal: Option<(usize, u64)>,
    /// Called in each leg with the part and the leg.
    pub stall: fn(usize, u64),
}

impl Errand {
    /// So many legs.
    pub fn of(legs: u64) -> Self {
        Self {
            legs,
            fatal: None,
            stall: |_, _| (),
        }
    }
}

pub(super) struct Part {
    number: usize,
    parts: usize,
    errand: Errand,
    leg: u64,
    pub sum: u64,
    end: Option<()>,
}

/// What a part makes of all letters.
fn next(sum: u64, letters: impl Iterator<Item = u64>) -> u64 {
    letters.zip(1..).fold(sum, |sum, (letter, k)| {
        sum.wrapping_mul(31).wrapping_add(letter.wrapping_mul(k))
    })
}

/// The sums of so many parts after so many ways, one part after the other.
pub(super) fn sums_in_turn(parts: u64, legs: u64, ways: u64) -> Vec<u64> {
    let mut sums: Vec<u64> = (0..parts).collect();
    for _ in 0..ways * legs {
        let letters = sums.clone();
        for sum in &mut sums {
            *sum = next(*sum, letters.iter().copied());
        }
    }
    sums
}

impl Part {
    pub fn new(number: usize, parts: usize) -> Self {
        Self {
            number,
            parts,
            errand: Errand::of(0),
            leg: 0,
            sum: number as u64,
            end: None,
        }
    }

    pub fn depart(&mut self, errand: &Errand, _: bool) {
        (self.errand, self.leg, self.end) = (*errand, 0, None);
    }

    pub fn end(&self) -> Option<()> {
        self.end
    }

    pub fn advance(&mut self, letters: &Exchange<Letter>) {
        assert!(self.end.is_none(), "it goes no further than its end");
        assert!(self.errand.fatal != Some((self.number, self.leg)), "fatal");
        (self.errand.stall)(self.number, self.leg);
        if self.leg > 0 {
            let all = (0..self.parts).map(|from| letters.read(self.number, from).0);
            self.sum = next(self.sum, all);
        }
        self.leg += 1;
        if self.leg > self.errand.legs {
            self.end = Some(());
            return;
        }
        letters.write(self.number, |letter| letter.0 = self.sum);
    }
}
