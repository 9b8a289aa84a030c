//! Quantities over each other, a point a run; outliers lead to their reports.

use crumple_report::Quantity;
use crumple_report::drawing::{Axis, Colour, Dash, Figure, Link, Look, Panel, Symbol, span};
use crumple_report::phrases::PHRASES;
use crumple_report::phrases::words;

use crate::page::outliers::line_and_outliers;
use crate::tables::rows::Row;

/// Most outliers of a panel that are links.
const LINKS: usize = 20;
/// Height of a panel, of its own 560 of width.
const HEIGHT: f64 = 300.0;

/// `y` over each of several quantities, a panel each; those that fewer than two runs have are left out.
pub(crate) fn scatter(rows: &[Row], (id, y): (&'static str, Quantity), over: &[Quantity]) -> Figure {
    let texts = &PHRASES.fleet;
    let mut figure = Figure::new(id, capitalised(y.name()));
    let entries = [
        figure.entry(texts.a_run, Look::marks(Colour::Series(0), Symbol::Point), true),
        figure.entry(texts.line, Look::line(Colour::Muted, Dash::Dashed), true),
        figure.entry(texts.outlier, Look::marks(Colour::Series(1), Symbol::Ring), true),
    ];
    figure.panels = over.iter().filter_map(|x| panel(rows, entries, (*x, y))).collect();
    figure
}

fn panel(rows: &[Row], [runs, line, _]: [usize; 3], (x, y): (Quantity, Quantity)) -> Option<Panel> {
    let both = |row: &Row| row.summary.as_ref().and_then(|run| Some(((x.of)(run)?, (y.of)(run)?)));
    let of_rows: Vec<(&Row, (f64, f64))> = rows.iter().filter_map(|row| Some((row, both(row)?))).collect();
    if of_rows.len() < 2 {
        return None;
    }
    let points: Vec<(f64, f64)> = of_rows.iter().map(|(_, point)| *point).collect();
    let fitted = line_and_outliers(&points);
    let is_outlier = |number: usize| fitted.as_ref().is_some_and(|(_, outliers)| outliers[number]);
    let whole = x.unit.is_empty();
    let mut panel =
        Panel { height: HEIGHT, ..Panel::new(Axis { whole, ..Axis::new(x.label()) }, Axis::new(y.label())) };
    let dots = points.iter().enumerate().filter(|(number, _)| !is_outlier(*number));
    panel.points(runs, dots.map(|(_, (x, y))| [*x, *y]).collect());
    if let Some((fit, _)) = &fitted {
        let all: Vec<f64> = points.iter().map(|point| point.0).collect();
        let (low, high) = span(&all)?;
        panel.line(line, [low, high].map(|at| [at, fit.value(at)]).to_vec());
    }
    let outliers = of_rows.iter().enumerate().filter(|(number, _)| is_outlier(*number)).take(LINKS);
    panel.links = outliers
        .map(|(_, (row, point))| Link {
            at: [point.0, point.1],
            address: format!("{}/report.html", row.run.folder),
            text: format!("{}: {} {}", row.run.record.identity, words::significant(point.1, 3), y.unit)
                .trim_end()
                .to_owned(),
        })
        .collect();
    Some(panel)
}

fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
