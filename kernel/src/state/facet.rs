//! Triangles of a mesh, and which place of one is nearest.

use crate::math::real::{Real, larger, magnitude, smaller};
use crate::math::vec3::{Vec3, cross, dot, scale, sub};
use crate::state::shape::divide;

/// A triangle of a mesh, in the axes of its obstacle. Grains touch both of its sides. One without an area is a line or
/// a point. [`arrange`](crate::arrange) makes a mesh of several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Facet<R> {
    /// Its corners in ascending order, so that triangles that share an edge compute the same numbers for it.
    pub(crate) corners: [Vec3<R>; 3],
    /// Unit vector across it; zero if it has no area.
    pub(crate) normal: Vec3<R>,
    /// The box round those triangles of the mesh that this one stands for in a search.
    pub(crate) lo: Vec3<R>,
    pub(crate) hi: Vec3<R>,
}

/// The part of a triangle that is nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Feature<R> {
    Face,
    /// With its ends, the lower one first.
    Edge([Vec3<R>; 2]),
    Corner(Vec3<R>),
}

/// The nearest place of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near<R> {
    pub feature: Feature<R>,
    /// Unit vector from there.
    pub normal: Vec3<R>,
    pub distance: R,
}

/// Whether one place comes before another: by x, then y, then z.
pub(crate) fn is_before<R: Real>(a: &Vec3<R>, b: &Vec3<R>) -> bool {
    if a[0] != b[0] {
        return a[0] < b[0];
    }
    if a[1] != b[1] {
        return a[1] < b[1];
    }
    a[2] < b[2]
}

impl<R: Real> Facet<R> {
    /// The triangle with these corners (length, in the axes of its obstacle), in any order.
    #[must_use]
    #[inline(never)]
    pub fn new(corners: [[R; 3]; 3]) -> Self {
        // There is one zero.
        let [mut a, mut b, mut c] = corners.map(|corner| corner.map(|x| x + R::ZERO));
        if is_before(&b, &a) {
            (a, b) = (b, a);
        }
        if is_before(&c, &b) {
            (b, c) = (c, b);
        }
        if is_before(&b, &a) {
            (a, b) = (b, a);
        }
        let (along, across) = (sub(b, a), sub(c, a));
        let area = cross(along, across);
        let square = dot(area, area);
        // The direction of one that is thinner than rounding is none.
        let least = (dot(along, along) * R::EPSILON) * dot(across, across);
        let normal = match square > least {
            true => divide(area, square.sqrt()),
            false => [R::ZERO; 3],
        };
        let mut facet = Self {
            corners: [a, b, c],
            normal,
            lo: a,
            hi: a,
        };
        (facet.lo, facet.hi) = facet.bounds();
        facet
    }

    /// Its corners (length, in the axes of its obstacle), by ascending x, then y, then z.
    #[must_use]
    pub fn corners(&self) -> [[R; 3]; 3] {
        self.corners
    }

    /// The box round it.
    pub(crate) fn bounds(&self) -> (Vec3<R>, Vec3<R>) {
        let [a, b, c] = self.corners;
        let (mut lo, mut hi) = (a, a);
        for k in 0..3 {
            lo[k] = smaller(smaller(a[k], b[k]), c[k]);
            hi[k] = larger(larger(a[k], b[k]), c[k]);
        }
        (lo, hi)
    }

    pub(crate) fn has(&self, corner: Vec3<R>) -> bool {
        self.corners.contains(&corner)
    }

    /// Whether the place is over the face: on the inner side of each edge.
    fn is_over(&self, place: Vec3<R>) -> bool {
        let [a, b, c] = self.corners;
        let side =
            |from: Vec3<R>, to: Vec3<R>| dot(cross(sub(to, from), sub(place, from)), self.normal);
        // The corners ascend, so that each edge is measured from the same end in both of its triangles.
        self.normal != [R::ZERO; 3]
            && side(a, b) >= R::ZERO
            && side(b, c) >= R::ZERO
            && side(a, c) <= R::ZERO
    }

    /// Its place that is nearest to `place`, in the axes of the obstacle.
    #[inline(never)]
    pub(crate) fn nearest(&self, place: Vec3<R>) -> Near<R> {
        let [a, b, c] = self.corners;
        if self.is_over(place) {
            let height = dot(sub(place, a), self.normal);
            let side = if height < R::ZERO { -R::ONE } else { R::ONE };
            return Near {
                feature: Feature::Face,
                normal: scale(self.normal, side),
                distance: magnitude(height),
            };
        }
        let mut least = to_edge(a, b, place);
        for (from, to) in [(a, c), (b, c)] {
            let near = to_edge(from, to, place);
            if near.distance < least.distance {
                least = near;
            }
        }
        least
    }
}

/// The place of an edge that is nearest.
#[inline(never)]
fn to_edge<R: Real>(from: Vec3<R>, to: Vec3<R>, place: Vec3<R>) -> Near<R> {
    let (along, apart) = (sub(to, from), sub(place, from));
    let (way, length) = (dot(apart, along), dot(along, along));
    let (feature, apart) = if way > R::ZERO && way < length {
        let foot = scale(along, way / length);
        (Feature::Edge([from, to]), sub(apart, foot))
    } else if way > R::ZERO && length > R::ZERO {
        (Feature::Corner(to), sub(place, to))
    } else {
        (Feature::Corner(from), apart)
    };
    let distance = dot(apart, apart).sqrt();
    Near {
        feature,
        normal: divide(apart, distance),
        distance,
    }
}

/// Distance of a place from what two triangles share: an edge or a corner. None if they share nothing.
#[inline(never)]
pub(crate) fn to_shared<R: Real>(one: &Facet<R>, other: &Facet<R>, place: Vec3<R>) -> Option<R> {
    let [a, b, c] = one.corners;
    let mut least = None;
    let mut note = |near: Near<R>| {
        if least.is_none_or(|least| near.distance < least) {
            least = Some(near.distance);
        }
    };
    let has = |corner| other.has(corner);
    for corner in [a, b, c] {
        if has(corner) {
            note(to_edge(corner, corner, place));
        }
    }
    for (from, to) in [(a, b), (a, c), (b, c)] {
        if has(from) && has(to) {
            note(to_edge(from, to, place));
        }
    }
    least
}
