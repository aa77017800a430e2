//! Whether there is memory for what the numbers of a file ask for, before it is filled.

use crate::error::{Error, Result};

/// Bytes of memory a grain takes, from beds of 10,000 and 70,000 grains.
pub const PER_GRAIN: f64 = 510.0;

/// The same where several threads step one bed: 2.1 times as many bytes are kept, measured with two.
pub const PER_GRAIN_ON_THREADS: f64 = 2.1 * PER_GRAIN;

/// Asks for this many bytes at once and gives them back; what is then taken piece by piece is likely to be available.
///
/// # Errors
/// [`Error::Memory`] if the system does not provide them; `what` they are for.
pub fn room(bytes: f64, what: &str) -> Result<()> {
    let mut trial: Vec<u8> = Vec::new();
    // A number that is too large becomes the largest, which no machine has.
    match trial.try_reserve_exact(bytes as usize) {
        Ok(()) => Ok(()),
        Err(_) => Err(Error::Memory {
            what: what.to_string(),
            bytes,
        }),
    }
}

/// The most memory that this process ever held, in bytes, as Linux reports it; elsewhere nothing.
pub fn peak() -> Option<f64> {
    reported("/proc/self/status", "VmHWM:")
}

/// The memory of this machine, in bytes, as Linux reports it; elsewhere nothing.
pub fn of_machine() -> Option<f64> {
    reported("/proc/meminfo", "MemTotal:")
}

/// A number of kilobytes in a file of the system.
fn reported(file: &str, name: &str) -> Option<f64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024.0 * kilobytes)
}
