//! Processes that a launcher of MPI programs started together: they share the steps of one run.

#[cfg(feature = "mpi")]
mod joined;

#[cfg(feature = "mpi")]
use joined::together;

use bitgrain_sim::parts::LAUNCHED;

/// Exit status if this process cannot do what it was started for.
#[cfg(not(feature = "mpi"))]
const REFUSED: u8 = 2;

/// Does a program's work once, in whatever number of processes it was started: the first does it, and the others do
/// parts of its steps. Returns the exit status. Processes that are not of one kind are named, with status 3.
pub fn once(work: impl FnOnce() -> u8) -> u8 {
    match started() {
        0 | 1 => work(),
        _ => together(work),
    }
}

/// How many processes were started together with this one, by what their launcher tells each.
fn started() -> usize {
    let sizes = LAUNCHED.iter().filter_map(|name| std::env::var(name).ok());
    let sizes = sizes.filter_map(|size| size.parse().ok());
    sizes.max().unwrap_or(1)
}

/// Refuses to do in every process what should be done once.
#[cfg(not(feature = "mpi"))]
fn together(_work: impl FnOnce() -> u8) -> u8 {
    eprintln!(
        "bitgrain: {} processes were started together, and each would do the whole command: this build knows no MPI. \
         Build it with `--features mpi`, or start one process",
        started()
    );
    REFUSED
}
