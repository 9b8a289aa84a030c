//! How quantities are distributed over the runs.

use crumple_report::Quantity;
use crumple_report::drawing::{Axis, Colour, Dash, Figure, Look, Panel, span};
use crumple_report::phrases::PHRASES;

use crate::tables::rows::Row;

/// Columns of a panel.
const COLUMNS: usize = 24;
/// Height of a panel, of its own 560 of width.
const HEIGHT: f64 = 210.0;

/// Numbers of runs by value, a panel a quantity; those that fewer than two runs have are left out.
pub(crate) fn distributions(rows: &[Row], quantities: &[Quantity]) -> Figure {
    let texts = &PHRASES.fleet;
    let mut figure = Figure::new("distributions", texts.runs_by_value);
    let entry = figure.entry(texts.runs, Look::line(Colour::Series(0), Dash::Solid), true);
    for quantity in quantities {
        let values: Vec<f64> = rows.iter().filter_map(|row| (quantity.of)(row.summary.as_ref()?)).collect();
        if values.len() > 1 {
            figure.panels.push(panel(entry, quantity, &values));
        }
    }
    figure
}

fn panel(entry: usize, quantity: &Quantity, values: &[f64]) -> Panel {
    let (low, high) = span(values).unwrap_or((0.0, 1.0));
    let room = if high > low { 0.02 * (high - low) } else { (0.1 * high.abs()).max(0.5) };
    let (low, high) = (low - room, high + room);
    let width = (high - low) / COLUMNS as f64;
    let mut counts = [0.0; COLUMNS];
    for value in values {
        counts[(((value - low) / width) as usize).min(COLUMNS - 1)] += 1.0;
    }
    let edges: Vec<f64> = (0..=COLUMNS).map(|k| low + width * k as f64).collect();
    let most = counts.iter().copied().fold(1.0, f64::max);
    let up = Axis { whole: true, ..Axis::new(PHRASES.fleet.runs) }.from_to([0.0, 1.08 * most]);
    let mut panel = Panel { height: HEIGHT, ..Panel::new(Axis::new(quantity.label()).from_to([low, high]), up) };
    panel.columns(entry, &edges, &counts);
    panel
}

#[cfg(test)]
mod tests {
    use crumple_report::quantities::MASS;

    use super::*;

    #[test]
    fn every_run_is_in_a_column_and_equal_values_have_an_axis() {
        for values in [vec![1.0, 2.0, 2.0, 5.0], vec![3.0, 3.0]] {
            let panel = panel(0, &MASS, &values);
            let counted: f64 = panel.curves[0].points.windows(2).filter(|p| p[0][1] == p[1][1]).map(|p| p[0][1]).sum();
            assert_eq!(counted, values.len() as f64, "{panel:?}");
            assert_eq!(panel.x.title, "test mass, kg");
        }
    }
}
