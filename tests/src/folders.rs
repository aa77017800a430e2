//! Folders with results in them: all of their files at once, and folders with such files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use bitgrain::folder::Folder;
use bitgrain::manifest::{Manifest, audit::audit};
use bitgrain::run::planned;

/// Holds what lies in the folder of a run, and its manifest, against the files that its scenario names.
pub fn assert_named(out: &Path) {
    let scenario = Folder(out).saved_scenario().expect("a run's folder");
    let manifest = Manifest::of(out).expect("a sound manifest");
    let manifest = manifest.expect("a run has a manifest");
    let found = audit(out, &manifest, &planned(&scenario)).expect("a readable folder");
    assert_eq!(found.wrong, Vec::<String>::new());
}

/// A copy of a folder with the results in it, to be changed.
pub fn copied(from: &Path) -> tempfile::TempDir {
    written(&results(from))
}

/// A folder with these files in it.
pub fn written(files: &BTreeMap<String, Vec<u8>>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes) in files {
        let path = folder.path().join(name);
        let parent = path.parent().expect("it lies below");
        std::fs::create_dir_all(parent).expect("a folder can be made");
        std::fs::write(path, bytes).expect("a file can be written");
    }
    folder
}

/// Every file below a folder, by relative name, but the machine's own `performance.json`.
pub fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(next).expect("a readable folder") {
            let path = entry.expect("a readable entry").path();
            if path.is_dir() {
                open.push(path);
            } else if !path.ends_with("performance.json") {
                let name = path.strip_prefix(folder).expect("it lies below");
                let name = name.to_str().expect("a plain name").replace('\\', "/");
                found.insert(name, std::fs::read(&path).expect("a readable file"));
            }
        }
    }
    found
}

/// Names of files that are not the same in both.
pub fn differing(a: &BTreeMap<String, Vec<u8>>, b: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let names: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let differs = |name: &&String| a.get(*name) != b.get(*name);
    names.into_iter().filter(differs).cloned().collect()
}
