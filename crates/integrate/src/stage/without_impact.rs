//! A motion without an impact of a vehicle: from rest, pushed, of a sled, of a pulse whose speed nobody states.

use crumple_metrics::definitions::STROKE;
use crumple_metrics::{Measured, Metric, Onset, SMOOTHING_S, end_of_force, first_event};
use crumple_signal::{
    Acceleration, Channel, IntegrationRule, IntegrationSettings, Sampled, Signal, TestDescription, TestKind,
    integrate_twice,
};
use crumple_stage::records::{ImpactsV1, MetricsV2};
use crumple_stage::{Inputs, Outcome, Output, Refused, option};

use crate::{Uncertainty, stroke_interval};

use crate::stage::channels::{ChannelAgreement, integrate_others};
use crate::stage::collision::{of_one_vehicle, other_vehicle, vehicles};
use crate::stage::criteria;
use crate::stage::integration::{ChannelIntegration, Integrated, acceleration};
use crate::stage::occupants_and_roadside::Criteria;
use crate::stage::options::{StageSettings, uncertainty_note};
use crate::stage::pulse_shape::{pulse_shape, sled_pulse};
use crate::stage::records::{impact_records, metric_record, metric_records, note_impacts, warn_unless_of_the_vehicle};

/// Gain of velocity over the impact speed, up to which a pulse that pushes forward is a hit from behind: a frontal
/// pulse of the wrong sign gains 1.0 to 1.35 times the impact speed.
const PUSHED: f64 = 0.6;
/// Less is no pulse: 3.6 km/h.
const LEAST_GAIN_M_PER_S: f64 = 1.0;

/// Whether a vehicle that moves at a stated speed gains velocity: it was struck from behind. A pulse of the wrong sign
/// gains more, and was asked about.
pub fn is_pushed(
    input: &Inputs,
    test: &TestDescription,
    (pulse, speed_m_per_s): (&Channel, Option<f64>),
) -> anyhow::Result<bool> {
    let Some(speed) = speed_m_per_s.filter(|_| !test.exchange_asked) else { return Ok(false) };
    let samples = acceleration(input, pulse)?;
    let (whole, _) = integrate_twice(samples.samples(), samples.dt_s(), IntegrationRule::Trapezoid, 0.0, 0.0);
    let v = &whole[samples.index_at_or_after(0.0).min(whole.len().saturating_sub(1))..];
    let change = |of: fn(f64, f64) -> f64| v.iter().copied().reduce(of).map_or(0.0, |end| end - v[0]);
    let (gain, loss) = (change(f64::max), -change(f64::min));
    Ok(gain > loss && gain < PUSHED * speed && gain > LEAST_GAIN_M_PER_S)
}

/// Writes the change of velocity of the pulse, the metrics that need no impact, and criteria. The others are absent,
/// with this as their reason. Where the speed at contact is known, velocity and displacement are; of what starts from
/// rest, and of a sled, the stroke. A known end takes the drift out, of the change what is left without that speed.
/// Later stages, whose models are of a structure that meets something, have nothing to work on.
pub fn without_impact(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    (pulse, speed_m_per_s): (&Channel, Option<f64>),
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let samples = acceleration(input, pulse)?;
    // What is pushed forward and has no speed stated starts from rest: a sled, a hit on a vehicle that stands.
    let starts_from = speed_m_per_s.or(pushes_forward(&samples).then_some(0.0));
    if settings.end_condition.is_some() && starts_from.is_none() {
        return Err(Refused::new("an end is known, and the speed at contact is not: the ends are over ground")
            .expected("both, or none")
            .hint(format!("state the speed: {}", option("ingest", "impact-speed", "50km/h")))
            .into());
    }
    let task = ChannelIntegration {
        settings,
        input,
        test,
        // A motion from rest is its change of velocity.
        impact_speed_m_per_s: speed_m_per_s.filter(|speed| *speed == 0.0),
        change_from_m_per_s: starts_from,
        most_replicates: usize::MAX,
    };
    let integrated = task.integrate(pulse, &samples, out)?;
    warn_unless_of_the_vehicle(pulse, out.notes());
    note_impacts(&integrated.events.impacts, out);
    if let Some(uncertainty) = &integrated.uncertainty {
        out.notes().push(uncertainty_note(uncertainty, None));
    }
    let mut metrics = metric_records(&pulse.id, &integrated);
    let delta_v = integrated.metrics.iter().find(|metric| metric.name == "delta_v");
    let delta_v = delta_v.and_then(|metric| Some((metric.value?, metric.window?.to_s)));
    let over_ground = task.over_ground(&integrated.motion)?;
    let impacts = &integrated.events.impacts;
    let impact = first_event(impacts).map(|k| &impacts[k]);
    let stroke = starts_from.filter(|speed| *speed == 0.0 || !test.has_structure()).and_then(|speed| {
        let (_, way) = over_ground.as_ref()?;
        stroke(&task, &integrated, (speed, way), delta_v?.1)
    });
    let stroke_m = stroke.as_ref().and_then(|stroke| stroke.value);
    metrics.extend(stroke.map(|stroke| metric_record(&[&pulse.id], &stroke)));
    metrics.extend(pulse_shape(&pulse.id, &integrated, out));
    let measured = Measured {
        change_m_per_s: impact.map_or(0.0, |impact| impact.change_m_per_s),
        is_whole: impact.is_some_and(|impact| impact.is_whole),
        speed_m_per_s,
        stroke_m,
    };
    metrics.extend(sled_pulse(settings.corridor, pulse, &integrated, measured, out));
    let vehicles = vehicles(input)?;
    let own_test = of_one_vehicle(test, &vehicles, &pulse.id);
    let mut others = ChannelAgreement::new(pulse, &integrated);
    metrics.extend(integrate_others(&ChannelIntegration { test: &own_test, ..task }, pulse, &mut others, out)?);
    if let Some((speed, (velocity, _))) = speed_m_per_s.zip(over_ground.as_ref()) {
        metrics.extend(other_vehicle(&task, &vehicles, pulse, (speed, velocity), out)?);
    }
    metrics.extend(others.spread(out));
    let against =
        criteria::Pulse { id: &pulse.id, motion: &integrated.motion, separation_s: delta_v.map(|(_, end_s)| end_s) };
    metrics.extend(criteria::in_the_plane(input, &own_test, pulse, &against)?);
    let criteria = Criteria { settings, input, test, pulse, impact_speed_m_per_s: None };
    metrics.extend(criteria.records(out)?);

    let change = delta_v.map_or_else(String::new, |(value, time_s)| {
        format!(": change of velocity {value:.3} m/s at {:.1} ms", 1e3 * time_s)
    });
    let stroke = stroke_m.map_or_else(String::new, |stroke_m| format!(", stroke {:.0} mm", 1e3 * stroke_m));
    let (speed_text, reason) = why_none(test, speed_m_per_s, starts_from);
    out.summary(format!("pulse {}{change}{stroke}{speed_text}", pulse.id));
    out.put("/test", &input.test_with_samples(test))?;
    let impacts = impact_records(&integrated.events.impacts, None);
    out.put("/impacts", &ImpactsV1 { channel: pulse.id.clone(), impacts })?;
    out.put("/metrics", &MetricsV2 { metrics })?;
    task.write(&pulse.id, integrated, out)?;
    out.nothing_for_later_stages(reason);
    Ok(Outcome::Done)
}

/// The stroke: the way from contact to the end of the force, or where its fall does not show it to the largest change
/// of velocity, `change_s`. `speed` is that at contact, `way` the way over ground, m.
fn stroke(
    task: &ChannelIntegration<'_>,
    integrated: &Integrated,
    (speed_m_per_s, way): (f64, &Sampled),
    change_s: f64,
) -> Option<Metric> {
    let impact = &integrated.events.impacts[first_event(&integrated.events.impacts)?];
    // What rolls on passes 2 % of its stroke while a mean of 4.4 ms sees the end of the force.
    let end = end_of_force(&integrated.motion.acceleration, impact.time_of_peak_s, impact.end_s)
        .unwrap_or(Onset { time_s: change_s, deviation_s: SMOOTHING_S / 2.0 });
    let metric = Metric::with_value(&STROKE, way.at(end.time_s)?.abs()).over(0.0, end.time_s);
    let of_speed = task
        .settings
        .uncertainty
        .as_ref()
        .and_then(|stated| stated.impact_speed_m_per_s)
        .filter(|_| speed_m_per_s > 0.0);
    let interval = integrated.uncertainty.as_ref().and_then(|uncertainty| {
        let uncertainty = Uncertainty { impact_speed_m_per_s: of_speed, ..uncertainty.clone() };
        let settings = IntegrationSettings {
            rule: task.settings.rule,
            start: integrated.motion.start.into(),
            impact_speed_m_per_s: speed_m_per_s,
            low_pass_filtered: true,
        };
        let acceleration = &integrated.motion.acceleration;
        stroke_interval(acceleration, &settings, task.settings.end_condition, &uncertainty, &end)
    });
    Some(Metric { interval, ..metric })
}

/// Whether a pulse ends faster than it begins, whatever drift does to it.
fn pushes_forward(samples: &Signal<Acceleration>) -> bool {
    let from = samples.index_at_or_after(0.0);
    samples.samples().get(from..).unwrap_or_default().iter().sum::<f64>() > 0.0
}

/// What the summary says of the speed, and why there are no models.
fn why_none(test: &TestDescription, speed: Option<f64>, starts_from: Option<f64>) -> (String, String) {
    let kind = test.kind.as_ref().map(|of| of.kind).filter(|_| !test.has_structure());
    let speed_text = match speed {
        Some(0.0) => "; from rest".to_owned(),
        Some(speed) if kind.is_some() => format!("; from {speed:.3} m/s"),
        Some(_) => "; it is pushed forward".to_owned(),
        None => "; no impact speed is stated".to_owned(),
    };
    let reason = match (kind, speed) {
        (Some(TestKind::Component), _) => "a component without its mass has no model: --mass 30kg at ingest".to_owned(),
        (Some(kind), _) => format!("a {} has no structure: it has no crush and no crush model", kind.name()),
        (None, Some(0.0)) => FROM_REST.to_owned(),
        (None, Some(_)) => "the pulse pushes the vehicle forward: it has no crush and no crush model".to_owned(),
        // A vehicle pushed forward starts from rest: nobody has an impact speed to give.
        (None, None) if starts_from.is_some() => UNSTATED_AND_FORWARD.to_owned(),
        (None, None) => {
            "no impact speed is stated, so there is no crush and no model of it: --impact-speed 35km/h at ingest"
                .to_owned()
        }
    };
    (speed_text, reason)
}

const FROM_REST: &str = "the motion starts from rest: it has no crush and no crush model";
const UNSTATED_AND_FORWARD: &str = "no impact speed is stated and the pulse is positive, as of a sled or a hit from \
    behind: a motion from rest has no crush and no crush model";
