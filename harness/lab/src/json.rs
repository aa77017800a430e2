//! JSON files read as data types, with the line and the key of what is wrong.

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

use crate::parse_errors::teach;
use bitgrain_sim::error::{Error, Result};

/// Reads the text of a JSON file that holds one value; `name` is what errors call it.
///
/// # Errors
/// [`Error::Input`] with line and key, and what was expected.
pub fn parse<T: DeserializeOwned>(text: &str, name: &str) -> Result<T> {
    let mut json = serde_json::Deserializer::from_str(text);
    let value: T = serde_path_to_error::deserialize(&mut json).map_err(|e| {
        let (line, key) = (e.inner().line(), e.path().to_string());
        let place = if line > 0 {
            format!("{name}:{line}")
        } else {
            name.to_string()
        };
        let key = if key == "." {
            String::new()
        } else {
            format!("`{key}`: ")
        };
        Error::input(place, format!("{key}{}", teach(&e.inner().to_string())))
    })?;
    json.end().map_err(|e| {
        let place = format!("{name}:{}", e.line());
        Error::input(
            place,
            "text after the end of the object; expected one JSON object",
        )
    })?;
    Ok(value)
}

/// The text of a JSON file; a number that is not finite, which JSON would turn into null, is refused.
///
/// # Errors
/// [`Error::Write`] with the file's name.
pub fn json_text(path: &Path, value: &impl Serialize) -> Result<String> {
    let refused = |e: serde_json::Error| Error::write(path, std::io::Error::other(e));
    let tree = serde_json::to_value(value).map_err(refused)?;
    if has_null(&tree) {
        let problem = std::io::Error::other("a number in it is not finite");
        return Err(Error::write(path, problem));
    }
    let mut text = serde_json::to_string_pretty(value).map_err(refused)?;
    text.push('\n');
    Ok(text)
}

fn has_null(tree: &serde_json::Value) -> bool {
    match tree {
        serde_json::Value::Null => true,
        serde_json::Value::Array(list) => list.iter().any(has_null),
        serde_json::Value::Object(map) => map.values().any(has_null),
        _ => false,
    }
}
