//! Meshes the obvious way, by what is written of them in `mesh.rs`: every triangle is looked at.

use bitgrain_kernel::Facet;
use bitgrain_kernel::vec3::{cross, dot, scale, sub};

type V = [f64; 3];

/// Where a triangle is nearest: 0 on its face, 1 on an edge, 2 on a corner; with the corners of that.
#[derive(Clone, PartialEq)]
struct Near {
    kind: u8,
    ends: Vec<V>,
    normal: V,
    distance: f64,
}

fn over(v: V, s: f64) -> V {
    v.map(|x| x / s)
}

fn on_edge(from: V, to: V, place: V) -> Near {
    let (along, apart) = (sub(to, from), sub(place, from));
    let (way, length) = (dot(apart, along), dot(along, along));
    let (kind, ends, apart) = if way <= 0.0 {
        (2, vec![from], apart)
    } else if way >= length {
        (2, vec![to], sub(place, to))
    } else {
        let foot = scale(along, way / length);
        (1, vec![from, to], sub(apart, foot))
    };
    let distance = dot(apart, apart).sqrt();
    Near {
        kind,
        ends,
        normal: over(apart, distance),
        distance,
    }
}

fn near(facet: &Facet<f64>, place: V) -> Near {
    let [a, b, c] = facet.corners();
    let area = cross(sub(b, a), sub(c, a));
    let across = over(area, dot(area, area).sqrt());
    let side = |from: V, to: V| dot(cross(sub(to, from), sub(place, from)), across);
    if side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(a, c) <= 0.0 {
        let height = dot(sub(place, a), across);
        return Near {
            kind: 0,
            ends: vec![a, b, c],
            normal: scale(across, if height < 0.0 { -1.0 } else { 1.0 }),
            distance: height.abs(),
        };
    }
    let edges = [
        on_edge(a, b, place),
        on_edge(a, c, place),
        on_edge(b, c, place),
    ];
    let least = edges
        .iter()
        .map(|near| near.distance)
        .fold(f64::INFINITY, f64::min);
    edges
        .into_iter()
        .find(|near| near.distance == least)
        .unwrap()
}

fn has(facet: &Facet<f64>, corner: &V) -> bool {
    facet.corners().contains(corner)
}

/// Whether a triangle holds a contact.
fn touches(all: &[Facet<f64>], k: usize, place: V, radius: f64) -> bool {
    let own = near(&all[k], place);
    let beaten = |other: usize| {
        let rival = near(&all[other], place);
        let shares = own.ends.iter().all(|end| has(&all[other], end));
        let is_near = other != k && rival.distance < radius && shares;
        is_near
            && match (own.kind, rival.kind) {
                (0, _) => false,
                (_, 0) => true,
                (1, 2) => false,
                (2, 1) if rival.ends.contains(&own.ends[0]) => true,
                (a, b) if a == b && own.ends == rival.ends => other < k,
                _ => rival.distance < own.distance,
            }
    };
    own.distance < radius && !(0..all.len()).any(beaten)
}

/// What a second contact leaves of the first.
fn left(own: &Near, rival: &Near, radius: f64, is_first: bool) -> f64 {
    let apart = sub(own.normal, rival.normal);
    let bend = dot(apart, apart) * 0.5;
    let sine = bend * (2.0 - bend);
    if sine <= f64::EPSILON && bend > 1.0 {
        return 1.0;
    }
    let (mut part, mut crease) = (0.5, own.distance.max(rival.distance));
    if sine > f64::EPSILON {
        let (one, two) = if is_first { (own, rival) } else { (rival, own) };
        let (d, e) = (one.distance, two.distance);
        let way = ((e - d) + d * bend) / sine.sqrt();
        crease = (d * d + way * way).sqrt();
        let lambda = (((d - e) + e * bend) / ((d + e) * bend)).clamp(0.0, 1.0);
        part = if is_first { lambda } else { 1.0 - lambda };
    }
    if crease >= radius {
        return 1.0;
    }
    let depth = ((radius - crease) / (radius - own.distance)).min(1.0);
    1.0 - part * (depth * depth.sqrt())
}

/// Unit vector, overlap and share of a contact on a triangle.
pub fn meet(all: &[Facet<f64>], k: usize, place: V, radius: f64) -> (V, f64, f64) {
    let own = near(&all[k], place);
    let overlap = radius - own.distance;
    if !touches(all, k, place, radius) {
        return (own.normal, overlap.min(0.0), 0.0);
    }
    let (mut taken, mut is_all) = (0.0, false);
    for (other, facet) in all.iter().enumerate() {
        let joined = all[k].corners().iter().any(|corner| has(facet, corner));
        if other == k || !joined || !touches(all, other, place, radius) {
            continue;
        }
        let left = left(&own, &near(facet, place), radius, k < other);
        if left > 0.0 {
            taken += 1.0 / left - 1.0;
        } else {
            is_all = true;
        }
    }
    if is_all {
        return (own.normal, 0.0, 0.0);
    }
    (own.normal, overlap, 1.0 / (1.0 + taken))
}

/// The triangle among these, on which the grain had springs, that hands its spring on to a new contact.
pub fn source(all: &[Facet<f64>], k: usize, had: &[usize], place: V, radius: f64) -> Option<usize> {
    let corners = all[k].corners();
    let mut best: Option<(f64, usize)> = None;
    for &other in had {
        let shared: Vec<V> = corners
            .iter()
            .filter(|c| has(&all[other], c))
            .copied()
            .collect();
        let mut far = f64::INFINITY;
        for (n, a) in shared.iter().enumerate() {
            far = far.min(on_edge(*a, *a, place).distance);
            for b in &shared[n + 1..] {
                far = far.min(on_edge(*a, *b, place).distance);
            }
        }
        let distance = near(&all[other], place).distance;
        if far < radius && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, other));
        }
    }
    best.map(|(_, other)| other)
}
