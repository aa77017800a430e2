//! Campaigns: one base scenario and the values that are varied, run as one, into one table.
//!
//! A campaign's file says what is varied ([`keys`]), [`plan`] turns it into members, each its own
//! scenario whose speeds share a bed, [`sweep`] runs what is left of them, and [`table`] holds a row for
//! every drag: inputs, observables, digest. [`tasks`] are the pieces of it that many processes do. [`written`] reads
//! back what lies in a campaign's folder.

mod base;
mod column;
pub mod columns;
pub mod folder;
pub mod forecast;
pub mod found;
pub mod keys;
pub mod only;
pub mod parquet;
pub mod plan;
pub mod rules;
pub mod sweep;
pub mod table;
mod tank_columns;
pub mod tasks;
pub mod verify;
pub mod written;

use std::path::Path;

use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use plan::Plan;

/// Names and texts of the campaigns that ship with the program.
pub const SHIPPED: [(&str, &str); 9] = [
    (
        "kumar-small",
        include_str!("../../campaigns/kumar-small.toml"),
    ),
    (
        "kumar-middle",
        include_str!("../../campaigns/kumar-middle.toml"),
    ),
    (
        "kumar-yield",
        include_str!("../../campaigns/kumar-yield.toml"),
    ),
    (
        "kumar-table-1",
        include_str!("../../campaigns/kumar-table-1.toml"),
    ),
    (
        "kumar-fig-5",
        include_str!("../../campaigns/kumar-fig-5.toml"),
    ),
    (
        "kumar-depth",
        include_str!("../../campaigns/kumar-depth.toml"),
    ),
    (
        "kumar-deep",
        include_str!("../../campaigns/kumar-deep.toml"),
    ),
    (
        "kumar-2018",
        include_str!("../../campaigns/kumar-2018.toml"),
    ),
    (
        "guillard-tanks",
        include_str!("../../campaigns/guillard-tanks.toml"),
    ),
];

/// Loads a campaign by the name of a shipped one or the path of a file, changes keys of its base scenario
/// as `sets` say, and makes its plan.
///
/// # Errors
/// [`Error::Input`] with line, grid or key, and what was expected.
pub fn load(name: &str, sets: &[String]) -> Result<Plan> {
    if let Some((key, text)) = SHIPPED.iter().find(|(key, _)| *key == name) {
        return plan::parse(text, &format!("{key} (shipped)"), sets, Path::new(""));
    }
    let path = Path::new(name);
    if !disk::is_there(path) && path.extension().is_none() {
        let names: Vec<&str> = SHIPPED.iter().map(|(key, _)| *key).collect();
        let problem = format!(
            "no such campaign; shipped are {}, or give a TOML file",
            names.join(", ")
        );
        return Err(Error::input(name, problem));
    }
    let text = bitgrain_sim::files::read_text(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    plan::parse(&text, &path.display().to_string(), sets, folder)
}
