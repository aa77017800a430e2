//! Surfaces of obstacles for ParaView.

use bitgrain_kernel::vec3::{add, cross, scale};
use bitgrain_kernel::{Obstacle, Shape, to_world};

use super::vtk::{push_rows, push_vectors, push_whole, vtk_head};
use crate::simulation::Simulation;

/// Sides of what is round.
const SIDES: usize = 32;

type Polygon = Vec<[f64; 3]>;

/// The obstacles that have ends, as polygons of a VTK file, with the obstacle's number, its velocity, and the sum of
/// contact forces on it; round ones have 32 sides. `title` is its second line.
pub fn vtk_bodies(sim: &Simulation, title: &str) -> String {
    let surfaces = sim.obstacles.iter().map(|body| surface(sim, body));
    let polygons: Vec<(usize, Polygon)> = surfaces
        .enumerate()
        .flat_map(|(number, polygons)| polygons.into_iter().map(move |one| (number, one)))
        .collect();
    let corners: usize = polygons.iter().map(|(_, one)| one.len()).sum();
    let mut out = vtk_head(title);
    out.push_str(&format!("POINTS {corners} double\n"));
    push_rows(
        &mut out,
        polygons.iter().flat_map(|(_, one)| one.iter().copied()),
    );
    out.push_str(&format!(
        "POLYGONS {} {}\n",
        polygons.len(),
        polygons.len() + corners
    ));
    let mut next = 0;
    for (_, one) in &polygons {
        out.push_str(&one.len().to_string());
        for _ in one {
            out.push_str(&format!(" {next}"));
            next += 1;
        }
        out.push('\n');
    }
    let numbers = || polygons.iter().map(|(number, _)| *number);
    out.push_str(&format!("CELL_DATA {}\n", polygons.len()));
    push_whole(&mut out, "obstacle", "int", numbers().map(|k| k as i64));
    push_vectors(
        &mut out,
        "velocity",
        numbers().map(|k| sim.obstacles[k].velocity),
    );
    push_vectors(&mut out, "force", numbers().map(|k| sim.obstacles[k].force));
    out
}

/// The surface of a body where it is; nothing of an endless one.
fn surface(sim: &Simulation, body: &Obstacle<f64>) -> Vec<Polygon> {
    let own = match body.shape {
        Shape::Plane { .. } | Shape::Cylinder { .. } => Vec::new(),
        Shape::Sphere { radius } => turned([0.0, 0.0, 1.0], &half_circles(radius, 0.0)),
        Shape::Capsule {
            axis,
            radius,
            half_length,
        } => turned(axis, &half_circles(radius, half_length)),
        Shape::FiniteCylinder {
            axis,
            radius,
            half_length,
        }
        | Shape::Drum {
            axis,
            radius,
            half_length,
        } => {
            let (low, high) = (-half_length, half_length);
            turned(
                axis,
                &[[0.0, low], [radius, low], [radius, high], [0.0, high]],
            )
        }
        Shape::Box { half } => cuboid(half),
        Shape::Mesh { first, count, .. } => {
            let facets = sim.facets.iter().skip(first as usize).take(count as usize);
            facets.map(|facet| facet.corners().to_vec()).collect()
        }
    };
    let place = |corner: [f64; 3]| add(body.point, to_world(body.orientation, corner));
    own.into_iter()
        .map(|one| one.into_iter().map(place).collect())
        .collect()
}

/// Distances from the axis and heights of the outline of a capsule, or of a ball without a length.
fn half_circles(radius: f64, half_length: f64) -> Vec<[f64; 2]> {
    let quarter = SIDES / 4;
    let at = |k: usize, middle: f64| {
        let up = core::f64::consts::FRAC_PI_2 * (k as f64 / quarter as f64 - 1.0);
        [radius * libm::cos(up), middle + radius * libm::sin(up)]
    };
    let below = (0..=quarter).map(|k| at(k, -half_length));
    let above = (quarter..=2 * quarter).map(|k| at(k, half_length));
    below.chain(above).collect()
}

/// The surface of an outline that turns about an axis.
fn turned(axis: [f64; 3], outline: &[[f64; 2]]) -> Vec<Polygon> {
    let least = (0..3).fold(0, |a, b| if axis[b].abs() < axis[a].abs() { b } else { a });
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let across = cross(axis, other);
    let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
    let across = scale(across, 1.0 / length);
    let beside = cross(axis, across);
    let corner = |[far, up]: [f64; 2], side: usize| {
        let turn = core::f64::consts::TAU * (side % SIDES) as f64 / SIDES as f64;
        let out = add(
            scale(across, libm::cos(turn)),
            scale(beside, libm::sin(turn)),
        );
        add(scale(axis, up), scale(out, far))
    };
    let strip = |pair: &[[f64; 2]]| {
        let (low, high) = (pair[0], pair[1]);
        let piece = move |side: usize| {
            [(low, side), (low, side + 1), (high, side + 1), (high, side)]
                .map(|(at, side)| corner(at, side))
                .to_vec()
        };
        (0..SIDES).map(piece).collect::<Vec<_>>()
    };
    outline.windows(2).flat_map(strip).collect()
}

fn cuboid([x, y, z]: [f64; 3]) -> Vec<Polygon> {
    let face = |a: [f64; 3], u: [f64; 3], v: [f64; 3]| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(s, t)| add(a, add(scale(u, s), scale(v, t))))
            .to_vec()
    };
    let (i, j, k) = ([x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]);
    [(i, j, k), (j, k, i), (k, i, j)]
        .into_iter()
        .flat_map(|(a, u, v)| [face(a, u, v), face(scale(a, -1.0), v, u)])
        .collect()
}
