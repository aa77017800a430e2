//! The report of a run directory: one HTML page with pictures, charts and every number.
//!
//! The page is a pure function of what it shows: no time, no path and no name of a machine is in
//! it, and it needs no other file.

mod chart;
mod picture;

use crate::summary::{BedSummary, Mean, RunSummary, SeriesRow, Summary, Units};

/// A settled bed to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct BedPicture {
    /// Name of the bed.
    pub name: String,
    /// Lower corner of the box, periodic in x and y.
    pub lo: [f64; 3],
    /// Upper corner of the box.
    pub hi: [f64; 3],
    /// Height of the free surface.
    pub surface: f64,
    /// All grains, frozen ones included, the intruder not.
    pub grains: Vec<PictureGrain>,
    /// Centre and radius of the intruder.
    pub intruder: ([f64; 3], f64),
}

/// A grain to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureGrain {
    /// Its centre.
    pub position: [f64; 3],
    /// Its radius.
    pub radius: f64,
    /// Whether it belongs to the frozen base.
    pub frozen: bool,
}

/// Plug ratio from which the layers above the intruder may add to the drag, and the one from which
/// they do; both measured for a friction coefficient of 0.5.
const PLUG: [f64; 2] = [0.12, 0.3];

/// One self-contained HTML page. The series come in the order of the runs of the summary, the
/// pictures in that of its beds; where one is missing, the page says so.
pub fn page(
    summary: &Summary,
    scenario_text: &str,
    series: &[Vec<SeriesRow>],
    pictures: &[BedPicture],
) -> String {
    let name = escape(&summary.scenario);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name}: drag of a sphere through a bed of grains</title>\n\
         <style>{CSS}</style>\n</head>\n<body>\n<main>\n\
         <header><h1>{name}</h1>\n\
         <p class=\"kind\">Drag of a sphere through a bed of grains</p></header>\n"
    );
    out.push_str(&in_words(summary));
    out.push_str(&bed_figures(summary, pictures));
    out.push_str(&force_figures(summary, series));
    out.push_str(&froude_figure(summary));
    out.push_str(&numbers(summary));
    out.push_str(&repeat(summary, scenario_text));
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

/// The main numbers as a paragraph.
fn in_words(summary: &Summary) -> String {
    let units = &summary.units;
    let runs = &summary.runs;
    let bed = |f: fn(&BedSummary) -> f64, unit| span(summary.beds.iter().map(f), unit);
    let run = |f: fn(&RunSummary) -> f64, unit| span(runs.iter().map(f), unit);
    let several = |n: usize, one: &str, name: &str| match n {
        1 => one.to_owned(),
        n => format!("{n} {name}"),
    };
    let mut text = match summary.beds.len() {
        0 => "There is no settled bed.".to_owned(),
        n => format!(
            "{} of {} grains, {} of them a frozen base, settled to a free surface at height {} \
             and a packing fraction of {}; the intruder&rsquo;s centre lies {} below the surface.",
            several(n, "A bed", "beds"),
            bed(|b| b.grains as f64, ""),
            bed(|b| b.frozen as f64, ""),
            bed(|b| b.surface, &units.length),
            bed(|b| b.packing_fraction, ""),
            bed(|b| b.depth, &units.length),
        ),
    };
    let by_drag = |a: &&RunSummary, b: &&RunSummary| a.drag.mean.total_cmp(&b.drag.mean);
    let finite = || runs.iter().filter(|r| r.drag.mean.is_finite());
    let (Some(least), Some(most)) = (finite().min_by(by_drag), finite().max_by(by_drag)) else {
        return format!("<p class=\"lead\">{text} No drag was measured.</p>\n");
    };
    text.push_str(&format!(
        " A sphere of diameter {} was dragged through in {}, at speed {} (Froude number {}).",
        run(|r| r.diameter, &units.length),
        several(runs.len(), "one run", "runs"),
        run(|r| r.speed, &units.speed),
        run(|r| r.froude, ""),
    ));
    let force = escape(&typeset(&units.force));
    let drag = |r: &RunSummary| {
        let (mean, froude) = (plus_minus(r.drag), short(r.froude));
        format!("{mean}&nbsp;{force} at Fr&nbsp;=&nbsp;{froude}")
    };
    text.push_str(&match runs.len() {
        1 => format!(" The mean drag is {}.", drag(least)),
        _ => format!(
            " The mean drag lies between {} and {}.",
            drag(least),
            drag(most)
        ),
    });
    format!("<p class=\"lead\">{text} Errors are standard errors.</p>\n")
}

/// The range of some numbers with its unit.
fn span(values: impl Iterator<Item = f64>, unit: &str) -> String {
    let finite = values.filter(|x| x.is_finite());
    let ends = finite.fold(None, |ends: Option<(f64, f64)>, x| {
        Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
    });
    let (low, high) = ends.unwrap_or((f64::NAN, f64::NAN));
    let range = match (short(low), short(high)) {
        (low, high) if low == high => low,
        (low, high) => format!("{low} to {high}"),
    };
    match unit {
        "" => range,
        unit => format!("{range}&nbsp;{}", escape(&typeset(unit))),
    }
}

fn bed_figures(summary: &Summary, pictures: &[BedPicture]) -> String {
    let unit = &summary.units.length;
    let mut out = "<section>\n<h2>The settled bed</h2>\n".to_owned();
    for (k, bed) in summary.beds.iter().enumerate() {
        let name = escape(&bed.name);
        let drawn = pictures
            .get(k)
            .and_then(|p| Some((p, picture::slice(p, unit, k)?)));
        let Some((picture, svg)) = drawn else {
            out.push_str(&format!("<p>No picture of bed {name}.</p>\n"));
            continue;
        };
        let unit = escape(&typeset(unit));
        out.push_str(&format!(
            "<figure class=\"bed\">{svg}<figcaption><b>{name}</b>, slice at \
             y&nbsp;=&nbsp;{}&nbsp;{unit} through the intruder&rsquo;s centre. Each circle is the \
             cut of one grain, to scale, so cuts off centre are small. Light: free grains. \
             Hatched: frozen base. Black: the intruder. Arrow: direction of drag, +x. Dashed: \
             free surface at \
             z&nbsp;=&nbsp;{}&nbsp;{unit}. The box repeats along x and y.</figcaption></figure>\n",
            short(picture.intruder.0[1]),
            short(picture.surface),
        ));
    }
    out + "</section>\n"
}

fn force_figures(summary: &Summary, series: &[Vec<SeriesRow>]) -> String {
    let units = &summary.units;
    let runs = &summary.runs;
    let mut out = "<section>\n<h2>Drag against time</h2>\n".to_owned();
    if !runs.is_empty() {
        out.push_str(&format!("<p class=\"legend\">{LEGEND}</p>\n"));
    }
    out.push_str("<div class=\"grid\">\n");
    for (k, run) in runs.iter().enumerate() {
        let rows = series.get(k).map_or(&[][..], |s| s.as_slice());
        let chart = chart::force(run, rows, units, runs.len());
        let chart = chart.unwrap_or_else(|| "<p class=\"none\">No series.</p>".to_owned());
        let place = match summary.beds.len() {
            0 | 1 => String::new(),
            _ => format!(", {}", escape(&run.bed)),
        };
        out.push_str(&format!(
            "<figure>{chart}<figcaption><b>Fr = {}</b>{place}. Speed {}&nbsp;{}; mean drag of the \
             window {}&nbsp;{}.</figcaption></figure>\n",
            short(run.froude),
            short(run.speed),
            escape(&typeset(&units.speed)),
            plus_minus(run.drag),
            escape(&typeset(&units.force)),
        ));
    }
    out + "</div>\n</section>\n"
}

fn froude_figure(summary: &Summary) -> String {
    let beds: Vec<&str> = summary.beds.iter().map(|b| b.name.as_str()).collect();
    let head = "<section>\n<h2>Drag against Froude number</h2>\n";
    let Some(svg) = chart::froude(&summary.runs, &beds, &summary.units) else {
        return format!("{head}<p>There is no drag to show.</p>\n</section>\n");
    };
    let key = |(k, bed): (usize, &BedSummary)| {
        let depth = format!(
            "{}&nbsp;{}",
            short(bed.depth),
            escape(&typeset(&summary.units.length))
        );
        format!(
            "<span>{}{}, depth {depth}</span>",
            chart::marker(k),
            escape(&bed.name)
        )
    };
    let legend = match beds.len() {
        0 | 1 => String::new(),
        _ => {
            let keys: String = summary.beds.iter().enumerate().map(key).collect();
            format!("<p class=\"legend\">{keys}</p>\n")
        }
    };
    let points = match summary.runs.len() {
        1 => "1 point".to_owned(),
        n => format!("{n} points"),
    };
    format!(
        "{head}{legend}<figure class=\"narrow\">{svg}<figcaption>Mean drag \
         of each averaging window with bars of one standard error each way. No curve is fitted: \
         {points} cannot carry one.</figcaption></figure>\n</section>\n"
    )
}

/// All numbers as tables: a column for each bed or run, a row for each quantity.
fn numbers(summary: &Summary) -> String {
    let units = &summary.units;
    let list = [
        ("lengths", &units.length),
        ("times", &units.time),
        ("speeds", &units.speed),
        ("forces", &units.force),
        ("torques", &units.torque),
        ("energies", &units.energy),
    ];
    let list: Vec<String> = list
        .iter()
        .map(|(kind, unit)| format!("{kind} in {}", escape(&typeset(unit))))
        .collect();
    // In reduced units these three are the measures of everything.
    let symbols = match units.length.as_str() {
        "d" => "; d is the mean diameter of a grain, &rho; its density, g gravity",
        _ => "",
    };
    format!(
        "<section>\n<h2>Numbers</h2>\n<p>Units: {}{symbols}.</p>\n<h3>Beds</h3>\n{}\
         <h3>Drags</h3>\n{}{}</section>\n",
        list.join(", "),
        bed_table(&summary.beds, units),
        run_table(&summary.runs, units),
        plug_remark(&summary.runs),
    )
}

/// Rows of a table under the names of its columns.
struct Table<'a, T> {
    items: &'a [T],
    label: &'static str,
    html: String,
}

impl<'a, T> Table<'a, T> {
    fn new(label: &'static str, items: &'a [T], name: impl Fn(&T) -> &str) -> Self {
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

    fn row(&mut self, name: &str, unit: &str, note: &str, cell: impl Fn(&T) -> String) {
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

    fn finish(self) -> String {
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

fn bed_table(beds: &[BedSummary], units: &Units) -> String {
    let mut t = Table::new("Beds", beds, |b| &b.name);
    let (length, force, energy) = (&units.length, &units.force, &units.energy);
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
        |b| exact(b.surface),
    );
    t.row(
        "Depth",
        length,
        "of the intruder's centre below the surface",
        |b| exact(b.depth),
    );
    let note = "between 1 d above the base and 2 d below the surface";
    t.row("Packing fraction", "", note, |b| exact(b.packing_fraction));
    let note = "contacts of a free grain below the surface layer";
    t.row("Coordination number", "", note, |b| {
        exact(b.coordination_number)
    });
    t.row("Deepest overlap", "", "over the mean diameter", |b| {
        exact(b.overlap_max)
    });
    t.row("Kinetic energy", energy, "per free grain", |b| {
        exact(b.kinetic_energy_per_grain)
    });
    t.row("Weight", force, "of the free grains", |b| exact(b.weight));
    let note = "upward force on the free grains; at rest their weight";
    t.row("Support", force, note, |b| exact(b.support));
    t.row("Digest", "", "of the settled state", |b| digest(&b.digest));
    t.finish()
}

fn run_table(runs: &[RunSummary], units: &Units) -> String {
    let mut t = Table::new("Drags", runs, |r| &r.name);
    let (length, force) = (&units.length, &units.force);
    t.row("Bed", "", "it was dragged through", |r| escape(&r.bed));
    t.row("Froude number", "", "2 V &radic;(2 D/g)/(D + d)", |r| {
        exact(r.froude)
    });
    t.row("Speed V", &units.speed, "of the intruder along x", |r| {
        exact(r.speed)
    });
    t.row("Diameter D", length, "of the intruder", |r| {
        exact(r.diameter)
    });
    t.row(
        "Depth",
        length,
        "of its centre below the free surface",
        |r| exact(r.depth),
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
    t.row("Drag, uncut", force, "mean over all steps", |r| {
        exact(r.drag_uncut)
    });
    let note = "drag over the weight of the bed above the intruder's lowest point";
    t.row("Plug ratio", "", note, |r| exact(r.plug_ratio));
    t.row("Distance", length, "travelled", |r| exact(r.distance));
    t.row("Steps", "", "of the drag", |r| count(r.steps));
    t.row(
        "Window start",
        length,
        "travel at which averaging began",
        |r| exact(r.window_start),
    );
    t.row(
        "Window end",
        length,
        "travel at which averaging ended",
        |r| exact(r.window_end),
    );
    t.row(
        "Window steps",
        "",
        "averaged; errors from 8 equal blocks",
        |r| count(r.window_steps),
    );
    t.row("Digest", "", "of the final state", |r| digest(&r.digest));
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
    t.finish()
}

/// A warning where the drag is a large part of the weight above, in words.
fn plug_remark(runs: &[RunSummary]) -> String {
    let above = runs
        .iter()
        .filter(|r| r.plug_ratio.is_finite() && r.plug_ratio > PLUG[0]);
    let says = |(k, r): (usize, &RunSummary)| {
        let (froude, ratio) = (short(r.froude), short(r.plug_ratio));
        let unusable = r.plug_ratio > PLUG[1];
        let end = if unusable { " (unusable)" } else { "" };
        match k {
            0 => format!(
                "At Fr&nbsp;=&nbsp;{froude} the drag is {ratio} of the weight of the bed above the \
                 intruder{end}"
            ),
            _ => format!(", at Fr&nbsp;=&nbsp;{froude} it is {ratio}{end}"),
        }
    };
    let says: String = above.enumerate().map(says).collect();
    if says.is_empty() {
        return says;
    }
    format!(
        "<p class=\"remark\"><b>Plug ratio.</b> {says}: the layers above the intruder slide with \
         it to some degree; a larger box is needed for a drag free of this. As measured for \
         &mu;&nbsp;=&nbsp;0.5, a drag is sound below {} and unusable above {}.</p>\n",
        PLUG[0], PLUG[1],
    )
}

fn repeat(summary: &Summary, scenario_text: &str) -> String {
    format!(
        "<section>\n<h2>How to repeat it</h2>\n<p>Save the scenario below as \
         <code>scenario.toml</code> and, in the same folder, run</p>\n\
         <pre>bitgrain run scenario.toml</pre>\n<p>Made with bitgrain {}, arithmetic version {}: \
         runs with the same arithmetic version end in the digests above.</p>\n<h3>Scenario</h3>\n\
         <pre tabindex=\"0\">{}</pre>\n</section>\n",
        escape(&summary.version),
        summary.bits_version,
        escape(scenario_text),
    )
}

/// Text with no character that means something in HTML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// A unit as it is printed: `rho d^3 g` with Greek letter and power, on one line.
fn typeset(unit: &str) -> String {
    ["rho", "sqrt", "^2", "^3", "^4", " "]
        .iter()
        .zip([
            "\u{3c1}", "\u{221a}", "\u{b2}", "\u{b3}", "\u{2074}", "\u{a0}",
        ])
        .fold(unit.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// Mantissa and power of ten of a number rounded to so many digits.
fn scientific(x: f64, digits: usize) -> (String, i32) {
    let text = format!("{x:.*e}", digits.max(1) - 1);
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (mantissa.to_owned(), exponent.parse().unwrap_or(0))
}

/// A number to so many significant digits; a dash for what is no number.
fn significant(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return "\u{2014}".to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let (mantissa, exponent) = scientific(x, digits);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    let text = if (-4..7).contains(&exponent) {
        let decimals = digits as i32 - 1 - exponent;
        trimmed(&format!("{x:.*}", usize::try_from(decimals).unwrap_or(0)))
    } else {
        format!("{}{}", trimmed(&mantissa), power(exponent))
    };
    text.replace('-', "\u{2212}")
}

/// ` × 10` to a power.
fn power(exponent: i32) -> String {
    let high = |c: char| match c.to_digit(10) {
        Some(1) => '\u{b9}',
        Some(k @ 2..=3) => char::from_u32(0xb0 + k).unwrap_or(c),
        Some(k) => char::from_u32(0x2070 + k).unwrap_or(c),
        None => '\u{207b}',
    };
    let high: String = exponent.to_string().chars().map(high).collect();
    format!("\u{a0}\u{d7}\u{a0}10{high}")
}

/// Six significant digits.
fn number(x: f64) -> String {
    significant(x, 6)
}

/// Four, for running text.
fn short(x: f64) -> String {
    significant(x, 4)
}

/// Six digits to read, all of them in the markup.
fn exact(x: f64) -> String {
    match x.is_finite() {
        true => format!("<data value=\"{x:?}\">{}</data>", number(x)),
        false => number(x),
    }
}

/// A whole number in groups of three.
fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (k, c) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{202f}');
        }
        text.push(c);
    }
    format!("<data value=\"{n}\">{text}</data>")
}

/// A mean to the second digit of its standard error.
fn plus_minus(value: Mean) -> String {
    let (mean, error) = (value.mean, value.standard_error);
    if !mean.is_finite() || !error.is_finite() {
        return format!("{}\u{a0}\u{b1}\u{a0}{}", exact(mean), exact(error));
    }
    let exponent = scientific(mean, 6).1;
    let scaled = !(-4..7).contains(&exponent) && mean != 0.0;
    let ten: f64 = format!("1e{exponent}").parse().unwrap_or(1.0);
    let ten = if scaled { ten } else { 1.0 };
    let places = 1 - scientific(error / ten, 2).1;
    let most = 5 - if scaled { 0 } else { exponent };
    let text = if error == 0.0 || places > most {
        format!(
            "{}\u{a0}\u{b1}\u{a0}{}",
            number(mean / ten),
            significant(error / ten, 2)
        )
    } else {
        let places = usize::try_from(places).unwrap_or(0);
        format!(
            "{:.places$}\u{a0}\u{b1}\u{a0}{:.places$}",
            mean / ten,
            error / ten
        )
    };
    let text = match scaled {
        true => format!("({text}){}", power(exponent)),
        false => text,
    };
    let text = text.replace('-', "\u{2212}");
    format!("<data value=\"{mean:?}\" title=\"{mean:?} \u{b1} {error:?}\">{text}</data>")
}

fn digest(hex: &str) -> String {
    format!("<code class=\"digest\">{}</code>", escape(hex))
}

/// What the lines of a force chart are.
const LEGEND: &str = "<span><svg class=\"key\" viewBox=\"0 0 60 30\" aria-hidden=\"true\">\
<path d=\"M2 20L14 8L24 24L36 6L46 22L58 10\" fill=\"none\" stroke=\"#68778a\" \
stroke-width=\"2\"/></svg>drag, mean of each row</span><span><svg class=\"key\" \
viewBox=\"0 0 60 30\" aria-hidden=\"true\"><path d=\"M2 15H58\" stroke=\"#161b22\" \
stroke-width=\"6\"/></svg>its average from the start</span><span>\
<svg class=\"key\" viewBox=\"0 0 60 30\" aria-hidden=\"true\">\
<rect x=\"10\" width=\"50\" height=\"30\" fill=\"#f1ede2\"/><path d=\"M10 0V30\" \
stroke=\"#161b22\" stroke-width=\"3\" stroke-dasharray=\"6 4\"/></svg>averaging window</span>";

const CSS: &str = "
:root{color-scheme:light;--ink:#161b22;--soft:#59626d;--line:#d9d7d0}
*{box-sizing:border-box}
body{margin:0;background:#fff;color:var(--ink);font:16px/1.55 system-ui,sans-serif;
-webkit-text-size-adjust:100%}
main{max-width:1080px;margin:0 auto;padding:2rem 1rem 4rem}
h1{font-size:1.9rem;line-height:1.2;margin:0;font-weight:600;overflow-wrap:anywhere}
h2{font-size:1.3rem;font-weight:600;margin:2.8rem 0 .8rem;padding-top:.9rem;
border-top:1px solid var(--line)}
h3{font-size:1.05rem;font-weight:600;margin:1.6rem 0 .5rem}
p{max-width:46rem;margin:.6rem 0}
.kind{color:var(--soft);margin:.2rem 0 1.4rem}
.lead{font-size:1.06rem}
figure{margin:1rem 0;min-width:0}
figure.bed{max-width:46rem}
figure.narrow{max-width:35rem}
figcaption{color:var(--soft);font-size:.9rem;line-height:1.45;margin-top:.4rem}
figcaption b{color:var(--ink)}
svg.chart,svg.slice{display:block;width:100%;height:auto}
.grid{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,27rem),1fr));
gap:.6rem 2.2rem}
.legend{display:flex;flex-wrap:wrap;gap:.3rem 1.5rem;font-size:.9rem;color:var(--soft)}
.legend span{display:inline-flex;align-items:center;gap:.5rem}
svg.key{height:1rem;flex:none}
.none{color:var(--soft)}
.wide{overflow-x:auto;margin:.6rem 0 1rem}
table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums}
th,td{text-align:left;vertical-align:top;padding:.45rem .9rem;border-bottom:1px solid var(--line)}
thead th{border-bottom:2px solid var(--ink);vertical-align:bottom;overflow-wrap:anywhere}
th:first-child{position:sticky;left:0;background:#fff;width:19rem;min-width:10rem;
max-width:19rem;padding-left:0;font-weight:400}
th b{font-weight:600}
th i{color:var(--soft);font-style:normal;white-space:nowrap}
th small{display:block;color:var(--soft);font-size:.8rem;line-height:1.35}
td{min-width:8.5rem}
td data{white-space:nowrap}
.digest{display:block;font-size:.72rem;line-height:1.4;max-width:17ch;overflow-wrap:anywhere}
.remark{border-left:3px solid var(--ink);padding:.1rem 0 .1rem 1rem;margin:1rem 0}
code,pre{font-family:ui-monospace,monospace}
pre{background:#f6f5f1;padding:.9rem 1rem;overflow-x:auto;font-size:.82rem;line-height:1.5}
@media(min-width:700px){svg.slice text{font-size:10.5px}}
@media(max-width:500px){th:first-child{min-width:8.6rem;max-width:8.6rem;padding-right:.5rem}}
@media print{.wide,pre{overflow:visible}}
";

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(mean: f64, standard_error: f64) -> Mean {
        Mean {
            mean,
            standard_error,
        }
    }

    fn bed(x: f64) -> BedSummary {
        BedSummary {
            name: "bed".into(),
            grains: 12_345,
            frozen: 3,
            steps: 1_000_000,
            surface: x,
            depth: x,
            packing_fraction: x,
            coordination_number: x,
            overlap_max: x,
            kinetic_energy_per_grain: x,
            weight: x,
            support: x,
            digest: "0123abcd".into(),
        }
    }

    fn run(x: f64) -> RunSummary {
        RunSummary {
            name: "fr".into(),
            bed: "bed".into(),
            froude: x,
            speed: x,
            diameter: x,
            depth: x,
            distance: x,
            steps: 7,
            window_start: x,
            window_end: x,
            window_steps: 5,
            drag: mean(x, x),
            lift: mean(x, x),
            side: mean(-x, x),
            contacts: mean(x, x),
            drag_uncut: x,
            plug_ratio: x,
            digest: "89ef".into(),
            digest_parts: vec![("grains".into(), "4567".into())],
        }
    }

    /// One bed and two drags, all of whose measured numbers are `x`.
    fn summary(x: f64) -> Summary {
        Summary {
            version: "1.2.3".into(),
            bits_version: 9,
            scenario: "a <b> & c".into(),
            units: Units {
                length: "d".into(),
                time: "sqrt(d/g)".into(),
                speed: "sqrt(g d)".into(),
                force: "rho d^3 g".into(),
                torque: "rho d^4 g".into(),
                energy: "rho d^4 g".into(),
            },
            beds: vec![bed(x)],
            runs: vec![run(x), run(x)],
        }
    }

    fn series(x: f64) -> Vec<Vec<SeriesRow>> {
        let row = |k: u64| SeriesRow {
            step: k,
            time: x * k as f64,
            distance: x * k as f64,
            force_mean: [x * (k % 7) as f64, 0.0, 0.0],
            ..SeriesRow::default()
        };
        vec![(1..2000).map(row).collect(), Vec::new()]
    }

    fn picture(x: f64) -> BedPicture {
        let grain = |z| PictureGrain {
            position: [2.0, 3.0, z],
            radius: 0.5,
            frozen: z < 1.0,
        };
        BedPicture {
            name: "bed".into(),
            lo: [0.0; 3],
            hi: [10.0; 3],
            surface: x,
            grains: vec![grain(0.5), grain(1.5), grain(x)],
            intruder: ([5.0, 3.0, 4.0], 1.0),
        }
    }

    #[test]
    fn the_same_input_gives_the_same_bytes() {
        let make = || page(&summary(0.5), "a = 1", &series(0.1), &[picture(5.0)]);
        assert_eq!(make(), make());
    }

    #[test]
    fn the_page_is_self_contained_small_and_complete() {
        let text = page(&summary(0.5), "a = 1", &series(0.1), &[picture(5.0)]);
        assert!(!text.contains("http") && !text.contains("<script") && !text.contains("src="));
        assert!(text.len() < 200_000, "{}", text.len());
        let parts = ["0123abcd", "89ef", "4567", "1.2.3", "value=\"12345\""];
        assert!(parts.iter().all(|part| text.contains(part)));
    }

    #[test]
    fn nothing_in_the_text_is_taken_for_html() {
        let text = page(&summary(0.5), "x = \"<script>&\"", &[], &[]);
        assert!(text.contains("x = &quot;&lt;script&gt;&amp;&quot;"));
        assert!(text.contains("a &lt;b&gt; &amp; c") && !text.contains("a <b>"));
    }

    #[test]
    fn what_is_no_number_is_a_dash() {
        for x in [f64::NAN, f64::INFINITY, -0.0, 1e-300, 1e300] {
            let text = page(&summary(x), "", &series(x), &[picture(x)]);
            assert!(
                !text.contains("NaN") && !text.contains("inf"),
                "{x}: {text}"
            );
        }
    }

    #[test]
    fn a_page_of_nothing_is_a_page() {
        let mut empty = summary(1.0);
        page(&empty, "", &[], &[]);
        empty.runs.clear();
        page(&empty, "", &[], &[]);
        empty.beds.clear();
        assert!(page(&empty, "", &[], &[]).ends_with("</html>\n"));
    }

    #[test]
    fn a_drag_that_moves_the_layers_above_is_remarked_on() {
        let remark = |ratio| {
            let mut run = run(1.5);
            run.plug_ratio = ratio;
            plug_remark(&[run])
        };
        assert_eq!(remark(0.11), "");
        assert!(remark(0.2).contains("At Fr&nbsp;=&nbsp;1.5 the drag is 0.2 of the weight"));
        assert!(!remark(0.2).contains("(unusable)") && remark(0.31).contains("(unusable)"));
    }

    #[test]
    fn numbers_have_the_digits_they_deserve() {
        assert_eq!(number(1_234_567.8), "1234568");
        assert_eq!(number(-0.000_123_456_78), "\u{2212}0.000123457");
        assert_eq!(number(1.5e-9), "1.5\u{a0}\u{d7}\u{a0}10\u{207b}\u{2079}");
        let shown = |m, e| {
            let text = plus_minus(mean(m, e)).replace('\u{a0}', " ");
            let text = text.trim_end_matches("</data>");
            text.rsplit('>').next().unwrap_or("").to_owned()
        };
        assert_eq!(shown(83.5678, 1.834), "83.6 \u{b1} 1.8");
        assert_eq!(shown(-0.31, 0.0514), "\u{2212}0.310 \u{b1} 0.051");
        assert_eq!(shown(1.5, 0.0), "1.5 \u{b1} 0");
        assert_eq!(shown(1234.4, 560.0), "1234 \u{b1} 560");
        assert_eq!(
            shown(2.5e-8, 1.2e-9),
            "(2.50 \u{b1} 0.12) \u{d7} 10\u{207b}\u{2078}"
        );
    }
}
