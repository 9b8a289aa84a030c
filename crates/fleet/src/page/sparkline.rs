//! The pulse of a run as a small line.

use std::fmt::Write as _;
use std::path::Path;

use crumple_artifact::Artifact;

use crate::tables::rows::Row;

/// Artifact with the filtered pulse.
const FILTERED: &str = "2-filter.mcap";
/// Time that is shown, s after time zero.
const SHOWN_S: f64 = 0.15;
/// Points of the line, and its size.
const POINTS: usize = 31;
const HEIGHT: f64 = 18.0;

/// The filtered acceleration of a run's pulse over 150 ms, upwards as the car slows down; `None` where there is none.
pub(crate) fn sparkline(fleet: &Path, row: &Row) -> Option<String> {
    let summary = row.summary.as_ref()?;
    let artifact = Artifact::open(&fleet.join(&row.run.folder).join(FILTERED)).ok()?;
    let wave = &artifact.waves().get(summary.test.channel.as_deref()?)?.sampled;
    let zero = summary.events.as_ref().map_or(0.0, |events| events.time_zero_s);
    let at = |time: f64| {
        let place = ((zero + time - wave.t0_s()) / wave.dt_s()).round();
        if place < 0.0 { None } else { wave.samples().get(place as usize).map(|a| -a) }
    };
    let values: Vec<f64> = (0..POINTS).map_while(|k| at(SHOWN_S * k as f64 / (POINTS - 1) as f64)).collect();
    line(&values)
}

fn line(values: &[f64]) -> Option<String> {
    let (low, high) = values.iter().fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(*v), high.max(*v)));
    if values.len() < 2 || high <= low {
        return None;
    }
    let mut path = String::new();
    let mut before = 0;
    for (number, value) in values.iter().enumerate() {
        let y = (HEIGHT * (high - value) / (high - low)).round() as i32;
        // Relative steps: the shortest text. Writing to a string does not fail.
        let _ = match number {
            0 => write!(path, "M0 {y}"),
            1 => write!(path, "l2 {}", y - before),
            _ => write!(path, " 2 {}", y - before),
        };
        before = y;
    }
    Some(format!("<svg class=s viewBox=\"0 0 60 18\"><path d=\"{path}\"/></svg>"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_spans_its_box() {
        let svg = line(&[0.0, 10.0, 5.0]).unwrap();
        assert!(svg.contains("M0 18l2 -18 2 9"), "{svg}");
        assert!(line(&[0.0, 0.0]).is_none() && line(&[1.0]).is_none());
    }
}
