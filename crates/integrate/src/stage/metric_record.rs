//! A metric as it stands in the artifact.

use crumple_metrics::Metric;
use crumple_stage::records::MetricV1;

/// The record of a metric of a channel, or of several under their joined ids.
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
