//! Bytes as choices and numbers.

use bitgrain::case::MotionSpec;
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};

/// Bytes as choices; beyond their end there are zeros.
pub(super) struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }

    pub fn below(&mut self, count: u8) -> usize {
        usize::from(self.byte() % count)
    }

    /// From `lo` to `hi` in 65,536 places.
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        let word = u16::from_le_bytes([self.byte(), self.byte()]);
        lo + (hi - lo) * f64::from(word) / 65535.0
    }

    /// From 10^lo to 10^hi; now and then any number at all.
    pub fn scale(&mut self, lo: f64, hi: f64) -> f64 {
        if self.byte() < 250 {
            return 10f64.powf(self.between(lo, hi));
        }
        let word = std::array::from_fn(|_| self.byte());
        f64::from_bits(u64::from_le_bytes(word))
    }

    /// Zero, one time in four, or a scale.
    pub fn zero_or_scale(&mut self, lo: f64, hi: f64) -> f64 {
        match self.below(4) {
            0 => 0.0,
            _ => self.scale(lo, hi),
        }
    }

    pub fn vector(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-1.0, 1.0))
    }

    /// A direction of length 1.
    pub fn direction(&mut self) -> [f64; 3] {
        unit(self.vector())
    }

    pub fn law(&mut self) -> LawSpec {
        if self.below(2) == 0 {
            LawSpec::HertzHistory(HertzHistoryParameters {
                kn: self.scale(2.0, 10.0),
                kt: self.zero_or_scale(2.0, 10.0),
                gamma_n: self.zero_or_scale(0.0, 6.0),
                gamma_t: self.zero_or_scale(0.0, 6.0),
                mu: self.zero_or_scale(-2.0, 2.0),
                rolling: None,
            })
        } else {
            LawSpec::HertzTsuji(HertzTsujiParameters {
                young: self.scale(3.0, 11.0),
                poisson: self.between(-0.9, 0.5),
                restitution: self.between(0.01, 1.0),
                mu: self.zero_or_scale(-2.0, 2.0),
                rolling: None,
            })
        }
    }

    pub fn motion(&mut self, speed: f64) -> MotionSpec {
        match self.below(8) {
            0 => MotionSpec::Frozen,
            1 => MotionSpec::Carried(self.vector().map(|v| v * speed)),
            2 => MotionSpec::Weightless,
            3 => {
                let [x, y, _] = self.vector();
                MotionSpec::Lid([x * speed, y * speed])
            }
            _ => MotionSpec::Free,
        }
    }
}

/// A vector of length 1 along another; up if that has no length.
pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    if length > 0.0 {
        v.map(|x| x / length)
    } else {
        [0.0, 0.0, 1.0]
    }
}
