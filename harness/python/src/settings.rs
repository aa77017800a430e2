//! What a world is stepped with: threads and instructions.

use bitgrain::isa::Isa;
use pyo3::prelude::*;

use crate::errors::input;

/// Most threads.
const THREADS: usize = 1024;

/// Threads: so many as are asked for, or one for each processor.
///
/// # Errors
/// `InputError` for none or too many.
pub fn processors(asked: Option<usize>) -> PyResult<usize> {
    let threads = asked.unwrap_or_else(bitgrain::threads::processors);
    match (1..=THREADS).contains(&threads) {
        true => Ok(threads),
        false => Err(input(
            "threads",
            format!("is {threads}; expected 1 to {THREADS}"),
        )),
    }
}

/// The instructions that are asked for.
///
/// # Errors
/// `InputError` for what this machine has not.
pub fn registers(asked: Option<&str>) -> PyResult<Isa> {
    let names = [
        ("plain", Isa::Plain),
        ("avx2", Isa::Avx2),
        ("avx512", Isa::Avx512),
    ];
    let here = Isa::all();
    let Some(asked) = asked else {
        return Ok(Isa::best());
    };
    let found = names
        .iter()
        .find(|(name, isa)| *name == asked && here.contains(isa));
    found.map(|(_, isa)| *isa).ok_or_else(|| {
        let names = names
            .iter()
            .filter(|(_, isa)| here.contains(isa))
            .map(|(name, _)| *name);
        let names: Vec<&str> = names.collect();
        input(
            "instructions",
            format!("is {asked:?}; this machine has {}", names.join(", ")),
        )
    })
}
