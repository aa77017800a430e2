//! The box: where it ends, which of its axes are periodic, and the nearest image across them.

use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::vec3::{Vec3, sub};

/// A rectangular box, each axis periodic or closed by its edges; or open space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Domain<R> {
    lo: Vec3<R>,
    hi: Vec3<R>,
    periodic: [bool; 3],
    /// Period of each periodic axis, 0 elsewhere.
    period: Vec3<R>,
    /// Half a period; on other axes a number that no separation exceeds.
    half: Vec3<R>,
}

impl<R> Domain<R> {
    /// Where in a domain it says which axes are periodic.
    pub(crate) const PERIODIC: usize = core::mem::offset_of!(Self, periodic);
}

impl<R: Real> Domain<R> {
    /// A box from `lo` to `hi` (units of length).
    ///
    /// # Errors
    /// [`Error::BadDomain`] unless `lo < hi` on every axis and all are finite; in fixed point, within a quarter of the
    /// range, so that no difference of two places overflows.
    pub fn new(lo: Vec3<R>, hi: Vec3<R>, periodic: [bool; 3]) -> Result<Self, Error> {
        let mut period = [R::ZERO; 3];
        let mut half = [R::MAX; 3];
        for a in 0..3 {
            let ordered = lo[a] < hi[a];
            let places = lo[a] >= -limit::<R>() && hi[a] <= limit::<R>();
            if !ordered || !places || !(hi[a] - lo[a]).is_finite() {
                return Err(Error::BadDomain { axis: a as u8 });
            }
            if periodic[a] {
                period[a] = hi[a] - lo[a];
                half[a] = period[a] * R::HALF;
            }
        }
        Ok(Self {
            lo,
            hi,
            periodic,
            period,
            half,
        })
    }

    /// No space at all: what a store holds before it is given a box.
    pub(crate) const VACANT: Self = Self {
        lo: [R::ZERO; 3],
        hi: [R::ZERO; 3],
        periodic: [false; 3],
        period: [R::ZERO; 3],
        half: [R::ZERO; 3],
    };

    /// Space without edges or periods.
    pub fn open() -> Self {
        Self {
            lo: [-limit::<R>(); 3],
            hi: [limit::<R>(); 3],
            periodic: [false; 3],
            period: [R::ZERO; 3],
            half: [R::MAX; 3],
        }
    }

    /// Lower edges (units of length).
    pub fn lo(&self) -> Vec3<R> {
        self.lo
    }

    /// Upper edges (units of length).
    pub fn hi(&self) -> Vec3<R> {
        self.hi
    }

    /// Which axes are periodic.
    pub fn periodic(&self) -> [bool; 3] {
        self.periodic
    }

    /// `a - b` to the nearest image: subtract first, then one selection per axis.
    #[inline(always)]
    pub fn separation(&self, a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
        self.nearest(sub(a, b))
    }

    /// The nearest image of a difference of two places in the box: one selection per axis.
    #[inline(always)]
    pub(crate) fn nearest(&self, raw: Vec3<R>) -> Vec3<R> {
        [
            self.image(raw[0], 0),
            self.image(raw[1], 1),
            self.image(raw[2], 2),
        ]
    }

    #[inline(always)]
    fn image(&self, raw: R, k: usize) -> R {
        let down = raw - self.period[k];
        let up = raw + self.period[k];
        let high = if raw > self.half[k] { down } else { raw };
        if raw < -self.half[k] { up } else { high }
    }

    /// Brings `x` back into the box along periodic axes and counts the crossings in `image`.
    /// Returns whether `x` is inside afterwards: `false` beyond a closed edge, for NaN, or if the
    /// count of crossings cannot grow and stays what it was.
    ///
    /// A coordinate that rounds to the upper edge becomes the lower edge, so that a place has one
    /// name only. A step may cross at most one period.
    #[inline(always)]
    pub fn wrap(&self, x: &mut Vec3<R>, image: &mut [i32; 3]) -> bool {
        let mut inside = true;
        for k in 0..3 {
            if !(x[k] >= self.lo[k] && x[k] < self.hi[k]) {
                inside &= self.wrap_axis(k, &mut x[k], &mut image[k]);
            }
        }
        inside
    }

    /// The lower and the upper edges as rows, without a limit in the last words.
    #[inline(always)]
    pub(crate) fn rows(&self) -> (Row<R>, Row<R>) {
        let ([x, y, z], [u, v, w]) = (self.lo, self.hi);
        ([x, y, z, -R::MAX], [u, v, w, R::MAX])
    }

    fn wrap_axis(&self, k: usize, x: &mut R, image: &mut i32) -> bool {
        if !self.periodic[k] {
            return *x >= self.lo[k] && *x <= self.hi[k];
        }
        let mut crossing = 0;
        if *x >= self.hi[k] {
            *x = *x - self.period[k];
            crossing = 1;
            if *x < self.lo[k] {
                *x = self.lo[k];
            }
        } else if *x < self.lo[k] {
            *x = *x + self.period[k];
            crossing = -1;
            if *x >= self.hi[k] {
                *x = self.lo[k];
                crossing = 0;
            }
        }
        // A count that overflowed would put the grain billions of periods away.
        let Some(count) = image.checked_add(crossing) else {
            return false;
        };
        *image = count;
        *x >= self.lo[k] && *x < self.hi[k]
    }
}

/// How far from the origin places may be.
pub(crate) fn limit<R: Real>() -> R {
    match R::FIXED_POINT {
        true => R::MAX * R::HALF * R::HALF,
        false => R::MAX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> Domain<f64> {
        Domain::new([0.0; 3], [10.0, 4.0, 8.0], [true, true, false]).unwrap()
    }

    #[test]
    fn separation_is_antisymmetric_to_the_bit_and_nearest() {
        let domain = ring();
        let (a, b) = ([9.75, 0.1, 7.5], [0.125, 3.9, 0.5]);
        let (ab, ba) = (domain.separation(a, b), domain.separation(b, a));
        for k in 0..3 {
            assert_eq!(ab[k].to_bits(), (-ba[k]).to_bits());
        }
        assert_eq!(ab, [-0.375, 0.1 - 3.9 + 4.0, 7.0]);
    }

    #[test]
    fn a_place_has_one_name() {
        let domain = ring();
        let (mut x, mut image) = ([-1e-30, 4.0, 1.0], [0; 3]);
        assert!(domain.wrap(&mut x, &mut image));
        assert_eq!((x, image), ([0.0, 0.0, 1.0], [0, 1, 0]));
        let (mut x, mut image) = ([-0.5, 4.5, 1.0], [0; 3]);
        assert!(domain.wrap(&mut x, &mut image));
        assert_eq!((x, image), ([9.5, 0.5, 1.0], [-1, 1, 0]));
    }

    #[test]
    fn closed_edges_and_nan_are_outside() {
        let domain = ring();
        assert!(!domain.wrap(&mut [1.0, 1.0, 8.5], &mut [0; 3]));
        assert!(!domain.wrap(&mut [f64::NAN, 1.0, 1.0], &mut [0; 3]));
        assert!(domain.wrap(&mut [1.0, 1.0, 8.0], &mut [0; 3]));
        assert!(Domain::new([0.0; 3], [1.0, 0.0, 1.0], [false; 3]).is_err());
    }

    #[test]
    fn crossings_are_counted_or_refused() {
        let domain = ring();
        let mut image = [i32::MAX, i32::MIN, 0];
        assert!(!domain.wrap(&mut [10.5, 1.0, 1.0], &mut image));
        assert!(!domain.wrap(&mut [1.0, -0.5, 1.0], &mut image));
        assert!(domain.wrap(&mut [-0.5, 4.5, 1.0], &mut image));
        assert_eq!(image, [i32::MAX - 1, i32::MIN + 1, 0]);
    }
}
