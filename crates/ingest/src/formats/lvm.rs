//! LVM, the text files of LabVIEW's "Write to Measurement File": a header, then segments of columns.

use std::collections::BTreeMap;

use crumple_signal::{About, Notes, Weight, remarks};

use crate::formats::reader::{Bundle, Reader};
use crate::formats::remarks::{SampleCount, TimesFromFirst};
use crate::formats::text::lines::{self, Lines, decode, without_mark};
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::recording::content::Recording;
use crate::recording::details::{Details, Stated};
use crate::time::{Instant, time_of_day};
use crate::{GAPS_ARE_NOT_FILLED, IngestSettings, Result, refuse, time};

/// Difference of clocks that counts as the same, s.
const CLOCK_SLACK_S: f64 = 1e-3;

pub const LVM: Reader = Reader::of_one_file("lvm", recognises, conversion::FLAGS, read);

fn recognises(head: &[u8]) -> bool {
    without_mark(head).trim_ascii_start().starts_with(b"LabVIEW Measurement")
}

/// A segment: its header and samples by channel.
struct Segment {
    header: SegmentHeader,
    decimal: u8,
    values: Vec<Vec<f64>>,
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, text) = (bundle.main.name.as_str(), without_mark(&bundle.main.bytes));
    let start = text.iter().take_while(|b| b.is_ascii_whitespace()).count();
    let mut lines = Lines::new(file, &text);
    // Blank lines before the header are no part of it.
    for _ in 0..text[..start].iter().filter(|b| **b == b'\n').count() {
        lines.take()?;
    }
    let file_header = file_header(&mut lines)?;
    let mut notes = Notes::new();
    let mut segments: Vec<Segment> = Vec::new();
    while let Some(header) = segment_header(&mut lines, &file_header)? {
        let decimal = file_header.decimal.unwrap_or_else(|| header.decimal());
        let values = rows_of(&mut lines, &file_header, &header, decimal)?;
        let segment = Segment { header, decimal, values };
        segment.check_counts(segments.len() + 1, &mut notes);
        match segments.last_mut() {
            Some(last) if last.continues(&segment) => last.append(segment),
            _ => segments.push(segment),
        }
    }
    if segments.is_empty() {
        return refuse(
            file,
            "a header without a segment of data",
            "rows of samples under their own header",
            "check that the measurement was saved with its data",
        );
    }
    let details = details(&file_header, &segments[0]);
    let several = segments.len() > 1;
    if several {
        notes.push(SegmentsApart { segments: segments.len() });
    }
    // A unit that is none is refused with the channels.
    let stated = settings.time_unit.as_deref();
    let time_unit_s = stated.and_then(|symbol| time::stated_unit(file, symbol, "").ok());
    let mut waveforms = Vec::new();
    for (k, segment) in segments.into_iter().enumerate() {
        let group = if several { format!("segment_{}", k + 1) } else { String::new() };
        waveforms.extend(segment.waveforms(&group, &file_header, time_unit_s, &mut notes));
    }
    conversion::recording(file, waveforms, details, settings, notes)
}

impl Segment {
    fn check_counts(&self, number: usize, notes: &mut Notes) {
        let mut off: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for (column, values) in self.header.columns.iter().zip(&self.values) {
            if let Ok(announced) = self.header.text("Samples", *column).parse::<usize>()
                && announced != values.len()
            {
                *off.entry((announced, values.len())).or_default() += 1;
            }
        }
        if number > 20 {
            return;
        }
        for ((announced, found), channels) in off.into_iter().take(5) {
            let (segment, channels, stated) = (Some(number), Some(channels), announced as f64);
            notes.push(SampleCount { file: None, segment, channels, stated, found, used: found });
        }
    }

    fn start(&self, column: usize) -> f64 {
        self.header.number("X0", column, self.decimal).unwrap_or(0.0)
    }

    fn interval(&self, column: usize) -> Option<f64> {
        self.header.number("Delta_X", column, self.decimal).filter(|dt| *dt > 0.0)
    }

    /// Whether `next` has the same channels, each from where this one ends: by X0, or by the clock where X0 starts
    /// again at its first value.
    fn continues(&self, next: &Self) -> bool {
        let (a, b) = (&self.header, &next.header);
        a.titles == b.titles
            && a.columns == b.columns
            && a.columns.iter().zip(&self.values).all(|(column, values)| {
                let (Some(dt), Some(next_dt)) = (self.interval(*column), next.interval(*column)) else { return false };
                let length = values.len() as f64 * dt;
                let clocks = [a, b].map(|header| time_of_day(header.text("Time", *column)));
                let by_x0 = (next.start(*column) - self.start(*column) - length).abs() < 0.5 * dt;
                let by_clock = next.start(*column) == self.start(*column)
                    && matches!(clocks, [Some(a), Some(b)] if (b.since(a) - length).abs() < 0.5 * dt)
                    && a.text("Date", *column) == b.text("Date", *column);
                dt == next_dt
                    && a.text("Y_Unit_Label", *column) == b.text("Y_Unit_Label", *column)
                    && (by_x0 || by_clock)
            })
    }

    fn append(&mut self, next: Self) {
        for (values, more) in self.values.iter_mut().zip(next.values) {
            values.extend(more);
        }
    }

    /// `time_unit_s`: factor of the unit of X that a person states.
    fn waveforms(self, group: &str, file: &FileHeader, time_unit_s: Option<f64>, notes: &mut Notes) -> Vec<Waveform> {
        let header = &self.header;
        let date = file.keys.get("Date").map(String::as_str).unwrap_or_default();
        let mut waveforms = Vec::with_capacity(self.values.len());
        for (column, values) in header.columns.iter().zip(&self.values) {
            let mut waveform = Waveform::new(group, header.titles[*column].clone());
            header.text("Y_Unit_Label", *column).clone_into(&mut waveform.unit);
            let steps = self.interval(*column).map(|dt| (self.start(*column), dt));
            waveform.set_steps(steps, header.text("X_Dimension", *column), header.text("X_Unit_Label", *column));
            let is_of_day = header.text("Date", *column) == date && !values.is_empty();
            waveform.origin = time_of_day(header.text("Time", *column)).filter(|_| is_of_day);
            waveforms.push(waveform);
        }
        let begin = file.keys.get("Time").and_then(|time| time_of_day(time));
        settle_starts(&mut waveforms, begin, time_unit_s, notes);
        for (waveform, values) in waveforms.iter_mut().zip(self.values) {
            waveform.values = Ok(values);
        }
        waveforms
    }
}

/// Leaves one of X0 and the clock where both say when a channel starts: X0 as the time since the program began, at
/// `begin`, is no time of the record; where every X0 grows as the clocks do, it holds them already.
fn settle_starts(waveforms: &mut [Waveform], begin: Option<Instant>, time_unit_s: Option<f64>, notes: &mut Notes) {
    let mut since_begin_s: f64 = 0.0;
    let mut starts: Vec<(Instant, f64)> = Vec::new();
    for Waveform { steps, step_unit_s, origin, .. } in waveforms.iter_mut() {
        let (Some(clock), Some((x0, _))) = (*origin, steps) else { continue };
        let x0_s = *x0 * time_unit_s.unwrap_or(*step_unit_s);
        if x0_s > 0.0 && begin.is_some_and(|begin| (clock.since(begin) - x0_s).abs() < CLOCK_SLACK_S) {
            since_begin_s = since_begin_s.max(x0_s);
            *x0 = 0.0;
        }
        starts.push((clock, if *x0 == 0.0 { 0.0 } else { x0_s }));
    }
    if since_begin_s > 0.0 {
        let since_start_s = Some(since_begin_s);
        notes.push(TimesFromFirst { column: None, since_start_s, first_s: None });
    }
    let Some((first, first_x0_s)) = starts.first().copied() else { return };
    if starts.iter().all(|(clock, x0_s)| (x0_s - first_x0_s - clock.since(first)).abs() < CLOCK_SLACK_S) {
        waveforms.iter_mut().for_each(|waveform| waveform.origin = None);
    }
}

fn details(file: &FileHeader, first: &Segment) -> Details {
    let key = |name: &str| file.keys.get(name).map(|text| text.trim()).filter(|text| !text.is_empty());
    let of_segment = |name: &str| Some(first.header.text(name, 1).trim()).filter(|text| !text.is_empty());
    let mut facts = Vec::new();
    if let Some(date) = key("Date") {
        let time = key("Time").map_or_else(String::new, |t| format!(" {}", t.split(['.', ',']).next().unwrap_or(t)));
        let operator = key("Operator").map_or_else(String::new, |name| format!(" by {name}"));
        facts.push(format!("recorded {date}{time}{operator}"));
    }
    for name in ["Project", "Description"] {
        facts.extend(key(name).map(|text| format!("{name}: {text}")));
    }
    facts.extend(of_segment("Notes").map(|text| format!("Notes: {text}")));
    let title = of_segment("Test_Name").or(of_segment("UUT_Name"));
    Details {
        title: title.map(|text| Stated { value: text.to_owned(), from: "the segment's header".to_owned() }),
        facts,
        ..Details::default()
    }
}

/// How many X columns the rows have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum XColumns {
    /// The first field is empty.
    No,
    /// The first field, for all channels.
    One,
    /// One before each channel.
    Multi,
}

#[derive(Debug, Clone)]
pub struct FileHeader {
    /// Tab or comma.
    pub separator: u8,
    /// The decimal mark, if stated. Files of Writer_Version 0.92 do not.
    pub decimal: Option<u8>,
    pub x_columns: XColumns,
    /// All keys with their first value.
    pub keys: BTreeMap<String, String>,
}

/// What a segment's header says: values by key, by column of the rows (0 is the key's own).
#[derive(Debug, Clone, Default)]
pub struct SegmentHeader {
    pub keys: BTreeMap<String, Vec<String>>,
    pub titles: Vec<String>,
    pub columns: Vec<usize>,
}

/// Reads up to the first `***End_of_Header***`.
fn file_header(lines: &mut Lines) -> Result<FileHeader> {
    let mut keys = BTreeMap::new();
    let mut after_key = None;
    lines.take()?;
    loop {
        let Some(line) = lines.take()? else { return no_end(lines) };
        if is_mark(line.bytes, "End_of_Header") {
            break;
        }
        // Which of both it is, the header says itself.
        let Some(end) = line.bytes.iter().position(|b| matches!(b, b'\t' | b',')) else { continue };
        after_key.get_or_insert(line.bytes[end]);
        let separator = line.bytes[end];
        let [key, value] = [&line.bytes[..end], &line.bytes[end + 1..]];
        let value = value.strip_suffix(&[separator]).unwrap_or(value);
        keys.entry(decode(key.trim_ascii())).or_insert_with(|| decode(value.trim_ascii()));
    }
    let key = |name: &str| keys.get(name).map(String::as_str).unwrap_or_default();
    let separator = match key("Separator") {
        "Tab" => b'\t',
        "Comma" => b',',
        _ => after_key.unwrap_or(b'\t'),
    };
    // With commas for both, the value of the key is between two separators.
    let decimal = match key("Decimal_Separator") {
        "." => Some(b'.'),
        "," => Some(b','),
        "" if keys.contains_key("Decimal_Separator") && separator == b'\t' => Some(b','),
        _ => None,
    };
    if separator == b',' && decimal == Some(b',') {
        let hint = "save the measurement with tabs between the columns";
        return refuse(lines.place(), "decimal commas between commas", "another decimal mark than the separator", hint);
    }
    let x_columns = match key("X_Columns") {
        "No" => XColumns::No,
        "Multi" => XColumns::Multi,
        _ => XColumns::One,
    };
    Ok(FileHeader { separator, decimal, x_columns, keys })
}

/// Reads the header of the next segment and the line of titles below; `None` at the end of the file.
fn segment_header(lines: &mut Lines, file: &FileHeader) -> Result<Option<SegmentHeader>> {
    let mut header = SegmentHeader::default();
    loop {
        let Some(line) = lines.take()? else {
            return if header.keys.is_empty() { Ok(None) } else { no_end(lines) };
        };
        if is_mark(line.bytes, "End_of_Header") {
            break;
        }
        if is_mark(line.bytes, "Start_Special") {
            while let Some(line) = lines.take()?
                && !is_mark(line.bytes, "End_Special")
            {}
            continue;
        }
        if is_blank(line.bytes) {
            continue;
        }
        let fields = words(line.bytes, file.separator);
        header.keys.insert(fields[0].clone(), fields);
    }
    header.titles = match lines.take()? {
        Some(line) => words(line.bytes, file.separator),
        None => return no_end(lines),
    };
    let step = if file.x_columns == XColumns::Multi { 2 } else { 1 };
    let room = (header.titles.len().saturating_sub(1)).div_ceil(step);
    let count = match header.keys.get("Channels").and_then(|fields| fields.get(1)) {
        Some(text) => match text.parse::<usize>() {
            Ok(count) if (1..=room).contains(&count) => count,
            _ => {
                let titles = header.titles.len();
                let found = format!("{text:?} channels are announced, there are {titles} column titles");
                let hint = "the file may be damaged: save the measurement again";
                return refuse(lines.place(), found, "a title for each channel", hint);
            }
        },
        None => header.titles[1..].iter().step_by(step).filter(|t| *t != "Comment" && !t.is_empty()).count(),
    };
    header.columns = (0..count).map(|k| 1 + k * step).collect();
    Ok(Some(header))
}

fn no_end<T>(lines: &Lines) -> Result<T> {
    let hint = "the file may be cut short: save or download it again";
    let expected = "***End_of_Header***, a line of column titles and rows";
    refuse(lines.place(), "the file ends in a header", expected, hint)
}

impl SegmentHeader {
    /// The value of a key for the channel in a column; empty if there is none.
    pub fn text(&self, key: &str, column: usize) -> &str {
        self.keys.get(key).and_then(|fields| fields.get(column)).map_or("", String::as_str)
    }

    /// The same as a finite number.
    pub fn number(&self, key: &str, column: usize, decimal: u8) -> Option<f64> {
        lines::field(self.text(key, column).as_bytes(), decimal).map(|number| number.value)
    }

    /// The decimal mark where the file states none: the comma if interval or start have one.
    pub fn decimal(&self) -> u8 {
        let comma = |key: &str| self.keys.get(key).is_some_and(|fields| fields.iter().any(|f| f.contains(',')));
        if comma("Delta_X") || comma("X0") { b',' } else { b'.' }
    }
}

/// Whether a line holds nothing but separators and blanks.
pub fn is_blank(line: &[u8]) -> bool {
    line.iter().all(|b| b.is_ascii_whitespace() || *b == b',')
}

/// Whether a line is the mark `***name***`.
fn is_mark(line: &[u8], name: &str) -> bool {
    line.trim_ascii_start().strip_prefix(b"***").is_some_and(|rest| {
        let rest = rest.to_ascii_lowercase();
        rest.strip_prefix(name.to_ascii_lowercase().as_bytes()).is_some_and(|rest| rest.starts_with(b"***"))
    })
}

pub fn words(line: &[u8], separator: u8) -> Vec<String> {
    line.split(|b| *b == separator).map(|field| decode(field.trim_ascii())).collect()
}

/// The samples of each channel of a segment.
///
/// Channels may have different numbers of samples: the rows then end in empty fields. An empty field before a sample is
/// refused. The printed X are a check only: rounded to a microsecond, they must not leave the grid by half an interval.
fn rows_of(lines: &mut Lines, file: &FileHeader, header: &SegmentHeader, decimal: u8) -> Result<Vec<Vec<f64>>> {
    let channels = header.columns.len();
    let last_column = header.columns.last().copied().unwrap_or(0);
    let mut channel_of = vec![None; last_column + 1];
    for (k, column) in header.columns.iter().enumerate() {
        channel_of[*column] = Some(k);
    }
    let mut clocks: Vec<Option<Clock>> = header
        .columns
        .iter()
        .enumerate()
        .map(|(k, column)| match file.x_columns {
            XColumns::No => None,
            XColumns::One if k > 0 => None,
            _ => header.number("Delta_X", *column, decimal).filter(|dt| *dt > 0.0).map(|dt| Clock { dt, first: None }),
        })
        .collect();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); channels];
    let mut row = 0;
    while let Some(line) = lines.peek()? {
        let start = line.bytes.split(|b| *b == file.separator).next().unwrap_or_default();
        // Words in front: the next segment.
        if !start.trim_ascii().is_empty() && lines::field(start, decimal).is_none() && !lines::is_gap(start) {
            break;
        }
        lines.take()?;
        if is_blank(line.bytes) {
            continue;
        }
        let mut x = None;
        for (column, field) in line.bytes.split(|b| *b == file.separator).enumerate().take(last_column + 1) {
            let Some(k) = channel_of[column] else {
                x = lines::field(field, decimal).map(|number| number.value);
                continue;
            };
            let field = lines::unquoted(field);
            if field.is_empty() {
                continue;
            }
            let place = || lines.place().in_nth_column(column, &header.titles[column]);
            if values[k].len() < row {
                return refuse(place(), "a sample after empty fields", "samples without gaps", GAPS_ARE_NOT_FILLED);
            }
            let value = match lines::field(field, decimal) {
                Some(number) => number.value,
                None if lines::is_gap(field) => f64::NAN,
                None => {
                    let found = format!("{:?} is not a finite number", decode(&field[..field.len().min(40)]));
                    let hint = "save the measurement again, or write the number that belongs there: without its line \
                                all later samples would come too early";
                    return refuse(place(), found, "a finite number or nothing in every field", hint);
                }
            };
            values[k].push(value);
            if let (Some(clock), Some(x)) = (&mut clocks[k], x)
                && let Some(expected) = clock.off(x, row)
            {
                let found = format!("X is {x}, the row is at {expected} by X0 and Delta_X");
                let hint =
                    "the recording was interrupted there, or several were saved under one header: split the file";
                return refuse(place(), found, "rows at equal steps of Delta_X", hint);
            }
        }
        row += 1;
    }
    Ok(values)
}

/// A printed X column against its interval.
struct Clock {
    dt: f64,
    first: Option<f64>,
}

impl Clock {
    /// The X that row `row` should have, if it is not near it.
    fn off(&mut self, x: f64, row: usize) -> Option<f64> {
        // X is printed to the microsecond, to seven digits where it is large; both ends are rounded. Where it starts is
        // not checked.
        let expected = *self.first.get_or_insert(x) + row as f64 * self.dt;
        let rounding = if expected.abs() < 1e6 { 1.1e-6 } else { 1.1e-6 * expected.abs() };
        let slack = 0.5 * self.dt + rounding;
        ((x - expected).abs() > slack).then_some(expected)
    }
}

remarks! {
    /// Remarks of LVM files.
    pub REMARKS;

    /// The segments of the file are several recordings.
    CR037 SegmentsApart { segments: usize }
    bears on (About::Record, Weight::Slight)
    decided "A segment continues the one before if it has the same channels, units and interval, and begins where that \
             one ends, within half an interval, by X0 or by its clock."
    means "Each segment has channels of its own, and only one of them holds the crash."
    remedy "name the channel of the crash by --channel, such as segment_2.NAME"
    says format!(
        "{segments} segments of the file do not continue each other: their channels are kept apart as segment_1, \
         segment_2, ..."
    );
}
