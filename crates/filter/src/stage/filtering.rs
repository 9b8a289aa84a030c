//! Filters the chosen channels and writes them, with what a person should know of it.

use std::sync::Mutex;

use crumple_signal::{
    About, Applied, Channel, ChannelStatus, Class, Coefficients, CorridorPoint, FilterError, FilterSettings, Filtered,
    Note, Notes, QuantityKind, TestDescription, Value, Weight, ZeroLevel, acceleration_of_velocity_change, corridor,
    derivative_note, filter, filter_reporting, remarks,
};
use crumple_stage::records::{ChannelFilterV1, CorridorPointV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused, option};
use rayon::prelude::*;

use crate::stage::channels_to_filter::ChannelToFilter;

/// The channels after filtering, in their order. One that cannot be filtered is refused, or left out with a warning
/// where nobody named it and it is not the pulse.
pub fn filter_channels(
    channels: &[ChannelToFilter<'_>],
    named: bool,
    pulse: Option<&str>,
    remarks: &mut Remarks,
    out: &Output,
) -> anyhow::Result<Vec<FilteredChannel>> {
    let mut all = Vec::new();
    for (channel, result) in channels.iter().zip(filter_all(channels, out)) {
        match result {
            Ok(filtered) => {
                for note in filtered.notes.iter() {
                    remarks.add(&channel.id, note.clone());
                }
                all.push(FilteredChannel {
                    id: channel.id.clone(),
                    quantity: channel.wave.quantity,
                    filtered,
                    extra: Extra::default(),
                });
            }
            // A channel nobody asked for does not stop the others.
            Err(error) if !named && pulse != Some(&channel.id) => {
                remarks.add(&channel.id, NotFiltered { reason: error.to_string() });
            }
            Err(error) => {
                return Err(Refused::new(format!("channel {}: {error}", channel.id)).hint(hint(&error)).into());
            }
        }
    }
    Ok(all)
}

/// All channels at once; the results are in the order of the channels, whatever the number of threads.
fn filter_all(channels: &[ChannelToFilter<'_>], out: &Output) -> Vec<Result<Filtered, FilterError>> {
    let work = channels.iter().map(|channel| 2 * channel.wave.sampled.len() as u64).sum();
    let progress = Mutex::new(out.progress("filtering", work));
    let report = |amount| {
        if let Ok(mut progress) = progress.lock() {
            progress.advance(amount);
        }
    };
    let run = |channel: &ChannelToFilter<'_>| {
        filter_reporting(&channel.wave.sampled, channel.cfc, &channel.settings, &report)
    };
    match channels {
        // Threads cost more than they give for one channel.
        [channel] => vec![run(channel)],
        several => several.par_iter().map(run).collect(),
    }
}

/// The one thing to do about a channel that cannot be filtered.
fn hint(error: &FilterError) -> String {
    let typed = |name, value| option("filter", name, value);
    match error {
        FilterError::Order { .. } => format!("{} is usual", typed("order", "4")),
        FilterError::Cutoff { .. } => format!("{}: the -3 dB frequency with its unit", typed("cutoff", "100Hz")),
        FilterError::Window { .. } => "let the zero level begin before it ends".to_owned(),
        _ => format!("{} leaves the signal as it is", typed("cfc", "none")),
    }
}

/// What was done to a channel after filtering.
#[derive(Default)]
pub struct Extra {
    pub resampled_to_hz: Option<f64>,
    /// The filter at the rate that is kept, and the samples it mirrors at each end there; `None`: all samples are kept.
    pub as_kept: Option<(Coefficients, usize)>,
}

/// A channel on its way out.
pub struct FilteredChannel {
    pub id: String,
    pub quantity: QuantityKind,
    pub filtered: Filtered,
    pub extra: Extra,
}

/// The acceleration of a pulse that is a velocity or a change of it, which becomes the pulse in its place; nothing for
/// any other. What a recorder kept is not filtered to a class: the recorder has filtered, nobody says how. A velocity
/// is where it is sampled fast enough for the class.
pub fn derived(
    settings: &FilterSettings,
    input: &Inputs,
    test: &mut TestDescription,
    remarks: &mut Remarks,
) -> anyhow::Result<Option<FilteredChannel>> {
    let change = |channel: &&Channel| {
        matches!(channel.quantity, QuantityKind::VelocityChange | QuantityKind::Velocity) && channel.status.has_data()
    };
    let Some(of) = test.pulse_channel().ok().filter(change).cloned() else { return Ok(None) };
    let wave = &input.wave(&of.id)?.sampled;
    let acceleration =
        acceleration_of_velocity_change(wave).refuse_with_hint("check the steps of the velocity change")?;
    let is_recorder = of.quantity == QuantityKind::VelocityChange;
    let class = match settings.class {
        Class::Cfc(cfc) if !is_recorder && wave.rate_hz() >= 10.0 * f64::from(cfc.number()) => settings.class,
        _ => Class::None,
    };
    let of_derived = FilterSettings { class, zero_level: ZeroLevel::None, ..*settings };
    let mut filtered = filter(&acceleration, None, &of_derived).refuse_with_hint("leave the filter out")?;
    if is_recorder {
        derivative_note(wave, &of.id, &mut filtered.notes);
    } else {
        filtered.notes.push(DerivedFromVelocity { velocity: of.id.clone(), over_s: 2.0 * wave.dt_s() });
    }
    let mut id = format!("{}_derivative", of.id);
    while test.channel(&id).is_some() {
        id.push('_');
    }
    for note in filtered.notes.iter() {
        remarks.add(&id, note.clone());
    }
    test.pulse = Some(id.clone());
    test.channels.push(Channel {
        location: of.location,
        axis: of.axis,
        status: ChannelStatus::Computed,
        comment: Some(format!(
            "derived from the velocity {}{}, central differences",
            if is_recorder { "change " } else { "" },
            of.id
        )),
        filter_state: is_recorder.then(|| "not stated by the recorder".to_owned()),
        polarity: of.polarity,
        sensor: of.sensor,
        ..Channel::new(id.clone(), QuantityKind::Acceleration)
    });
    Ok(Some(FilteredChannel { id, quantity: QuantityKind::Acceleration, filtered, extra: Extra::default() }))
}

/// The line of the summary about the pulse.
pub fn pulse_line(id: &str, cfc: Option<u16>, filtered: &Filtered) -> String {
    let class = cfc.map_or_else(|| "no class".to_owned(), |cfc| format!("CFC {cfc}"));
    let how = filtered.applied.as_ref().map_or("passed through", Applied::name);
    format!("pulse {id}: {class} ({how}), zero level {:+.4} m/s^2 removed", filtered.zero_level_removed)
}

/// The record of how a channel was filtered.
pub fn record(filtered: &Filtered, extra: &Extra) -> ChannelFilterV1 {
    let applied = filtered.applied.as_ref();
    let mut record = ChannelFilterV1 {
        cfc: None,
        mode: applied.map_or("none", Applied::name).to_owned(),
        frequency_factor: None,
        samples_added: applied.map_or(0, |applied| applied.samples_added() as u64),
        coefficients: Vec::new(),
        gain_at_class_db: None,
        zero_level_removed: filtered.zero_level_removed,
        notes: filtered.notes.to_texts(),
        corridor: Vec::new(),
        corridor_ok: None,
        cutoff_hz: Vec::new(),
        phase: applied.map(|applied| applied.phase().name().to_owned()),
        width_s: None,
        resampled_to_hz: extra.resampled_to_hz,
        shift_s: None,
    };
    match applied {
        Some(Applied::Class { cfc, coefficients, .. }) => {
            let points = corridor(*cfc, coefficients);
            record.cfc = Some(cfc.number());
            record.frequency_factor = Some(coefficients.mode().frequency_factor());
            record.coefficients = coefficients.to_array().to_vec();
            record.gain_at_class_db = Some(coefficients.two_pass_gain_db(cfc.frequency_hz()));
            record.corridor_ok = Some(points.iter().all(CorridorPoint::is_inside));
            record.corridor = points.into_iter().map(corridor_point).collect();
        }
        Some(Applied::Butterworth { design, .. }) => {
            record.coefficients = design.sections.concat();
            record.cutoff_hz = vec![design.asked.cutoff_hz];
        }
        None => {}
    }
    // What the kept samples show is this filter at their rate.
    if let Some((coefficients, samples_added)) = &extra.as_kept {
        record.coefficients = coefficients.to_array().to_vec();
        record.samples_added = *samples_added as u64;
    }
    record
}

fn corridor_point(point: CorridorPoint) -> CorridorPointV1 {
    let CorridorPoint { frequency_hz, gain_db, upper_db, lower_db } = point;
    CorridorPointV1 { frequency_hz, gain_db, upper_db, lower_db }
}

remarks! {
    /// Remarks of single channels.
    pub REMARKS;

    /// The acceleration was derived from a measured velocity.
    CR218 DerivedFromVelocity { velocity: String, over_s: f64 }
    bears on (About::Pulse, Weight::Slight)
    decided "The pulse of the test is a velocity; central differences give its acceleration."
    means "Delta-v and crush hold. Noise of the velocity is amplified in the acceleration: peaks are too high."
    remedy "take the accelerometer channel as the pulse, where there is one: --channel"
    says format!(
        "derived from the velocity {velocity} by central differences over {:.3} ms, not measured: noise of the \
         velocity is amplified in it",
        1e3 * over_s
    );

    /// A channel that nobody asked for cannot be filtered and is left out.
    CR219 NotFiltered { reason: String }
    bears on (About::Pulse, Weight::Slight)
    decided "A filter needs a rate of ten times its class and four samples; the sentence says what is missing."
    means "Nothing is made from this channel. The pulse and all others are as they are."
    remedy "nothing, or name the channels to filter: filter.channels"
    says format!("left out: {reason}");

    /// A channel is handed on without a filter.
    CR220 HandedOn {}
    bears on (About::Pulse, Weight::None)
    decided "The pipeline names it in filter.pass, or it is a change of velocity that a recorder kept."
    means "Later stages read it as it was recorded."
    remedy "nothing"
    says "handed on as it is";

    /// A channel was brought to another sampling rate.
    CR221 Resampled { from_hz: f64, to_hz: f64, interpolation: String }
    bears on (About::Pulse, Weight::None)
    decided "The pipeline asks for it: filter.resample."
    means "Samples are interpolated; between them nothing new is known."
    remedy "nothing; leave filter.resample out to keep the rate of the record"
    says format!("resampled from {from_hz:.0} Hz to {to_hz:.0} Hz ({interpolation})");

    /// Of a channel sampled fast only as many samples are kept as its class needs.
    CR222 Thinned { from_hz: f64, every: usize, to_hz: f64 }
    bears on (About::Pulse, Weight::None)
    decided "The rate that is left is the lowest that shows the response of the class without an error."
    means "Results are the same; files and later stages are smaller and faster."
    remedy "nothing; filter.rate = \"full\" keeps every sample"
    says format!(
        "sampled at {from_hz:.0} Hz; after filtering every {every}th sample is kept, {to_hz:.0} Hz"
    );
}

/// Remarks, each once, with the channels they hold for.
#[derive(Default)]
pub struct Remarks(Vec<(Note, Vec<String>)>);

impl Remarks {
    /// A remark on a channel.
    pub fn add(&mut self, id: &str, remark: impl Into<Note>) {
        self.channels_of(remark.into()).push(id.to_owned());
    }

    /// A remark on no channel of those that are filtered.
    pub fn of_test(&mut self, remark: impl Into<Note>) {
        self.channels_of(remark.into());
    }

    fn channels_of(&mut self, note: Note) -> &mut Vec<String> {
        let at = self.0.iter().position(|(own, _)| *own == note).unwrap_or_else(|| {
            self.0.push((note, Vec::new()));
            self.0.len() - 1
        });
        &mut self.0[at].1
    }

    pub fn into_notes(self) -> Notes {
        let mut notes = Notes::new();
        for (mut note, ids) in self.0 {
            if !ids.is_empty() {
                let names = first_of(&ids);
                note = note.within(&format!("channel{} {names}: ", if ids.len() > 1 { "s" } else { "" }), "");
                note.values.push(("channels", Value::Text(names)));
            }
            notes.push(note);
        }
        notes
    }
}

/// The first of a list of names: hundreds of load cells help nobody.
pub fn first_of(ids: &[String]) -> String {
    const SHOWN: usize = 12;
    match ids.len().saturating_sub(SHOWN) {
        0 => ids.join(", "),
        more => format!("{} and {more} more", ids[..SHOWN].join(", ")),
    }
}
