//! A command that is asked for its arrays at one step after the other.
//!
//! It is started by the shell, and gets lines on its standard input: `goto N`, with N never below a step asked for
//! before. It goes on to step N and writes the frame of that step (see [`super::stream`]) to its standard output;
//! if its run ends before, the frame of its last step. When its standard input ends, it ends.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::threads::builder;

use super::stream::{Frame, Frames};

/// How often a request to stop is looked at.
const SLICE: Duration = Duration::from_millis(100);

/// How long to wait before it is looked again whether a command has ended.
const LOOK: Duration = Duration::from_millis(10);

/// So many looks are a second: as long as a command that was given up has for ending by itself.
const SECOND: u64 = 100;

/// The variable by which processes that a command started are known, with a value of its own for each command.
const MARK: &str = "BITGRAIN_COMMAND";

/// How often what a command started is looked for.
#[cfg(unix)]
const ROUNDS: usize = 10;

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
    /// Its value of [`MARK`].
    mark: String,
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
        static STARTED: AtomicU64 = AtomicU64::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let mark = format!("{}-{number}", std::process::id());
        let mut command = shell(text);
        command
            .env(MARK, &mark)
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
            mark,
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
                return Err(self.interrupted());
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

    /// Ends the input of a command that has answered for the last time, and waits for its end.
    ///
    /// # Errors
    /// [`Error::Input`] for a command that says more than the line `end`, ends with another status than 0, or not
    /// within the time that an answer may take; [`Error::Interrupted`].
    pub fn finish(mut self) -> Result<()> {
        self.input = None;
        let limit = self.patience.limit;
        let status = self.ended(limit.saturating_mul(SECOND));
        if self.patience.stop.load(Ordering::Relaxed) {
            return Err(self.interrupted());
        }
        let after = format!("after its answer to `goto {}`", self.asked);
        let Some(status) = status else {
            let problem = format!(
                "{after} its input was ended, and it did not end within {limit} s; --limit allows more"
            );
            return Err(self.told(problem));
        };
        // What it left behind may hold its output open.
        end_all(&mut self.child, &self.mark);
        if !status.success() {
            return Err(self.told(format!("{after} it ended with {status}")));
        }
        let rest = self.frames.finish();
        rest.map_err(|e| self.told(e.to_string()))
    }

    /// What the command did instead of answering, and how it ended and what it said if it has ended.
    fn failed(&mut self, what: &str) -> Error {
        let mut problem = format!("asked to `goto {}`: {what}", self.asked);
        // A pipe closes a moment before its process has ended.
        if let Some(status) = self.ended(SECOND / 10) {
            problem += &format!("; it ended with {status}");
        }
        self.told(problem)
    }

    fn interrupted(&self) -> Error {
        Error::Interrupted {
            stage: "bisect".into(),
            step: self.asked,
            saved: false,
        }
    }

    /// A problem of this command, with what it said.
    fn told(&mut self, mut problem: String) -> Error {
        let words = last_words(&mut self.told);
        if !words.is_empty() {
            problem += &format!("; it said: {words}");
        }
        Error::input(format!("`{}`", self.text), problem)
    }

    /// How the command ended, if it does within so many looks and nobody asks to stop.
    fn ended(&mut self, looks: u64) -> Option<ExitStatus> {
        for _ in 0..looks {
            if let Ok(Some(status)) = self.child.try_wait() {
                return Some(status);
            }
            if self.patience.stop.load(Ordering::Relaxed) {
                return None;
            }
            thread::sleep(LOOK);
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
        self.ended(SECOND);
        end_all(&mut self.child, &self.mark);
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
fn end_all(child: &mut Child, mark: &str) {
    use rustix::process::{Pid, Signal, kill_process, kill_process_group};
    // The group has the number of its first process.
    let group = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    let _ = group.map(|group| kill_process_group(group, Signal::KILL));
    // Again, for what started another one while it was looked for.
    for _ in 0..ROUNDS {
        let left = marked(mark);
        if left.is_empty() {
            break;
        }
        for process in left.into_iter().filter_map(Pid::from_raw) {
            let _ = kill_process(process, Signal::KILL);
        }
    }
}

#[cfg(not(unix))]
fn end_all(child: &mut Child, _: &str) {
    let _ = child.kill();
}

/// Processes that have this value of [`MARK`]: also those that left the group of the command that started them. Where
/// there is no /proc none are found.
#[cfg(unix)]
fn marked(mark: &str) -> Vec<i32> {
    use bitgrain_sim::disk;
    use std::path::Path;
    let wanted = format!("{MARK}={mark}");
    let is_marked = |process: &i32| {
        let environment = Path::new("/proc").join(format!("{process}/environ"));
        let environment = disk::read(&environment).unwrap_or_default();
        let mut variables = environment.split(|byte| *byte == 0);
        variables.any(|variable| variable == wanted.as_bytes())
    };
    let entries = disk::list(Path::new("/proc")).unwrap_or_default();
    let processes = entries.iter().filter_map(|(name, _)| name.parse().ok());
    processes.filter(is_marked).collect()
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
        let reads = move || {
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
        };
        builder().spawn(reads).expect("a thread to read with");
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
