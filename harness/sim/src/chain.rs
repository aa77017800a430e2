//! The chain of digests: at regular steps the digest of each part of a state, chained with the link
//! before, so that a run of many hours can be checked anywhere and nothing in between can be changed
//! without notice.
//!
//! A link is the BLAKE3 hash of the line `BEFORE,STEP,PARTS...`: the link before it, the step, and the
//! digests of the six parts, in hex, as they stand in the file. Anyone checks one with `b3sum`. The first
//! link of a bed follows the digest of its recipe, that of a drag the last link of its bed.

use bitgrain_kernel::{BITS_VERSION, Digest, PARTS};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::files::bits;
use crate::simulation::hex;

/// Digits of a digest in hex.
const DIGITS: usize = 64;

/// How the file begins.
const BEGINS: &str = "# begins with ";

/// The digest of a state and its place in the chain.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Steps of the stage.
    pub step: u64,
    /// Digests of the parts in the order of [`PARTS`], in hex.
    pub parts: [String; 6],
    /// BLAKE3 over the link before and this one's step and parts, in hex.
    pub link: String,
}

impl Link {
    /// The link that follows `before` with this state.
    pub fn new(before: &str, step: u64, digest: &Digest) -> Self {
        let parts = digest.parts().map(|part| hex(part));
        Self::of(before, step, parts)
    }

    fn of(before: &str, step: u64, parts: [String; 6]) -> Self {
        let line = format!("{before},{step},{}", parts.join(","));
        let link = hash(&line);
        Self { step, parts, link }
    }

    /// `STEP,PARTS...,LINK`: a line of the file.
    pub fn line(&self) -> String {
        format!("{},{},{}", self.step, self.parts.join(","), self.link)
    }

    fn parse(before: &str, line: &str) -> Option<Self> {
        let mut words = line.split(',');
        let step = words.next()?.parse().ok()?;
        let mut part = || Some(words.next()?.to_string());
        let parts = [part()?, part()?, part()?, part()?, part()?, part()?];
        let link = Self::of(before, step, parts);
        // Written again it must be the same text, so that no other text is accepted.
        (link.line() == line).then_some(link)
    }
}

/// Names of the parts whose digests differ.
pub fn differing(a: &[String; 6], b: &[String; 6]) -> Vec<&'static str> {
    let pairs = a.iter().zip(b).zip(PARTS);
    let differing = pairs.filter(|((a, b), _)| a != b);
    differing.map(|(_, name)| name).collect()
}

fn hash(text: &str) -> String {
    hex(blake3::hash(text.as_bytes()).as_bytes())
}

/// What the very first link follows: the digest of what a bed is made from.
pub fn beginning(source: &str) -> String {
    hash(&format!("bitgrain {BITS_VERSION} {source}"))
}

/// The links of one stage.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chain {
    /// What the first link follows.
    pub begins: String,
    /// Steps between links.
    pub every: u64,
    /// The links so far, by step.
    pub links: Vec<Link>,
}

/// Column names of a chain's file.
fn columns() -> String {
    format!("step,{},link", PARTS.join(","))
}

impl Chain {
    /// A chain without links.
    pub fn new(begins: String, every: u64) -> Self {
        Self {
            begins,
            every: every.max(1),
            links: Vec::new(),
        }
    }

    /// The last link, or what the first one is to follow.
    pub fn end(&self) -> &str {
        self.links.last().map_or(&self.begins, |link| &link.link)
    }

    /// Whether a state at this step is to become a link: the first, and one in each stretch of steps.
    pub fn is_due(&self, step: u64) -> bool {
        let before = self.links.last().map(|link| link.step / self.every);
        before.is_none_or(|before| step / self.every > before)
    }

    /// Adds a state; a step that is the last link's already is passed over.
    pub fn add(&mut self, step: u64, digest: &Digest) -> Option<&Link> {
        if self.links.last().is_some_and(|link| link.step >= step) {
            return None;
        }
        self.links.push(Link::new(self.end(), step, digest));
        self.links.last()
    }

    /// Whether it is that of a stage which begins with step 0 and has come to this step: every link follows from the
    /// one before, none that is due is missing, and none lies ahead.
    pub fn is_whole_at(&self, step: u64) -> bool {
        let before = std::iter::once(&self.begins).chain(self.links.iter().map(|link| &link.link));
        let mut pairs = self.links.iter().zip(before);
        let follows =
            pairs.all(|(link, before)| *link == Link::of(before, link.step, link.parts.clone()));
        let (last, ahead) = match self.links.split_last() {
            Some((last, before)) if !last.step.is_multiple_of(self.every) => (last.step, before),
            _ => (step, &self.links[..]),
        };
        let due = (0..).map(|k| k * self.every).take_while(|due| *due <= step);
        follows && last == step && due.eq(ahead.iter().map(|link| link.step))
    }

    /// The file: a comment with what the chain begins with, the column names, the links.
    pub fn text(&self) -> String {
        let mut out = format!("{BEGINS}{}; {}\n{}\n", self.begins, bits(), columns());
        for link in &self.links {
            out.push_str(&link.line());
            out.push('\n');
        }
        out
    }

    /// Reads the text of a file and checks every link; `name` is what errors call it.
    ///
    /// # Errors
    /// [`Error::Input`] with the line that does not follow from the one before.
    pub fn parse(text: &str, name: &str) -> Result<Self> {
        let broken = |line: usize, what: &str| {
            Error::input(
                format!("{name}:{line}"),
                format!("{what}; the file was changed or cut off after it was written"),
            )
        };
        // Any arithmetic is accepted: links do not contain it.
        let first = text.lines().next().unwrap_or_default();
        let begins: String = first.chars().skip(BEGINS.len()).take(DIGITS).collect();
        let mut chain = Self::new(begins, 1);
        let made = first.rsplit(' ').next().unwrap_or_default();
        let number = made.parse::<u32>().is_ok_and(|n| n.to_string() == made);
        let head = format!(
            "{BEGINS}{}; BITS_VERSION {made}\n{}\n",
            chain.begins,
            columns()
        );
        if !number || !text.starts_with(&head) {
            return Err(broken(1, "is not the head of a chain of digests"));
        }
        for (k, line) in text.lines().enumerate().skip(2) {
            let link = Link::parse(chain.end(), line)
                .ok_or_else(|| broken(k + 1, "is no link that follows the one before"))?;
            if chain
                .links
                .last()
                .is_some_and(|last| last.step >= link.step)
            {
                return Err(broken(k + 1, "has a step that does not ascend"));
            }
            chain.links.push(link);
        }
        if !text.ends_with('\n') {
            return Err(broken(text.lines().count(), "has no end"));
        }
        Ok(chain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digest(seed: u8) -> Digest {
        let part = |k: u8| [seed.wrapping_mul(7) ^ k; 32];
        Digest {
            positions: part(0),
            velocities: part(1),
            spins: part(2),
            histories: part(3),
            forces: part(4),
            obstacles: part(5),
            whole: part(6),
        }
    }

    /// Links that follow are not enough: none may be missing, and none may lie ahead of the state.
    #[test]
    fn a_whole_chain_has_every_link_that_is_due() {
        let of = |steps: &[u64]| {
            let mut chain = Chain::new(beginning("a recipe"), 100);
            for step in steps {
                chain.add(*step, &digest(*step as u8));
            }
            chain
        };
        for (steps, at) in [
            (&[0, 100][..], 100),
            (&[0, 100], 199),
            (&[0, 100, 150], 150),
            (&[0], 0),
        ] {
            assert!(of(steps).is_whole_at(at), "{steps:?} at {at}");
        }
        let wrong = [
            (&[0, 100][..], 99),
            (&[0, 100], 200),
            (&[0, 200], 200),
            (&[], 0),
            (&[0, 150], 199),
        ];
        for (steps, at) in wrong {
            assert!(!of(steps).is_whole_at(at), "{steps:?} at {at}");
        }
        let mut changed = of(&[0, 100]);
        changed.links[0].parts[0].replace_range(..1, "x");
        assert!(!changed.is_whole_at(100));
    }

    fn chain() -> Chain {
        let mut chain = Chain::new(beginning("a recipe"), 100);
        for step in [0, 100, 200, 250] {
            chain.add(step, &digest(step as u8));
        }
        chain
    }

    #[test]
    fn links_are_due_once_in_a_stretch() {
        let mut chain = Chain::new(beginning(""), 100);
        let mut due = Vec::new();
        for step in [0, 50, 99, 130, 160, 199, 200, 450, 451] {
            if chain.is_due(step) {
                due.push(step);
                chain.add(step, &digest(1));
            }
        }
        assert_eq!(due, [0, 130, 200, 450]);
        assert!(chain.add(450, &digest(2)).is_none(), "only once a step");
        assert!(chain.add(460, &digest(2)).is_some());
    }

    #[test]
    fn a_chain_reads_back() {
        let chain = chain();
        let again = Chain::parse(&chain.text(), "chain.csv").unwrap();
        assert_eq!(
            (again.begins.clone(), again.links.clone()),
            (chain.begins, chain.links)
        );
        let line = format!(
            "{},250,{}",
            again.links[2].link,
            again.links[3].parts.join(",")
        );
        assert_eq!(again.end(), hash(&line));
    }

    /// Every bit counts: none can be flipped, and no line taken away but the last.
    #[test]
    fn every_flipped_bit_is_seen() {
        let text = chain().text();
        for at in 0..text.len() {
            for bit in 0..8 {
                let mut bytes = text.clone().into_bytes();
                bytes[at] ^= 1 << bit;
                let Ok(flipped) = String::from_utf8(bytes) else {
                    continue;
                };
                let read = Chain::parse(&flipped, "chain.csv");
                // The arithmetic's number alone is not in the chain: the folder's scenario holds it.
                let version = text.find("BITS_VERSION ").unwrap() + "BITS_VERSION ".len();
                assert!(read.is_err() || at == version, "byte {at}, bit {bit}");
            }
        }
        let lines: Vec<&str> = text.lines().collect();
        for gone in 0..lines.len() - 1 {
            let kept = lines.iter().enumerate().filter(|(k, _)| *k != gone);
            let kept: String = kept.map(|(_, line)| format!("{line}\n")).collect();
            assert!(Chain::parse(&kept, "chain.csv").is_err(), "line {gone}");
        }
    }
}
