//! Benchmarks that others published: their cases under our laws, beside theory and the published points.
//!
//! Nothing is fitted. A [`Check`] holds our numbers to theory where the law is exact, and must hold; a [`Comparison`]
//! says how far they are from points of others, and is no verdict.

mod chung_ooi;
mod comparison;
mod dosta_impact;
mod request;
mod result;

pub use request::Request;
pub use result::{Benchmark, Chart, Check, Comparison, Curve, Source, Test};

use bitgrain_sim::error::{Error, Result};

/// A benchmark: its name, what it is in one line, which options it takes, and what runs it.
struct Known {
    name: &'static str,
    about: &'static str,
    has_options: bool,
    run: fn(&Request) -> Result<Benchmark>,
}

const KNOWN: [Known; 2] = [
    Known {
        name: "chung-ooi",
        about: "eight tests of single impacts, elastic to oblique and spinning (Chung and Ooi 2011); seconds",
        has_options: false,
        run: |_| chung_ooi::run(),
    },
    Known {
        name: "dosta-impact",
        about: "a steel ball hits 25,000 grains, at two values of g (Dosta et al. 2024); minutes",
        has_options: true,
        run: dosta_impact::run,
    },
];

/// Names of all benchmarks, and what each is in one line.
pub fn list() -> impl Iterator<Item = (&'static str, &'static str)> {
    KNOWN.iter().map(|known| (known.name, known.about))
}

/// Runs a benchmark.
///
/// # Errors
/// [`Error::Input`] with the names there are, if this is none of them, or of an option that it does not take;
/// [`Error::Run`] if a case stops; [`Error::Interrupted`].
pub fn run(request: &Request) -> Result<Benchmark> {
    let name = request.name;
    let Some(known) = KNOWN.iter().find(|known| known.name == name) else {
        let names: Vec<&str> = list().map(|(name, _)| name).collect();
        let problem = format!("is no benchmark; there are: {}", names.join(", "));
        return Err(Error::input(name, problem));
    };
    let options = [
        ("--start", request.start.is_some()),
        ("--grains", request.grains.is_some()),
        ("--until", request.until.is_some()),
    ];
    match options.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) if !known.has_options => {
            let problem =
                format!("is no option of {name}, of which all is published; leave it out");
            Err(Error::input(*option, problem))
        }
        _ => (known.run)(request),
    }
}
