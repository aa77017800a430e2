//! Campaigns in pieces: command lines for schedulers, one task, and what they come to.

use std::path::Path;

use super::channels::{MAX_INPUT, print};
use super::slurm::{Submission, Work, is_plain, quoted, quoted_first, utf8};
use bitgrain_lab::bed::library::BedCache;
use bitgrain_lab::campaign::folder::CampaignFolder;
use bitgrain_lab::campaign::only::Only;
use bitgrain_lab::campaign::plan::Plan;
use bitgrain_lab::campaign::tasks::{Ended, Missing, missing};
use bitgrain_lab::run::SaveEvery;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

/// What a shell executes something for, or takes for something else, unless quotes are round it.
const SPECIAL: &str = "$`;&|<>()#~*?[]{}!\\\"";

/// A campaign that is handed out in pieces.
pub(super) struct Pieces<'a> {
    pub plan: &'a Plan,
    pub only: &'a Only,
    pub out: &'a Path,
    pub library: &'a BedCache,
    pub retry: bool,
    /// Threads for each piece.
    pub threads: u16,
    /// The words of each command, as a shell reads them: program, campaign, and options that hold for all.
    pub command: String,
    /// Names of what alone is wanted.
    pub names: Vec<String>,
}

impl Pieces<'_> {
    /// What is left to do.
    pub(super) fn missing(&self) -> Result<Missing> {
        missing(self.plan, self.only, self.out, self.library, self.retry)
    }

    /// The command of a task, but for its threads; `task` as a shell reads it.
    fn command(&self, task: &str) -> String {
        let retry = if self.retry { " --retry" } else { "" };
        format!("{}{retry} --task {task}", self.command)
    }

    /// The command that puts together what is wanted.
    fn merge(&self) -> String {
        let only = |name: &String| format!(" --only {}", quoted(name));
        let names: String = self.names.iter().map(only).collect();
        format!("{}{names} --merge", self.command)
    }

    /// Prints the commands of the tasks that are left, a line each.
    ///
    /// # Errors
    /// [`Error::Input`] also for a name that programs between here and the shell may take the quotes from.
    pub(super) fn list(&self, kind: &str) -> Result<()> {
        let Missing { beds, drags } = self.missing()?;
        let wanted = match kind {
            "beds" => beds,
            "drags" => drags,
            _ => [beds, drags].concat(),
        };
        let line = |task: &String| {
            let command = self.command(&quoted(task));
            format!("{command} --threads {}\n", self.threads)
        };
        let lines: String = wanted.iter().map(line).collect();
        if lines.contains(|c| SPECIAL.contains(c)) || !is_plain(&lines) {
            let problem = format!(
                "a name in the commands has a control character, an apostrophe, or one of {}, which `xargs` hands to \
                 a shell without its quotes: choose names without these",
                SPECIAL
                    .chars()
                    .map(String::from)
                    .collect::<Vec<_>>()
                    .join(" ")
            );
            return Err(Error::input("--tasks", problem));
        }
        print(&lines)
    }

    /// Writes job scripts of what is left, and submits them unless they are only to be written.
    pub(super) fn submit(&self, options: &[String], write_only: bool) -> Result<()> {
        let Missing { beds, drags } = self.missing()?;
        if drags.is_empty() {
            return print(&format!(
                "nothing to submit: no drag is missing; `{}` writes the table\n",
                self.merge()
            ));
        }
        let folder = CampaignFolder(self.out);
        folder.share(self.plan)?;
        let (tasks, name) = (folder.tasks(), &self.plan.campaign.name);
        let place = format!("{}/\"$task\"", quoted(&utf8(&tasks)?));
        let command = self.command("\"$task\"");
        let work = |kind| Work {
            kind,
            name,
            command: &command,
            folder: Some(&place),
            threads: self.threads,
        };
        let mut submission = Submission::new(self.out, options)?;
        if !beds.is_empty() {
            submission.array(&beds, &work("beds"))?;
            submission.then();
        }
        submission.array(&drags, &work("drags"))?;
        submission.then();
        let merge = self.merge();
        submission.one(&Work {
            kind: "merge",
            name,
            command: &merge,
            folder: None,
            threads: 1,
        })?;
        print(&format!(
            "missing: beds {}, drags {}\n",
            beds.len(),
            drags.len()
        ))?;
        submission.submit(write_only)
    }

    /// Names what a merge lacks, with the commands that make it.
    pub(super) fn lacking(&self, lacking: usize, rows: usize) -> Result<()> {
        self.list("all")?;
        Err(Error::Unverified {
            problem: format!(
                "{} of {rows} rows of {} are missing",
                lacking,
                self.out.display()
            ),
            hint: "the commands above make them; those that workers are at come by themselves; then give this command \
                   again",
        })
    }
}

/// What is said as a task ends.
pub(super) fn told(task: &str, ended: Ended) -> Result<()> {
    match ended {
        Ended::Done => print(&format!("{task}: done\n")),
        Ended::Already => print(&format!("{task}: done before\n")),
        Ended::Taken => print(&format!(
            "{task}: another worker is at it; nothing is left to do here\n"
        )),
        Ended::Failed(reason) => Err(Error::Unverified {
            problem: format!("{task} failed, and its row will say so: {reason}"),
            hint: "--retry tries it again",
        }),
    }
}

/// The words of a command that every process of it needs: the program, the command and its options, as a shell reads
/// them.
pub(super) fn shared_words(
    program: &str,
    words: &[&str],
    options: &[(&str, Option<String>)],
) -> String {
    let mut line = quoted_first(program);
    for word in words {
        line += &format!(" {}", quoted(word));
    }
    for (name, value) in options {
        if let Some(value) = value {
            line += &format!(" {name} {}", quoted(value));
        }
    }
    line
}

/// How often a stage is saved, as the command line has it.
pub(super) fn interval(every: SaveEvery) -> String {
    match every {
        SaveEvery::Time(time) => format!("{}m", time.as_secs_f64() / 60.0),
        SaveEvery::Steps(steps) => steps.to_string(),
    }
}

/// The limit on files that are read, if it is not the usual one, in MiB.
pub(super) fn max_input() -> Option<String> {
    let mib = disk::most() >> 20;
    (mib != MAX_INPUT).then(|| mib.to_string())
}
