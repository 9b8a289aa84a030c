//! What the artifacts say of how the motion of a channel came about.

use crumple_artifact::records::{ChannelFilterV1, EventsV1, TestV1};
use crumple_signal::{Acceleration, BeforeEvent, IntegrationRule, Measurement, Sampled, TwoPassFilter};

use crate::artifacts::inputs::Inputs;
use crate::error::RefuseExt;

/// The coefficients of a channel class filter and the samples mirrored before it; `None` of any other.
pub(crate) fn class_filter(record: &ChannelFilterV1) -> Option<TwoPassFilter> {
    let is_class = record.mode.starts_with("iso6487") || record.mode.starts_with("sae");
    let coefficients: [f64; 5] = record.coefficients.clone().try_into().ok()?;
    (is_class && record.cfc.is_some())
        .then_some(TwoPassFilter { coefficients, samples_added: record.samples_added as usize })
}

/// Whether both have one interval, and samples at the same instants where they overlap.
fn is_on_grid_of(wave: &Sampled, motion: &Sampled) -> bool {
    let apart = (motion.t0_s() - wave.t0_s()) / wave.dt_s();
    (wave.dt_s() - motion.dt_s()).abs() <= 1e-9 * wave.dt_s() && (apart - apart.round()).abs() <= 1e-3
}

impl Inputs {
    /// The steps from the acceleration of this channel to its motion. Time zero, start and rule are those of the
    /// events: all channels are integrated alike.
    ///
    /// Known are CFC filters with their coefficients, no filter, the trapezoidal rule and forward Euler, at the rate of
    /// the record; else the measurement is exact. Errors: a record that cannot be read.
    pub fn recording_steps(&self, events: &EventsV1, channel: &str, motion: &Sampled) -> anyhow::Result<Measurement> {
        let record: Option<ChannelFilterV1> = self.record_if(&format!("/filter/{channel}"))?;
        let acceleration = self
            .wave_if(channel)
            .map(crumple_artifact::Wave::signal::<Acceleration>)
            .transpose()
            .refuse()?
            .filter(|wave| is_on_grid_of(wave, motion));
        let (dt_s, t0_s, samples) = match &acceleration {
            Some(wave) => (wave.dt_s(), wave.t0_s(), wave.len()),
            None => (motion.dt_s(), motion.t0_s(), motion.len()),
        };
        let filter = record.as_ref().and_then(class_filter);
        let untouched = record.as_ref().is_some_and(|r| r.coefficients.is_empty() && r.width_s.is_none());
        let test: Option<TestV1> = self.record_if("/test")?;
        let recorded = test.iter().flat_map(|test| &test.channels).find(|recorded| recorded.id == channel);
        let unfiltered = untouched && recorded.and_then(|recorded| recorded.cfc).is_none();
        let as_sampled = record.as_ref().is_some_and(|r| r.resampled_to_hz.is_none());
        let rule = match events.rule.as_deref() {
            None | Some("trapezoid") => Some(IntegrationRule::Trapezoid),
            Some("forward-euler") => Some(IntegrationRule::ForwardEuler),
            Some(_) => None,
        };
        let known = acceleration.is_some() && as_sampled && (filter.is_some() || unfiltered);
        let end_s = filter.map_or(0.0, |filter| filter.samples_added as f64 * dt_s);
        let before_event = acceleration.as_ref().and_then(|wave| BeforeEvent::of(wave, events.time_zero_s, end_s));
        let measurement = Measurement {
            dt_s,
            first_s: t0_s - events.time_zero_s,
            samples,
            filter,
            from_contact: events.start.as_deref() != Some("record-start"),
            rule,
            before_event,
        };
        Ok(if known && rule.is_some() { measurement } else { measurement.exact() })
    }
}
