//! Which arrays of a recording are kept beside their digests.

use std::fmt;
use std::str::FromStr;

/// Which steps' arrays are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// None: digests alone.
    Digests,
    /// Those of every recorded step.
    All,
    /// Those of the recorded steps that this number divides; at least 1.
    Every(u64),
    /// Those of so many recorded steps before the end; older ones are removed as new ones come. At least 1.
    Last(usize),
    /// Those of the recorded steps from the first number to the second, both included.
    Range(u64, u64),
}

impl Keep {
    /// Whether the arrays of a step are to be kept when it is recorded.
    pub fn wants(self, step: u64) -> bool {
        match self {
            Keep::Digests => false,
            Keep::All | Keep::Last(_) => true,
            Keep::Every(by) => step.is_multiple_of(by.max(1)),
            Keep::Range(from, to) => (from..=to).contains(&step),
        }
    }
}

impl fmt::Display for Keep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Keep::Digests => f.write_str("digests"),
            Keep::All => f.write_str("all"),
            Keep::Every(by) => write!(f, "every:{by}"),
            Keep::Last(count) => write!(f, "last:{count}"),
            Keep::Range(from, to) => write!(f, "{from}-{to}"),
        }
    }
}

impl FromStr for Keep {
    type Err = String;

    /// Reads `digests`, `all`, `every:100`, `last:5` or `120-140`.
    ///
    /// ```
    /// use bitgrain_lab::recording::Keep;
    ///
    /// assert_eq!("120-140".parse(), Ok(Keep::Range(120, 140)));
    /// assert!("some".parse::<Keep>().unwrap_err().contains("every:100"));
    /// ```
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |word: &str| word.parse::<u64>().ok();
        let positive = |word: &str| number(word).filter(|n| *n > 0);
        let found = match text.split_once(':') {
            Some(("every", by)) => positive(by).map(Keep::Every),
            Some(("last", count)) => positive(count)
                .and_then(|n| usize::try_from(n).ok())
                .map(Keep::Last),
            Some(_) => None,
            None if text == "digests" => Some(Keep::Digests),
            None if text == "all" => Some(Keep::All),
            None => text.split_once('-').and_then(|(from, to)| {
                let (from, to) = (number(from)?, number(to)?);
                (from <= to).then_some(Keep::Range(from, to))
            }),
        };
        found.ok_or_else(|| {
            format!(
                "`{text}` does not say which arrays to keep: `digests` (none), `all`, `every:100` (steps that 100 \
                 divides), `last:5` (the last five steps) or `120-140` (these steps)"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_read_back() {
        let all = [
            Keep::Digests,
            Keep::All,
            Keep::Every(7),
            Keep::Last(3),
            Keep::Range(0, 0),
            Keep::Range(5, 9),
        ];
        for keep in all {
            assert_eq!(keep.to_string().parse(), Ok(keep));
        }
        for wrong in [
            "", "every", "every:0", "last:0", "last:x", "9-5", "5-", "each:2", "-1",
        ] {
            assert!(wrong.parse::<Keep>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn steps_are_wanted() {
        let wanted = |keep: Keep| (0..12).filter(|step| keep.wants(*step)).collect::<Vec<_>>();
        assert!(wanted(Keep::Digests).is_empty());
        assert_eq!(wanted(Keep::Every(5)), [0, 5, 10]);
        assert_eq!(wanted(Keep::Range(3, 5)), [3, 4, 5]);
        assert_eq!(wanted(Keep::All).len() + wanted(Keep::Last(2)).len(), 24);
    }
}
