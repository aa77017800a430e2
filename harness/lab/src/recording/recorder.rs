//! Writes a recording while a program runs.

use std::collections::{BTreeSet, VecDeque};
use std::path::{Path, PathBuf};

use bitgrain_kernel::record::{Chain, HEAD, check};
use bitgrain_sim::below::Below;
use bitgrain_sim::disk::{self, Appended};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::simulation::hex;
use safetensors::tensor::{TensorView, serialize};

use super::array::{ArrayRef, dtype};
use super::keep::Keep;
use super::read::{ARRAYS, FILE, arrays_file};
use crate::folder::{has_run, refuse_among_results};

/// A recording in progress. If it is dropped without [`Recorder::close`] the recording has no end, and says so when it
/// is read.
///
/// ```
/// use bitgrain_lab::recording::array::{Element, little_endian};
/// use bitgrain_lab::recording::{ArrayRef, Keep, Recorder, read::Recorded};
///
/// let folder = tempfile::tempdir().unwrap();
/// let place = folder.path().join("fall");
/// let mut recorder = Recorder::create(&place, Keep::All).unwrap();
/// let mut height = 1.0;
/// for step in 0..10 {
///     let bytes = little_endian(&[height, 0.0]);
///     let heights = ArrayRef { element: Element::F64, shape: &[2], bytes: &bytes };
///     recorder.record(step, &[("heights", heights)]).unwrap();
///     height -= 0.01 * step as f64;
/// }
/// let link = recorder.close().unwrap();
/// assert_eq!(Recorded::open(&place).unwrap().recording.link, link);
/// ```
pub struct Recorder {
    folder: PathBuf,
    file: Appended,
    chain: Chain,
    last: Option<u64>,
    keep: Keep,
    /// Files of arrays, the oldest first, if old ones are to be removed.
    ring: VecDeque<PathBuf>,
}

impl Recorder {
    /// Begins a recording in a folder, which is made if it is missing.
    ///
    /// # Errors
    /// [`Error::Input`] if the folder has a recording already, is one of a run or campaign or lies among its results,
    /// or `keep` keeps nothing where it should; [`Error::Write`].
    pub fn create(folder: &Path, keep: Keep) -> Result<Self> {
        let path = folder.join(FILE);
        if disk::is_there(&path) || disk::is_there(&folder.join(ARRAYS)) {
            let problem = "has a recording already: choose another folder, or remove this one";
            return Err(Error::input(folder.display().to_string(), problem));
        }
        refuse_among_results(folder)?;
        if has_run(folder) {
            let problem =
                "is the folder of a run or campaign: choose another folder for the recording";
            return Err(Error::input(folder.display().to_string(), problem));
        }
        if let Keep::Every(0) | Keep::Last(0) = keep {
            let problem =
                format!("`{keep}` does not say which arrays to keep: the number is at least 1");
            return Err(Error::input("keep", problem));
        }
        disk::make_folder(folder)?;
        let mut file = Appended::create(&path, disk::most())?;
        if let Err(e) = file.append(HEAD.as_bytes()) {
            // What is no recording must not be taken for one.
            Below(folder).remove(&path)?;
            return Err(e);
        }
        Ok(Self {
            folder: folder.to_path_buf(),
            file,
            chain: Chain::new(),
            last: None,
            keep,
            ring: VecDeque::new(),
        })
    }

    /// Records the arrays of a step. Steps ascend; each array of a step has a name of its own. All is recorded or, if
    /// something is refused or cannot be written, nothing of this step.
    ///
    /// # Errors
    /// [`Error::Input`] for a step that does not ascend, no array, a wrong name or shape; [`Error::Write`].
    pub fn record(&mut self, step: u64, arrays: &[(&str, ArrayRef<'_>)]) -> Result<()> {
        let place = || self.folder.display().to_string();
        let refused = |problem: String| Error::input(place(), problem);
        if let Some(last) = self.last.filter(|last| *last >= step) {
            return Err(refused(format!(
                "step {step} does not come after step {last}: steps ascend"
            )));
        }
        if arrays.is_empty() {
            return Err(refused(format!("step {step} has no array")));
        }
        let mut chain = self.chain;
        let mut lines = String::new();
        let mut names = BTreeSet::new();
        for (name, array) in arrays {
            if !names.insert(*name) {
                return Err(refused(format!(
                    "step {step} has two arrays of the name `{name}`"
                )));
            }
            let refused = |what: String| refused(format!("array `{name}` of step {step}: {what}"));
            check(array.element, array.shape, array.bytes)
                .map_err(|what| refused(what.to_string()))?;
            let digest = blake3::hash(array.bytes);
            let line = chain.add_digest(step, name, array.element, array.shape, digest.as_bytes());
            lines.push_str(line.map_err(|what| refused(what.to_string()))?.text());
        }
        // Arrays before their lines: what no line speaks of is not read.
        if self.keep.wants(step) {
            self.keep_arrays(step, arrays)?;
        }
        self.file.append(lines.as_bytes())?;
        (self.chain, self.last) = (chain, Some(step));
        Ok(())
    }

    fn keep_arrays(&mut self, step: u64, arrays: &[(&str, ArrayRef<'_>)]) -> Result<()> {
        let path = self.folder.join(ARRAYS).join(arrays_file(step));
        let wrong = |e: safetensors::SafeTensorError| {
            Error::input(path.display().to_string(), e.to_string())
        };
        let mut views = Vec::new();
        for (name, array) in arrays {
            let view = TensorView::new(dtype(array.element), array.shape.to_vec(), array.bytes);
            views.push((*name, view.map_err(wrong)?));
        }
        let bytes = serialize(views, None).map_err(wrong)?;
        Below(&self.folder).write(&path, &bytes)?;
        if let Keep::Last(count) = self.keep {
            // Tried again after a failure it is there already.
            if self.ring.back() != Some(&path) {
                self.ring.push_back(path);
            }
            if self.ring.len() > count
                && let Some(oldest) = self.ring.front()
            {
                Below(&self.folder).remove(oldest)?;
                self.ring.pop_front();
            }
        }
        Ok(())
    }

    /// The last step that was recorded.
    pub fn last(&self) -> Option<u64> {
        self.last
    }

    /// Writes the end of the recording and makes it last; returns the last link in hex.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn close(mut self) -> Result<String> {
        self.file.append(self.chain.end().text().as_bytes())?;
        self.file.sync()?;
        Ok(hex(self.chain.link()))
    }
}
