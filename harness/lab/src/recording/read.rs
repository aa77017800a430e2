//! A recording, read: every line is checked, and kept arrays against their digests.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use bitgrain_kernel::record::{Chain, HEAD};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::text_of;
use bitgrain_sim::simulation::hex;
use safetensors::SafeTensors;

use super::array::{Array, Element, dtype, read_element, read_shape};
use crate::folder::has_run;

/// The file with the lines, in the folder of a recording.
pub const FILE: &str = "recording.csv";

/// The folder with the arrays that were kept, beside that file.
pub const ARRAYS: &str = "arrays";

/// The file of the arrays of a step, in [`ARRAYS`].
pub fn arrays_file(step: u64) -> String {
    format!("{step:012}.safetensors")
}

/// What a line says of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// The array's name.
    pub name: String,
    /// What its elements are.
    pub element: Element,
    /// Lengths of its axes.
    pub shape: Vec<usize>,
    /// BLAKE3 of its bytes.
    pub digest: [u8; 32],
}

/// A step of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// Its number.
    pub step: u64,
    /// Its arrays, in the order in which they were recorded; each has a name of its own.
    pub arrays: Vec<Item>,
}

/// The lines of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// The steps, ascending.
    pub steps: Vec<Step>,
    /// The last link, in hex; zeros if there is none.
    pub link: String,
    /// Whether it has its end. If not, the program that wrote it was stopped, or whole lines are missing at its end;
    /// the last step may then lack arrays.
    pub closed: bool,
}

impl Recording {
    /// Reads the text of a recording and checks every line; `name` is what errors call it.
    ///
    /// # Errors
    /// [`Error::Input`] with the line that was changed or is cut off.
    pub fn parse(text: &str, name: &str) -> Result<Self> {
        let broken = |line: usize, what: &str| Error::input(format!("{name}:{line}"), what);
        if !text.starts_with(HEAD) {
            let same = HEAD.lines().zip(text.lines()).take_while(|(a, b)| a == b);
            let problem = "is not how a recording begins: `# bitgrain recording 1`, then the names of its columns";
            return Err(broken(1 + same.count().min(1), problem));
        }
        let mut chain = Chain::new();
        // Of the last step.
        let mut names = BTreeSet::new();
        let mut recording = Self {
            steps: Vec::new(),
            link: String::new(),
            closed: false,
        };
        for (k, line) in text.split_inclusive('\n').enumerate().skip(2) {
            let at = |what: &str| broken(k + 1, what);
            if !line.ends_with('\n') {
                return Err(at(
                    "is cut off: the file was cut, or its program stopped while it wrote; without this line \
                     the lines before it can be read",
                ));
            }
            if recording.closed {
                return Err(at(
                    "follows the end: the file was changed after it was written",
                ));
            }
            if line.starts_with('#') {
                recording.closed = line == chain.end().text();
                if !recording.closed {
                    return Err(at(
                        "is not the end that follows the line before: lines are missing or were changed",
                    ));
                }
                continue;
            }
            let (step, item) = row(line.trim_end_matches('\n')).map_err(|what| at(&what))?;
            let again = chain.add_digest(step, &item.name, item.element, &item.shape, &item.digest);
            let again = again.map_err(|refusal| at(&refusal.to_string()))?;
            if again.text() != line {
                return Err(at(
                    "does not follow from the line before: the file was changed after it was written, or its links \
                     were not computed as the guide says (File formats)",
                ));
            }
            if recording.steps.last().is_none_or(|last| last.step != step) {
                let arrays = Vec::new();
                recording.steps.push(Step { step, arrays });
                names.clear();
            }
            if !names.insert(item.name.clone()) {
                let problem = format!("names `{}` a second time at step {step}", item.name);
                return Err(at(&problem));
            }
            if let Some(last) = recording.steps.last_mut() {
                last.arrays.push(item);
            }
        }
        recording.link = hex(chain.link());
        Ok(recording)
    }

    /// How many lines of arrays it has.
    pub fn lines(&self) -> usize {
        self.steps.iter().map(|step| step.arrays.len()).sum()
    }
}

/// The columns of a line but for the link.
fn row(line: &str) -> std::result::Result<(u64, Item), String> {
    let words: Vec<&str> = line.split(',').collect();
    let [step, name, element, shape, digest, _] = words[..] else {
        return Err(format!("has {} columns, not 6", words.len()));
    };
    let step = step.parse().map_err(|_| format!("`{step}` is no step"))?;
    let element = read_element(element)?;
    let (shape, _) = read_shape(element, shape)?;
    let wrong = |_| format!("`{digest}` is no digest: 64 digits of a hexadecimal number");
    let digest = *blake3::Hash::from_hex(digest).map_err(wrong)?.as_bytes();
    let name = name.to_string();
    Ok((
        step,
        Item {
            name,
            element,
            shape,
            digest,
        },
    ))
}

/// A recording and where it lies.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// Its lines.
    pub recording: Recording,
    /// The path that it was opened by.
    pub place: PathBuf,
}

/// Whether a path is that of a recording: a file, or a folder with one in it that is none of a run or campaign.
///
/// # Errors
/// [`Error::Input`] if the folder is one of a run or campaign and has a recording too.
pub fn is_recording(path: &Path) -> Result<bool> {
    let file = path.join(FILE);
    if !disk::is_folder(path) || !disk::is_there(&file) {
        return Ok(disk::is_file(path));
    }
    if !has_run(path) {
        return Ok(true);
    }
    let problem = format!(
        "holds both a run and a recording: name {} to compare the recording, or move that away to compare the run",
        file.display()
    );
    Err(Error::input(path.display().to_string(), problem))
}

impl Recorded {
    /// Opens the folder of a recording, or the file with its lines alone.
    ///
    /// # Errors
    /// [`Error::Input`] as [`Recording::parse`], and for what is not there.
    pub fn open(path: &Path) -> Result<Self> {
        let file = match disk::is_folder(path) {
            true => path.join(FILE),
            false => path.to_path_buf(),
        };
        let name = file.display().to_string();
        if disk::is_folder(path) && !disk::is_there(&file) {
            let problem = format!("is not the folder of a recording: it holds no {FILE}");
            return Err(Error::input(path.display().to_string(), problem));
        }
        let text = text_of(disk::read(&file)?, &name)?;
        Ok(Self {
            recording: Recording::parse(&text, &name)?,
            place: path.to_path_buf(),
        })
    }

    /// The file in which the arrays of a step are, if they were kept.
    fn kept(&self, step: u64) -> PathBuf {
        self.place.join(ARRAYS).join(arrays_file(step))
    }

    /// The arrays of a step as they were kept; `None` if they were not.
    ///
    /// # Errors
    /// [`Error::Input`] if an array is not the one that was recorded.
    pub fn arrays(&self, step: &Step) -> Result<Option<Vec<Array>>> {
        let path = self.kept(step.step);
        let Some(bytes) = disk::read_if_there(&path)? else {
            return Ok(None);
        };
        let place = path.display().to_string();
        let wrong = |problem: String| Error::input(&place, problem);
        let file = SafeTensors::deserialize(&bytes);
        let file =
            file.map_err(|e| wrong(format!("is no safetensors file, or not a whole one: {e}")))?;
        let mut arrays = Vec::new();
        for item in &step.arrays {
            let found = file.tensor(&item.name);
            let found =
                found.map_err(|_| wrong(format!("lacks the array `{}` of its step", item.name)))?;
            let bytes = found.data();
            let kind = (found.dtype(), found.shape());
            let same = kind == (dtype(item.element), &item.shape[..]);
            if !same || *blake3::hash(bytes).as_bytes() != item.digest {
                return Err(wrong(format!(
                    "holds another array `{}` than the one recorded: the file was changed after it was written, or \
                     belongs to another recording",
                    item.name
                )));
            }
            arrays.push(Array {
                name: item.name.clone(),
                element: item.element,
                shape: item.shape.clone(),
                bytes: bytes.to_vec(),
            });
        }
        Ok(Some(arrays))
    }
}
