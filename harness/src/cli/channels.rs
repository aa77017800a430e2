//! The channels of a command: standard output, signals, and the limit on the size of files.

use std::io::Write;
use std::path::Path;
use std::sync::atomic::Ordering;
#[cfg(unix)]
use std::sync::{Arc, atomic::AtomicBool};
use std::time::{Duration, Instant};

use bitgrain_lab::plain::escaped;
use bitgrain_lab::progress::Progress;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::parts::Ranks;

/// Largest file that is read unless something else is said, unpacked, in MiB.
pub(super) const MAX_INPUT: u64 = 512;

/// Signals that come within this time are one request to stop.
const ONE_BREATH: Duration = Duration::from_millis(10);

/// A file that outgrows what the system allows (`ulimit -f`) ends the process by a signal, without a message; if
/// that is handled the write fails instead, and is reported.
#[cfg(unix)]
pub(super) fn heed_full_files() -> Result<()> {
    let heeded = Arc::new(AtomicBool::new(false));
    let registered = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, heeded);
    registered.map(|_| ()).map_err(Error::Output)
}

#[cfg(not(unix))]
pub(super) fn heed_full_files() -> Result<()> {
    Ok(())
}

/// Prints a text. A closed reader (`| head`) hides no verdict: the command goes on to its own end.
pub(super) fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout();
    let written = out
        .write_all(escaped(text).as_bytes())
        .and_then(|()| out.flush());
    match written {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(Error::Output),
    }
}

/// A path for printing.
pub(super) fn shown(path: &Path) -> String {
    escaped(&path.display().to_string())
}

/// Progress of a command whose stages stop at Ctrl-C or SIGTERM.
pub(super) fn stoppable(verbose: bool) -> Progress {
    let progress = Progress::new(verbose);
    let stop = progress.stop_flag();
    let mut first: Option<Instant> = None;
    // Without a handler the signal ends the process at once, which loses no file either.
    let _ = ctrlc::set_handler(move || {
        stop.store(true, Ordering::Relaxed);
        // Asked again: now. Schedulers and `timeout` send a signal to a process and to its group at once,
        // which is one request.
        if first.get_or_insert_with(Instant::now).elapsed() > ONE_BREATH {
            std::process::exit(130);
        }
    });
    progress
}

/// Threads to use: so many as asked for, or one for each processor.
pub(super) fn processors(asked: Option<u16>) -> usize {
    // Of processes that were started together each has its share of the machine.
    let processors = || match Ranks::joined() {
        Some(_) => 1,
        None => bitgrain_sim::threads::processors(),
    };
    asked.map_or_else(processors, usize::from)
}
