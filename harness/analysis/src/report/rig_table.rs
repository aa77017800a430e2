//! Tables of what only flowing beds have: their rigs, their flow, and the coefficients of their contact
//! law.

use super::inputs::pressure_unit;
use super::table::Table;
use super::text::{count, exact};
use bitgrain_lab::scenario::UnitSystem;
use bitgrain_lab::summary::{BedSummary, DragSummary, Flow, Rig, Summary};
use bitgrain_sim::coefficients::table_one;
use bitgrain_sim::format::{number_with_error, short};
use bitgrain_sim::units::Units;

const NONE: &str = "\u{2014}";

fn yes_or_no(is: bool) -> String {
    if is { "yes" } else { "no" }.to_owned()
}

/// A column for each bed with its intruder, its lid and the pressure.
pub(super) fn rig_table(summary: &Summary) -> String {
    let (beds, units, gravity) = (&summary.beds, &summary.units, summary.inputs.gravity);
    let mut t = Table::new("Rigs", beds, |b| &b.name);
    let mut row = |name: &str, unit: &str, note: &str, cell: &dyn Fn(&Rig) -> String| {
        t.row(name, unit, note, |b: &BedSummary| {
            b.rig.as_ref().map_or(NONE.to_owned(), cell)
        });
    };
    let (length, pressure) = (units.length.as_str(), pressure_unit(units));
    let density = density_unit(units);
    row("Seed", "", "of its pouring", &|r| count(r.seed));
    row("Diameter D", length, "of the intruder", &|r| {
        exact(r.diameter)
    });
    row("Length L", length, "of a cylinder: the box along y", &|r| {
        exact(r.length)
    });
    let note = "whether the bed below the lid has weight";
    row("Pressure gradient", "", note, &|r| {
        yes_or_no(r.pressure_gradient)
    });
    row("Grains of the lid", "", "none without one", &|r| {
        count(r.lid_grains as u64)
    });
    row("Density of the lid", density, "of its grains", &|r| {
        exact(r.lid_density)
    });
    let note = "&rho;, packing fraction times density of a grain";
    row("Bulk density", density, note, &|r| exact(r.bulk_density));
    let note =
        "h\u{303} = h + (&pi; d/6)(&rho;<sub>lid</sub>/&rho;), without h if there is no gradient";
    row("Effective depth", length, note, &|r| {
        exact(r.effective_depth)
    });
    row("Pressure", pressure, "&rho; g h\u{303}", &|r| {
        exact(r.bulk_density * gravity * r.effective_depth)
    });
    let note = "weight above the intruder&rsquo;s centre over the area of the box";
    row("Pressure, measured", pressure, note, &|r| exact(r.pressure));
    let note = "upward force on the resting intruder over its buoyancy; negative: it carries some of the bed";
    row("Reaction", "", note, &|r| exact(r.reaction_over_buoyancy));
    t.finish()
}

/// A column for each run with how its bed flowed, and forces over what they scale with.
pub(super) fn flow_table(runs: &[DragSummary], units: &Units) -> String {
    let mut t = Table::new("Flow", runs, |r| &r.name);
    let mut row = |name: &str, unit: &str, note: &str, cell: &dyn Fn(&Flow) -> String| {
        t.row(name, unit, note, |r: &DragSummary| {
            r.flow.as_ref().map_or(NONE.to_owned(), cell)
        });
    };
    let (force, pressure) = (units.force.as_str(), pressure_unit(units));
    let density = density_unit(units);
    let note = "whether the bed below the lid had weight";
    row("Pressure gradient", "", note, &|f| {
        yes_or_no(f.pressure_gradient)
    });
    row("Packing fraction", "", "mean over the window", &|f| {
        exact(f.packing_fraction)
    });
    row(
        "Bulk density",
        density,
        "&rho;, with that packing fraction",
        &|f| exact(f.bulk_density),
    );
    let note = "h\u{303}, with that density";
    row("Effective depth", &units.length, note, &|f| {
        exact(f.effective_depth)
    });
    row("Pressure", pressure, "&rho; g h\u{303}", &|f| {
        exact(f.pressure)
    });
    let note =
        "weight above the intruder&rsquo;s centre over the area of the box, mean over the window";
    row("Pressure, measured", pressure, note, &|f| {
        exact(f.pressure_measured)
    });
    row(
        "Buoyancy",
        force,
        "&rho; g times the volume of the intruder",
        &|f| exact(f.buoyancy),
    );
    row(
        "Drag coefficient",
        "",
        "drag over &rho; g h\u{303} D L",
        &|f| number_with_error(f.drag_coefficient, f.drag_coefficient_error),
    );
    let note = "drag over the measured pressure, D and L";
    row("Drag coefficient of the weight", "", note, &|f| {
        let over = f.pressure / f.pressure_measured;
        number_with_error(f.drag_coefficient * over, f.drag_coefficient_error * over)
    });
    row("Lift over buoyancy", "", "mean over the window", &|f| {
        number_with_error(f.lift_over_buoyancy, f.lift_over_buoyancy_error)
    });
    let note = "speed of the far grains over the speed asked for, from displacements";
    row("Far field", "", note, &|f| exact(f.far_field));
    row("Far field, least", "", "in the slowest layer", &|f| {
        exact(f.far_field_least)
    });
    let note =
        "part of the drag; with the lid&rsquo;s 1, and what changes the bed&rsquo;s momentum";
    row("Carried by the base", "", note, &|f| {
        exact(f.carried_by_base)
    });
    row("Carried by the lid", "", "part of the drag", &|f| {
        exact(f.carried_by_lid)
    });
    let note = "part of the drag that base and lid bear beyond it, which speeds the bed up";
    row("Inertia", "", note, &|f| exact(f.inertia));
    row(
        "Floating grains",
        "",
        "most free grains above the lid",
        &|f| count(f.floating),
    );
    row(
        "Travel",
        "d",
        "of the window, in mean grain diameters",
        &|f| exact(f.travel),
    );
    let two = |[a, b]: [f64; 2]| format!("{}, {}", exact(a), exact(b));
    let note = "first and second half of the window";
    row("Drag by halves", force, note, &|f| two(f.drag_halves));
    row("Lift over buoyancy by halves", "", note, &|f| {
        two(f.lift_halves)
    });
    t.finish()
}

fn density_unit(units: &Units) -> &'static str {
    match units.length.as_str() {
        "d" => "rho",
        _ => "kg/m^3",
    }
}

/// A coefficient's name with Greek letters, indices and powers.
fn symbol(name: &str) -> String {
    ["gamma", "delta", "_n", "_t", "^(1/2)", "^(1/4)"]
        .iter()
        .zip([
            "&gamma;",
            "&delta;",
            "<sub>n</sub>",
            "<sub>t</sub>",
            "<sup>1/2</sup>",
            "<sup>1/4</sup>",
        ])
        .fold(name.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// A coefficient's unit with its powers.
fn unit(name: &str) -> String {
    ["^(-3/2)", "^(-1/4)", "^-1"]
        .iter()
        .zip([
            "<sup>&minus;3/2</sup>",
            "<sup>&minus;1/4</sup>",
            "<sup>&minus;1</sup>",
        ])
        .fold(name.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// The coefficients of the contact law as in the paper's table; nothing for another law.
pub(super) fn law_table(summary: &Summary) -> String {
    let inputs = &summary.inputs;
    let Some(rows) = table_one(&inputs.law, inputs.mean_diameter(), inputs.bed.density) else {
        return String::new();
    };
    let row = |row: &bitgrain_sim::coefficients::Coefficient| {
        let unit = match inputs.units {
            UnitSystem::Si => unit(row.unit),
            UnitSystem::Reduced => String::new(),
        };
        format!(
            "<tr><th scope=\"row\">{} <i>{unit}</i></th><td>{}</td><td>{}</td></tr>\n",
            symbol(row.name),
            exact(row.pair),
            exact(row.wall)
        )
    };
    let rows: String = rows.iter().map(row).collect();
    format!(
        "<section>\n<h2>Contact law in numbers</h2>\n<p>Guillard 2014, Table I, for grains of diameter \
         {}: stiffness over the root and damping over the fourth root of the overlap \
         &delta;<sub>n</sub>.</p>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" \
         aria-label=\"Coefficients\"><table class=\"inputs\">\n<thead><tr>\
         <th scope=\"col\">Coefficient</th><th scope=\"col\">Two grains</th>\
         <th scope=\"col\">Grain and wall</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n\
         </section>\n",
        short(inputs.mean_diameter())
    )
}
