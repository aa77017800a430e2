//! The page of a benchmark: each curve over the published points and theory, the checks, the comparisons.

use super::page::{Top, assembled, remark, row};
use super::plot::marker;
use super::scatter::{Line, Mark, Range, scatter};
use super::table::Table;
use super::text::{brief, escape};
use bitgrain_lab::benchmark::{Benchmark, Chart, Check, Curve, Source, Test};
use bitgrain_sim::format::short;

/// Marks along a computed curve of which no points were published.
const MARKS: usize = 25;

/// Markers of computed, published and other points.
const COMPUTED: usize = 0;
const PUBLISHED: usize = 1;
const OTHER: usize = 2;

/// One self-contained HTML page of a benchmark.
pub fn benchmark_page(benchmark: &Benchmark) -> String {
    let sections: String = benchmark.tests.iter().map(section).collect();
    let text = |(title, words): &(&str, &str)| remark(title, &escape(words));
    let failed = benchmark.checks().filter(|check| !check.holds);
    let failed = failed.map(|check| {
        let words = format!("{}: {}", check.material, check.what);
        remark("A check does not hold", &escape(&words))
    });
    let about = row("Benchmark", &escape(benchmark.source))
        + &row("Published points", &escape(&benchmark.published))
        + &row(
            "Repeat",
            &format!("<code>bitgrain benchmark {}</code>", benchmark.name),
        );
    let top = Top {
        name: benchmark.name,
        kind: benchmark.title,
        style: "",
        lead: lead(benchmark),
        remarks: failed.chain(benchmark.remarks.iter().map(text)).collect(),
        about,
    };
    assembled(&top, &sections)
}

/// What came of the checks.
fn lead(benchmark: &Benchmark) -> String {
    let all = benchmark.checks().count();
    let held = benchmark.checks().filter(|check| check.holds).count();
    let by_part = |a: &&Check, b: &&Check| {
        let part = |check: &Check| check.deviation / check.tolerance;
        part(a).total_cmp(&part(b))
    };
    let worst = benchmark
        .checks()
        .max_by(by_part)
        .map_or(String::new(), |check| {
            format!(
                " The largest part of a tolerance that is taken up is {} of {}: {}, {}.",
                short(check.deviation),
                short(check.tolerance),
                escape(&check.material),
                escape(check.what),
            )
        });
    format!(
        "<p class=\"lead\">{held} of {all} numbers that theory fixes are within their tolerance.{worst}</p>\n"
    )
}

fn section(test: &Test) -> String {
    let mut out = format!(
        "<section>\n<h2>Test {}</h2>\n<p><b>{}.</b> {}</p>\n",
        test.number,
        escape(test.title),
        escape(&test.setup)
    );
    if !test.outcome.is_empty() {
        out.push_str(&format!("<p>{}.</p>\n", escape(&test.outcome)));
    }
    out.push_str(&legend(&test.charts));
    out.push_str("<div class=\"grid\">\n");
    out.extend(test.charts.iter().map(figure));
    out.push_str("</div>\n<h3>Against theory</h3>\n");
    out.push_str(&checks(&test.checks));
    if !test.comparisons.is_empty() {
        out.push_str("<h3>Beside published points</h3>\n");
        out.push_str(&comparisons(test));
    }
    out + "</section>\n"
}

/// The marker of a curve's points, hollow unless they are ours; none for a line.
fn shape(source: &Source) -> Option<usize> {
    match source {
        Source::Computed => Some(COMPUTED),
        Source::Theory => None,
        Source::Published(_) => Some(PUBLISHED),
        Source::Other(_) => Some(OTHER),
    }
}

fn legend(charts: &[Chart]) -> String {
    let mut keys = vec![
        format!(
            "<span>{}dark line, or points on it: bitgrain</span>",
            marker(COMPUTED, false)
        ),
        "<span>grey line on it: theory, where it is exact or nearly so</span>".to_owned(),
    ];
    for curve in charts.iter().flat_map(|chart| &chart.curves) {
        let (Source::Published(by) | Source::Other(by)) = &curve.source else {
            continue;
        };
        let shape = shape(&curve.source).unwrap_or(OTHER);
        let key = format!("<span>{}{}</span>", marker(shape, true), escape(by));
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    format!("<p class=\"legend\">{}</p>\n", keys.concat())
}

fn figure(chart: &Chart) -> String {
    let title = format!("{}: {}", chart.title, chart.labels[1]);
    let line = |curve: &Curve| {
        let heavy = match curve.source {
            Source::Computed => true,
            Source::Theory => false,
            _ => return None,
        };
        Some(Line {
            points: curve.points.clone(),
            heavy,
        })
    };
    let lines: Vec<Line> = chart.curves.iter().filter_map(line).collect();
    let is_theirs =
        |curve: &&Curve| matches!(curve.source, Source::Published(_) | Source::Other(_));
    let any_theirs = chart.curves.iter().any(|curve| is_theirs(&curve));
    let mut marks = Vec::new();
    for curve in &chart.curves {
        let Some(shape) = shape(&curve.source) else {
            continue;
        };
        let ours = curve.source == Source::Computed;
        if ours && any_theirs {
            continue;
        }
        let every = if ours {
            curve.points.len().div_ceil(MARKS).max(1)
        } else {
            1
        };
        let points = curve.points.iter().step_by(every);
        marks.extend(points.map(|at| Mark {
            hollow: !ours,
            ..Mark::bare(*at, shape)
        }));
    }
    let svg = scatter(&title, &chart.labels, &marks, &lines, [Range::FromZero; 2]);
    let svg = svg.unwrap_or_else(|| "<p class=\"none\">No points.</p>".to_owned());
    format!(
        "<figure>{svg}<figcaption><b>{}</b></figcaption></figure>\n",
        escape(&chart.title)
    )
}

fn checks(checks: &[Check]) -> String {
    let columns = [
        "cases",
        "expected",
        "measured",
        "deviation",
        "allowed",
        "holds",
    ];
    let mut table = Table::new("Checks", &columns, |name| name);
    for check in checks {
        let cell = |column: &&str| match *column {
            "cases" => check.cases.to_string(),
            "expected" => brief(check.expected),
            "measured" => brief(check.measured),
            "deviation" => brief(check.deviation),
            "allowed" => brief(check.tolerance),
            _ => if check.holds { "yes" } else { "<b>no</b>" }.to_owned(),
        };
        table.row(&check.material, "", &escape(check.what), cell);
    }
    table.finish()
}

fn comparisons(test: &Test) -> String {
    let columns = [
        "points",
        "mean difference over span",
        "largest over span",
        "span",
    ];
    let mut table = Table::new("Comparisons", &columns, |name| name);
    for one in &test.comparisons {
        let cell = |column: &&str| match *column {
            "points" => one.points.to_string(),
            "mean difference over span" => brief(one.mean),
            "largest over span" => brief(one.largest),
            _ => brief(one.span),
        };
        let note = format!(
            "{}, {}; {}",
            one.quantity.replace('_', " "),
            one.range,
            one.with
        );
        table.row(&one.material, "", &escape(&note), cell);
    }
    table.finish()
}
