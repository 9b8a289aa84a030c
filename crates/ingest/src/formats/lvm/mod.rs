//! LVM, the text files of LabVIEW's "Write to Measurement File": a header, then segments of columns.

mod header;
mod lines;
mod rows;

use std::collections::BTreeMap;

use crumple_signal::Notes;

use crate::formats::iso13499;
use crate::formats::reader::{Bundle, Reader};
use crate::formats::text::lines::without_mark;
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::recording::content::Recording;
use crate::recording::details::{Details, Stated};
use crate::recording::read_channel::ReadChannel;
use crate::{IngestError, IngestSettings, Place};
use header::{FileHeader, SegmentHeader};
use lines::Lines;

/// Difference of clocks that counts as the same, s.
const CLOCK_SLACK_S: f64 = 1e-3;

/// Channels that start farther apart than this are not of one event, s.
const ONE_EVENT_S: f64 = 60.0;

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
    let mut waveforms = Vec::new();
    for (k, segment) in segments.into_iter().enumerate() {
        let group = if several { format!("segment_{}", k + 1) } else { String::new() };
        waveforms.extend(segment.waveforms(&group, &file_header, &mut notes));
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
                let clocks = [a, b].map(|header| clock_s(header.text("Time", *column)));
                let by_x0 = (next.start(*column) - self.start(*column) - length).abs() < 0.5 * dt;
                let by_clock = next.start(*column) == self.start(*column)
                    && matches!(clocks, [Some(a), Some(b)] if (b - a - length).abs() < 0.5 * dt)
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

    fn waveforms(mut self, group: &str, file: &FileHeader, notes: &mut Notes) -> Vec<Waveform> {
        let samples = std::mem::take(&mut self.values);
        let starts = self.starts(&samples, file, notes);
        let mut waveforms = Vec::with_capacity(samples.len());
        for ((column, values), start) in self.header.columns.iter().zip(samples).zip(starts) {
            let header = &self.header;
            let mut waveform = Waveform::new(group, header.titles[*column].clone());
            header.text("Y_Unit_Label", *column).clone_into(&mut waveform.unit);
            let steps = self.interval(*column).map(|dt| (start, dt));
            waveform.set_steps(steps, header.text("X_Dimension", *column), header.text("X_Unit_Label", *column));
            waveform.values = Ok(values);
            waveforms.push(waveform);
        }
        waveforms
    }

    /// Start of each channel on the axis of the one that starts first: X0, and how much later the channel started by
    /// its clock, which X0 may hold already.
    ///
    /// X0 as the time since the program began, which is known from the clock of the file, is no time of the record.
    fn starts(&self, samples: &[Vec<f64>], file: &FileHeader, notes: &mut Notes) -> Vec<f64> {
        let columns = &self.header.columns;
        let x0: Vec<f64> = columns.iter().map(|column| self.start(*column)).collect();
        let begin = file.keys.get("Time").and_then(|time| clock_s(time));
        let date = file.keys.get("Date").map(String::as_str).unwrap_or_default();
        let clocks: Vec<Option<f64>> = columns
            .iter()
            .zip(samples)
            .map(|(column, values)| {
                let is_of_day = self.header.text("Date", *column) == date && !values.is_empty();
                clock_s(self.header.text("Time", *column)).filter(|_| is_of_day)
            })
            .collect();
        let earliest = clocks.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let later = |k: usize| clocks[k].map_or(0.0, |clock| clock - earliest);
        let known = || (0..columns.len()).filter(|k| clocks[*k].is_some());
        let apart_s = known().map(later).fold(0.0, f64::max);
        let first = known().find(|k| later(*k) == 0.0).unwrap_or(0);
        let since_begin = |k: usize| clocks[k].zip(begin).map(|(clock, begin)| clock - begin);
        let is_since_begin =
            |k: usize| x0[k] > 0.0 && since_begin(k).is_some_and(|s| (s - x0[k]).abs() < CLOCK_SLACK_S);
        // Either X0 grows as the clock does, or the clocks are those of different events.
        let in_x0 = known().all(|k| (x0[k] - x0[first] - later(k)).abs() < CLOCK_SLACK_S);
        let by_clock = |k: usize| if apart_s > ONE_EVENT_S { 0.0 } else { later(k) };
        let since_program_start = (0..columns.len()).filter(|k| is_since_begin(*k)).map(|k| x0[k]).fold(0.0, f64::max);
        if since_program_start > 0.0 {
            notes.info(format!(
                "X0 = {since_program_start} s is the time since the program began, by the clock: the samples start at \
                 t = 0, and --time-zero counts from there"
            ));
        }
        if (0.0..=ONE_EVENT_S).contains(&apart_s) && apart_s > 0.0 {
            notes.info(format!(
                "channels start up to {apart_s:.6} s apart by their clocks: all have the axis of the one that starts \
                 first, and --time-zero counts on it"
            ));
        }
        let start = |k: usize| match (is_since_begin(k), in_x0) {
            (true, _) => by_clock(k),
            (false, true) => x0[k],
            (false, false) => x0[k] + by_clock(k),
        };
        (0..columns.len()).map(start).collect()
    }
}

/// Seconds of the day of `13:40:37.7466657` or `09:54:07,483999`.
fn clock_s(text: &str) -> Option<f64> {
    let text = text.replace(',', ".");
    let mut parts =
        text.trim().splitn(3, ':').map(|part| part.parse::<f64>().ok().filter(|x| (0.0..100.0).contains(x)));
    let (hours, minutes, seconds) = (parts.next()??, parts.next()??, parts.next()??);
    Some(hours * 3600.0 + minutes * 60.0 + seconds)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_are_read_with_either_mark() {
        // Half a unit in the last place of 49237 s is 4e-12.
        assert!((clock_s("13:40:37.7466657312496152783").unwrap() - 49_237.746_665_731_25).abs() < 1e-9);
        assert_eq!(clock_s("09:54:07,5"), Some(35_647.5));
        assert_eq!(clock_s("19:00:00"), Some(68_400.0));
        for text in ["", "12:00", "a:b:c", "1:2:3:4", "-1:0:0"] {
            assert_eq!(clock_s(text), None, "{text}");
        }
    }
}
