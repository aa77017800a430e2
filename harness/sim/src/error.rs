//! Errors of the harness: what, where, why and what to do, and the exit status each ends with.

use crate::threads::ThreadsError;
use std::path::{Path, PathBuf};

use bitgrain_kernel::Error as KernelError;
use thiserror::Error;

/// What the message of an interrupted run adds.
const SAVED: &str = "; it is saved: the same command goes on from there, and so does `bitgrain run --resume` \
                     with the run's folder";

/// If results are not those of their scenario.
pub const CHANGED: &str = "the files were changed, or made by another build or on a machine that does not \
                                  keep the bit contract (`bitgrain selftest` checks it); `bitgrain bisect` finds where \
                                  two runs part";

/// If a run is not the one that was expected.
pub const UNEXPECTED: &str = "this is not the run that the expected hash was taken from, or \
                                     the hash was copied wrongly";

/// Why a command ended without its result.
#[derive(Debug, Error)]
pub enum Error {
    /// The input was refused before anything ran.
    #[error("{place}: {problem}")]
    Input {
        /// File, with line or key if there is one.
        place: String,
        /// What is wrong, what was expected, and what to do.
        problem: String,
    },
    /// A checkpoint that is not whole: changed or cut off since it was written.
    #[error("{place}: not a whole checkpoint: {problem}")]
    Damaged {
        /// The file.
        place: String,
        /// What does not fit.
        problem: String,
    },
    /// A manifest that is not whole: changed or cut off since it was written.
    #[error(
        "{place}: not a sound manifest: {problem}; `bitgrain run --resume FOLDER`, or for a campaign `bitgrain \
         sweep` with its --out, makes again what it vouched for"
    )]
    Manifest {
        /// The file.
        place: String,
        /// What does not fit.
        problem: String,
    },
    /// A run failed and stopped at a step.
    #[error("{stage} stopped at step {step}: {fault}{hint}")]
    Run {
        /// Which stage of which run.
        stage: String,
        /// The step that failed; 0 if the start did.
        step: u64,
        /// What the kernel found.
        fault: KernelError,
        /// What to look at next.
        hint: String,
    },
    /// A settled bed does not allow what the scenario asks for, which only pouring it shows.
    #[error("{place}: {problem}")]
    Unfit {
        /// Scenario and key.
        place: String,
        /// What is wrong, what was expected, and what to do.
        problem: String,
    },
    /// A bed did not come to rest.
    #[error(
        "{bed} did not settle: after {step} steps its kinetic energy per grain is {energy:.2e} (to be \
         below {bound:.0e}) and {carried:.4} of its weight is carried (to be within 0.0005 of 1); \
         if the first is wrong raise bed.settled or the friction, or lower drag.dt if the energy has long stopped \
         falling; if the second is, see that the grains have a base or a floor under them"
    )]
    Unsettled {
        /// Which bed.
        bed: String,
        /// Steps done.
        step: u64,
        /// Kinetic energy per free grain over its weight times diameter.
        energy: f64,
        /// The scenario's bound.
        bound: f64,
        /// Upward force of base, planes and intruder over the weight.
        carried: f64,
    },
    /// A run that was executed again did not give what was written.
    #[error("{problem}: {hint}")]
    Unverified {
        /// What does not hold.
        problem: String,
        /// What may be the cause, and what to do.
        hint: &'static str,
    },
    /// Runs of a campaign failed.
    #[error(
        "{failed} of {} runs failed: the column `reason` of {} says why; --retry tries them again",
        failed + done, table.display()
    )]
    Failed {
        /// How many.
        failed: usize,
        /// How many did not.
        done: usize,
        /// The table.
        table: PathBuf,
    },
    /// Two runs differ, as was reported.
    #[error("the runs differ")]
    Parted,
    /// The command was asked to stop, as by Ctrl-C.
    #[error("{stage} interrupted at step {step}{}", if *.saved { SAVED } else { "" })]
    Interrupted {
        /// Which stage of which run.
        stage: String,
        /// Steps done.
        step: u64,
        /// Whether it was saved, so that it can be continued.
        saved: bool,
    },
    /// This machine or this build does not keep the bit contract.
    #[error(
        "this machine does not keep the bit contract: {problem}; no result of it can be trusted: see \
         what the process is linked with, its compiler flags and the processor's modes"
    )]
    Contract {
        /// What was found.
        problem: String,
    },
    /// There is not enough memory.
    #[error(
        "{what}: {} of memory are needed, more than there is; ask for less (fewer grains, points or runs side by \
         side: --threads, --jobs), or take a larger machine", crate::format::bytes(*.bytes)
    )]
    Memory {
        /// What it is for.
        what: String,
        /// How many bytes.
        bytes: f64,
    },
    /// A file could not be written.
    #[error("cannot write {path}: {source}; {hint}", hint = write_hint(source))]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// Standard output was closed.
    #[error("cannot write to standard output: {0}")]
    Output(std::io::Error),
}

impl From<ThreadsError> for Error {
    fn from(why: ThreadsError) -> Self {
        match why {
            ThreadsError::Start { .. } => Self::input("--threads", why.to_string()),
            ThreadsError::Arithmetic(fault) => Self::run("a thread", 0, fault),
        }
    }
}

impl Error {
    /// 2 for refused input, 3 for a run or a machine that failed, 1 for output that could not be
    /// written, 130 for a command that was interrupted.
    pub fn exit_status(&self) -> u8 {
        match self {
            Error::Input { .. }
            | Error::Damaged { .. }
            | Error::Manifest { .. }
            | Error::Unfit { .. } => 2,
            Error::Run { .. }
            | Error::Unsettled { .. }
            | Error::Unverified { .. }
            | Error::Failed { .. }
            | Error::Parted
            | Error::Memory { .. }
            | Error::Contract { .. } => 3,
            Error::Write { .. } | Error::Output(_) => 1,
            Error::Interrupted { .. } => 130,
        }
    }

    /// Whether grains and scenario alone are the cause, so that every machine ends with it again: not a file, not the
    /// memory.
    pub fn is_physical(&self) -> bool {
        match self {
            Error::Run { fault, .. } => hint(*fault) != FULL,
            Error::Unsettled { .. } | Error::Unfit { .. } => true,
            _ => false,
        }
    }

    /// The message without the place at its beginning.
    pub fn describe_at(&self, place: &str) -> String {
        let text = self.to_string();
        let rest = text.strip_prefix(&format!("{place}: "));
        rest.map_or(text.clone(), String::from)
    }

    /// The same, with the stage as saved if it is an interruption.
    pub fn saved(mut self) -> Self {
        if let Error::Interrupted { saved, .. } = &mut self {
            *saved = true;
        }
        self
    }

    /// Input refused at a place.
    pub fn input(place: impl Into<String>, problem: impl Into<String>) -> Self {
        Error::Input {
            place: place.into(),
            problem: problem.into(),
        }
    }

    /// A file that cannot be read.
    pub fn read(path: &Path, source: &std::io::Error) -> Self {
        Error::input(
            path.display().to_string(),
            format!("cannot be read: {source}; check the name and its permissions"),
        )
    }

    /// A file that cannot be written.
    pub fn write(path: &Path, source: std::io::Error) -> Self {
        Error::Write {
            path: path.to_path_buf(),
            source,
        }
    }

    /// A run that the kernel stopped.
    pub fn run(stage: impl Into<String>, step: u64, fault: KernelError) -> Self {
        if let KernelError::Arithmetic { flaw } = fault {
            let problem = flaw.to_string();
            return Error::Contract { problem };
        }
        Error::Run {
            stage: stage.into(),
            step,
            fault,
            hint: hint(fault).into(),
        }
    }
}

fn write_hint(source: &std::io::Error) -> &'static str {
    use std::io::ErrorKind as Kind;
    match source.kind() {
        Kind::StorageFull | Kind::QuotaExceeded => {
            "free some space, then give the same command again"
        }
        Kind::FileTooLarge => {
            "files may not be so long here: raise the limit (`ulimit -f`) or choose another file system, then give \
             the same command again"
        }
        Kind::PermissionDenied | Kind::ReadOnlyFilesystem => {
            "choose a folder that you may write to (--out, --beds)"
        }
        Kind::NotADirectory | Kind::IsADirectory | Kind::AlreadyExists => {
            "something else has that name: move it away or choose another folder (--out, --beds)"
        }
        _ => "see that the folder can be written to, or choose another (--out, --beds)",
    }
}

/// What to do about lists that may not grow as long as they should.
pub const FULL: &str = "; that is more than there is memory for, or than bodies have that do not lie in each \
                               other: look for many in one place, or for sizes that differ by many orders";

fn hint(fault: KernelError) -> &'static str {
    match fault {
        KernelError::ObstacleTooDeep { .. } => {
            "; in a scenario obstacle 0 is the intruder and 1 the floor; bodies this deep in each other \
             come from too fast an intruder, too soft a contact or too long a time step"
        }
        KernelError::OverlapTooDeep { .. } => {
            "; grains this deep in each other come from a bad start, too soft a contact or too long a time step"
        }
        KernelError::PairListFull { .. }
        | KernelError::OuterListFull { .. }
        | KernelError::ObstacleContactsFull { .. } => FULL,
        KernelError::Escaped { .. } => "; make the box higher, or see what pushed the grain out",
        KernelError::TooFast { .. } | KernelError::NotFinite { .. } => {
            "; look for overlaps at the start, or take a shorter time step"
        }
        _ => "",
    }
}

/// The result of most things here.
pub type Result<T> = std::result::Result<T, Error>;
