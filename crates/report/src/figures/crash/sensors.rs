//! Other sensors on the vehicle, and the masses of the models over them.

use std::collections::BTreeSet;

use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Width, over_time};
use crate::findings::{CandidateResult, Ranking, Run, SensorMotion};
use crumple_signal::Sampled;

use super::curves::view_ms;
use crate::figures::shown_at_first::at_first;
use crate::figures::time_view::{DISPLACEMENT, VELOCITY, over_time_axis};

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
    let mut figure = Figure::new("sensors", "Other sensors on the vehicle");
    figure.caption = String::from(
        "Each sensor integrated from its own acceleration. A mass of a model is drawn over the sensor that sits on \
         it, for the best candidates, and the compartment of the best model over the pulse; sensors that the best \
         model was not compared with and no mass stands for wait in the legend.",
    );
    let view = view_ms(run).map(|[from, to]| [from.max(0.0), to]);
    let mut velocity = over_time_axis(view, Axis::of(VELOCITY));
    let axis = Axis { view: displacement_view(run, view), ..Axis::of(DISPLACEMENT) };
    let mut displacement = over_time_axis(view, axis);
    let mut push = |name: String, look: Look, shown: bool, v: Option<&Sampled>, x: Option<&Sampled>| {
        let entry = figure.entry(name, look, shown);
        velocity.line(entry, v.map(|v| over_time(v, KM_PER_H_PER_M_PER_S)).unwrap_or_default());
        displacement.line(entry, x.map(|x| over_time(x, MILLI)).unwrap_or_default());
    };
    let measured = &run.measured;
    push(
        format!("pulse {}", run.channel_id().unwrap_or_default()),
        Look::line(Colour::Raw, Dash::Solid),
        true,
        measured.velocity.as_ref(),
        measured.displacement.as_ref(),
    );
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id));
    if let Some(best) = best.filter(|best| best.displacement.is_some()) {
        push(
            format!("compartment of {}", run.name_of(&best.id)),
            Look::line(Colour::Event, Dash::Dashed),
            true,
            best.velocity.as_ref(),
            best.displacement.as_ref(),
        );
    }
    let mut series = 0;
    let compared =
        best.and_then(|best| best.simulation.as_ref()).map(|s| s.other_sensors.as_slice()).unwrap_or_default();
    for sensor in &run.other_sensors {
        let (models, shown) = models_at(sensor, &ranked, ranking);
        let is_compared = compared.iter().any(|other| other.channel == sensor.channel);
        let look = if models.is_empty() {
            Look::line(Colour::Series(series), Dash::Dotted)
        } else {
            Look::line(Colour::Test, Dash::Solid).width(Width::Thick)
        };
        series += usize::from(models.is_empty());
        let seen = is_compared || !models.is_empty();
        push(sensor_name(run, sensor), look, seen, sensor.velocity.as_ref(), Some(&sensor.displacement));
        for (candidate, mass) in models {
            let Some((x, v)) = candidate.masses.get(mass - 1) else { continue };
            push(
                format!("mass {mass} of {}", run.name_of(&candidate.id)),
                Look::of_series(series),
                shown.contains(candidate.id.as_str()),
                v.as_ref(),
                Some(x),
            );
            series += 1;
        }
    }
    if let Some(t_m) = run.time_of_crush_s() {
        velocity.mark(MILLI * t_m, "", Colour::Event, Dash::Dashed);
        displacement.mark(MILLI * t_m, "", Colour::Event, Dash::Dashed);
    }
    figure.panels = vec![velocity, displacement];
    Some(figure.tidy())
}

/// `sensor 97 (engine)`.
fn sensor_name(run: &Run, sensor: &SensorMotion) -> String {
    let place = run.test.channel(&sensor.channel).map(|c| c.location.clone()).filter(|place| !place.is_empty());
    let place = place.map_or_else(String::new, |place| format!(" ({place})"));
    format!("sensor {}{place}", sensor.channel)
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

/// First view of the displacement, mm: of all sensors in the first view of time.
fn displacement_view(run: &Run, view: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let to_s = view.map_or(f64::INFINITY, |[_, to]| to / MILLI);
    let signals = run.other_sensors.iter().map(|sensor| &sensor.displacement).chain(&run.measured.displacement);
    let samples = signals.flat_map(|signal| {
        let from = signal.index_at_or_after(0.0);
        let end = signal.index_at_or_after(to_s).max(from);
        signal.samples()[from..end].iter().copied()
    });
    let (low, high) = samples.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    let margin = 0.08 * (high - low);
    (margin > 0.0).then_some([MILLI * (low - margin), MILLI * (high + margin)])
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
