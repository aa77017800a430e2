//! The parts of charts: axes with round ticks, grid, error bars, markers.

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::text::escape;
use bitgrain_sim::format::number;

/// Size of a drawing: three times that of the smallest screen it must be read on, because
/// coordinates are whole numbers and curves would show steps at a coarser scale.
const SIZE: (u32, u32) = (1440, 930);
/// Text sizes are divided by 1.24 on their way into the SVG: this is 44 there, 15 at a third.
const FONT: f64 = 54.56;
pub(super) const INK: RGBColor = RGBColor(22, 27, 34);
pub(super) const THIN: RGBColor = RGBColor(104, 119, 138);
pub(super) const GRID: RGBColor = RGBColor(228, 228, 224);
pub(super) const BAND: RGBColor = RGBColor(241, 237, 226);
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;
pub(super) type Area<'b> = DrawingArea<SVGBackend<'b>, Shift>;
pub(super) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// An axis with round tick values.
#[derive(Clone)]
pub(super) struct Axis {
    /// Where it begins.
    pub lo: f64,
    /// Where it ends.
    pub hi: f64,
    /// Values of the ticks and their labels.
    pub ticks: Vec<(f64, String)>,
    /// Whether equal steps along it are equal ratios; its ends are above zero then.
    log: bool,
}

impl Axis {
    /// How far along it a value is: 0 where it begins, 1 where it ends.
    fn part(&self, value: f64) -> f64 {
        match self.log {
            true => libm::log(value / self.lo) / libm::log(self.hi / self.lo),
            false => (value - self.lo) / (self.hi - self.lo),
        }
    }

    /// The value so far along it.
    pub(super) fn at(&self, part: f64) -> f64 {
        match self.log {
            true => self.lo * libm::pow(self.hi / self.lo, part),
            false => self.lo + part * (self.hi - self.lo),
        }
    }
}

/// An axis of ratios with room beyond both values, which are above zero, and ticks at round numbers.
pub(super) fn log_axis(low: f64, high: f64) -> Axis {
    let good = |x: f64| x > 1e-100 && drawable(x);
    let (low, high) = if good(low) && good(high) && low <= high {
        (low, high)
    } else {
        (1.0, 10.0)
    };
    // An empty range would have no ratio.
    let room = libm::pow(high / low, 0.06).max(1.06);
    let (lo, hi) = (low / room, high * room);
    let decades = libm::log10(hi / lo);
    let digits: &[u32] = match decades {
        ..=1.3 => &[1, 2, 3, 4, 5, 7],
        ..=3.0 => &[1, 3],
        _ => &[1],
    };
    let first = libm::floor(libm::log10(lo)) as i32;
    let last = libm::ceil(libm::log10(hi)) as i32;
    let tick = |(power, digit): (i32, u32)| {
        let value: f64 = format!("{digit}e{power}").parse().unwrap_or(f64::NAN);
        (value, number(value))
    };
    let all = (first..=last).flat_map(|power| digits.iter().map(move |digit| (power, *digit)));
    let inside = |(x, _): &(f64, String)| (lo..=hi).contains(x);
    let mut ticks: Vec<_> = all.map(tick).filter(inside).collect();
    if ticks.len() < 3 {
        ticks = axis(lo, hi, 4).ticks;
    }
    Axis {
        lo,
        hi,
        ticks,
        log: true,
    }
}

/// An axis from `lo` to `hi` with about `count` ticks at multiples of 1, 2 or 5 times a power of
/// ten. Powers come from decimal text: the same bits on every platform.
pub(super) fn axis(lo: f64, hi: f64, count: usize) -> Axis {
    let (lo, hi) = if drawable(lo) && drawable(hi) && hi - lo > 1e-100 {
        (lo, hi)
    } else {
        (0.0, 1.0)
    };
    let raw = (hi - lo) / count.max(1) as f64;
    let text = format!("{raw:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa: f64 = mantissa.parse().unwrap_or(1.0);
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let (factor, exponent) = match mantissa {
        ..1.5 => (1, exponent),
        ..3.0 => (2, exponent),
        ..7.0 => (5, exponent),
        _ => (1, exponent + 1),
    };
    let step: f64 = format!("{factor}e{exponent}").parse().unwrap_or(raw);
    let first = (lo / step - 1e-6).ceil() as i64;
    let last = (hi / step + 1e-6).floor() as i64;
    let decimals = usize::try_from(-exponent).unwrap_or(0);
    let label = |x: f64| match exponent {
        -4..6 => format!("{x:.decimals$}").replace('-', "\u{2212}"),
        _ => number(x),
    };
    let ticks = (first..=last)
        .map(|k| k as f64 * step)
        .map(|x| (x, label(x)))
        .collect();
    Axis {
        lo,
        hi,
        ticks,
        log: false,
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        limit.0 + (self.part(*value) * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let shown = if hint.weight().allow_light_points() {
            0
        } else {
            self.ticks.len()
        };
        self.ticks.iter().take(shown).map(|t| t.0).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.lo..self.hi
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let tick = self.ticks.iter().find(|t| t.0 == *value);
        tick.map_or(String::new(), |t| t.1.clone())
    }
}

/// Finite, and small enough that a range of such numbers is finite too.
pub(super) fn drawable(x: f64) -> bool {
    x.abs() < 1e100
}

/// A range with zero in it and room above and below the data.
pub(super) fn padded(low: f64, high: f64) -> Axis {
    let room = 0.07 * (high - low);
    let low = if low < 0.0 { low - room } else { low };
    axis(low, if high > 0.0 { high + room } else { high }, 6)
}

/// Draws into a string and puts it in the form the page holds: as wide as its column, with a title.
pub(super) fn svg(title: &str, draw: impl FnOnce(&Area) -> Drawn) -> String {
    let mut out = String::new();
    {
        let area = SVGBackend::with_string(&mut out, SIZE).into_drawing_area();
        draw(&area)
            .and_then(|()| area.present())
            .expect("a string takes every drawing");
    }
    let body = out.split_once('>').map_or("", |(_, body)| body);
    let (width, height) = SIZE;
    let title = escape(title);
    format!(
        "<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-label=\"{title}\"><title>{title}</title>{body}"
    )
}

pub(super) fn chart<'a, 'b>(
    area: &'a Area<'b>,
    x: &Axis,
    y: &Axis,
) -> Result<Chart<'a, 'b>, DrawingAreaErrorKind<std::io::Error>> {
    below(area, x, y, 24)
}

/// A chart below so much room.
fn below<'a, 'b>(
    area: &'a Area<'b>,
    x: &Axis,
    y: &Axis,
    room: u32,
) -> Result<Chart<'a, 'b>, DrawingAreaErrorKind<std::io::Error>> {
    let longest = y.ticks.iter().map(|t| t.1.chars().count()).max();
    let labels = 26 * u32::try_from(longest.unwrap_or(1)).unwrap_or(1);
    ChartBuilder::on(area)
        .margin_top(room)
        .margin_right(84)
        .margin_bottom(6)
        .margin_left(22)
        .x_label_area_size(140)
        .y_label_area_size(100 + labels)
        .build_cartesian_2d(x.clone(), y.clone())
}

/// Grid, axes, tick labels and axis labels.
pub(super) fn mesh(chart: &mut Chart, labels: &[String; 2]) -> Drawn {
    let text = ("sans-serif", FONT).into_font().color(&INK);
    chart
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(2))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(3))
        .set_all_tick_mark_size(14)
        .label_style(text.clone())
        .axis_desc_style(text)
        .x_desc(&labels[0])
        .y_desc(&labels[1])
        .draw()
}

/// A chart with a second axis along its top, from zero to the same end as `x`, and its label.
pub(super) fn chart_with_top<'a, 'b>(
    area: &'a Area<'b>,
    x: &Axis,
    y: &Axis,
    top: &Axis,
    label: &str,
) -> Result<Chart<'a, 'b>, DrawingAreaErrorKind<std::io::Error>> {
    let chart = below(area, x, y, 150)?;
    let text = ("sans-serif", FONT).into_font().color(&INK);
    let centred = text.pos(Pos::new(HPos::Center, VPos::Bottom));
    let place = |part: f64| chart.backend_coord(&(x.at(part), y.hi));
    for (value, words) in &top.ticks {
        let (across, down) = place(top.part(*value));
        let tick = [(across, down), (across, down - 14)];
        area.draw(&PathElement::new(tick, INK.stroke_width(3)))?;
        let at = (across, down - 18);
        area.draw(&Text::new(words.clone(), at, centred.clone()))?;
    }
    let ends = [place(0.0), place(1.0)];
    area.draw(&PathElement::new(ends, INK.stroke_width(3)))?;
    let at = ((ends[0].0 + ends[1].0) / 2, ends[0].1 - 74);
    area.draw(&Text::new(label.to_owned(), at, centred))?;
    Ok(chart)
}

/// A dashed vertical line over the whole height.
pub(super) fn dashes(x: f64, y: &Axis) -> Vec<PathElement<(f64, f64)>> {
    let piece = (y.hi - y.lo) / 47.0;
    let at = |k: usize| y.lo + piece * k as f64;
    let dash = |k| PathElement::new([(x, at(k)), (x, at(k + 1))], INK.stroke_width(4));
    (0..47).step_by(2).map(dash).collect()
}

/// An upright bar with caps, over an axis.
pub(super) fn bar(x: f64, low: f64, high: f64, axis: &Axis) -> Vec<PathElement<(f64, f64)>> {
    let line = |from, to| PathElement::new([from, to], INK.stroke_width(5));
    let cap = |side: f64| axis.at(axis.part(x) + side * 0.008);
    let across = |y| line((cap(-1.0), y), (cap(1.0), y));
    vec![line((x, low), (x, high)), across(low), across(high)]
}

/// Markers that differ from one another, each filled or hollow.
pub(super) const SHAPES: usize = 8;

/// Corners of a marker; none for a circle.
fn corners(shape: usize) -> &'static [(i32, i32)] {
    match shape % SHAPES {
        0 => &[],
        1 => &[(-12, -12), (12, -12), (12, 12), (-12, 12)],
        2 => &[(0, -16), (15, 11), (-15, 11)],
        3 => &[(0, -18), (15, 0), (0, 18), (-15, 0)],
        4 => &[(0, 16), (15, -11), (-15, -11)],
        5 => &[(-16, 0), (11, 15), (11, -15)],
        6 => &[(16, 0), (-11, 15), (-11, -15)],
        _ => &[(-14, -14), (14, -14), (-14, 14), (14, 14)],
    }
}

/// Draws a marker, hollow if a point is less certain than the others.
pub(super) fn draw_marker(chart: &mut Chart, at: (f64, f64), shape: usize, hollow: bool) -> Drawn {
    let corners = corners(shape);
    let fill = if hollow { WHITE } else { INK };
    if corners.is_empty() {
        chart.draw_series([Circle::new(at, 13, fill.filled())])?;
        chart.draw_series([Circle::new(at, 13, INK.stroke_width(5))])?;
        return Ok(());
    }
    let closed: Vec<_> = corners.iter().chain(&corners[..1]).copied().collect();
    let inner = Polygon::new(corners, fill.filled());
    let outer = PathElement::new(closed, INK.stroke_width(5));
    chart.draw_series([EmptyElement::at(at) + inner + outer])?;
    Ok(())
}

/// Draws a cross, for a second reading of a point.
pub(super) fn draw_cross(chart: &mut Chart, at: (f64, f64)) -> Drawn {
    for line in [vec![(-13, -13), (13, 13)], vec![(-13, 13), (13, -13)]] {
        let line = PathElement::new(line, THIN.stroke_width(6));
        chart.draw_series([EmptyElement::at(at) + line])?;
    }
    Ok(())
}

/// A marker for the legend.
pub(super) fn marker(shape: usize, hollow: bool) -> String {
    let fill = if hollow { "#fff" } else { "#161b22" };
    let style = format!("fill=\"{fill}\" stroke=\"#161b22\" stroke-width=\"5\"");
    let corners = corners(shape);
    let points: Vec<String> = corners.iter().map(|(x, y)| format!("{x},{y}")).collect();
    let body = match corners.is_empty() {
        true => format!("<circle r=\"13\" {style}/>"),
        false => format!("<polygon points=\"{}\" {style}/>", points.join(" ")),
    };
    format!("<svg class=\"key\" viewBox=\"-22 -22 44 44\" aria-hidden=\"true\">{body}</svg>")
}

/// A cross for the legend.
pub(super) const CROSS: &str = "<svg class=\"key\" viewBox=\"-22 -22 44 44\" aria-hidden=\"true\"><path \
    d=\"M-13 -13L13 13M-13 13L13 -13\" stroke=\"#68778a\" stroke-width=\"6\"/></svg>";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_ratios_are_equally_long_on_an_axis_of_ratios() {
        let axis = log_axis(0.1, 10.0);
        assert!(axis.lo < 0.1 && axis.hi > 10.0);
        let labels: Vec<&str> = axis.ticks.iter().map(|t| t.1.as_str()).collect();
        assert_eq!(labels, ["0.1", "0.3", "1", "3", "10"]);
        let whole = (0, 1000);
        let places: Vec<i32> = [0.1, 1.0, 10.0]
            .iter()
            .map(|x| axis.map(x, whole))
            .collect();
        assert_eq!(places[1], 500);
        assert_eq!(places[2] - places[1], places[1] - places[0]);
        assert!((axis.at(axis.part(3.0)) - 3.0).abs() < 1e-12);
        let one = log_axis(5.0, 5.0);
        assert!(one.lo < 5.0 && one.hi > 5.0);
        assert_eq!(log_axis(-1.0, 0.0).ticks, log_axis(1.0, 10.0).ticks);
    }

    #[test]
    fn ticks_are_round_numbers() {
        let labels = |lo, hi| -> Vec<String> {
            let ticks = axis(lo, hi, 5).ticks;
            ticks.into_iter().map(|t| t.1).collect()
        };
        assert_eq!(labels(0.0, 100.0), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(
            labels(-0.2, 0.25),
            ["\u{2212}0.2", "\u{2212}0.1", "0.0", "0.1", "0.2"]
        );
        assert_eq!(labels(0.0, 1e-7).len(), 6);
        assert_eq!(labels(f64::NAN, 1.0), labels(0.0, 1.0));
        assert_eq!(labels(3.0, 3.0), labels(0.0, 1.0));
    }
}
