//! Where two recordings part.

use std::fmt;

use bitgrain_sim::error::{Error, Result};

use super::array::Array;
use super::difference::{Difference, difference, differing, kind};
use super::read::{Recorded, Recording, Step};

/// Where two recordings, or two running commands, first differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parting {
    /// The last step that was compared and is the same; none if they differ from the beginning.
    pub equal: Option<u64>,
    /// The first step that was compared and differs.
    pub step: u64,
    /// Names of all arrays that differ there, in the order of the first side; then those that only the second has. None
    /// if only one has the step, or lacks its end: then `hint` says which.
    pub arrays: Vec<String>,
    /// How the first of them differs; none if only digests are known.
    pub difference: Option<Difference>,
    /// What to do to learn more.
    pub hint: Option<String>,
}

impl Parting {
    /// Two that are the same to a step, after which the next steps of both are not of one number, or one is not there:
    /// it has ended, or was cut off if it is not `whole`.
    pub(super) fn uneven(equal: Option<u64>, next: [Option<u64>; 2], whole: [bool; 2]) -> Self {
        let told = |side: usize| match (next[side], equal) {
            (Some(step), Some(_)) => format!("goes on with step {step}"),
            (Some(step), None) => format!("begins with step {step}"),
            (None, None) => "has no step".into(),
            (None, Some(last)) if whole[side] => format!("ends with step {last}"),
            (None, Some(last)) => format!("was cut off after step {last}"),
        };
        let step = next.into_iter().flatten().min().or(equal);
        Self {
            equal,
            step: step.unwrap_or(0),
            arrays: Vec::new(),
            difference: None,
            hint: Some(format!("the first {}, the second {}", told(0), told(1))),
        }
    }
}

impl fmt::Display for Parting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (step, uneven) = (self.step, self.arrays.is_empty());
        match self.equal {
            Some(equal) if uneven => write!(f, "the same to step {equal}")?,
            None if uneven => f.write_str("different from the beginning")?,
            Some(equal) => write!(f, "the same to step {equal}, different at step {step}")?,
            None => write!(f, "different from the beginning, step {step}")?,
        }
        if !uneven {
            write!(f, "\n  arrays: {}", self.arrays.join(", "))?;
        }
        if let (Some(name), Some(difference)) = (self.arrays.first(), &self.difference) {
            write!(f, "\n  {name}{difference}")?;
        }
        match &self.hint {
            Some(hint) if uneven => write!(f, ": {hint}"),
            Some(hint) => write!(f, "\n  {hint}"),
            None => Ok(()),
        }
    }
}

/// Finds where two recordings part; `None` if both have their ends and the same steps, and every step is the same. With
/// `prefix` one may be the beginning of the other, and may lack its end. `say` reports what there is to know beside
/// that.
///
/// # Errors
/// Recordings of which no step was compared, and kept arrays that are not those recorded.
pub fn part(
    sides: &[Recorded; 2],
    prefix: bool,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<Option<Parting>> {
    let [one, other] = sides;
    for (side, which) in [(one, "first"), (other, "second")] {
        if let Some(last) = side
            .recording
            .steps
            .last()
            .filter(|_| !side.recording.closed)
        {
            say(&format!(
                "the {which} has no end: its program was stopped, or lines are missing; its last step, {}, is not \
                 compared",
                last.step
            ))?;
        }
    }
    let mut held = Held::new(one, prefix);
    for step in whole_steps(&other.recording) {
        let parting = held.next(step, || other.arrays(step))?;
        if parting.is_some() {
            return Ok(parting);
        }
    }
    held.end(other.recording.closed, &other.place.display().to_string())
}

/// The steps that can be compared: the last one of a recording without an end may lack arrays.
fn whole_steps(recording: &Recording) -> &[Step] {
    let steps = &recording.steps[..];
    match steps.split_last() {
        Some((_, before)) if !recording.closed => before,
        _ => steps,
    }
}

/// A recording with which the steps of another one are compared as they come.
pub struct Held<'a> {
    first: &'a Recorded,
    steps: &'a [Step],
    prefix: bool,
    /// How many steps are the same.
    same: usize,
}

impl<'a> Held<'a> {
    /// Before the first step. With `prefix` one may be the beginning of the other.
    pub fn new(first: &'a Recorded, prefix: bool) -> Self {
        Self {
            first,
            steps: whole_steps(&first.recording),
            prefix,
            same: 0,
        }
    }

    /// How many steps are the same, and how many could have been compared.
    pub fn counts(&self) -> (usize, usize) {
        (self.same, self.steps.len())
    }

    /// The last step that is the same.
    fn equal(&self) -> Option<u64> {
        self.same.checked_sub(1).map(|k| self.steps[k].step)
    }

    fn uneven(&self, next: [Option<u64>; 2], whole: bool) -> Option<Parting> {
        let whole = [self.first.recording.closed, whole];
        Some(Parting::uneven(self.equal(), next, whole))
    }

    /// Compares the next step of the other one, whose arrays `kept` reads if there are any.
    ///
    /// # Errors
    /// Kept arrays that are not those recorded.
    pub fn next(
        &mut self,
        step: &Step,
        kept: impl FnOnce() -> Result<Option<Vec<Array>>>,
    ) -> Result<Option<Parting>> {
        let own = self.steps.get(self.same);
        match own {
            None if self.prefix => Ok(None),
            Some(own) if own.step == step.step => {
                let names = differing(&own.arrays, &step.arrays, |item| &item.name);
                if names.is_empty() {
                    self.same += 1;
                    return Ok(None);
                }
                let kept = || Ok([self.first.arrays(own)?, kept()?]);
                explain(self.equal(), [own, step], names, kept).map(Some)
            }
            own => Ok(self.uneven([own.map(|own| own.step), Some(step.step)], true)),
        }
    }

    /// Compares the end of the other one, which is called `name` and is `whole` if it was not cut off.
    ///
    /// # Errors
    /// If no element was compared.
    pub fn end(&self, whole: bool, name: &str) -> Result<Option<Parting>> {
        let next = self.steps.get(self.same).map(|step| step.step);
        let ends = next.is_none() && whole && self.first.recording.closed;
        if !self.prefix && !ends && (self.same > 0 || next.is_some()) {
            return Ok(self.uneven([next, None], whole));
        }
        let mut items = self.steps[..self.same].iter().flat_map(|step| &step.arrays);
        if items.all(|item| item.shape.contains(&0)) {
            let place = self.first.place.display().to_string();
            let problem = format!("no element of a step of it was compared with one of {name}");
            return Err(Error::input(place, problem));
        }
        Ok(None)
    }
}

/// What can be said of a step at which two recordings differ, by the arrays that `kept` reads.
fn explain(
    equal: Option<u64>,
    steps: [&Step; 2],
    arrays: Vec<String>,
    kept: impl FnOnce() -> Result<[Option<Vec<Array>>; 2]>,
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
    let kept = kept()?;
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
