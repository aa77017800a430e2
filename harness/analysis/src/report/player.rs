//! Figures that can be stepped through and played: a drawing whose circles a small script of the page puts
//! in other places. Without scripts, and in print, the drawing stays as it is.

use super::scale::{Cut, Scale};
use super::text::escape;

/// Signs of which two make a number and which mean nothing in HTML or JSON.
pub(super) const SIGNS: &str =
    "()*+,-./0123456789:;=>?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[]^_`abcdefghijklmnopqrstuvwxyz{|}~";
/// Parts of a unit of the drawing, and what is added so that no number is below zero.
const PARTS: f64 = 9.0;
const ADDED: f64 = 30.0;

/// One state of a figure: its name, and its circles with the place of their group of colour.
pub(super) struct State {
    /// Plain text.
    pub label: String,
    /// Cuts and places.
    pub cuts: Vec<(Cut, usize)>,
}

/// Circles of some states together, which a page has room for.
pub(super) const ROOM: usize = 120_000;

/// The figure of a drawing that shows `states[home]`; its circles of place `k` are the `k`th of
/// `groups` groups. `class` begins with `played`; `title` names what can be played.
pub(super) fn figure(
    class: &str,
    svg: &str,
    (title, caption): (&str, &str),
    scale: &Scale,
    groups: usize,
    states: &[State],
    home: usize,
) -> String {
    let frames: Vec<String> = states.iter().map(|s| packed(&s.cuts, scale)).collect();
    let labels: Vec<&str> = states.iter().map(|s| s.label.as_str()).collect();
    let data = serde_json::json!({
        "groups": groups,
        "home": home,
        "labels": labels,
        "frames": frames,
    });
    let data = data.to_string().replace('<', "\\u003c");
    let button = |sign: &str, words: &str| {
        format!("<button type=\"button\" aria-label=\"{words}\">{sign}</button>")
    };
    format!(
        "<figure class=\"{class}\">{svg}<div class=\"controls\" hidden>{}{}{}<input type=\"range\" min=\"0\" \
         max=\"{}\" value=\"{home}\" aria-label=\"{}\"><output></output></div><figcaption>{caption}</figcaption>\
         <script type=\"application/json\">{data}</script></figure>\n",
        button("&lsaquo;", "one back"),
        button("&#9654;", "play"),
        button("&rsaquo;", "one on"),
        states.len().saturating_sub(1),
        escape(title),
    )
}

/// Circles as signs.
fn packed(cuts: &[(Cut, usize)], scale: &Scale) -> String {
    let signs = SIGNS.as_bytes();
    let base = signs.len();
    let mut out = String::with_capacity(7 * cuts.len());
    for (cut, place) in cuts {
        let lengths = [
            scale.x(cut.x) + ADDED,
            scale.z(cut.z) + ADDED,
            scale.factor * cut.radius,
        ];
        for length in lengths {
            // What is not a number, or far outside, becomes one at the edge.
            let n = ((length * PARTS).round().max(0.0) as usize).min(base * base - 1);
            out.push(char::from(signs[n / base]));
            out.push(char::from(signs[n % base]));
        }
        out.push(char::from(signs[(*place).min(base - 1)]));
    }
    out
}

/// The script that plays all figures of a page.
pub(super) fn script() -> String {
    format!(
        "<script>\n{}</script>\n",
        include_str!("player.js").replace("SIGNS", SIGNS)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_harmless_and_differ() {
        let mut signs: Vec<char> = SIGNS.chars().collect();
        assert_eq!(signs.len(), 85);
        signs.dedup();
        assert_eq!(signs.len(), 85);
        assert!(!SIGNS.contains(['<', '&', '"', '\'', '\\']));
    }

    #[test]
    fn circles_are_packed_to_a_ninth_of_a_unit() {
        let scale = Scale::new([0.0, 0.0], [10.0, 10.0]).unwrap();
        let cut = Cut {
            x: 4.0,
            z: 3.0,
            radius: 0.5,
        };
        let text = packed(&[(cut, 3)], &scale);
        let value = |k: usize| SIGNS.find(&text[k..=k]).unwrap() as f64;
        let length = |k: usize| (85.0 * value(k) + value(k + 1)) / PARTS;
        assert!((length(0) - ADDED - scale.x(4.0)).abs() <= 0.5 / PARTS);
        assert!((length(2) - ADDED - scale.z(3.0)).abs() <= 0.5 / PARTS);
        assert!((length(4) - 0.5 * scale.factor).abs() <= 0.5 / PARTS);
        assert_eq!(value(6), 3.0);
        let beyond = Cut {
            x: f64::NAN,
            z: 1e300,
            radius: 1.0,
        };
        assert_eq!(packed(&[(beyond, 0)], &scale).len(), 7);
    }
}
