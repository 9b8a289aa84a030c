//! HDF5 files, and MATLAB's of version 7.3, which are such: every data set of numbers is a channel, or the columns of a
//! matrix are; groups are groups.
//!
//! Unit, interval or rate and start are taken from attributes of the data set, else of its group, by their usual names.
//! The bytes are read by the crate `hdf5-pure`, which has no C. What a data set states of its size is held against the
//! memory that is left before anything is read.

use std::collections::HashMap;

use crumple_signal::Notes;
use hdf5_pure::{AttrValue, File, Group};

use crate::formats::mat::columns;
use crate::formats::reader::{Bundle, Reader, guarded};
use crate::formats::remarks::PartsNotRead;
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::recording::content::{Recording, list};
use crate::recording::details::Details;
use crate::{IngestError, IngestSettings, Result};

pub const HDF5: Reader = Reader::of_one_file("hdf5", recognises, conversion::FLAGS, read);

/// Groups within groups.
const DEPTH: usize = 8;
/// More groups and data sets than this are no record; links may lead back to a group.
const OBJECT_LIMIT: usize = 4096;
/// Most numbers of all data sets together: 256 MiB, as of a packed variable of an earlier MATLAB file.
const NUMBER_LIMIT: u64 = 1 << 25;
/// What a number takes while it is read: packed, unpacked, as a column and as a wave.
const BYTES_A_NUMBER: u64 = 32;

const UNIT: [&str; 4] = ["units", "unit", "unit_string", "yunit"];
const INTERVAL: [&str; 8] =
    ["dt", "wf_increment", "increment", "sample_time", "sampling_interval", "sample_interval", "xincrement", "delta_t"];
const RATE: [&str; 7] =
    ["sampling_rate", "sample_rate", "samplerate", "sampling_frequency", "sample_frequency", "fs", "rate"];
const START: [&str; 5] = ["t0", "wf_start_offset", "start_time", "start", "x0"];

fn recognises(head: &[u8]) -> bool {
    head.starts_with(b"\x89HDF\r\n\x1a\n") || head.starts_with(b"MATLAB 7.3")
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let file = bundle.main.name.as_str();
    let found = guarded(|| Found::of(bundle.main.bytes.clone()));
    let hint = "the file may be cut short: save it again, or export the channels as CSV";
    let found = found.map_err(|what| IngestError::content(file, what, "a whole HDF5 file", hint))?;
    let mut notes = Notes::new();
    if !found.unread.is_empty() {
        notes.push(PartsNotRead { parts: "data sets", names: list(&found.unread) });
    }
    conversion::recording(file, found.waveforms, Details::default(), settings, notes)
}

#[derive(Default)]
struct Found {
    waveforms: Vec<Waveform>,
    unread: Vec<String>,
    seen: usize,
    numbers: u64,
}

/// What attributes say of a data set.
#[derive(Default, Clone)]
struct Attributes {
    unit: String,
    interval_s: Option<f64>,
    start_s: Option<f64>,
}

impl Attributes {
    /// Those of an object, where it has none those of its group.
    fn of(attributes: HashMap<String, AttrValue>, group: &Self) -> Self {
        // In the order of names, since a map has none.
        let mut attributes: Vec<(String, AttrValue)> =
            attributes.into_iter().map(|(name, value)| (name.to_lowercase(), value)).collect();
        attributes.sort_by(|a, b| a.0.cmp(&b.0));
        let first = |names: &[&str]| {
            names.iter().find_map(|name| attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value))
        };
        let positive = |names: &[&str]| first(names).and_then(number).filter(|x| *x > 0.0);
        Self {
            unit: first(&UNIT).and_then(text).unwrap_or_else(|| group.unit.clone()),
            interval_s: positive(&INTERVAL).or_else(|| positive(&RATE).map(|rate| 1.0 / rate)).or(group.interval_s),
            start_s: first(&START).and_then(number).or(group.start_s),
        }
    }
}

fn number(value: &AttrValue) -> Option<f64> {
    let number = match value {
        AttrValue::F64(x) => *x,
        AttrValue::F32(x) => f64::from(*x),
        AttrValue::I64(x) => *x as f64,
        AttrValue::U64(x) => *x as f64,
        AttrValue::I32(x) => f64::from(*x),
        AttrValue::U32(x) => f64::from(*x),
        AttrValue::I16(x) => f64::from(*x),
        AttrValue::U16(x) => f64::from(*x),
        AttrValue::I8(x) => f64::from(*x),
        AttrValue::U8(x) => f64::from(*x),
        AttrValue::F64Array(x) => *x.first().filter(|_| x.len() == 1)?,
        AttrValue::I64Array(x) => *x.first().filter(|_| x.len() == 1)? as f64,
        other => text(other)?.trim().parse().ok()?,
    };
    number.is_finite().then_some(number)
}

fn text(value: &AttrValue) -> Option<String> {
    match value {
        AttrValue::String(text)
        | AttrValue::AsciiString(text)
        | AttrValue::VarLenString(text)
        | AttrValue::VarLenAsciiString(text) => Some(text.clone()),
        AttrValue::StringSized { value, .. } | AttrValue::AsciiStringSized { value, .. } => Some(value.clone()),
        AttrValue::StringArray(texts)
        | AttrValue::VarLenStringArray(texts)
        | AttrValue::VarLenAsciiStringArray(texts)
            if texts.len() == 1 =>
        {
            texts.first().cloned()
        }
        _ => None,
    }
}

impl Found {
    fn of(bytes: Vec<u8>) -> Result<Self, String> {
        let file = File::from_bytes(bytes).map_err(|error| error.to_string())?;
        let mut found = Self::default();
        found.group(&file.root(), "", &Attributes::default(), DEPTH)?;
        Ok(found)
    }

    fn group(&mut self, group: &Group, name: &str, above: &Attributes, depth: usize) -> Result<(), String> {
        let words = |error: hdf5_pure::Error| error.to_string();
        let own = Attributes::of(group.attrs().unwrap_or_default(), above);
        self.seen += 1;
        let mut names = group.datasets().map_err(words)?;
        names.sort_unstable();
        for set in names {
            self.seen += 1;
            if self.seen > OBJECT_LIMIT {
                return Err(format!("more than {OBJECT_LIMIT} groups and data sets"));
            }
            if let Err(reason) = self.dataset(group, name, &set, &own) {
                self.unread.push(format!("{set} ({reason})"));
            }
        }
        let mut groups = group.groups().map_err(words)?;
        groups.sort_unstable();
        // What MATLAB keeps for itself begins with `#`.
        for inner in groups.iter().filter(|inner| depth > 0 && !inner.starts_with('#')) {
            if self.seen > OBJECT_LIMIT {
                return Err(format!("more than {OBJECT_LIMIT} groups and data sets"));
            }
            let path = if name.is_empty() { inner.clone() } else { format!("{name}.{inner}") };
            self.group(&group.group(inner).map_err(words)?, &path, &own, depth - 1)?;
        }
        Ok(())
    }

    fn dataset(&mut self, group: &Group, path: &str, name: &str, above: &Attributes) -> Result<(), String> {
        let data = group.dataset(name).map_err(|error| error.to_string())?;
        let shape = data.shape().map_err(|error| error.to_string())?;
        let count = shape.iter().try_fold(1_u64, |product, side| product.checked_mul(*side)).unwrap_or(u64::MAX);
        let most = NUMBER_LIMIT.min(crumple_memory::left() / BYTES_A_NUMBER).saturating_sub(self.numbers);
        if count > most {
            return Err(format!("{count} numbers, of which there is room for {most}"));
        }
        if count < 2 {
            return Ok(());
        }
        let attributes = data.attrs().map_err(|error| error.to_string())?;
        let class = attributes.get("MATLAB_class").and_then(text);
        if class.is_some_and(|class| class == "char" || class == "cell") {
            return Err("texts".to_owned());
        }
        if shape.len() > 2 {
            return Err(format!("{} dimensions", shape.len()));
        }
        let side = |k: usize| shape.get(k).and_then(|side| usize::try_from(*side).ok()).unwrap_or(1);
        let values = data.read_f64().map_err(|error| error.to_string())?;
        self.numbers += count;
        let own = Attributes::of(attributes, above);
        let first = self.waveforms.len();
        // Rows stand one after the other, as the columns of MATLAB do.
        let sides = if shape.len() == 1 { (side(0), 1) } else { (side(1), side(0)) };
        columns(path, name, sides, values, &mut self.waveforms);
        for waveform in &mut self.waveforms[first..] {
            waveform.unit.clone_from(&own.unit);
            waveform.steps = own.interval_s.map(|interval| (own.start_s.unwrap_or(0.0), interval));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdf5_pure::FileBuilder;

    fn found(build: impl FnOnce(&mut FileBuilder)) -> Found {
        let mut builder = FileBuilder::new();
        build(&mut builder);
        Found::of(builder.finish().unwrap()).unwrap()
    }

    #[test]
    fn data_sets_are_channels_and_attributes_say_unit_and_rate() {
        let found = found(|file| {
            file.create_dataset("time").with_f64_data(&[0.0, 0.1, 0.2]).with_shape(&[3]);
            let set = file.create_dataset("ax").with_f32_data(&[1.0, 2.0, 3.0]).with_shape(&[3]);
            set.set_attr("units", AttrValue::String("g".to_owned()));
            set.set_attr("sampling_rate", AttrValue::F64(1000.0));
        });
        let [ax, time] = &found.waveforms[..] else { panic!("{}", found.waveforms.len()) };
        assert_eq!((ax.name.as_str(), ax.unit.as_str(), ax.steps), ("ax", "g", Some((0.0, 1e-3))));
        assert_eq!(time.values.as_deref().unwrap(), [0.0, 0.1, 0.2]);
        assert_eq!(time.steps, None);
    }

    #[test]
    fn a_matrix_is_its_columns() {
        let found = found(|file| {
            file.create_dataset("m").with_f64_data(&[0.0, 5.0, 1.0, 6.0, 2.0, 7.0]).with_shape(&[3, 2]);
        });
        let names: Vec<&str> = found.waveforms.iter().map(|waveform| waveform.name.as_str()).collect();
        assert_eq!(names, ["m_time", "m_2"]);
        assert_eq!(found.waveforms[1].values.as_deref().unwrap(), [5.0, 6.0, 7.0]);
    }
}
