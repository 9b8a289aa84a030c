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

use crumple_signal::{About, Notes, QuantityKind, Weight};

use crate::formats::ev5::sensor;
use crate::formats::ev5::specification::{Barrier, Curve, Test, Vehicle, details, says_nothing};
use crate::formats::reader::{Bundle, Reader};
use crate::formats::tdms::metadata::{Properties, Property, names};
use crate::formats::tdms::segments::{Content, Object, SegmentError};
use crate::formats::text::stamps::Instant;
use crate::formats::text::stamps::instant;
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::formats::{iso13499, tdm};
use crate::recording::content::{PulseRule, ReadChannel, Recording};
use crate::recording::details::Details;
use crate::{IngestError, IngestSettings, Place};

pub(crate) mod metadata;
mod segments;

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
        conversion::FLAGS
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
    let details = if layers.channels.iter().any(|(k, ..)| curve(&objects[*k].properties).is_some()) {
        test(&all, vehicle)
    } else {
        None
    };
    let is_nhtsa = details.is_some();
    let details = details.unwrap_or_else(|| tdm::details(&layers.root_texts()));

    let mut objects = objects;
    let mut records = Vec::with_capacity(layers.channels.len());
    let mut waveforms = Vec::with_capacity(layers.channels.len());
    for (k, group, name) in &layers.channels {
        let object = std::mem::take(&mut objects[*k]);
        let scales = metadata::chain(&[&object.properties, layers.group(group), &layers.root], object.is_daqmx);
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
fn waveform(object: Object, group: &str, name: &str, scales: Result<Vec<metadata::Linear>, String>) -> Waveform {
    let properties = &object.properties;
    let mut waveform = Waveform::new(group, name);
    waveform.unit = [text(properties, "unit_string"), text(properties, "NI_UnitDescription")]
        .into_iter()
        .find(|unit| !unit.is_empty())
        .map(str::to_owned)
        .or_else(|| unit(properties))
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
        SegmentError::TooLarge(found, limit) => IngestError::too_large(Place::file(file), found, limit),
    }
}

/// A field by its name in the guide, in any of `layers`; what is empty or `NA` counts as absent.
fn words(layers: &[&Properties], field: &str) -> Option<String> {
    let matches = |name: &str| {
        let name = name.trim();
        name.len().checked_sub(field.len()).is_some_and(|at| {
            let tail = name.get(at..).is_some_and(|tail| tail.eq_ignore_ascii_case(field));
            tail && (at == 0 || name[..at].ends_with(['_', '.', ' ', '[']))
        })
    };
    layers.iter().flat_map(|layer| layer.iter()).find_map(|(name, value)| {
        let text = match value {
            Property::Text(text) => text.trim().to_owned(),
            Property::Number(x) if x.is_finite() => x.to_string(),
            _ => return None,
        };
        (matches(name) && !text.is_empty()).then_some(text)
    })
}

/// A field that is a number.
fn number_of(layers: &[&Properties], field: &str) -> Option<f64> {
    words(layers, field)?.replace(',', ".").parse().ok().filter(|x: &f64| x.is_finite())
}

/// A field that is a number; 0 stands for nothing recorded.
fn positive(layers: &[&Properties], field: &str) -> Option<f64> {
    number_of(layers, field).filter(|x| *x > 0.0)
}

fn vehicle_number(layers: &[&Properties]) -> Option<u32> {
    number_of(layers, "VEHNO").map(|n| n as u32)
}

/// The unit of a channel, YUNITS.
pub fn unit(channel: &Properties) -> Option<String> {
    words(&[channel], "YUNITS")
}

/// The instrumentation record of a channel, if it has one.
pub fn curve(channel: &Properties) -> Option<Curve> {
    let layers = [channel];
    let sensor = words(&layers, "SENTYP")?.to_ascii_uppercase();
    // Codes may be followed by their meaning: `XG - X GLOBAL`.
    let code = |field: &str| {
        let text = words(&layers, field).unwrap_or_default().to_ascii_uppercase();
        text.split([' ', '-']).next().unwrap_or_default().to_owned()
    };
    Some(Curve {
        vehicle: vehicle_number(&layers).unwrap_or(1),
        number: number_of(&layers, "CURNO").map_or(0, |n| n as u32),
        sensor: if sensor.starts_with("AC") { "AC".to_owned() } else { sensor },
        location: code("SENLOC"),
        attachment: code("SENATT"),
        axis: code("AXIS"),
        y_unit: unit(channel).unwrap_or_default(),
        initial_velocity_km_per_h: number_of(&layers, "INIVEL"),
        status: code("DASTAT"),
        channel_status: code("CHSTAT"),
        comment: words(&layers, "INSCOM"),
        ..Curve::default()
    })
}

/// Identity, status and fitness of a channel from its record.
pub fn describe(read: &mut ReadChannel, curve: &Curve, vehicle: u32, notes: &mut Notes) {
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
    if matches!(channel.status, crumple_signal::ChannelStatus::Questionable | crumple_signal::ChannelStatus::Failed) {
        let comment = channel.comment.as_deref().unwrap_or("without a comment");
        let text = format!("channel {} is {} by its laboratory: {comment}", channel.id, channel.status);
        notes.concern(About::Channel(channel.id.clone()), Weight::Slight, text);
    }
}

/// What the properties say of test and vehicle; `None` if they say nothing.
pub fn test(all: &[&Properties], vehicle: u32) -> Option<Details> {
    let of_vehicle: Vec<&Properties> =
        all.iter().copied().filter(|p| vehicle_number(&[p]).is_none_or(|n| n == vehicle)).collect();
    let of_vehicle = of_vehicle.as_slice();
    let test = Test {
        title: words(of_vehicle, "TITLE"),
        date: words(of_vehicle, "TSTDAT"),
        laboratory: words(of_vehicle, "TSTPRF"),
        reference: words(of_vehicle, "TSTREF"),
        configuration: words(of_vehicle, "TSTCFN")
            .map(|c| c.split([' ', '-']).next().unwrap_or_default().to_ascii_uppercase()),
        closing_speed_km_per_h: positive(of_vehicle, "CLSSPD"),
        impact_angle_deg: number_of(of_vehicle, "IMPANG"),
        offset_mm: number_of(of_vehicle, "OFFSET"),
        comment: words(of_vehicle, "TSTCOM"),
    };
    let vehicle = Vehicle {
        number: vehicle,
        make_and_model: [words(of_vehicle, "MAKE"), words(of_vehicle, "MODEL")],
        year: words(of_vehicle, "YEAR"),
        test_mass_kg: positive(of_vehicle, "VEHTWT"),
        speed_km_per_h: number_of(of_vehicle, "VEHSPD").filter(|v| *v >= 0.0),
        width_mm: positive(of_vehicle, "VEHWID"),
        crush_profile_mm: (1..=6).filter_map(|k| number_of(of_vehicle, &format!("DPD{k}"))).collect(),
        damage_classification: words(of_vehicle, "VDI"),
        crab_angle_deg: number_of(of_vehicle, "CRBANG").filter(|a| *a != 0.0),
        principal_direction_deg: number_of(of_vehicle, "PDOF").filter(|a| *a != 0.0),
        damage_offset_mm: number_of(of_vehicle, "DAMDST").filter(|x| *x != 0.0),
        damage_width_mm: positive(of_vehicle, "LENCNT"),
        static_crush_mm: positive(of_vehicle, "CRHDST"),
        comment: words(of_vehicle, "VEHCOM").filter(|c| c != "0" && !says_nothing(c)),
    };
    let barrier = Barrier {
        rigidity: words(of_vehicle, "BARRIG"),
        shape: words(of_vehicle, "BARSHP"),
        angle_deg: positive(of_vehicle, "BARANG"),
        diameter_mm: positive(of_vehicle, "BARDIA"),
        comment: words(of_vehicle, "BARCOM"),
    };
    Some(details(&test, Some(&barrier), &vehicle, std::slice::from_ref(&vehicle)))
}
