//! The book of claims: what the papers say in numbers, what was last measured of it, and whether the two
//! agree (`golden/claims.toml`).

use serde::{Deserialize, Serialize};

use super::verdict::Verdict;
use crate::analysis::Value;
use bitgrain_lab::parse_errors::wrong_toml;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::format::round10;
use bitgrain_sim::format::{number_with_error, short};

/// Most claims of a book.
const CLAIMS_MAX: usize = 10_000;

/// The book that ships with the program.
pub const SHIPPED: &str = include_str!("../../data/claims.toml");

/// One statement of a paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Name, by which it is measured.
    pub id: String,
    /// Which paper.
    pub paper: String,
    /// Where it says so: section, equation, figure or table.
    pub source: String,
    /// What it says, in a sentence.
    pub statement: String,
    /// The paper's number for what is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// How far a measured number may lie from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Or the least that it may be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
    /// Or the most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most: Option<f64>,
    /// Why that tolerance, or that bound.
    pub why: String,
    /// What is measured.
    pub measures: String,
    /// Scenarios and campaigns that measure it.
    pub tested_by: Vec<String>,
    /// Numbers of a table of the paper, row by row.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<Vec<f64>>,
    /// What was last measured, once for each that measured it; of those that have a number the last one counts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measured: Vec<Measured>,
}

/// One measurement of a claim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Name of the scenario or campaign; `direct` for what is computed on the spot.
    pub by: String,
    /// The number; none if the runs cannot give it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Its standard error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// What it rests on, or why there is none.
    pub note: String,
    /// BLAKE3 of the results that it was read from, which hold the digest of every run.
    pub digest: String,
}

/// All claims.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Book {
    /// In the order of the papers.
    pub claim: Vec<Claim>,
}

impl Book {
    /// Reads a book; `place` is what errors call it.
    ///
    /// # Errors
    /// [`Error::Input`] with the line or the claim that is wrong.
    pub fn parse(text: &str, place: &str) -> Result<Self> {
        let book: Book = toml::from_str(text).map_err(|e| wrong_toml(place, text, &e))?;
        if book.claim.len() > CLAIMS_MAX {
            let problem = format!(
                "holds {} claims; expected at most {CLAIMS_MAX}",
                book.claim.len()
            );
            return Err(Error::input(place, problem));
        }
        for (k, claim) in book.claim.iter().enumerate() {
            let place = format!("{place}: claim `{}`", claim.id);
            if book.claim[..k].iter().any(|other| other.id == claim.id) {
                return Err(Error::input(place, "is there twice"));
            }
            claim.check_numbers(&place)?;
            let bounds = claim.least.is_some() || claim.most.is_some();
            if claim.value.is_some() == bounds || claim.value.is_some() != claim.tolerance.is_some()
            {
                let problem = "expected value and tolerance, or bounds: least, most or both";
                return Err(Error::input(place, problem));
            }
        }
        Ok(book)
    }

    /// The book that ships with the program.
    pub fn shipped() -> Self {
        Self::parse(SHIPPED, "the shipped claims").expect("the shipped book is tested")
    }

    /// As TOML, behind the comment that a text begins with.
    pub fn text(&self, before: &str) -> String {
        let comment = before.lines().take_while(|line| line.starts_with('#'));
        let comment: String = comment.map(|line| format!("{line}\n")).collect();
        let body = toml::to_string(self).expect("claims are words and finite numbers");
        format!("{comment}\n{body}")
    }

    /// Puts a measurement into a claim's list, in place of the one by the same.
    pub fn record(&mut self, id: &str, measured: Measured) {
        let Some(claim) = self.claim.iter_mut().find(|claim| claim.id == id) else {
            return;
        };
        match claim.measured.iter_mut().find(|m| m.by == measured.by) {
            Some(old) => *old = measured,
            None => claim.measured.push(measured),
        }
    }
}

impl Measured {
    /// A number that was measured, or why none was.
    pub fn new(
        by: &str,
        digest: &str,
        found: std::result::Result<(Value, String), String>,
    ) -> Self {
        let (value, note) = match found {
            Ok((value, note)) if value.value.is_finite() && value.error.is_finite() => {
                (Some(value), note)
            }
            Ok((_, note)) => (None, format!("no finite number came out: {note}")),
            Err(why) => (None, why),
        };
        Self {
            by: by.into(),
            value: value.map(|v| round10(v.value)),
            error: value.map(|v| round10(v.error)),
            note,
            digest: digest.into(),
        }
    }

    /// `0.93 ± 0.02`, or a dash.
    pub fn number(&self) -> String {
        match (self.value, self.error) {
            (Some(value), Some(error)) if error > 0.0 => number_with_error(value, error),
            (Some(value), _) => short(value),
            _ => "-".into(),
        }
    }
}

impl Claim {
    /// TOML has numbers that are not finite, which cannot be compared.
    fn check_numbers(&self, place: &str) -> Result<()> {
        let own = [self.value, self.tolerance, self.least, self.most];
        let measured = self.measured.iter().flat_map(|m| [m.value, m.error]);
        let mut all = own.into_iter().chain(measured).flatten();
        if let Some(x) = all.find(|x| !x.is_finite()) {
            return Err(Error::input(
                place,
                format!("has the number {x}; expected a finite one"),
            ));
        }
        let errors = self.measured.iter().filter_map(|m| m.error);
        let mut widths = errors.chain(self.tolerance);
        if let Some(x) = widths.find(|x| *x < 0.0) {
            return Err(Error::input(
                place,
                format!("has an error or tolerance of {x}, below zero"),
            ));
        }
        Ok(())
    }

    /// `1 +- 0.1`, or `at most 0.1`.
    pub fn expected(&self) -> String {
        let bound = |word: &str, x: Option<f64>| x.map(|x| format!("{word} {}", short(x)));
        match (self.value, self.tolerance) {
            (Some(value), Some(tolerance)) => format!("{} +- {}", short(value), short(tolerance)),
            _ => [bound("at least", self.least), bound("at most", self.most)]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join(", "),
        }
    }

    /// Whether a measurement agrees. A number agrees within the tolerance if its error is no larger, and
    /// disagrees if two errors more do not reach it. It keeps a bound if it does so within one error, and
    /// breaks it if it does so by two.
    pub fn agreement(&self, measured: &Measured) -> Verdict {
        let (Some(x), Some(error)) = (measured.value, measured.error) else {
            return Verdict::NotResolved;
        };
        if let (Some(value), Some(tolerance)) = (self.value, self.tolerance) {
            let off = (x - value).abs();
            return if off > tolerance + 2.0 * error {
                Verdict::Disagrees
            } else if off <= tolerance && error <= tolerance {
                Verdict::Agrees
            } else {
                Verdict::NotResolved
            };
        }
        let above = |least: f64, errors: f64| x - errors * error >= least;
        let below = |most: f64, errors: f64| x + errors * error <= most;
        let kept =
            self.least.is_none_or(|b| above(b, 1.0)) && self.most.is_none_or(|b| below(b, 1.0));
        let broken = self.least.is_some_and(|b| !above(b, -2.0))
            || self.most.is_some_and(|b| !below(b, -2.0));
        match (kept, broken) {
            (true, _) => Verdict::Agrees,
            (_, true) => Verdict::Disagrees,
            _ => Verdict::NotResolved,
        }
    }

    /// The measurement that counts: the last one that has a number.
    fn counted(&self) -> Option<&Measured> {
        let mut numbers = self.measured.iter().filter(|m| m.value.is_some());
        numbers.next_back()
    }

    /// Whether the measurement that counts agrees.
    pub fn verdict(&self) -> Verdict {
        let counted = self.counted();
        counted.map_or(Verdict::NotResolved, |measured| self.agreement(measured))
    }

    /// How far a measurement is off the paper's number, or off a bound that it does not keep: in percent, and in its
    /// errors.
    fn deviation(&self, measured: &Measured) -> [String; 2] {
        let off = measured.value.and_then(|x| {
            let beyond = self.most.filter(|most| x > *most);
            let aim = self
                .value
                .or(beyond)
                .or(self.least.filter(|least| x < *least))?;
            Some((x - aim, aim))
        });
        let Some((off, aim)) = off else {
            return ["-".into(), "-".into()];
        };
        let percent = match aim {
            0.0 => "-".into(),
            aim => format!("{:+.0} %", 100.0 * off / aim.abs()),
        };
        let errors = match measured.error {
            Some(error) if error > 0.0 => format!("{:+.1}", off / error),
            _ => "-".into(),
        };
        [percent, errors]
    }
}

/// The book in a line for each claim: verdict, name, the paper's number, ours, how far apart they are, and what
/// measured it.
pub fn lines(book: &Book) -> String {
    let row = |cells: [&str; 7]| {
        let [verdict, id, paper, ours, percent, errors, by] = cells;
        let line =
            format!("{verdict:<13} {id:<31} {paper:<26} {ours:<17} {percent:>7} {errors:>7}  {by}");
        line.trim_end().to_string()
    };
    let mut out = vec![row([
        "verdict", "claim", "paper", "measured", "off", "errors", "by",
    ])];
    let mut counts = [0; 3];
    for claim in &book.claim {
        let verdict = claim.verdict();
        counts[verdict as usize] += 1;
        let (ours, [percent, errors], by) = match claim.counted() {
            Some(one) => (one.number(), claim.deviation(one), one.by.as_str()),
            None => ("-".into(), ["-".into(), "-".into()], ""),
        };
        let paper = claim.expected();
        out.push(row([
            verdict.text(),
            &claim.id,
            &paper,
            &ours,
            &percent,
            &errors,
            by,
        ]));
    }
    let [agrees, disagrees, open] = counts;
    out.push(format!(
        "\n{agrees} agree, {disagrees} disagree, {open} are not resolved. A number agrees if it lies within the \
         paper's tolerance and\nits error is no larger. `off` is its distance from the paper's number, `errors` the \
         same in its own standard errors.\n--full says what each claim is, from where, and every measurement of it."
    ));
    out.join("\n") + "\n"
}

/// The book in full: verdict, statement, what is measured, the paper's number, every one of ours.
pub fn table(book: &Book) -> String {
    let mut lines = Vec::new();
    let mut paper = "";
    let mut counts = [0; 3];
    for claim in &book.claim {
        if claim.paper != paper {
            paper = &claim.paper;
            lines.push(format!("\n{paper}"));
        }
        let verdict = claim.verdict();
        counts[verdict as usize] += 1;
        lines.push(format!(
            "{:<13} {} ({})",
            verdict.text(),
            claim.statement,
            claim.source
        ));
        lines.push(format!(
            "{:<13} {}: {}",
            "",
            claim.measures,
            claim.expected()
        ));
        for measured in &claim.measured {
            let word = claim.agreement(measured).text();
            lines.push(format!(
                "{:<13} {}: {}, {word}; {}",
                "",
                measured.by,
                measured.number(),
                measured.note
            ));
        }
        if claim.measured.is_empty() {
            lines.push(format!("{:<13} nothing was measured", ""));
        }
    }
    let [agrees, disagrees, open] = counts;
    lines.push(format!(
        "\n{agrees} agree, {disagrees} disagree, {open} are not resolved"
    ));
    lines.join("\n").trim_start().to_string() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use Verdict::{Agrees, Disagrees, NotResolved};

    fn claim(bounds: &str) -> Claim {
        let text = format!(
            "[[claim]]\nid = \"a\"\npaper = \"p\"\nsource = \"s\"\nstatement = \"t\"\n{bounds}\nwhy = \"w\"\n\
             measures = \"m\"\ntested_by = []\n"
        );
        Book::parse(&text, "text").unwrap().claim.remove(0)
    }

    fn verdict(bounds: &str, value: f64, error: f64) -> Verdict {
        let found = Ok((Value { value, error }, String::new()));
        claim(bounds).agreement(&Measured::new("x", "", found))
    }

    #[test]
    fn deviations_are_from_the_number_or_from_the_bound_that_is_not_kept() {
        let off = |bounds: &str, value: f64, error: f64| {
            let found = Ok((Value { value, error }, String::new()));
            claim(bounds)
                .deviation(&Measured::new("x", "", found))
                .join(" ")
        };
        assert_eq!(off("value = 2.0\ntolerance = 0.1", 2.5, 0.25), "+25 % +2.0");
        assert_eq!(off("value = -2.0\ntolerance = 0.1", -2.5, 0.0), "-25 % -");
        assert_eq!(off("value = 0.0\ntolerance = 0.1", 0.2, 0.1), "- +2.0");
        assert_eq!(off("least = 2.0", 2.5, 0.4), "- -");
        assert_eq!(off("least = 2.0", 1.0, 0.5), "-50 % -2.0");
        assert_eq!(off("least = 0.0\nmost = 1.0", 1.5, 0.5), "+50 % +1.0");
    }

    #[test]
    fn errors_decide_what_can_be_told() {
        let one = "value = 1.0\ntolerance = 0.1";
        assert_eq!(verdict(one, 1.09, 0.05), Agrees);
        assert_eq!(verdict(one, 1.0, 0.11), NotResolved);
        assert_eq!(verdict(one, 1.19, 0.05), NotResolved);
        assert_eq!(verdict(one, 1.21, 0.05), Disagrees);
        assert_eq!(verdict(one, f64::NAN, 0.05), NotResolved);
        let least = "least = 2.0";
        assert_eq!(verdict(least, 2.5, 0.4), Agrees);
        assert_eq!(verdict(least, 2.2, 0.4), NotResolved);
        assert_eq!(verdict(least, 1.3, 0.4), NotResolved);
        assert_eq!(verdict(least, 1.1, 0.4), Disagrees);
        let both = "least = 0.0\nmost = 1.0";
        assert_eq!(verdict(both, 0.5, 0.1), Agrees);
        assert_eq!(verdict(both, 1.5, 0.1), Disagrees);
        assert_eq!(verdict(both, 0.95, 0.1), NotResolved);
        // Runs that cannot give a number do not revoke what others measured.
        let mut claim = claim(one);
        let value = |value| Ok((Value::new(value, 0.05), String::new()));
        claim.measured = [value(1.5), value(1.0), Err("too few".to_string())]
            .map(|found| Measured::new("x", "", found))
            .to_vec();
        assert_eq!(claim.verdict(), Agrees);
        claim.measured.clear();
        assert_eq!(claim.verdict(), NotResolved);
    }

    #[test]
    fn a_book_reads_back_and_wrong_ones_are_refused() {
        let mut book = Book::shipped();
        assert!(book.claim.len() > 40);
        let last = Measured::new("test", "ab", Err("too short".into()));
        book.record("kumar-flat", last.clone());
        book.record("kumar-flat", last);
        let text = book.text(SHIPPED);
        assert_eq!(Book::parse(&text, "again").unwrap(), book);
        assert!(text.starts_with("# What Kumar 2018"), "{}", &text[..200]);
        let twice = format!("{0}{0}", &text[text.find("[[claim]]").unwrap()..]);
        assert!(
            Book::parse(&twice, "twice")
                .unwrap_err()
                .to_string()
                .contains("is there twice")
        );
        let neither = text.replacen("tolerance = ", "least = ", 1);
        let told = Book::parse(&neither, "neither").unwrap_err().to_string();
        assert!(
            told.contains("claim `kumar-flat`: expected value and tolerance"),
            "{told}"
        );
    }
}
