//! Events and metrics as they stand in the artifact.

use crumple_integrate::{EVENT_NAMES, event_values};
use crumple_metrics::{Metric, centroid_time_from_crush, definitions};
use crumple_stage::records::{EventIntervalV1, EventsV1, MetricV1, MissingIntervalV1};

use crate::stage::metric_record::{interval_source, metric_record};
use crate::stage::options::StageSettings;
use crate::stage::pulse::integrated::Integrated;
use crate::stage::pulse::time_zero::TimeZero;

pub fn events_record(
    channel: &str,
    settings: &StageSettings,
    zero: &TimeZero,
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
            interval_source: Some(interval_source(interval.by)),
        })
    });
    let without = named().filter_map(|name| {
        let reason = pulse.events_without.get(place(name)?).cloned().flatten()?;
        Some(MissingIntervalV1 { name: name.to_owned(), reason })
    });
    EventsV1 {
        channel: channel.to_owned(),
        time_zero_s: zero.time_s,
        time_zero_rule: zero.rule.clone(),
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
    }
}

/// The metrics of a channel, and the drift taken out of it.
pub fn metric_records(channel: &str, integrated: &Integrated, time_zero_s: f64) -> Vec<MetricV1> {
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
        let from_s = integrated.motion.velocity.t0_s() - time_zero_s;
        let metric = Metric::with_value(&definitions::DRIFT, drift.acceleration_m_per_s2)
            .over(from_s, drift.time_s - time_zero_s)
            .remarked(&format!("{}, met at {:.6} s of the record", drift.shape.name(), drift.time_s));
        records.push(metric_record(&[channel], &metric));
    }
    records
}
