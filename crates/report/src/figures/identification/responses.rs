//! Impulse and step response of the identified models.

use serde_json::{Value, json};

use crate::drawing::figure::{Figure, axis, base_layout, colour, over, room_above, set, short};
use crate::text::escape::html;
use crate::text::numbers::{LONG_S, words_and_unit};
use crate::{Model, Run};

const HEIGHT_PX: u32 = 460;
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
    let mut traces = Vec::new();
    let mut hidden = 0;
    for (place, (model, response)) in models.iter().enumerate() {
        let line = json!({"color": colour::SERIES[place % colour::SERIES.len()], "width": 2,
                          "dash": colour::DASHES[place % colour::DASHES.len()]});
        let has_same_units = response.output == first.output && response.impulse_of == first.impulse_of;
        let shown = has_same_units && peak(&response.impulse) <= GROWN * least;
        hidden += usize::from(!shown);
        let visible = if shown { json!(true) } else { json!("legendonly") };
        if shown {
            settled_s = settled_s.max(settles(&response.time_s, &response.impulse));
        }
        let times: Vec<f64> = response.time_s.iter().map(|t| factor * t).collect();
        for (values, axis, legend) in [(&response.impulse, "y", true), (&response.step, "y2", false)] {
            let mut trace = over(&times, values, 1_600);
            set(
                &mut trace,
                json!({"yaxis": axis, "name": html(&model.id), "legendgroup": model.id, "showlegend": legend,
                       "line": line, "visible": visible, "hovertemplate": "%{y:.4~g}"}),
            );
            traces.push(trace);
        }
    }
    if first.impulse_of == "unit sample"
        && first.input.contains("Markov")
        && let Some(record) = record_trace(run, models[0].0, factor)
    {
        traces.insert(0, record);
    }
    let ((_, in_unit), (words, out_unit)) = (words_and_unit(&first.input), words_and_unit(&first.output));
    let mut caption = format!(
        "Response of {} to a {} (above) and to a unit step (below), from rest.",
        if words.is_empty() { "the output" } else { words },
        first.impulse_of
    );
    // An impulse of a unit for one sample has the input's unit, an impulse of unit area that times s.
    let per = |more: &str| match (&out_unit, &in_unit) {
        (Some(out), Some(input)) => format!(", {out} per {input}{more}"),
        (Some(out), None) => format!(", {out}"),
        _ => String::new(),
    };
    let impulse_title = format!("impulse response{}", per(if first.impulse_of == "unit impulse" { "·s" } else { "" }));
    let time_title = format!("time from the start of the window, {unit}");
    let step_title = format!("step response{}", per(""));
    let view = if settled_s > 0.0 && ROOM * settled_s < 0.5 * longest_s {
        caption.push_str(" The first view ends where the impulse response has died down; double-click shows all.");
        json!([0, short(factor * ROOM * settled_s)])
    } else {
        Value::Null
    };
    if hidden > 0 {
        caption.push_str(&format!(
            " {hidden} models with another output, another impulse, or far larger responses are hidden: click their \
             names."
        ));
    }
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "x unified", "hoversubplots": "axis",
            "xaxis": axis(&time_title, json!({"anchor": "y2", "range": view})),
            "yaxis": axis(&impulse_title, json!({"domain": [0.54, 1.0], "exponentformat": "power"})),
            "yaxis2": axis(&step_title, json!({"domain": [0.0, 0.46], "exponentformat": "power"})),
        }),
    );
    room_above(&mut layout, HEIGHT_PX, 0, 1);
    Some(Figure {
        id: "responses",
        title: "Impulse and step response",
        caption,
        height_px: HEIGHT_PX,
        half_width: false,
        traces,
        layout,
    })
}

/// The record itself, which an impulse response of a sample is compared with; times are multiplied by `factor`.
fn record_trace(run: &Run, model: &Model, factor: f64) -> Option<Value> {
    let (record, identification) = (run.acceleration()?, model.identification.as_ref()?);
    let zero_s = run.events.as_ref().map_or(0.0, |events| events.time_zero_s);
    let from = record.index_at_or_after(identification.from_s - zero_s - 0.5 * record.dt_s());
    let end = record.len().min(from + usize::try_from(identification.samples).unwrap_or(0));
    if end <= from {
        return None;
    }
    let samples = &record.samples()[from..end];
    let times: Vec<f64> = (0..samples.len()).map(|k| factor * record.dt_s() * k as f64).collect();
    let mut trace = over(&times, samples, 5_000);
    set(
        &mut trace,
        json!({"name": "the record", "line": {"color": colour::MEASURED, "width": 1}, "hovertemplate": "%{y:.4~g}"}),
    );
    Some(trace)
}
