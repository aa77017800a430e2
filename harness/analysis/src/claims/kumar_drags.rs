//! What a campaign's analysis says of the claims about how the drag grows, by both means of it: the paper averages from
//! the start (Kumar 2018, Fig. 4), the averaging window leaves the start-up out.

use super::kumar_curves::{MU, Of, found, parameter};
use super::number::{Found, Number};
use crate::analysis::{Finding, Growth, Reading};
use crate::fit::Fit;
use bitgrain_sim::format::{number_with_error, plural};

pub(super) fn drags(id: &str, of: &Of) -> Option<Found> {
    let second = |reading| growth(of, reading, "p", |growth| &growth.second);
    let third = |reading| growth(of, reading, "r", |growth| &growth.third);
    Some(match id {
        "linear" => second(Reading::Uncut),
        "linear-cut" => second(Reading::Cut),
        "steeper" => third(Reading::Uncut),
        "steeper-cut" => third(Reading::Cut),
        _ => return table_one(id, of),
    })
}

/// A number of one reading; the note has those of the others.
fn growth(of: &Of, reading: Reading, name: &str, which: fn(&Growth) -> &Finding<Fit>) -> Found {
    let pooled = of.pooled(MU)?;
    let own = pooled
        .growth(reading)
        .ok_or("the drags cannot be read so")?;
    let fit = found(which(own))?;
    let mut note = fit.line();
    for other in pooled
        .growth
        .iter()
        .filter(|other| other.reading != reading)
    {
        let Some(value) = which(other).found().and_then(|fit| fit.parameter(name)) else {
            continue;
        };
        let number = number_with_error(value.value, value.error);
        let path = match (other.reading, pooled.path) {
            (Reading::CutOnPath | Reading::UncutOnPath, Some(path)) => format!(" of {path} d"),
            _ => String::new(),
        };
        note += &format!("; with {}{path} {number}", other.reading.words());
    }
    Ok(Number::one(parameter(fit, name)?, note))
}

/// `table-1-drag-D`: the drags on an intruder without friction over those of Table I.
fn table_one(id: &str, of: &Of) -> Option<Found> {
    let diameter: f64 = id.strip_prefix("table-1-drag-")?.parse().ok()?;
    let all = of.analysis.table_one.iter();
    let mut own = all.filter(|one| one.diameter == diameter);
    Some(match own.next() {
        Some(one) => {
            let [shallow, deep] = one.at_depths.map(|v| number_with_error(v.value, v.error));
            let [least, most] = one.depths;
            let note = format!(
                "{} at Fr {}, {}, at h = {:.1} brought to the paper's depth by h^{}; {shallow} if that is \
                 {least} d, {deep} if it is {most} d",
                plural(one.points.len(), "drag"),
                match &one.points[..] {
                    [first, .., last] => format!("{} to {}", first.0, last.0),
                    few => few.iter().map(|point| point.0.to_string()).collect(),
                },
                one.reading.words(),
                one.depth,
                number_with_error(one.alpha.value, one.alpha.error),
            );
            Ok(Number::one(one.ratio, note))
        }
        None => Err(format!(
            "no frictionless run has D = {diameter} d and Fr from 0.25 to 1"
        )),
    })
}
