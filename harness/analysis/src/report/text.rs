//! Numbers and units as text of the page.

use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::format::{number, number_with_error, short};

/// Text with no character that means something in HTML.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// A unit as it is printed: `rho d^3 g` with Greek letter and power, on one line.
pub(super) fn typeset(unit: &str) -> String {
    ["rho", "sqrt", "^2", "^3", "^4", " "]
        .iter()
        .zip([
            "\u{3c1}", "\u{221a}", "\u{b2}", "\u{b3}", "\u{2074}", "\u{a0}",
        ])
        .fold(unit.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// Six digits are shown, all of them are in the markup.
pub(super) fn exact(x: f64) -> String {
    match x.is_finite() {
        true => format!("<data value=\"{x:?}\">{}</data>", number(x)),
        false => number(x),
    }
}

/// Four digits are shown, all of them are in the markup.
pub(super) fn brief(x: f64) -> String {
    match x.is_finite() {
        true => format!("<data value=\"{x:?}\" title=\"{x:?}\">{}</data>", short(x)),
        false => short(x),
    }
}

/// A number to the second digit of an error that is not its own, all digits in the markup.
pub(super) fn to_error(x: f64, error: f64) -> String {
    if !x.is_finite() || !error.is_finite() || error <= 0.0 {
        return brief(x);
    }
    let whole = number_with_error(x, error);
    let text = match (whole.split_once('\u{a0}'), whole.starts_with('(')) {
        (Some((text, _)), false) => text.to_owned(),
        _ => short(x),
    };
    format!("<data value=\"{x:?}\" title=\"{x:?}\">{text}</data>")
}

/// A whole number in groups of three.
pub(super) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (k, c) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{202f}');
        }
        text.push(c);
    }
    format!("<data value=\"{n}\">{text}</data>")
}

/// A mean to the second digit of its standard error, all digits in the markup.
pub(super) fn plus_minus(value: Mean) -> String {
    let (mean, error) = (value.mean, value.standard_error);
    if !mean.is_finite() || !error.is_finite() {
        return format!("{}\u{a0}\u{b1}\u{a0}{}", exact(mean), exact(error));
    }
    let text = number_with_error(mean, error);
    format!("<data value=\"{mean:?}\" title=\"{mean:?} \u{b1} {error:?}\">{text}</data>")
}
