//! The reference worlds on other machines: each target is built with the compiler that it takes, run by
//! this machine or an emulator, and its text is compared with the golden one.

pub mod compare;
pub mod firmware;
pub mod list;
pub mod machine;
pub mod report;

use std::time::Instant;

use compare::{Difference, first_difference, lines};
use list::{Expect, Target};
use report::{Outcome, Row};

/// The golden texts.
pub struct Golden {
    /// Of the worlds in `f64` and `f32`.
    pub floats: String,
    /// Of those in fixed point, which follow.
    pub fixed: String,
}

/// What the kernel says to a machine whose arithmetic it refuses.
const REFUSAL: &str = "x87 arithmetic rounds twice";

/// Builds and runs one target and judges what came of it. A firmware's image comes along.
pub fn check(target: &Target, golden: &Golden) -> Row {
    // Firmware has room for one of them.
    let golden = match (target.is_firmware(), target.has_no_floats()) {
        (_, true) => golden.fixed.clone(),
        (true, _) => golden.floats.clone(),
        _ => format!("{}{}", golden.floats, golden.fixed),
    };
    let begin = Instant::now();
    let mut row = Row {
        name: target.name,
        ran: String::new(),
        digest: String::new(),
        seconds: 0.0,
        outcome: Outcome::Same,
        firmware: None,
    };
    let missing = machine::missing(target);
    row.outcome = if missing.is_empty() {
        run(target, &golden, &mut row)
    } else {
        Outcome::Skipped(missing)
    };
    row.seconds = begin.elapsed().as_secs_f64();
    row
}

fn run(target: &Target, golden: &str, row: &mut Row) -> Outcome {
    let built = machine::build(target);
    if target.expect == Expect::Refused {
        row.ran = "the compiler".into();
        return refused(built);
    }
    let program = match built {
        Ok(program) => program,
        Err(told) => return Outcome::Failed(format!("it does not build:\n{told}")),
    };
    row.ran = machine::ran_by(target);
    let ended = match machine::run(target, &program) {
        Ok(ended) => ended,
        Err(why) => return Outcome::Failed(why),
    };
    let text = lines(&ended.output);
    row.digest = compare::last_digest(&text);
    if target.is_firmware() {
        let no_floats = target.has_no_floats();
        row.firmware = Some(firmware::inspect(&program, &ended.output, no_floats));
    }
    judge(target.expect, first_difference(&text, golden), &ended)
}

/// A build that must fail, and for that reason alone.
fn refused(built: Result<std::path::PathBuf, String>) -> Outcome {
    match built {
        Ok(_) => Outcome::Failed("it builds, but must be refused".into()),
        Err(told) if told.contains(REFUSAL) => Outcome::Refused,
        Err(told) => Outcome::Failed(format!("refused for another reason:\n{told}")),
    }
}

/// Whether a line tells of a step after step 0.
fn has_stepped(text: &str) -> bool {
    let step = |line: &str| line.split_whitespace().nth(2)?.parse::<u64>().ok();
    let lines = text.lines().filter(|line| line.starts_with("f64 "));
    lines.filter_map(step).any(|step| step > 0)
}

fn judge(expect: Expect, difference: Option<Difference>, ended: &machine::Ended) -> Outcome {
    match (expect, difference) {
        (Expect::Different, None) => Outcome::Failed("the same bits, but they must differ".into()),
        // A control that never took a step shows nothing; one that stops later did compute.
        (Expect::Different, Some(_)) if !has_stepped(&ended.output) => {
            Outcome::Failed(format!("it takes no step\n{}", ended.errors))
        }
        (Expect::Different, Some(at)) => Outcome::Differs(at),
        (_, Some(at)) => Outcome::Different(at, ended.errors.clone()),
        (_, None) if !ended.success => Outcome::Failed(format!(
            "the same bits, but it ends badly\n{}",
            ended.errors
        )),
        (_, None) => Outcome::Same,
    }
}
