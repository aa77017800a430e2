//! Where two commands part: both are run side by side, and asked for their arrays at every step or at some.

use std::collections::BTreeMap;

use bitgrain_kernel::record::Chain;
use bitgrain_sim::error::{Error, Result};

use super::command::{Patience, Running};
use super::difference::{Difference, difference, differing};
use super::parting::Parting;
use super::stream::Frame;

/// Into how many parts the steps between two frames are divided when they are looked at again.
const PARTS: u64 = 16;

/// If a command gives other arrays when it is started again.
const UNSTEADY: &str = "what it computes depends on more than the step (threads, a clock, a seed, memory that was not \
                        set); without --every each step of one execution is compared, and nothing is started again";

/// Two commands and how far they are compared.
#[derive(Clone, Debug)]
pub struct Commands {
    /// Command lines for the shell; see [`super::command`] for what they are asked.
    pub texts: [String; 2],
    /// The last step that is compared; without it, until both end.
    pub to: Option<u64>,
    /// Steps between the frames of the first execution, at least 1.
    pub every: u64,
    /// Whether the run of one may end before that of the other.
    pub prefix: bool,
    /// How long an answer may take, and how the search is stopped.
    pub patience: Patience,
}

/// What an execution of both showed.
enum Seen {
    /// Every frame was the same.
    Same,
    /// One run ended before the other.
    Uneven { equal: Option<u64>, ends: [u64; 2] },
    /// Two frames of one step differ.
    Differ {
        equal: Option<u64>,
        frames: [Frame; 2],
    },
}

/// Finds where two commands part; `None` if all frames that were compared are the same and both runs end with one step,
/// or reach the last that is compared. If every step is compared, what is found is the first step that differs, and
/// each command is executed once. Else both are executed again for the steps between two frames, at a sixteenth of
/// their distance, then of that, until two frames are neighbours; a difference that goes away again before the next
/// frame is not seen. `say` reports what is being done.
///
/// # Errors
/// [`Error::Input`] for a command that does not answer as it should, [`Error::Unverified`] for one whose arrays are
/// others when it is started again, and for two that end before the last step that is asked for, or at once;
/// [`Error::Interrupted`].
pub fn search(commands: &Commands, say: impl FnMut(&str) -> Result<()>) -> Result<Option<Parting>> {
    let mut search = Search {
        commands,
        known: BTreeMap::new(),
        elements: false,
        say,
    };
    search.run()
}

struct Search<'a, S> {
    commands: &'a Commands,
    /// Digests of all frames so far, by side and step.
    known: BTreeMap<(usize, u64), [u8; 32]>,
    /// Whether an array that was compared has an element.
    elements: bool,
    say: S,
}

impl<S: FnMut(&str) -> Result<()>> Search<'_, S> {
    fn run(&mut self) -> Result<Option<Parting>> {
        let (to, every) = (self.commands.to, self.commands.every);
        let mut seen = self.execute(first_steps(to, every))?;
        let mut uneven = None;
        if let Seen::Uneven { equal, ends } = seen {
            let [first, second] = ends;
            (self.say)(&format!(
                "the first is at step {first} when the second is at step {second}: one run ends before the other"
            ))?;
            let last = first.min(second);
            let next = ends.map(|end| (end > last).then_some(last.saturating_add(1)));
            uneven = Some(Parting::uneven(Some(last), next, [true; 2]));
            seen = match equal {
                Some(equal) if equal == last => Seen::Same,
                _ => self.execute(equal.into_iter().chain([last]))?,
            };
        }
        loop {
            let (equal, frames) = match seen {
                Seen::Same => return self.same(uneven),
                Seen::Differ { equal, frames } => (equal, frames),
                // Digests of both frames are known, so an execution that is another was told before.
                Seen::Uneven { .. } => {
                    return Err(Error::Unverified {
                        problem:
                            "one of the commands ended at another step when it was started again"
                                .into(),
                        hint: UNSTEADY,
                    });
                }
            };
            let step = frames[0].step;
            let Some(from) = equal.filter(|equal| step - equal > 1) else {
                return Ok(Some(parting(equal, &frames)));
            };
            (self.say)(&format!(
                "the same at step {from}, different at step {step}: the steps between, again"
            ))?;
            let stride = ((step - from) / PARTS).max(1) as usize;
            seen = self.execute((from..step).step_by(stride).chain([step]))?;
        }
    }

    /// What it means that all frames of both are the same, and one may be `uneven`.
    fn same(&self, uneven: Option<Parting>) -> Result<Option<Parting>> {
        match uneven {
            Some(parting) if !self.commands.prefix => Ok(Some(parting)),
            Some(parting) if parting.equal == Some(0) => {
                Err(short("no step after step 0 was compared".into()))
            }
            _ if !self.elements => Err(short("no array that was compared has an element".into())),
            _ => Ok(None),
        }
    }

    /// Runs both commands from their beginning and compares them at some steps, until they differ or end.
    fn execute(&mut self, steps: impl Iterator<Item = u64>) -> Result<Seen> {
        let commands = self.commands;
        let start = |side: usize| Running::start(&commands.texts[side], &commands.patience);
        let mut pair = [start(0)?, start(1)?];
        let mut equal = None;
        for step in steps {
            // Both at work at once.
            for running in &mut pair {
                running.goto(step);
            }
            let frames = [pair[0].frame()?, pair[1].frame()?];
            for (side, frame) in frames.iter().enumerate() {
                self.check(side, frame, equal)?;
            }
            let [one, other] = &frames;
            if one.step != other.step {
                let ends = [one.step, other.step];
                if commands.prefix {
                    pair.into_iter().try_for_each(Running::finish)?;
                }
                return Ok(Seen::Uneven { equal, ends });
            }
            if !differing(&one.arrays, &other.arrays, |array| &array.name).is_empty() {
                return Ok(Seen::Differ { equal, frames });
            }
            self.elements |= one.arrays.iter().any(|array| !array.bytes.is_empty());
            equal = Some(one.step);
            if one.step < step {
                let ends = format!("both end at step {}", one.step);
                (self.say)(&ends)?;
                match commands.to {
                    _ if one.step == 0 => {
                        return Err(short(format!("{ends}, and none after that was compared")));
                    }
                    Some(to) if !commands.prefix => {
                        return Err(short(format!("{ends}, and step {to} was asked for")));
                    }
                    _ => break,
                }
            }
        }
        pair.into_iter().try_for_each(Running::finish)?;
        Ok(Seen::Same)
    }

    /// A frame has the step it should and, in another execution, the same arrays.
    fn check(&mut self, side: usize, frame: &Frame, before: Option<u64>) -> Result<()> {
        let (text, step) = (&self.commands.texts[side], frame.step);
        let place = || format!("`{text}`");
        if let Some(before) = before.filter(|before| step < *before) {
            let problem = format!("answers with step {step} after step {before}: steps ascend");
            return Err(Error::input(place(), problem));
        }
        // Only if they are started again is there anything to compare with.
        if self.commands.every == 1 {
            return Ok(());
        }
        let mut chain = Chain::new();
        for array in &frame.arrays {
            let digest = blake3::hash(&array.bytes);
            let line = chain.add_digest(
                step,
                &array.name,
                array.element,
                &array.shape,
                digest.as_bytes(),
            );
            line.map_err(|refusal| {
                Error::input(place(), format!("array `{}`: {refusal}", array.name))
            })?;
        }
        let digest = *chain.link();
        if *self.known.entry((side, step)).or_insert(digest) != digest {
            return Err(Error::Unverified {
                problem: format!(
                    "`{text}` gave other arrays at step {step} when it was started again"
                ),
                hint: UNSTEADY,
            });
        }
        Ok(())
    }
}

/// Two commands of which less was compared than a confirmation needs.
fn short(problem: String) -> Error {
    Error::Unverified {
        problem,
        hint: "see that they go on when they are asked to; --prefix takes what there is",
    }
}

/// The steps of the first execution.
fn first_steps(to: Option<u64>, every: u64) -> impl Iterator<Item = u64> {
    let last = to.unwrap_or(u64::MAX);
    let next = move |step: &u64| step.checked_add(every.max(1));
    let steps = std::iter::successors(Some(0), next).take_while(move |step| *step < last);
    steps.chain([last])
}

fn parting(equal: Option<u64>, frames: &[Frame; 2]) -> Parting {
    let [one, other] = frames;
    let arrays = differing(&one.arrays, &other.arrays, |array| &array.name);
    let named = |frame: &'_ Frame| {
        frame
            .arrays
            .iter()
            .position(|array| array.name == arrays[0])
    };
    let difference = match (named(one), named(other)) {
        (Some(i), Some(j)) => difference(&one.arrays[i], &other.arrays[j]),
        (first, _) => Some(Difference::Missing {
            first_has: first.is_some(),
        }),
    };
    Parting {
        equal,
        step: one.step,
        arrays,
        difference,
        hint: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_step_is_one_of_the_first_execution() {
        let steps = |to, every| first_steps(to, every).take(4).collect::<Vec<_>>();
        assert_eq!(steps(None, 1), [0, 1, 2, 3]);
        assert_eq!(steps(Some(25), 10), [0, 10, 20, 25]);
        assert_eq!(steps(Some(20), 10), [0, 10, 20]);
        assert_eq!(steps(Some(0), 1), [0]);
        assert_eq!(steps(None, u64::MAX), [0, u64::MAX]);
    }
}
