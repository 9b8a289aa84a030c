//! Candidates from the crash events and the motion of a test.

use crumple_lumped_fit::{Candidate, Sensor, TestData, solve};
use crumple_signal::Displacement;
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, Output, RefuseExt, Wave};

use crate::stage::inputs::Record;
use crate::stage::options::settings::StageSettings;

/// More of the way at constant speed than this part, and the record shows a vehicle that speeds up; a drifting zero
/// level of 0.1 g adds 1 % of 10 m/s in 100 ms.
const SPEEDS_UP: f64 = 1.05;

/// Within this part of it, and the record shows no impact.
const KEEPS_ITS_SPEED: f64 = 0.01;

/// Why no force slows the vehicle down, if so, and what to do: it never stops, and is in the end as far as its impact
/// speed alone would have taken it, or beyond.
pub fn not_slowed(input: &Inputs, events: &EventsV1) -> anyhow::Result<Option<(&'static str, &'static str)>> {
    let wave = input.wave_if(&format!("{}/displacement", events.channel));
    let Some(displacement) = wave.map(Wave::signal::<Displacement>).transpose().refuse()? else { return Ok(None) };
    let (Some(speed), Some(end_m)) = (events.impact_speed_m_per_s, displacement.samples().last()) else {
        return Ok(None);
    };
    let part = end_m / (speed * (displacement.end_s() - events.time_zero_s));
    Ok(match part {
        _ if events.dynamic_crush_m.is_some() => None,
        SPEEDS_UP.. => Some((
            "the vehicle moves further than its impact speed alone would carry it, which no spring or damper can do",
            "check the sign of the pulse (--sign flip at crumple-ingest turns it) and its unit",
        )),
        part if (part - 1.0).abs() < KEEPS_ITS_SPEED => Some((
            "the pulse does not slow the vehicle down, so that there is no force to model",
            "check which channel is the pulse (--channel at crumple-ingest), its unit and time zero",
        )),
        _ => None,
    })
}

/// The settings with the end of the event as the end of the window, where the velocity never reaches zero and no end is
/// stated.
pub fn up_to_the_end_of_the_event(
    settings: &StageSettings,
    events: &EventsV1,
    out: &mut Output,
) -> Option<StageSettings> {
    let open = settings.solve.fit_to_s.is_none() && events.time_of_dynamic_crush_s.is_none();
    let end_s = events.end_of_event_s.filter(|end_s| open && *end_s > settings.solve.fit_from_s)?;
    out.notes().info(format!(
        "the velocity never reaches zero: fitted up to the end of the event at {:.1} ms ({}); --fit-to states another",
        1e3 * end_s,
        events.end_of_event_rule.as_deref().unwrap_or("rule not stated")
    ));
    let mut settings = settings.clone();
    settings.solve.fit_to_s = Some(end_s);
    Some(settings)
}

/// Candidates from the events and the motion.
pub fn from_events(
    settings: &StageSettings,
    record: &Record,
    events: &EventsV1,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let sensors = sensors_of(record);
    let test_data = test_data(record, events, &sensors);
    solve(&test_data, &settings.solve, out.notes()).refuse_with_hint("see --mass, --m1, --m2, --fit-from and --fit-to")
}

/// The sensors to fit together.
pub fn sensors_of<'a>(record: &'a Record) -> Vec<Sensor<'a>> {
    record
        .sensors
        .iter()
        .map(|wave| Sensor {
            channel: &wave.channel,
            place: wave.place,
            quantity: wave.quantity,
            record: &wave.record,
            measurement: Some(wave.measurement),
            noise: None,
        })
        .collect()
}

/// What the solvers start from.
pub fn test_data<'a>(record: &'a Record, events: &EventsV1, sensors: &'a [Sensor<'a>]) -> TestData<'a> {
    TestData {
        mass_kg: record.mass_kg,
        impact_speed_m_per_s: record.impact_speed_m_per_s,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        dynamic_crush_m: events.dynamic_crush_m,
        coefficient_of_restitution: restitution(events),
        time_zero_s: events.time_zero_s,
        time_of_rebound_s: events.time_of_rebound_s,
        displacement: record.displacement.as_ref().map(|(x, _)| x),
        measurement: record.displacement.as_ref().map(|(_, measurement)| *measurement),
        sensors,
    }
}

/// The coefficient of restitution; zero where its interval holds zero.
fn restitution(events: &EventsV1) -> Option<f64> {
    let holds_zero = events.intervals.iter().any(|i| i.name == "coefficient_of_restitution" && i.low <= 0.0);
    events.coefficient_of_restitution.map(|e| if holds_zero { 0.0 } else { e })
}
