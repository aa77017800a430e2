//! Every input of a scenario as a table: what it is, its value and its unit.

use toml::{Table, Value};

use super::text::{count, escape, exact, typeset};
use bitgrain_sim::units::Units;

/// What a number of the scenario counts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// No number, or one without a unit.
    Bare,
    Length,
    Time,
    Speed,
    Acceleration,
    Density,
    /// Stiffnesses and moduli.
    Pressure,
    /// Damping per mass and square root of area: 1 / (length time).
    Damping,
}

/// A table of the scenario, its name in words, and its keys in the order of the page: key, what
/// it counts, meaning as markup.
type Group = (
    &'static str,
    &'static str,
    &'static [(&'static str, Kind, &'static str)],
);

const GROUPS: [Group; 7] = [
    (
        "",
        "The experiment",
        &[
            ("name", Kind::Bare, "of the scenario and its folder"),
            ("units", Kind::Bare, "system in which all inputs are given"),
            ("seed", Kind::Bare, "of every random number"),
            ("seeds", Kind::Bare, "several: each has its own beds"),
            ("gravity", Kind::Acceleration, "along &minus;z"),
        ],
    ),
    (
        "bed",
        "The bed",
        &[
            (
                "file",
                Kind::Bare,
                "LAMMPS file that the bed comes from, instead of pouring",
            ),
            ("hash", Kind::Bare, "BLAKE3 of that file&rsquo;s text"),
            (
                "box",
                Kind::Length,
                "size along x and y, periodic unless it is a tank, and the height that the bed may fill",
            ),
            ("container", Kind::Bare, "what holds the bed at its sides"),
            ("grains", Kind::Bare, "how many, the intruder not counted"),
            (
                "fill_height",
                Kind::Length,
                "height to fill at a packing fraction of 0.6; gives the number of grains",
            ),
            (
                "diameters",
                Kind::Length,
                "of the grains, uniform between the two",
            ),
            ("density", Kind::Density, "of a grain"),
            (
                "base",
                Kind::Length,
                "grains that settle with their centres below this height are frozen",
            ),
            (
                "floor",
                Kind::Bare,
                "whether a plane at z = 0 lies under the base",
            ),
            (
                "pouring",
                Kind::Bare,
                "<code>at_once</code>, or <code>in_turn</code>: up to the intruder first, then over it",
            ),
            (
                "pouring_mu",
                Kind::Bare,
                "friction coefficient while the bed is poured; from its last rest on it is &mu; of the law",
            ),
            (
                "settled",
                Kind::Bare,
                "the bed is at rest when its kinetic energy per grain, over the mean weight times \
                 d, is below this",
            ),
        ],
    ),
    (
        "law",
        "The contact law",
        &[
            (
                "kind",
                Kind::Bare,
                "<code>hertz_history</code>: Kumar 2018, eqs. 1 and 2; <code>hertz_tsuji</code>: \
                 Guillard 2014, eq. A1",
            ),
            ("kn", Kind::Pressure, "normal stiffness K<sub>n</sub>"),
            ("kt", Kind::Pressure, "tangential stiffness K<sub>t</sub>"),
            (
                "gamma_n",
                Kind::Damping,
                "normal damping &gamma;<sub>n</sub>",
            ),
            (
                "gamma_t",
                Kind::Damping,
                "tangential damping &gamma;<sub>t</sub>",
            ),
            ("young", Kind::Pressure, "Young&rsquo;s modulus E"),
            ("poisson", Kind::Bare, "Poisson&rsquo;s ratio &nu;"),
            ("restitution", Kind::Bare, "coefficient of restitution e"),
            ("mu", Kind::Bare, "friction coefficient &mu;"),
        ],
    ),
    (
        "intruder",
        "The intruder",
        &[
            (
                "shape",
                Kind::Bare,
                "a sphere, a cylinder along y, as long as the box is wide, or a bar in a tank",
            ),
            ("diameter", Kind::Length, "D of the sphere"),
            ("length", Kind::Length, "L of the bar"),
            (
                "density",
                Kind::Density,
                "as it enters the effective mass of its contacts",
            ),
            (
                "height",
                Kind::Length,
                "of its centre above z = 0; a bed for each value",
            ),
            (
                "depth",
                Kind::Length,
                "of its centre below the surface expected at a packing fraction of 0.6; a bed for \
                 each value",
            ),
            ("speed", Kind::Speed, "V along x; a run for each value"),
            (
                "froude",
                Kind::Bare,
                "Froude number 2 V &radic;(2 D/g)/(D + d); a run for each value",
            ),
        ],
    ),
    (
        "lid",
        "The lid",
        &[
            (
                "effective_depth",
                Kind::Length,
                "h + (&pi; d/6)(&rho;<sub>lid</sub>/&rho;) of the intruder&rsquo;s centre; a bed for \
                 each value",
            ),
            (
                "density",
                Kind::Density,
                "of the lid&rsquo;s grains, instead",
            ),
            (
                "pressure_gradient",
                Kind::Bare,
                "whether the bed below the lid has weight: with, without, or a bed of each kind",
            ),
        ],
    ),
    (
        "drag",
        "The drag",
        &[
            ("dt", Kind::Time, "time step, also of the pouring"),
            (
                "moves",
                Kind::Bare,
                "the intruder, or the bed, carried past it by base and lid",
            ),
            (
                "distance",
                Kind::Length,
                "travel: one for all speeds, or one for each",
            ),
            (
                "own_wake",
                Kind::Bare,
                "whether the travel may be longer than the box, into the intruder&rsquo;s own wake",
            ),
            ("discard", Kind::Length, "travel left out of the means"),
            (
                "history",
                Kind::Bare,
                "tangential springs of the settled bed as the drag begins: kept, or empty as in a \
                 LAMMPS run from a file",
            ),
        ],
    ),
    (
        "measure",
        "Output",
        &[
            (
                "every",
                Kind::Bare,
                "steps between rows of the force series",
            ),
            ("torque", Kind::Bare, "whether the series holds the torque"),
            (
                "contacts",
                Kind::Bare,
                "whether the series holds the number of contacts, their mean angle and the \
                 coordination number near the intruder",
            ),
            ("snapshots", Kind::Bare, "snapshots of each drag"),
            (
                "energy",
                Kind::Bare,
                "whether the energy of each drag is accounted for",
            ),
            ("gzip", Kind::Bare, "whether LAMMPS files are packed"),
            (
                "checkpoints",
                Kind::Bare,
                "checkpoints kept of each drag, between which it can be verified",
            ),
            (
                "digest_every",
                Kind::Bare,
                "steps between links of each drag&rsquo;s chain of digests",
            ),
            (
                "reaches",
                Kind::Length,
                "distances from the intruder within which coordination numbers are measured, besides 2 d",
            ),
            (
                "fields.grid",
                Kind::Bare,
                "points along x, y and z at which fields are averaged",
            ),
            (
                "fields.window",
                Kind::Length,
                "radius of the spherical averaging windows",
            ),
            (
                "fields.every",
                Kind::Bare,
                "steps between samples of the fields",
            ),
        ],
    ),
];

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
