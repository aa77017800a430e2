//! Frames of arrays on a pipe: how any program hands over its arrays, to be recorded or compared.
//!
//! A frame is the line `step N`; for each array the line `array NAME TYPE SHAPE` and then the array's bytes,
//! little-endian, row by row, without a line feed after them; and the line `done`. After the last frame comes the line
//! `end`.

use std::collections::BTreeSet;
use std::io::{self, BufRead, Read};

use bitgrain_kernel::record::Chain;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

use super::array::{Array, ArrayRef, read_element, read_shape};
use super::parting::{Held, Parting};
use super::read::{Item, Step};
use super::recorder::Recorder;

/// Most bytes of a line; the longest that means something has 270.
const LINE: u64 = 1000;

/// The arrays of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// The step.
    pub step: u64,
    /// The arrays, in the order in which they came.
    pub arrays: Vec<Array>,
}

impl Frame {
    /// What a recording says of it.
    fn digests(&self) -> Step {
        let item = |array: &Array| Item {
            name: array.name.clone(),
            element: array.element,
            shape: array.shape.clone(),
            digest: *blake3::hash(&array.bytes).as_bytes(),
        };
        Step {
            step: self.step,
            arrays: self.arrays.iter().map(item).collect(),
        }
    }
}

/// Frames as they come from a source.
pub struct Frames<R> {
    source: R,
    name: String,
    lines: u64,
    /// What it means if the source ends.
    cut: &'static str,
    /// Whether it ended before the line `end`.
    ended: bool,
}

impl<R: BufRead> Frames<R> {
    /// Reads the frames of a whole run from a source, which errors call `name`.
    pub fn new(source: R, name: impl Into<String>) -> Self {
        Self {
            source,
            name: name.into(),
            lines: 0,
            cut: "has ended without the line `end`: the program that writes it has stopped, or does not write that",
            ended: false,
        }
    }

    /// Reads frames that a command writes when it is asked for them.
    pub fn answers(source: R) -> Self {
        let cut = "has ended: the answer is missing or cut off";
        Self {
            cut,
            ..Self::new(source, "its output")
        }
    }

    /// A line that does not belong there.
    fn wrong(&self, problem: impl Into<String>) -> Error {
        Error::input(format!("{}, line {}", self.name, self.lines), problem)
    }

    /// What happened instead of another line.
    fn instead(&self, problem: impl Into<String>) -> Error {
        match self.lines {
            0 => Error::input(&self.name, problem),
            lines => Error::input(format!("{}, after line {lines}", self.name), problem),
        }
    }

    fn failed(&self, e: &io::Error) -> Error {
        self.instead(match e.kind() {
            io::ErrorKind::TimedOut => e.to_string(),
            _ => format!("cannot be read: {e}"),
        })
    }

    /// The next line without its line feed; `None` if the source has ended.
    fn line(&mut self) -> Result<Option<String>> {
        let mut bytes = Vec::new();
        let read = self
            .source
            .by_ref()
            .take(LINE)
            .read_until(b'\n', &mut bytes);
        read.map_err(|e| self.failed(&e))?;
        if bytes.is_empty() {
            self.ended = true;
            return Ok(None);
        }
        self.lines += 1;
        if bytes.pop_if(|last| *last == b'\n').is_none() {
            self.ended = bytes.len() as u64 != LINE;
            let problem = match self.ended {
                true => "is cut off",
                false => {
                    "is no line of a frame: it has more than 1000 bytes; an array may have more bytes than its \
                         shape says"
                }
            };
            return Err(self.wrong(problem));
        }
        // Pipes of Windows end lines with two characters.
        let _ = bytes.pop_if(|last| *last == b'\r');
        let text = String::from_utf8(bytes);
        text.map(Some).map_err(|_| {
            self.wrong(
                "is no text: an array before it may have fewer or more bytes than its shape says",
            )
        })
    }

    /// Reads what is left when every frame was read: nothing.
    ///
    /// # Errors
    /// [`Error::Input`] with the line that is there.
    fn over(&mut self, after: &str) -> Result<()> {
        match self.line()? {
            None => Ok(()),
            Some(line) => Err(self.wrong(format!("is `{}` after {after}", begin(&line)))),
        }
    }

    /// Reads what is left after the last answer: nothing, or the line `end`.
    ///
    /// # Errors
    /// [`Error::Input`] with the line that is there.
    pub fn finish(&mut self) -> Result<()> {
        match self.line()? {
            None => Ok(()),
            Some(line) if line == "end" => self.over("the line `end`"),
            Some(line) => Err(self.wrong(format!("is `{}` after the last answer", begin(&line)))),
        }
    }

    /// The next frame; `None` after the line `end`.
    ///
    /// # Errors
    /// [`Error::Input`] with the line that does not belong there, or if the source ends before its `end`.
    pub fn next_frame(&mut self) -> Result<Option<Frame>> {
        let Some(line) = self.line()? else {
            return Err(self.instead(self.cut));
        };
        if line == "end" {
            return Ok(None);
        }
        let step = line
            .strip_prefix("step ")
            .and_then(|step| step.parse().ok());
        let step = step.ok_or_else(|| {
            self.wrong(format!(
                "is `{}`; expected `step NUMBER` or `end`",
                begin(&line)
            ))
        })?;
        let mut arrays: Vec<Array> = Vec::new();
        let mut names = BTreeSet::new();
        loop {
            let Some(line) = self.line()? else {
                return Err(self.instead(self.cut));
            };
            if line == "done" {
                return Ok(Some(Frame { step, arrays }));
            }
            let array = self.array(&line)?;
            if !names.insert(array.name.clone()) {
                return Err(self.wrong(format!(
                    "names `{}` a second time at step {step}",
                    array.name
                )));
            }
            arrays.push(array);
        }
    }

    /// The array that a line announces.
    fn array(&mut self, line: &str) -> Result<Array> {
        let mut words = line.split(' ');
        let (first, name, element) = (words.next(), words.next(), words.next());
        let (Some("array"), Some(name), Some(element)) = (first, name, element) else {
            let told = begin(line);
            return Err(self.wrong(format!(
                "is `{told}`; expected `array NAME TYPE SHAPE` or `done`"
            )));
        };
        let element = read_element(element).map_err(|what| self.wrong(what))?;
        let shape: Vec<&str> = words.collect();
        let (shape, count) =
            read_shape(element, &shape.join(" ")).map_err(|what| self.wrong(what))?;
        let named = Chain::new().add_digest(0, name, element, &shape, &[0; 32]);
        named.map_err(|refusal| self.wrong(format!("`{}`: {refusal}", begin(name))))?;
        if count as u64 > disk::most() {
            let most = disk::most() >> 20;
            return Err(self.wrong(format!(
                "announces an array of {count} bytes; at most {most} MiB are read, more with --max-input"
            )));
        }
        let mut bytes = Vec::new();
        let read = self
            .source
            .by_ref()
            .take(count as u64)
            .read_to_end(&mut bytes);
        read.map_err(|e| self.failed(&e))?;
        if bytes.len() < count {
            self.ended = true;
            let there = bytes.len();
            return Err(self.wrong(format!(
                "announces an array of {count} bytes, of which {there} came before the end"
            )));
        }
        Ok(Array {
            name: name.to_string(),
            element,
            shape,
            bytes,
        })
    }
}

/// The beginning of a line, for an error.
fn begin(line: &str) -> String {
    line.chars().take(60).collect()
}

/// Records all frames of a source, whose steps are compared with those of another recording if there is one; returns
/// how many there were, and where the two part. At the first difference nothing more is read. The recorder is not
/// closed.
///
/// # Errors
/// As [`Frames::next_frame`], [`Recorder::record`] and [`Held::next`]; what came before is recorded.
pub fn record_all(
    source: impl BufRead,
    name: &str,
    recorder: &mut Recorder,
    mut held: Option<&mut Held<'_>>,
) -> Result<(u64, Option<Parting>)> {
    let mut frames = Frames::new(source, name);
    let mut count = 0;
    loop {
        let frame = match frames.next_frame() {
            Ok(Some(frame)) => frame,
            Ok(None) => {
                frames.over("the line `end`")?;
                return Ok((count, None));
            }
            Err(cut) => {
                let held = held.filter(|_| frames.ended);
                let parting = held.and_then(|held| held.end(false, name).ok().flatten());
                let Some(mut parting) = parting else {
                    return Err(cut);
                };
                parting.hint = parting.hint.map(|hint| format!("{hint}\n  {cut}"));
                return Ok((count, Some(parting)));
            }
        };
        let arrays: Vec<(&str, ArrayRef<'_>)> = frame
            .arrays
            .iter()
            .map(|a| (a.name.as_str(), a.lent()))
            .collect();
        let recorded = recorder.record(frame.step, &arrays);
        recorded.map_err(|e| match e {
            Error::Input { .. } => frames.wrong(e.to_string()),
            other => other,
        })?;
        count += 1;
        if let Some(held) = &mut held {
            let step = frame.digests();
            if let Some(parting) = held.next(&step, || Ok(Some(frame.arrays)))? {
                return Ok((count, Some(parting)));
            }
        }
    }
}
