//! Meshes of triangles: from STL files and arrays into a world.

use std::cmp::Ordering;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use bitgrain_kernel::{FACETS_MAX, Facet, Obstacle, Shape, arrange};
use stl_io::create_stl_reader;

use crate::disk;
use crate::error::{Error, Result};
use crate::owned_world::OwnedWorld;

/// Three corners (length).
pub type Triangle = [[f64; 3]; 3];

/// The triangles of an STL file, text or binary, which holds numbers of seven digits. Normals and attributes are not
/// read: grains touch both sides.
///
/// # Errors
/// A file that cannot be read or is no STL file; triangles as [`check_triangles`] finds them.
pub fn read_stl(path: &Path) -> Result<Vec<Triangle>> {
    let name = path.display().to_string();
    let bytes = disk::read(path)?;
    parse_stl(&bytes).map_err(|problem| Error::input(name, problem))
}

/// The triangles in the bytes of an STL file.
///
/// # Errors
/// What is wrong with them.
pub fn parse_stl(bytes: &[u8]) -> std::result::Result<Vec<Triangle>, String> {
    let wrong = |fault: std::io::Error| {
        format!("is no STL file, in text (it begins with `solid`) or binary: {fault}")
    };
    let mut bytes = Cursor::new(bytes);
    let reader = create_stl_reader(&mut bytes).map_err(wrong)?;
    let mut triangles = Vec::new();
    for triangle in reader {
        let corners = triangle.map_err(wrong)?.vertices;
        triangles.push(corners.map(|corner| corner.0.map(f64::from)));
        if triangles.len() > FACETS_MAX {
            break;
        }
    }
    check_triangles(&triangles)?;
    Ok(triangles)
}

/// Checks that these triangles can be a mesh: at least one, not too many, and all corners numbers.
///
/// # Errors
/// What is wrong with them.
pub fn check_triangles(triangles: &[Triangle]) -> std::result::Result<(), String> {
    if triangles.is_empty() {
        return Err("has no triangle".into());
    }
    if triangles.len() > FACETS_MAX {
        return Err(format!(
            "has more than {FACETS_MAX} triangles; make it coarser, or give it in pieces"
        ));
    }
    let numbers = |triangle: &Triangle| triangle.as_flattened().iter().all(|x| x.is_finite());
    if let Some(k) = triangles.iter().position(|triangle| !numbers(triangle)) {
        return Err(format!("triangle {k} has a corner that is not finite"));
    }
    let (meet, [x, y, z]) = crowded_corner(triangles);
    match meet > MEETING_MAX {
        true => Err(format!(
            "{meet} triangles meet in the corner ({x}, {y}, {z}), at most {MEETING_MAX} may: a grain there touches all \
             of them, and each contact is looked at beside each other; make the mesh coarser around that corner"
        )),
        false => Ok(()),
    }
}

/// So many triangles may meet in a corner.
const MEETING_MAX: usize = 4096;

/// The corner in which most triangles meet, and how many.
fn crowded_corner(triangles: &[Triangle]) -> (usize, [f64; 3]) {
    let mut corners = triangles.as_flattened().to_vec();
    let order = |a: &[f64; 3], b: &[f64; 3]| {
        let axes = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
        axes.fold(Ordering::Equal, Ordering::then)
    };
    corners.sort_unstable_by(order);
    let runs = corners.chunk_by(|a, b| a == b);
    let most = runs.max_by_key(|run| run.len());
    most.map_or((0, [0.0; 3]), |run| (run.len(), run[0]))
}

/// Adds these triangles to those of a world, and returns the mesh that they are, about this point, at rest and
/// infinitely heavy; the caller adds it as an obstacle. Their corners are in the axes of the mesh, from its point.
/// Their order says nothing: the numbers that contacts have are those of [`arrange`].
pub fn add_mesh(
    world: &mut OwnedWorld<f64>,
    center: [f64; 3],
    triangles: &[Triangle],
) -> Obstacle<f64> {
    let facets = Arc::make_mut(&mut world.facets);
    let first = facets.len();
    facets.extend(triangles.iter().copied().map(Facet::new));
    let own = &mut facets[first..];
    arrange(own);
    Obstacle::mesh(center, own, first as u32)
}

/// The corners of all triangles of a world, one row each.
pub(crate) fn corners(facets: &[Facet<f64>]) -> Vec<Triangle> {
    facets.iter().map(Facet::corners).collect()
}

/// Triangles from the corners that [`corners`] gave, for these obstacles.
pub(crate) fn restored(corners: &[Triangle], obstacles: &[Obstacle<f64>]) -> Vec<Facet<f64>> {
    let mut facets: Vec<_> = corners.iter().copied().map(Facet::new).collect();
    for body in obstacles {
        if let Shape::Mesh { first, count, .. } = body.shape {
            let (first, count) = (first as usize, count as usize);
            // What is not there is found when the world is checked.
            if let Some(own) = facets.get_mut(first..first.saturating_add(count)) {
                arrange(own);
            }
        }
    }
    facets
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                        vertex 0 0.5 0\nendloop\nendfacet\nendsolid one\n";

    #[test]
    fn text_and_binary_files_are_read() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.5, 0.0]];
        assert_eq!(parse_stl(TEXT.as_bytes()), Ok(vec![corners]));
        let mut binary = vec![0u8; 80];
        binary.extend(1u32.to_le_bytes());
        let numbers = [0.0, 0.0, 1.0]
            .into_iter()
            .chain(corners.into_iter().flatten());
        binary.extend(numbers.flat_map(|x: f64| (x as f32).to_le_bytes()));
        binary.extend([0, 0]);
        assert_eq!(parse_stl(&binary), Ok(vec![corners]));
        // One byte less is no file.
        binary.pop();
        assert!(parse_stl(&binary).is_err());
    }

    #[test]
    fn what_is_no_mesh_is_told() {
        let told = |text: &str| parse_stl(text.as_bytes()).unwrap_err();
        assert!(told("").contains("no STL file"));
        assert!(told("solid none\nendsolid none\n").contains("no triangle"));
        let far = [[[0.0; 3], [f64::INFINITY, 0.0, 0.0], [0.0, 1.0, 0.0]]];
        assert!(check_triangles(&far).unwrap_err().contains("triangle 0"));
        let fan = |count: u32| -> Vec<Triangle> {
            let turn = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(count);
            let rim = |k: u32| [libm::cos(turn(k)), libm::sin(turn(k)), 1.0];
            (0..count).map(|k| [[0.0; 3], rim(k), rim(k + 1)]).collect()
        };
        assert_eq!(check_triangles(&fan(4096)), Ok(()));
        let many = check_triangles(&fan(4097)).unwrap_err();
        assert!(
            many.starts_with("4097 triangles meet in the corner (0, 0, 0)"),
            "{many}"
        );
        assert!(told(&TEXT.replace("0.5", "half")).contains("no STL file"));
        assert!(told(&TEXT.replace("endloop", "")).contains("no STL file"));
    }

    /// What is written of a world with two meshes is read to the same triangles.
    #[test]
    fn triangles_come_back() {
        let mut world = OwnedWorld::new(bitgrain_kernel::Domain::open(), 1e-4);
        let turned = |k: u32| {
            let turn = f64::from(k) * 0.7;
            [
                [0.0, 0.0, turn],
                [turn.cos(), 0.0, 1.0],
                [0.0, turn.sin(), 0.3 * turn],
            ]
        };
        for range in [0..40, 40..55] {
            let triangles: Vec<_> = range.map(turned).collect();
            let body = add_mesh(&mut world, [0.0; 3], &triangles);
            world.obstacles.push(body);
        }
        let again = restored(&corners(&world.facets), &world.obstacles);
        assert_eq!(again, *world.facets);
    }
}
