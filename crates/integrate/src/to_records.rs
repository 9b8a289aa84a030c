//! Events and metrics as they stand in the artifact.

use crumple_integrate::EVENT_NAMES;
use crumple_metrics::{Metric, centroid_time_from_crush, definitions};
use crumple_stage::records::{EventIntervalV1, EventsV1, MetricV1};

use crate::contact::TimeZero;
use crate::options::StageSettings;
use crate::stage::Integrated;

pub fn events_record(
    channel: &str,
    settings: &StageSettings,
    zero: &TimeZero,
    pulse: &Integrated,
    impact_speed_m_per_s: f64,
) -> EventsV1 {
    let events = &pulse.events;
    let intervals = EVENT_NAMES.iter().zip(&pulse.event_intervals).filter_map(|(name, interval)| {
        interval.map(|interval| EventIntervalV1 {
            name: (*name).to_owned(),
            low: interval.low,
            high: interval.high,
            interval_by: interval.by.to_string(),
        })
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
        delta_v_m_per_s: events.delta_v_m_per_s(impact_speed_m_per_s),
        time_of_rebound_s: events.rebound.map(|rebound| rebound.time_s),
        impact_speed_m_per_s: Some(impact_speed_m_per_s),
        rule: Some(settings.rule.name().to_owned()),
        start: Some(pulse.motion.start.name().to_owned()),
        intervals: if events.crush.is_some() { intervals.collect() } else { Vec::new() },
    }
}

/// The metrics of a channel, and the drift taken out of it.
pub fn metric_records(channel: &str, of: &Integrated, time_zero_s: f64) -> Vec<MetricV1> {
    let mut records: Vec<MetricV1> = of.metrics.iter().map(|metric| metric_record(channel, metric)).collect();
    if let Some(drift) = of.drift {
        let from_s = of.motion.velocity.t0_s() - time_zero_s;
        let metric = Metric::found(&definitions::DRIFT, drift.acceleration_m_per_s2)
            .over(from_s, drift.time_s - time_zero_s)
            .remarked(&format!("{}, met at {:.6} s of the record", drift.shape.name(), drift.time_s));
        records.push(metric_record(channel, &metric));
    }
    records
}

pub fn metric_record(channel: &str, metric: &Metric) -> MetricV1 {
    MetricV1 {
        name: metric.name.to_owned(),
        value: metric.value,
        unit: metric.unit.to_owned(),
        channel: channel.to_owned(),
        definition: metric.definition.clone(),
        definition_id: Some(metric.id.to_owned()),
        from_s: metric.window.map(|window| window.from_s),
        to_s: metric.window.map(|window| window.to_s),
        low: metric.interval.map(|interval| interval.low),
        high: metric.interval.map(|interval| interval.high),
        interval_by: metric.interval.map(|interval| interval.by.to_string()),
    }
}
