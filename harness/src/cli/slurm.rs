//! Job scripts for Slurm: what they say, where they lie, and how they are submitted.
//!
//! A submission is a folder `slurm/N` beside the results: the scripts, the lists of what arrays do, the logs, and
//! `submit.sh`, which submits all of it. This program does no more than run that.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::channels::print;
use bitgrain_lab::folder::SUBMITTED;
use bitgrain_lab::plain::escaped;
use bitgrain_sim::below::Below;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

/// Most elements of an array: Slurm's own default allows indices up to 1000.
const ARRAY_MAX: usize = 1000;

/// What `submit.sh` ends with if there is no `sbatch`, as a shell does.
const NOT_FOUND: i32 = 127;

/// What the jobs of one script do.
pub(super) struct Work<'a> {
    /// Name of the script, and the last word of the job's name.
    pub kind: &'a str,
    /// First word of the job's name.
    pub name: &'a str,
    /// The command, as a shell reads it; `"$task"` stands for a line of the list.
    pub command: &'a str,
    /// The folder in which it saves itself, as a shell reads it; `None` of what is short.
    pub folder: Option<&'a str>,
    /// Processors for each.
    pub threads: u16,
}

/// The files of one submission.
pub(super) struct Submission {
    out: PathBuf,
    folder: PathBuf,
    /// What is handed on to each `sbatch`, as a shell reads it.
    options: String,
    /// The most elements of an array at a time, as `%4`.
    throttle: String,
    /// What `submit.sh` does.
    steps: String,
}

/// Refuses a scheduler that is not known.
pub(super) fn check_scheduler(name: &str) -> Result<()> {
    let problem = match name {
        "slurm" if cfg!(unix) => return Ok(()),
        "slurm" => "needs the shell of a system with Slurm: give the command there".to_string(),
        other => format!(
            "`{other}` is not a scheduler that is known here: there is slurm; for others `bitgrain sweep CAMPAIGN \
             --tasks` prints a command a line"
        ),
    };
    Err(Error::input("--submit", problem))
}

impl Submission {
    /// A new one beside the results in `out`; `options` are those for `sbatch`.
    ///
    /// # Errors
    /// [`Error::Input`] for an option or a name that cannot be in a script; [`Error::Write`].
    pub(super) fn new(out: &Path, options: &[String]) -> Result<Self> {
        let (throttle, options) = throttle(options)?;
        let above = out.join(SUBMITTED);
        Below(out).check_folder(&above)?;
        utf8(&above)?;
        let names = disk::list(&above)?.into_iter();
        let mut next = names.filter_map(|(name, _)| name.parse::<u32>().ok()).max();
        // Another submission may take a number meanwhile.
        let folder = loop {
            next = next.unwrap_or(0).checked_add(1);
            let Some(number) = next else {
                let problem = "has no number left for a new submission: move the largest away";
                return Err(Error::input(above.display().to_string(), problem));
            };
            let folder = above.join(number.to_string());
            if disk::make_new_folder(&folder)? {
                break folder;
            }
        };
        Ok(Self {
            out: out.to_path_buf(),
            folder,
            options: options.concat(),
            throttle,
            steps: String::new(),
        })
    }

    fn write(&self, path: &Path, text: &str) -> Result<()> {
        Below(&self.out).write(path, text.as_bytes())
    }

    /// Adds an array with an element for each of these tasks, or several arrays if there are too many for one.
    pub(super) fn array(&mut self, tasks: &[String], work: &Work<'_>) -> Result<()> {
        for (k, part) in tasks.chunks(ARRAY_MAX).enumerate() {
            let file = match k {
                0 => work.kind.to_string(),
                k => format!("{}-{}", work.kind, k + 1),
            };
            let list = self.folder.join(format!("{file}.txt"));
            self.write(&list, &(part.join("\n") + "\n"))?;
            let array = format!("#SBATCH --array=1-{}{}\n", part.len(), self.throttle);
            let list = quoted(&utf8(&list)?);
            let task = format!("task=$(sed -n \"${{SLURM_ARRAY_TASK_ID}}p\" {list})\n");
            self.script(&file, "%A-%a", &array, &task, work)?;
        }
        Ok(())
    }

    /// Adds one job.
    pub(super) fn one(&mut self, work: &Work<'_>) -> Result<()> {
        self.script(work.kind, "%j", "", "", work)
    }

    /// What is added from here on begins when all before it has ended, well or not: what it lacks it makes itself, or
    /// says so.
    pub(super) fn then(&mut self) {
        self.steps += "after=$jobs jobs=\n";
    }

    fn script(
        &mut self,
        file: &str,
        log: &str,
        array: &str,
        task: &str,
        work: &Work<'_>,
    ) -> Result<()> {
        let path = self.folder.join(format!("{file}.sh"));
        let logs = utf8(&self.folder)?.replace('%', "%%");
        let output = quoted(&format!("{logs}/{file}-{log}.log"));
        let name = quoted(&format!("{}-{}", work.name, work.kind));
        let mut text = format!(
            "#!/bin/sh\n\
             #SBATCH --job-name={name}\n\
             {array}\
             #SBATCH --output={output}\n\
             #SBATCH --open-mode=append\n\
             #SBATCH --ntasks=1\n\
             #SBATCH --cpus-per-task={}\n",
            work.threads
        );
        text += &match work.folder {
            None => format!("\n{}\n", work.command),
            Some(folder) => format!(
                "#SBATCH --requeue\n\
                 # Slurm sends this signal two minutes before the end: the work saves itself and ends with 130.\n\
                 #SBATCH --signal=TERM@120\n\
                 \n{task}folder={folder}\n{RESUMES}\n\
                 before=$(saved)\n\
                 threads=${{SLURM_CPUS_PER_TASK:-1}}\n\
                 srun --ntasks=1 --cpus-per-task=\"$threads\" {} --threads \"$threads\"\n{AGAIN}",
                work.command
            ),
        };
        self.write(&path, &text)?;
        self.steps += &format!("submit {}\n", quoted(&utf8(&path)?));
        Ok(())
    }

    /// Writes `submit.sh`, and runs it unless it is only to be written.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no Slurm here, or it refuses a job; [`Error::Write`].
    pub(super) fn submit(self, write_only: bool) -> Result<()> {
        let path = self.folder.join("submit.sh");
        let text = format!(
            "#!/bin/sh\n\
             # Submits the scripts beside it, each when those that it waits for have ended.\n\
             set -e\n\
             command -v sbatch > /dev/null || exit {NOT_FOUND}\n\
             after= jobs=\n\
             submit() {{\n    \
             id=$(sbatch --parsable{} ${{after:+\"--dependency=afterany$after\"}} \"$1\")\n    \
             jobs=$jobs:${{id%%;*}}\n    \
             echo \"$1: job ${{id%%;*}}\"\n\
             }}\n{}",
            self.options, self.steps
        );
        self.write(&path, &text)?;
        let script = utf8(&path)?;
        let by_hand = format!("sh {}", quoted(&script));
        if write_only {
            return print(&format!("written, not submitted: `{by_hand}` submits it\n"));
        }
        let status = Command::new("sh").arg(&script).status();
        let place = path.display().to_string();
        match status.map(|status| status.code()) {
            Ok(Some(0)) => Ok(()),
            Ok(Some(NOT_FOUND)) => Err(Error::input(
                "--submit",
                format!(
                    "there is no `sbatch` here; the scripts are written: where Slurm is, give `{by_hand}` in this \
                     folder"
                ),
            )),
            Ok(_) => Err(Error::input(
                place,
                format!(
                    "Slurm refused a job, as it says above; once that is mended, `{by_hand}` submits all again"
                ),
            )),
            Err(e) => Err(Error::input(
                place,
                format!("the shell cannot be started: {e}"),
            )),
        }
    }
}

/// How a script sees whether anything was saved.
const RESUMES: &str = "\
# One number for all that is saved of it so far.
saved() {
    find \"$folder\" \\( -name manifest.json -o -name latest.safetensors -o -name '*.pouring.safetensors' \\) \\
        -exec cksum {} + 2> /dev/null | sort | cksum
}";

/// What a script does behind its work.
const AGAIN: &str = "\
status=$?
if [ \"$status\" -eq 130 ]; then
    if [ \"$(saved)\" = \"$before\" ]; then
        echo \"$folder: nothing was saved in the time of this job, so it is not begun again: give it more time\" >&2
        exit 3
    fi
    scontrol requeue \"$SLURM_JOB_ID\"
fi
exit \"$status\"
";

/// The most elements of an array at a time, from an `--array=%4` among the options; the rest as a shell reads them, a
/// space before each.
fn throttle(options: &[String]) -> Result<(String, Vec<String>)> {
    let (mut throttle, mut rest) = (String::new(), Vec::new());
    let mut options = options.iter();
    while let Some(option) = options.next() {
        let value = match option.as_str() {
            "--array" | "-a" => options.next().map(String::as_str),
            other => other.strip_prefix("--array=").or(other.strip_prefix("-a")),
        };
        match value {
            None => rest.push(format!(" {}", quoted(option))),
            Some(most) if is_throttle(most) => throttle = most.to_string(),
            Some(other) => {
                let problem = format!(
                    "`{other}`: the elements of an array are bitgrain's; expected at most how many are to run at a \
                     time, as in --array=%4"
                );
                return Err(Error::input("--array", problem));
            }
        }
    }
    Ok((throttle, rest))
}

fn is_throttle(text: &str) -> bool {
    let digits = text.strip_prefix('%');
    digits.is_some_and(|n| n.parse::<u32>().is_ok_and(|n| n > 0))
}

/// A word as a shell reads it.
pub(super) fn quoted(word: &str) -> String {
    quoted_unless(word, "_-./:,+@%=")
}

/// The first word of a line: behind `A=` it would be the value of a variable.
pub(super) fn quoted_first(word: &str) -> String {
    quoted_unless(word, "_-./:,+@%")
}

fn quoted_unless(word: &str, signs: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || signs.contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_string(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// Whether the lines of a text are those that other programs see, and are printed as they stand.
pub(super) fn is_plain(text: &str) -> bool {
    escaped(text) == text && !text.contains(['\u{2028}', '\u{2029}'])
}

/// The text of a path, which no program reads as an option.
pub(super) fn utf8(path: &Path) -> Result<String> {
    let plain = |text: &&str| is_plain(text) && !text.contains('\n');
    let text = path.to_str().filter(plain).ok_or_else(|| {
        let problem = "cannot be written into a script: expected UTF-8 in one line, without control characters";
        Error::input(path.display().to_string(), problem)
    })?;
    Ok(match text.starts_with('-') {
        true => format!("./{text}"),
        false => text.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_if_a_shell_would_change_them() {
        for plain in ["out/camp", "law.mu=0.3", "mu0.5-D2/run-1", "%4"] {
            assert_eq!(quoted(plain), plain);
        }
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted_first("a=b/bitgrain"), "'a=b/bitgrain'");
        assert_eq!(quoted("it's $1"), "'it'\\''s $1'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn a_throttle_is_taken_out_of_the_options() {
        let words = |text: &str| -> Vec<String> { text.split(' ').map(String::from).collect() };
        let got = throttle(&words("--time=10 --array=%4 --mem 2G")).unwrap();
        assert_eq!(got.0, "%4");
        assert_eq!(got.1.concat(), " --time=10 --mem 2G");
        assert_eq!(throttle(&words("-a %2")).unwrap().0, "%2");
        for wrong in ["--array=1-5", "--array=%0", "-a %"] {
            assert!(throttle(&words(wrong)).is_err(), "{wrong}");
        }
    }
}
