//! `metrics`: one row a metric of a run.

use crumple_report::{RunSummary, SummaryMetric};

use crate::runs::Run;
use crate::tables::table::Kind::{Number, Text};
use crate::tables::table::{Cell, Kind};
use crate::tables::tests_table::cells_of_run;

/// Columns of the table.
pub(crate) const METRICS: [(&str, Kind); 8] = [
    ("metric", Text),
    ("channel", Text),
    ("location", Text),
    ("value", Number),
    ("unit", Text),
    ("low", Number),
    ("high", Number),
    ("definition_id", Text),
];

/// The rows of a run: metrics of the pulse, then those of other channels.
pub(crate) fn rows(run: &Run, summary: &RunSummary) -> Vec<Vec<Cell>> {
    let own = cells_of_run(run);
    let row = |name: &str, channel: Option<&str>, location: Option<&str>, metric: &SummaryMetric| {
        let row = vec![
            name.into(),
            channel.into(),
            location.into(),
            metric.value.into(),
            (&metric.unit).into(),
            metric.low.into(),
            metric.high.into(),
            metric.definition_id.as_deref().into(),
        ];
        [own.clone(), row].concat()
    };
    let pulse = summary.test.channel.as_deref();
    let of_pulse = summary.metrics.iter().map(|(name, metric)| row(name, pulse, None, metric));
    let of_others = summary
        .other_metrics
        .iter()
        .map(|other| row(&other.name, Some(&other.channel), other.location.as_deref(), &other.metric));
    of_pulse.chain(of_others).collect()
}
