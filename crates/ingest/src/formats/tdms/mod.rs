//! TDMS, the binary files of LabVIEW and DIAdem: segments of metadata and raw data, channels in groups.
//!
//! Read after NI's description of the format: contiguous and interleaved data, both byte orders, inherited object
//! lists, DAQmx raw data, linear scaling, aborted recordings.
//!
//! TDMS files of the NHTSA database: the fields of the EV5 guide as properties `INST_SENTYP`, `VEH_VEHTWT`,
//! `TEST_CLSSPD`.
//!
//! Written after descriptions of such files; none was at hand. Hence tolerant: a field may stand at the channel, its
//! group or the file, with any prefix, as a text or as a number.

use std::collections::BTreeMap;

use crumple_signal::{Notes, QuantityKind};

use crate::formats::ev5::sensor;
use crate::formats::ev5::specification::{Barrier, Curve, Record, Test, Vehicle, details};
use crate::formats::reader::{Bundle, Reader};
use crate::formats::tdms::metadata::{Properties, Property, names};
use crate::formats::tdms::segments::{Content, Object, is_date};
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::formats::{iso13499, tdm};
use crate::recording::content::{PulseRule, ReadChannel, Recording, note_doubts};
use crate::recording::details::Details;
use crate::time::{Instant, instant};
use crate::{IngestSettings, Result};

pub(crate) mod metadata;
pub(crate) mod segments;

pub const TDMS: Reader = Reader::of_one_file("tdms", |head| head.starts_with(b"TDSm"), conversion::FLAGS, read);

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let Content { objects, warnings } = segments::read(file, bytes)?;
    let mut notes = Notes::new();
    warnings.into_iter().take(12).for_each(|warning| notes.push(warning));

    let layers = Layers::from_objects(&objects);
    let all: Vec<&Properties> = objects.iter().map(|object| &object.properties).collect();
    let curves: Vec<Curve> = layers.channels.iter().filter_map(|(k, ..)| curve(&objects[*k].properties)).collect();
    let is_nhtsa = !curves.is_empty();
    let vehicle = settings.vehicle_of(|channel| {
        let curve = curves.iter().find(|curve| curve.number > 0 && channel.parse() == Ok(curve.number))?;
        Some(curve.vehicle).filter(|vehicle| *vehicle > 0)
    });
    let details = if is_nhtsa { test(&all, vehicle) } else { tdm::details(&layers.root_texts()) };

    let mut objects = objects;
    let mut records = Vec::with_capacity(layers.channels.len());
    let mut waveforms = Vec::with_capacity(layers.channels.len());
    for (k, group, name) in &layers.channels {
        let object = std::mem::take(&mut objects[*k]);
        let scales = {
            static NONE: Properties = Properties::new();
            let of_group = layers.groups.get(group).unwrap_or(&NONE);
            metadata::chain(&[&object.properties, of_group, &layers.root], object.is_daqmx)
        };
        records.push(curve(&object.properties).filter(|_| is_nhtsa));
        waveforms.push(waveform(object, group, name, scales));
    }
    let channels = conversion::to_channels(file, waveforms, settings, &mut notes)?;
    let mut channels: Vec<ReadChannel> = channels
        .into_iter()
        .map(|(k, mut read)| {
            if let Some(curve) = &records[k] {
                describe(&mut read, curve, vehicle, &mut notes);
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
}

impl Layers {
    fn from_objects(objects: &[Object]) -> Self {
        let mut layers = Self { root: Properties::new(), groups: BTreeMap::new(), channels: Vec::new() };
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
    match properties.get("wf_start_time") {
        Some(Property::Time(start)) => Some(*start).filter(|start| is_date(*start)),
        Some(Property::Text(text)) => instant(text),
        _ => None,
    }
}

/// A channel with its time and its values, scaled.
fn waveform(object: Object, group: &str, name: &str, scales: Result<Vec<metadata::Linear>, String>) -> Waveform {
    let properties = &object.properties;
    let mut waveform = Waveform::new(group, name);
    waveform.unit = [text(properties, "unit_string"), text(properties, "NI_UnitDescription")]
        .into_iter()
        .find(|unit| !unit.is_empty())
        .map(str::to_owned)
        .or_else(|| Fields(&[properties]).words(8, "YUNITS"))
        .unwrap_or_default();
    waveform.comment = Some(text(properties, "description").to_owned()).filter(|text| !text.is_empty());
    let interval = number(properties, "wf_increment").filter(|dt| *dt > 0.0);
    let start = number(properties, "wf_start_offset").unwrap_or(0.0);
    let steps = interval.map(|dt| (start, dt));
    waveform.set_steps(steps, text(properties, "wf_xname"), text(properties, "wf_xunit_string"));
    waveform.origin = start_time(properties);
    let mut values = object.values;
    waveform.set_stamps(object.first_stamp);
    if object.parts.is_some() {
        waveform.remedy = "write each record into a channel of its own, or export the one of the crash as CSV";
    }
    waveform.values = match (object.unread, object.parts, scales) {
        (Some(what), ..) => Err(format!("its samples are not read: {what}")),
        (None, Some(reason), _) | (None, None, Err(reason)) => Err(reason),
        (None, None, Ok(scales)) => {
            for (slope, intercept) in scales {
                values.iter_mut().for_each(|x| *x = slope * *x + intercept);
            }
            Ok(values)
        }
    };
    waveform
}

/// Properties of one or several layers as a record of the guide; what is empty counts as absent.
struct Fields<'a>(&'a [&'a Properties]);

impl Record for Fields<'_> {
    /// A field by its name in the guide, in any layer.
    fn words(&self, _: usize, field: &str) -> Option<String> {
        let matches = |name: &str| {
            let name = name.trim();
            name.len().checked_sub(field.len()).is_some_and(|at| {
                let tail = name.get(at..).is_some_and(|tail| tail.eq_ignore_ascii_case(field));
                tail && (at == 0 || name[..at].ends_with(['_', '.', ' ', '[']))
            })
        };
        self.0.iter().flat_map(|layer| layer.iter()).find_map(|(name, value)| {
            let text = match value {
                Property::Text(text) => text.trim().to_owned(),
                Property::Number(x) if x.is_finite() => x.to_string(),
                _ => return None,
            };
            (matches(name) && !text.is_empty()).then_some(text)
        })
    }

    fn number(&self, position: usize, field: &str) -> Option<f64> {
        self.words(position, field)?.replace(',', ".").parse().ok().filter(|x: &f64| x.is_finite())
    }

    /// Codes may be followed by their meaning: `XG - X GLOBAL`.
    fn code(&self, position: usize, field: &str) -> String {
        let text = self.words(position, field).unwrap_or_default().to_ascii_uppercase();
        text.split([' ', '-']).next().unwrap_or_default().to_owned()
    }

    fn comment(&self, position: usize, field: &str) -> Option<String> {
        self.words(position, field)
    }
}

fn vehicle_number(layers: &[&Properties]) -> Option<u32> {
    Fields(layers).number(1, "VEHNO").map(|n| n as u32)
}

fn curve(channel: &Properties) -> Option<Curve> {
    let (layers, number) = ([channel], Fields(&[channel]).number(2, "CURNO").map_or(0, |n| n as u32));
    let sensor = Fields(&layers).words(3, "SENTYP")?.to_ascii_uppercase();
    let sensor = if sensor.starts_with("AC") { "AC".to_owned() } else { sensor };
    Some(Curve { sensor, ..Curve::new(&Fields(&layers), vehicle_number(&layers).unwrap_or(1), number) })
}

/// Identity, status and fitness of a channel from its record.
fn describe(read: &mut ReadChannel, curve: &Curve, vehicle: u32, notes: &mut Notes) {
    let channel = &mut read.channel;
    channel.location = sensor::location(curve);
    channel.axis = sensor::axis(curve).or(channel.axis);
    channel.status = curve.channel_status();
    channel.redundant = curve.channel_status == "R";
    channel.initial_velocity_m_per_s = curve.initial_velocity_km_per_h.map(|v| v / 3.6);
    channel.comment = curve.comment.clone().or(channel.comment.take());
    read.fitness = sensor::fitness(curve, vehicle).filter(|_| channel.quantity == QuantityKind::Acceleration);
    if curve.number > 0 {
        read.aliases.push(curve.number.to_string());
    }
    note_doubts(channel, notes);
}

/// What the properties say of test and vehicle.
fn test(all: &[&Properties], vehicle: u32) -> Details {
    let of_vehicle: Vec<&Properties> =
        all.iter().copied().filter(|p| vehicle_number(&[p]).is_none_or(|n| n == vehicle)).collect();
    let record = Fields(&of_vehicle);
    let configuration = Some(record.code(9, "TSTCFN")).filter(|_| record.words(9, "TSTCFN").is_some());
    let test = Test { configuration, ..Test::new(&record) };
    let (vehicle, barrier) = (Vehicle::new(&record, vehicle), Barrier::new(&record));
    details(&test, Some(&barrier), &vehicle, std::slice::from_ref(&vehicle))
}
