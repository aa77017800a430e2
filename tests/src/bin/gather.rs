//! Puts results together that were computed in several folders: `gather OUT SUMMARY...` the summaries of drags, or of
//! some drags of a run; `gather OUT --campaign NAME TABLE...` tables of a campaign. OUT ends in `.gz` if it is to be
//! packed, and may be one of the inputs.

use std::path::{Path, PathBuf};

use bitgrain::campaign;
use bitgrain::error::{Error, Result};
use bitgrain::files::{read_text, write_text};
use bitgrain::json::json_text;
use bitgrain::summary::{Summary, parse_record, parse_summary};
use bitgrain_tests::gather::{of_record, summary, table};

fn main() -> Result<()> {
    let mut words = std::env::args().skip(1);
    let usage = || {
        Error::input(
            "gather",
            "takes OUT SUMMARY... or OUT --campaign NAME TABLE...",
        )
    };
    let out = PathBuf::from(words.next().ok_or_else(usage)?);
    let mut files: Vec<String> = words.collect();
    let text = if files.first().is_some_and(|word| word == "--campaign") {
        let tables = files.split_off(2.min(files.len()));
        let plan = campaign::load(files.get(1).ok_or_else(usage)?, &[])?;
        let texts = tables.iter().map(|file| read_text(Path::new(file)));
        table(&plan, &texts.collect::<Result<Vec<_>>>()?)?
    } else {
        let parts = files.iter().map(|file| part(Path::new(file)));
        json_text(&out, &summary(parts.collect::<Result<_>>()?)?)?
    };
    let packed = out.extension().is_some_and(|end| end == "gz");
    let plain = if packed { out.with_extension("") } else { out };
    write_text(&plain, &text, packed)
}

/// A whole summary, or that of one drag.
fn part(file: &Path) -> Result<Summary> {
    let text = read_text(file)?;
    parse_summary(&text, file).or_else(|_| Ok(of_record(parse_record(&text, file)?)))
}
