//! The messages on a file that cannot be parsed.

use bitgrain_sim::error::Error;

/// A text that is not TOML of the wanted kind, with the line; `place` is what the text is called.
pub fn wrong_toml(place: &str, text: &str, error: &toml::de::Error) -> Error {
    let line = error
        .span()
        .map(|s| 1 + text[..s.start].matches('\n').count());
    let place = line.map_or(place.to_string(), |line| format!("{place}:{line}"));
    Error::input(place, teach(error.message()))
}

/// A parser's message with what helps most: the nearest valid key to an unknown one, or what a
/// broken file probably is. The caller adds the place.
pub fn teach(message: &str) -> String {
    let message = message.split(" at line ").next().unwrap_or(message);
    // Users need not know the names of Rust's types.
    let message = &message
        .replace("expected usize", "expected a whole number")
        .replace("expected u64", "expected a whole number")
        .replace("expected f64", "expected a number")
        .replace(
            "invalid type: unit variant, expected string only",
            "expected one of its words, in quotes",
        )
        .replace(
            "wanted string or table",
            "expected one of its words, in quotes",
        );
    if message.starts_with("EOF") {
        return format!("{message}: is the file cut off?");
    }
    if message == "trailing characters" {
        return "holds more values than expected".into();
    }
    if message == "expected value" {
        return "expected a value; JSON has no NaN and no infinity".into();
    }
    let mut quoted = message.split('`').skip(1).step_by(2);
    let unknown = message.contains("unknown field") || message.contains("unknown variant");
    let (true, Some(word)) = (unknown, quoted.next()) else {
        return message.to_string();
    };
    let nearest = quoted
        .map(|valid| (strsim::damerau_levenshtein(word, valid), valid))
        .min_by_key(|(distance, _)| *distance);
    match nearest {
        Some((distance, valid)) if distance <= 1 + word.len() / 3 => {
            format!("{message}; did you mean `{valid}`?")
        }
        _ => message.to_string(),
    }
}
