//! Singular values of the Hankel matrix: the evidence for the order of a model.

use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Symbol};
use crate::findings::Run;
use crate::words;

/// Values drawn: more say nothing about an order that a crash record supports.
const DRAWN: usize = 40;
const SYMBOLS: [Symbol; 4] = [Symbol::Disc, Symbol::Square, Symbol::Diamond, Symbol::Ring];

/// Relative singular values of every model; `None` where none has any.
pub fn figure(run: &Run) -> Option<Figure> {
    let mut figure = Figure::new("singular-values", "Evidence for the order");
    let axis = Axis { whole: true, ..Axis::new("index") };
    let mut panel = Panel::new(axis, Axis { logarithmic: true, ..Axis::new("relative singular value") });
    let mut caption = String::from("Singular values of the Hankel matrix relative to the largest.");
    // Models of several orders from one record share their singular values: drawn once.
    let mut drawn: Vec<&[f64]> = Vec::new();
    for model in &run.models {
        let Some(identification) = &model.identification else { continue };
        let values = &identification.singular_values;
        let Some(&largest) = values.first().filter(|largest| **largest > 0.0) else { continue };
        let order = identification.order as usize;
        if !drawn.contains(&values.as_slice()) {
            let place = drawn.len();
            drawn.push(values);
            let shown: Vec<[f64; 2]> =
                (1..=values.len().min(DRAWN)).map(|k| [k as f64, values[k - 1] / largest]).collect();
            let line = figure.entry(&model.id, Look::of_series(place), true);
            panel.line(line, shown.clone());
            let look = Look::marks(Colour::Series(place), SYMBOLS[place % SYMBOLS.len()]);
            let points = figure.entry(format!("{}, values", model.id), look, true);
            panel.points(points, shown);
        }
        panel.mark(order as f64 + 0.5, format!("order {order}"), Colour::Event, Dash::Dashed);
        if let (Some(kept), Some(dropped)) = (order.checked_sub(1).and_then(|k| values.get(k)), values.get(order))
            && *dropped > 0.0
        {
            let gap = words::significant(kept / dropped, 3);
            caption.push_str(&format!(" {}: σ{order}/σ{} = {gap}.", model.id, order + 1));
        }
    }
    if panel.curves.is_empty() {
        return None;
    }
    caption.push_str(
        " A wide gap supports the order before it; on a gentle slope the record does not determine the order.",
    );
    figure.caption = caption;
    figure.panels.push(panel);
    Some(figure.tidy())
}
