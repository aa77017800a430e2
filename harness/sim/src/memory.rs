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
