//! What is asked of a benchmark.

use std::path::Path;

use crate::progress::Progress;

/// What is asked of a benchmark.
pub struct Request<'a> {
    /// Its name.
    pub name: &'a str,
    /// A file of where grains lie before it begins.
    pub start: Option<&'a Path>,
    /// How many grains, in place of the published number.
    pub grains: Option<u32>,
    /// Time at which it ends (s), in place of the published one.
    pub until: Option<f64>,
    /// Where its progress is shown.
    pub progress: &'a Progress,
}
