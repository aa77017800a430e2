//! First steps: the shipped scenarios, a file to begin from, shell completions and manual pages.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;

use super::channels::processors;
use super::channels::{print, shown};
use bitgrain_lab::folder::refuse_among_results;
use bitgrain_lab::{forecast, scenario};
use bitgrain_sim::disk::{self, write_whole};
use bitgrain_sim::error::{Error, Result};

/// What `bitgrain new` takes.
#[derive(Args)]
pub(super) struct New {
    /// Name of the scenario: letters, digits, - and _. The file is called NAME.toml.
    name: String,
}

/// What `bitgrain completions` takes.
#[derive(Args)]
pub(super) struct Completions {
    /// The shell.
    shell: Shell,
}

/// What `bitgrain man` takes.
#[derive(Args)]
pub(super) struct Man {
    /// Folder for the pages, one for each command; it is made.
    folder: PathBuf,
}

/// Writes a scenario with every key and a comment on each.
pub(super) fn new(what: &New) -> Result<()> {
    let name = &what.name;
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if name.is_empty() || name.len() > 64 || !name.chars().all(plain) {
        let problem = "is not a name for a scenario: use up to 64 letters, digits, - and _";
        return Err(Error::input(name, problem));
    }
    let path = PathBuf::from(format!("{name}.toml"));
    if disk::is_there(&path) {
        let problem = "exists already: choose another name, or move it away";
        return Err(Error::input(shown(&path), problem));
    }
    write_whole(&path, scenario::template(name).as_bytes())?;
    print(&format!(
        "{}: a bed of 2,500 grains and four drags; change what you like, then\n  bitgrain run {0} --dry-run\n  \
         bitgrain run {0}\n",
        shown(&path)
    ))
}

/// The shipped scenarios with their sizes and times.
pub(super) fn list() -> Result<()> {
    let threads = processors(None);
    let mut text = format!(
        "{:<16} {:>9} {:>5} {:>6}  {}\n",
        "scenario",
        "grains",
        "beds",
        "drags",
        format_args!("time on {threads} thread(s)")
    );
    for size in forecast::shipped(threads)? {
        text += &format!(
            "{:<16} {:>9} {:>5} {:>6}  {}\n",
            size.name, size.grains, size.beds, size.drags, size.time
        );
    }
    text += "\nbitgrain run NAME runs one of them, bitgrain run NAME --dry-run says more about it, and bitgrain new \
             NAME writes a file to begin from.\n";
    print(&text)
}

/// Prints the completion script of a shell.
pub(super) fn completions(what: &Completions, mut program: Command) -> Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(what.shell, &mut program, "bitgrain", &mut text);
    print(&String::from_utf8_lossy(&text))
}

/// Writes the manual page of the program and of each command.
pub(super) fn man(what: &Man, mut whole: Command) -> Result<()> {
    // Gives each command its full name.
    whole.build();
    let mut pages = vec![("bitgrain".to_string(), whole.clone())];
    for command in whole.get_subcommands() {
        let name = command.get_name();
        if name != "help" {
            pages.push((format!("bitgrain-{name}"), command.clone()));
        }
    }
    refuse_among_results(&what.folder)?;
    let count = pages.len();
    let place = |name: &str| what.folder.join(format!("{name}.1"));
    for (name, _) in &pages {
        let held = disk::read_if_there(&place(name))?;
        if held.is_some_and(|held| !disk::bears(&held, ".TH bitgrain")) {
            let problem = "is no page of this program, and would be replaced: move it away, or choose another folder";
            return Err(Error::input(shown(&place(name)), problem));
        }
    }
    for (name, command) in pages {
        let path = place(&name);
        let mut text = Vec::new();
        let rendered = clap_mangen::Man::new(command).render(&mut text);
        rendered.map_err(|e| Error::write(&path, e))?;
        write_whole(&path, &text)?;
    }
    print(&format!("{count} pages in {}\n", shown(&what.folder)))
}
