//! Benchmarks that others published: their cases under our laws, beside theory and the published points.
//!
//! Nothing is fitted. A [`Check`] holds our numbers to theory where the law is exact, and must hold; a [`Comparison`]
//! says how far they are from points of others, and is no verdict.

mod chung_ooi;
mod comparison;
mod result;

pub use result::{Benchmark, Chart, Check, Comparison, Curve, Source, Test};

use bitgrain_sim::error::{Error, Result};

/// A benchmark: its name, what it is in one line, and what runs it.
struct Known {
    name: &'static str,
    about: &'static str,
    run: fn() -> Result<Benchmark>,
}

const KNOWN: [Known; 1] = [Known {
    name: "chung-ooi",
    about: "eight tests of single impacts, elastic to oblique and spinning (Chung and Ooi 2011); seconds",
    run: chung_ooi::run,
}];

/// Names of all benchmarks, and what each is in one line.
pub fn list() -> impl Iterator<Item = (&'static str, &'static str)> {
    KNOWN.iter().map(|known| (known.name, known.about))
}

/// Runs the benchmark of this name.
///
/// # Errors
/// [`Error::Input`] with the names there are, if this is none of them; [`Error::Run`] if a case stops.
pub fn run(name: &str) -> Result<Benchmark> {
    match KNOWN.iter().find(|known| known.name == name) {
        Some(known) => (known.run)(),
        None => {
            let names: Vec<&str> = list().map(|(name, _)| name).collect();
            let problem = format!("is no benchmark; there are: {}", names.join(", "));
            Err(Error::input(name, problem))
        }
    }
}
