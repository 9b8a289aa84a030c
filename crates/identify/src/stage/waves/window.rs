//! The window of a run: its channel, where it starts, and the samples in it.

use crumple_signal::Sampled;
use crumple_stage::records::EventsV1;
use crumple_stage::{RefuseExt, Refused};
use crumple_sysid::end_of_contact;

use crate::stage::waves::source::Source;

/// Start of the window, s after time zero, and in words how it was found where that is not simply `--from`.
pub fn window_start(source: Source<'_>) -> anyhow::Result<(f64, Option<String>)> {
    let Source { settings, test, inputs } = source;
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

/// The channel asked for, else the crash pulse; `hint` tells what to name where there is none.
pub fn channel<'a>(source: Source<'a>, hint: &str) -> anyhow::Result<&'a str> {
    match &source.settings.channel {
        Some(id) => Ok(id),
        None => Ok(&source.test.pulse_channel().refuse_with_hint(hint)?.id),
    }
}

/// The samples of a record that a model is identified from, and those after them that are kept for validation.
pub struct Window {
    /// Identified from.
    pub used: Sampled,
    /// What follows, if samples are kept for validation: no gap between.
    pub kept: Vec<f64>,
}

/// The part of the record that is used. The window counts from time zero, which the crash events state where they are
/// among the inputs; without them it is the record's own zero.
pub fn window(record: &Sampled, source: Source<'_>) -> anyhow::Result<Window> {
    let Source { settings, inputs, .. } = source;
    let zero_s = inputs.record_if::<EventsV1>("/events")?.map_or(0.0, |events| events.time_zero_s);
    // Half a sample of room for the rounding of times.
    let (from_s, rule) = window_start(source)?;
    let room_s = if rule.is_some() { record.dt_s() / 2.0 } else { 0.0 };
    let first = record.index_at_or_after(zero_s + from_s - room_s);
    // The sample at `to` itself belongs to the window.
    let end = settings.to_s.map_or(record.len(), |to| record.index_at_or_after(zero_s + to + record.dt_s() / 2.0));
    let used = settings.validate_from_s.map_or(end, |from| end.min(record.index_at_or_after(zero_s + from)));
    let kept = record.slice(used.max(first), end).samples().to_vec();
    let end = settings.samples.map_or(used, |count| used.min(first.saturating_add(count)));
    let window = record.slice(first, end);
    if window.is_empty() {
        return Err(Refused::new(format!(
            "the window from {} s holds no sample: the record runs from {} s to {} s",
            settings.from_s,
            record.t0_s(),
            record.end_s()
        ))
        .hint("set --from and --to to times inside the record")
        .into());
    }
    if settings.validate_from_s.is_some() && (kept.is_empty() || end < used) {
        return Err(Refused::new("no sample is left for the validation, or --samples ends before it begins")
            .hint("set --validate-from to a time inside the window, without --samples")
            .into());
    }
    let kept = if settings.validate_from_s.is_some() { kept } else { Vec::new() };
    Ok(Window { used: window, kept })
}
