//! Stabilisation diagram: poles over the order of the model.

use crate::phrases::PHRASES;
use crate::phrases::words;
use std::f64::consts::TAU;

use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Symbol};
use crate::findings::Run;
use crate::phrases::IdentificationTexts;
use crate::phrases::words::fill;

/// Marks in the order of the legend: word of the record, name, symbol, colour.
const fn marks(texts: &IdentificationTexts) -> [(&'static str, &'static str, Symbol, Colour); 5] {
    [
        ("all", texts.all_are_stable, Symbol::Disc, Colour::Series(2)),
        ("frequency-and-damping", texts.frequency_and_damping_stable, Symbol::Diamond, Colour::Series(0)),
        ("frequency", texts.frequency_stable, Symbol::Triangle, Colour::Series(4)),
        ("new", texts.new, Symbol::Cross, Colour::Muted),
        ("rejected", texts.rejected, Symbol::Ring, Colour::Raw),
    ]
}

/// The first diagram of the run; `None` without one.
pub fn figure(run: &Run) -> Option<Figure> {
    let diagram = run.stabilizations.first().filter(|d| !d.poles.is_empty())?;
    let hz = |re: f64, im: f64| re.hypot(im) / TAU;
    let texts = &PHRASES.identification;
    let mut figure = Figure::new("stabilisation", texts.stabilisation);
    let axis = Axis { logarithmic: true, ..Axis::new(texts.natural_frequency_axis) };
    let mut panel = Panel::new(axis, Axis { whole: true, ..Axis::new(texts.order_axis) });
    panel.height = 300.0;
    for (word, name, symbol, colour) in marks(texts) {
        let poles = diagram.poles.iter().filter(|pole| pole.stability == word);
        let points = poles.map(|p| [hz(p.re_per_s, p.im_rad_per_s), f64::from(p.order)]).collect();
        let entry = figure.entry(name, Look::marks(colour, symbol), true);
        panel.points(entry, points);
    }
    for cluster in &diagram.clusters {
        let f = cluster.natural_frequency_rad_per_s / TAU;
        let name = format!("{} Hz, ζ {}", words::significant(f, 4), words::significant(cluster.damping_ratio, 3));
        panel.mark(f, name, Colour::Muted, Dash::Dotted);
    }
    let percent = |x: f64| format!("{} %", words::decimals(100.0 * x, 0));
    let shape = diagram.shape_change.map(|x| fill(texts.shape_within, &[("mac", words::decimals(1.0 - x, 2))]));
    let filled = [
        ("method", diagram.method.clone()),
        ("channel", diagram.channel.clone()),
        ("frequency", percent(diagram.frequency_change)),
        ("damping", percent(diagram.damping_change)),
        ("shape", shape.unwrap_or_default()),
        ("highest", words::significant(diagram.highest_damping, 2)),
        ("nyquist", percent(diagram.nyquist_share)),
        ("presence", percent(diagram.presence)),
        ("count", diagram.clusters.len().to_string()),
    ];
    let mut caption = fill(texts.stabilisation_caption, &filled);
    let template = if diagram.clusters.is_empty() { texts.no_mode_marked } else { texts.modes_marked };
    caption.push_str(&fill(template, &filled));
    if run.stabilizations.len() > 1 {
        caption.push_str(&fill(texts.more_diagrams, &[("count", (run.stabilizations.len() - 1).to_string())]));
    }
    figure.caption = caption;
    figure.panels.push(panel);
    Some(figure.tidy())
}
