//! A campaign as read from its own folder: with its base written out, and no path in it followed elsewhere.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::keys::{Base, Campaign};
use super::plan::{Plan, parse_campaign, plan_of};
use bitgrain_sim::below::Below;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::bits;

/// Parses the text of `campaign.toml` in the folder of a campaign and plans it; `place` is what errors call it. The
/// file of an imported bed is the copy that a member in this folder has.
///
/// # Errors
/// [`Error::Input`] if it is not a campaign, or names its base.
pub fn parse(text: &str, place: &str, folder: &Path) -> Result<Plan> {
    let mut campaign: Campaign = parse_campaign(text, place)?;
    let Base::Written(base) = &mut campaign.base else {
        let problem = "expected the keys of a scenario: in its folder a campaign has its base written out; the \
                       same `bitgrain sweep` writes it again";
        return Err(Error::input(format!("{place}: `base`"), problem));
    };
    let copied = |file: &mut Value| copy(file, folder);
    let wrong = |problem| Error::input(format!("{place}: `bed.file`"), problem);
    if let Some(Value::Table(bed)) = base.get_mut("bed") {
        bed.get_mut("file").map_or(Ok(()), copied).map_err(wrong)?;
    }
    for grid in &mut campaign.grid {
        let set: &mut Table = &mut grid.set;
        let file = set.get_mut("bed.file");
        file.map_or(Ok(()), copied).map_err(wrong)?;
    }
    plan_of(campaign, place, &[], folder)
}

/// The line that the file begins with.
pub(super) fn head() -> String {
    format!("# {}\n", bits())
}

/// Whether these are the bytes that a campaign writes of what they say, with nothing of somebody else in them.
pub(super) fn is_as_made(bytes: &[u8]) -> bool {
    let text = std::str::from_utf8(bytes).unwrap_or_default();
    let campaign = parse_campaign(text, "").ok();
    let made = campaign.and_then(|campaign| toml::to_string(&campaign).ok());
    made.is_some_and(|made| head() + &made == text)
}

/// Puts the copy in a member of this folder in the place of the file that a campaign names.
fn copy(file: &mut Value, folder: &Path) -> std::result::Result<(), String> {
    let Some(path) = file.as_str() else {
        return Ok(());
    };
    let Some(name) = Path::new(path).file_name() else {
        return Err(format!("`{path}` does not name a file"));
    };
    let members = folder.join("members");
    let names = disk::list(&members).map_err(|e| e.to_string())?.into_iter();
    let mut copies = names.map(|(member, _)| members.join(member).join("beds/imported").join(name));
    let is_copy = |copy: &PathBuf| disk::is_there(copy) && Below(folder).check_file(copy).is_ok();
    let copies: Option<PathBuf> = copies.find(is_copy);
    let found = copies
        .as_ref()
        .and_then(|copy| copy.strip_prefix(folder).ok());
    let Some(found) = found.and_then(Path::to_str) else {
        return Err(format!(
            "no member in this folder has a copy of `{path}`; the same `bitgrain sweep` makes it"
        ));
    };
    *file = Value::String(found.to_string());
    Ok(())
}
