//! Tables of numbers: CSV, TSV, semicolons or blanks, as instruments and spreadsheets write them.

mod columns;
pub(crate) mod header;
mod layout;
mod recorder;
mod report;
mod rows;
mod section;
mod time_axis;

use std::borrow::Cow;
use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::path::Path;

use crumple_signal::Notes;

use crate::formats::iso13499;
use crate::formats::reader::Bundle;
use crate::formats::registry::Reader;
use crate::recording::content::{Details, Found, Recording};
use crate::recording::details::from_comments;
use crate::recording::unheeded_flags;
use crate::{IngestError, Place, Profile, Settings};

use crate::formats::text::lines::{decode, is_text, without_mark};

/// Fewer samples than this are no crash record.
pub const MINIMUM_SAMPLES: usize = 50;

/// Bytes read at a time of a long table.
const PIECE: usize = 8 << 20;
/// Event data recorders keep 25 to 35 samples.
const MINIMUM_EDR_SAMPLES: usize = 5;

/// Reader of tables: whatever is text and nothing else.
pub struct Table;

impl Reader for Table {
    fn format(&self) -> &'static str {
        "csv"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        is_text(head)
    }

    /// UTF-16 and old Macintosh line ends are converted as a whole, so such files must fit into memory.
    fn streams(&self, head: &[u8]) -> bool {
        !matches!(without_mark(head), Cow::Owned(_))
    }

    fn heeds(&self) -> &'static [&'static str] {
        &["--unit", "--time-unit", "--sample-time", "--profile", "--skip-to", "--vehicle-number", "--resample"]
    }

    fn read(&self, bundle: &Bundle, settings: &Settings) -> Result<Recording, IngestError> {
        read(&bundle.main.name, &bundle.main.bytes, bundle, settings)
    }
}

/// Reads a table from its bytes, or from the file of which these are the start. `file` names it in messages.
fn read(file: &str, bytes: &[u8], bundle: &Bundle, settings: &Settings) -> Result<Recording, IngestError> {
    let edr = settings.profile == Some(Profile::Edr);
    let mut text = without_mark(bytes);
    if edr
        && bundle.large.is_none()
        && let Some(recording) = report::read(file, &text, bundle, settings)?
    {
        return Ok(recording);
    }
    if let Some(title) = &settings.skip_to {
        if bundle.large.is_some() {
            return Err(IngestError::TooLarge {
                place: Place::file(file),
                found: "--skip-to in a table that is read piece by piece".to_owned(),
                limit: "one table to a file of this length".to_owned(),
            });
        }
        text = Cow::Owned(section::cut(&text, title, file)?);
    }
    let OneTable { mut channels, mut details, mut notes } = match one_table(file, bytes, &text, bundle, settings) {
        Err(error) if !edr && bundle.large.is_none() => return Err(report::hinted(file, &text, error)),
        table => table?,
    };
    if edr {
        edr_notes(&channels, &mut details, &mut notes);
    }
    let pulse_rule = iso13499::pulse_rule(&mut channels, settings, &mut notes);
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: false, notes })
}

/// What one table says.
struct OneTable {
    channels: Vec<Found>,
    details: Details,
    notes: Notes,
}

/// Reads one table. `text` is that of `bytes` without its mark; a long table goes on in the file of the bundle.
fn one_table(
    file: &str,
    bytes: &[u8],
    text: &[u8],
    bundle: &Bundle,
    settings: &Settings,
) -> Result<OneTable, IngestError> {
    let edr = settings.profile == Some(Profile::Edr);
    let least_columns = if settings.sample_time.is_some() { 1 } else { 2 };
    let layout = layout::sniff(text, file, least_columns)?;
    let header = header::read(&layout);
    let comments: Vec<(usize, String)> = layout.comments.iter().map(|line| (line.number, decode(line.bytes))).collect();
    let facts = from_comments(file, comments.iter().map(|(line, text)| (*line, text.as_str())))?;
    let name = |k: usize| header.columns[k].title.clone();
    let mut rows = match &bundle.large {
        None => rows::read(text, &layout, file, name)?,
        Some(large) => {
            let skipped = bytes.len() - text.len() + layout.first_row;
            let source = start_at(file, &large.path, skipped as u64)?;
            let length = usize::try_from(large.length).unwrap_or(usize::MAX).saturating_sub(skipped);
            let head = &text[layout.first_row..];
            let advance = |bytes| {
                if let Some(progress) = bundle.progress.get() {
                    progress.borrow_mut().advance(bytes);
                }
            };
            rows::read_stream(rows::Pieces { source, length, head, piece: PIECE }, &layout, file, name, advance)?
        }
    };
    let samples = rows.lines.len();
    let least = if edr { MINIMUM_EDR_SAMPLES } else { MINIMUM_SAMPLES };
    if samples < least {
        return Err(IngestError::content(
            Place::file(file),
            format!("{samples} samples"),
            format!("at least {least} samples, one in a row"),
            "give the whole record: some tens of milliseconds before and after contact, sampled at 1 kHz or more",
        ));
    }
    let mut notes = Notes::new();
    header_notes(file, &header, &mut notes);
    notes.extend(facts.notes);
    let time = match settings.sample_time {
        Some(interval) => {
            if settings.time_unit.is_some() {
                unheeded_flags::note("--time-unit", "--sample-time states the interval with its unit", &mut notes);
            }
            time_axis::stated(file, &header, interval.si())?
        }
        None => time_axis::find(file, &header, &mut rows, settings, facts.time_unit.as_ref(), &mut notes)?,
    };
    let channels = columns::channels(file, &header, rows, &time, settings, facts.unit.as_ref(), &mut notes)?;
    Ok(OneTable { channels, details: facts.details, notes })
}

/// What an event data recorder's table is good for.
fn edr_notes(channels: &[Found], details: &mut Details, notes: &mut Notes) {
    details.no_pulse = !channels.iter().any(|f| f.fitness.is_some());
    details.facts.push(
        "event data recorder (49 CFR 563): time zero is the recorder's, some milliseconds after contact".to_owned(),
    );
    notes.warning(
        "event data recorder table: the velocity change is cumulative and coarse (as a rule 10 ms, whole km/h or mph), and how the recorder \
         filtered it is not stated: peak acceleration and force cannot be taken from it, crush roughly",
    );
}

/// The file from `offset` on.
fn start_at(file: &str, path: &Path, offset: u64) -> Result<File, IngestError> {
    let open = || -> std::io::Result<File> {
        let mut source = File::open(path)?;
        source.seek(SeekFrom::Start(offset))?;
        Ok(source)
    };
    open().map_err(|error| {
        IngestError::content(Place::file(file), error.to_string(), "a readable file", "check the disk and try again")
    })
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
