//! One figure: traces and layout as plotly reads them, numbers no longer than a screen can show.

use crumple_signal::Sampled;
use serde_json::{Value, json};

/// Points of a measured curve that are drawn; more are thinned.
pub const MEASURED_POINTS: usize = 5_000;
/// Points of a computed, smooth curve that are drawn.
pub const COMPUTED_POINTS: usize = 1_600;

/// The colours: after Okabe and Ito (2008), which stay apart for the colour-blind, the light ones darkened to 3:1 on
/// white (WCAG 2.2, 1.4.11) and yellow left out.
pub mod colour {
    /// The measured record.
    pub const MEASURED: &str = "#1b2733";
    /// The record before filtering.
    pub const RAW: &str = "#8794a1";
    /// The main curve of a figure.
    pub const MAIN: &str = "#0072b2";
    /// Unloading, and what must be distinct from the main curve.
    pub const SECOND: &str = "#d55e00";
    /// Marks of events.
    pub const EVENT: &str = "#b0126d";
    /// Lines of a grid.
    pub const GRID: &str = "#e3e7eb";
    /// Guide lines drawn into a plane.
    pub const GUIDE: &str = "#c3cad1";
    /// Text.
    pub const TEXT: &str = "#1b2733";
    /// Text of second rank.
    pub const MUTED: &str = "#55616d";
    /// Curves of one kind.
    pub const SERIES: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#b86693", "#b87a00", "#2f8fc4"];
    /// Line styles that tell curves apart once the colours are used up, and in black and white.
    pub const DASHES: [&str; 4] = ["solid", "dash", "dot", "dashdot"];
}

/// A figure of the report.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Id of its element on the page.
    pub id: &'static str,
    /// Heading above it.
    pub title: &'static str,
    /// What it shows and what to take from it, plain text.
    pub caption: String,
    /// Height, CSS pixels.
    pub height_px: u32,
    /// Whether half the page's width is enough.
    pub half_width: bool,
    /// plotly traces.
    pub traces: Vec<Value>,
    /// plotly layout.
    pub layout: Value,
}

impl Figure {
    /// Traces and layout as one JSON text.
    pub fn to_json(&self) -> String {
        json!({"data": self.traces, "layout": self.layout}).to_string()
    }
}

/// Rounds numbers to a hundred-thousandth of their span, far below a pixel, so that their text is short.
pub fn compact(values: impl ExactSizeIterator<Item = f64> + Clone) -> Value {
    let (low, high) = values.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let span = if high > low { high - low } else { high.abs() };
    let exponent = if span > 0.0 && span.is_finite() { 5 - span.log10().floor() as i32 } else { 0 };
    let scale = 10_f64.powi(exponent.abs());
    let round = |x: f64| if exponent >= 0 { (x * scale).round() / scale } else { (x / scale).round() * scale };
    Value::Array(values.map(|x| number(round(x))).collect())
}

/// A number without a needless `.0`; `null` where it is not finite (plotly leaves a gap).
fn number(x: f64) -> Value {
    if x.fract() == 0.0 && x.abs() < 1e15 { Value::from(x as i64) } else { Value::from(x) }
}

/// Indices of the points that keep the look of a curve: of each bucket its lowest and highest, and both ends.
///
/// `None` where `values` has at most `limit` points and is drawn whole. Extremes survive, so a peak on the page is the
/// peak of the record; what lies between two extremes of a bucket is lost.
pub fn thinned(values: &[f64], limit: usize) -> Option<Vec<usize>> {
    let limit = limit.max(4);
    if values.len() <= limit {
        return None;
    }
    let buckets = (limit - 2) / 2;
    let mut kept = Vec::with_capacity(limit);
    kept.push(0);
    let inner = values.len() - 2;
    for bucket in 0..buckets {
        let from = 1 + bucket * inner / buckets;
        let to = 1 + (bucket + 1) * inner / buckets;
        let (mut low, mut high) = (from, from);
        for index in from..to {
            if values[index] < values[low] {
                low = index;
            }
            if values[index] > values[high] {
                high = index;
            }
        }
        kept.push(low.min(high));
        if low != high {
            kept.push(low.max(high));
        }
    }
    kept.push(values.len() - 1);
    Some(kept)
}

/// A trace of a signal over time in ms, its samples times `factor`.
///
/// A trace that is drawn whole carries the grid instead of its times.
pub fn over_time(signal: &Sampled, factor: f64, limit: usize) -> Value {
    let samples = signal.samples();
    match thinned(samples, limit) {
        None => json!({
            "type": "scatter", "mode": "lines",
            "x0": short(1e3 * signal.t0_s()), "dx": short(1e3 * signal.dt_s()),
            "y": compact(samples.iter().map(|y| y * factor)),
        }),
        Some(kept) => json!({
            "type": "scatter", "mode": "lines",
            "x": compact(kept.iter().map(|&k| 1e3 * signal.time_s(k))),
            "y": compact(kept.iter().map(|&k| samples[k] * factor)),
        }),
    }
}

/// A trace of one list of numbers over another of the same length.
pub fn over(x: &[f64], y: &[f64], limit: usize) -> Value {
    match thinned(y, limit) {
        None => json!({
            "type": "scatter", "mode": "lines", "x": compact(x.iter().copied()), "y": compact(y.iter().copied()),
        }),
        Some(kept) => json!({
            "type": "scatter", "mode": "lines",
            "x": compact(kept.iter().map(|&k| x[k])), "y": compact(kept.iter().map(|&k| y[k])),
        }),
    }
}

/// Lowest and highest of the values; `None` without any.
pub fn span(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    Some(values.iter().fold((first, first), |(low, high), &y| (low.min(y), high.max(y))))
}

/// Nine significant digits: enough to place a sample, without the tail of a binary fraction.
pub fn short(x: f64) -> f64 {
    format!("{x:.8e}").parse().unwrap_or(x)
}

/// Sets entries of a JSON object; what is there already is replaced.
pub fn set(object: &mut Value, entries: Value) {
    if let (Value::Object(object), Value::Object(entries)) = (object, entries) {
        object.extend(entries);
    }
}

/// A value with entries set: see [`set`].
pub fn with(mut object: Value, entries: Value) -> Value {
    set(&mut object, entries);
    object
}

/// Room above the panels for so many rows of marks' names and, over them, so many rows of legend.
pub fn room_above(layout: &mut Value, height_px: u32, name_rows: u32, legend_rows: u32) {
    let to_legend = 4 + 16 * name_rows;
    let top = to_legend + 14 + 21 * legend_rows;
    set(layout, json!({"margin": {"l": 68, "r": 18, "t": top, "b": 52}}));
    let panels = f64::from(height_px.saturating_sub(top + 52).max(1));
    if let Some(legend) = layout.get_mut("legend") {
        set(legend, json!({"y": short(1.0 + f64::from(to_legend) / panels)}));
    }
}

/// The layout every figure starts from.
pub fn base_layout() -> Value {
    json!({
        "font": {"family": "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif",
                 "size": 13, "color": colour::TEXT},
        "paper_bgcolor": "#ffffff", "plot_bgcolor": "#ffffff",
        "margin": {"l": 68, "r": 18, "t": 44, "b": 52},
        "hoverlabel": {"font": {"size": 12}, "namelength": -1},
        "legend": {"orientation": "h", "x": 0, "xanchor": "left", "y": 1.01, "yanchor": "bottom",
                   "font": {"size": 12}, "bgcolor": "rgba(255,255,255,0)"},
        "showlegend": true,
    })
}

/// An axis with a title.
pub fn axis(title: &str, entries: Value) -> Value {
    with(
        json!({
            "title": {"text": title, "standoff": 8}, "gridcolor": colour::GRID, "zerolinecolor": "#9aa5b1",
            "linecolor": "#9aa5b1", "ticks": "outside", "ticklen": 4, "tickcolor": "#9aa5b1", "automargin": true,
        }),
        entries,
    )
}

/// A vertical line through all panels at time `t_ms`, with its name above them.
pub fn event_line(t_ms: f64, name: &str, colour: &str, dash: &str) -> (Value, Value) {
    let line = json!({
        "type": "line", "xref": "x", "yref": "paper", "x0": short(t_ms), "x1": short(t_ms), "y0": 0, "y1": 1,
        "line": {"color": colour, "width": 1.2, "dash": dash}, "layer": "below",
    });
    let label = json!({
        "x": short(t_ms), "xref": "x", "y": 1, "yref": "paper", "xanchor": "center", "yanchor": "bottom", "yshift": 1,
        "text": name, "showarrow": false, "font": {"size": 12, "color": colour},
        "bgcolor": "rgba(255,255,255,0.8)",
    });
    (line, label)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_stand_out_from_the_paper() {
        // Relative luminance and contrast as WCAG 2.2 defines them; 1.05 is that of white plus 0.05.
        let contrast = |hex: &str| {
            let channel = |at: usize| {
                let c = f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            };
            1.05 / (0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5) + 0.05)
        };
        let lines = [colour::MEASURED, colour::RAW, colour::MAIN, colour::SECOND, colour::EVENT];
        for colour in lines.iter().chain(&colour::SERIES) {
            assert!(contrast(colour) >= 3.0, "{colour}: {}", contrast(colour));
        }
        for text in [colour::TEXT, colour::MUTED] {
            assert!(contrast(text) >= 4.5, "{text}: {}", contrast(text));
        }
    }

    #[test]
    fn thinning_keeps_both_ends_and_the_extremes() {
        let mut values: Vec<f64> = (0..100_000).map(|k| (f64::from(k) * 1e-3).sin()).collect();
        values[54_321] = 7.0;
        values[77_777] = -9.0;
        let kept = thinned(&values, 5_000).unwrap();
        assert!(kept.len() <= 5_000, "{}", kept.len());
        assert!(kept.is_sorted_by(|a, b| a < b));
        for index in [0, 54_321, 77_777, 99_999] {
            assert!(kept.contains(&index), "{index}");
        }
    }

    #[test]
    fn a_short_curve_is_drawn_whole() {
        assert_eq!(thinned(&[1.0; 5_000], 5_000), None);
        assert_eq!(thinned(&[], 5_000), None);
        // More than the limit, all equal: one point a bucket.
        assert_eq!(thinned(&[1.0; 12], 6), Some(vec![0, 1, 6, 11]));
    }

    #[test]
    fn compact_numbers_are_short_and_within_a_hundred_thousandth_of_the_span() {
        let values = [0.0, 0.123_456_789, 25.0 / 3.0];
        assert_eq!(compact(values.iter().copied()).to_string(), "[0,0.12346,8.33333]");
        let large = [1_234_567_890.123, 1_299_999_999.5];
        assert_eq!(compact(large.iter().copied()).to_string(), "[1234567900,1300000000]");
        assert_eq!(compact([2.5, 2.5].into_iter()).to_string(), "[2.5,2.5]");
        assert_eq!(compact([0.0, -1e-9].into_iter()).to_string(), "[0,-1e-9]");
    }
}
