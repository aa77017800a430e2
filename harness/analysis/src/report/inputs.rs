//! Every input of a scenario as a table: what it is, its value and its unit.

use toml::{Table, Value};

use super::input_keys::{GROUPS, Kind};
use super::text::{count, escape, exact, typeset};
use bitgrain_sim::units::Units;

/// The section of the page with every input of a resolved scenario. Keys that are not known here
/// are listed without a meaning; a text that is not TOML gives one line that says so.
pub(super) fn section(scenario_text: &str, units: &Units) -> String {
    let head = "<section>\n<h2>Inputs</h2>\n";
    let Ok(scenario) = scenario_text.parse::<Table>() else {
        return format!("{head}<p class=\"none\">The scenario is not TOML.</p>\n</section>\n");
    };
    if scenario.is_empty() {
        return format!("{head}<p class=\"none\">None.</p>\n</section>\n");
    }
    let bodies: String = groups(&scenario)
        .iter()
        .map(|(table, rows)| body(table, rows, units))
        .collect();
    format!(
        "{head}<p>The scenario with every default written out.</p>\n<div class=\"wide\" \
         tabindex=\"0\" role=\"region\" aria-label=\"Inputs\"><table class=\"inputs\">\n<thead>\
         <tr><th scope=\"col\">Input</th><th scope=\"col\">Value</th><th scope=\"col\">Unit</th>\
         </tr></thead>\n{bodies}</table></div>\n</section>\n"
    )
}

/// Tables of the scenario with their rows, key and value: the known ones first and in the order of
/// [`GROUPS`], then the others by name.
fn groups(scenario: &Table) -> Vec<(String, Vec<(String, &Value)>)> {
    let mut groups: Vec<(String, Vec<(String, &Value)>)> = Vec::new();
    collect("", "", scenario, &mut groups);
    let place = |table: &str| GROUPS.iter().position(|g| g.0 == table);
    groups.sort_by_key(|(table, _)| (place(table).unwrap_or(GROUPS.len()), table.clone()));
    for (table, rows) in &mut groups {
        let known = place(table).map_or(&[][..], |k| GROUPS[k].2);
        let place = |key: &str| known.iter().position(|row| row.0 == key);
        rows.sort_by_key(|(key, _)| (place(key).unwrap_or(known.len()), key.clone()));
    }
    groups.retain(|(_, rows)| !rows.is_empty());
    groups
}

/// Puts the values of `table`, whose keys in its group begin with `prefix`, under `group`. Tables
/// of the top level are separate groups, deeper ones are part of their keys' paths.
fn collect<'a>(
    group: &str,
    prefix: &str,
    table: &'a Table,
    groups: &mut Vec<(String, Vec<(String, &'a Value)>)>,
) {
    let mut rows = Vec::new();
    for (key, value) in table {
        match value {
            Value::Table(inner) if group.is_empty() => collect(key, "", inner, groups),
            Value::Table(inner) => collect(group, &format!("{prefix}{key}."), inner, groups),
            value => rows.push((format!("{prefix}{key}"), value)),
        }
    }
    match groups.iter_mut().find(|(name, _)| name == group) {
        Some((_, all)) => all.extend(rows),
        None => groups.push((group.to_owned(), rows)),
    }
}

/// The rows of one table under its name.
fn body(table: &str, rows: &[(String, &Value)], units: &Units) -> String {
    let group = GROUPS.iter().find(|g| g.0 == table);
    let words = group.map_or("", |g| g.1);
    let name = match table {
        "" => String::new(),
        table => format!("<code>[{}]</code>", escape(table)),
    };
    let mut out = format!(
        "<tbody>\n<tr class=\"group\"><th colspan=\"3\" scope=\"rowgroup\"><b>{words}</b> {name}\
         </th></tr>\n"
    );
    for (key, value) in rows {
        let known = group.and_then(|g| g.2.iter().find(|row| row.0 == key));
        let (kind, meaning) = known.map_or((Kind::Bare, ""), |row| (row.1, row.2));
        let meaning = match (table, key.as_str()) {
            // A shape is written out if it is not a sphere.
            ("intruder", "diameter") if rows.iter().any(|row| row.0 == "shape") => {
                "D of the cylinder or bar"
            }
            _ => meaning,
        };
        out.push_str(&format!(
            "<tr><th scope=\"row\"><code>{}</code><small>{meaning}</small></th><td>{}</td>\
             <td>{}</td></tr>\n",
            escape(key),
            shown(value),
            escape(&typeset(unit(kind, units))),
        ));
    }
    out + "</tbody>\n"
}

/// A value for reading; numbers with all their digits in the markup.
fn shown(value: &Value) -> String {
    match value {
        Value::Integer(n) => match u64::try_from(*n) {
            Ok(n) => count(n),
            Err(_) => escape(&n.to_string()),
        },
        Value::Float(x) => exact(*x),
        Value::Array(list) => list.iter().map(shown).collect::<Vec<_>>().join(", "),
        Value::String(text) => escape(text),
        other => escape(&other.to_string()),
    }
}

/// The unit of a pressure.
pub(super) fn pressure_unit(units: &Units) -> &str {
    unit(Kind::Pressure, units)
}

/// The unit of a kind of number. Those of no result follow from the system of units.
fn unit(kind: Kind, units: &Units) -> &str {
    let reduced = units.length == "d";
    let either = |in_reduced, in_si| if reduced { in_reduced } else { in_si };
    match kind {
        Kind::Bare => "",
        Kind::Length => &units.length,
        Kind::Time => &units.time,
        Kind::Speed => &units.speed,
        Kind::Force => &units.force,
        Kind::Acceleration => either("g", "m/s^2"),
        Kind::Density => either("rho", "kg/m^3"),
        Kind::Pressure => either("rho d g", "Pa"),
        Kind::Damping => either("sqrt(g/d^3)", "1/(m s)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_lab::scenario::{SHIPPED, parse};

    #[test]
    fn every_key_of_the_shipped_scenarios_is_explained() {
        for (name, text) in SHIPPED {
            let resolved = parse(text, name, &[], std::path::Path::new(""))
                .unwrap()
                .to_toml();
            let table: Table = resolved.parse().unwrap();
            for (group, rows) in groups(&table) {
                let known = GROUPS.iter().find(|g| g.0 == group);
                for (key, _) in rows {
                    let known = known.is_some_and(|g| g.2.iter().any(|row| row.0 == key));
                    assert!(known, "{name}: {group}.{key} has no row in GROUPS");
                }
            }
        }
    }

    #[test]
    fn values_units_and_meanings_stand_in_their_rows() {
        let text = "[law]\nmu = 0.5\ngamma_n = 792.4465962305567\n[bed]\nbox = [20.0, 13.0, 9.0]";
        let units = bitgrain_lab::scenario::load("quick", &[]).unwrap().units();
        let html = section(text, &units).replace('\u{a0}', " ");
        assert!(
            html.contains("792.447</data></td><td>\u{221a}(g/d\u{b3})</td>"),
            "{html}"
        );
        assert!(html.contains("value=\"792.4465962305567\""));
        assert!(html.contains("20</data>, <data value=\"13.0\">13</data>, "));
        let place = |part: &str| html.find(part).unwrap();
        assert!(place("[bed]") < place("[law]") && place("gamma_n") < place("<code>mu"));
    }

    #[test]
    fn unknown_keys_are_shown_and_nothing_is_taken_for_html() {
        let text = "[zoo.\"<b>\"]\na = [true, \"<i>\"]\nb = 1979-05-27\n[zoo]\nc = -3";
        let units = bitgrain_lab::scenario::load("quick", &[]).unwrap().units();
        let html = section(text, &units);
        for part in [
            "[zoo]",
            "&lt;b&gt;.a",
            "true, &lt;i&gt;",
            "1979-05-27",
            "-3",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
        assert!(!html.contains("<i>"));
        assert!(section("= no", &units).contains("is not TOML"));
    }
}
