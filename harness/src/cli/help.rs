//! What `--help` of each command says below its options: examples, and how it ends.

use clap::Command;

/// The commands by what they are for.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Make", &["new", "run", "sweep"]),
    (
        "Check",
        &[
            "verify",
            "bisect",
            "record",
            "replay",
            "selftest",
            "benchmark",
        ],
    ),
    ("Look", &["report", "analyse", "claims", "bed", "bench"]),
    ("Other", &["completions", "man", "help"]),
];

/// The same command, whose help lists its commands in groups.
pub(super) fn grouped(command: Command) -> Command {
    let mut text = "{about}\n\n{usage-heading} {usage}\n".to_string();
    for (title, names) in GROUPS {
        text += &format!("\n{title}:\n");
        for name in names {
            let about = match command.find_subcommand(name) {
                Some(found) => found.get_about().map_or(String::new(), |a| a.to_string()),
                None => "Print this help, or that of a command".into(),
            };
            text += &format!("  {name:<12} {about}\n");
        }
    }
    command.help_template(text + "\nOptions:\n{options}{after-help}\n")
}

pub(super) const RUN_HELP: &str = "\
Examples:
  bitgrain run quick
  bitgrain run kumar-system-1 --dry-run
  bitgrain run quick --out out/thick --set intruder.diameter=3 --set 'intruder.froude=[1, 4]' \\
      --set drag.distance=12
  bitgrain run --resume out/quick
  bitgrain run kumar-system-1 --submit slurm -- --time=8:00:00 --cpus-per-task=4

Results depend neither on --threads, nor on whether a bed was poured or reused, nor on whether a run was
stopped: Ctrl-C (or SIGTERM) saves unfinished stages; the same command goes on from there, after a kill or
a full disk from the last save; finished stages are kept. Missing or damaged files are made again. A folder
with other files under names that a run would write is refused. A job that was submitted saves itself before
its time is up and goes back into the queue; if it could save nothing in its time it stops, and says so.

With --expect or --against status 0 says that every link was executed by this call: what it found of the run, in the
folder or in the library of beds, it executes again and compares; no file changes by that.

Exit status: 0 done, 2 the scenario was refused, 3 a run failed or is not what was expected, 1 results could not be
written, 130 interrupted.";

pub(super) const SWEEP_HELP: &str = "\
Examples:
  bitgrain sweep kumar-small
  bitgrain sweep kumar-2018 --dry-run
  bitgrain sweep my-campaign.toml --threads 16 --jobs 4
  bitgrain sweep my-campaign.toml --tasks
  bitgrain sweep my-campaign.toml --merge
  bitgrain sweep my-campaign.toml --submit slurm -- --time=8:00:00 --array=%20

A campaign's file holds a base scenario and grids of values; harness/lab/campaigns/kumar-small.toml is one to
begin from. Each member (the runs that share a bed) is a separate run directory, which `bitgrain verify`
and `bitgrain run --resume` accept. Finished runs are in results.csv and results.parquet at once; those that
fail have a row with the reason. A campaign that was stopped or killed goes on with the same command, and
ends with the same bytes.

Many machines: --tasks prints a command for each bed and drag; run them by any scheduler, in any order and any
number at a time, where the campaign's file, --out and --beds are shared; then --merge writes the table of one
process. A drag whose bed another worker pours waits for it: to avoid that, end those of --tasks=beds before those
of --tasks=drags. What was killed is done by the same command again. --submit does all this on Slurm; given again
it submits what is missing. The guide's page Many machines (harness/guide/src/many-machines.md) has the rest.

Exit status: 0 done, 2 the campaign was refused, 3 runs failed, 1 results could not be written,
130 interrupted.";

pub(super) const ANALYSE_HELP: &str = "\
Examples:
  bitgrain analyse out/kumar-small
  bitgrain analyse out/quick
  bitgrain analyse results.csv --plugs --out findings.json

Fits come with their errors and quality, or with the reason why there is none: too few points, too short a
range, an exponent with too large an error.";

pub(super) const CLAIMS_HELP: &str = "\
Examples:
  bitgrain claims
  bitgrain claims --full
  bitgrain claims out/kumar-small
  bitgrain claims out/kumar-small --book golden/claims.toml

A claim agrees, disagrees, or is not resolved by the runs at hand: a number agrees within its tolerance if
its standard error is no larger, and disagrees if two errors more do not reach it. Several measurements count
as their mean, or as the worst of them where a claim must hold for each. A claim that assumes what the paper
does not say cannot disagree.";

pub(super) const BED_HELP: &str = "\
Examples:
  bitgrain bed list
  bitgrain bed show db7e
  bitgrain bed remove --all";

pub(super) const BENCH_HELP: &str = "\
Examples:
  bitgrain bench --steps 2000
  bitgrain bench --bed golden/peers/bed200.data --steps 4000 --json
  bitgrain bench --bed golden/peers/bed200.data --tiles 8 --steps 100";

pub(super) const BENCHMARK_HELP: &str = "\
Examples:
  bitgrain benchmark
  bitgrain benchmark chung-ooi
  bitgrain benchmark dosta-impact --grains 400 --until 0.005

Without a name it lists the benchmarks. With one it runs its cases and writes a table for each test (test-1.csv
and so on), summary.json and the page report.html. Where the law has a closed form the results must be within 0.1 %
of it; from published curves they are compared, and nothing is fitted to them. How fast this machine is says
`bitgrain bench`.

Exit status: 0 all checks against theory hold, 3 one does not, 2 there is no such benchmark, 1 results could not be
written.";

pub(super) const SELFTEST_HELP: &str = "\
Example:
  bitgrain selftest

It takes seconds. Every way of stepping that this machine has (instruction sets, one thread and several)
must give the published digests. Exit status: 0 it keeps the contract, 3 it does not.";

pub(super) const VERIFY_HELP: &str = "\
Examples:
  bitgrain verify out/quick
  bitgrain verify out/quick --segment run-1:20000-40000 --segment bed
  bitgrain verify out/quick --sample 3
  bitgrain verify out/kumar-small --sample 5

The folder is compared with its manifest: unfinished stages and missing, changed or extra files are named.
For a campaign its members are compared too, and its table is made again. Then runs are executed again: between two
checkpoints of a run every link of its chain of digests is made again, and so is the checkpoint at the end
with all that was measured, the tables and the snapshots; a bed is poured again. The summary is made again
if all is verified. The report is not checked (`bitgrain report DIR` makes it again). Exit status: 0 all
holds, 3 something does not, or the run has no manifest or is not finished, 2 the folder holds no run.";

pub(super) const BISECT_HELP: &str = "\
Examples:
  bitgrain bisect out/quick out/other
  bitgrain bisect out/quick elsewhere/quick --program-b ./bitgrain-of-last-week
  bitgrain bisect ./bitgrain-of-last-week target/release/bitgrain --scenario quick
  bitgrain bisect out/one out/two
  bitgrain bisect --commands './one' './other' --to 1000

The last two compare recordings (`bitgrain record`), and two programs while they run. What ends before the other, was
cut off or is not finished differs from it, unless --prefix says that this is meant. With --scenario the two programs
write into an --out in which none has written before.

Exit status: 0 the same at every link or step to the end of both, 3 they differ, 2 they cannot be compared, or a program
did not do its part.";

pub(super) const RECORD_HELP: &str = "\
Examples:
  bitgrain record out/one < one.frames
  bitgrain record out/two --keep all < two.frames
  bitgrain record out/new --against out/one < one.frames

A step comes as the line `step N`; for each array the line `array NAME TYPE SHAPE`, as in `array x f64 100x3`, and
its bytes, little-endian, row by row; then the line `done`. After the last step comes the line `end`. The guide's
page Recordings (harness/guide/src/recordings.md) shows this in Python. `bitgrain bisect` compares two recordings, and
--against compares what comes with one while it comes.

Exit status: 0 recorded, and the same as what it was compared with, 3 it differs, or ends before or after that, 2 the
input was refused or is cut off (what came before is recorded, without an end), 1 it could not be written.";

pub(super) const REPLAY_HELP: &str = "\
Examples:
  bitgrain replay golden/cases/collapse.json --steps 100 --every 10 --contacts
  bitgrain replay golden/cases/rig.json --steps 1000 --energy
  bitgrain replay out/quick --stage run-1 --from 12345 --steps 1 --contacts

A grain's motion in a case is \"free\", \"weightless\", \"frozen\", {\"carried\": [vx, vy, vz]} or, as a grain of
a lid, {\"lid\": [vx, vy]}; the guide (harness/guide/src/cases-and-energy.md) shows a whole case, and explains
the terms of --energy.";

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let whole = super::super::Cli::command();
        let mut names: Vec<&str> = whole.get_subcommands().map(Command::get_name).collect();
        names.push("help");
        let mut grouped: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, names)| *names)
            .copied()
            .collect();
        names.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(names, grouped);
    }
}
