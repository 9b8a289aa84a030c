//! What a TDMS file says of its channels: properties, scaling, where the samples lie.
//!
//! NI scaling: raw values of a card to values with a unit.
//!
//! A channel lists scales by number; each takes its input from another one or from the raw values, and the last gives
//! the result. Linear scales are applied; a channel with another kind is refused by its name. As in npTDMS 1.13 scales
//! are those of the first of channel, group and file that has any, the highest number is the last where their number is
//! not stated, and they are applied unless the values are said to be scaled.

use std::collections::BTreeMap;

use crate::Result;
use crate::formats::tdms::segments::Cursor;
use crate::time::Instant;

#[derive(Debug, Clone, PartialEq)]
pub enum Property {
    Text(String),
    /// A number or a truth value (0, 1).
    Number(f64),
    /// A time since 1904-01-01 UTC.
    Time(Instant),
    Other,
}

pub type Properties = BTreeMap<String, Property>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// Signed integer of so many bytes.
    Int(usize),
    /// Unsigned integer of so many bytes; a truth value is one of one byte.
    Unsigned(usize),
    /// IEEE number of 4 bytes.
    Single,
    /// IEEE number of 8 bytes.
    Double,
    /// 16 bytes of time: fraction of a second, seconds since 1904.
    Time,
    Text,
    /// Known and not a real number: what it is, and its bytes.
    Unread(&'static str, usize),
}

impl Type {
    fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            1..=4 => Self::Int(1 << (code - 1)),
            5..=8 => Self::Unsigned(1 << (code - 5)),
            9 | 0x19 => Self::Single,
            0xA | 0x1A => Self::Double,
            0xB | 0x1B => Self::Unread("extended-precision numbers", 16),
            0x20 => Self::Text,
            0x21 => Self::Unsigned(1),
            0x44 => Self::Time,
            0x0008_000C => Self::Unread("complex numbers", 8),
            0x0010_000D => Self::Unread("complex numbers", 16),
            _ => return None,
        })
    }

    /// Type codes of DAQmx scalers are numbered differently.
    fn from_daqmx_code(code: u32) -> Option<Self> {
        (code < 6)
            .then(|| if code.is_multiple_of(2) { Self::Unsigned(1 << (code / 2)) } else { Self::Int(1 << (code / 2)) })
    }

    /// Bytes of one sample; texts have no fixed size.
    pub fn size(self) -> usize {
        match self {
            Self::Int(size) | Self::Unsigned(size) | Self::Unread(_, size) => size,
            Self::Single => 4,
            Self::Double => 8,
            Self::Time => 16,
            Self::Text => 0,
        }
    }
}

/// How the samples of one object lie in each chunk of raw data.
#[derive(Debug, Clone, PartialEq)]
pub enum RawIndex {
    /// `count` samples of a type, `bytes` bytes in all.
    Plain {
        kind: Type,
        count: u64,
        /// What they take.
        bytes: u64,
    },
    /// Raw values of a data-acquisition card: `count` rows of `widths[buffer]` bytes, the sample at an offset in each.
    Daqmx {
        count: u64,
        /// Where the sample stands in its row; `None` with the reason if it is no plain number.
        scaler: Result<Scaler, &'static str>,
        /// Bytes of a row in each buffer.
        widths: Vec<u32>,
    },
}

impl RawIndex {
    /// A chunk has nothing of it.
    pub fn is_empty(&self) -> bool {
        self.count() == 0 || matches!(self, Self::Plain { bytes: 0, .. })
    }

    pub fn count(&self) -> u64 {
        match self {
            Self::Plain { count, .. } | Self::Daqmx { count, .. } => *count,
        }
    }
}

/// Place of a DAQmx sample in a row of its buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Scaler {
    pub kind: Type,
    pub buffer: usize,
    /// Offset in the row, bytes.
    pub offset: usize,
}

/// What the entry of an object says of raw data in this segment.
#[derive(Debug, Clone, PartialEq)]
pub enum SegmentData {
    None,
    /// As in the last segment that described it.
    AsBefore,
    New(RawIndex),
}

/// An object's entry in the metadata of a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// `/'group'/'channel'`.
    pub path: String,
    pub raw: SegmentData,
    /// New or changed properties.
    pub properties: Vec<(String, Property)>,
}

pub fn entry(cursor: &mut Cursor) -> Result<Entry> {
    let path = cursor.text()?;
    let raw = raw(cursor)?;
    let count = cursor.u32()?;
    let mut properties = Vec::new();
    for _ in 0..count {
        let name = cursor.text()?;
        properties.push((name, property(cursor)?));
    }
    Ok(Entry { path, raw, properties })
}

fn raw(cursor: &mut Cursor) -> Result<SegmentData> {
    let at = cursor.at;
    match cursor.u32()? {
        0xFFFF_FFFF => Ok(SegmentData::None),
        0 => Ok(SegmentData::AsBefore),
        0x1269 => daqmx(cursor, false).map(SegmentData::New),
        // NI writes the second; the first is met in files, too.
        0x126A | 0x1369 => daqmx(cursor, true).map(SegmentData::New),
        20 | 28 => {
            let type_at = cursor.at;
            let code = cursor.u32()?;
            let Some(kind) = Type::from_code(code) else {
                return cursor.broken(type_at, format!("samples of an unknown type, code {code:#x}"));
            };
            dimension(cursor)?;
            let count = cursor.u64()?;
            let bytes = if kind == Type::Text {
                Some(cursor.u64()?)
            } else {
                u64::try_from(kind.size()).ok().and_then(|size| size.checked_mul(count))
            };
            match bytes {
                Some(bytes) => Ok(SegmentData::New(RawIndex::Plain { kind, count, bytes })),
                None => cursor.broken(type_at, format!("an impossible count of samples, {count}")),
            }
        }
        other => cursor.broken(at, format!("a description of raw data of unknown length {other:#x}")),
    }
}

fn dimension(cursor: &mut Cursor) -> Result<()> {
    let at = cursor.at;
    match cursor.u32()? {
        1 => Ok(()),
        other => cursor.broken(at, format!("an array of {other} dimensions, 1 is the only valid one")),
    }
}

fn daqmx(cursor: &mut Cursor, digital: bool) -> Result<RawIndex> {
    cursor.u32()?;
    dimension(cursor)?;
    let count = cursor.u64()?;
    let scalers = cursor.u32()?;
    let mut scaler = Err("no DAQmx scaler is listed");
    for k in 0..scalers {
        let code = cursor.u32()?;
        let (buffer, offset) = (cursor.u32()? as usize, cursor.u32()? as usize);
        if digital {
            cursor.u8()?;
        } else {
            cursor.u32()?;
        }
        cursor.u32()?;
        scaler = match (digital, k, Type::from_daqmx_code(code)) {
            (true, ..) => Err("digital lines of DAQmx are not read"),
            (_, 0, Some(kind)) => Ok(Scaler { kind, buffer, offset }),
            (_, 0, None) => Err("raw DAQmx samples of an unknown type"),
            _ => Err("several DAQmx scalers for one channel are not read"),
        };
    }
    let mut widths = Vec::new();
    for _ in 0..cursor.u32()? {
        widths.push(cursor.u32()?);
    }
    Ok(RawIndex::Daqmx { count, scaler, widths })
}

fn property(cursor: &mut Cursor) -> Result<Property> {
    let at = cursor.at;
    let code = cursor.u32()?;
    let number = Property::Number;
    Ok(match code {
        0 => Property::Other,
        1 => number(f64::from(cursor.u8()?.cast_signed())),
        2 => number(f64::from(cursor.u16()?.cast_signed())),
        3 => number(f64::from(cursor.u32()?.cast_signed())),
        4 => number(cursor.u64()?.cast_signed() as f64),
        5 | 0x21 => number(f64::from(cursor.u8()?)),
        6 => number(f64::from(cursor.u16()?)),
        7 => number(f64::from(cursor.u32()?)),
        8 => number(cursor.u64()? as f64),
        9 | 0x19 => number(f64::from(f32::from_bits(cursor.u32()?))),
        0xA | 0x1A => number(f64::from_bits(cursor.u64()?)),
        0x20 => Property::Text(cursor.text()?),
        0x44 => {
            let (fraction_s, seconds) = time(cursor)?;
            Property::Time(Instant { seconds, fraction_s })
        }
        0xB | 0x1B | 0x0010_000D => {
            cursor.take(16)?;
            Property::Other
        }
        0x0008_000C => {
            cursor.take(8)?;
            Property::Other
        }
        other => return cursor.broken(at, format!("a property of an unknown type, code {other:#x}")),
    })
}

/// Fraction of a second, and whole seconds since 1904-01-01 UTC. The whole 16 bytes change their order with the byte
/// order.
pub fn time(cursor: &mut Cursor) -> Result<(f64, i64)> {
    const PER_S: f64 = 18_446_744_073_709_551_616.0;
    let big_endian = cursor.big_endian;
    let (first, second) = (cursor.u64()?, cursor.u64()?);
    let (fraction, seconds) = if big_endian { (second, first) } else { (first, second) };
    Ok((fraction as f64 / PER_S, seconds.cast_signed()))
}

/// The names in a path: none for the root, one for a group, two for a channel. `''` stands for a quote.
pub fn names(path: &str) -> Option<Vec<String>> {
    let mut names = Vec::new();
    let mut rest = path.strip_prefix('/')?;
    while !rest.is_empty() {
        rest = rest.strip_prefix('\'')?;
        let mut name = String::new();
        loop {
            let quote = rest.find('\'')?;
            name.push_str(&rest[..quote]);
            rest = &rest[quote + 1..];
            match rest.strip_prefix('\'') {
                Some(after) => {
                    name.push('\'');
                    rest = after;
                }
                None => break,
            }
        }
        names.push(name);
        match rest.strip_prefix('/') {
            Some(after) if !after.is_empty() => rest = after,
            None if rest.is_empty() => {}
            _ => return None,
        }
    }
    Some(names)
}

/// Slope and intercept.
pub type Linear = (f64, f64);

/// How many scales a level lists.
fn number_of_scales(properties: &Properties) -> Option<f64> {
    let listed = |name: &String| name.strip_prefix("NI_Scale[")?.strip_suffix("]_Scale_Type")?.parse::<u32>().ok();
    let count = match properties.get("NI_Number_Of_Scales") {
        Some(Property::Number(count)) => Some(*count),
        _ => properties.keys().filter_map(listed).max().map(|last| f64::from(last) + 1.0),
    };
    count.filter(|n| *n >= 1.0)
}

/// The scales to apply, in order; none if the values are final. `layers`: properties of the channel, its group, the
/// file.
pub fn chain(layers: &[&Properties], is_daqmx: bool) -> Result<Vec<Linear>, String> {
    let find = |name: &str| layers.iter().find_map(|layer| layer.get(name));
    let number = |name: &str| match find(name) {
        Some(Property::Number(x)) => Some(*x),
        _ => None,
    };
    let status = match find("NI_Scaling_Status") {
        Some(Property::Text(status)) => status.as_str(),
        _ => "",
    };
    let count = layers.iter().find_map(|layer| number_of_scales(layer)).filter(|_| status != "scaled");
    let mut scales = Vec::new();
    let mut scale = count.map_or(f64::from(u32::MAX), |count| count - 1.0);
    // A scale without a kind, and the number 2^32 - 1, are the raw values.
    while let Some(Property::Text(kind)) = find(&format!("NI_Scale[{scale}]_Scale_Type")) {
        let part = |part: &str| {
            let name = format!("NI_Scale[{scale}]_{kind}_{part}");
            number(&name).filter(|x| x.is_finite()).ok_or_else(|| format!("its property {name} is not a number"))
        };
        match kind.as_str() {
            "Linear" => scales.push((part("Slope")?, part("Y_Intercept")?)),
            // Stands for settings of the card; the values pass.
            "AdvancedAPI" => scales.push((1.0, 0.0)),
            _ => return Err(format!("its scale {scale} is of kind {kind}, only Linear is applied")),
        }
        if scales.len() > 64 {
            return Err("its scales refer to each other in a circle".to_owned());
        }
        scale = part("Input_Source").unwrap_or(f64::from(u32::MAX));
    }
    if scales.is_empty() && !is_daqmx && (count.is_some() || status == "unscaled") {
        return Err(
            "its values are raw (unscaled), and the scale that would make them numbers with a unit is not stated"
                .to_owned(),
        );
    }
    scales.reverse();
    Ok(scales)
}

/// `count` samples, each at the start of `stride` bytes; the last may end where `raw` ends.
#[derive(Debug, Clone, Copy)]
pub struct Strided<'a> {
    /// The bytes, from the first sample on.
    pub raw: &'a [u8],
    /// Bytes from one sample to the next.
    pub stride: usize,
    pub count: usize,
}

impl Strided<'_> {
    fn each<const N: usize>(self, big_endian: bool, out: &mut Vec<f64>, value: impl Fn([u8; N]) -> f64) {
        // A count is never believed further than the bytes go.
        out.reserve(self.count.min(self.raw.len()));
        let decode = |sample: &[u8]| {
            let mut array = [0; N];
            array.copy_from_slice(&sample[..N]);
            if big_endian {
                array.reverse();
            }
            value(array)
        };
        if self.stride == N {
            out.extend(self.raw.chunks_exact(N).take(self.count).map(decode));
        } else {
            out.extend(self.raw.chunks(self.stride).filter(|s| s.len() >= N).take(self.count).map(decode));
        }
    }
}

/// Numbers, added to `out`. Integers beyond 2^53 are rounded.
pub fn numbers(raw: Strided, kind: Type, big_endian: bool, out: &mut Vec<f64>) {
    match kind {
        Type::Int(1) => raw.each(big_endian, out, |b| f64::from(i8::from_le_bytes(b))),
        Type::Int(2) => raw.each(big_endian, out, |b| f64::from(i16::from_le_bytes(b))),
        Type::Int(4) => raw.each(big_endian, out, |b| f64::from(i32::from_le_bytes(b))),
        Type::Int(_) => raw.each(big_endian, out, |b| i64::from_le_bytes(b) as f64),
        Type::Unsigned(1) => raw.each(big_endian, out, |b| f64::from(u8::from_le_bytes(b))),
        Type::Unsigned(2) => raw.each(big_endian, out, |b| f64::from(u16::from_le_bytes(b))),
        Type::Unsigned(4) => raw.each(big_endian, out, |b| f64::from(u32::from_le_bytes(b))),
        Type::Unsigned(_) => raw.each(big_endian, out, |b| u64::from_le_bytes(b) as f64),
        Type::Single => raw.each(big_endian, out, |b| f64::from(f32::from_le_bytes(b))),
        Type::Double => raw.each(big_endian, out, f64::from_le_bytes),
        Type::Time | Type::Text | Type::Unread(..) => {}
    }
}

/// Times in seconds since `first`, the first one of all, so that nanoseconds are kept.
pub fn times(raw: Strided, big_endian: bool, first: &mut Option<Instant>, out: &mut Vec<f64>) {
    out.reserve(raw.count.min(raw.raw.len()));
    for sample in raw.raw.chunks(raw.stride).take(raw.count) {
        let Ok((fraction_s, seconds)) = time(&mut Cursor::new("", sample, 0, big_endian)) else { continue };
        let instant = Instant { seconds, fraction_s };
        out.push(instant.since(*first.get_or_insert(instant)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_hold_any_sign() {
        let split = |path: &str| names(path);
        assert_eq!(split("/"), Some(vec![]));
        assert_eq!(split("/'a'"), Some(vec!["a".to_owned()]));
        assert_eq!(split("/'a/b'/'DeltaV (m\\s)'"), Some(vec!["a/b".to_owned(), "DeltaV (m\\s)".to_owned()]));
        assert_eq!(split("/'it''s'/''''"), Some(vec!["it's".to_owned(), "'".to_owned()]));
        for broken in ["", "a", "/a", "/'a", "/'a'/", "/'a'b"] {
            assert_eq!(split(broken), None, "{broken}");
        }
    }

    #[test]
    fn codes_are_types() {
        assert_eq!(Type::from_code(3), Some(Type::Int(4)));
        assert_eq!(Type::from_code(6), Some(Type::Unsigned(2)));
        assert_eq!(Type::from_daqmx_code(3), Some(Type::Int(2)));
        assert_eq!(Type::from_daqmx_code(4), Some(Type::Unsigned(4)));
        assert_eq!((Type::from_code(0x99), Type::from_daqmx_code(6)), (None, None));
    }

    fn properties(list: &[(&str, Property)]) -> Properties {
        list.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
    }

    fn text(text: &str) -> Property {
        Property::Text(text.to_owned())
    }

    #[test]
    fn scales_are_followed_to_the_raw_values() {
        use Property::Number;
        let mut all = properties(&[
            ("NI_Number_Of_Scales", Number(3.0)),
            ("NI_Scaling_Status", text("unscaled")),
            ("NI_Scale[1]_Scale_Type", text("Linear")),
            ("NI_Scale[1]_Linear_Slope", Number(2.0)),
            ("NI_Scale[1]_Linear_Y_Intercept", Number(1.0)),
            ("NI_Scale[1]_Linear_Input_Source", Number(0.0)),
            ("NI_Scale[2]_Scale_Type", text("Linear")),
            ("NI_Scale[2]_Linear_Slope", Number(10.0)),
            ("NI_Scale[2]_Linear_Y_Intercept", Number(0.0)),
            ("NI_Scale[2]_Linear_Input_Source", Number(1.0)),
        ]);
        let both = vec![(2.0, 1.0), (10.0, 0.0)];
        assert_eq!(chain(&[&all], false), Ok(both.clone()));
        assert_eq!(chain(&[&Properties::new(), &all], true), Ok(both));
        all.insert("NI_Scale[1]_Linear_Input_Source".to_owned(), Number(2.0));
        assert!(chain(&[&all], false).unwrap_err().contains("circle"));
        all.insert("NI_Scale[1]_Scale_Type".to_owned(), text("Thermocouple"));
        assert!(chain(&[&all], false).unwrap_err().contains("kind Thermocouple"));
        all.insert("NI_Scaling_Status".to_owned(), text("scaled"));
        assert_eq!(chain(&[&all], false), Ok(vec![]));
    }
}
