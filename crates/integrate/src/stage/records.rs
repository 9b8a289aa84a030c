//! What the stage writes of the pulse: records of events and metrics, notes, the summary.

use crate::{EVENT_NAMES, WRONG_SIGN, event_values, findings, question_speed, wrong_sign};
use crumple_metrics::{EventEnd, IntervalBy, Metric, PulseImpact, centroid_time_from_crush, definitions, first_event};
use crumple_signal::{About, Channel, Note, Notes, Severity, Value, Weight, part_of, remarks};
use crumple_stage::records::{EventIntervalV1, EventsV1, ImpactV1, IntervalSourceV1, MetricV1, MissingIntervalV1};
use crumple_stage::{Output, option};

use crate::stage::integration::Integrated;
use crate::stage::options::StageSettings;

pub fn events_record(
    channel: &str,
    settings: &StageSettings,
    rule: &str,
    pulse: &Integrated,
    impact_speed_m_per_s: f64,
) -> EventsV1 {
    let events = &pulse.events;
    // An event that is not there has neither an interval nor a reason for none.
    let is_there = event_values(events, impact_speed_m_per_s).map(|value| value.is_some());
    let named = || EVENT_NAMES.iter().zip(is_there).filter(|(_, is_there)| *is_there).map(|(name, _)| *name);
    let place = |name: &str| EVENT_NAMES.iter().position(|other| *other == name);
    let intervals = named().filter_map(|name| {
        pulse.event_intervals.get(place(name)?).copied().flatten().map(|interval| EventIntervalV1 {
            name: name.to_owned(),
            low: interval.low,
            high: interval.high,
            interval_by: interval.by.to_string(),
            interval_source: interval_source(interval.by),
        })
    });
    let without = named().filter_map(|name| {
        let reason = pulse.events_without.get(place(name)?).cloned().flatten()?;
        Some(MissingIntervalV1 { name: name.to_owned(), reason })
    });
    EventsV1 {
        channel: channel.to_owned(),
        time_zero_s: 0.0,
        time_zero_rule: rule.to_owned(),
        dynamic_crush_m: events.crush.map(|crush| crush.displacement_m),
        time_of_dynamic_crush_s: events.crush.map(|crush| crush.time_s),
        centroid_time_s: events.crush.map(|c| centroid_time_from_crush(c.displacement_m, impact_speed_m_per_s)),
        rebound_velocity_m_per_s: events.rebound.map(|rebound| rebound.velocity_m_per_s),
        coefficient_of_restitution: events.restitution(impact_speed_m_per_s),
        still_separating: events.rebound.is_some_and(|rebound| rebound.still_separating),
        delta_v_m_per_s: events.delta_v_m_per_s(impact_speed_m_per_s),
        time_of_rebound_s: events.rebound.map(|rebound| rebound.time_s),
        impact_speed_m_per_s: Some(impact_speed_m_per_s),
        rule: Some(settings.rule.name().to_owned()),
        start: Some(pulse.motion.start.name().to_owned()),
        intervals: intervals.collect(),
        time_of_delta_v_s: events.unstopped.map(|unstopped| unstopped.time_s),
        end_of_event_s: events.unstopped.map(|unstopped| unstopped.end_s),
        end_of_event_rule: events.unstopped.map(|unstopped| unstopped.end.name().to_owned()),
        without_interval: without.collect(),
        impacts: impact_records(&events.impacts, Some(impact_speed_m_per_s)),
    }
}

/// The impacts of a motion from an impact speed; without one its velocity is the change of velocity.
pub fn impact_records(impacts: &[PulseImpact], impact_speed_m_per_s: Option<f64>) -> Vec<ImpactV1> {
    let record = |impact: &PulseImpact| ImpactV1 {
        start_s: impact.start_s,
        end_s: impact.end_s,
        start_velocity_m_per_s: impact_speed_m_per_s.map(|_| impact.start_velocity_m_per_s),
        // `+ 0.0` turns -0.0 into 0.
        delta_v_m_per_s: -impact.change_m_per_s + 0.0,
        peak_acceleration_m_per_s2: Some(impact.peak_m_per_s2),
        time_of_peak_s: Some(impact.time_of_peak_s),
        is_lower_bound: !impact.is_whole,
    };
    impacts.iter().map(record).collect()
}

/// Says of a pulse with several impacts what each of them does, and of which the numbers are.
pub fn note_impacts(impacts: &[PulseImpact], out: &mut Output) {
    let Some(event) = first_event(impacts).filter(|_| impacts.len() > 1) else { return };
    let each: Vec<String> = (1..).zip(impacts).map(|(number, impact)| impact.words_with_peak(number)).collect();
    let (count, number) = (impacts.len(), event + 1);
    out.summary(format!("{count} impacts: {}", each.join("; ")));
    let another = if number == 1 { 2 } else { 1 };
    out.notes().push(SeveralImpacts { count, impacts: each, number, another });
}

/// The metrics of a channel, and the drift taken out of it.
pub fn metric_records(channel: &str, integrated: &Integrated) -> Vec<MetricV1> {
    let record_of = |(k, metric): (usize, &Metric)| {
        let mut record = metric_record(&[channel], metric);
        // A check of the arithmetic has no interval, and a missing value none to give a reason for.
        if metric.value.is_some() && metric.interval.is_none() && metric.id != definitions::CLOSURE.id {
            record.interval_by = integrated.metrics_without.get(k).cloned().flatten();
        }
        record
    };
    let mut records: Vec<MetricV1> = integrated.metrics.iter().enumerate().map(record_of).collect();
    if let Some(drift) = integrated.drift {
        let from_s = integrated.motion.velocity.t0_s();
        let metric = Metric::with_value(&definitions::DRIFT, drift.acceleration_m_per_s2)
            .over(from_s, drift.time_s)
            .remarked(&format!("{}, met at {:.6} s of the record", drift.shape.name(), drift.time_s));
        records.push(metric_record(&[channel], &metric));
    }
    records
}

/// Notes what the motion of the pulse shows: first where its sign is wrong or the impact speed does not fit it, because
/// most other notes follow from that.
///
/// Where the stage that read the record asked for an exchange that explains it, nothing more is asked.
pub fn note_findings(pulse: &Integrated, impact_speed_m_per_s: f64, speed_rule: SpeedRule, notes: &mut Notes) {
    let of_pulse = findings(&pulse.motion, &pulse.events, impact_speed_m_per_s);
    if wrong_sign(&pulse.motion.velocity, impact_speed_m_per_s) {
        let before = std::mem::replace(notes, of_pulse);
        notes.extend(before);
        return;
    }
    let is_left = pulse.events.restitution(impact_speed_m_per_s).is_none();
    let is_open = match speed_rule {
        SpeedRule::None => false,
        SpeedRule::MayBeLeft => !is_left,
        SpeedRule::AskedBefore | SpeedRule::New => true,
    };
    let question = question_speed(&pulse.events, impact_speed_m_per_s).filter(|_| is_open);
    let is_asked = question.is_some() && speed_rule == SpeedRule::AskedBefore;
    // What follows from the exchange is no finding of its own.
    for note in of_pulse.iter().filter(|note| !(is_asked && is_decisive(note))) {
        notes.push(note.clone());
    }
    if let Some(question) = question.filter(|_| !is_asked) {
        notes.push_first(question);
    }
}

/// Whether a speed can be held against a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedRule {
    /// No: a partner gives way, too, or no vehicle has this mass.
    None,
    /// Yes, unless speed is left: the impact is stated to be glancing.
    MayBeLeft,
    /// Yes, and the stage that read the record has asked for an exchange of one of both.
    AskedBefore,
    /// Yes, and nobody has asked yet.
    New,
}

fn is_decisive(note: &Note) -> bool {
    note.bearing.as_ref().is_some_and(|bearing| bearing.weight == Weight::Decisive)
}

/// Notes the warnings of the motion of another channel, under its name.
pub fn note_warnings(id: &str, channel: &Integrated, impact_speed_m_per_s: f64, notes: &mut Notes) {
    for note in findings(&channel.motion, &channel.events, impact_speed_m_per_s).iter() {
        if note.severity == Severity::Warning {
            let mut of_channel = note.clone().within(&format!("channel {id}: "), "");
            of_channel.values.push(("channel", Value::Text(id.to_owned())));
            notes.push(of_channel.bears_on(About::Channel(id.to_owned()), Weight::Marked));
        }
    }
}

/// Warns of vehicle metrics of what is no part of the vehicle.
pub fn warn_unless_of_the_vehicle(channel: &Channel, notes: &mut Notes) {
    if !channel.may_be_on_vehicle() || part_of(channel).is_some() {
        let location = if channel.location.is_empty() { "an occupant" } else { &channel.location };
        notes.push(NotOfTheVehicle { channel: channel.id.clone(), location: location.to_owned() });
    }
}

/// The line of the summary.
pub fn summary(channel: &str, pulse: &Integrated, impact_speed_m_per_s: f64) -> String {
    if impact_speed_m_per_s == 0.0 {
        let change = pulse.events.end_velocity_m_per_s;
        return format!("pulse {channel}: from rest, change of velocity {change:.3} m/s at the end, no crash events");
    }
    if wrong_sign(&pulse.motion.velocity, impact_speed_m_per_s) {
        return format!("pulse {channel}: no crash events, {WRONG_SIGN}");
    }
    match (pulse.events.crush, pulse.events.rebound) {
        (Some(crush), Some(rebound)) => {
            let interval = pulse.event_intervals.first().copied().flatten();
            let interval = interval.map_or_else(String::new, |i| format!(" ({:.3} to {:.3} m)", i.low, i.high));
            format!(
                "pulse {channel}: dynamic crush {:.4} m{interval} at {:.2} ms, rebound {:.3} m/s",
                crush.displacement_m,
                1e3 * crush.time_s,
                rebound.velocity_m_per_s
            )
        }
        _ => {
            if let Some(unstopped) = pulse.events.unstopped.filter(|unstopped| unstopped.end == EventEnd::Contact) {
                return format!(
                    "pulse {channel}: the impact leaves {:.3} m/s, another one follows",
                    unstopped.velocity_m_per_s
                );
            }
            let end = pulse.events.end_velocity_m_per_s;
            let change = pulse.events.unstopped.map_or_else(String::new, |unstopped| {
                format!(
                    ", delta-v {:.3} m/s at {:.1} ms (event ends at {:.1} ms: {})",
                    impact_speed_m_per_s - unstopped.velocity_m_per_s,
                    1e3 * unstopped.time_s,
                    1e3 * unstopped.end_s,
                    unstopped.end.name()
                )
            });
            format!("pulse {channel}: the velocity never reaches zero, {end:.3} m/s at the end{change}")
        }
    }
}

/// What an interval is made from, as records say it.
fn interval_source(by: IntervalBy) -> Option<IntervalSourceV1> {
    match by {
        IntervalBy::Channels(_) => Some(IntervalSourceV1::Channels),
        IntervalBy::Replicates(_) => Some(IntervalSourceV1::Replicates),
        IntervalBy::Resolution => Some(IntervalSourceV1::Resolution),
        IntervalBy::Restitution => None,
    }
}

/// The record of a metric of one channel or several.
pub fn metric_record(channels: &[&str], metric: &Metric) -> MetricV1 {
    MetricV1 {
        name: metric.name.to_owned(),
        value: metric.value,
        unit: metric.unit.to_owned(),
        channel: channels.join("+"),
        definition: metric.definition.clone(),
        definition_id: Some(metric.id.to_owned()),
        from_s: metric.window.map(|window| window.from_s),
        to_s: metric.window.map(|window| window.to_s),
        low: metric.interval.map(|interval| interval.low),
        high: metric.interval.map(|interval| interval.high),
        interval_by: metric.interval.map(|interval| interval.by.to_string()),
        interval_source: metric.interval.and_then(|interval| interval_source(interval.by)),
        channels: if channels.len() > 1 { channels.iter().map(|id| (*id).to_owned()).collect() } else { Vec::new() },
        is_lower_bound: metric.is_lower_bound,
    }
}

remarks! {
    /// Remarks of the pulse and its impacts.
    pub REMARKS;

    /// The pulse holds several impacts.
    CR361 SeveralImpacts { count: usize, impacts: Vec<String>, number: usize, another: usize }
    bears on (About::Motion, Weight::Slight)
    decided "15 ms without a force separate two impacts. The numbers are of the first one of 8 km/h, which an \
             event data recorder would keep (49 CFR 563.5), else of the strongest."
    means "Crush, delta-v, rebound and models are of one impact only."
    remedy "take another impact with --impact at ingest; each has a row in the record /impacts"
    says format!(
        "the pulse holds {count} impacts: {}. All numbers and models are of impact {number}; {} takes impact {another}",
        impacts.join("; "),
        option("ingest", "impact", &another.to_string())
    );

    /// A channel that was integrated does not sit on the vehicle.
    CR362 NotOfTheVehicle { channel: String, location: String }
    bears on (About::Pulse, Weight::Decisive)
    decided "Code, location or name of the channel says an occupant, the barrier or another object."
    means "Dynamic crush, restitution, energies and pulse indices describe the sensor, not the vehicle."
    remedy "name a sensor of the compartment as the pulse: --channel at ingest"
    says format!(
        "channel {channel} is not of the vehicle ({location}): its dynamic crush, restitution, energies and pulse \
         indices are those of the sensor, not of the vehicle"
    );
}
