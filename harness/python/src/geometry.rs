//! Boxes, directions and triangles as Python gives them.

use bitgrain::mesh::{Triangle, check_triangles, read_stl};
use bitgrain_kernel::Domain;
use pyo3::prelude::*;

use crate::arrays::{rows, triangles, vector};
use crate::errors::{input, kernel};

/// The triangles in an array or a file.
pub fn corners(given: &Bound<'_, PyAny>) -> PyResult<Vec<Triangle>> {
    let wrong = |problem: String| input("triangles", problem);
    if let Ok(path) = given.extract::<std::path::PathBuf>() {
        return read_stl(&path).map_err(|problem| wrong(problem.to_string()));
    }
    let corners = triangles(given, "triangles")?;
    check_triangles(&corners).map_err(wrong)?;
    Ok(corners)
}

/// A vector; zero if none is given.
///
/// # Errors
/// `InputError` if it is none.
pub fn or_zero(value: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<[f64; 3]> {
    value.map_or(Ok([0.0; 3]), |value| vector(value, name))
}

/// A vector of any length but zero.
pub fn direction(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    let direction = vector(value, name)?;
    match direction == [0.0; 3] {
        true => Err(input(name, "is zero; expected a direction")),
        false => Ok(direction),
    }
}

/// The box that a world is given.
pub fn domain(given: Option<&Bound<'_, PyAny>>, periodic: [bool; 3]) -> PyResult<Domain<f64>> {
    let Some(given) = given else {
        return match periodic.contains(&true) {
            true => Err(input("periodic", "asks for a period, but there is no box")),
            false => Ok(Domain::open()),
        };
    };
    let [lo, hi] = match vector(given, "box") {
        Ok(lengths) => [[0.0; 3], lengths],
        Err(_) => match rows(given, "box", Some(2)) {
            Ok(corners) => [corners[0], corners[1]],
            Err(_) => {
                let problem = format!(
                    "is {}; expected three lengths or two corners",
                    given.repr()?
                );
                return Err(input("box", problem));
            }
        },
    };
    Domain::new(lo, hi, periodic).map_err(kernel)
}
