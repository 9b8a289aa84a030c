//! Stabilisation diagram: poles over the order of the model.

use crate::words;
use std::f64::consts::TAU;

use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Symbol};
use crate::findings::Run;

/// Marks in the order of the legend: word of the record, name, symbol, colour.
const MARKS: [(&str, &str, Symbol, Colour); 5] = [
    ("all", "frequency, damping, shape stable", Symbol::Disc, Colour::Series(2)),
    ("frequency-and-damping", "frequency and damping stable", Symbol::Diamond, Colour::Series(0)),
    ("frequency", "frequency stable", Symbol::Triangle, Colour::Series(4)),
    ("new", "new", Symbol::Cross, Colour::Muted),
    ("rejected", "rejected", Symbol::Ring, Colour::Raw),
];

/// The first diagram of the run; `None` without one.
pub fn figure(run: &Run) -> Option<Figure> {
    let diagram = run.stabilizations.first().filter(|d| !d.poles.is_empty())?;
    let hz = |re: f64, im: f64| re.hypot(im) / TAU;
    let mut figure = Figure::new("stabilisation", "Stabilisation diagram");
    let axis = Axis { logarithmic: true, ..Axis::new("natural frequency, Hz") };
    let mut panel = Panel::new(axis, Axis { whole: true, ..Axis::new("order") });
    panel.height = 300.0;
    for (word, name, symbol, colour) in MARKS {
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
    let shape = diagram.shape_change.map(|x| format!(", a shape with MAC of {} or more", words::decimals(1.0 - x, 2)));
    let mut caption = format!(
        "{} of {}: poles of models of rising order, from one factorisation. Compared with the order before, stable is \
         a frequency within {}, a damping ratio within {}{}. Rejected: growing, damping ratio above {}, above {} of \
         the Nyquist frequency, or no stronger than noise.",
        diagram.method,
        diagram.channel,
        percent(diagram.frequency_change),
        percent(diagram.damping_change),
        shape.unwrap_or_default(),
        words::significant(diagram.highest_damping, 2),
        percent(diagram.nyquist_share)
    );
    let presence = percent(diagram.presence);
    caption.push_str(&match diagram.clusters.len() {
        0 => format!(" No mode is present in {presence} of the orders, none is marked."),
        count => format!(" Marked: modes present in {presence} of the orders or more ({count})."),
    });
    if run.stabilizations.len() > 1 {
        caption.push_str(&format!(" {} more are in the artifact.", run.stabilizations.len() - 1));
    }
    figure.caption = caption;
    figure.panels.push(panel);
    Some(figure.tidy())
}
