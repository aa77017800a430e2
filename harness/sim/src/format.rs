//! Numbers as plain text for people.

/// Mantissa and power of ten of a number rounded to this many digits.
fn scientific(x: f64, digits: usize) -> (String, i32) {
    let text = format!("{x:.*e}", digits.max(1) - 1);
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (mantissa.to_owned(), exponent.parse().unwrap_or(0))
}

/// A number to this many significant digits; a dash for what is not a number.
fn significant(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return "\u{2014}".to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let (mantissa, exponent) = scientific(x, digits);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    let text = if (-4..7).contains(&exponent) {
        let decimals = digits as i32 - 1 - exponent;
        trimmed(&format!("{x:.*}", usize::try_from(decimals).unwrap_or(0)))
    } else {
        format!("{}{}", trimmed(&mantissa), power(exponent))
    };
    text.replace('-', "\u{2212}")
}

/// ` × 10` to a power.
fn power(exponent: i32) -> String {
    let high = |c: char| match c.to_digit(10) {
        Some(1) => '\u{b9}',
        Some(k @ 2..=3) => char::from_u32(0xb0 + k).unwrap_or(c),
        Some(k) => char::from_u32(0x2070 + k).unwrap_or(c),
        None => '\u{207b}',
    };
    let high: String = exponent.to_string().chars().map(high).collect();
    format!("\u{a0}\u{d7}\u{a0}10{high}")
}

/// Six significant digits.
pub fn number(x: f64) -> String {
    significant(x, 6)
}

/// Four, for running text.
pub fn short(x: f64) -> String {
    significant(x, 4)
}

/// A number to the second digit of its error, as plain text.
pub fn number_with_error(mean: f64, error: f64) -> String {
    if !mean.is_finite() || !error.is_finite() {
        return format!("{}\u{a0}\u{b1}\u{a0}{}", number(mean), number(error));
    }
    let exponent = scientific(mean, 6).1;
    let scaled = !(-4..7).contains(&exponent) && mean != 0.0;
    let ten: f64 = format!("1e{exponent}").parse().unwrap_or(1.0);
    let ten = if scaled { ten } else { 1.0 };
    let places = 1 - scientific(error / ten, 2).1;
    let most = 5 - if scaled { 0 } else { exponent };
    let text = if error == 0.0 || places > most {
        format!(
            "{}\u{a0}\u{b1}\u{a0}{}",
            number(mean / ten),
            significant(error / ten, 2)
        )
    } else {
        let places = usize::try_from(places).unwrap_or(0);
        format!(
            "{:.places$}\u{a0}\u{b1}\u{a0}{:.places$}",
            mean / ten,
            error / ten
        )
    };
    let text = match scaled {
        true => format!("({text}){}", power(exponent)),
        false => text,
    };
    text.replace('-', "\u{2212}")
}

/// A number to ten significant digits, as fitted numbers are written to files: rounding as the last digits
/// go does not show there.
pub fn round10(x: f64) -> f64 {
    format!("{x:.9e}").parse().unwrap_or(x)
}

/// A count with its noun.
pub fn plural(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// Seconds in words.
pub fn duration(seconds: f64) -> String {
    match seconds {
        ..100.0 => format!("{seconds:.0} s"),
        ..6000.0 => format!("{:.0} min", seconds / 60.0),
        ..172_800.0 => format!("{:.1} h", seconds / 3600.0),
        _ => format!("{:.0} days", seconds / 86_400.0),
    }
}

/// Bytes in words.
pub fn bytes(count: f64) -> String {
    match count {
        0.0..1e3 => format!("{count:.0} B"),
        1e3..1e6 => format!("{:.0} kB", 1e-3 * count),
        1e6..1e9 => format!("{:.0} MB", 1e-6 * count),
        _ => format!("{:.1} GB", 1e-9 * count),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_they_deserve() {
        assert_eq!(number(1_234_567.8), "1234568");
        assert_eq!(number(-0.000_123_456_78), "\u{2212}0.000123457");
        assert_eq!(number(1.5e-9), "1.5\u{a0}\u{d7}\u{a0}10\u{207b}\u{2079}");
        let shown = |m, e| number_with_error(m, e).replace('\u{a0}', " ");
        assert_eq!(shown(83.5678, 1.834), "83.6 \u{b1} 1.8");
        assert_eq!(shown(-0.31, 0.0514), "\u{2212}0.310 \u{b1} 0.051");
        assert_eq!(shown(1.5, 0.0), "1.5 \u{b1} 0");
        assert_eq!(shown(1234.4, 560.0), "1234 \u{b1} 560");
        assert_eq!(
            [0, 1, 2].map(|n| plural(n, "link")),
            ["0 links", "1 link", "2 links"]
        );
        assert_eq!(
            shown(2.5e-8, 1.2e-9),
            "(2.50 \u{b1} 0.12) \u{d7} 10\u{207b}\u{2078}"
        );
    }

    #[test]
    fn bytes_are_rounded_to_their_unit() {
        assert_eq!(bytes(1.3e6), "1 MB");
    }

    #[test]
    fn times_are_told_in_words() {
        assert_eq!(duration(7200.0), "2.0 h");
    }
}
