//! Which channel is the crash pulse.

use crumple_signal::{About, Axis, Channel, ChannelStatus, Notes, QuantityKind, Weight, part_of};

use crate::IngestError;
use crate::pulse::compartment;
use crate::recording::channel_selection::select;
use crate::recording::content::{MINIMUM_SAMPLES, PulseRule, Recording};
use crate::recording::read_channel::ReadChannel;

/// Index of the pulse among the channels: the one asked for, else the fittest of those that are valid and have data.
/// What was taken, why, and what else there is goes into a note. `None` only where one may be missing; where nothing
/// speaks of a crash, that is no warning.
pub fn choose_pulse(
    file: &str,
    recording: &Recording,
    wanted: Option<&str>,
    (allow_missing, is_of_a_crash): (bool, bool),
    notes: &mut Notes,
) -> Result<Option<usize>, IngestError> {
    let mut candidates: Vec<usize> =
        (0..recording.channels.len()).filter(|k| is_candidate(&recording.channels[*k])).collect();
    // Stable: equally fit channels stay in the order of the file.
    candidates.sort_by_key(|k| recording.channels[*k].fitness);
    let index = match wanted {
        Some(wanted) => requested_channel(file, recording, wanted, &candidates)?,
        None => match best_candidate(file, recording, &candidates) {
            Ok(index) => index,
            Err(error) if allow_missing => {
                if is_of_a_crash {
                    let text = format!("no channel is named as the crash pulse: {error}");
                    notes.concern(About::Pulse, Weight::Decisive, text);
                } else {
                    notes.info(format!("a record of inputs and outputs, as no pulse is named (--channel names one): {error}"));
                }
                return Ok(None);
            }
            Err(error) => return Err(error),
        },
    };
    let pulse = &recording.channels[index];
    let samples = pulse.wave.as_ref().map_or(0, crumple_signal::Sampled::len);
    if samples < MINIMUM_SAMPLES {
        return Err(IngestError::channel(
            file,
            format!("channel {} has {samples} samples", pulse.channel.id),
            format!("at least {MINIMUM_SAMPLES} samples"),
            "choose another channel by --channel",
        ));
    }
    note_choice(recording, index, &candidates, wanted.is_some(), notes);
    Ok(Some(index))
}

fn is_candidate(read: &ReadChannel) -> bool {
    read.fitness.is_some()
        && read.wave.is_some()
        && matches!(read.channel.status, ChannelStatus::Valid | ChannelStatus::Computed)
}

fn best_candidate(file: &str, recording: &Recording, candidates: &[usize]) -> Result<usize, IngestError> {
    let hint = "name the channel by --channel";
    match (candidates, recording.pulse_rule) {
        ([], PulseRule::OnlyOne) => Err(IngestError::channel(file, "no acceleration column with data", "one", hint)),
        ([], PulseRule::Fittest) => {
            let others: Vec<&ReadChannel> = recording
                .channels
                .iter()
                .filter(|f| f.wave.is_some() && f.channel.quantity == QuantityKind::Acceleration)
                .collect();
            let unread: Vec<&str> = recording.channels.iter().filter_map(|read| read.unread.as_deref()).collect();
            if let Some(first) = unread.first() {
                let more = unread.len() - 1;
                let more = if more > 0 { format!("; and {more} more cannot be read") } else { String::new() };
                return Err(IngestError::channel(
                    file,
                    format!("no accelerometer along x at a usual place of the compartment can be read: {first}{more}"),
                    "a readable file of rear-seat crossmember, rear floor, sill, B-pillar or centre of gravity",
                    "download the test again, or name another channel by --channel",
                ));
            }
            Err(IngestError::channel(
                file,
                format!(
                    "no valid accelerometer along x at a usual place of the compartment has its file here; \
                     accelerations here: {}",
                    if others.is_empty() { "none".to_owned() } else { list(others.into_iter()) }
                ),
                "rear-seat crossmember, rear floor, sill, B-pillar or centre of gravity",
                hint,
            ))
        }
        ([first, ..], PulseRule::Fittest) => Ok(*first),
        ([only], PulseRule::OnlyOne) => Ok(*only),
        (several, PulseRule::OnlyOne) if let Some(pulse) = vehicle_channel(recording, several) => Ok(pulse),
        (several, PulseRule::OnlyOne) => Err(IngestError::channel(
            file,
            format!(
                "{} acceleration columns: {}",
                several.len(),
                list(several.iter().map(|k| &recording.channels[*k]))
            ),
            "to be told which is the crash pulse",
            format!("add --channel {}, for example", recording.channels[several[0]].channel.id),
        )),
    }
}

/// The only accelerometer of several columns that is of no occupant's head or chest; where all are, the first of them
/// along x: criteria are made of all of them, and nothing else is here.
fn vehicle_channel(recording: &Recording, several: &[usize]) -> Option<usize> {
    let channel = |k: usize| &recording.channels[k].channel;
    let vehicle: Vec<usize> = several.iter().copied().filter(|k| part_of(channel(*k)).is_none()).collect();
    match vehicle.as_slice() {
        [only] => Some(*only),
        [] => several.iter().copied().find(|k| channel(*k).axis == Some(Axis::X)).or_else(|| several.first().copied()),
        _ => None,
    }
}

fn requested_channel(
    file: &str,
    recording: &Recording,
    wanted: &str,
    candidates: &[usize],
) -> Result<usize, IngestError> {
    let wanted = wanted.trim();
    let usual = || list(candidates.iter().map(|k| &recording.channels[*k]));
    let several = select(&recording.channels, wanted);
    let &[index] = several.as_slice() else {
        if !several.is_empty() {
            return Err(IngestError::channel(
                file,
                format!(
                    "--channel {wanted} means {} channels: {}",
                    several.len(),
                    list(several.iter().map(|k| &recording.channels[*k]))
                ),
                "one channel as the crash pulse",
                format!("give an id, such as --channel {}", recording.channels[several[0]].channel.id),
            ));
        }
        return Err(IngestError::channel(
            file,
            format!("channel {wanted} is not listed"),
            format!("one of its {} channels, such as {}", recording.channels.len(), usual()),
            "crumple-ingest --list prints the table of channels",
        ));
    };
    let ReadChannel { channel, wave, unread, .. } = &recording.channels[index];
    let id = &channel.id;
    let hint = || match candidates {
        [] => "choose a channel with data by --channel".to_owned(),
        _ => format!("candidates here: {}", usual()),
    };
    if wave.is_none() {
        let found = match channel.status {
            ChannelStatus::NotInstalled => {
                let comment = channel.comment.as_deref().map_or_else(String::new, |c| format!(" ({c})"));
                format!("channel {id}: not installed{comment}: it has no data, and no file is missing")
            }
            _ if let Some(reason) = unread => format!("channel {id}: its file is not read: {reason}"),
            _ => match &channel.comment {
                Some(comment) if id.parse::<u32>().is_err() => format!("channel {id} has no data: {comment}"),
                _ if id.parse::<u32>().is_err() => format!("channel {id} ({}): its file is not here", channel.location),
                _ => format!(
                    "channel {id} ({}): its signal file, with the extension .{id:0>3}, is not here",
                    channel.location
                ),
            },
        };
        return Err(IngestError::channel(file, found, "a channel with data", hint()));
    }
    if channel.quantity != QuantityKind::Acceleration {
        let found = format!("channel {} measures {}", describe(channel), channel.quantity);
        return Err(IngestError::channel(file, found, "an acceleration as the crash pulse", hint()));
    }
    Ok(index)
}

fn describe(channel: &Channel) -> String {
    let location = channel.location.strip_prefix("vehicle, ").unwrap_or(&channel.location);
    match (location.is_empty(), channel.redundant) {
        (true, _) => channel.id.clone(),
        (false, false) => format!("{} ({location})", channel.id),
        (false, true) => format!("{} ({location}, redundant)", channel.id),
    }
}

fn list<'a>(channels: impl Iterator<Item = &'a ReadChannel>) -> String {
    let names: Vec<String> = channels.map(|f| describe(&f.channel)).collect();
    if names.len() > 12 {
        format!("{} and {} more", names[..12].join(", "), names.len() - 12)
    } else {
        names.join(", ")
    }
}

fn note_choice(recording: &Recording, index: usize, candidates: &[usize], asked: bool, notes: &mut Notes) {
    let pulse = &recording.channels[index];
    let why = match (asked, pulse.fitness) {
        (true, _) => "as asked for".to_owned(),
        (false, Some(fitness)) if recording.pulse_rule == PulseRule::Fittest => {
            format!("valid accelerometer along x at the best place here: {}", fitness.why)
        }
        (false, Some(fitness)) => fitness.why.to_owned(),
        (false, None) => String::new(),
    };
    let others: Vec<&ReadChannel> =
        candidates.iter().filter(|k| **k != index).map(|k| &recording.channels[*k]).collect();
    let others = match others.as_slice() {
        [] => String::new(),
        others => format!("; others by --channel: {}", list(others.iter().copied())),
    };
    notes.info(format!("pulse: channel {}, {why}{others}", describe(&pulse.channel)));
    if !candidates.contains(&index) && pulse.channel.status != ChannelStatus::Valid {
        notes.concern(
            About::Pulse,
            Weight::Marked,
            format!("the pulse, channel {}, is {} by its laboratory", pulse.channel.id, pulse.channel.status),
        );
    }
    if let Some(doubt) = compartment::doubt(pulse, recording.pulse_rule) {
        let taken = if asked { "taken as asked for" } else { "nothing else is here" };
        notes.concern(About::Pulse, Weight::Decisive, format!(
            "the pulse, channel {}, does not stand for the passenger compartment: {doubt}; {taken}, but crush, force \
             and models are then not those of the vehicle",
            describe(&pulse.channel)
        ));
    }
    if !asked && pulse.channel.redundant {
        notes.concern(
            About::Pulse,
            Weight::Slight,
            format!("the pulse, channel {}, is a redundant sensor: no primary one is valid here", pulse.channel.id),
        );
    }
}
