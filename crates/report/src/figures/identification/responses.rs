//! Impulse and step response of the identified models.

use crate::drawing::numbers::LONG_S;
use crate::drawing::{Axis, Figure, Look, Panel, over};
use crate::findings::{Run, words_and_unit};

/// A model that grows this far beyond the others would hide them.
const GROWN: f64 = 1e3;
/// An impulse response has died down once it stays below this share of its peak.
const SETTLED: f64 = 0.01;
/// The first view is so much longer than that takes.
const ROOM: f64 = 1.5;

/// Responses of every model that has them; `None` where none has.
pub fn figure(run: &Run) -> Option<Figure> {
    let models: Vec<_> = run
        .models
        .iter()
        .filter_map(|model| Some((model, model.response.as_ref().filter(|r| !r.time_s.is_empty())?)))
        .collect();
    let (_, first) = models.first()?;
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let least = models.iter().map(|(_, r)| peak(&r.impulse)).filter(|p| *p > 0.0).fold(f64::INFINITY, f64::min);
    let longest_s = models.iter().filter_map(|(_, r)| r.time_s.last()).fold(0.0_f64, |m, t| m.max(*t));
    let mut settled_s = 0.0_f64;
    let settles = |times: &[f64], values: &[f64]| {
        let bound = SETTLED * peak(values);
        let last = values.iter().rposition(|x| x.abs() > bound);
        last.and_then(|k| times.get(k + 1)).copied().unwrap_or(if last.is_some() { f64::INFINITY } else { 0.0 })
    };
    // In s where the part that is looked at is long.
    let seen_s = || models.iter().map(|(_, r)| settles(&r.time_s, &r.impulse)).fold(0.0, f64::max).min(longest_s);
    let (factor, unit) = if seen_s() > LONG_S { (1.0, "s") } else { (1e3, "ms") };
    // Models with another input or output have other units: they start hidden.
    let of_free_motion = first.input.contains("Markov");
    let title = if of_free_motion { "Impulse response" } else { "Impulse and step response" };
    let mut figure = Figure::new("responses", title);
    let (mut impulse, mut step) =
        (Panel::new(Axis::default(), Axis::default()), Panel::new(Axis::default(), Axis::default()));
    let mut hidden = 0;
    for (place, (model, response)) in models.iter().enumerate() {
        let has_same_units = response.output == first.output && response.impulse_of == first.impulse_of;
        let is_like_the_others = has_same_units && peak(&response.impulse) <= GROWN * least;
        let shown = is_like_the_others || run.is_recommended(&model.id);
        hidden += usize::from(!shown);
        if shown {
            settled_s = settled_s.max(settles(&response.time_s, &response.impulse));
        }
        let times: Vec<f64> = response.time_s.iter().map(|t| factor * t).collect();
        let entry = figure.entry(&model.id, Look::of_series(place), shown);
        impulse.line(entry, over(&times, &response.impulse));
        // What was taken as an impulse response has no input that could be a step.
        if !of_free_motion {
            step.line(entry, over(&times, &response.step));
        }
    }
    let ((_, in_unit), (words, out_unit)) = (words_and_unit(&first.input), words_and_unit(&first.output));
    let output = if words.is_empty() { "the output" } else { words };
    let and_step = if of_free_motion { "" } else { " and to a unit step" };
    let mut caption = format!("Response of {output} to a {}{and_step}, from rest.", first.impulse_of);
    // An impulse of a unit for one sample has the input's unit, an impulse of unit area that times s.
    let per = |more: &str| match (&out_unit, &in_unit) {
        (Some(out), Some(input)) => format!(", {out} per {input}{more}"),
        (Some(out), None) => format!(", {out}"),
        _ => String::new(),
    };
    let more = if first.impulse_of == "unit impulse" { "·s" } else { "" };
    let impulse_title = format!("impulse response{}", per(more));
    let time_title = format!("time from the start of the window, {unit}");
    let step_title = format!("step response{}", per(""));
    let view = (settled_s > 0.0 && ROOM * settled_s < 0.5 * longest_s).then_some([0.0, factor * ROOM * settled_s]);
    if view.is_some() {
        caption.push_str(" The axis of time ends where the impulse response has died down.");
    }
    if hidden > 0 {
        caption.push_str(&format!(
            " {hidden} models with another output, another impulse, or far larger responses are hidden: their names in \
             the legend show them."
        ));
    }
    for (panel, title) in [(&mut impulse, impulse_title), (&mut step, step_title)] {
        panel.x = Axis { view, ..Axis::new(&time_title) };
        panel.y = Axis::new(title);
    }
    figure.caption = caption;
    figure.panels = vec![impulse, step];
    Some(figure.tidy())
}
