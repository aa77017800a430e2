//! A command that is asked for its arrays at one step after the other.
//!
//! It is started by the shell, and gets lines on its standard input: `goto N`, with N never below a step asked for
//! before. It goes on to step N and writes the frame of that step (see [`super::stream`]) to its standard output;
//! if its run ends before, the frame of its last step. When its standard input ends, it ends.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use bitgrain_sim::error::{Error, Result};

use super::stream::{Frame, Frames};

/// How often a request to stop is looked at.
const SLICE: Duration = Duration::from_millis(100);

/// How long a command that was told to end, or that closed its output, has for ending, in slices.
const GRACE: u64 = 10;

/// Most of what a command said that an error repeats, in bytes.
const WORDS: u64 = 2000;

/// How a command is dealt with.
#[derive(Clone, Debug)]
pub struct Patience {
    /// Seconds without a byte of an answer after which a command is given up.
    pub limit: u64,
    /// Set when the search is to stop.
    pub stop: Arc<AtomicBool>,
}

/// A command at work. It is ended, with all that it started, when this is dropped.
pub struct Running {
    text: String,
    child: Child,
    input: Option<ChildStdin>,
    frames: Frames<BufReader<Answers>>,
    told: File,
    patience: Patience,
    asked: u64,
}

impl Running {
    /// Starts a command by the shell.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no shell.
    pub fn start(text: &str, patience: &Patience) -> Result<Self> {
        let failed = |e: io::Error| Error::input(text, format!("cannot be started: {e}"));
        // Into a file: a pipe that nobody empties would block a command that says much.
        let told = tempfile::tempfile().map_err(failed)?;
        let stderr = told.try_clone().map_err(failed)?;
        let mut command = shell(text);
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(stderr);
        let mut child = command.spawn().map_err(failed)?;
        let input = child.stdin.take();
        let out = child
            .stdout
            .take()
            .ok_or_else(|| failed(io::ErrorKind::BrokenPipe.into()))?;
        let answers = Answers::of(out, patience.clone());
        Ok(Self {
            text: text.to_string(),
            child,
            input,
            frames: Frames::answers(BufReader::new(answers)),
            told,
            patience: patience.clone(),
            asked: 0,
        })
    }

    /// Asks for the frame of a step. If the command has ended, [`Running::frame`] says so.
    pub fn goto(&mut self, step: u64) {
        self.asked = step;
        if let Some(input) = &mut self.input {
            let _ = writeln!(input, "goto {step}").and_then(|()| input.flush());
        }
    }

    /// The frame that was asked for: of that step, or if the command's run ends before, of its last step.
    ///
    /// # Errors
    /// [`Error::Input`] for a command that ends, says what is no frame, or says nothing for too long;
    /// [`Error::Interrupted`].
    pub fn frame(&mut self) -> Result<Frame> {
        let frame = match self.frames.next_frame() {
            Ok(Some(frame)) => frame,
            Ok(None) => {
                return Err(
                    self.failed("it says `end`, which belongs at the end of a recording alone")
                );
            }
            Err(_) if self.patience.stop.load(Ordering::Relaxed) => {
                return Err(Error::Interrupted {
                    stage: "bisect".into(),
                    step: self.asked,
                    saved: false,
                });
            }
            Err(e) => return Err(self.failed(&e.to_string())),
        };
        if frame.step > self.asked {
            let problem = format!("it is at step {} already", frame.step);
            return Err(self.failed(&problem));
        }
        if frame.arrays.is_empty() {
            return Err(self.failed("its frame has no array"));
        }
        Ok(frame)
    }

    /// What the command did instead of answering, and how it ended and what it said if it has ended.
    fn failed(&mut self, what: &str) -> Error {
        let mut problem = format!("asked to `goto {}`: {what}", self.asked);
        // A pipe closes a moment before its process has ended.
        if let Some(status) = self.ended() {
            problem += &format!("; it ended with {status}");
        }
        let words = last_words(&mut self.told);
        if !words.is_empty() {
            problem += &format!("; it said: {words}");
        }
        Error::input(format!("`{}`", self.text), problem)
    }

    /// How the command ended, if it does soon.
    fn ended(&mut self) -> Option<std::process::ExitStatus> {
        for _ in 0..GRACE {
            if let Ok(Some(status)) = self.child.try_wait() {
                return Some(status);
            }
            thread::sleep(SLICE / 10);
        }
        None
    }
}

/// The end of what a command wrote into a file.
pub(crate) fn last_words(told: &mut File) -> String {
    let length = told.seek(io::SeekFrom::End(0)).unwrap_or(0);
    let mut bytes = Vec::new();
    let begin = told.seek(io::SeekFrom::Start(length.saturating_sub(WORDS)));
    let read = begin.and_then(|_| told.take(WORDS).read_to_end(&mut bytes));
    read.map_or(String::new(), |_| {
        String::from_utf8_lossy(&bytes).trim().to_string()
    })
}

impl Drop for Running {
    fn drop(&mut self) {
        // The end of its input ends a command that keeps to the protocol.
        self.input = None;
        for _ in 0..GRACE {
            if self.ended().is_some() {
                break;
            }
        }
        end_all(&mut self.child);
        let _ = self.child.wait();
    }
}

/// A command line as the shell takes it, in a group of processes of its own, so that all of it can be ended.
#[cfg(unix)]
fn shell(text: &str) -> Command {
    use std::os::unix::process::CommandExt;
    let mut command = Command::new("/bin/sh");
    command.args(["-c", text]).process_group(0);
    command
}

#[cfg(not(unix))]
fn shell(text: &str) -> Command {
    let mut command = Command::new("cmd");
    command.args(["/C", text]);
    command
}

/// Ends what is left of a command and of what it started.
#[cfg(unix)]
fn end_all(child: &mut Child) {
    use rustix::process::{Pid, Signal, kill_process_group};
    // The group has the number of its first process.
    let group = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    let _ = group.map(|group| kill_process_group(group, Signal::KILL));
}

#[cfg(not(unix))]
fn end_all(child: &mut Child) {
    let _ = child.kill();
}

/// What a command writes, read by a thread so that silence can be measured.
struct Answers {
    pieces: Receiver<io::Result<Vec<u8>>>,
    left: VecDeque<u8>,
    patience: Patience,
}

impl Answers {
    fn of(mut out: ChildStdout, patience: Patience) -> Self {
        // Few pieces: a command that writes without end waits, and memory does not fill.
        let (send, pieces) = sync_channel(4);
        thread::spawn(move || {
            loop {
                let mut piece = vec![0; 1 << 16];
                let read = out.read(&mut piece);
                let last = !matches!(read, Ok(count) if count > 0);
                let piece = read.map(|count| {
                    piece.truncate(count);
                    piece
                });
                if send.send(piece).is_err() || last {
                    return;
                }
            }
        });
        Self {
            pieces,
            left: VecDeque::new(),
            patience,
        }
    }
}

impl Read for Answers {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut slices = 0;
        while self.left.is_empty() {
            match self.pieces.recv_timeout(SLICE) {
                Ok(Ok(piece)) if piece.is_empty() => return Ok(0),
                Ok(Ok(piece)) => self.left = piece.into(),
                Ok(Err(e)) if e.kind() == io::ErrorKind::Interrupted => {}
                Ok(Err(e)) => return Err(e),
                Err(RecvTimeoutError::Disconnected) => return Ok(0),
                Err(RecvTimeoutError::Timeout) => {
                    slices += 1;
                    let limit = self.patience.limit;
                    if self.patience.stop.load(Ordering::Relaxed) {
                        return Err(io::Error::other("asked to stop"));
                    }
                    if slices >= limit.saturating_mul(10) {
                        let problem = format!("nothing came for {limit} s; --limit allows more");
                        return Err(io::Error::new(io::ErrorKind::TimedOut, problem));
                    }
                }
            }
        }
        self.left.read(into)
    }
}
