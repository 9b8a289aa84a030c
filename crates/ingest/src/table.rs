//! Tables of numbers: CSV, TSV, semicolons or blanks, as instruments and spreadsheets write them.

mod columns;
mod header;
mod layout;
pub(crate) mod numbers;
mod rows;
mod text;
mod time_axis;

use crumple_signal::Notes;

use crate::bundle::Bundle;
use crate::details::from_comments;
use crate::recognise::Reader;
use crate::recording::{PulseRule, Recording};
use crate::{IngestError, Place, Settings};

pub(crate) use text::{decode, line_at, without_mark};

/// Fewer samples than this are no crash record.
pub const MINIMUM_SAMPLES: usize = 50;

/// Reader of tables: whatever is text and nothing else.
pub struct Table;

impl Reader for Table {
    fn format(&self) -> &'static str {
        "csv"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        text::is_text(head)
    }

    fn read(&self, bundle: &Bundle, settings: &Settings) -> Result<Recording, IngestError> {
        read(&bundle.main.name, &bundle.main.bytes, settings)
    }
}

/// Reads a table from its bytes. `file` names it in messages.
pub fn read(file: &str, bytes: &[u8], settings: &Settings) -> Result<Recording, IngestError> {
    let text = without_mark(bytes);
    let layout = layout::sniff(&text, file)?;
    let header = header::read(&layout);
    let comments: Vec<(usize, String)> = layout.comments.iter().map(|line| (line.number, decode(line.bytes))).collect();
    let facts = from_comments(file, comments.iter().map(|(line, text)| (*line, text.as_str())))?;
    let mut rows = rows::read(&text, &layout, file, |k| header.columns[k].title.clone())?;
    let samples = rows.lines.len();
    if samples < MINIMUM_SAMPLES {
        return Err(IngestError::content(
            Place::file(file),
            format!("{samples} samples"),
            format!("at least {MINIMUM_SAMPLES} samples, one in a row"),
            "give the whole record: some tens of milliseconds before and after contact, sampled at 1 kHz or more",
        ));
    }
    let mut notes = Notes::new();
    header_notes(file, &header, &mut notes);
    notes.extend(facts.notes);
    let time = time_axis::find(file, &header, &mut rows, settings, facts.time_unit.as_ref(), &mut notes)?;
    let channels = columns::channels(file, &header, rows, &time, settings, facts.unit.as_ref(), &mut notes)?;
    Ok(Recording { details: facts.details, channels, pulse_rule: PulseRule::OnlyOne, contact_at_zero: false, notes })
}

fn header_notes(file: &str, header: &header::Header, notes: &mut Notes) {
    if let Some(names) = header.surplus_names {
        notes.warning(format!(
            "{names} names in the header of {file}, but {} columns: the first names are used",
            header.columns.len()
        ));
    }
    if !header.kilo_g.is_empty() {
        notes.info("unit kg in a column of acceleration is read as kilo-g, 9806.65 m/s^2");
    }
    if let Some(line) = header.ignored_lines.first() {
        let count = header.ignored_lines.len();
        notes.info(format!("{count} lines of text above the header of {file} are not used, the first is line {line}"));
    }
}
