//! The force on the barrier as the sum of its load cells, and how it was measured.

use crumple_artifact::records::{ChannelFilterV1, EventsV1};
use crumple_signal::{IntegrationRule, Measurement, QuantityKind, Sampled, TwoPassFilter};

use crate::artifacts::inputs::Inputs;
use crate::artifacts::recording_steps::class_filter;

impl Inputs {
    /// The sum of the load cells that integrate wrote, N, positive in compression, with the filter of its cells; `None`
    /// without one.
    ///
    /// The measurement is known where all cells with data went through one filter at their own rate, else exact.
    /// Errors: a record that cannot be read.
    pub fn wall_force(&self, events: &EventsV1) -> anyhow::Result<Option<(Sampled, Measurement)>> {
        let Some(wave) = self.wave_if("barrier/force") else { return Ok(None) };
        let force = wave.sampled.clone();
        let test = self.test()?;
        let is_cell = |location: &str| location.trim().to_lowercase().starts_with("barrier");
        let cells = test.channels.iter().filter(|c| c.quantity == QuantityKind::Force && is_cell(&c.location));
        let mut filters: Vec<TwoPassFilter> = Vec::new();
        let mut known = true;
        for cell in cells {
            let Some(record) = self.record_if::<ChannelFilterV1>(&format!("/filter/{}", cell.id))? else { continue };
            match class_filter(&record).filter(|_| record.resampled_to_hz.is_none()) {
                Some(filter) => filters.push(filter),
                None => known = false,
            }
        }
        filters.dedup();
        known &= filters.len() == 1;
        let measurement = Measurement {
            dt_s: force.dt_s(),
            first_s: force.t0_s() - events.time_zero_s,
            samples: force.len(),
            filter: filters.pop(),
            from_contact: false,
            rule: Some(IntegrationRule::Trapezoid),
            // What is not known of a sum of load cells are their gains more than their noise.
            before_event: None,
        };
        Ok(Some((force, if known { measurement } else { measurement.exact() })))
    }
}
