//! Foreign text made safe for a terminal.

/// Longest word that is shown whole, in characters: that of a path, which is a file's name only as a whole.
const WORD_MAX: usize = 4096;

/// The text with control characters but newlines, and those that turn the direction of writing, shown as
/// `\u{1b}`.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        match c {
            '\n' => out.push(c),
            c if c.is_control() || turns => out.extend(c.escape_unicode()),
            c => out.push(c),
        }
    }
    out
}

/// The same, and of a word of more than 4096 characters the first 4096 and how many there are.
pub fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len().min(1 << 16));
    for part in text.split_inclusive(char::is_whitespace) {
        let word = part.trim_end_matches(char::is_whitespace);
        match word.char_indices().nth(WORD_MAX) {
            None => out.push_str(&escaped(part)),
            Some((end, _)) => {
                let count = word.chars().count();
                out.push_str(&escaped(&word[..end]));
                out.push_str(&format!("... ({count} characters)"));
                out.push_str(&escaped(&part[word.len()..]));
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_is_told_no_commands() {
        assert_eq!(
            escaped("a\u{1b}[2J\r\n\u{7}b"),
            "a\\u{1b}[2J\\u{d}\n\\u{7}b"
        );
        assert_eq!(escaped("\u{9b}31m \u{202e}"), "\\u{9b}31m \\u{202e}");
        let sane = "Fr 2, drag 83.6 \u{b1} 1.8\nnext line";
        assert_eq!((escaped(sane), plain(sane)), (sane.into(), sane.into()));
    }

    #[test]
    fn a_long_word_is_cut() {
        let text = format!("a {} b", "\u{e9}".repeat(1_000_000));
        let cut = format!("a {}... (1000000 characters) b", "\u{e9}".repeat(WORD_MAX));
        assert_eq!(plain(&text), cut);
        let whole = "x".repeat(WORD_MAX);
        assert_eq!(plain(&whole), whole);
    }
}
