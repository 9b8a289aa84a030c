//! Singular values of the Hankel matrix: the evidence for the order of a model.

use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Symbol};
use crate::findings::Run;
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;

/// Values drawn: more say nothing about an order that a crash record supports.
const DRAWN: usize = 40;
const SYMBOLS: [Symbol; 4] = [Symbol::Disc, Symbol::Square, Symbol::Diamond, Symbol::Ring];

/// Relative singular values of every model; `None` where none has any.
pub fn figure(run: &Run) -> Option<Figure> {
    let texts = &PHRASES.identification;
    let mut figure = Figure::new("singular-values", texts.singular_values);
    let axis = Axis { whole: true, ..Axis::new(texts.index) };
    let mut panel = Panel::new(axis, Axis { logarithmic: true, ..Axis::new(texts.relative_singular_value) });
    let mut caption = texts.singular_values_caption.to_owned();
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
            let (name, symbol) = (fill(texts.values, &[("model", &model.id)]), SYMBOLS[place % SYMBOLS.len()]);
            let points = figure.entry(name, Look::marks(Colour::Series(place), symbol), true);
            panel.points(points, shown);
        }
        panel.mark(order as f64 + 0.5, fill(texts.order, &[("order", order.to_string())]), Colour::Event, Dash::Dashed);
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
    caption.push_str(texts.wide_gap);
    figure.caption = caption;
    figure.panels.push(panel);
    Some(figure.tidy())
}
