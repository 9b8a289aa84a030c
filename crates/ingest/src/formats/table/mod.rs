//! Tables of numbers: CSV, TSV, semicolons or blanks, as instruments and spreadsheets write them.

use std::borrow::Cow;

use crumple_signal::{Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2};

use crate::formats::iso13499;
use crate::formats::reader::{Bundle, Reader};
use crate::formats::remarks::LinesNotUsed;
use crate::formats::table::numbers::{LeftOut, Remnant};
use crate::formats::table::remarks::{KiloG, LinesAtEnds, NamesAndColumns};
use crate::formats::text::lines::{Line, NumberStyle, decode, is_text, without_mark};
use crate::recording::content::{MINIMUM_SAMPLES, ReadChannel, Recording};
use crate::recording::details::{Details, Stated, from_comments};
use crate::recording::preamble;
use crate::recording::settings;
use crate::{IngestError, IngestSettings, Place, Profile, Result, refuse, refuse_size};

mod columns;
mod event_data_recorder;
mod gaps;
pub mod header;
pub mod layout;
mod logs;
pub mod numbers;
mod pairs;
pub mod remarks;
mod time_axis;

/// Tables: whatever is text and nothing else. UTF-16 and old Macintosh line ends are converted as a whole, so such
/// files must fit into memory.
pub const TABLE: Reader = Reader {
    streams: |head| !matches!(without_mark(head), Cow::Owned(_)),
    has_comments: true,
    ..Reader::of_one_file("csv", is_text, FLAGS, read)
};
/// Flags about the form of a file that is rows of cells, texts aside.
pub const FLAGS_OF_ROWS: &[&str] = &["--unit", "--time-unit", "--sample-time", "--vehicle-number", "--resample"];
const FLAGS: &[&str] =
    &["--unit", "--time-unit", "--sample-time", "--profile", "--skip-to", "--vehicle-number", "--resample"];

/// Reads a table from its bytes, or from the file of which these are the start.
fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let edr = settings.profile == Some(Profile::Edr);
    let mut text = without_mark(bytes);
    if edr
        && bundle.large.is_none()
        && let Some(recording) = event_data_recorder::read(file, &text, bundle, settings)?
    {
        return Ok(recording);
    }
    if let Some(title) = &settings.skip_to {
        if bundle.large.is_some() {
            return refuse_size(
                file,
                "--skip-to in a table that is read piece by piece",
                "one table to a file of this length",
            );
        }
        text = Cow::Owned(header::cut(&text, title, file)?);
    }
    let mut rewritten = None;
    if bundle.large.is_none()
        && let Some(logs::AsTable { text: as_table, note }) = logs::as_table(file, &text, settings.channel.as_deref())?
    {
        (text, rewritten) = (Cow::Owned(as_table), Some(note));
    }
    let OneTable { channels, mut details, mut notes } =
        match one_table(file, bytes, &text, bundle, settings, TextAbove::Unused) {
            Err(error) if !edr && bundle.large.is_none() => {
                return Err(event_data_recorder::with_profile_hint(file, &text, error));
            }
            table => table?,
        };
    rewritten.into_iter().for_each(|note| notes.push(note));
    if edr {
        event_data_recorder::edr_notes(&channels, &mut details, &mut notes);
    }
    Ok(recording(channels, details, settings, notes))
}

pub fn recording(
    mut channels: Vec<ReadChannel>,
    mut details: Details,
    settings: &IngestSettings,
    mut notes: Notes,
) -> Recording {
    // A table of velocities has no acceleration to take as the pulse.
    let has = |quantity| channels.iter().any(|read| read.channel.quantity == quantity);
    details.no_pulse |= has(QuantityKind::Velocity) && !has(QuantityKind::Acceleration) && !has(QuantityKind::Other);
    let pulse_rule = iso13499::pulse_rule(&mut channels, settings, &mut notes);
    Recording { details, channels, pulse_rule, contact_at_zero: false, notes }
}

/// Bytes read at a time of a long table.
const PIECE: usize = 8 << 20;
/// Event data recorders keep 25 to 35 samples.
const MINIMUM_EDR_SAMPLES: usize = 5;

pub struct OneTable {
    /// Its columns but that of the time.
    pub channels: Vec<ReadChannel>,
    pub details: Details,
    pub notes: Notes,
}

/// What lines of text above the names of a table are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextAbove {
    /// Not used, which is noted.
    Unused,
    /// The heading of a table in a report.
    Heading,
}

/// Reads one table. `text` is that of `bytes` without its mark; a long table goes on in the file of the bundle.
pub fn one_table(
    file: &str,
    bytes: &[u8],
    text: &[u8],
    bundle: &Bundle,
    settings: &IngestSettings,
    text_above: TextAbove,
) -> Result<OneTable> {
    let edr = settings.profile == Some(Profile::Edr);
    let least_columns = if settings.sample_time.is_some() { 1 } else { 2 };
    let layout = layout::sniff(text, file, least_columns)?;
    let header = header::read(&layout);
    let comments: Vec<(usize, String)> = layout.comments.iter().map(|line| (line.number, decode(line.bytes))).collect();
    let mut facts = from_comments(file, comments.iter().map(|(line, text)| (*line, text.as_str())), settings)?;
    let above = layout.header.iter();
    let above = above.map(|line| (format!("line {} of {file}", line.number), header::cells(line, &layout)));
    preamble::take(above, &mut facts.details, &mut facts.notes);
    if let Some(contradiction) = &header.contradiction {
        return Err(two_units(file, contradiction));
    }
    refuse_scale_factor(file, &layout)?;
    let name = |k: usize| header.columns[k].title.clone();
    let rows = match &bundle.large {
        None => numbers::read(text, &layout, file, name)?,
        Some(large) => {
            let skipped = bytes.len() - text.len() + layout.first_row;
            let source = large.from_offset(skipped as u64).map_err(|error| {
                IngestError::content(file, error.to_string(), "a readable file", "check the disk and try again")
            })?;
            let length = usize::try_from(large.length).unwrap_or(usize::MAX).saturating_sub(skipped);
            let head = &text[layout.first_row..];
            let advance = (bundle.show_progress)(format!("reading {}", bundle.name), large.length);
            numbers::read_stream(numbers::Pieces { source, length, head, piece: PIECE }, &layout, file, name, advance)?
        }
    };
    let samples = rows.lines.len();
    let columns = header.columns.len();
    if columns > MINIMUM_SAMPLES && samples < MINIMUM_SAMPLES {
        return refuse(
            Place::line(file, layout.first_line),
            format!("{samples} rows of {columns} numbers: the samples of a channel seem to stand in one row"),
            "one sample a row, one channel a column",
            "export the transpose of this table",
        );
    }
    let least = if edr { MINIMUM_EDR_SAMPLES } else { MINIMUM_SAMPLES };
    if samples < least {
        let whole = "give the whole record: some tens of milliseconds before and after contact, at 1 kHz or more";
        let of_recorder = "; the table of an event data recorder, some ten rows, takes --profile edr";
        let hint = [whole, if samples < MINIMUM_EDR_SAMPLES { "" } else { of_recorder }].concat();
        let expected = format!("at least {least} samples, one in a row");
        return refuse(file, format!("too few samples: {samples}"), expected, hint);
    }
    if header.lacks_a_name && time_axis::counts(&rows.columns[0]) {
        return refuse(
            Place::line(file, layout.first_line),
            format!("{columns} columns, {} names, and the first column counts the rows", columns - 1),
            "a name for every column",
            "the name of the count is missing, as R leaves it out: put \"row\" in front of the names, or export \
             without the count (row.names = FALSE)",
        );
    }
    let mut notes = Notes::new();
    header_notes(file, &header, text_above, &mut notes);
    left_out_notes(file, &rows, &mut notes);
    notes.extend(facts.notes);
    let channels =
        channels_of(file, &header, rows, settings, (facts.unit.as_ref(), facts.time_unit.as_ref()), &mut notes)?;
    Ok(OneTable { channels, details: facts.details, notes })
}

/// The channels of a table from its names and its rows; `comments`: what they state of the units of accelerations and
/// times.
pub fn channels_of(
    file: &str,
    header: &header::TableHeader,
    rows: numbers::Rows,
    settings: &IngestSettings,
    comments: (Option<&Stated<String>>, Option<&Stated<String>>),
    notes: &mut Notes,
) -> Result<Vec<ReadChannel>> {
    let groups = pairs::groups(header, &rows).filter(|_| settings.sample_time.is_none());
    match groups {
        Some(groups) => pairs::channels(file, header, &rows, &groups, settings, notes, |rows, settings, notes| {
            of_one_time(file, header, rows, settings, comments, notes)
        }),
        None => {
            let (channels, _) = of_one_time(file, header, rows, settings, comments, notes)?;
            Ok(channels.into_iter().map(|(_, channel)| channel).collect())
        }
    }
}

/// Channels with their columns, and what their times count from, s, where they are those of a calendar.
type OfOneTime = (Vec<(usize, ReadChannel)>, Option<f64>);

/// The same where all channels have one time, each with its column; and what the times count from, s, where they are
/// those of a calendar.
fn of_one_time(
    file: &str,
    header: &header::TableHeader,
    mut rows: numbers::Rows,
    settings: &IngestSettings,
    comments: (Option<&Stated<String>>, Option<&Stated<String>>),
    notes: &mut Notes,
) -> Result<OfOneTime> {
    gaps::settle(file, header, &mut rows, settings, notes)?;
    let time = match settings.sample_time {
        Some(interval) => {
            if settings.time_unit.is_some() {
                settings::warn("--time-unit", "--sample-time states the interval with its unit", notes);
            }
            time_axis::stated(file, header, &rows, interval.si(), notes)
        }
        None => time_axis::find(file, header, &mut rows, settings, comments.1, notes),
    };
    let time = match time {
        Err(error) if settings.listing => return Ok((columns::without_time(header, &rows, &error), None)),
        time => time?,
    };
    // Whole numbers that are no times are what they were.
    for (k, column) in rows.columns.iter_mut().enumerate() {
        if let layout::Cells::Whole(first) = rows.cells[k] {
            column.iter_mut().for_each(|x| *x += first as f64);
        }
    }
    Ok((columns::channels(file, header, rows, &time, settings, comments.0, notes)?, time.origin_s))
}

/// Refuses rows below `1.0e+03 *`, which MATLAB prints above numbers that it has divided by that.
fn refuse_scale_factor(file: &str, layout: &layout::Layout) -> Result<()> {
    let is_factor = |line: &&Line| {
        let factor = line.bytes.trim_ascii().strip_suffix(b"*").map(<[u8]>::trim_ascii);
        factor.is_some_and(|text| NumberStyle::POINT.field(text).is_some())
    };
    let Some(line) = layout.header.iter().find(is_factor) else { return Ok(()) };
    refuse(
        Place::line(file, line.number),
        format!("{:?}: the numbers below are divided by a common factor", decode(line.bytes.trim_ascii())),
        "numbers as they are",
        "write the table with writematrix or writetable, or multiply all columns and remove that line",
    )
}

fn header_notes(file: &str, header: &header::TableHeader, text_above: TextAbove, notes: &mut Notes) {
    let (names, columns) = (header.names, header.columns.len());
    if names > columns || header.lacks_names() {
        notes.push(NamesAndColumns { file: file.to_owned(), names, columns });
    }
    if !header.kilo_g.is_empty() {
        notes.push(KiloG { factor_m_per_s2: 1e3 * STANDARD_GRAVITY_M_PER_S2 });
    }
    if let Some(line) = header.ignored_lines.first().filter(|_| text_above == TextAbove::Unused) {
        let (count, file) = (header.ignored_lines.len(), Some(file.to_owned()));
        notes.push(LinesNotUsed { count, file, line: Some(*line) });
    }
}

fn left_out_notes(file: &str, rows: &numbers::Rows, notes: &mut Notes) {
    let (gaps, text): (Vec<&LeftOut>, Vec<&LeftOut>) =
        rows.left_out.iter().partition(|left_out| left_out.what == Remnant::Gap);
    if let [first, ..] = gaps.as_slice() {
        notes.push(LinesAtEnds { file: file.to_owned(), count: gaps.len(), line: first.line, words: None });
    }
    if let [first, ..] = text.as_slice()
        && let Remnant::Footer(words) = &first.what
    {
        let words = Some(words.clone());
        notes.push(LinesAtEnds { file: file.to_owned(), count: text.len(), line: first.line, words });
    }
}

fn two_units(file: &str, contradiction: &header::Contradiction) -> IngestError {
    let header::Contradiction { column, name, unit } = contradiction;
    IngestError::content(
        Place::line(file, unit.0).in_column((column + 1).to_string()),
        format!("the unit {:?} is not the one that line {} states: {:?}", unit.1, name.0, name.1),
        "one unit for a column",
        format!("correct line {} or line {}", name.0, unit.0),
    )
}
