//! Impulse and step response of the identified models.

use serde_json::json;

use crate::Run;
use crate::escape::html;
use crate::figure::{Figure, axis, base_layout, colour, over, room_above, set};

const HEIGHT_PX: u32 = 460;
/// A model that grows this far beyond the others would hide them.
const GROWN: f64 = 1e3;

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
    // Models of other ends have other units: they start hidden.
    let mut traces = Vec::new();
    let mut hidden = 0;
    for (place, (model, response)) in models.iter().enumerate() {
        let line = json!({"color": colour::SERIES[place % colour::SERIES.len()], "width": 2,
                          "dash": colour::DASHES[place % colour::DASHES.len()]});
        let alike = response.output == first.output && response.impulse_of == first.impulse_of;
        let shown = alike && peak(&response.impulse) <= GROWN * least;
        hidden += usize::from(!shown);
        let visible = if shown { json!(true) } else { json!("legendonly") };
        let time_ms: Vec<f64> = response.time_s.iter().map(|t| 1e3 * t).collect();
        for (values, axis, legend) in [(&response.impulse, "y", true), (&response.step, "y2", false)] {
            let mut trace = over(&time_ms, values, 1_600);
            set(
                &mut trace,
                json!({"yaxis": axis, "name": html(&model.id), "legendgroup": model.id, "showlegend": legend,
                       "line": line, "visible": visible, "hovertemplate": "%{y:.4~g}"}),
            );
            traces.push(trace);
        }
    }
    // The record itself is what an impulse response of a sample is held against.
    if let (true, Some(record), Some(identification)) = (
        first.impulse_of == "unit sample" && first.input.contains("Markov"),
        run.acceleration(),
        &models[0].0.identification,
    ) {
        let zero_s = run.events.as_ref().map_or(0.0, |events| events.time_zero_s);
        let from = record.index_at_or_after(identification.from_s - zero_s - 0.5 * record.dt_s());
        let end = record.len().min(from + usize::try_from(identification.samples).unwrap_or(0));
        if end > from {
            let samples = &record.samples()[from..end];
            let time_ms: Vec<f64> = (0..samples.len()).map(|k| 1e3 * record.dt_s() * k as f64).collect();
            let mut trace = over(&time_ms, samples, 5_000);
            set(
                &mut trace,
                json!({"name": "the record", "line": {"color": colour::MEASURED, "width": 1}, "hovertemplate": "%{y:.4~g}"}),
            );
            traces.insert(0, trace);
        }
    }
    let mut caption = format!(
        "Response of {} to a {} (above) and to a unit step (below), from rest, SI units.",
        if first.output.trim().is_empty() { "the output" } else { first.output.trim() },
        first.impulse_of
    );
    if hidden > 0 {
        caption.push_str(&format!(
            " {hidden} models with another output, another impulse, or far larger responses are hidden: click their names."
        ));
    }
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "x unified", "hoversubplots": "axis",
            "xaxis": axis("time from the start of the window, ms", json!({"anchor": "y2"})),
            "yaxis": axis("impulse response", json!({"domain": [0.54, 1.0], "exponentformat": "power"})),
            "yaxis2": axis("step response", json!({"domain": [0.0, 0.46], "exponentformat": "power"})),
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
