//! The book of claims: what the papers say in numbers, what was last measured of it, and whether the two
//! agree (`golden/claims.toml`).

use serde::{Deserialize, Serialize};

use super::number::{Combine, Found};
use crate::analysis::Value;
use bitgrain_lab::parse_errors::wrong_toml;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::format::round10;
use bitgrain_sim::format::{number_with_error, short};

/// Most claims of a book.
const CLAIMS_MAX: usize = 10_000;

/// Most claims that one follows from.
const ROOTS_MAX: usize = 10;

/// Most numbers of which a measurement is the worst.
const NUMBERS_MAX: usize = 1_000_000;

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
    /// How several numbers of it become one, of one campaign and of all.
    #[serde(default, skip_serializing_if = "Combine::is_default")]
    pub combine: Combine,
    /// What holding it against the runs takes for granted and the paper does not say: a number beside the paper's then
    /// contradicts the two together, so that the claim is not resolved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub assumes: Option<String>,
    /// Claims whose numbers decide this one's: it is the same number in other words or units, an integral of it, or
    /// their quotient. It is counted with them, not as an independent number. They follow from no others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub follows_from: Vec<String>,
    /// Numbers of a table of the paper, row by row.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<Vec<f64>>,
    /// What was last measured, once for each that measured it; those that have a number count together.
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
    /// Its standard error, above 0; 0 for what is computed; none if there is no number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Of how many numbers it is the worst, at least 1; 1 if it is the only one or a mean.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub of: usize,
    /// What it rests on, or why there is none.
    pub note: String,
    /// BLAKE3 of the results that it was read from, which hold the digest of every run.
    pub digest: String,
}

fn one() -> usize {
    1
}

fn is_one(of: &usize) -> bool {
    *of == 1
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
            claim.check_measured(&place)?;
            let bounds = claim.least.is_some() || claim.most.is_some();
            if claim.value.is_some() == bounds || claim.value.is_some() != claim.tolerance.is_some()
            {
                let problem = "expected value and tolerance, or bounds: least, most or both";
                return Err(Error::input(place, problem));
            }
            if claim.follows_from.len() > ROOTS_MAX {
                let problem = format!("follows from more than {ROOTS_MAX} claims");
                return Err(Error::input(place, problem));
            }
            for id in &claim.follows_from {
                let root = book.claim.iter().find(|other| other.id == *id);
                if root.is_none_or(|other| !other.follows_from.is_empty()) {
                    let problem = format!(
                        "follows from `{id}`; expected a claim of this book that follows from no other"
                    );
                    return Err(Error::input(place, problem));
                }
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
    pub fn new(by: &str, digest: &str, found: Found) -> Self {
        let finite = |v: &Value| v.value.is_finite() && v.error.is_finite();
        let (value, of, note) = match found {
            Ok(number) if finite(&number.value) => (Some(number.value), number.of, number.note),
            Ok(number) => {
                let note = format!("no finite number came out: {}", number.note);
                (None, 1, note)
            }
            Err(why) => (None, 1, why),
        };
        Self {
            by: by.into(),
            value: value.map(|v| round10(v.value)),
            error: value.map(|v| round10(v.error)),
            of,
            note,
            digest: digest.into(),
        }
    }

    /// The number with its error, if there is one.
    pub fn as_value(&self) -> Option<Value> {
        Some(Value::new(self.value?, self.error?))
    }

    /// `0.93 ± 0.02`, or a dash.
    pub fn number(&self) -> String {
        self.as_value().map_or("-".into(), shown)
    }
}

/// `0.93 ± 0.02`; without an error that is above 0 the number alone.
pub fn shown(number: Value) -> String {
    match number.error > 0.0 {
        true => number_with_error(number.value, number.error),
        false => short(number.value),
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

    /// A number has an error, and is the worst of several in claims alone that say so.
    fn check_measured(&self, place: &str) -> Result<()> {
        for measured in &self.measured {
            let by = &measured.by;
            if measured.value.is_some() != measured.error.is_some() {
                let problem =
                    format!("`{by}` has a value or an error alone; expected both or none");
                return Err(Error::input(place, problem));
            }
            if measured.of == 0 || measured.of > NUMBERS_MAX {
                let of = measured.of;
                let problem = format!("`{by}` has of = {of}; expected 1 to {NUMBERS_MAX}");
                return Err(Error::input(place, problem));
            }
            if measured.of > 1 && self.combine == Combine::Mean {
                let problem = format!(
                    "`{by}` is the worst of {}; expected combine = \"worst\"",
                    measured.of
                );
                return Err(Error::input(place, problem));
            }
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
}

#[cfg(test)]
mod tests {
    use super::super::number::Number;
    use super::super::synthetic::claim;
    use super::*;

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
        let refused = |text: &str| Book::parse(text, "text").unwrap_err().to_string();
        let twice = format!("{0}{0}", &text[text.find("[[claim]]").unwrap()..]);
        assert!(refused(&twice).contains("is there twice"));
        let told = refused(&text.replacen("tolerance = ", "least = ", 1));
        assert!(
            told.contains("claim `kumar-flat`: expected value and tolerance"),
            "{told}"
        );
        let claim = claim("least = 1.0");
        let refused = |change: fn(&mut Claim)| {
            let mut wrong = claim.clone();
            let found = Ok(Number::one(Value::new(2.0, 0.1), "n"));
            wrong.measured = vec![Measured::new("x", "", found)];
            change(&mut wrong);
            let claim = vec![wrong];
            Book::parse(&Book { claim }.text(""), "text")
                .unwrap_err()
                .to_string()
        };
        assert!(refused(|c| c.measured[0].error = None).contains("expected both or none"));
        assert!(refused(|c| c.measured[0].of = 0).contains("expected 1 to"));
        assert!(refused(|c| c.measured[0].of = 2).contains("combine = \"worst\""));
        // Of no claim, of itself, and of one that follows from another.
        assert!(refused(|c| c.follows_from = vec!["b".into()]).contains("follows from `b`"));
        assert!(refused(|c| c.follows_from = vec!["a".into()]).contains("follows from `a`"));
        let text = text.replacen("id = \"guillard-front\"", "id = \"front\"", 1);
        let told = Book::parse(&text, "text").unwrap_err().to_string();
        assert!(told.contains("follows from `guillard-front`"), "{told}");
    }
}
