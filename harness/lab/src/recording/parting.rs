//! Where two recordings part.

use std::fmt;

use bitgrain_sim::error::{Error, Result};

use super::difference::{Difference, difference, kind};
use super::read::{Item, Recorded, Step};

/// Where two recordings, or two running commands, first differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parting {
    /// The last step that was compared and is the same; none if they differ from the beginning.
    pub equal: Option<u64>,
    /// The first step that was compared and differs.
    pub step: u64,
    /// Names of all arrays that differ there, in the order of the first side; then those that only the second has.
    pub arrays: Vec<String>,
    /// How the first of them differs; none if only digests are known.
    pub difference: Option<Difference>,
    /// What to do to learn more.
    pub hint: Option<String>,
}

impl fmt::Display for Parting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let step = self.step;
        match self.equal {
            Some(equal) => write!(f, "the same to step {equal}, different at step {step}")?,
            None => write!(f, "different from the beginning, step {step}")?,
        }
        write!(f, "\n  arrays: {}", self.arrays.join(", "))?;
        if let (Some(name), Some(difference)) = (self.arrays.first(), &self.difference) {
            write!(f, "\n  {name}{difference}")?;
        }
        match &self.hint {
            Some(hint) => write!(f, "\n  {hint}"),
            None => Ok(()),
        }
    }
}

/// Finds where two recordings part; `None` if every step that both have is the same. `say` reports what there is to
/// know beside that.
///
/// # Errors
/// Recordings without a step in common, and kept arrays that are not those recorded.
pub fn part(
    sides: &[Recorded; 2],
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<Option<Parting>> {
    let steps = [
        compared(&sides[0], "first", &mut say)?,
        compared(&sides[1], "second", &mut say)?,
    ];
    let pairs = common(steps);
    let only = [steps[0].len() - pairs.len(), steps[1].len() - pairs.len()];
    if pairs.is_empty() {
        let [one, other] = sides
            .each_ref()
            .map(|side| side.place.display().to_string());
        return Err(Error::input(
            one,
            format!("has no step in common with {other}"),
        ));
    }
    if only != [0, 0] {
        say(&format!(
            "{} steps are in both; {} are in the first alone, {} in the second alone",
            pairs.len(),
            only[0],
            only[1]
        ))?;
    }
    let mut equal = None;
    for (a, b) in pairs {
        let names = differing(&a.arrays, &b.arrays);
        if !names.is_empty() {
            return explain(sides, equal, [a, b], names).map(Some);
        }
        equal = Some(a.step);
    }
    Ok(None)
}

/// The steps of a side that can be compared: the last one of a recording without an end may lack arrays.
fn compared<'a>(
    side: &'a Recorded,
    which: &str,
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<&'a [Step]> {
    let steps = &side.recording.steps[..];
    if side.recording.closed {
        return Ok(steps);
    }
    let Some((last, before)) = steps.split_last() else {
        return Ok(steps);
    };
    say(&format!(
        "the {which} has no end: its program was stopped, or lines are missing; its last step, {}, is not compared",
        last.step
    ))?;
    Ok(before)
}

/// The steps that both have.
fn common([a, b]: [&[Step]; 2]) -> Vec<(&Step, &Step)> {
    let find = |step: &Step| b.binary_search_by_key(&step.step, |other| other.step);
    a.iter()
        .filter_map(|step| Some((step, &b[find(step).ok()?])))
        .collect()
}

/// Names of the arrays that are not the same on both sides.
fn differing(a: &[Item], b: &[Item]) -> Vec<String> {
    let in_a = a.iter().filter(|item| !b.contains(item));
    let in_b = b
        .iter()
        .filter(|item| !a.iter().any(|other| other.name == item.name));
    in_a.chain(in_b).map(|item| item.name.clone()).collect()
}

/// What can be said of a step at which two recordings differ.
fn explain(
    sides: &[Recorded; 2],
    equal: Option<u64>,
    steps: [&Step; 2],
    arrays: Vec<String>,
) -> Result<Parting> {
    let step = steps[0].step;
    let mut parting = Parting {
        equal,
        step,
        arrays,
        difference: None,
        hint: None,
    };
    let name = &parting.arrays[0];
    let named = |step: &'_ Step| step.arrays.iter().position(|item| item.name == *name);
    let (Some(i), Some(j)) = (named(steps[0]), named(steps[1])) else {
        let first_has = named(steps[0]).is_some();
        parting.difference = Some(Difference::Missing { first_has });
        return Ok(parting);
    };
    let items = [&steps[0].arrays[i], &steps[1].arrays[j]];
    let [first, second] = items.map(|item| kind(item.element, &item.shape));
    if first != second {
        parting.difference = Some(Difference::Kind { first, second });
        return Ok(parting);
    }
    let kept = [sides[0].arrays(steps[0])?, sides[1].arrays(steps[1])?];
    if let [Some(one), Some(other)] = &kept {
        parting.difference = difference(&one[i], &other[j]);
        return Ok(parting);
    }
    let from = equal.map_or(step, |equal| equal.saturating_add(1));
    let who = match kept.map(|side| side.is_some()) {
        [true, _] => "the second did not keep",
        [_, true] => "the first did not keep",
        _ => "neither kept",
    };
    let between = match from < step {
        true => ", with every step between",
        false => "",
    };
    parting.hint = Some(format!(
        "{who} the arrays of step {step}: record both again with --keep {from}-{step}{between}, or let \
         `bitgrain bisect --commands` run the two programs"
    ));
    Ok(parting)
}
