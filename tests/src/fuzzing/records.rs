//! What commands read back of their own files: summaries, campaigns, tables and books of claims, and their use.

use std::path::Path;
use std::sync::OnceLock;

use bitgrain::analysis::{self, analyse, describe};
use bitgrain::campaign::plan::Plan;
use bitgrain::campaign::table::{CampaignTable, of_run};
use bitgrain::campaign::{plan, written};
use bitgrain::claims::evidence::Evidence;
use bitgrain::claims::{self, book::Book};
use bitgrain::report::{self, Drawings};
use bitgrain::series::SeriesRow;
use bitgrain::summary::{DragRecord, Summary, parse_record, parse_summary};
use serde_json::Value;

use super::bytes::Bytes;

/// Most drags whose table, findings and page are made, so that an input takes milliseconds.
const RUNS: usize = 8;
/// Most members of a campaign that is planned again from its own text.
const MEMBERS: usize = 16;
/// Most rows of a table that is analysed.
const ROWS: usize = 64;

/// A small summary to begin from: two drags of a flowing bed.
const FLOWING: &str = include_str!("../../../golden/guillard-small/summary.json");

/// Raw text after a 0 (a summary) or a 1 (the record of a drag); after anything else the sound summary or record
/// with some of its values replaced.
pub fn summary(data: &[u8]) -> bool {
    let Some((choice, rest)) = data.split_first() else {
        return false;
    };
    let text = match choice {
        0 | 1 => match std::str::from_utf8(rest) {
            Ok(text) => text.to_string(),
            Err(_) => return false,
        },
        _ => altered(choice % 2 == 1, Bytes(rest)),
    };
    if choice % 2 == 1 {
        return of_record(&text);
    }
    let Ok(read) = parse_summary(&text, Path::new("fuzz")) else {
        return false;
    };
    let again = serde_json::to_string(&read).expect("a summary can be written");
    let again = parse_summary(&again, Path::new("fuzz"));
    assert_eq!(again.expect("a summary reads back"), read);
    told(read, &text)
}

fn of_record(text: &str) -> bool {
    let Ok(read) = parse_record(text, Path::new("fuzz")) else {
        return false;
    };
    let again = serde_json::to_string(&read).expect("a record can be written");
    let again = parse_record(&again, Path::new("fuzz"));
    assert_eq!(again.expect("a record reads back"), read);
    let DragRecord {
        version,
        bits_version,
        units,
        inputs,
        standard_error_method,
        bed,
        run,
    } = read;
    let whole = Summary {
        version,
        bits_version,
        scenario: inputs.name.clone(),
        units,
        inputs,
        standard_error_method,
        beds: vec![bed],
        runs: vec![run],
    };
    told(whole, text)
}

/// What `analyse`, `claims` and `report` make of a summary, as far as that needs no other file.
fn told(read: Summary, text: &str) -> bool {
    if read.runs.len() > RUNS {
        return true;
    }
    let runs = read.runs.len();
    let table =
        CampaignTable::parse(&of_run(&read), "fuzz").expect("the table of a run reads back");
    assert_eq!(table.len(), runs);
    let none: Vec<Vec<SeriesRow>> = vec![Vec::new(); runs];
    let page = match read.runs.iter().any(|run| run.flow.is_some()) {
        true => {
            let courses = vec![report::FlowSeries::default(); runs];
            let drawings = Drawings {
                series: &none,
                courses: &courses,
                ..Drawings::default()
            };
            report::flowing_page(&read, text, &drawings)
        }
        false => report::page(&read, text, &Drawings::default()),
    };
    assert!(!page.contains("<script>alert"), "what is read is no markup");
    let evidence = Evidence {
        by: read.scenario.clone(),
        digest: String::new(),
        analysis: analyse(&table, true),
        table,
        summary: Some(read),
        beside: None,
    };
    said(&evidence);
    true
}

/// Findings in words and as JSON, the page, and a book with what was measured.
fn said(evidence: &Evidence) {
    let _ = describe(&evidence.analysis);
    let _ = analysis::text(&evidence.analysis);
    let page = bitgrain::report::campaign_page(evidence);
    assert!(!page.contains("<script>alert"), "what is read is no markup");
    let mut book = Book::shipped();
    evidence.record(&mut book);
    let text = book.text("");
    assert_eq!(Book::parse(&text, "fuzz").expect("a book reads back"), book);
}

/// The sound summary, or the record of one of its drags, with values replaced.
fn altered(record: bool, mut from: Bytes) -> String {
    static SOUND: OnceLock<Value> = OnceLock::new();
    let sound = SOUND.get_or_init(|| serde_json::from_str(FLOWING).expect("the golden is JSON"));
    let mut tree = sound.clone();
    if record {
        let take = |key: &str| (key.to_string(), sound[key].clone());
        let mut map: serde_json::Map<String, Value> = [
            "version",
            "bits_version",
            "units",
            "inputs",
            "standard_error_method",
        ]
        .map(take)
        .into_iter()
        .collect();
        map.insert("bed".into(), sound["beds"][0].clone());
        map.insert("run".into(), sound["runs"][0].clone());
        tree = Value::Object(map);
    }
    for _ in 0..1 + from.below(4) {
        replace(&mut tree, &mut from);
    }
    tree.to_string()
}

/// Goes down into a tree at random and replaces the value at which it ends.
fn replace(tree: &mut Value, from: &mut Bytes) {
    match tree {
        Value::Object(map) if !map.is_empty() => {
            let place = from.below(map.len().min(255) as u8);
            if let Some(inner) = map.values_mut().nth(place) {
                replace(inner, from);
            }
        }
        Value::Array(list) if !list.is_empty() => match from.below(8) {
            0 => list.clear(),
            1 => {
                let first = list[0].clone();
                list.push(first);
            }
            _ => {
                let place = from.below(list.len().min(255) as u8);
                replace(&mut list[place], from);
            }
        },
        // Half of the time the kind stays, which more readers accept.
        Value::Number(number) if from.below(2) == 0 => {
            let new = match number.is_f64() {
                true => Value::from(from.scale(-20.0, 20.0)),
                false => Value::from(u64::from(from.byte()) << (8 * from.below(8))),
            };
            *tree = new;
        }
        leaf => *leaf = any(from),
    }
}

/// Any value that a file can hold.
fn any(from: &mut Bytes) -> Value {
    match from.below(10) {
        0 => Value::Null,
        1 => Value::Bool(from.below(2) == 0),
        2 => {
            Value::from([0, 1, 2, 64, 1000, 1 << 53, u64::MAX, u64::from(u32::MAX)][from.below(8)])
        }
        3 => Value::from(u64::from(from.byte())),
        4 => Value::from(-i64::from(from.byte())),
        5 => Value::from(from.scale(-300.0, 300.0)),
        6 => Value::from(from.scale(-6.0, 6.0)),
        7 => Value::from(
            [
                "",
                "..",
                "../x",
                "/",
                "bed-2",
                "bed-1-run-1",
                "<script>alert(1)</script>",
                "\u{1b}[2J",
            ][from.below(8)],
        ),
        8 => Value::Array((0..from.below(4)).map(|_| any(from)).collect()),
        _ => Value::Array(vec![Value::from(from.scale(-3.0, 3.0)); 1 + from.below(70)]),
    }
}

/// A campaign's file: its plan can be made, and what lies in the campaign's folder gives the same plan again.
pub fn campaign(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let nowhere = Path::new("/nowhere");
    let Ok(read) = plan::parse(text, "fuzz", &[], nowhere) else {
        return false;
    };
    assert!(!read.members.is_empty(), "nothing to do");
    for member in &read.members {
        let mut parts = Path::new(&member.name).components();
        let part = parts.next().expect("a name");
        assert!(matches!(part, std::path::Component::Normal(_)) && parts.next().is_none());
    }
    if read.members.len() > MEMBERS {
        return true;
    }
    let again = written::parse(&read.text(), "fuzz", nowhere).expect("a campaign reads back");
    let members = |plan: &Plan| -> Vec<_> {
        let members = plan.members.iter();
        members
            .map(|m| (m.name.clone(), m.scenario.clone()))
            .collect()
    };
    assert_eq!(members(&again), members(&read));
    true
}

/// A campaign's table: read, analysed, shown in words, as JSON and as a page, and claims measured on it.
pub fn table(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let Ok(table) = CampaignTable::parse(text, "fuzz") else {
        return false;
    };
    if table.len() > ROWS {
        return true;
    }
    let _ = table.check_against(&table, "fuzz", |_, _| true);
    let _ = table.unit("drag");
    let evidence = Evidence {
        by: "fuzz".into(),
        digest: String::new(),
        analysis: analyse(&table, true),
        table,
        summary: None,
        beside: None,
    };
    said(&evidence);
    !evidence.analysis.curves.is_empty()
}

/// A book of claims: shown as a table, and written and read again.
pub fn book(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    let Ok(read) = Book::parse(text, "fuzz") else {
        return false;
    };
    let _ = (claims::lines(&read), claims::table(&read));
    let again = Book::parse(&read.text(text), "fuzz").expect("a book reads back");
    assert_eq!(again, read);
    true
}
