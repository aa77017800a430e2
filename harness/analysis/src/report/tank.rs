//! The page of bars that turn in tanks.

use super::drawings::Drawings;
use super::flowing::{STYLE, force_grid};
use super::page::{Top, assembled};
use super::picture::BedPicture;
use super::sections::{LEGEND, bed_figure, numbers, repeat, span};
use super::table::Table;
use super::tank_charts::{along_bar, comparison, half_turns, tanks, velocities};
use super::tank_views::from_above;
use super::text::{escape, exact, plus_minus, typeset};
use super::{before, claims, inputs, player, rig_table};
use crate::claims::evidence;
use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::{DragSummary, Summary, Tank};
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::format::{number_with_error, short};

/// One self-contained HTML page of bars in tanks.
pub fn tank_page(summary: &Summary, scenario_text: &str, drawings: &Drawings<'_>) -> String {
    let book = evidence::book_of_run(summary);
    let mut out = String::new();
    out.push_str(&force_figures(summary, drawings.series));
    out.push_str(&half_turns(summary));
    out.push_str(&comparison(summary));
    out.push_str(&claims::section(
        &book,
        &summary.scenario,
        " Statements for which these runs give no number are left out: <code>bitgrain claims FOLDER</code> says why.",
    ));
    out.push_str(&bed_figures(summary, drawings.beds));
    out.push_str(&velocities(summary, drawings.tanks));
    out.push_str(&along_bar(summary, drawings.tanks));
    out.push_str(&numbers(
        summary,
        &rig_table::rig_table(summary),
        &table(summary),
    ));
    out.push_str(&rig_table::law_table(summary));
    out.push_str(&inputs::section(scenario_text, &summary.units));
    out.push_str(&repeat(summary, scenario_text));
    let top = Top {
        name: &summary.scenario,
        kind: "Drag and lift on a bar in a tank of grains",
        style: STYLE,
        lead: lead(summary),
        remarks: before::remarks(summary),
        about: before::about(summary, drawings.closing),
    };
    assembled(&top, &out)
}

/// The main numbers as a paragraph.
fn lead(summary: &Summary) -> String {
    let (units, inputs) = (&summary.units, &summary.inputs);
    let of = |number: fn(&DragSummary, &Tank) -> f64, unit: &str| {
        span(tanks(summary).map(|(run, tank)| number(run, tank)), unit)
    };
    let grain = inputs.mean_diameter();
    let in_grains = |length: f64| short(length / grain);
    let mut text = format!(
        "A bar of length {} and diameter {} (D/d = {}) turns {} times in the middle of a tank {} wide, {} grains, \
         whose floor and wall are grains, its ends at {}; its axis lies {} diameters deep.",
        of(|_, t| t.length, &units.length),
        of(|r, _| r.diameter, &units.length),
        span(tanks(summary).map(|(run, _)| run.diameter / grain), ""),
        of(|_, t| t.turns, ""),
        of(|_, t| t.diameter, &units.length),
        in_grains(inputs.bed.size[0]),
        of(|r, _| r.speed, &units.speed),
        of(|r, _| r.depth / r.diameter, ""),
    );
    text += &format!(
        " In the first half turn, before the bar meets its own wake, the drag is {} times &rho; g h D L (Guillard: 13 \
         in the experiment) and the lift {} times the buoyancy (Guillard: 20, saturated, for thick bars).",
        of(|_, t| t.drag_coefficient, ""),
        of(|_, t| t.lift_over_buoyancy, ""),
    );
    let drops = tanks(summary).filter_map(|(_, tank)| {
        let [first, second] = tank.half_turns.get(..2)? else {
            return None;
        };
        Some(second.drag.mean / first.drag.mean)
    });
    let drops: Vec<f64> = drops.collect();
    if !drops.is_empty() {
        text += &format!(
            " In the second half turn, in its wake, the drag is {} of that.",
            span(drops.into_iter(), "")
        );
    }
    text += &format!(
        " The paper turns the tank and holds the bar; here the tank is at rest and the bar turns. Seen from the tank \
         the two differ by forces of the order of &Omega;<sup>2</sup> R/g = {} of the weight.",
        of(|_, t| t.centrifugal, ""),
    );
    format!("<p class=\"lead\">{text} Errors are standard errors.</p>\n")
}

/// Drag and lift against travel, side by side, for every run.
fn force_figures(summary: &Summary, series: &[Vec<SeriesRow>]) -> String {
    let drag = "drag by the torque, 4&nbsp;M/L";
    let figures = force_grid(summary, series, drag, &|_| String::new());
    format!(
        "<section>\n<h2>Drag and lift against travel</h2>\n<p>Travel is that of the ends of the bar. Dashed: the \
         beginning of the averaging window, and the end of each half turn, from the first of which on the bar goes \
         through its own wake (Guillard 2014, Fig. 2).</p>\n<p class=\"legend\">{}</p>\n\
         {figures}</section>\n",
        LEGEND.replacen("drag, mean", "force, mean", 1)
    )
}

/// The settled beds, from the side and from above.
fn bed_figures(summary: &Summary, pictures: &[BedPicture]) -> String {
    let unit = &summary.units.length;
    let mut out = "<section>\n<h2>The settled bed</h2>\n<p>Slices, to scale: each circle is the cut of one grain, so \
                   cuts off centre are small. Hatched: the grains of floor and wall. Dark: the bar. Dashed: free \
                   surface.</p>\n<div class=\"grid\">\n"
        .to_owned();
    let mut room = player::ROOM;
    let unit_set = escape(&typeset(unit));
    for (k, bed) in summary.beds.iter().enumerate() {
        let name = escape(&bed.name);
        let Some(picture) = pictures.get(k) else {
            out.push_str(&format!("<p>No picture of bed {name}.</p>\n"));
            continue;
        };
        let caption = format!(
            "<b>{name}</b>, across the bar at y&nbsp;=&nbsp;{}&nbsp;{unit_set}; free surface at \
             z&nbsp;=&nbsp;{}&nbsp;{unit_set}.",
            short(picture.intruder.0[1]),
            short(picture.surface),
        );
        out.push_str(&bed_figure(picture, unit, k, &caption, &mut room));
        if let Some(svg) = from_above(picture, unit, summary.beds.len() + k) {
            out.push_str(&format!(
                "<figure class=\"bed\">{svg}<figcaption><b>{name}</b>, from above, at the height of the bar&rsquo;s \
                 axis as it begins to turn.</figcaption></figure>\n"
            ));
        }
    }
    out + "</div>\n</section>\n"
}

/// A column for each run with what was measured of its tank.
fn table(summary: &Summary) -> String {
    let units = &summary.units;
    let mut t = Table::new("Tanks", &summary.runs, |r| &r.name);
    let mut row = |name: &str, unit: &str, note: &str, cell: &dyn Fn(&Tank) -> String| {
        t.row(name, unit, note, |r: &DragSummary| {
            r.tank.as_ref().map_or("\u{2014}".to_owned(), cell)
        });
    };
    row("Diameter of the tank", &units.length, "inner", &|t| {
        exact(t.diameter)
    });
    row("Length L", &units.length, "of the bar", &|t| {
        exact(t.length)
    });
    row("Turns", "", "of the whole drag", &|t| exact(t.turns));
    let rate = format!("1/({})", units.time);
    row("Turning rate &Omega;", &rate, "", &|t| {
        exact(t.turning_rate)
    });
    let note = "the size of the forces that a turning tank has and one at rest lacks";
    row("&Omega;<sup>2</sup> R/g", "", note, &|t| {
        exact(t.centrifugal)
    });
    row(
        "Pressure",
        inputs::pressure_unit(units),
        "&rho; g h",
        &|t| exact(t.pressure),
    );
    row(
        "Buoyancy",
        &units.force,
        "&rho; g times the volume of the bar",
        &|t| exact(t.buoyancy),
    );
    row(
        "Drag coefficient C<sub>d</sub>",
        "",
        "drag over &rho; g h D L, first half turn",
        &|t| number_with_error(t.drag_coefficient, t.drag_coefficient_error),
    );
    row("Lift over buoyancy", "", "first half turn", &|t| {
        number_with_error(t.lift_over_buoyancy, t.lift_over_buoyancy_error)
    });
    row("Direct sum of the drag", "", "over that of eq. 1", &|t| {
        t.direct.map_or("\u{2014}".to_owned(), exact)
    });
    let most = tanks(summary).map(|(_, tank)| tank.half_turns.len()).max();
    for k in 0..most.unwrap_or(0) {
        let mean = |t: &Tank, of: fn(&bitgrain_lab::tank::HalfTurn) -> Mean| {
            t.half_turns
                .get(k)
                .map_or("\u{2014}".to_owned(), |half| plus_minus(of(half)))
        };
        row(
            &format!("Drag, half turn {}", k + 1),
            &units.force,
            "",
            &|t| mean(t, |half| half.drag),
        );
        row(
            &format!("Lift, half turn {}", k + 1),
            &units.force,
            "",
            &|t| mean(t, |half| half.lift),
        );
    }
    t.finish()
}

#[cfg(test)]
mod tests {
    use super::super::tests;
    use super::*;
    use crate::report::TankSeries;
    use bitgrain_lab::tank::HalfTurn;
    use bitgrain_lab::tank_tables::{BarRow, SECTORS, VelocityRow};

    fn tank(x: f64) -> Tank {
        let mean = Mean {
            mean: x,
            standard_error: 0.1 * x,
            ..Mean::default()
        };
        let half = HalfTurn {
            drag: mean,
            lift: mean,
        };
        Tank {
            diameter: x,
            length: x,
            turning_rate: x,
            turns: 1.0,
            centrifugal: x,
            bulk_density: x,
            pressure: x,
            buoyancy: x,
            drag_coefficient: x,
            drag_coefficient_error: x,
            lift_over_buoyancy: x,
            lift_over_buoyancy_error: x,
            direct: Some(x),
            half_turns: vec![half; 2],
        }
    }

    /// The page of bars whose numbers are all `x`, with the numbers of its tables.
    fn shown(x: f64) -> String {
        let mut summary = tests::summary(x);
        summary.inputs = bitgrain_lab::scenario::load("guillard-tank-small", &[]).unwrap();
        for run in &mut summary.runs {
            run.tank = Some(tank(x));
        }
        let bar = BarRow {
            drag: Some(x),
            ..BarRow::default()
        };
        let velocity = VelocityRow {
            height: 0.5,
            ahead: Some(x),
            ..VelocityRow::default()
        };
        let series = TankSeries {
            bar: vec![bar],
            velocity: vec![velocity; SECTORS],
        };
        let tanks = vec![series; 2];
        let drawings = Drawings {
            tanks: &tanks,
            ..Drawings::default()
        };
        tank_page(&summary, "name = 1", &drawings)
    }

    #[test]
    fn a_page_has_what_was_measured_of_a_tank() {
        let page = shown(2.5);
        for title in [
            "Drag and lift against travel",
            "Half a turn and after",
            "Velocity",
            "Along the bar",
        ] {
            assert!(page.contains(&format!(">{title}</h2>")), "{title}");
        }
        assert!(page.contains("&Omega;<sup>2</sup> R/g = 2.5"));
        assert!(page.contains("Drag, half turn 2") && !page.contains("half turn 3"));
        // No two depths differ.
        assert!(!page.contains("Against depth"));
    }

    #[test]
    fn numbers_that_are_none_draw_nothing_wrong() {
        for x in [0.0, f64::NAN, f64::INFINITY, -1.0] {
            let page = shown(x);
            let drawings = page
                .split("<svg")
                .skip(1)
                .filter_map(|part| part.split("</svg>").next());
            assert!(drawings.into_iter().all(|svg| !svg.contains("NaN")), "{x}");
        }
    }
}
