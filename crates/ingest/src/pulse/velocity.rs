//! The pulse of a record that has a velocity and no acceleration.

use crumple_signal::{Axis, Notes, QuantityKind};

use crate::IngestError;
use crate::recording::channel_selection::select;
use crate::recording::content::Recording;
use crate::recording::details::Stated;
use crate::recording::read_channel::ReadChannel;

/// A velocity at contact of at least this part of the largest one is the impact speed; a smaller one is that of a
/// record of changes of velocity, or of a motion from rest.
const IMPACT_PART: f64 = 0.5;

/// Index of the velocity, or change of it, that stands for the pulse of a record without an acceleration: the one asked
/// for, else the first along x, else the first whose axis is not stated, else none. A note names the others.
pub fn choose(
    file: &str,
    recording: &Recording,
    wanted: Option<&str>,
    notes: &mut Notes,
) -> Result<Option<usize>, IngestError> {
    let has = |quantity| recording.channels.iter().any(|read| read.channel.quantity == quantity && read.wave.is_some());
    // Speeds before the crash stand beside the changes of velocity of a recorder.
    let (quantity, what) = if has(QuantityKind::VelocityChange) {
        (QuantityKind::VelocityChange, "change of velocity")
    } else {
        (QuantityKind::Velocity, "velocity")
    };
    let is_change = |k: &usize| {
        let ReadChannel { channel, wave, .. } = &recording.channels[*k];
        channel.quantity == quantity && wave.is_some()
    };
    let changes: Vec<usize> = (0..recording.channels.len()).filter(is_change).collect();
    let name = |k: usize| {
        let channel = &recording.channels[k].channel;
        channel.comment.as_ref().map_or_else(|| channel.id.clone(), |title| format!("{} ({title})", channel.id))
    };
    let names = |indices: &[usize]| indices.iter().map(|k| name(*k)).collect::<Vec<_>>().join(", ");
    let taken = match wanted {
        Some(wanted) => match select(&recording.channels, wanted).as_slice() {
            [k] if is_change(k) => *k,
            selected => {
                let found = match selected {
                    [] => format!("channel {wanted} is not listed"),
                    [k] => format!("channel {} is no {what}", name(*k)),
                    several => format!("--channel {wanted} means {} channels: {}", several.len(), names(several)),
                };
                let hint = "--list shows the channels of all tables";
                return Err(IngestError::channel(file, found, format!("one of {}", names(&changes)), hint));
            }
        },
        None => {
            let along = |axis| changes.iter().find(|k| recording.channels[**k].channel.axis == axis).copied();
            let Some(taken) = along(Some(Axis::X)).or_else(|| along(None)) else {
                notes.warning(format!(
                    "no {what} is along x: {}; --channel names the one that is meant",
                    names(&changes)
                ));
                return Ok(None);
            };
            taken
        }
    };
    let others: Vec<usize> = changes.into_iter().filter(|k| *k != taken).collect();
    let rest = if others.is_empty() { String::new() } else { format!("; others: {}", names(&others)) };
    notes.info(format!("the {what} {} is taken as the pulse{rest}", name(taken)));
    Ok(Some(taken))
}

/// The velocity at time zero as the impact speed, where nothing else states one.
pub fn speed_at_contact(recording: &mut Recording, index: usize, notes: &mut Notes) {
    let ReadChannel { channel, wave: Some(wave), .. } = &recording.channels[index] else { return };
    if channel.quantity != QuantityKind::Velocity || recording.details.impact_speed_m_per_s.is_some() {
        return;
    }
    let samples = wave.samples();
    let largest = samples.iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    let Some(at_contact) = samples.get(wave.index_at_or_after(0.0)).map(|v| v.abs()) else { return };
    if at_contact >= IMPACT_PART * largest && at_contact > 0.0 {
        notes.info(format!("impact speed {at_contact:.3} m/s: velocity {} at time zero", channel.id));
        let from = format!("the velocity {} at time zero", channel.id);
        recording.details.impact_speed_m_per_s = Some(Stated { value: at_contact, from });
    }
}
