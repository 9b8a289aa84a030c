//! Named waveforms as channels in SI, and what is noted about them.

use crumple_signal::{About, Channel, Notes, QuantityKind, Sampled, Weight, remarks};

use crate::formats::iso13499;
use crate::formats::remarks::{ChannelLeftOut, MissingAtEnds, PartsNotRead, UnitReplaced, UnitUnknown};
use crate::formats::text::column_names::{self, Unit, names_acceleration, stated_unit};
use crate::formats::waveform::channel::{self, Label, Waveform};
use crate::formats::waveform::clock::{Asked, Clocks, TimeOfChannel};
use crate::recording::content::{Fitness, ReadChannel, Recording, list};
use crate::recording::details::Details;
use crate::recording::settings;
use crate::{GAPS_ARE_NOT_FILLED, IngestError, IngestSettings, Place, Result, refuse, time};

/// What is noted once for many channels.
#[derive(Debug, Default)]
struct Remarks {
    /// Missing samples at the end, by channel.
    trimmed: Vec<(usize, String)>,
    /// Channels without samples.
    empty: Vec<String>,
    /// Channels without a known unit.
    no_unit: Vec<String>,
    /// Channels that cannot be read.
    left_out: Vec<IngestError>,
}

/// Flags about the form of a file that waveforms heed.
pub const FLAGS: &[&str] = &["--unit", "--time-unit", "--sample-time", "--vehicle-number", "--resample"];

pub fn recording(
    file: &str,
    waveforms: Vec<Waveform>,
    details: Details,
    settings: &IngestSettings,
    mut notes: Notes,
) -> Result<Recording> {
    let channels = to_channels(file, waveforms, settings, &mut notes)?;
    let mut channels: Vec<ReadChannel> = channels.into_iter().map(|(_, read)| read).collect();
    let pulse_rule = iso13499::pulse_rule(&mut channels, settings, &mut notes);
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: false, notes })
}

/// Makes channels in SI of waveforms; each comes with the index of its waveform.
///
/// A channel of times and one without samples are no channels of the record. One that cannot be read is left out with a
/// warning, unless it is asked for or nothing remains.
pub fn to_channels(
    file: &str,
    mut waveforms: Vec<Waveform>,
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<Vec<(usize, ReadChannel)>> {
    let labels: Vec<Label> = waveforms.iter().map(|w| channel::label(&w.name, &w.unit)).collect();
    let ids = channel::ids(&waveforms, &labels);
    let aliases = channel::aliases(&waveforms, &labels);
    let wanted = settings.channel.as_deref().and_then(|wanted| channel::find(wanted, &ids, &aliases));
    let mut remarks = Remarks::default();
    for (waveform, id) in waveforms.iter_mut().zip(&ids) {
        if let Ok(values) = &mut waveform.values {
            let missing = values.iter().rev().take_while(|x| x.is_nan()).count();
            values.truncate(values.len() - missing);
            if missing > 0 {
                remarks.trimmed.push((missing, id.clone()));
            }
        }
    }
    let mut clocks = Clocks::find(file, &waveforms, &labels, settings, notes);
    // The unit is that of the channels of times; without any, that of the steps.
    if let Some(symbol) = settings.time_unit.as_deref().filter(|_| !clocks.are_any()) {
        let unit_s = time::stated_unit(file, symbol, "--time-unit or the sidecar")?;
        let is_other = |waveform: &Waveform| waveform.steps.is_some() && waveform.step_unit_s != unit_s;
        if waveforms.iter().any(is_other) {
            notes.push(UnitOfSteps { unit: symbol.to_owned() });
        }
        waveforms.iter_mut().for_each(|waveform| waveform.step_unit_s = unit_s);
    }
    let kinds = quantities(file, &waveforms, &labels, &clocks, wanted, settings, notes)?;

    let mut channels: Vec<(usize, ReadChannel)> = Vec::new();
    let mut origins = Vec::new();
    for (k, waveform) in waveforms.into_iter().enumerate() {
        let (id, aliases, label, (quantity, factor)) = (&ids[k], &aliases[k], &labels[k], kinds[k]);
        let is_wanted = wanted == Some(k);
        if clocks.are_times[k] {
            continue;
        }
        if matches!(&waveform.values, Ok(values) if values.is_empty()) && !is_wanted {
            remarks.empty.push(id.clone());
            continue;
        }
        let (wave, (grid, origin), comment) = match samples(file, id, waveform, (quantity, factor), &mut clocks) {
            Ok(read) => read,
            Err(error) if is_wanted => return Err(error),
            // A list has it, without a rate.
            Err(error) if settings.listing => {
                let channel = Channel::new(id.clone(), quantity);
                channels.push((k, ReadChannel::without_readable_file(channel, error.to_string())));
                origins.push(None);
                continue;
            }
            Err(error) => {
                remarks.left_out.push(error);
                continue;
            }
        };
        if quantity == QuantityKind::Other && !matches!(label.unit, Unit::Time(_)) {
            remarks.no_unit.push(id.clone());
        }
        let acceleration = quantity == QuantityKind::Acceleration;
        let mut channel = Channel::new(id.clone(), quantity);
        channel.axis = column_names::axis(&label.title);
        channel.cfc = column_names::cfc(&label.title).filter(|_| acceleration);
        iso13499::describe_by_name(&mut channel, &label.name, notes);
        channel.comment = comment;
        let fitness = Fitness::of_only(quantity, "the only acceleration channel");
        let aliases = aliases.clone();
        origins.push(origin);
        let jitter = grid.jitter;
        channels.push((k, ReadChannel { wave: Some(wave), jitter, fitness, aliases, ..ReadChannel::new(channel) }));
    }
    channel::align(file, &mut channels, &origins, notes)?;
    if channels.is_empty() {
        return Err(remarks.left_out.into_iter().next().unwrap_or_else(|| {
            IngestError::content(
                file,
                "no channel has samples",
                "at least one channel of numbers",
                "check that the recording was saved, not its description only",
            )
        }));
    }
    if settings.resample.is_some() && !clocks.resamples() {
        let why = "every channel states a uniform step; resample of the filter brings channels to another rate";
        settings::warn("--resample", why, notes);
    }
    if settings.sample_time.is_some() && !clocks.is_stated_used {
        settings::warn("--sample-time", "every channel has its time in the file", notes);
    }
    clocks.notes(notes);
    remarks.notes(notes);
    Ok(channels)
}

const MOTIONS: [QuantityKind; 3] = [QuantityKind::Acceleration, QuantityKind::Velocity, QuantityKind::VelocityChange];

type Read = (Sampled, TimeOfChannel, Option<String>);

fn samples(
    file: &str,
    id: &str,
    waveform: Waveform,
    (quantity, factor): (QuantityKind, f64),
    clocks: &mut Clocks,
) -> Result<Read> {
    let refuse =
        |found: String, expected: &str, hint: &str| refuse(Place::file(file).in_column(id), found, expected, hint);
    let mut values = match waveform.values {
        Ok(values) => values,
        Err(found) => return refuse(found, "numbers", waveform.remedy),
    };
    if values.is_empty() {
        return refuse("no samples".to_owned(), "samples", "choose another channel by --channel");
    }
    if let Some(found) = waveform.not_time {
        return refuse(found, "steps of time", "export the channel over time");
    }
    let unit_s = waveform.step_unit_s;
    let asked = Asked {
        file,
        id,
        group: &waveform.group,
        steps: waveform.steps.map(|(start, interval)| (start * unit_s, interval * unit_s)),
        origin: waveform.origin,
        is_motion: MOTIONS.contains(&quantity),
    };
    let (grid, origin) = clocks.grid(&asked, &mut values)?;
    if let Some(k) = values.iter().position(|x| !x.is_finite()) {
        let what = if values[k].is_nan() { "missing (NaN)" } else { "infinite" };
        return refuse(
            format!("sample {k} of {} is {what}", values.len()),
            "finite numbers; only missing samples at the end are cut off",
            GAPS_ARE_NOT_FILLED,
        );
    }
    values.iter_mut().for_each(|x| *x *= factor);
    match Sampled::new(grid.t0_s, grid.dt_s, values) {
        Ok(wave) => Ok((wave, (grid, origin), waveform.comment)),
        Err(error) => refuse(error.to_string(), "finite numbers on a uniform grid", "export the channel again"),
    }
}

impl Remarks {
    fn notes(mut self, notes: &mut Notes) {
        self.trimmed.sort_by_key(|(count, _)| *count);
        for same in self.trimmed.chunk_by(|a, b| a.0 == b.0) {
            let ids: Vec<&str> = same.iter().map(|(_, id)| id.as_str()).collect();
            let channels = Some(list(&ids));
            notes.push(MissingAtEnds { file: None, channels, before: 0, after: same[0].0 });
        }
        if !self.empty.is_empty() {
            notes.push(PartsNotRead { parts: "channels", names: list(&self.empty) });
        }
        if !self.no_unit.is_empty() {
            notes.push(UnitUnknown { unit: None, channels: list(&self.no_unit) });
        }
        for error in self.left_out.iter().take(12) {
            let reason = Some(error.to_string());
            notes.push(ChannelLeftOut { channel: None, file: None, more: None, reason });
        }
        if self.left_out.len() > 12 {
            let more = Some(self.left_out.len() - 12);
            notes.push(ChannelLeftOut { channel: None, file: None, more, reason: None });
        }
    }
}

/// Quantity and factor to SI of every waveform; [`QuantityKind::Other`] and 1 where no unit is known.
///
/// `--unit` is for the channel asked for and for those named for acceleration, or for the only one.
pub fn quantities(
    file: &str,
    waveforms: &[Waveform],
    labels: &[Label],
    clocks: &Clocks,
    wanted: Option<usize>,
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<Vec<(QuantityKind, f64)>> {
    let stated = settings.unit.as_deref();
    let stated = stated.map(|symbol| stated_unit(file, symbol, "--unit or the sidecar", false)).transpose()?;
    let data: Vec<usize> = (0..waveforms.len()).filter(|k| !clocks.are_times[*k]).collect();
    let is_acceleration = |k: &&usize| matches!(labels[**k].unit, Unit::Signal(QuantityKind::Acceleration, _));
    let accelerations = data.iter().filter(is_acceleration).count();
    let is_target =
        |k: usize| speaks_of_acceleration(&labels[k].title) || wanted.map_or(data.len() == 1, |wanted| wanted == k);
    let mut kinds = vec![(QuantityKind::Other, 1.0); waveforms.len()];
    for &k in &data {
        let title = &labels[k].title;
        kinds[k] = match (&labels[k].unit, stated) {
            (Unit::Signal(QuantityKind::Acceleration, f), Some((QuantityKind::Acceleration, over)))
                if *f != over && (wanted == Some(k) || accelerations == 1) =>
            {
                let (channel, stated_m_per_s2, used_m_per_s2) = (Some(title.clone()), *f, over);
                notes.push(UnitReplaced { channel, column: None, stated_m_per_s2, used_m_per_s2 });
                (QuantityKind::Acceleration, over)
            }
            (Unit::Signal(kind, f), _) => (*kind, *f),
            (Unit::Unstated | Unit::Unknown(_), Some(unit))
                if is_target(k) && (unit.0 == QuantityKind::Acceleration || wanted == Some(k) || data.len() == 1) =>
            {
                unit
            }
            _ => (QuantityKind::Other, 1.0),
        };
    }
    if let Some(unit) = stated
        && !data.iter().any(|k| kinds[*k] == unit)
    {
        settings::warn("--unit", "the channels state units of their own; --channel names the one that is meant", notes);
    }
    let lacks_unit = |k: &usize| stated.is_none() && matches!(labels[*k].unit, Unit::Unstated | Unit::Unknown(_));
    let mut named = data.iter().copied().filter(|k| lacks_unit(k) && speaks_of_acceleration(&labels[*k].title));
    let ask = match wanted {
        Some(wanted) => Some(wanted).filter(lacks_unit),
        None => named.next().filter(|_| accelerations == 0),
    };
    let Some(k) = ask.filter(|_| !settings.listing && settings.scale.is_none()) else {
        return Ok(kinds);
    };
    let Label { title, unit, .. } = &labels[k];
    let hint = "add --unit g or --unit m/s^2; units are not guessed";
    Err(unit.refuse(Place::file(file).in_column(title), &channel::ids(waveforms, labels)[k], hint))
}

/// Whether a title names acceleration; `Femur (Acceptable)` does not.
fn speaks_of_acceleration(title: &str) -> bool {
    let other_words = ["accept", "accur", "access", "accum", "accord"];
    names_acceleration(&other_words.iter().fold(title.to_lowercase(), |title, word| title.replace(word, "")))
}

remarks! {
    /// Remarks of waveforms as channels.
    pub REMARKS;

    /// The unit of the time steps was replaced by that of a flag or the sidecar.
    CR065 UnitOfSteps { unit: String }
    bears on (About::Record, Weight::None)
    decided "--time-unit or the sidecar states another unit of time than the file, which has no channel of times."
    means "All times are in the unit of the flag. If the file was right, velocity and crush are wrong."
    remedy "leave --time-unit out, unless the file is known to be wrong"
    says format!("the steps of the channels are in {unit} by --time-unit; the file has another unit");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_words_that_start_alike_are_no_acceleration() {
        assert!(speaks_of_acceleration("Head Acc X") && speaks_of_acceleration("IIWPG Acceleration"));
        assert!(!speaks_of_acceleration("Femur (Acceptable)") && !speaks_of_acceleration("accuracy"));
    }
}
