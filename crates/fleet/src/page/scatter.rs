//! One quantity over another, a point a run; outliers are links to their reports.

use std::fmt::Write as _;

use crate::page::markup::{escaped, link, number};
use crate::page::outliers::line_and_outliers;
use crate::page::quantities::Quantity;
use crate::tables::rows::Row;

/// Size and margins of a figure.
pub(crate) const WIDTH: f64 = 320.0;
pub(crate) const HEIGHT: f64 = 200.0;
pub(crate) const LEFT: f64 = 44.0;
pub(crate) const BOTTOM: f64 = 34.0;
const TOP: f64 = 8.0;
const RIGHT: f64 = 8.0;
/// Most outliers that are drawn as links.
const LINKS: usize = 40;

/// An axis: what stands at its ends.
#[derive(Clone, Copy)]
pub(crate) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// Of values, with room at both ends.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
        let room = if high > low { 0.04 * (high - low) } else { 0.5 * low.abs().max(1.0) };
        Self { low: low - room, high: high + room }
    }

    /// Of counts: from zero to a little above the largest.
    pub(crate) fn of_counts(most: f64) -> Self {
        Self { low: 0.0, high: 1.04 * most }
    }

    /// Place of a value, 0 to 1.
    pub(crate) fn place(self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Round values on it.
    pub(crate) fn ticks(self) -> Vec<f64> {
        let rough = (self.high - self.low) / 4.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step = power * [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * power >= rough).unwrap_or(10.0);
        let first = (self.low / step).ceil() as i64;
        (first..).map(|k| k as f64 * step).take_while(|tick| *tick <= self.high).collect()
    }
}

/// Place on the figure.
pub(crate) fn x_of(place: f64) -> f64 {
    LEFT + place * (WIDTH - LEFT - RIGHT)
}

/// Place on the figure.
pub(crate) fn y_of(place: f64) -> f64 {
    HEIGHT - BOTTOM - place * (HEIGHT - BOTTOM - TOP)
}

/// The frame of a figure: axes with their labels.
pub(crate) fn frame(x: Range, y: Range, label_x: &str, label_y: &str) -> String {
    let mut svg =
        format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{label_y} over {label_x}\">");
    let step = |ticks: &[f64]| ticks.windows(2).next().map_or(1.0, |pair| pair[1] - pair[0]);
    let text = |value: f64, step: f64| format!("{value:.*}", (-step.log10().floor()).max(0.0) as usize);
    let (ticks_x, ticks_y) = (x.ticks(), y.ticks());
    for tick in &ticks_x {
        let at = x_of(x.place(*tick));
        // Writing to a string does not fail.
        let _ = write!(svg, "<path class=g d=\"M{at:.1} {TOP}V{:.0}\"/>", HEIGHT - BOTTOM);
        let _ = write!(
            svg,
            "<text x={at:.1} y={:.0} text-anchor=middle>{}</text>",
            HEIGHT - 21.0,
            text(*tick, step(&ticks_x))
        );
    }
    for tick in &ticks_y {
        let at = y_of(y.place(*tick));
        let _ = write!(svg, "<path class=g d=\"M{LEFT} {at:.1}H{:.0}\"/>", WIDTH - RIGHT);
        let _ = write!(
            svg,
            "<text x={} y={:.1} text-anchor=end>{}</text>",
            LEFT - 4.0,
            at + 3.0,
            text(*tick, step(&ticks_y))
        );
    }
    let _ = write!(svg, "<text x={WIDTH} dx=-8 y={} text-anchor=end>{label_x}</text>", HEIGHT - 6.0);
    svg
}

/// `y` over `x` of the runs that have both; empty where fewer than two have.
pub(crate) fn scatter(rows: &[Row], x: Quantity, y: Quantity) -> String {
    let both = |row: &'_ Row| Some(((x.of)(row)?, (y.of)(row)?));
    let of_rows: Vec<(&Row, (f64, f64))> = rows.iter().filter_map(|row| Some((row, both(row)?))).collect();
    if of_rows.len() < 2 {
        return String::new();
    }
    let points: Vec<(f64, f64)> = of_rows.iter().map(|(_, point)| *point).collect();
    let range_x = Range::of(points.iter().map(|point| point.0));
    let range_y = Range::of(points.iter().map(|point| point.1));
    let mut svg = frame(range_x, range_y, &x.label(), &y.label());
    let place = |(px, py): (f64, f64)| (x_of(range_x.place(px)), y_of(range_y.place(py)));
    let fitted = line_and_outliers(&points);
    let is_outlier = |number: usize| fitted.as_ref().is_some_and(|(_, outliers)| outliers[number]);
    let mut dots = String::new();
    for (_, point) in points.iter().enumerate().filter(|(number, _)| !is_outlier(*number)) {
        let (px, py) = place(*point);
        let _ = write!(dots, "M{px:.0} {py:.0}h0");
    }
    let _ = write!(svg, "<path class=p d=\"{dots}\"/>");
    if let Some((line, _)) = &fitted {
        let ends = [range_x.low, range_x.high].map(|at| place((at, line.value(at).clamp(range_y.low, range_y.high))));
        let _ =
            write!(svg, "<path class=l d=\"M{:.0} {:.0}L{:.0} {:.0}\"/>", ends[0].0, ends[0].1, ends[1].0, ends[1].1);
    }
    let outliers = of_rows.iter().enumerate().filter(|(number, _)| is_outlier(*number)).take(LINKS);
    for (_, (row, point)) in outliers {
        let (px, py) = place(*point);
        let _ = write!(
            svg,
            "<a href=\"{}/report.html\"><circle class=o cx={px:.0} cy={py:.0} r=4>\
             <title>{}: {} {}</title></circle></a>",
            link(&row.run.folder),
            escaped(&row.run.record.identity),
            number(point.1, 3),
            y.unit
        );
    }
    format!("<figure><figcaption>{}</figcaption>{svg}</svg></figure>", y.label())
}
