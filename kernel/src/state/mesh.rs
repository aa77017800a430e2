//! Meshes of triangles as surfaces: which triangles a grain touches, and how much of a contact each of them holds.
//!
//! A grain touches a mesh where its distance from the surface is least among all places around: on a face that it is
//! over; on an edge only if it is over no face of that edge and no other place of them is nearer; on a corner only if
//! that holds for all triangles around it. So there is one contact over a flat or convex edge, whichever triangles meet
//! there, and one on each face of a hollow one.
//!
//! At a hollow crease the grain may come over the second face while it overlaps the crease itself, and two whole
//! contacts would count the overlap there twice: on a nearly flat crease the force would double at once. So what the
//! crease itself would press with, `(g / delta)^(3/2)` of the force of a contact of depth `delta` if the crease is `g`
//! deep in the grain, is shared: a part `lambda` of it is taken from one contact and `1 - lambda` from the other, where
//! `lambda` goes from 0, as the grain comes over the second face, to 1, as it leaves the first. A crease that does not
//! reach into the grain takes nothing.
//!
//! Nothing here depends on the order of triangles in a file: [`arrange`] puts them in one order, and each rule is
//! one of distances, the order of corners deciding between equal ones.

use crate::blake3::Hasher;
use crate::math::real::{Real, larger, smaller};
use crate::math::rows::{part, set, sort_by};
use crate::math::vec3::{Vec3, add, dot, sub};
use crate::state::facet::{Facet, Feature, Near, is_before};
use crate::state::shape::Nearest;

/// A mesh can have so many triangles.
pub const FACETS_MAX: usize = 1 << 19;

/// Gaps of Shell's sort: Ciura's, and longer ones by a factor of 2.25.
const GAPS: [usize; 15] = [
    204_585, 90_927, 40_412, 17_961, 7_983, 3_548, 1_577, 701, 301, 132, 57, 23, 10, 4, 1,
];

/// Brings triangles into the order of a mesh, whatever order they are in, and prepares their search: near ones
/// come together, along a curve through 1,024 cells in each direction, and those of a cell go by their corners.
/// The number of a triangle is its place from now on, as [`surface_of`](crate::surface_of) gives it.
pub fn arrange<R: Real>(facets: &mut [Facet<R>]) {
    let (mut lo, mut hi) = ([R::MAX; 3], [-R::MAX; 3]);
    for facet in facets.iter() {
        let middle = middle(facet);
        for k in 0..3 {
            lo[k] = smaller(lo[k], middle[k]);
            hi[k] = larger(hi[k], middle[k]);
        }
    }
    let code = |facet: &Facet<R>| along_curve(middle(facet), lo, hi);
    sort_by(facets, &GAPS, |a, b| {
        let (first, second) = (code(a), code(b));
        first < second || first == second && precedes(a, b)
    });
    let end = facets.len();
    enclose(facets, 0, end);
}

/// A third of the sum of corners: in fixed point the sum might be no number.
fn middle<R: Real>(facet: &Facet<R>) -> Vec3<R> {
    let third = R::from_f64(1.0 / 3.0);
    let [a, b, c] = facet.corners.map(|corner| corner.map(|x| x * third));
    add(add(a, b), c)
}

/// Where a place is along Morton's curve through a box.
fn along_curve<R: Real>(place: Vec3<R>, lo: Vec3<R>, hi: Vec3<R>) -> u32 {
    let mut code = 0;
    for k in 0..3 {
        let wide = hi[k] - lo[k];
        let cells = R::from_count(1023);
        let cell = match wide > R::ZERO {
            true => (((place[k] - lo[k]) / wide) * cells).to_index() as u32,
            false => 0,
        };
        for bit in 0..10 {
            code |= (cell >> bit & 1) << (3 * bit + k as u32);
        }
    }
    code
}

fn precedes<R: Real>(a: &Facet<R>, b: &Facet<R>) -> bool {
    for (x, y) in a.corners.iter().zip(&b.corners) {
        if x != y {
            return is_before(x, y);
        }
    }
    false
}

/// Sets the box of the triangle in the middle of a range to that of the whole range, and so on in both halves.
fn enclose<R: Real>(facets: &mut [Facet<R>], begin: usize, end: usize) -> (Vec3<R>, Vec3<R>) {
    let middle = begin + (end - begin) / 2;
    let Some(facet) = facets.get(middle).filter(|_| begin < end) else {
        return ([R::MAX; 3], [-R::MAX; 3]);
    };
    let mut facet = *facet;
    (facet.lo, facet.hi) = facet.bounds();
    for (lo, hi) in [
        enclose(facets, begin, middle),
        enclose(facets, middle + 1, end),
    ] {
        for k in 0..3 {
            facet.lo[k] = smaller(facet.lo[k], lo[k]);
            facet.hi[k] = larger(facet.hi[k], hi[k]);
        }
    }
    set(facets, middle, facet);
    (facet.lo, facet.hi)
}

/// A triangle, and its place that is nearest to a grain.
struct Candidate<'f, R> {
    number: u32,
    facet: &'f Facet<R>,
    near: Near<R>,
}

/// The triangles of one mesh.
#[derive(Clone, Copy)]
pub(crate) struct Mesh<'a, R>(pub &'a [Facet<R>]);

impl<'a, R: Real> Mesh<'a, R> {
    /// Those from `first` on.
    pub(crate) fn of(facets: &'a [Facet<R>], first: u32, count: u32) -> Self {
        let first = first as usize;
        Self(part(facets, first, first.saturating_add(count as usize)))
    }

    /// The farthest corner from the origin.
    pub(crate) fn reach(self) -> R {
        let corners = self.0.iter().flat_map(|facet| facet.corners);
        corners.fold(R::ZERO, |most, corner| {
            larger(most, dot(corner, corner).sqrt())
        })
    }

    /// The first half of the hash of all corners: what tells meshes apart.
    #[inline(never)]
    pub(crate) fn name(self) -> u64 {
        let mut hasher = Hasher::new();
        for x in self.0.iter().flat_map(|facet| facet.corners).flatten() {
            let (low, high) = x.to_words();
            hasher.word(low);
            high.into_iter().for_each(|high| hasher.word(high));
        }
        let [a, b, c, d, e, f, g, h, ..] = hasher.finish();
        u64::from_le_bytes([a, b, c, d, e, f, g, h])
    }

    /// Calls `found` with the number of each triangle, ascending, whose box is within `far` of `place` in each axis, as
    /// long as it wants more.
    pub(crate) fn near(self, place: Vec3<R>, far: R, found: &mut dyn FnMut(u32) -> bool) {
        self.within(0, self.0.len(), (place, far), found);
    }

    #[inline(never)]
    fn within(
        self,
        begin: usize,
        end: usize,
        (place, far): (Vec3<R>, R),
        found: &mut dyn FnMut(u32) -> bool,
    ) -> bool {
        let middle = begin + (end - begin) / 2;
        let Some(facet) = self.0.get(middle).filter(|_| begin < end) else {
            return true;
        };
        let meets = |lo: Vec3<R>, hi: Vec3<R>| {
            (0..3).all(|k| place[k] - hi[k] <= far && lo[k] - place[k] <= far)
        };
        if !meets(facet.lo, facet.hi) {
            return true;
        }
        let (lo, hi) = facet.bounds();
        self.within(begin, middle, (place, far), found)
            && (!meets(lo, hi) || found(middle as u32))
            && self.within(middle + 1, end, (place, far), found)
    }

    /// Where a grain of this radius at `place` meets the triangle of this number, and the share of the law's force that
    /// counts: none, and no overlap, if it touches the mesh elsewhere than where this triangle is nearest.
    #[inline(never)]
    pub(crate) fn meet(self, number: u32, place: Vec3<R>, radius: R) -> (Nearest<R>, R) {
        let mut met = Nearest {
            normal: [R::ZERO; 3],
            overlap: -R::MAX,
            curvature: R::ZERO,
        };
        let Some(facet) = self.0.get(number as usize) else {
            return (met, R::ZERO);
        };
        let near = facet.nearest(place);
        (met.normal, met.overlap) = (near.normal, radius - near.distance);
        let own = Candidate {
            number,
            facet,
            near,
        };
        if !self.touches(&own, place, radius) {
            met.overlap = smaller(met.overlap, R::ZERO);
            return (met, R::ZERO);
        }
        let share = self.share(&own, place, radius);
        if share == R::ZERO {
            met.overlap = R::ZERO;
        }
        (met, share)
    }

    /// Calls `found` with the other triangles that are nearer than `radius`, as long as it wants more.
    #[inline(never)]
    fn others(
        self,
        number: u32,
        place: Vec3<R>,
        radius: R,
        found: &mut dyn FnMut(&Candidate<'_, R>) -> bool,
    ) {
        self.near(place, radius, &mut |other| {
            let Some(facet) = self.0.get(other as usize).filter(|_| other != number) else {
                return true;
            };
            let near = facet.nearest(place);
            let candidate = Candidate {
                number: other,
                facet,
                near,
            };
            candidate.near.distance >= radius || found(&candidate)
        });
    }

    /// Whether the nearest place of a triangle is nearest among all places around it.
    #[inline(never)]
    fn touches(self, own: &Candidate<'_, R>, place: Vec3<R>, radius: R) -> bool {
        let mut touches = own.near.distance < radius;
        if touches && own.near.feature != Feature::Face {
            self.others(own.number, place, radius, &mut |rival| {
                touches = !gives_way(own, rival);
                touches
            });
        }
        touches
    }

    /// The share of a contact beside those that it meets at a crease: `1 / (1 + sum (1 / f - 1))` over what each of
    /// them alone would leave, `f`, so that flat triangles that meet in a corner hold one contact together.
    #[inline(never)]
    fn share(self, own: &Candidate<'_, R>, place: Vec3<R>, radius: R) -> R {
        let (mut taken, mut is_all) = (R::ZERO, false);
        self.others(own.number, place, radius, &mut |rival| {
            let joined = own
                .facet
                .corners
                .iter()
                .any(|corner| rival.facet.has(*corner));
            if joined && self.touches(rival, place, radius) {
                let left = left_by([&own.near, &rival.near], radius, own.number < rival.number);
                match left > R::ZERO {
                    true => taken = taken + (R::ONE / left - R::ONE),
                    false => is_all = true,
                }
            }
            !is_all
        });
        match is_all {
            true => R::ZERO,
            false => R::ONE / (R::ONE + taken),
        }
    }
}

/// Whether the nearest place of a triangle, on an edge or a corner, is not the nearest place around it, by another
/// triangle; or is the same place of that one, whose number is lower.
///
/// Faces come before edges, edges before corners, whatever the rounding of distances: one of all always remains.
#[inline(never)]
fn gives_way<R: Real>(own: &Candidate<'_, R>, rival: &Candidate<'_, R>) -> bool {
    let (number, other, facet) = (own.number, rival.number, rival.facet);
    let is_nearer = rival.near.distance < own.near.distance;
    match own.near.feature {
        Feature::Face => false,
        Feature::Edge([a, b]) => {
            facet.has(a)
                && facet.has(b)
                && match rival.near.feature {
                    Feature::Face => true,
                    Feature::Edge(edge) if edge == [a, b] => other < number,
                    Feature::Edge(_) => is_nearer,
                    Feature::Corner(_) => false,
                }
        }
        Feature::Corner(a) => {
            facet.has(a)
                && match rival.near.feature {
                    Feature::Face => true,
                    Feature::Edge(edge) => is_nearer || edge.contains(&a),
                    Feature::Corner(b) if a == b => other < number,
                    Feature::Corner(_) => is_nearer,
                }
        }
    }
}

/// What a second contact leaves of the force of the first, where the planes across them meet in a crease: see above.
#[inline(never)]
fn left_by<R: Real>([near, rival]: [&Near<R>; 2], radius: R, is_first: bool) -> R {
    // One less the cosine of the angle between the normals, also of nearly equal ones.
    let apart = sub(near.normal, rival.normal);
    let bend = dot(apart, apart) * R::HALF;
    let squared_sine = bend * ((R::ONE + R::ONE) - bend);
    let (mut part, mut crease) = (R::HALF, larger(near.distance, rival.distance));
    if squared_sine > R::EPSILON {
        let (one, two) = match is_first {
            true => (near, rival),
            false => (rival, near),
        };
        // From the foot of the grain's centre on the plane of one to the crease.
        let to_crease = (two.distance - one.distance) + one.distance * bend;
        let to_crease = to_crease / squared_sine.sqrt();
        crease = (one.distance * one.distance + to_crease * to_crease).sqrt();
        let way = (one.distance - two.distance) + two.distance * bend;
        let whole = (one.distance + two.distance) * bend;
        let lambda = larger(smaller(way / whole, R::ONE), R::ZERO);
        part = if is_first { lambda } else { R::ONE - lambda };
    } else if bend > R::ONE {
        // Two sides of a plate.
        return R::ONE;
    }
    if crease >= radius {
        return R::ONE;
    }
    let depth = smaller((radius - crease) / (radius - near.distance), R::ONE);
    R::ONE - part * (depth * depth.sqrt())
}
