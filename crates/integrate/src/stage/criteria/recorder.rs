//! Maximum delta-V of the tables of an event data recorder, which need no impact speed.

use crumple_metrics::maximum_delta_v;
use crumple_signal::{Channel, QuantityKind, TestDescription};
use crumple_stage::records::MetricV1;
use crumple_stage::{Inputs, Output};

use crate::stage::metric_record::metric_record;

/// Maximum delta-V and the time to it, of every change of velocity in the inputs, under the ids of their channels,
/// first that which the pulse was derived from. Each has a line of the summary.
pub fn recorded_changes(input: &Inputs, test: &TestDescription, time_zero_s: f64, out: &mut Output) -> Vec<MetricV1> {
    let mut records = Vec::new();
    let mut changes: Vec<&Channel> =
        test.channels.iter().filter(|channel| channel.quantity == QuantityKind::VelocityChange).collect();
    // `<id>_derivative`, with underscores after it where that was taken.
    let derived_from = |id: &str| {
        let pulse = test.pulse.as_deref().unwrap_or_default();
        pulse == id || pulse.strip_prefix(id).is_some_and(|rest| rest.trim_end_matches('_') == "_derivative")
    };
    // Stable: the others stay in the order of the file.
    changes.sort_by_key(|channel| !derived_from(&channel.id));
    for channel in changes {
        let Some(wave) = input.wave_if(&channel.id) else { continue };
        let metrics = maximum_delta_v(&wave.sampled, time_zero_s);
        if let [Some(change), Some(time_s)] = [&metrics[0], &metrics[1]].map(|metric| metric.value) {
            let title = channel.comment.as_ref().map_or_else(String::new, |title| format!(" ({title})"));
            let (change_km_per_h, time_ms) = (3.6 * change, 1e3 * time_s);
            let line =
                format!("recorded {}{title}: maximum delta-v {change_km_per_h:.2} km/h at {time_ms:.0} ms", channel.id);
            out.summary(line);
        }
        records
            .extend(metrics.into_iter().map(|metric| metric_record(&[&channel.id], &metric.counted_from(time_zero_s))));
    }
    records
}
