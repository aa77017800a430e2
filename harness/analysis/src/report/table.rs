//! Tables of the page: every number of the beds and drags.

use super::text::{brief, count, escape, plus_minus, to_error, typeset};
use bitgrain_lab::summary::{BedSummary, DragSummary};
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::energy_budget::EnergyRow;
use bitgrain_sim::format::number_with_error;
use bitgrain_sim::units::Units;

/// Rows of a table under the names of its columns.
pub(super) struct Table<'a, T> {
    items: &'a [T],
    label: &'static str,
    html: String,
}

impl<'a, T> Table<'a, T> {
    pub(super) fn new(label: &'static str, items: &'a [T], name: impl Fn(&T) -> &str) -> Self {
        let head = |t: &T| format!("<th scope=\"col\">{}</th>", escape(name(t)));
        let heads: String = items.iter().map(head).collect();
        Table {
            items,
            label,
            html: format!(
                "<thead><tr><th scope=\"col\">Quantity</th>{heads}</tr></thead>\n<tbody>\n"
            ),
        }
    }

    pub(super) fn row(&mut self, name: &str, unit: &str, note: &str, cell: impl Fn(&T) -> String) {
        let unit = match unit {
            "" => String::new(),
            unit => format!(" <i>{}</i>", escape(&typeset(unit))),
        };
        let cells = self.items.iter().map(|t| format!("<td>{}</td>", cell(t)));
        let cells: String = cells.collect();
        let name = escape(name);
        self.html.push_str(&format!(
            "<tr><th scope=\"row\"><b>{name}</b>{unit}<small>{note}</small></th>{cells}</tr>\n"
        ));
    }

    pub(super) fn finish(self) -> String {
        if self.items.is_empty() {
            return "<p>None.</p>\n".to_owned();
        }
        format!(
            "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>\n{}\
             </tbody>\n</table></div>\n",
            self.label, self.html
        )
    }
}

/// A digest of which the first digits are shown, and all once it is opened.
fn digest(hex: &str) -> String {
    folded(hex, &escape(hex))
}

/// HTML that is shown once the first digits of a digest are opened.
pub(super) fn folded(hex: &str, html: &str) -> String {
    match hex.get(..8) {
        Some(first) => format!(
            "<details class=\"digest\"><summary><code>{}&hellip;</code></summary><code>{html}</code></details>",
            escape(first)
        ),
        None => format!("<code>{html}</code>"),
    }
}

pub(super) fn bed_table(beds: &[BedSummary], units: &Units) -> String {
    let mut t = Table::new("Beds", beds, |b| &b.name);
    let (length, force) = (&units.length, &units.force);
    t.row(
        "Grains",
        "",
        "frozen ones included, the intruder not",
        |b| count(b.grains as u64),
    );
    t.row("Frozen grains", "", "of the rough base", |b| {
        count(b.frozen as u64)
    });
    t.row(
        "Steps",
        "",
        "from the first release to the settled bed",
        |b| count(b.steps),
    );
    t.row(
        "Free surface",
        length,
        "height, a median over columns",
        |b| brief(b.surface),
    );
    t.row(
        "Depth",
        length,
        "of the intruder's centre below the surface",
        |b| brief(b.depth),
    );
    let note = "from z = 1 d to 2 d below the surface";
    t.row("Packing fraction", "", note, |b| brief(b.packing_fraction));
    let note = "contacts of a free grain below the surface layer";
    t.row("Coordination number", "", note, |b| {
        brief(b.coordination_number)
    });
    t.row("Deepest overlap", "", "over the mean diameter", |b| {
        brief(b.overlap_max)
    });
    let note = "per free grain, over its weight times d";
    t.row("Kinetic energy", "", note, |b| {
        brief(b.kinetic_energy_over_weight_d)
    });
    t.row("Weight", force, "of the free grains", |b| brief(b.weight));
    let note = "upward force on the free grains; at rest their weight";
    t.row("Support", force, note, |b| brief(b.support));
    t.row("Digest", "", "of the settled state", |b| digest(&b.digest));
    let note = "the last link of its chain of digests";
    t.row("Chain", "", note, |b| digest(&b.chain));
    t.finish()
}

pub(super) fn run_table(runs: &[DragSummary], units: &Units) -> String {
    let mut t = Table::new("Drags", runs, |r| &r.name);
    let (length, force) = (&units.length, &units.force);
    t.row("Bed", "", "it was dragged through", |r| escape(&r.bed));
    let flows = runs.iter().any(|r| r.flow.is_some());
    if !flows {
        t.row("Froude number", "", "2 V &radic;(2 D/g)/(D + d)", |r| {
            brief(r.froude)
        });
    }
    let note = match flows {
        true => "of base and bed past the intruder along x",
        false => "of the intruder along x",
    };
    t.row("Speed V", &units.speed, note, |r| brief(r.speed));
    t.row("Diameter D", length, "of the intruder", |r| {
        brief(r.diameter)
    });
    t.row(
        "Depth",
        length,
        "of its centre below the free surface",
        |r| brief(r.depth),
    );
    t.row("Drag", force, "force against the motion", |r| {
        plus_minus(r.drag)
    });
    t.row("Lift", force, "upward force, without the weight", |r| {
        plus_minus(r.lift)
    });
    t.row("Side force", force, "along y", |r| plus_minus(r.side));
    t.row("Contacts", "", "grains that touch the intruder", |r| {
        plus_minus(r.contacts)
    });
    t.row(
        "Contact angle",
        "rad",
        "of the grains that touch the intruder, 0 straight ahead",
        |r| optional(r.contact_angle),
    );
    t.row(
        "Coordination number",
        "",
        "contacts of a grain within 2 d of the intruder&rsquo;s surface",
        |r| optional(r.coordination),
    );
    around_rows(&mut t, runs);
    t.row("Drag, uncut", force, "mean over all steps", |r| {
        to_error(r.drag_uncut, r.drag.standard_error)
    });
    let note = "drag over the weight of the bed above the intruder's lowest point";
    if !flows {
        t.row("Plug ratio", "", note, |r| brief(r.plug_ratio));
    }
    let note = "at any row, over the mean diameter";
    t.row("Deepest overlap", "", note, |r| brief(r.overlap_max));
    energy_rows(&mut t, runs, &units.energy);
    t.row("Distance", length, "travelled", |r| brief(r.distance));
    t.row("Steps", "", "of the drag", |r| count(r.steps));
    t.row(
        "Window start",
        length,
        "travel at which averaging began",
        |r| brief(r.window_start),
    );
    t.row(
        "Window end",
        length,
        "travel at which averaging ended",
        |r| brief(r.window_end),
    );
    t.row("Window steps", "", "averaged", |r| count(r.window_steps));
    t.row(
        "Blocks of the drag",
        "",
        "from which its error comes: doubled in length until the error no longer changes; not converged: the window is \
         too short for that, or the force drifts",
        |r| blocks(&r.drag),
    );
    t.row("Digest", "", "of the final state", |r| digest(&r.digest));
    let note = "the last link of its chain of digests";
    t.row("Chain", "", note, |r| digest(&r.chain));
    digest_rows(&mut t, runs);
    t.finish()
}

/// Rows of the grains round the intruder that some runs have and others have not.
fn around_rows(t: &mut Table<DragSummary>, runs: &[DragSummary]) {
    type Line = (
        &'static str,
        &'static str,
        &'static str,
        fn(&DragSummary) -> Option<Mean>,
    );
    let lines: [Line; 4] = [
        (
            "Contact angle, new",
            "rad",
            "of contacts with the intruder as they begin",
            |r| r.new_contact_angle,
        ),
        (
            "Floating",
            "",
            "share of the grains within 2 d of the intruder&rsquo;s surface that have no contact",
            |r| r.floating,
        ),
        (
            "Moving along",
            "",
            "free grains that go at half the intruder&rsquo;s speed or faster",
            |r| r.moving,
        ),
        (
            "Drift above",
            "V",
            "speed of the layers above the intruder&rsquo;s top",
            |r| r.drift,
        ),
    ];
    for (name, unit, note, of) in lines {
        if runs.iter().any(|r| of(r).is_some()) {
            t.row(name, unit, note, |r| optional(of(r)));
        }
    }
    if runs.iter().any(|r| r.kappa.is_some()) {
        let note = "kappa: (Z/n) (D + d)<sup>2</sup>/(2 &radic;3 d<sup>2</sup>), Z the coordination \
                    number and n the contacts";
        let cell = |r: &DragSummary| {
            let both = r.kappa.zip(r.kappa_error);
            both.map_or("\u{2014}".to_owned(), |(k, e)| number_with_error(k, e))
        };
        t.row("Normalised coordination", "", note, cell);
    }
}

fn optional(mean: Option<Mean>) -> String {
    mean.map_or("\u{2014}".to_owned(), plus_minus)
}

/// How many blocks of how many steps, and whether longer ones were wanted.
fn blocks(mean: &Mean) -> String {
    let steps = count(mean.block_length);
    let short = match mean.converged {
        true => "",
        false => "; not converged",
    };
    format!("{} of {steps} steps{short}", mean.blocks)
}

/// A row for each named part of the final states, in the order of their first mention.
fn digest_rows(t: &mut Table<DragSummary>, runs: &[DragSummary]) {
    let mut parts: Vec<&str> = Vec::new();
    for (name, _) in runs.iter().flat_map(|r| &r.digest_parts) {
        if !parts.contains(&name.as_str()) {
            parts.push(name);
        }
    }
    for part in parts {
        t.row(
            &format!("Digest: {part}"),
            "",
            "part of the final state",
            |r| {
                let mut found = r.digest_parts.iter().filter(|(name, _)| name == part);
                found
                    .next()
                    .map_or("\u{2014}".to_owned(), |(_, hex)| digest(hex))
            },
        );
    }
}

/// Rows of the energy budget of each drag.
fn energy_rows(t: &mut Table<DragSummary>, runs: &[DragSummary], unit: &str) {
    type Term = (&'static str, &'static str, fn(&EnergyRow) -> f64);
    let terms: [Term; 9] = [
        ("Work of the intruder", "and of all obstacles", |e| {
            e.obstacles
        }),
        ("Work of the carriers", "of base and lid", |e| e.carriers),
        ("Lifted", "change of the energy in gravity", |e| {
            e.gravitational
        }),
        ("Slid", "dissipated by friction", |e| e.sliding),
        ("Damped, normal", "dissipated", |e| e.normal_damping),
        ("Damped, tangential", "dissipated", |e| e.tangential_damping),
        (
            "Stiffened",
            "gained by springs squeezed at fixed displacement",
            |e| e.stiffening,
        ),
        (
            "Turned",
            "lost by springs cut to their plane as it turns",
            |e| e.projection,
        ),
        (
            "Erased",
            "lost with the springs of contacts that part",
            |e| e.erased,
        ),
    ];
    if runs.iter().all(|r| r.energy.is_none()) {
        return;
    }
    let cell = |r: &DragSummary, of: &dyn Fn(&EnergyRow) -> f64| {
        r.energy.as_ref().map_or("none".into(), |e| brief(of(e)))
    };
    for (name, note, of) in terms {
        t.row(name, unit, note, |r| cell(r, &of));
    }
    let note = "residual of the energy budget, over the work done: the integrator&rsquo;s error";
    t.row("Energy unaccounted for", "", note, |r| {
        cell(r, &EnergyRow::closure)
    });
}
