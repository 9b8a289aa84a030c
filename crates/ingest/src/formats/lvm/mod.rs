//! LVM, the text files of LabVIEW's "Write to Measurement File": a header, then segments of columns.

mod header;
mod lines;
mod rows;

use std::collections::BTreeMap;

use crumple_signal::Notes;

use crate::formats::iso13499;
use crate::formats::reader::{Bundle, Reader};
use crate::formats::text::lines::without_mark;
use crate::formats::waveform::channel::{Instant, Waveform};
use crate::formats::waveform::conversion;
use crate::formats::waveform::date::time_of_day;
use crate::recording::content::Recording;
use crate::recording::details::{Details, Stated};
use crate::recording::read_channel::ReadChannel;
use crate::time::time_unit;
use crate::{IngestError, IngestSettings, Place};
use header::{FileHeader, SegmentHeader};
use lines::Lines;

/// Difference of clocks that counts as the same, s.
const CLOCK_SLACK_S: f64 = 1e-3;

/// Reader of LVM files.
pub struct Lvm;

impl Reader for Lvm {
    fn format(&self) -> &'static str {
        "lvm"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        without_mark(head).trim_ascii_start().starts_with(b"LabVIEW Measurement")
    }

    fn relevant_flags(&self) -> &'static [&'static str] {
        &["--unit", "--time-unit", "--sample-time", "--vehicle-number", "--resample"]
    }

    fn read(&self, bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
        read(&bundle.main.name, &bundle.main.bytes, settings)
    }
}

/// A segment: its header and samples by channel.
struct Segment {
    header: SegmentHeader,
    decimal: u8,
    values: Vec<Vec<f64>>,
}

/// Reads a file from its bytes. `file` names it in messages.
pub fn read(file: &str, bytes: &[u8], settings: &IngestSettings) -> Result<Recording, IngestError> {
    let text = without_mark(bytes);
    let start = text.iter().take_while(|b| b.is_ascii_whitespace()).count();
    let mut lines = Lines::new(file, &text);
    // Blank lines before the header are no part of it.
    for _ in 0..text[..start].iter().filter(|b| **b == b'\n').count() {
        lines.take()?;
    }
    let file_header = header::file_header(&mut lines)?;
    let mut notes = Notes::new();
    let mut segments: Vec<Segment> = Vec::new();
    while let Some(header) = header::segment_header(&mut lines, &file_header)? {
        let decimal = file_header.decimal.unwrap_or_else(|| header.decimal());
        let values = rows::read(&mut lines, &file_header, &header, decimal)?;
        let segment = Segment { header, decimal, values };
        segment.check_counts(segments.len() + 1, &mut notes);
        match segments.last_mut() {
            Some(last) if last.continues(&segment) => last.append(segment),
            _ => segments.push(segment),
        }
    }
    if segments.is_empty() {
        return Err(IngestError::content(
            Place::file(file),
            "a header without a segment of data",
            "rows of samples under their own header",
            "check that the measurement was saved with its data",
        ));
    }
    let details = details(&file_header, &segments[0]);
    let several = segments.len() > 1;
    if several {
        notes.warning(format!(
            "{} segments of the file do not continue each other: their channels are kept apart as segment_1, \
             segment_2, ...",
            segments.len()
        ));
    }
    // A unit that is none is refused with the channels.
    let stated = settings.time_unit.as_deref();
    let time_unit_s = stated.and_then(|symbol| time_unit::stated_unit(Place::file(file), symbol, "").ok());
    let mut waveforms = Vec::new();
    for (k, segment) in segments.into_iter().enumerate() {
        let group = if several { format!("segment_{}", k + 1) } else { String::new() };
        waveforms.extend(segment.waveforms(&group, &file_header, time_unit_s, &mut notes));
    }
    let channels = conversion::to_channels(file, waveforms, settings, &mut notes)?;
    let mut channels: Vec<ReadChannel> = channels.into_iter().map(|(_, found)| found).collect();
    let pulse_rule = iso13499::pulse_rule(&mut channels, settings, &mut notes);
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: false, notes })
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
            notes.warning(format!(
                "segment {number}: {announced} samples are announced, {found} are there, in {channels} channels: those \
                 are used"
            ));
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
        notes.info(format!(
            "X0 = {since_begin_s} s is the time since the program began, by the clock: the samples start at t = 0, and \
             --time-zero counts from there"
        ));
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
