//! Recordings of any arrays, and where two of them part.

use std::path::{Path, PathBuf};

use bitgrain::error::{Error, Result};
use bitgrain::recording::array::{Element, read_element};
use bitgrain::recording::difference::Difference;
use bitgrain::recording::parting::Parting;
use bitgrain::recording::read::Recorded;
use bitgrain::recording::{ArrayRef, Keep, Recorder, part, read};
use parking_lot::Mutex;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use serde_json::{Value, json};

use crate::errors::{input, laboratory};

/// An array as Python hands it over: its name, type of elements, shape, and bytes that nobody can change.
type Given = (String, String, Vec<usize>, PyBackedBytes);

/// A recording in progress; what a `Recorder` writes with. It is gone once it has its end.
#[pyclass(frozen, module = "bitgrain._native")]
pub struct Writer(Mutex<Option<Recorder>>);

#[pymethods]
impl Writer {
    /// Begins a recording in a folder.
    ///
    /// Raises
    /// ------
    /// InputError, WriteFailed
    #[new]
    fn new(py: Python<'_>, folder: PathBuf, keep: &str) -> PyResult<Self> {
        let keep: Keep = keep
            .parse()
            .map_err(|problem: String| input("keep", problem))?;
        let made = py.detach(|| Recorder::create(&folder, keep));
        let made = made.map_err(|error| laboratory(&error))?;
        Ok(Self(Mutex::new(Some(made))))
    }

    /// Records the arrays of a step: name, type of elements, shape and bytes of each.
    ///
    /// Raises
    /// ------
    /// InputError, WriteFailed
    fn record(&self, py: Python<'_>, step: u64, arrays: Vec<Given>) -> PyResult<()> {
        self.act(py, |recorder| {
            let lent = arrays.iter().map(|(name, element, shape, bytes)| {
                let element = element_of(name, element)?;
                Ok((
                    &name[..],
                    ArrayRef {
                        element,
                        shape,
                        bytes,
                    },
                ))
            });
            let recorder = recorder.as_mut().ok_or_else(ended)?;
            recorder.record(step, &lent.collect::<Result<Vec<_>>>()?)
        })
    }

    /// Writes the end and returns the last link.
    ///
    /// Raises
    /// ------
    /// InputError, WriteFailed
    fn close(&self, py: Python<'_>) -> PyResult<String> {
        self.act(py, |recorder| recorder.take().ok_or_else(ended)?.close())
    }

    /// Leaves the recording without an end.
    fn abandon(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, |recorder| {
            recorder.take();
            Ok(())
        })
    }
}

impl Writer {
    /// Acts without the interpreter's lock. Another thread that records at the same time waits, and holds no lock of
    /// the interpreter meanwhile.
    fn act<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut Option<Recorder>) -> Result<T> + Send,
    ) -> PyResult<T> {
        let done = py.detach(|| act(&mut self.0.lock()));
        done.map_err(|error| laboratory(&error))
    }
}

fn ended() -> Error {
    Error::input("recorder", "is closed: open another one in another folder")
}

fn element_of(name: &str, element: &str) -> Result<Element> {
    read_element(element).map_err(|problem| Error::input(format!("array `{name}`"), problem))
}

/// Whether a path is taken for that of a recording.
///
/// Raises
/// ------
/// InputError
///     It is the folder of a run or campaign and has a recording too.
#[pyfunction]
pub fn is_recording(path: PathBuf) -> PyResult<bool> {
    read::is_recording(&path).map_err(|error| laboratory(&error))
}

/// Finds where two recordings part; returns what is found as JSON, and what there is to know beside that.
#[pyfunction]
pub fn part_recordings(
    py: Python<'_>,
    first: PathBuf,
    second: PathBuf,
    prefix: bool,
) -> PyResult<(Option<String>, Vec<String>)> {
    let mut lines = Vec::new();
    let told = &mut lines;
    let found = py.detach(|| {
        let open = |path: &Path| Recorded::open(path);
        part(&[open(&first)?, open(&second)?], prefix, |line| {
            told.push(line.to_string());
            Ok(())
        })
    });
    let found = found.map_err(|error| laboratory(&error))?;
    Ok((found.map(|parting| shown(&parting).to_string()), lines))
}

fn shown(parting: &Parting) -> Value {
    let mut value = json!({
        "equal": parting.equal,
        "step": parting.step,
        "arrays": parting.arrays,
        "hint": parting.hint,
        "text": parting.to_string(),
    });
    match &parting.difference {
        None => {}
        Some(Difference::Missing { first_has }) => {
            value["missing"] = json!({ "first_has": first_has })
        }
        Some(Difference::Kind { first, second }) => value["kinds"] = json!([first, second]),
        Some(Difference::Elements(elements)) => {
            value["element"] = json!({
                "type": elements.element.name(),
                "index": elements.index,
                "bits": [elements.first, elements.second],
                "ulp": elements.ulps(),
                "differing": elements.differing,
                "count": elements.count,
            });
        }
    }
    value
}
