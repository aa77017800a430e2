//! Runs the reference worlds on other machines, in emulators, and compares every bit with the golden text.

// Its tests use the rest.
#[allow(dead_code)]
#[path = "../../machines/mod.rs"]
mod machines;

use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use bitgrain_tests::golden;
use machines::list::{TARGETS, Target, find};
use machines::{Golden, check, firmware, machine, report};

const HELP: &str = "\
Builds the reference worlds for other machines, runs them and compares every bit with
golden/digests/reference.snap.txt and fixed.snap.txt.

targets [--list] [--require NAME,...] [NAME ...]

  --list             names every target, with the Debian packages that it takes
  --require NAME,... it is an error that these cannot be tried
  NAME ...           only these (and those required); all if none is named

Exit status: 0 all that ran is as it must be, 1 something is not or a required target cannot be tried,
2 no such target or option.";

/// What the command line asks for.
struct Wish {
    list: bool,
    chosen: Vec<&'static Target>,
    required: Vec<&'static str>,
}

fn wish(args: impl Iterator<Item = String>) -> Result<Wish, String> {
    let mut list = false;
    let mut names: Vec<String> = Vec::new();
    let mut required: Vec<String> = Vec::new();
    let mut all = true;
    let mut args = args;
    while let Some(arg) = args.next() {
        if arg == "--list" {
            list = true;
        } else if arg == "--require" {
            let next = args.next().ok_or("--require takes names, with commas")?;
            required.extend(next.split(',').map(str::to_string));
        } else if arg.starts_with('-') {
            return Err(format!("unknown option `{arg}`; --help shows all"));
        } else {
            names.push(arg);
            all = false;
        }
    }
    for name in names.iter().chain(&required) {
        find(name)?;
    }
    let is = |names: &[String], target: &Target| names.iter().any(|name| name == target.name);
    let asked = |target: &&Target| all || is(&names, target) || is(&required, target);
    let must = TARGETS.iter().filter(|target| is(&required, target));
    Ok(Wish {
        list,
        chosen: TARGETS.iter().filter(asked).collect(),
        required: must.map(|target| target.name).collect(),
    })
}

fn main() -> ExitCode {
    if std::env::args().any(|arg| arg == "--help" || arg == "-h") {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    let wish = match wish(std::env::args().skip(1)) {
        Ok(wish) => wish,
        Err(why) => {
            eprintln!("{why}");
            return ExitCode::from(2);
        }
    };
    if wish.list {
        for target in wish.chosen {
            let packages = target.packages().join(" ");
            println!("{:<15} {}\n{:15} {packages}", target.name, target.about, "");
        }
        return ExitCode::SUCCESS;
    }
    match run(&wish) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

/// Runs what was asked for and returns whether all of it is as it must be.
fn run(wish: &Wish) -> Result<bool, String> {
    let read = |name: &str| {
        let text = std::fs::read_to_string(golden(name));
        text.map_err(|why| format!("golden/{name}: {why}"))
    };
    let text = Golden {
        floats: read("digests/reference.snap.txt")?,
        fixed: read("digests/fixed.snap.txt")?,
    };
    let bounds = firmware::bounds(&read("firmware.csv")?)?;
    let version = machine::cross_version();
    if !version.is_empty() {
        println!("Debian's compiler: {version}\n");
    }
    println!("{}", report::heading());
    let rows = check_all(&wish.chosen, &text);
    let (table, sound) = report::firmware(&rows, &bounds);
    print!("{table}");
    let must = |row: &&report::Row| row.is_skipped() && wish.required.contains(&row.name);
    let lacking: Vec<&str> = rows.iter().filter(must).map(|row| row.name).collect();
    if !lacking.is_empty() {
        println!("\nrequired, but skipped: {}", lacking.join(", "));
    }
    Ok(sound && lacking.is_empty() && rows.iter().all(report::Row::is_good))
}

/// Checks targets two at a time, since emulators and the last steps of builds keep one core busy, and returns their
/// rows in the order of the targets. Those of one triple go one after the other: a program takes the place of another.
fn check_all(chosen: &[&'static Target], text: &Golden) -> Vec<report::Row> {
    let mut triples: Vec<&str> = chosen.iter().map(|target| target.triple).collect();
    triples.sort_unstable();
    triples.dedup();
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(triple) = triples.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let these = chosen.iter().enumerate();
                    for (at, target) in these.filter(|(_, target)| target.triple == *triple) {
                        let row = check(target, text);
                        println!("{}", row.text());
                        rows.lock().unwrap().push((at, row));
                    }
                }
            });
        }
    });
    let mut rows = rows.into_inner().unwrap();
    rows.sort_by_key(|(at, _)| *at);
    rows.into_iter().map(|(_, row)| row).collect()
}
