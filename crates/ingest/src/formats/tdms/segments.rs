//! The segments of a file, one after the other: metadata, then raw data in chunks.
//!
//! A segment without a list of objects of its own has that of the segment before it, in the same order. A recording
//! that was aborted has a last segment without a length, or one that runs past the end of the file: it is read as far
//! as it goes.
//!
//! A segment may state step, start, unit or scale of a channel in another way than earlier ones. It goes on where only
//! the start is another and the earlier samples end there; else the channel holds several records and is refused.

use std::collections::BTreeMap;

use crate::formats::remarks::CutShort;
use crate::formats::tdms::metadata::{self, Properties, Property, RawIndex, SegmentData, Type, entry};
use crate::time::Instant;
use crate::{Refusal, Result, refuse, refuse_size};

const OBJECT_LIMIT: usize = 100_000;
/// Most samples in a file, all channels together: 2 GiB in memory.
pub const SAMPLE_LIMIT: u64 = 1 << 28;
/// What is found and expected where there are more.
pub const MANY_SAMPLES: (&str, &str) =
    ("more than 268 million samples", "at most 268435456 samples in all channels together");
/// Most objects looked at in all segments together. A segment costs its number of objects, so that a small file could
/// keep a reader busy for days.
const WORK_LIMIT: u64 = 1 << 30;

const METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;

/// An object of the file: the file itself, a group or a channel.
#[derive(Debug, Clone, Default)]
pub struct Object {
    /// `/'group'/'channel'`.
    pub path: String,
    /// Its properties, the latest of each name.
    pub properties: Properties,
    /// How its samples lie in a chunk, as last described.
    index: Option<RawIndex>,
    /// Its samples, not scaled.
    pub values: Vec<f64>,
    /// Samples are raw values of a card.
    pub is_daqmx: bool,
    /// Samples are times; they count from this one, since 1904.
    pub first_stamp: Option<Instant>,
    /// Why samples that the file has are not among the values.
    pub unread: Option<&'static str>,
    /// Properties that later segments state in another way, and no samples were read under yet.
    changed: Properties,
    /// What later samples state in another way, where they do not go on where the earlier ones end.
    pub parts: Option<String>,
}

/// What samples are read by. The latest of all other properties counts.
const READ_BY: [&str; 7] = [
    "NI_Number_Of_Scales",
    "NI_UnitDescription",
    "unit_string",
    "wf_increment",
    "wf_start_offset",
    "wf_start_time",
    "wf_xunit_string",
];

impl Object {
    /// Takes the properties of a segment. What earlier samples are read by stays, and the new value waits for samples.
    fn update(&mut self, properties: Vec<(String, Property)>) {
        for (name, value) in properties {
            let is_read_by = READ_BY.contains(&name.as_str()) || name.starts_with("NI_Scal");
            let before = self.properties.get(&name).filter(|before| is_read_by && says(&name, before));
            match before {
                Some(before) if !self.values.is_empty() => {
                    if value == *before {
                        self.changed.remove(&name);
                    } else if says(&name, &value) {
                        self.changed.insert(name, value);
                    }
                }
                _ => drop(self.properties.insert(name, value)),
            }
        }
    }

    /// Further samples under changed properties are of the same record if only their start is another, and that is
    /// where the earlier ones end.
    fn go_on(&mut self) {
        let changed = std::mem::take(&mut self.changed);
        let number = |properties: &Properties, name: &str| match properties.get(name) {
            Some(Property::Number(x)) => Some(*x),
            _ => None,
        };
        let offset = number(&self.properties, "wf_start_offset").unwrap_or(0.0);
        let by_offset = number(&changed, "wf_start_offset").map_or(0.0, |later| later - offset);
        let by_clock = match (self.properties.get("wf_start_time"), changed.get("wf_start_time")) {
            (Some(Property::Time(first)), Some(Property::Time(later))) => later.since(*first),
            _ => 0.0,
        };
        let is_start = |name: &String| matches!(name.as_str(), "wf_start_offset" | "wf_start_time");
        let goes_on = number(&self.properties, "wf_increment").is_some_and(|dt| {
            let end = dt * self.values.len() as f64;
            changed.keys().all(is_start) && (by_offset + by_clock - end).abs() <= 0.5 * dt
        });
        if !goes_on && self.parts.is_none() {
            let differs = |(name, later): (&String, &Property)| {
                format!("{name} is {}, then {}", shown(self.properties.get(name)), shown(Some(later)))
            };
            let differ: Vec<String> = changed.iter().take(4).map(differs).collect();
            let apart = if by_clock == 0.0 { String::new() } else { format!(" ({by_clock} s later)") };
            let at = self.values.len();
            self.parts = Some(format!("it holds several records: at sample {at} {}{apart}", differ.join("; ")));
        }
    }
}

/// Whether a property states something: an increment of 0, the year 1904 and no letters do not.
fn says(name: &str, value: &Property) -> bool {
    match value {
        Property::Number(x) => name != "wf_increment" || *x > 0.0,
        Property::Text(text) => !text.trim().is_empty(),
        Property::Time(time) => is_date(*time),
        Property::Other => false,
    }
}

/// Years before 1910 stand for no date.
pub fn is_date(time: Instant) -> bool {
    time.seconds > 200_000_000
}

/// A property in words; of a date the time of the day.
fn shown(property: Option<&Property>) -> String {
    match property {
        Some(Property::Number(x)) => x.to_string(),
        Some(Property::Text(text)) => text.chars().take(40).collect(),
        Some(Property::Time(time)) => {
            let s = time.seconds.rem_euclid(86_400);
            format!("{:02}:{:02}:{:06.3} UTC", s / 3600, s / 60 % 60, (s % 60) as f64 + time.fraction_s)
        }
        Some(Property::Other) | None => "something else".to_owned(),
    }
}

/// Objects in the order in which they first appear, and remarks.
#[derive(Debug, Clone, Default)]
pub struct Content {
    pub objects: Vec<Object>,
    /// Oddities that did not stop the reading.
    pub warnings: Vec<CutShort>,
}

/// State between segments.
#[derive(Default)]
struct Walk<'a> {
    file: &'a str,
    content: Content,
    by_path: BTreeMap<String, usize>,
    /// Objects of the current list, and whether they have raw data.
    list: Vec<(usize, bool)>,
    /// Place of an object in the list.
    place: BTreeMap<usize, usize>,
    samples: u64,
    work: u64,
}

/// All segments of a file, which is named in messages.
pub fn read(file: &str, bytes: &[u8]) -> Result<Content> {
    let mut walk = Walk { file, ..Walk::default() };
    let mut at = 0;
    while at < bytes.len() {
        let left = bytes.len() - at;
        if left < 28 && at > 0 {
            walk.content.warnings.push(CutShort { left_bytes: Some(left), ..CutShort::SOMEWHERE });
            break;
        }
        at = walk.segment(bytes, at)?;
    }
    for object in &mut walk.content.objects {
        object.properties.append(&mut object.changed);
    }
    Ok(walk.content)
}

impl Walk<'_> {
    /// Reads the segment at `at` and says where the next one is.
    fn segment(&mut self, bytes: &[u8], at: usize) -> Result<usize> {
        let mut cursor = Cursor::new(self.file, bytes, at, false);
        let mark = cursor.take(4)?;
        if mark != b"TDSm" {
            return broken(self.file, at, "no segment starts here (no TDSm)");
        }
        let toc = cursor.u32()?;
        let big_endian = toc & BIG_ENDIAN != 0;
        let mut cursor = Cursor::new(self.file, bytes, cursor.at, big_endian);
        let version = cursor.u32()?;
        if !matches!(version, 4712 | 4713) {
            return broken(self.file, at + 8, format!("version {version} of TDMS, 4712 and 4713 are known"));
        }
        let (length, raw_offset) = (cursor.u64()?, cursor.u64()?);
        let body = cursor.at;
        let end = usize::try_from(length).ok().and_then(|length| body.checked_add(length));
        let whole = end.filter(|end| length != u64::MAX && *end <= bytes.len());
        let end = whole.unwrap_or(bytes.len());
        if whole.is_none() {
            let stated_bytes = (length != u64::MAX).then_some(length);
            let cut = CutShort { segment_at_byte: Some(at), stated_bytes, ..CutShort::SOMEWHERE };
            self.content.warnings.push(cut);
        }
        let mut metadata_end = body;
        if toc & METADATA != 0 {
            let mut metadata = Cursor::new(self.file, &bytes[..end], body, big_endian);
            match self.metadata(&mut metadata, toc & NEW_LIST != 0) {
                Ok(()) => metadata_end = metadata.at,
                // The first segment must say something at least.
                Err(error) if error.refusal == Refusal::Content && whole.is_none() && at > 0 => return Ok(bytes.len()),
                Err(error) => return Err(error),
            }
        }
        if toc & RAW_DATA != 0 {
            let stated = usize::try_from(raw_offset).ok().and_then(|offset| body.checked_add(offset));
            let start = match stated.filter(|start| *start <= end) {
                Some(start) => start,
                None if whole.is_none() => metadata_end,
                None => {
                    return broken(self.file, at + 20, format!("raw data from byte {raw_offset} of a shorter segment"));
                }
            };
            self.raw_data(&bytes[start..end], start, toc & INTERLEAVED != 0, big_endian)?;
        }
        Ok(end)
    }

    fn metadata(&mut self, cursor: &mut Cursor, new_list: bool) -> Result<()> {
        if new_list {
            self.list.clear();
            self.place.clear();
        }
        for _ in 0..cursor.u32()? {
            let at = cursor.at;
            let entry = entry(cursor)?;
            let index = match self.by_path.get(&entry.path) {
                Some(index) => *index,
                None => {
                    let index = self.content.objects.len();
                    if index == OBJECT_LIMIT {
                        let limit = format!("at most {OBJECT_LIMIT} groups and channels");
                        return refuse_size(self.file, format!("more than {OBJECT_LIMIT} objects"), limit);
                    }
                    self.content.objects.push(Object { path: entry.path.clone(), ..Object::default() });
                    self.by_path.insert(entry.path, index);
                    index
                }
            };
            let object = &mut self.content.objects[index];
            object.update(entry.properties);
            let has_data = match entry.raw {
                SegmentData::None => false,
                SegmentData::AsBefore if object.index.is_none() => {
                    return broken(self.file, at, format!("raw data of {} as before, but there was none", object.path));
                }
                SegmentData::AsBefore => true,
                SegmentData::New(index) => {
                    object.index = Some(index);
                    true
                }
            };
            if let Some(place) = self.place.get(&index) {
                self.list[*place].1 = has_data;
            } else {
                self.place.insert(index, self.list.len());
                self.list.push((index, has_data));
            }
        }
        Ok(())
    }

    fn raw_data(&mut self, raw: &[u8], start: usize, interleaved: bool, big_endian: bool) -> Result<()> {
        self.work(self.list.len())?;
        let objects = &self.content.objects;
        let active: Vec<(usize, RawIndex)> = self
            .list
            .iter()
            .filter(|(_, has_data)| *has_data)
            .filter_map(|(k, _)| Some((*k, objects[*k].index.as_ref().filter(|index| !index.is_empty())?.clone())))
            .collect();
        let buffers = |index: &RawIndex| if let RawIndex::Daqmx { widths, .. } = index { widths.len() } else { 0 };
        self.work(active.iter().map(|(_, index)| buffers(index)).sum())?;
        if raw.is_empty() || active.is_empty() {
            return Ok(());
        }
        let rest = if active.iter().any(|(_, index)| matches!(index, RawIndex::Daqmx { .. })) {
            self.daqmx(&active, raw, start, big_endian)?
        } else if interleaved {
            self.interleaved(&active, raw, start, big_endian)?
        } else {
            self.contiguous(&active, raw, big_endian)?
        };
        if rest {
            self.content.warnings.push(CutShort { data_at_byte: Some(start), ..CutShort::SOMEWHERE });
        }
        Ok(())
    }

    /// Takes note of `steps` that are not paid for by bytes of the file.
    fn work(&mut self, steps: usize) -> Result<()> {
        self.work = self.work.saturating_add(steps as u64 + 1);
        if self.work <= WORK_LIMIT {
            return Ok(());
        }
        refuse_size(self.file, "very many segments with very many channels", "files as a recorder writes them")
    }

    /// Takes note of `count` more samples, before there is memory for them.
    fn count(&mut self, count: u64) -> Result<()> {
        self.samples = self.samples.saturating_add(count);
        if self.samples <= SAMPLE_LIMIT {
            return Ok(());
        }
        refuse_size(self.file, MANY_SAMPLES.0, MANY_SAMPLES.1)
    }

    fn push(&mut self, object: usize, kind: Type, big_endian: bool, raw: metadata::Strided) -> Result<()> {
        if let Type::Unread(what, _) = kind {
            self.content.objects[object].unread = Some(what);
            return Ok(());
        }
        self.count(raw.count as u64)?;
        let object = &mut self.content.objects[object];
        if raw.count > 0 && !object.changed.is_empty() {
            object.go_on();
        }
        if kind == Type::Time {
            metadata::times(raw, big_endian, &mut object.first_stamp, &mut object.values);
        } else {
            metadata::numbers(raw, kind, big_endian, &mut object.values);
        }
        Ok(())
    }

    /// Chunks of all samples of one channel, then of the next. True if the last chunk is not whole.
    fn contiguous(&mut self, active: &[(usize, RawIndex)], raw: &[u8], big_endian: bool) -> Result<bool> {
        let mut rest = raw;
        loop {
            let before = rest.len();
            for (object, index) in active {
                let RawIndex::Plain { kind, bytes, .. } = index else { continue };
                let wanted = usize::try_from(*bytes).unwrap_or(usize::MAX);
                let (mine, after) = rest.split_at(wanted.min(rest.len()));
                rest = after;
                if *kind == Type::Text {
                    self.content.objects[*object].unread = Some("texts");
                } else {
                    let strided = metadata::Strided { raw: mine, stride: kind.size(), count: mine.len() / kind.size() };
                    self.push(*object, *kind, big_endian, strided)?;
                }
                if mine.len() < wanted {
                    return Ok(true);
                }
            }
            // Texts of no bytes alone would go on for ever.
            if rest.is_empty() || rest.len() == before {
                return Ok(!rest.is_empty());
            }
        }
    }

    /// Rows of one sample of each channel. True if the last row is not whole.
    fn interleaved(
        &mut self,
        active: &[(usize, RawIndex)],
        raw: &[u8],
        start: usize,
        big_endian: bool,
    ) -> Result<bool> {
        let mut stride = 0;
        for (object, index) in active {
            let RawIndex::Plain { kind, count, .. } = index else { continue };
            if *kind == Type::Text || *count != active[0].1.count() {
                let path = &self.content.objects[*object].path;
                let found = format!("interleaved channels must have equal counts and numbers only, {path} has not");
                return broken(self.file, start, found);
            }
            stride += kind.size();
        }
        let rows = raw.len() / stride;
        let mut offset = 0;
        for (object, index) in active {
            let RawIndex::Plain { kind, .. } = index else { continue };
            let strided = metadata::Strided { raw: raw.get(offset..).unwrap_or_default(), stride, count: rows };
            self.push(*object, *kind, big_endian, strided)?;
            offset += kind.size();
        }
        Ok(rows * stride < raw.len())
    }

    /// Rows of a card's buffers, one buffer after the other in each chunk. True if the last chunk is not whole.
    fn daqmx(&mut self, active: &[(usize, RawIndex)], raw: &[u8], start: usize, big_endian: bool) -> Result<bool> {
        let mixed = "DAQmx channels that do not share their buffers and counts, or with others";
        let RawIndex::Daqmx { count: rows, widths, .. } = &active[0].1 else { return broken(self.file, start, mixed) };
        let alike = |index: &RawIndex| match index {
            RawIndex::Daqmx { count, widths: others, .. } => count == rows && others == widths,
            RawIndex::Plain { .. } => false,
        };
        if !active.iter().all(|(_, index)| alike(index)) {
            return broken(self.file, start, mixed);
        }
        let widths: Vec<usize> = widths.iter().map(|w| *w as usize).collect();
        if widths.contains(&0) || widths.is_empty() {
            return broken(self.file, start, "a DAQmx buffer of no width");
        }
        let rows = usize::try_from(*rows).unwrap_or(usize::MAX);
        let mut rest = raw;
        let mut whole = true;
        while !rest.is_empty() && whole {
            for (buffer, width) in widths.iter().enumerate() {
                let here = rows.min(rest.len() / width);
                whole &= here == rows;
                let (mine, after) = rest.split_at(here * width);
                rest = after;
                self.work(active.len())?;
                for (object, index) in active {
                    let RawIndex::Daqmx { scaler, .. } = index else { continue };
                    self.content.objects[*object].is_daqmx = true;
                    match scaler {
                        Err(reason) => self.content.objects[*object].unread = Some(reason),
                        Ok(scaler) if scaler.buffer >= widths.len() => {
                            self.content.objects[*object].unread = Some("a DAQmx buffer that is not there");
                        }
                        Ok(scaler) if scaler.buffer == buffer => {
                            if scaler.offset.checked_add(scaler.kind.size()).is_none_or(|end| end > *width) {
                                return broken(self.file, start, "a DAQmx sample outside its row");
                            }
                            let raw = mine.get(scaler.offset..).unwrap_or_default();
                            let strided = metadata::Strided { raw, stride: *width, count: here };
                            self.push(*object, scaler.kind, big_endian, strided)?;
                        }
                        Ok(_) => {}
                    }
                }
            }
        }
        Ok(!whole)
    }
}

/// The refusal of what was read from byte `at` on.
pub fn broken<T>(file: &str, at: usize, found: impl std::fmt::Display) -> Result<T> {
    let hint = "the file may be cut short or damaged: copy or download it again";
    refuse(file, format!("at byte {at}: {found}"), "a TDMS file as LabVIEW or DIAdem writes it", hint)
}

/// A reading position in bytes.
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    file: &'a str,
    bytes: &'a [u8],
    /// Offset of the next byte.
    pub at: usize,
    /// Whether numbers are read with the high byte first.
    pub big_endian: bool,
}

impl<'a> Cursor<'a> {
    /// Starts at offset `at`, which may lie past the end.
    pub fn new(file: &'a str, bytes: &'a [u8], at: usize, big_endian: bool) -> Self {
        Self { file, bytes, at, big_endian }
    }

    /// The error of something read from offset `at`.
    pub fn broken<T>(&self, at: usize, found: impl std::fmt::Display) -> Result<T> {
        broken(self.file, at, found)
    }

    /// The next `length` bytes.
    pub fn take(&mut self, length: usize) -> Result<&'a [u8]> {
        let end = self.at.checked_add(length).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else {
            let left = self.bytes.len().saturating_sub(self.at);
            return self.broken(self.at, format!("{length} bytes should follow, {left} are left"));
        };
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        if self.big_endian {
            array.reverse();
        }
        Ok(array)
    }

    pub fn u8(&mut self) -> Result<u8> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u16(&mut self) -> Result<u16> {
        Ok(u16::from_le_bytes(self.array()?))
    }

    pub fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    /// A length in four bytes and as many bytes of UTF-8; what is none is replaced.
    pub fn text(&mut self) -> Result<String> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_and_the_end() {
        let bytes = [1, 0, 0, 0, 2, 0, 0, 0, b'a', b'b'];
        let cursor = |at, big_endian| Cursor::new("t.tdms", &bytes, at, big_endian);
        assert_eq!((cursor(0, false).u32(), cursor(0, true).u32()), (Ok(1), Ok(1 << 24)));
        assert_eq!(cursor(4, false).text().as_deref(), Ok("ab"));
        let error = cursor(8, false).u32().unwrap_err();
        assert_eq!(error.to_string(), "t.tdms: at byte 8: 4 bytes should follow, 2 are left");
        assert!(cursor(99, false).u8().is_err());
        assert!(Cursor::new("t.tdms", &[255, 255, 255, 255, 0], 0, false).text().is_err());
    }
}
