//! Results of one scenario or campaign that were computed in several folders, put together as one folder would have
//! them: goldens that take longer than a machine is lent for.

use bitgrain::campaign::plan::Plan;
use bitgrain::error::{Error, Result};
use bitgrain::summary::{DragRecord, Summary};

/// The whole summary from those of drags, and from a whole one of some of them: beds and drags in the scenario's order,
/// each once.
///
/// # Errors
/// [`Error::Input`] if they are of several scenarios, or say two things of one drag or bed.
pub fn summary(parts: Vec<Summary>) -> Result<Summary> {
    let refuse = |problem: String| Err(Error::input("summaries", problem));
    let mut parts = parts.into_iter();
    let Some(mut whole) = parts.next() else {
        return refuse("there are none".into());
    };
    for part in parts {
        if part.inputs != whole.inputs {
            return refuse("are of several scenarios".into());
        }
        for bed in part.beds {
            match whole.beds.iter().find(|one| one.name == bed.name) {
                Some(one) if *one != bed => {
                    return refuse(format!("say two things of {}", bed.name));
                }
                Some(_) => {}
                None => whole.beds.push(bed),
            }
        }
        for run in part.runs {
            match whole.runs.iter().find(|one| one.name == run.name) {
                Some(one) if *one != run => {
                    return refuse(format!("say two things of {}", run.name));
                }
                Some(_) => {}
                None => whole.runs.push(run),
            }
        }
    }
    let (beds, drags) = (whole.inputs.beds().to_vec(), whole.inputs.drags().to_vec());
    let bed = |name: &str| beds.iter().position(|plan| plan.name == name);
    let drag = |name: &str| drags.iter().position(|plan| plan.name == name);
    whole.beds.sort_by_key(|one| bed(&one.name));
    whole.runs.sort_by_key(|one| drag(&one.name));
    Ok(whole)
}

/// A drag's record as a summary of one drag.
pub fn of_record(record: DragRecord) -> Summary {
    Summary {
        version: record.version,
        bits_version: record.bits_version,
        scenario: record.inputs.name.clone(),
        units: record.units,
        inputs: record.inputs,
        standard_error_method: record.standard_error_method,
        beds: vec![record.bed],
        runs: vec![record.run],
    }
}

/// The table of a campaign from tables of parts of it: rows in the campaign's order, each once; of a row that two have
/// the one with more columns filled counts, if they agree in the others. Each text begins with a comment, then the
/// names of the columns.
///
/// # Errors
/// [`Error::Input`] if two tables say two things of one run, or a row is not of the campaign.
pub fn table(plan: &Plan, texts: &[String]) -> Result<String> {
    let mut all: Vec<Part> = texts
        .iter()
        .map(|text| Part::read(text))
        .collect::<Result<_>>()?;
    // The table with the most columns has all of them in their order.
    all.sort_by_key(|part| usize::MAX - part.names.len());
    let Some(first) = all.first() else {
        return Err(Error::input("tables", "there are none"));
    };
    let (comment, names) = (first.comment.clone(), first.names.clone());
    let mut out = csv::Writer::from_writer(Vec::new());
    let write = "a row of text can be written into memory";
    out.write_record(&names).expect(write);
    let mut left: usize = all.iter().map(|part| part.rows.len()).sum();
    for member in &plan.members {
        for run in member.scenario.drags() {
            let mut row: Option<Vec<String>> = None;
            for part in &all {
                for other in part.rows_of(&names, &member.name, &run.name)? {
                    left -= 1;
                    row = Some(match row {
                        None => other,
                        Some(row) => one(row, &other, &names)?,
                    });
                }
            }
            row.map_or(Ok(()), |row| out.write_record(row))
                .expect(write);
        }
    }
    if left > 0 {
        let problem = format!(
            "hold {left} rows of no run of the campaign {}",
            plan.campaign.name
        );
        return Err(Error::input("tables", problem));
    }
    let body = out.into_inner().expect(write);
    Ok(comment + "\n" + &String::from_utf8(body).expect("cells are text"))
}

/// Two rows of one run as one.
fn one(row: Vec<String>, other: &[String], names: &[String]) -> Result<Vec<String>> {
    let both = row.into_iter().zip(other).zip(names);
    both.map(|((a, b), name)| match (&a[..], &b[..]) {
        (x, y) if x == y => Ok(a),
        (_, "") => Ok(a),
        ("", _) => Ok(b.clone()),
        _ => Err(Error::input(
            "tables",
            format!("say two things of one run: {name} is {a} and {b}"),
        )),
    })
    .collect()
}

/// One of the tables.
struct Part {
    comment: String,
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Part {
    fn read(text: &str) -> Result<Self> {
        let wrong = |e: csv::Error| Error::input("table", e.to_string());
        let (comment, body) = text.split_once('\n').unwrap_or_default();
        let mut reader = csv::Reader::from_reader(body.as_bytes());
        let names = reader
            .headers()
            .map_err(wrong)?
            .iter()
            .map(String::from)
            .collect();
        let rows = reader
            .records()
            .map(|row| Ok(row.map_err(wrong)?.iter().map(String::from).collect()));
        Ok(Self {
            comment: comment.into(),
            names,
            rows: rows.collect::<Result<_>>()?,
        })
    }

    /// Its rows of a run, in these columns; those that it lacks are empty.
    fn rows_of(&self, names: &[String], member: &str, run: &str) -> Result<Vec<Vec<String>>> {
        let place = |name: &str| self.names.iter().position(|own| own == name);
        if let Some(lost) = self.names.iter().find(|own| !names.contains(own)) {
            return Err(Error::input(
                "tables",
                format!("only a smaller one has a column `{lost}`"),
            ));
        }
        let is = |row: &&Vec<String>| {
            let cell = |name| place(name).map(|k| &row[k][..]);
            cell("member") == Some(member) && cell("run") == Some(run)
        };
        let cells = |row: &Vec<String>| {
            let cell = |name: &String| place(name).map_or(String::new(), |k| row[k].clone());
            names.iter().map(cell).collect()
        };
        Ok(self.rows.iter().filter(is).map(cells).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> Plan {
        bitgrain::campaign::load("kumar-small", &[]).unwrap()
    }

    fn text(rows: &[&str], more: bool) -> String {
        let names = if more {
            "member,run,drag,late"
        } else {
            "member,run,drag"
        };
        format!("# units: none\n{names}\n{}\n", rows.join("\n"))
    }

    #[test]
    fn rows_come_in_the_order_of_the_campaign_with_all_columns() {
        let old = text(&["mu0.1-D2-h8,run-2,2", "mu0.1-D2-h8,run-1,1"], false);
        let new = text(&["mu0.5-D2-h8,run-1,5,50", "mu0.1-D2-h8,run-1,1,10"], true);
        let whole = table(&plan(), &[old.clone(), new.clone()]).unwrap();
        let rows = [
            "mu0.1-D2-h8,run-1,1,10",
            "mu0.1-D2-h8,run-2,2,",
            "mu0.5-D2-h8,run-1,5,50",
        ];
        assert_eq!(whole, text(&rows, true));
        assert_eq!(table(&plan(), &[whole.clone(), old]).unwrap(), whole);
        let other = text(&["mu0.1-D2-h8,run-1,7"], false);
        let told = table(&plan(), &[new.clone(), other])
            .unwrap_err()
            .to_string();
        assert!(
            told.contains("two things of one run: drag is 1 and 7"),
            "{told}"
        );
        let strange = text(&["mu9-D2-h8,run-1,1"], false);
        let told = table(&plan(), &[new, strange]).unwrap_err().to_string();
        assert!(told.contains("hold 1 rows of no run"), "{told}");
    }
}
