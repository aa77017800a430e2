//! Arrays that users give, as vectors of rows; and small arrays that they get.

use numpy::{PyArray1, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::input;

/// Anything that numpy takes for numbers, as an array of f64.
fn array<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let py = value.py();
    let numpy = py.import("numpy")?;
    let made = numpy.call_method1("ascontiguousarray", (value, "float64"));
    let made = made.map_err(|wrong| {
        // Errors of ours, as of a view that is stale, say what to do.
        let own = |py: Python<'py>| py.import("bitgrain.errors")?.getattr("Error");
        match own(py).is_ok_and(|error| wrong.matches(py, error).unwrap_or(false)) {
            true => wrong,
            false => input(name, format!("is not an array of numbers: {wrong}")),
        }
    })?;
    made.extract()
}

fn shape(shape: &[usize]) -> String {
    let inner: Vec<String> = shape.iter().map(usize::to_string).collect();
    match inner.len() {
        1 => format!("({},)", inner[0]),
        _ => format!("({})", inner.join(", ")),
    }
}

fn refuse<T>(name: &str, found: &[usize], expected: &str) -> PyResult<T> {
    let problem = format!("has the shape {}; expected {expected}", shape(found));
    Err(input(name, problem))
}

fn finite(name: &str, numbers: &[f64], width: usize) -> PyResult<()> {
    match numbers.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(k) => {
            let problem = format!(
                "holds {} in row {}; expected finite numbers",
                numbers[k],
                k / width
            );
            Err(input(name, problem))
        }
    }
}

/// The numbers of an array, contiguous, finite.
fn numbers(array: &PyReadonlyArrayDyn<'_, f64>, name: &str, width: usize) -> PyResult<Vec<f64>> {
    let numbers = array.as_slice()?.to_vec();
    finite(name, &numbers, width)?;
    Ok(numbers)
}

/// Rows of so many numbers; `count` rows, if there must be so many.
///
/// # Errors
/// `InputError` for another shape or a number that is not finite.
pub fn rows<const WIDTH: usize>(
    value: &Bound<'_, PyAny>,
    name: &str,
    count: Option<usize>,
) -> PyResult<Vec<[f64; WIDTH]>> {
    let array = array(value, name)?;
    let found = array.shape().to_vec();
    if found.len() != 2 || found[1] != WIDTH || count.is_some_and(|count| count != found[0]) {
        let rows = count.map_or("n".to_string(), |count| count.to_string());
        return refuse(name, &found, &format!("({rows}, {WIDTH})"));
    }
    let numbers = numbers(&array, name, WIDTH)?;
    Ok(numbers.as_chunks().0.to_vec())
}

/// Triples of corners.
///
/// # Errors
/// `InputError` for another shape or a number that is not finite.
pub fn triangles(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[[f64; 3]; 3]>> {
    let array = array(value, name)?;
    let found = array.shape().to_vec();
    if found.len() != 3 || found[1..] != [3, 3] {
        return refuse(name, &found, "(n, 3, 3)");
    }
    let numbers = numbers(&array, name, 9)?;
    let corners = numbers.as_chunks::<3>().0;
    Ok(corners.as_chunks().0.to_vec())
}

/// One number for each of `count`: an array, or a number for all.
///
/// # Errors
/// `InputError` for another shape or a number that is not finite.
pub fn column(value: &Bound<'_, PyAny>, name: &str, count: usize) -> PyResult<Vec<f64>> {
    let array = array(value, name)?;
    let found = array.shape().to_vec();
    // `ascontiguousarray` makes a number an array of one.
    let single = found.is_empty() || found == [1] && !value.hasattr("__len__")?;
    if !single && found != [count] {
        return refuse(name, &found, &format!("({count},), or a number"));
    }
    let numbers = numbers(&array, name, 1)?;
    match single {
        true => Ok(vec![numbers[0]; count]),
        false => Ok(numbers),
    }
}

/// Three numbers.
///
/// # Errors
/// `InputError` for another shape or a number that is not finite.
pub fn vector(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    let array = array(value, name)?;
    let found = array.shape().to_vec();
    if found != [3] {
        return refuse(name, &found, "(3,)");
    }
    let numbers = numbers(&array, name, 3)?;
    Ok([numbers[0], numbers[1], numbers[2]])
}

const MASK: &str = "holds True and False; expected ids: those that a mask picks are w.ids[mask]";

/// Ids of grains: a whole number, or an array of them.
///
/// # Errors
/// `InputError` for what is no id.
pub fn ids(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<u32>> {
    let numpy = value.py().import("numpy")?;
    let kind = numpy.call_method1("asarray", (value,))?.getattr("dtype")?;
    if kind.getattr("kind")?.extract::<String>()? == "b" {
        return Err(input(name, MASK));
    }
    let array = array(value, name)?;
    let found = array.shape().to_vec();
    if found.len() > 1 {
        return refuse(name, &found, "(n,), or a number");
    }
    let numbers = numbers(&array, name, 1)?;
    let whole = |x: &f64| *x >= 0.0 && *x <= f64::from(u32::MAX) && x.fract() == 0.0;
    match numbers.iter().find(|x| !whole(x)) {
        Some(x) => Err(input(
            name,
            format!("holds {x}; expected ids, whole numbers below 2^32"),
        )),
        None => Ok(numbers.iter().map(|x| *x as u32).collect()),
    }
}

/// Three numbers as an array that cannot be written to: writing to it would move nothing.
pub fn fixed<'py>(py: Python<'py>, value: [f64; 3]) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let array = PyArray1::from_slice(py, &value);
    array.call_method1("setflags", (false,))?;
    Ok(array)
}
