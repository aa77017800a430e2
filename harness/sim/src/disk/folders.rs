//! Folders: where a path to one leads, and how one is made.

#[cfg(unix)]
use std::fs::File;
use std::io;
use std::path::{Component, Path, PathBuf};

use super::watch::{Call, before};
use crate::error::{Error, Result};

/// Refuses a path with `..` behind what is no folder. Nothing is found by such a path, and once somebody makes that
/// folder the same path leads past it, to files that nobody looked at.
///
/// # Errors
/// [`Error::Input`].
pub fn check_way(path: &Path) -> Result<()> {
    let mut at = PathBuf::new();
    for word in path.components() {
        if word == Component::ParentDir && at.parent().is_some() && !at.is_dir() {
            let problem = format!(
                "`{}` is no folder, and `..` behind it leads out of one: give the path without `..`",
                at.display()
            );
            return Err(Error::input(path.display().to_string(), problem));
        }
        at.push(word);
    }
    Ok(())
}

/// A path from the root on, without links and `..` as far as something is there.
///
/// # Errors
/// As [`check_way`]; [`Error::Input`] if there is no current folder, or a link on the way leads to nothing.
pub fn resolved(path: &Path) -> Result<PathBuf> {
    check_way(path)?;
    let full = std::path::absolute(path).map_err(|e| Error::read(path, &e))?;
    if let Some(link) = full
        .ancestors()
        .find(|above| above.is_symlink() && !above.exists())
    {
        let problem = "is a link to nothing, which may be made meanwhile: name the folder itself";
        return Err(Error::input(link.display().to_string(), problem));
    }
    let mut known = full.ancestors();
    let real = known.find_map(|above| Some((above.canonicalize().ok()?, above)));
    let rest = real.map(|(real, above)| real.join(full.strip_prefix(above).unwrap_or(&full)));
    Ok(rest.unwrap_or(full))
}

/// Makes a folder and those above it, each of which lasts.
///
/// # Errors
/// As [`check_way`]; [`Error::Write`].
pub fn make_folder(folder: &Path) -> Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    match make(folder)? {
        Some(taken) if !folder.is_dir() => Err(Error::write(folder, taken)),
        // Another thread may have made it meanwhile.
        _ => Ok(()),
    }
}

/// The same; says whether it was made now, or something has its name.
///
/// # Errors
/// As [`make_folder`].
pub fn make_new_folder(folder: &Path) -> Result<bool> {
    Ok(make(folder)?.is_none())
}

/// Makes a folder, or says that something has its name.
fn make(folder: &Path) -> Result<Option<io::Error>> {
    check_way(folder)?;
    // Without a `.` at its end, where the system would look for the folder that is to be made.
    let folder = &folder.components().collect::<PathBuf>();
    let up = above(folder);
    if up != folder {
        make_folder(up)?;
    }
    let made = before(Call::MakeFolder(folder)).and_then(|()| std::fs::create_dir(folder));
    match made {
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Ok(Some(e)),
        made => {
            let lasts = made.and_then(|()| sync_folder(up));
            lasts.map(|()| None).map_err(|e| Error::write(folder, e))
        }
    }
}

/// The folder that a path is in.
pub(super) fn above(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Makes the names in a folder last.
pub(super) fn sync_folder(folder: &Path) -> io::Result<()> {
    before(Call::SyncFolder(folder))?;
    // Elsewhere folders cannot be opened, and renames last by themselves.
    #[cfg(unix)]
    File::open(folder)?.sync_all()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{read, write_whole};
    use super::*;

    #[test]
    fn a_new_folder_is_made_once() {
        let folder = tempfile::tempdir().unwrap();
        let new = folder.path().join("slurm/1");
        assert_eq!(
            [(), ()].map(|()| make_new_folder(&new).unwrap()),
            [true, false]
        );
        make_folder(&folder.path().join("new/.")).unwrap();
    }

    /// By a path past a folder that is not there nothing is made and nothing replaced.
    #[test]
    fn nothing_is_made_or_replaced_past_a_missing_folder() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        write_whole(&at("mine/a"), b"mine").unwrap();
        for way in ["new/../mine/a", "mine/a/../a", "mine/../new/b/../../mine/a"] {
            let told = write_whole(&at(way), b"ours").unwrap_err().to_string();
            assert!(told.contains("without `..`"), "{way}: {told}");
            assert!(make_folder(&at(way)).is_err() && resolved(&at(way)).is_err());
        }
        assert!(!at("new").exists());
        assert_eq!(read(&at("mine/a")).unwrap(), b"mine");
        for way in ["mine/../mine/a", "mine/.././mine/../mine/a"] {
            write_whole(&at(way), b"mine").unwrap();
            assert_eq!(
                resolved(&at(way)).unwrap(),
                resolved(&at("mine/a")).unwrap()
            );
        }
        for way in ["..", "../..", "./..", "/..", "../../a"] {
            check_way(Path::new(way)).unwrap();
        }
    }

    #[test]
    #[cfg(unix)]
    fn a_path_is_resolved_as_far_as_it_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        make_folder(&at("a/b")).unwrap();
        std::os::unix::fs::symlink(at("a/b"), at("link")).unwrap();
        let real = folder.path().canonicalize().unwrap();
        for (way, leads) in [
            ("link/new/c", "a/b/new/c"),
            ("link/../new", "a/new"),
            ("a/./b/../new/.", "a/new"),
        ] {
            assert_eq!(resolved(&at(way)).unwrap(), real.join(leads), "{way}");
        }
    }
}
