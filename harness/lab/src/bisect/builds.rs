//! A scenario run by two programs, so that their runs can be compared.

use std::path::{Path, PathBuf};

use crate::manifest::{FolderKind, Manifest};
use crate::recording::command::last_words;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::parts::alone;

/// Runs a scenario with two programs, each into a folder of its own in `out`, which are returned, and with beds of its
/// own: all that is compared was made by this call.
///
/// # Errors
/// [`Error::Input`] if something lies where they would write, or a program does not end well or without a finished run.
pub fn run_both(
    programs: [&Path; 2],
    scenario: &str,
    sets: &[String],
    out: &Path,
) -> Result<[PathBuf; 2]> {
    // Other builds may not look at the way there.
    disk::check_way(out)?;
    let names = ["a", "b", "beds-a", "beds-b"];
    if let Some(name) = names.iter().find(|name| disk::is_there(&out.join(name))) {
        let problem = format!(
            "holds `{name}`, where a program would go on with what an earlier one left: remove it, or choose \
             another --out"
        );
        return Err(Error::input(out.display().to_string(), problem));
    }
    let folders = ["a", "b"].map(|name| out.join(name));
    for ((program, folder), beds) in programs.iter().zip(&folders).zip(["beds-a", "beds-b"]) {
        run_one(program, scenario, sets, folder, &out.join(beds))?;
    }
    Ok(folders)
}

/// Runs a scenario with a program, which must leave a finished run in the folder.
fn run_one(
    program: &Path,
    scenario: &str,
    sets: &[String],
    folder: &Path,
    beds: &Path,
) -> Result<()> {
    let failed = |e| Error::write(Path::new("a temporary file"), e);
    let mut told = tempfile::tempfile().map_err(failed)?;
    let mut command = alone(program);
    command.args(["run", scenario, "--out"]).arg(folder);
    command.arg("--beds").arg(beds);
    command.args(sets.iter().flat_map(|set| ["--set", set]));
    // How far it is and what is wrong is seen as it comes.
    let ended = command.stdout(told.try_clone().map_err(failed)?).status();
    let ended = ended.map_err(|e| Error::read(program, &e))?;
    let run = |found: Manifest| found.of == FolderKind::Run && found.finished;
    let problem = match ended.success() {
        false => format!("did not run {scenario}: {ended}"),
        true if Manifest::of(folder)?.is_some_and(run) => return Ok(()),
        true => format!(
            "left no finished run of {scenario} in {}: it ended with {ended}",
            folder.display()
        ),
    };
    let words = match last_words(&mut told) {
        words if words.is_empty() => "it wrote nothing to its standard output".to_string(),
        words => format!("the last that it wrote to its standard output: {words}"),
    };
    let problem = format!("{problem}; {words}");
    Err(Error::input(program.display().to_string(), problem))
}
