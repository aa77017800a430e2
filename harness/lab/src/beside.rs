//! Files that lie beside results and that no manifest lists: a page, findings, facts of the machine.

use std::path::Path;

use crate::manifest::{self, Manifest};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

/// The page of a run or campaign.
pub(crate) const REPORT: &str = "report.html";

/// What the table of a campaign, or a run, says.
pub(crate) const ANALYSIS: &str = "analysis.json";

/// How fast stages went on this machine.
pub(crate) const PERFORMANCE: &str = "performance.json";

/// Refuses to replace a file that lies beside results and that this program did not write, by its name and how it
/// begins. Other names are those of results, which the manifest lists.
///
/// # Errors
/// [`Error::Input`].
pub fn refuse_foreign(path: &Path) -> Result<()> {
    let name = path.file_name().unwrap_or_default();
    let mark = match name.to_str() {
        Some(REPORT) => "Before you believe these numbers",
        Some(ANALYSIS) => "{\n  \"around\": ",
        Some(PERFORMANCE | manifest::NAME) => "\"bits_version\":",
        _ => return Ok(()),
    };
    let Some(held) = disk::read_if_there(path)? else {
        return Ok(());
    };
    if disk::bears(&held, mark) {
        return Ok(());
    }
    let problem = "is no file that bitgrain wrote, and would be replaced: move it away, or choose another folder";
    Err(Error::input(path.display().to_string(), problem))
}

/// Writes a file beside results, in a folder of ours: a page, findings, or facts of the machine.
///
/// # Errors
/// As [`refuse_foreign`]; [`Error::Write`].
pub fn write_beside(path: &Path, bytes: &[u8]) -> Result<()> {
    refuse_foreign(path)?;
    disk::write_whole(path, bytes)
}

/// Refuses a file that the user names for output if it is a result: one that the manifest of a folder above it lists,
/// or that manifest. What else lies there is the user's to replace.
///
/// # Errors
/// [`Error::Input`].
pub fn refuse_result(path: &Path) -> Result<()> {
    disk::check_way(path)?;
    let parent = path.parent().filter(|parent| *parent != Path::new(""));
    let parent = parent.unwrap_or(Path::new(".")).canonicalize();
    let (Ok(parent), Some(name)) = (parent, path.file_name()) else {
        return Ok(());
    };
    let full = parent.join(name);
    for above in full.ancestors().skip(1) {
        let name = manifest::relative(above, &full).unwrap_or_default();
        let Ok(Some(manifest)) = Manifest::of(above) else {
            continue;
        };
        if name == manifest::NAME || manifest.entry(&name).is_some() {
            let folder = above.display();
            let problem =
                format!("is a result, which the manifest in {folder} lists: name another file");
            return Err(Error::input(path.display().to_string(), problem));
        }
    }
    Ok(())
}
