//! Where the window of a run starts.

use crumple_identify::end_of_contact;
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, RefuseExt, Refused};

use crate::settings::Settings;

/// Start of the window, s after time zero, and in words how it was found where that is not simply `--from`.
pub fn window_start(settings: &Settings, inputs: &Inputs) -> anyhow::Result<(f64, Option<String>)> {
    let Some(share) = settings.hankel.as_ref().and_then(|hankel| hankel.free_decay_share) else {
        return Ok((settings.from_s, None));
    };
    let events = inputs.record_if::<EventsV1>("/events")?;
    if share == 0.0 {
        let Some(events) = events else {
            return Err(Refused::new("free decay from separation on, but there is no topic /events")
                .hint("add the artifact of crumple-integrate, or give a share of the peak, e.g. --free-decay 5%")
                .into());
        };
        let Some(time_s) = events.time_of_rebound_s else {
            return Err(Refused::new("the record of /events shows no time of rebound, hence no separation")
                .hint("give a share of the peak, e.g. --free-decay 5%, or --from")
                .into());
        };
        let start = time_s.max(settings.from_s);
        let rule = "the time of the rebound velocity, when the vehicle parts from the barrier";
        return Ok((start, Some(format!("free decay from {start:.5} s on, {rule}"))));
    }
    let zero_s = events.as_ref().map_or(0.0, |events| events.time_zero_s);
    let test = inputs.test()?;
    // The crash pulse is the channel that the events were read from.
    let pulse = match &events {
        Some(events) => &events.channel,
        None => &test.pulse_channel().refuse_with_hint("give the start as a time with --from")?.id,
    };
    let wave = &inputs.wave(pulse)?.sampled;
    let first = wave.index_at_or_after(zero_s + settings.from_s);
    let end = settings.to_s.map_or(wave.len(), |to| wave.index_at_or_after(zero_s + to + wave.dt_s() / 2.0));
    let force = wave.slice(first, end);
    let Some(after) = end_of_contact(force.samples(), share) else {
        return Err(Refused::new(format!(
            "channel {pulse} does not stay under {} % of its peak before the window ends: there is no free decay",
            100.0 * share
        ))
        .hint("give a larger share, a later --to, or the start as a time with --from")
        .into());
    };
    let start = force.t0_s() + after as f64 * force.dt_s() - zero_s;
    let rule = format!("after the last sample of channel {pulse} with {} % of its peak", 100.0 * share);
    Ok((start, Some(format!("free decay from {start:.5} s on, {rule}"))))
}
