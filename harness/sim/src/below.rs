//! What may be written and removed below a folder that a user named.

use std::io;
use std::path::{Component, Path};

use crate::disk::{
    Call, Kind, before, free_for, is_being_written, list, partial_of, remove_raw, write_whole,
};
use crate::error::{Error, Result};

/// A folder that a user named. Below it no link is followed, a file takes the place of a regular file or of nothing,
/// and only regular files and empty folders are removed: so nothing outside of it is touched, and nothing in it that
/// the program cannot have made.
///
/// Somebody who changes the folder between the look and the write is not found out.
#[derive(Clone, Copy, Debug)]
pub struct Below<'a>(pub &'a Path);

impl Below<'_> {
    /// Refuses a path that a file cannot be written to: what lies there is no regular file, or the way there leads
    /// through something that is no folder.
    ///
    /// # Errors
    /// [`Error::Input`].
    pub fn check_file(&self, path: &Path) -> Result<()> {
        self.check(path, Kind::File)
    }

    /// Refuses a path that a folder cannot have.
    ///
    /// # Errors
    /// [`Error::Input`].
    pub fn check_folder(&self, path: &Path) -> Result<()> {
        self.check(path, Kind::Folder)
    }

    fn check(&self, path: &Path, last: Kind) -> Result<()> {
        let outside = || {
            let problem = format!("does not lie below {}", self.0.display());
            Error::input(path.display().to_string(), problem)
        };
        let rest = path.strip_prefix(self.0).map_err(|_| outside())?;
        let mut at = self.0.to_path_buf();
        let mut words = rest.components().peekable();
        while let Some(word) = words.next() {
            let Component::Normal(word) = word else {
                return Err(outside());
            };
            at.push(word);
            let expected = match words.peek() {
                Some(_) => Kind::Folder,
                None => last,
            };
            free_for(&at, expected)?;
        }
        Ok(())
    }

    /// Writes a file as [`write_whole`] does.
    ///
    /// # Errors
    /// As [`Below::check_file`] and [`write_whole`].
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        self.check_file(path)?;
        write_whole(path, bytes)
    }

    /// Removes a file of ours; nothing happens if there is none.
    ///
    /// # Errors
    /// As [`Below::check_file`]; [`Error::Write`].
    pub fn remove(&self, path: &Path) -> Result<()> {
        self.check_file(path)?;
        match remove_raw(path) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(Error::write(path, e)),
            _ => Ok(()),
        }
    }

    /// Removes a folder that is empty. Says whether it is gone: one that holds something stays.
    ///
    /// # Errors
    /// As [`Below::check_folder`]; [`Error::Write`].
    pub fn remove_if_empty(&self, folder: &Path) -> Result<bool> {
        self.check_folder(folder)?;
        let tried = before(Call::RemoveFolder(folder)).and_then(|()| std::fs::remove_dir(folder));
        match tried.map_err(|e| (e.kind(), e)) {
            Ok(()) | Err((io::ErrorKind::NotFound, _)) => Ok(true),
            Err((io::ErrorKind::DirectoryNotEmpty, _)) => Ok(false),
            Err((_, e)) => Err(Error::write(folder, e)),
        }
    }

    /// Removes what killed processes of ours left half written in a folder itself. Whatever cannot be removed stays,
    /// and so does what is being written; where the file system cannot lock, nobody may write a name that is `wanted`.
    pub fn clear_partials(&self, folder: &Path, wanted: impl Fn(&str) -> bool) {
        if self.check_folder(folder).is_err() {
            return;
        }
        for (name, kind) in list(folder).unwrap_or_default() {
            let path = folder.join(&name);
            let left = kind == Kind::File && partial_of(&name).is_some_and(&wanted);
            if left && !is_being_written(&path) {
                let _ = remove_raw(&path);
            }
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// A folder with a link to another one, in which a file is.
    fn with_link() -> (tempfile::TempDir, PathBuf, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let [own, other] = ["own", "other"].map(|name| folder.path().join(name));
        std::fs::create_dir_all(&own).unwrap();
        std::fs::create_dir_all(other.join("empty")).unwrap();
        std::fs::write(other.join("file"), "mine").unwrap();
        std::os::unix::fs::symlink(&other, own.join("way")).unwrap();
        (folder, own, other)
    }

    #[test]
    fn nothing_is_written_or_removed_behind_a_link() {
        let (_folder, own, other) = with_link();
        let below = Below(&own);
        let half = "a.csv.12-0.bitgrain-partial";
        std::fs::write(other.join(half), "half").unwrap();
        for name in ["way", "way/file", "way/new"] {
            let path = own.join(name);
            assert!(below.write(&path, b"ours").is_err(), "{name}");
            assert!(below.remove(&path).is_err(), "{name}");
        }
        assert!(below.remove_if_empty(&own.join("way/empty")).is_err());
        below.clear_partials(&own.join("way"), |_| true);
        let names: Vec<String> = list(&other).unwrap().into_iter().map(|(n, _)| n).collect();
        assert_eq!(names, [half, "empty", "file"]);
        assert_eq!(std::fs::read(other.join("file")).unwrap(), b"mine");
    }

    #[test]
    fn what_is_being_written_stays_until_its_writer_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let half = folder.path().join("a.csv.12-0.bitgrain-partial");
        let writer = std::fs::File::create(&half).unwrap();
        writer.lock().unwrap();
        Below(folder.path()).clear_partials(folder.path(), |_| true);
        assert!(half.exists());
        drop(writer);
        Below(folder.path()).clear_partials(folder.path(), |_| true);
        assert!(!half.exists());
    }

    #[test]
    fn nothing_outside_and_nothing_of_another_kind_is_replaced() {
        let (_folder, own, other) = with_link();
        let below = Below(&own);
        let outside = [other.join("new"), own.join("../other/new")];
        for path in outside {
            assert!(below.write(&path, b"ours").is_err());
        }
        std::fs::create_dir(own.join("folder")).unwrap();
        let told = below.write(&own.join("folder"), b"").unwrap_err();
        assert!(
            told.to_string()
                .contains("is a folder in the place of a file")
        );
        below.write(&own.join("a/b"), b"ours").unwrap();
        assert!(!below.remove_if_empty(&own.join("a")).unwrap());
        below.remove(&own.join("a/b")).unwrap();
        assert!(below.remove_if_empty(&own.join("a")).unwrap());
    }
}
