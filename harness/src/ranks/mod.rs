//! Processes that a launcher of MPI programs started together: they share the steps of one run.

#[cfg(feature = "mpi")]
mod joined;

#[cfg(feature = "mpi")]
pub use joined::together;

/// Exit status if this process cannot do what it was started for.
#[cfg(not(feature = "mpi"))]
const REFUSED: u8 = 2;

/// How many processes were started together with this one, by what their launcher tells each.
pub fn started() -> usize {
    let told = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"];
    let sizes = told.iter().filter_map(|name| std::env::var(name).ok());
    let sizes = sizes.filter_map(|size| size.parse().ok());
    sizes.max().unwrap_or(1)
}

/// Refuses to do in every process what should be done once.
#[cfg(not(feature = "mpi"))]
pub fn together(_command: impl FnOnce() -> u8) -> u8 {
    eprintln!(
        "bitgrain: {} processes were started together, and each would do the whole command: this build knows no MPI. \
         Build it with `--features mpi`, or start one process",
        started()
    );
    REFUSED
}
