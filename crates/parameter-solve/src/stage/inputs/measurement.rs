//! What the artifacts say of how the displacement came about.

use crumple_lumped_fit::{IntegrationRule, Measurement, TwoPassFilter};
use crumple_signal::{Acceleration, Sampled};
use crumple_stage::records::{ChannelFilterV1, EventsV1};
use crumple_stage::{Inputs, RefuseExt, Wave};

/// The measurement of a motion of this channel; [exact](Measurement::exact) where its filter is not known. Time zero,
/// start and rule are those of the events: all channels are integrated alike.
pub fn measurement(input: &Inputs, events: &EventsV1, channel: &str, motion: &Sampled) -> anyhow::Result<Measurement> {
    let record: Option<ChannelFilterV1> = input.record_if(&format!("/filter/{channel}"))?;
    let acceleration = input
        .wave_if(channel)
        .map(Wave::signal::<Acceleration>)
        .transpose()
        .refuse()?
        .filter(|wave| (wave.dt_s() - motion.dt_s()).abs() <= 1e-9 * wave.dt_s());
    let (dt_s, t0_s, samples) = match &acceleration {
        Some(wave) => (wave.dt_s(), wave.t0_s(), wave.len()),
        None => (motion.dt_s(), motion.t0_s(), motion.len()),
    };
    let rule = match events.rule.as_deref() {
        Some("forward-euler") => IntegrationRule::ForwardEuler,
        _ => IntegrationRule::Trapezoid,
    };
    let filter = record.as_ref().and_then(|record| {
        let class = record.mode.starts_with("iso6487") || record.mode.starts_with("sae");
        let coefficients: [f64; 5] = record.coefficients.clone().try_into().ok()?;
        (class && record.cfc.is_some())
            .then_some(TwoPassFilter { coefficients, samples_added: record.samples_added as usize })
    });
    let untouched = record.as_ref().is_some_and(|record| record.coefficients.is_empty() && record.width_s.is_none());
    let unfiltered = untouched && input.test().ok().and_then(|t| t.channel(channel)?.cfc).is_none();
    let as_sampled = record.as_ref().is_some_and(|r| r.resampled_to_hz.is_none());
    let known = acceleration.is_some()
        && as_sampled
        && (filter.is_some() || unfiltered)
        && matches!(events.rule.as_deref(), None | Some("trapezoid" | "forward-euler"));
    let measurement = Measurement {
        dt_s,
        first_s: t0_s - events.time_zero_s,
        samples,
        filter: filter.filter(|_| known),
        from_contact: events.start.as_deref() != Some("record-start"),
        rule,
    };
    Ok(if known { measurement } else { measurement.exact() })
}
