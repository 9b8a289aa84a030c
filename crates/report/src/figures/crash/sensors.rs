//! Other sensors on the vehicle, and the masses of the models over them.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::drawing::figure::{
    COMPUTED_POINTS, Figure, MEASURED_POINTS, axis, base_layout, colour, over_time, room_above, set, short, with,
};
use crate::drawing::shown_at_first::at_first;
use crate::drawing::time_view::time_view_ms;
use crate::results::run::SensorMotion;
use crate::text::escape::html;
use crate::text::numbers::{KM_PER_H_PER_M_PER_S, MILLI, candidate_name};
use crate::{CandidateResult, Ranking, Run};

/// Candidates whose masses are drawn over a sensor.
const SHOWN: usize = 3;

/// Velocity and displacement of every other sensor; `None` without one.
///
/// Shown at first are the compartment of the best model over the pulse, the sensors that it was compared with, and
/// those that a model has a mass for, with that mass of the best candidates over them; the others wait in the legend.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    if run.other_sensors.is_empty() {
        return None;
    }
    let mut ranked: Vec<&CandidateResult> = run.candidates.iter().collect();
    ranked.sort_by_key(|candidate| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    let mut traces = Vec::new();
    let mut names = 1;
    let mut push = |name: &str, group: &str, style: Value, signals: [Option<&crumple_signal::Sampled>; 2], points| {
        let axes = [("y", KM_PER_H_PER_M_PER_S, "%{y:.2f} km/h"), ("y2", MILLI, "%{y:.1f} mm")];
        // One name a curve: that of its displacement, which is always there.
        for (signal, (axis, factor, hover)) in signals.into_iter().zip(axes) {
            let Some(signal) = signal else { continue };
            traces.push(with(
                with(over_time(signal, factor, points), style.clone()),
                json!({"name": name, "legendgroup": group, "yaxis": axis, "showlegend": axis == "y2",
                       "hovertemplate": hover}),
            ));
        }
    };
    push(
        &format!("pulse {}", html(run.channel_id().unwrap_or_default())),
        "pulse",
        json!({"line": {"color": colour::RAW, "width": 1.4}}),
        [run.measured.velocity.as_ref(), run.measured.displacement.as_ref()],
        MEASURED_POINTS,
    );
    let mut series = 0;
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id));
    if let Some(best) = best
        && let Some(displacement) = &best.displacement
    {
        push(
            &format!("compartment of {}", html(&candidate_name(&best.id))),
            "best",
            json!({"line": {"color": colour::EVENT, "width": 1.9, "dash": "dash"}}),
            [best.velocity.as_ref(), Some(displacement)],
            COMPUTED_POINTS,
        );
        names += 1;
    }
    let compared =
        best.and_then(|best| best.simulation.as_ref()).map(|s| s.other_sensors.as_slice()).unwrap_or_default();
    for sensor in &run.other_sensors {
        let (models, shown) = models_at(sensor, &ranked, ranking);
        let name = sensor_name(run, sensor);
        let is_compared = compared.iter().any(|other| other.channel == sensor.channel);
        let visible = if models.is_empty() && !is_compared { json!("legendonly") } else { json!(true) };
        let line = if models.is_empty() {
            json!({"color": colour::SERIES[series % colour::SERIES.len()], "width": 1.4, "dash": "dot"})
        } else {
            json!({"color": colour::MEASURED, "width": 3})
        };
        series += usize::from(models.is_empty());
        push(
            &html(&name),
            &sensor.channel,
            json!({"visible": visible, "line": line}),
            [sensor.velocity.as_ref(), Some(&sensor.displacement)],
            MEASURED_POINTS,
        );
        names += 1 + models.len();
        for (candidate, mass) in models {
            let Some((displacement, velocity)) = candidate.masses.get(mass - 1) else { continue };
            let visible = if shown.contains(candidate.id.as_str()) { json!(true) } else { json!("legendonly") };
            push(
                &format!("mass {mass} of {}", html(&candidate_name(&candidate.id))),
                &format!("{} {}", sensor.channel, candidate.id),
                json!({"visible": visible,
                       "line": {"color": colour::SERIES[series % colour::SERIES.len()], "width": 1.9,
                                "dash": colour::DASHES[(series + 1) % colour::DASHES.len()]}}),
                [velocity.as_ref(), Some(displacement)],
                COMPUTED_POINTS,
            );
            series += 1;
        }
    }
    let mut layout = layout(run);
    let legend_rows = names.div_ceil(2) as u32;
    let height_px = 480 + 21 * legend_rows;
    room_above(&mut layout, height_px, 0, legend_rows);
    Some(Figure {
        id: "sensors",
        title: "Other sensors on the vehicle",
        caption: "Each sensor integrated from its own acceleration. A mass of a model is drawn over the sensor that \
            sits on it, for the best candidates, and the compartment of the best model over the pulse; sensors that \
            the best model was not compared with and no mass stands for wait in the legend."
            .to_owned(),
        height_px,
        half_width: false,
        traces,
        layout,
    })
}

/// `sensor 97 (engine)`.
fn sensor_name(run: &Run, sensor: &SensorMotion) -> String {
    let place = run.test.channel(&sensor.channel).map(|c| c.location.clone()).filter(|place| !place.is_empty());
    format!("sensor {}{}", sensor.channel, place.map_or_else(String::new, |place| format!(" ({place})")))
}

/// The candidates with a mass at a sensor, at most [`SHOWN`] or all shown at first, with that mass; and the ids of
/// those shown at first.
fn models_at<'a>(
    sensor: &SensorMotion,
    ranked: &[&'a CandidateResult],
    ranking: &Ranking,
) -> (Vec<(&'a CandidateResult, usize)>, BTreeSet<&'a str>) {
    let with_mass: Vec<&CandidateResult> =
        ranked.iter().copied().filter(|candidate| mass_at(candidate, sensor).is_some()).collect();
    let shown = at_first(&with_mass, ranking, SHOWN);
    let mut drawn = with_mass;
    drawn.sort_by_key(|candidate| !shown.contains(candidate.id.as_str()));
    let models = drawn
        .into_iter()
        .take(SHOWN.max(shown.len()))
        .filter_map(|candidate| Some((candidate, mass_at(candidate, sensor)?)))
        .collect();
    (models, shown)
}

/// Velocity above displacement over the same times.
fn layout(run: &Run) -> Value {
    let view = match (time_view_ms(run), run.time_of_crush_s()) {
        (Some([_, to]), Some(t_m)) => json!([0, short(to.min(2.0 * MILLI * t_m))]),
        (Some([_, to]), None) => json!([0, short(to)]),
        (None, _) => Value::Null,
    };
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "x unified", "hoversubplots": "axis",
            "xaxis": axis("time after time zero, ms", json!({"anchor": "y2", "range": view, "hoverformat": ".2f"})),
            "yaxis": axis("velocity, km/h", json!({"domain": [0.53, 1.0]})),
            "yaxis2": axis("displacement, mm", json!({"domain": [0.0, 0.47], "range": displacement_view(run)})),
        }),
    );
    layout
}

/// First view of the displacement, mm: from contact to twice the time of crush. Before it all come nearer alike.
fn displacement_view(run: &Run) -> Value {
    let to_s = run.time_of_crush_s().map_or(f64::INFINITY, |t_m| 2.0 * t_m);
    let signals = run.other_sensors.iter().map(|sensor| &sensor.displacement).chain(&run.measured.displacement);
    let samples = signals.flat_map(|signal| {
        let from = signal.index_at_or_after(0.0);
        let end = signal.index_at_or_after(to_s).max(from);
        signal.samples()[from..end].iter().copied()
    });
    let (low, high) = samples.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    let margin = 0.08 * (high - low);
    if margin > 0.0 { json!([short(MILLI * (low - margin)), short(MILLI * (high + margin))]) } else { Value::Null }
}

/// The mass of the candidate that stands for the sensor, from 1 at the barrier: the one it was fitted to or compared
/// with. `None` for the compartment, whose motion is among the models over the test.
fn mass_at(candidate: &CandidateResult, sensor: &SensorMotion) -> Option<usize> {
    let fitted = candidate.other_channels().find(|(channel, _)| *channel == sensor.channel).map(|(_, mass)| mass);
    let compared = || {
        let others = candidate.simulation.as_ref().map(|s| s.other_sensors.as_slice()).unwrap_or_default();
        others.iter().find(|other| other.channel == sensor.channel).map(|other| other.mass)
    };
    let mass = usize::try_from(fitted.or_else(compared)?).ok()?;
    (1..=candidate.masses.len()).contains(&mass).then_some(mass)
}
