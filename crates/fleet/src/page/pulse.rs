//! The pulse of a run.

use std::path::Path;

use crumple_artifact::Artifact;
use crumple_report::pulse_line;

use crate::tables::rows::Row;

/// Artifact with the filtered pulse.
const FILTERED: &str = "2-filter.mcap";

/// The filtered acceleration of a run's pulse as a small line; empty where there is none.
pub(crate) fn pulse(fleet: &Path, row: &Row) -> String {
    line(fleet, row).unwrap_or_default()
}

fn line(fleet: &Path, row: &Row) -> Option<String> {
    let summary = row.summary.as_ref()?;
    let artifact = Artifact::open(&fleet.join(&row.run.folder).join(FILTERED)).ok()?;
    let wave = &artifact.waves().get(summary.test.channel.as_deref()?)?.sampled;
    Some(pulse_line(wave, summary.events.as_ref().map_or(0.0, |events| events.time_zero_s)))
}
