//! The candidates' responses over the test: displacement, what is left of it, velocity and acceleration.

use crumple_signal::Sampled;
use serde_json::{Value, json};

use crate::drawing::figure::{
    COMPUTED_POINTS, Figure, MEASURED_POINTS, axis, base_layout, colour, event_line, over_time, room_above, set, short,
    span, with,
};
use crate::drawing::shown_at_first::at_first;
use crate::drawing::time_view::time_view_ms;
use crate::results::ranking::pairs_of_equals;
use crate::text::escape::html;
use crate::text::numbers::{G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI, candidate_name, decimals};
use crate::{CandidateResult, Ranking, Run};

/// Candidates that are shown at first; the others wait in the legend.
const SHOWN: usize = 4;

/// Test and candidates; `None` without a simulated displacement.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let stands_for = pairs_of_equals(&run.candidates);
    let mut drawn: Vec<(usize, &CandidateResult, &Sampled)> = run
        .candidates
        .iter()
        .enumerate()
        .filter(|(index, _)| stands_for[*index] == *index)
        .filter_map(|(index, candidate)| Some((index, candidate, candidate.displacement.as_ref()?)))
        .collect();
    if drawn.is_empty() {
        return None;
    }
    drawn.sort_by_key(|(index, candidate, _)| (ranking.place(&candidate.id).unwrap_or(usize::MAX), *index));

    let ranked: Vec<&CandidateResult> = drawn.iter().map(|(_, candidate, _)| *candidate).collect();
    let shown = at_first(&ranked, ranking, SHOWN);
    let fits = fit_texts(&ranked);
    // The curves that are shown together have the colours before they repeat.
    let is_shown = |candidate: &CandidateResult| shown.contains(candidate.id.as_str());
    let mut coloured = ranked.clone();
    coloured.sort_by_key(|candidate| !is_shown(candidate));
    let look_of = |id: &str| coloured.iter().position(|candidate| candidate.id == id).unwrap_or_default();

    let measured = &run.measured;
    let mut traces = test_traces(run);
    let window = drawn.iter().find_map(|(_, candidate, _)| candidate.simulation.as_ref()).map(|s| (s.from_s, s.to_s));
    let mut equals = 0;
    let mut largest_mm = 0.0_f64;
    for (place, (index, candidate, displacement)) in drawn.iter().enumerate() {
        let others = stands_for.iter().enumerate().filter(|(i, drawn_as)| **drawn_as == *index && i != index).count();
        equals += others;
        let look = look_of(&candidate.id);
        let style = json!({
            "legendgroup": candidate.id, "visible": if is_shown(candidate) { json!(true) } else { json!("legendonly") },
            "line": {"color": colour::SERIES[look % colour::SERIES.len()], "width": 1.9,
                     "dash": colour::DASHES[look % colour::DASHES.len()]},
        });
        let mut push = |signal: &Sampled, factor: f64, axis: &str, unit: &str| {
            let trace = with(over_time(signal, factor, COMPUTED_POINTS), style.clone());
            traces.push(with(
                trace,
                json!({"name": name(candidate, fits[place].as_deref(), others, ranking), "showlegend": axis == "y",
                       "yaxis": axis,
                       "hovertemplate": format!("{unit}<extra>{}</extra>", html(&candidate_name(&candidate.id)))}),
            ));
        };
        push(displacement, MILLI, "y", "%{y:.1f} mm");
        if let Some(residual) = measured.displacement.as_ref().and_then(|test| residual(test, displacement)) {
            push(&residual, MILLI, "y2", "%{y:.2f} mm");
            if is_shown(candidate) {
                largest_mm = largest_mm.max(MILLI * largest_within(&residual, window));
            }
        }
        if let Some(velocity) = &candidate.velocity {
            push(velocity, KM_PER_H_PER_M_PER_S, "y3", "%{y:.2f} km/h");
        }
        if let Some(acceleration) = &candidate.acceleration {
            push(acceleration, G_PER_M_PER_S2, "y4", "%{y:.2f} g");
        }
    }

    let mut layout = layout(run, window, largest_mm);
    // Two names fit into a row; the test's own stands before them.
    let legend_rows = (drawn.len() + 1).div_ceil(2) as u32;
    let height_px = 900 + 21 * legend_rows;
    room_above(&mut layout, height_px, 1, legend_rows);
    Some(Figure {
        id: "models",
        title: "Models over the test",
        caption: caption(
            window,
            equals,
            shown.len() < drawn.len(),
            ranked.iter().any(|candidate| candidate.is_chain()),
        ),
        height_px,
        half_width: false,
        traces,
        layout,
    })
}

/// The motion of the test.
fn test_traces(run: &Run) -> Vec<Value> {
    let measured = &run.measured;
    let mut traces = Vec::new();
    let test_line = json!({"color": colour::MEASURED, "width": 3});
    for (signal, factor, axis, unit) in [
        (&measured.displacement, MILLI, "y", "%{y:.1f} mm"),
        (&measured.velocity, KM_PER_H_PER_M_PER_S, "y3", "%{y:.2f} km/h"),
        (&run.acceleration().cloned(), G_PER_M_PER_S2, "y4", "%{y:.2f} g"),
    ] {
        if let Some(signal) = signal {
            traces.push(with(
                over_time(signal, factor, MEASURED_POINTS),
                json!({"name": "test", "legendgroup": "test", "showlegend": axis == "y", "yaxis": axis,
                       "line": test_line, "hovertemplate": unit}),
            ));
        }
    }
    traces
}

/// The time of crush and the window that the models are compared over, with their labels.
fn marks(run: &Run, window: Option<(f64, f64)>) -> (Vec<Value>, Vec<Value>) {
    let (mut shapes, mut labels) = (Vec::new(), Vec::new());
    if let Some(t_m) = run.time_of_crush_s() {
        let name = format!("t<sub>m</sub> = {} ms", decimals(MILLI * t_m, 1));
        let (line, label) = event_line(MILLI * t_m, &name, colour::EVENT, "dash");
        shapes.push(line);
        labels.push(label);
    }
    if let Some((from, to)) = window {
        shapes.push(json!({
            "type": "rect", "xref": "x", "yref": "paper", "x0": short(MILLI * from), "x1": short(MILLI * to),
            "y0": 0, "y1": 1, "fillcolor": "#eef3f7", "line": {"width": 0}, "layer": "below",
        }));
    }
    (shapes, labels)
}

/// Four panels over the same times; `largest_mm` is the largest residual drawn at first.
fn layout(run: &Run, window: Option<(f64, f64)>, largest_mm: f64) -> Value {
    // By what lies inside the compared window: what a model does after it would flatten the rest.
    let residual_range =
        if largest_mm > 0.0 { json!([short(-1.15 * largest_mm), short(1.15 * largest_mm)]) } else { Value::Null };
    // The first view is that of the test up to twice its time of crush: a linear model ends with the loading phase.
    let view = match (time_view_ms(run), run.time_of_crush_s()) {
        (Some([_, to]), Some(t_m)) => json!([0, short(to.min(2.0 * MILLI * t_m))]),
        (Some([_, to]), None) => json!([0, short(to)]),
        (None, _) => Value::Null,
    };
    let (shapes, labels) = marks(run, window);
    let measured = &run.measured;
    let displacement_range = range_of(measured.displacement.as_ref(), MILLI);
    let velocity_range = range_of(measured.velocity.as_ref(), KM_PER_H_PER_M_PER_S);
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "x unified", "hoversubplots": "axis",
            "xaxis": axis("time after time zero, ms", json!({"anchor": "y4", "range": view, "hoverformat": ".2f"})),
            "yaxis": axis("displacement, mm", json!({"domain": [0.65, 1.0], "range": displacement_range})),
            "yaxis2": axis("residual, mm", json!({"domain": [0.45, 0.62], "range": residual_range})),
            "yaxis3": axis("velocity, km/h", json!({"domain": [0.225, 0.42], "range": velocity_range})),
            "yaxis4": axis("acceleration, g", json!({"domain": [0.0, 0.195]})),
            "shapes": shapes, "annotations": labels,
        }),
    );
    layout
}

fn caption(window: Option<(f64, f64)>, equals: usize, hidden: bool, chains: bool) -> String {
    let mut text = String::new();
    if let Some((from, to)) = window {
        text.push_str(&format!(
            "The shaded window, {} to {} ms, is the one the models are compared over; outside it they are only drawn. ",
            decimals(MILLI * from, 1),
            decimals(MILLI * to, 1)
        ));
    }
    text.push_str(
        "The residual is test minus model. Click a name in the legend to show or hide a model in all panels.",
    );
    if hidden {
        let chains = if chains { ", and the chains of your own" } else { "" };
        text.push_str(&format!(
            " Shown at first are up to {SHOWN}{chains}: the best, then those without a parameter on a bound of the \
             search, and of parameter sets of one model that fit alike the first."
        ));
    }
    if equals > 0 {
        text.push_str(" Parameter sets that give exactly the same record (duals) are drawn once.");
    }
    text
}

/// Fits in percent to two decimals, as in the table of candidates; to three where two are equal in print.
fn fit_texts(candidates: &[&CandidateResult]) -> Vec<Option<String>> {
    let fits = candidates.iter().map(|candidate| candidate.fit_percent());
    let texts: Vec<_> = fits.map(|fit| fit.map(|fit| (fit, decimals(fit, 2)))).collect();
    let twice = |text: &str| texts.iter().flatten().filter(|(_, other)| other == text).count() > 1;
    let text = |known: &Option<(f64, String)>| {
        let (fit, text) = known.as_ref()?;
        Some(if twice(text) { decimals(*fit, 3) } else { text.clone() })
    };
    texts.iter().map(text).collect()
}

fn name(candidate: &CandidateResult, fit: Option<&str>, equals: usize, ranking: &Ranking) -> String {
    let mut name = html(&candidate_name(&candidate.id));
    let mut remarks = Vec::new();
    remarks.extend(fit.map(|fit| format!("{fit} %")));
    if equals > 0 {
        remarks.push("and its dual: same record".to_owned());
    }
    if !candidate.record.physical {
        remarks.push("not physical".to_owned());
    }
    if !remarks.is_empty() {
        name.push_str(&format!(" ({})", remarks.join("; ")));
    }
    if ranking.best.as_deref() == Some(&candidate.id) { format!("<b>{name}</b>") } else { name }
}

/// Test minus model at the model's samples, as far as the test reaches.
fn residual(test: &Sampled, model: &Sampled) -> Option<Sampled> {
    let first = (0..model.len()).find(|&k| test.at(model.time_s(k)).is_some())?;
    let left: Vec<f64> =
        (first..model.len()).map_while(|k| Some(test.at(model.time_s(k))? - model.samples()[k])).collect();
    Sampled::new(model.time_s(first), model.dt_s(), left).ok()
}

/// A first view of an axis that holds the test with a margin, so that a model that runs away does not flatten it.
fn range_of(signal: Option<&Sampled>, factor: f64) -> Value {
    let from = signal.map_or(0, |signal| signal.index_at_or_after(0.0));
    let Some((low, high)) = signal.and_then(|signal| span(&signal.samples()[from..])) else { return Value::Null };
    let margin = 0.2 * (high - low);
    json!([short(factor * (low.min(0.0) - margin / 4.0)), short(factor * (high + margin))])
}

/// Largest magnitude inside the window, or of all where there is none.
fn largest_within(signal: &Sampled, window: Option<(f64, f64)>) -> f64 {
    let (from, to) = window.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let inside = (0..signal.len()).filter(|&k| (from..=to).contains(&signal.time_s(k)));
    inside.fold(0.0, |largest, k| largest.max(signal.samples()[k].abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_residual_is_scaled_by_the_compared_window() {
        let residual = Sampled::new(0.0, 0.01, vec![0.0, 1e-3, -2e-3, 5.0]).unwrap();
        assert_eq!(largest_within(&residual, Some((0.0, 0.025))), 2e-3);
        assert_eq!(largest_within(&residual, None), 5.0);
    }
}
