//! TDMS, the binary files of LabVIEW and DIAdem: segments of metadata and raw data, channels in groups.
//!
//! Read after NI's description of the format: contiguous and interleaved data, both byte orders, inherited object
//! lists, DAQmx raw data, linear scaling, aborted recordings.

mod bytes;
pub(crate) mod metadata;
mod nhtsa;
pub(crate) mod samples;
mod scaling;
mod segments;

use std::collections::BTreeMap;

use crumple_signal::Notes;

use crate::formats::reader::{Bundle, Reader};
use crate::formats::waveform::channel::{Instant, Waveform};
use crate::formats::waveform::conversion;
use crate::formats::waveform::date::instant;
use crate::formats::{diadem, iso13499};
use crate::recording::content::{PulseRule, Recording};
use crate::recording::read_channel::ReadChannel;
use crate::{IngestError, IngestSettings, Place};
use metadata::{Properties, Property, names};
use segments::{Content, Object, SegmentError};

/// Reader of TDMS files.
pub struct Tdms;

impl Reader for Tdms {
    fn format(&self) -> &'static str {
        "tdms"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        head.starts_with(b"TDSm")
    }

    fn relevant_flags(&self) -> &'static [&'static str] {
        &["--unit", "--time-unit", "--sample-time", "--vehicle-number", "--resample"]
    }

    fn read(&self, bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
        read(&bundle.main.name, &bundle.main.bytes, settings)
    }
}

/// Reads a file from its bytes. `file` names it in messages.
pub fn read(file: &str, bytes: &[u8], settings: &IngestSettings) -> Result<Recording, IngestError> {
    let Content { objects, warnings } = segments::read(bytes).map_err(|error| refuse(file, error))?;
    let mut notes = Notes::new();
    warnings.iter().take(12).for_each(|warning| notes.warning(warning.clone()));

    let layers = Layers::from_objects(&objects);
    let vehicle = settings.vehicle_number.unwrap_or(1);
    let all: Vec<&Properties> = objects.iter().map(|object| &object.properties).collect();
    let details = if layers.channels.iter().any(|(k, ..)| nhtsa::curve(&objects[*k].properties).is_some()) {
        nhtsa::test(&all, vehicle)
    } else {
        None
    };
    let is_nhtsa = details.is_some();
    let details = details.unwrap_or_else(|| diadem::details(&layers.root_texts()));

    let mut objects = objects;
    let mut records = Vec::with_capacity(layers.channels.len());
    let mut waveforms = Vec::with_capacity(layers.channels.len());
    for (k, group, name) in &layers.channels {
        let object = std::mem::take(&mut objects[*k]);
        let scales = scaling::chain(&[&object.properties, layers.group(group), &layers.root], object.is_daqmx);
        records.push(nhtsa::curve(&object.properties).filter(|_| is_nhtsa));
        waveforms.push(waveform(object, group, name, scales));
    }
    let channels = conversion::to_channels(file, waveforms, settings, &mut notes)?;
    let mut channels: Vec<ReadChannel> = channels
        .into_iter()
        .map(|(k, mut read)| {
            if let Some(curve) = &records[k] {
                nhtsa::describe(&mut read, curve, vehicle, &mut notes);
            }
            read
        })
        .collect();
    let pulse_rule =
        if is_nhtsa { PulseRule::Fittest } else { iso13499::pulse_rule(&mut channels, settings, &mut notes) };
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: is_nhtsa, notes })
}

/// Properties by the level at which they stand.
struct Layers {
    root: Properties,
    groups: BTreeMap<String, Properties>,
    /// Index of the object, group and name.
    channels: Vec<(usize, String, String)>,
    none: Properties,
}

impl Layers {
    fn from_objects(objects: &[Object]) -> Self {
        let mut layers =
            Self { root: Properties::new(), groups: BTreeMap::new(), channels: Vec::new(), none: Properties::new() };
        for (k, object) in objects.iter().enumerate() {
            match names(&object.path).as_deref() {
                Some([]) => layers.root = object.properties.clone(),
                Some([group]) => drop(layers.groups.insert(group.clone(), object.properties.clone())),
                Some([group, channel]) => layers.channels.push((k, group.clone(), channel.clone())),
                // Written by other programs, perhaps: the path is a name.
                _ => layers.channels.push((k, String::new(), object.path.clone())),
            }
        }
        layers
    }

    fn group(&self, name: &str) -> &Properties {
        self.groups.get(name).unwrap_or(&self.none)
    }

    fn root_texts(&self) -> BTreeMap<String, String> {
        self.root
            .iter()
            .filter_map(|(name, value)| match value {
                Property::Text(text) => Some((name.clone(), text.clone())),
                Property::Number(x) => Some((name.clone(), x.to_string())),
                _ => None,
            })
            .collect()
    }
}

fn text<'a>(properties: &'a Properties, name: &str) -> &'a str {
    match properties.get(name) {
        Some(Property::Text(text)) => text.trim(),
        _ => "",
    }
}

fn number(properties: &Properties, name: &str) -> Option<f64> {
    match properties.get(name) {
        Some(Property::Number(x)) if x.is_finite() => Some(*x),
        _ => None,
    }
}

/// When the time of a channel is 0, if it says so.
fn start_time(properties: &Properties) -> Option<Instant> {
    // Years before 1910 stand for no date.
    const NO_DATE_S: i64 = 200_000_000;
    match properties.get("wf_start_time") {
        Some(Property::Time(start)) => Some(*start).filter(|start| start.seconds > NO_DATE_S),
        Some(Property::Text(text)) => instant(text),
        _ => None,
    }
}

/// A channel with its time and its values, scaled.
fn waveform(object: Object, group: &str, name: &str, scales: Result<Vec<scaling::Linear>, String>) -> Waveform {
    let properties = &object.properties;
    let mut waveform = Waveform::new(group, name);
    waveform.unit = [text(properties, "unit_string"), text(properties, "NI_UnitDescription")]
        .into_iter()
        .find(|unit| !unit.is_empty())
        .map(str::to_owned)
        .or_else(|| nhtsa::unit(properties))
        .unwrap_or_default();
    waveform.comment = Some(text(properties, "description").to_owned()).filter(|text| !text.is_empty());
    let interval = number(properties, "wf_increment").filter(|dt| *dt > 0.0);
    let start = number(properties, "wf_start_offset").unwrap_or(0.0);
    let steps = interval.map(|dt| (start, dt));
    waveform.set_steps(steps, text(properties, "wf_xname"), text(properties, "wf_xunit_string"));
    waveform.origin = start_time(properties);
    let mut values = object.values;
    waveform.set_stamps(object.first_stamp);
    waveform.values = match (object.unread, scales) {
        (Some(what), _) => Err(format!("its samples are not read: {what}")),
        (None, Err(reason)) => Err(reason),
        (None, Ok(scales)) => {
            for scale in scales {
                values.iter_mut().for_each(|x| *x = scale.slope * *x + scale.intercept);
            }
            Ok(values)
        }
    };
    waveform
}

fn refuse(file: &str, error: SegmentError) -> IngestError {
    match error {
        SegmentError::Broken(broken) => IngestError::content(
            Place::file(file),
            format!("at byte {}: {}", broken.at, broken.found),
            "a TDMS file as LabVIEW or DIAdem writes it",
            "the file may be cut short or damaged: copy or download it again",
        ),
        SegmentError::TooLarge(found, limit) => IngestError::TooLarge { place: Place::file(file), found, limit },
    }
}
