//! Two texts of reference lines, side by side.

/// The first line in which two texts differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Number of the line, from 1.
    pub line: usize,
    /// The line that was got; empty behind the end.
    pub got: String,
    /// The golden one; empty behind the end.
    pub expected: String,
}

/// A program's output without its remarks, the lines that begin with `#`.
pub fn lines(output: &str) -> String {
    let kept = output.split_inclusive('\n');
    kept.filter(|line| !line.starts_with('#')).collect()
}

/// Where the texts differ first, line ends and all.
pub fn first_difference(got: &str, expected: &str) -> Option<Difference> {
    let (mut ours, mut theirs) = (got.split_inclusive('\n'), expected.split_inclusive('\n'));
    for line in 1.. {
        let (got, expected) = match (ours.next(), theirs.next()) {
            (None, None) => return None,
            (got, expected) if got == expected => continue,
            (got, expected) => (got.unwrap_or_default(), expected.unwrap_or_default()),
        };
        // Where only the line end differs, it is shown.
        let same = got.trim_end() == expected.trim_end();
        let show = |text: &str| match same {
            true => format!("{text:?}"),
            false => text.trim_end().to_string(),
        };
        let (got, expected) = (show(got), show(expected));
        return Some(Difference {
            line,
            got,
            expected,
        });
    }
    None
}

/// The first 16 digits of the digest over the first list of worlds, or of the last line; empty if that is none of a
/// reference.
pub fn last_digest(text: &str) -> String {
    let all = text.lines().find(|line| line.starts_with("all "));
    let last = all.or(text.lines().next_back()).unwrap_or_default();
    let word = last.split_whitespace().next_back().unwrap_or_default();
    let whole = word.len() == 64 && word.bytes().all(|b| b.is_ascii_hexdigit());
    if whole { &word[..16] } else { "" }.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_texts_have_no_difference() {
        assert_eq!(first_difference("", ""), None);
        assert_eq!(first_difference("a\nb\n", "a\nb\n"), None);
    }

    #[test]
    fn the_first_different_line_is_named() {
        let found = |got, expected| {
            let d = first_difference(got, expected).unwrap();
            (d.line, d.got, d.expected)
        };
        let texts = |line, got: &str, expected: &str| (line, got.into(), expected.into());
        assert_eq!(found("a\nb\nc\n", "a\nx\ny\n"), texts(2, "b", "x"));
        // One of them ends early.
        assert_eq!(found("a\n", "a\nb\n"), texts(2, "", "b"));
        assert_eq!(found("a\nb\n", "a\n"), texts(2, "b", ""));
        assert_eq!(found("", "a\n"), texts(1, "", "a"));
        // Line ends are bytes too.
        assert_eq!(found("a\r\n", "a\n"), texts(1, "\"a\\r\\n\"", "\"a\\n\""));
        assert_eq!(found("a", "a\n"), texts(1, "\"a\"", "\"a\\n\""));
    }

    #[test]
    fn remarks_are_not_compared() {
        assert_eq!(lines("a\n# stack 12 of 40\nb\n"), "a\nb\n");
    }

    #[test]
    fn a_digest_is_sixty_four_digits() {
        let digits = "0123456789abcdef".repeat(4);
        let line = format!("all lines above 0 {digits}\n");
        assert_eq!(last_digest(&line), "0123456789abcdef");
        for other in ["", "a panic\n", "all 0123\n", &line.replace('f', "g")] {
            assert_eq!(last_digest(other), "");
        }
    }
}
