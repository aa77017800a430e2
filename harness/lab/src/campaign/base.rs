//! The base of a campaign: the scenario that its members vary.

use std::path::Path;

use toml::{Table, Value};

use super::keys::Base;
use crate::parse_errors::wrong_toml;
use crate::scenario;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;

/// The base as a table, whose keys may be incomplete.
pub(super) fn base_table(base: &Base, place: &str, folder: &Path) -> Result<Table> {
    let (text, name) = match base {
        Base::Written(table) => {
            let mut table = table.clone();
            // The campaign and its members must have their own names.
            table
                .entry("name")
                .or_insert_with(|| Value::String("base".into()));
            return Ok(table);
        }
        Base::Named(name) => match scenario::SHIPPED.iter().find(|(key, _)| key == name) {
            Some((_, text)) => (text.to_string(), name.clone()),
            None => {
                let path = folder.join(name);
                if !disk::is_file(&path) {
                    let problem = format!(
                        "is `{name}`: no shipped scenario has that name, and {} is not a file",
                        path.display()
                    );
                    return Err(Error::input(format!("{place}: `base`"), problem));
                }
                (read_text(&path)?, path.display().to_string())
            }
        },
    };
    toml::from_str(&text).map_err(|e| wrong_toml(&name, &text, &e))
}
