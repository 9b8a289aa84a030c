//! A curve without axes, for a cell of a table.

use crumple_numerics::thinning::thinned;

use super::figure::span;
use super::polyline::polyline;

/// Width and height, in units of which the style of a page makes pixels.
const WIDTH: f64 = 90.0;
const HEIGHT: f64 = 20.0;
/// Room for half of the line's width.
const EDGE: f64 = 1.0;
/// The line stays this near to the curve, units.
const NEAR: f64 = 0.35;

/// Points with `x` between two ends as a small line, its zero within the cell. `None`: fewer than two points, or all
/// are zero.
///
/// HTML, not XML: attributes have no quotation marks where they need none, since a table has hundreds of them.
pub fn sparkline(points: &[[f64; 2]], [from, to]: [f64; 2]) -> Option<String> {
    let inside = |p: &&[f64; 2]| (from..=to).contains(&p[0]) && p[1].is_finite();
    let inside: Vec<[f64; 2]> = points.iter().filter(inside).copied().collect();
    let values: Vec<f64> = inside.iter().map(|p| p[1]).collect();
    let (low, high) = span(&values).map(|(low, high)| (low.min(0.0), high.max(0.0)))?;
    if inside.len() < 2 || high <= low {
        return None;
    }
    let y = |value: f64| EDGE + (high - value) / (high - low) * (HEIGHT - 2.0 * EDGE);
    let placed: Vec<[f64; 2]> = inside.iter().map(|p| [(p[0] - from) / (to - from) * WIDTH, y(p[1])]).collect();
    let mut path = String::new();
    polyline(&mut path, &thinned(&placed, NEAR), 10);
    Some(format!("<svg class=s viewBox=\"0 0 {WIDTH} {HEIGHT}\" aria-hidden=true><path d=\"{path}\"/></svg>"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_spans_its_cell_and_a_peak_of_one_sample_survives() {
        let svg = sparkline(&[[0.0, 0.0], [1.0, 10.0], [2.0, 5.0]], [0.0, 2.0]).unwrap();
        assert!(svg.contains("d=\"M0 19l45-18 45 9\""), "{svg}");
        let mut points: Vec<[f64; 2]> = (0..10_000).map(|k| [f64::from(k), 1.0]).collect();
        points[5000][1] = 9.0;
        let svg = sparkline(&points, [0.0, 1e4]).unwrap();
        assert!(svg.contains("-16") && svg.len() < 150, "{svg}");
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        assert!(sparkline(&[[0.0, 0.0], [1.0, 0.0]], [0.0, 1.0]).is_none());
        assert!(sparkline(&[[0.0, 1.0], [5.0, f64::NAN]], [0.0, 1.0]).is_none());
        assert!(sparkline(&[], [0.0, 1.0]).is_none());
    }
}
