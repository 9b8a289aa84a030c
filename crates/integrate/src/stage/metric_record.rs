//! A metric as it stands in the artifact.

use crumple_metrics::{IntervalBy, Metric};
use crumple_stage::records::{IntervalSourceV1, MetricV1};

/// What an interval is made from, as records say it.
pub fn interval_source(by: IntervalBy) -> IntervalSourceV1 {
    match by {
        IntervalBy::Channels(_) => IntervalSourceV1::Channels,
        IntervalBy::Replicates(_) => IntervalSourceV1::Replicates,
        IntervalBy::Resolution => IntervalSourceV1::Resolution,
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
        interval_source: metric.interval.map(|interval| interval_source(interval.by)),
        channels: if channels.len() > 1 { channels.iter().map(|id| (*id).to_owned()).collect() } else { Vec::new() },
        is_lower_bound: metric.is_lower_bound,
    }
}
