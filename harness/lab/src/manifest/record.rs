//! What a manifest says, and how a folder departs from it.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use bitgrain_kernel::BITS_VERSION;
use serde::{Deserialize, Serialize};

use bitgrain_sim::checkpoint;
use bitgrain_sim::disk::{self, Kind};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::simulation::hex;

/// Name of the file.
pub const NAME: &str = "manifest.json";

/// The file that says why a drag of a campaign failed, in the drag's folder, or its bed, in the run directory.
pub(crate) const FAILURE: &str = "failure.json";

/// Folders of results: every file in them is taken for one.
pub(crate) const RESULTS: [&str; 3] = ["beds", "runs", "members"];

/// Version of its layout.
pub const FORMAT: u32 = 1;

/// Whether a file of this name begins or is marked as those that are written here.
pub(crate) fn is_marked(name: &str, bytes: &[u8]) -> bool {
    let begin: &[u8] = match name.rsplit('.').next() {
        Some("dump") => b"ITEM: ",
        Some("gz") => &[0x1f, 0x8b],
        Some("parquet") => b"PAR1",
        Some("safetensors") => return checkpoint::begins(bytes),
        Some("json") if !name.ends_with(FAILURE) => {
            return disk::bears(bytes, "\"bits_version\":");
        }
        Some("json") => b"{\n  \"reason\": ",
        _ => return disk::bears(bytes, "BITS_VERSION"),
    };
    bytes.is_empty() || bytes.starts_with(begin)
}

/// What a manifest belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FolderKind {
    /// A run.
    Run,
    /// A campaign.
    Campaign,
}

impl FolderKind {
    /// What is told of a file that has the name of a result and no entry.
    pub(crate) fn foreign(self, path: &Path) -> Error {
        let problem = format!(
            "has the name of a file of the {}, and {NAME} has no entry of it: it is not replaced; move it away, or \
             choose another folder",
            self.word()
        );
        Error::input(path.display().to_string(), problem)
    }

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            FolderKind::Run => "run",
            FolderKind::Campaign => "campaign",
        }
    }

    /// The file that says what a folder of this kind is for; its first line names the arithmetic.
    pub(crate) fn marker(self) -> &'static str {
        match self {
            FolderKind::Run => "scenario.toml",
            FolderKind::Campaign => "campaign.toml",
        }
    }

    /// The folders in it that have its results, and nothing else.
    pub(crate) fn places(self) -> [&'static str; 2] {
        match self {
            FolderKind::Run => ["beds", "runs"],
            FolderKind::Campaign => ["members", "tasks"],
        }
    }
}

/// A bed or a drag of a run, or a member of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageRecord {
    /// Its name.
    pub name: String,
    /// Whether it is finished.
    pub finished: bool,
    /// The last link of its chain of digests, of a member its closing hash; empty before its end.
    pub link: String,
}

/// A file of results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileRecord {
    /// Its path from the folder on, with `/`.
    pub path: String,
    /// Its length.
    pub bytes: u64,
    /// BLAKE3 of its bytes, in hex.
    pub blake3: String,
}

/// What `manifest.json` holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of the layout.
    pub format: u32,
    /// Version of the kernel's arithmetic.
    pub bits_version: u32,
    /// What it belongs to.
    pub of: FolderKind,
    /// Whether all of it is finished.
    pub finished: bool,
    /// Its stages, in the order in which they are run.
    pub stages: Vec<StageRecord>,
    /// Its files, by path.
    pub files: Vec<FileRecord>,
    /// BLAKE3 over this text with an empty closing hash, in hex.
    pub closing: String,
}

/// How a file departs from its entry.
#[derive(Debug)]
pub enum Departure {
    /// It is missing, of another kind, or holds other bytes: in words.
    Changed(String),
    /// It may be unchanged: the system cannot read it, or it is larger than what is read.
    Unreadable(Error),
}

impl FileRecord {
    /// The entry of a file with these bytes.
    pub fn of(path: &str, bytes: &[u8]) -> Self {
        Self {
            path: path.to_string(),
            bytes: bytes.len() as u64,
            blake3: hex(blake3::hash(bytes).as_bytes()),
        }
    }

    /// The entry of a file that was written here, nobody knows with what bytes: the manifest that had it is lost.
    pub(super) fn lost(path: &str) -> Self {
        Self {
            path: path.to_string(),
            bytes: 0,
            blake3: String::new(),
        }
    }

    /// Whether it is known to have been written with other bytes than those of this entry.
    pub(super) fn was_another(&self, entry: &Self) -> bool {
        self != entry && !self.blake3.is_empty()
    }

    /// Whether these are the bytes of the file.
    pub fn is_of(&self, bytes: &[u8]) -> bool {
        *self == Self::of(&self.path, bytes)
    }

    /// Whether the file lies in a folder as it was written, or at least bears the mark of one that is written here.
    pub(crate) fn is_ours(&self, root: &Path) -> bool {
        let read = || disk::read(&root.join(&self.path));
        self.read(root).is_ok() || read().is_ok_and(|bytes| is_marked(&self.path, &bytes))
    }

    /// The bytes of the file in a folder, or what is wrong with it.
    pub fn read(&self, root: &Path) -> std::result::Result<Vec<u8>, Departure> {
        let changed = |how: String| Err(Departure::Changed(how));
        let mut at = root.to_path_buf();
        let mut words = self.path.split('/').peekable();
        while let Some(word) = words.next() {
            at.push(word);
            let last = words.peek().is_none();
            match (disk::kind(&at), last) {
                (None, _) => return changed("is missing".into()),
                (Some(Kind::File), true) | (Some(Kind::Folder), false) => {}
                (Some(other), true) => {
                    return changed(format!(
                        "is {}, not the file that was written",
                        other.word()
                    ));
                }
                (Some(other), false) => {
                    return changed(format!(
                        "is not there: {} is {}",
                        at.display(),
                        other.word()
                    ));
                }
            }
        }
        if disk::size(&at) != self.bytes {
            let size = disk::size(&at);
            return changed(format!("has {size} bytes instead of {}", self.bytes));
        }
        let bytes = disk::read(&at).map_err(Departure::Unreadable)?;
        match self.is_of(&bytes) {
            true => Ok(bytes),
            false => changed("was changed after it was written".into()),
        }
    }
}

impl Manifest {
    /// One without files, of which nothing is finished.
    pub fn new(of: FolderKind, stages: &[String]) -> Self {
        let stage = |name: &String| StageRecord {
            name: name.clone(),
            finished: false,
            link: String::new(),
        };
        Self {
            format: FORMAT,
            bits_version: BITS_VERSION,
            of,
            finished: false,
            stages: stages.iter().map(stage).collect(),
            files: Vec::new(),
            closing: String::new(),
        }
    }

    /// The text with its closing hash as it is.
    fn raw(&self) -> String {
        let mut text =
            serde_json::to_string_pretty(self).expect("words and whole numbers are JSON");
        text.push('\n');
        text
    }

    /// The closing hash that belongs to the rest.
    pub(super) fn closed(&self) -> String {
        let open = Self {
            closing: String::new(),
            ..self.clone()
        };
        hex(blake3::hash(open.raw().as_bytes()).as_bytes())
    }

    /// The text of the file, with its closing hash.
    pub fn text(&self) -> String {
        let whole = Self {
            closing: self.closed(),
            ..self.clone()
        };
        whole.raw()
    }

    /// Reads the text of a manifest.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        #[derive(Deserialize)]
        struct Made {
            format: u32,
            bits_version: u32,
        }
        let made: Made = serde_json::from_str(text).map_err(|e| e.to_string())?;
        if (made.format, made.bits_version) != (FORMAT, BITS_VERSION) {
            return Err(format!(
                "has format {} and arithmetic {}, and this program has {FORMAT} and {BITS_VERSION}",
                made.format, made.bits_version
            ));
        }
        let read: Self = serde_json::from_str(text).map_err(|e| e.to_string())?;
        if read.raw() != text || read.closed() != read.closing {
            return Err("its closing hash does not fit its content".into());
        }
        if !read.files.is_sorted_by(|a, b| a.path < b.path) {
            return Err("its files are not in order".into());
        }
        if let Some(entry) = read.files.iter().find(|entry| !is_below(&entry.path)) {
            return Err(format!("`{}` does not lie in its folder", entry.path));
        }
        Ok(read)
    }

    /// The manifest of a folder; `None` if it has none.
    ///
    /// # Errors
    /// [`Error::Manifest`] if it is not whole, [`Error::Input`] if it cannot be read.
    pub fn of(root: &Path) -> Result<Option<Self>> {
        let path = root.join(NAME);
        let place = path.display().to_string();
        let damaged = |problem: String| Error::Manifest {
            place: place.clone(),
            problem,
        };
        match disk::kind(&path) {
            None => return Ok(None),
            Some(Kind::File) => {}
            Some(other) => return Err(damaged(format!("is {}", other.word()))),
        }
        let bytes = disk::read(&path)?;
        let text = std::str::from_utf8(&bytes).map_err(|e| damaged(e.to_string()))?;
        Self::parse(text).map(Some).map_err(damaged)
    }

    /// The entry of a file.
    pub fn entry(&self, path: &str) -> Option<&FileRecord> {
        let place = self
            .files
            .binary_search_by(|entry| entry.path.as_str().cmp(path));
        place.ok().map(|k| &self.files[k])
    }

    /// Whether a stage of this name is finished.
    pub fn has_finished(&self, name: &str) -> bool {
        self.link(name).is_some()
    }

    /// The last link of a stage of this name, if it is finished.
    pub fn link(&self, name: &str) -> Option<&str> {
        let mut stages = self.stages.iter().filter(|stage| stage.finished);
        let stage = stages.find(|stage| stage.name == name)?;
        Some(&stage.link)
    }

    /// Whether this is the closing hash or the last link of a stage.
    pub fn has_link(&self, link: &str) -> bool {
        let mut stages = self.stages.iter().filter(|stage| stage.finished);
        self.finished && self.closing == link || stages.any(|stage| stage.link == link)
    }

    pub(super) fn entries(self) -> BTreeMap<String, FileRecord> {
        let each = self.files.into_iter();
        each.map(|entry| (entry.path.clone(), entry)).collect()
    }
}

/// Whether a path stays below its folder.
fn is_below(path: &str) -> bool {
    let plain = |c: Component<'_>| matches!(c, Component::Normal(_));
    !path.is_empty() && !path.contains(['\\', '\0']) && {
        let words = path.split('/');
        words.clone().all(|word| !word.is_empty() && word != ".")
            && Path::new(path).components().all(plain)
    }
}

/// The path of a file from its folder on, with `/`; `None` of one that does not lie below it.
pub fn relative(root: &Path, path: &Path) -> Option<String> {
    let below = path.strip_prefix(root).ok()?;
    let words: Option<Vec<&str>> = below.components().map(|c| c.as_os_str().to_str()).collect();
    words.map(|words| words.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Manifest {
        let mut manifest = Manifest::new(FolderKind::Run, &["bed".into(), "run-1".into()]);
        manifest.files = vec![
            FileRecord::of("a", b"1"),
            FileRecord::of("runs/run-1/forces.csv", b"2"),
        ];
        manifest.stages[0].finished = true;
        manifest.stages[0].link = "ab".into();
        manifest
    }

    #[test]
    fn a_manifest_reads_back_and_no_bit_of_it_can_be_changed() {
        let text = sample().text();
        let read = Manifest::parse(&text).unwrap();
        assert_eq!(read.text(), text);
        assert!(read.has_link("ab") && !read.has_link("") && !read.has_link(&read.closing));
        for at in 0..text.len() {
            for bit in 0..8 {
                let mut bytes = text.clone().into_bytes();
                bytes[at] ^= 1 << bit;
                if let Ok(flipped) = String::from_utf8(bytes) {
                    assert!(Manifest::parse(&flipped).is_err(), "byte {at}, bit {bit}");
                }
            }
        }
        assert!(Manifest::parse(&(text.clone() + "\n")).is_err());
        assert!(Manifest::parse(&text[..text.len() - 2]).is_err());
    }

    #[test]
    fn paths_stay_below_their_folder() {
        for path in ["../a", "/a", "a/../b", "a//b", "", "./a", "a/", "a\\b"] {
            let mut manifest = sample();
            manifest.files = vec![FileRecord::of(path, b"1")];
            assert!(Manifest::parse(&manifest.text()).is_err(), "{path}");
        }
        let mut twice = sample();
        twice.files[1].path = "a".into();
        assert!(Manifest::parse(&twice.text()).is_err());
    }
}
