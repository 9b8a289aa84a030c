//! One axis for channels that start at different instants.

use crate::formats::waveform::channel::{Instant, list};
use crate::recording::read_channel::ReadChannel;
use crate::time::time_zero;
use crate::{IngestError, Place};
use crumple_signal::Notes;

/// Channels that start farther apart than this are not of one event, s.
const ONE_EVENT_S: f64 = 60.0;
/// A shift below this part of an interval is rounding of the clock.
const ROUNDING: f64 = 1e-3;

/// Shifts channels so that all have the axis of the one that starts first. `origins`: when the t = 0 of each is, by the
/// clock of the file; a channel that has none keeps its times.
///
/// Channels more than a minute apart are of different events: none is shifted then, with a warning.
pub fn align(
    file: &str,
    channels: &mut [(usize, ReadChannel)],
    origins: &[Option<Instant>],
    notes: &mut Notes,
) -> Result<(), IngestError> {
    let start = |(channel, origin): (&(usize, ReadChannel), &Option<Instant>)| {
        let t0_s = channel.1.wave.as_ref()?.t0_s();
        origin.map(|origin| (origin, origin.plus(t0_s), channel.1.channel.id.clone()))
    };
    let starts: Vec<(Instant, Instant, String)> = channels.iter().zip(origins).filter_map(start).collect();
    let Some((axis, first, name)) = starts.iter().min_by(|a, b| a.1.since(b.1).total_cmp(&0.0)) else {
        return Ok(());
    };
    let apart_s = starts.iter().map(|(_, start, _)| start.since(*first)).fold(0.0, f64::max);
    if apart_s > ONE_EVENT_S {
        notes.warning(format!(
            "channels start at times of the day up to {apart_s:.3} s apart: they are not of one event, and each keeps \
             its own axis"
        ));
        return Ok(());
    }
    let mut shifted = Vec::new();
    for ((_, read), origin) in channels.iter_mut().zip(origins) {
        let (Some(origin), Some(wave)) = (origin, &read.wave) else { continue };
        let later_s = origin.since(*axis);
        if later_s.abs() <= ROUNDING * wave.dt_s() {
            continue;
        }
        let moved = time_zero::shift(wave, -later_s).map_err(|error| {
            let place = Place::file(file).in_column(read.channel.id.clone());
            IngestError::content(place, error.to_string(), "times in range", "correct the start time of the channel")
        })?;
        read.wave = Some(moved);
        shifted.push(format!("{} {:+.3} ms", read.channel.id, 1e3 * later_s));
    }
    if !shifted.is_empty() {
        notes.info(format!(
            "channels start at different instants: all have the axis of {name}, which starts first ({}); --time-zero \
             counts on that axis",
            list(&shifted)
        ));
    }
    Ok(())
}
