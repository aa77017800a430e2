//! A campaign as read from its own folder: with its base written out, and no path in it followed elsewhere.

use std::path::Path;

use super::keys::{Base, Campaign};
use super::plan::{Files, Plan, parse_campaign, plan_of};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::bits;

/// Parses the text of `campaign.toml` in the folder of a campaign and plans it; `place` is what errors call it. The
/// file of an imported bed is the copy that each member in this folder has.
///
/// # Errors
/// [`Error::Input`] if it is not a campaign, or names its base.
pub fn parse(text: &str, place: &str, folder: &Path) -> Result<Plan> {
    let campaign: Campaign = parse_campaign(text, place)?;
    if !matches!(campaign.base, Base::Written(_)) {
        let problem = "expected the keys of a scenario: in its folder a campaign has its base written out; the \
                       same `bitgrain sweep` writes it again";
        return Err(Error::input(format!("{place}: `base`"), problem));
    }
    plan_of(campaign, place, &[], Files::CopiedIn(folder))
}

/// The line that the file begins with.
pub(super) fn head() -> String {
    format!("# {}\n", bits())
}

/// The text that a sweep writes of the campaign of these bytes, if they are one with its base written out.
pub(super) fn as_made(bytes: &[u8]) -> Option<String> {
    let campaign = parse_campaign(std::str::from_utf8(bytes).ok()?, "").ok()?;
    Some(head() + &toml::to_string(&campaign).ok()?)
}
