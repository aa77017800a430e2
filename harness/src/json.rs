//! JSON files read as data types, with the line and the key of what is wrong.

use serde::de::DeserializeOwned;

use crate::error::{Error, Result, teach};

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
