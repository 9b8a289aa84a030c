//! Excel workbooks (.xlsx): a sheet is a table as any other.
//!
//! Programs write formulas without values: openpyxl none, XlsxWriter 0. A column of such is named and not read.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;

use calamine::{Data, DataRef, Reader as _, Xlsx, XlsxCellFormulaMetadataRecord, XlsxError};
use crumple_signal::{About, Channel, Notes, QuantityKind, Weight, remarks};

use crate::formats::reader::{Bundle, Reader};
use crate::formats::table::layout::{COLUMN_LIMIT, Cells};
use crate::formats::table::numbers::Rows;
use crate::formats::table::{channels_of, header, recording};
use crate::formats::text::column_names::{Unit, split_unit};
use crate::formats::waveform::channel::clean;
use crate::recording::content::{LineNumbers, MINIMUM_SAMPLES, ReadChannel, Recording, list};
use crate::recording::details::Details;
use crate::recording::preamble;
use crate::time::stamp;
use crate::{IngestError, IngestSettings, Place, Result, refuse_size};

/// Workbooks.
pub const WORKBOOK: Reader = Reader::of_one_file(
    "xlsx",
    recognises,
    &["--unit", "--time-unit", "--sample-time", "--sheet", "--vehicle-number", "--resample"],
    read,
);

/// Other archives do not come here with such an entry at their start.
pub fn recognises(head: &[u8]) -> bool {
    let has = |name: &[u8]| head.windows(name.len()).any(|window| window == name);
    head.starts_with(b"PK\x03\x04") && (has(b"xl/") || has(b"[Content_Types].xml")) && !has(b"word/")
}

/// The filled cells of a sheet, by row and column from 0.
type Grid = BTreeMap<u32, BTreeMap<u32, Data>>;

/// A sheet: its cells, and the formulas that have no values, by column.
#[derive(Default)]
struct Sheet {
    cells: Grid,
    formulas: BTreeMap<u32, usize>,
}

/// Rows at the top of a sheet that may state mass and speed.
const MOST_STATEMENTS: usize = 200;
const SAVE_VALUES: &str = "open the workbook in a spreadsheet program and save it: that stores the values of formulas";

fn refuse(file: &str, found: impl std::fmt::Display, hint: &str) -> IngestError {
    IngestError::content(file, found, "a sheet with rows of numbers below the names of their columns", hint)
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes) = (bundle.main.name.as_str(), bundle.main.bytes.as_slice());
    let damaged = |error: XlsxError| refuse(file, format!("the workbook cannot be read: {error}"), "save it again");
    let mut workbook: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(damaged)?;
    let names = workbook.sheet_names();
    let is_meant = |name: &String| settings.sheet.as_ref().is_none_or(|sheet| sheet.eq_ignore_ascii_case(name.trim()));
    let (mut tables, mut unread, mut statements) = (Vec::new(), Vec::new(), Vec::new());
    for name in &names {
        let sheet = match cells_of(file, &mut workbook, name) {
            Err(_) if !is_meant(name) => continue,
            sheet => sheet?,
        };
        let first = first_row(&sheet.cells, settings);
        let first = first.filter(|first| sheet.cells.range(first..).count() >= MINIMUM_SAMPLES);
        // Another record has a mass and a speed of its own.
        if first.is_none() {
            statements.extend(rows_of_words(name, &sheet.cells));
        }
        if !is_meant(name) {
            continue;
        }
        unread.extend(without_values(&sheet));
        if let Some(first) = first {
            tables.push((name, sheet, first));
        }
    }
    let several: Vec<String> = tables.iter().map(|(name, ..)| format!("{name:?}")).collect();
    match tables.as_slice() {
        [(name, sheet, first)] => {
            let mut recording = table(file, sheet, *first, settings)?;
            // What the sheet itself states is what counts.
            for rows in [rows_of_words(name, &sheet.cells), statements] {
                preamble::take(rows.into_iter(), &mut recording.details, &mut recording.notes);
            }
            Ok(recording)
        }
        [] if !unread.is_empty() => {
            let found = format!("no sheet has {MINIMUM_SAMPLES} rows of numbers: {}", reasons(&unread).join(", "));
            Err(refuse(file, found, SAVE_VALUES))
        }
        [] => {
            let found = format!("no sheet has {MINIMUM_SAMPLES} rows of numbers; its sheets: {}", names.join(", "));
            Err(refuse(file, found, "name another sheet by --sheet, or save the sheet with the record as CSV"))
        }
        _ => Err(refuse(
            file,
            format!("{} sheets hold rows of numbers: {}", several.len(), several.join(", ")),
            &format!("add --sheet {}, for example", several[0]),
        )),
    }
}

/// The first rows of a sheet that begin with words, each with where it stands.
fn rows_of_words(name: &str, sheet: &Grid) -> Vec<(String, Vec<String>)> {
    let begins_with_words = |cells: &&BTreeMap<u32, Data>| matches!(cells.values().next(), Some(Data::String(_)));
    let rows = sheet.iter().take(MOST_STATEMENTS).filter(|(_, cells)| begins_with_words(cells));
    let texts = |cells: &BTreeMap<u32, Data>| cells.values().take(4).map(Data::to_string).collect();
    rows.map(|(row, cells)| (format!("row {} of sheet {name}", row + 1), texts(cells))).collect()
}

/// The cells of a sheet one by one: what a sheet states of its size reserves nothing.
fn cells_of(file: &str, workbook: &mut Xlsx<Cursor<&[u8]>>, name: &str) -> Result<Sheet> {
    let mut sheet = Sheet::default();
    // Columns of which a formula has a value other than 0.
    let mut computed = BTreeSet::new();
    // A sheet of a chart has no cells.
    let Ok(mut cells) = workbook.worksheet_cells_reader(name) else { return Ok(sheet) };
    loop {
        let cell = cells
            .next_cell_with_formula_metadata()
            .map_err(|error| refuse(file, format!("sheet {name}: {error}"), "save it again"))?;
        let Some(XlsxCellFormulaMetadataRecord { pos: (row, column), value, formula, .. }) = cell else { break };
        if column as usize >= COLUMN_LIMIT {
            let place = Place::line(file, row as usize + 1);
            return refuse_size(place, "too many columns", format!("at most {COLUMN_LIMIT} columns"));
        }
        if formula.is_some() {
            *sheet.formulas.entry(column).or_default() += 1;
            if !matches!(value, DataRef::Empty) && value != DataRef::Float(0.0) {
                computed.insert(column);
            }
        }
        if !matches!(value, DataRef::Empty | DataRef::Error(_)) {
            sheet.cells.entry(row).or_default().insert(column, Data::from(value));
        }
    }
    sheet.formulas.retain(|column, count| *count >= MINIMUM_SAMPLES && !computed.contains(column));
    // Zeros of formulas are no values.
    if !sheet.formulas.is_empty() {
        sheet.cells.retain(|_, row| {
            row.retain(|column, cell| !(sheet.formulas.contains_key(column) && *cell == Data::Float(0.0)));
            !row.is_empty()
        });
    }
    Ok(sheet)
}

/// What a cell is as one of a row of numbers.
fn kind(cell: &Data) -> Cells {
    match cell {
        Data::Int(_) | Data::Float(_) | Data::DateTime(_) => Cells::Numbers,
        Data::String(text) | Data::DateTimeIso(text) => stamp(text).map_or(Cells::Words, Cells::Stamps),
        _ => Cells::Words,
    }
}

/// The columns of a row that hold numbers or times.
fn counted(row: &BTreeMap<u32, Data>) -> Vec<u32> {
    row.iter().filter(|(_, cell)| kind(cell) != Cells::Words).map(|(column, _)| *column).collect()
}

/// The first of three rows of numbers in the same columns, of which the later may lack some.
fn first_row(sheet: &Grid, settings: &IngestSettings) -> Option<u32> {
    let least = if settings.sample_time.is_some() { 1 } else { 2 };
    let rows: Vec<(u32, Vec<u32>)> = sheet.iter().map(|(row, cells)| (*row, counted(cells))).collect();
    let is_first = |rows: &[(u32, Vec<u32>)]| {
        let columns = &rows[0].1;
        columns.len() >= least
            && rows
                .iter()
                .all(|(_, other)| other.first() == columns.first() && other.iter().all(|c| columns.contains(c)))
    };
    rows.windows(3).find(|rows| is_first(rows)).map(|rows| rows[0].0)
}

/// The table whose rows start at `first`: the lines above are names and units, words below end it.
fn table(file: &str, whole: &Sheet, first: u32, settings: &IngestSettings) -> Result<Recording> {
    let sheet = &whole.cells;
    let columns = counted(&sheet[&first]);
    let line = |row: u32| row as usize + 1;
    let text = |cell: Option<&Data>| cell.map_or_else(String::new, Data::to_string);
    let above = sheet
        .range(..first)
        .map(|(row, cells)| (line(*row), columns.iter().map(|c| text(cells.get(c))).collect::<Vec<String>>()));
    let mut header =
        header::of_lines(above.filter(|(_, cells)| cells.iter().any(|c| !c.is_empty())).collect(), columns.len());
    let mut rows = Rows {
        columns: vec![Vec::new(); columns.len()],
        cells: columns.iter().map(|column| kind(&sheet[&first][column])).collect(),
        // All that a number has.
        digits: vec![17; columns.len()],
        lines: LineNumbers::default(),
        left_out: Vec::new(),
        begins_late: false,
    };
    for (row, cells) in sheet.range(first..) {
        let value = |(column, cells_of): (&u32, &Cells)| match (cells.get(column), cells_of) {
            (Some(Data::String(text) | Data::DateTimeIso(text)), Cells::Stamps(first)) => {
                stamp(text).map_or(f64::NAN, |time| time.since(*first))
            }
            (Some(Data::Int(x)), Cells::Numbers) => *x as f64,
            (Some(Data::Float(x)), Cells::Numbers) => *x,
            (Some(Data::DateTime(days)), Cells::Numbers) => days.as_f64(),
            _ => f64::NAN,
        };
        let values: Vec<f64> = columns.iter().zip(&rows.cells).map(value).collect();
        // A row with its time alone says nothing.
        if values.iter().filter(|x| !x.is_nan()).count() <= usize::from(columns.len() > 1) {
            continue;
        }
        rows.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        rows.lines.push(line(*row));
    }
    for (column, title) in columns.iter().zip(&mut header.columns) {
        if matches!((&sheet[&first][column], &title.unit), (Data::DateTime(_), Unit::Unstated)) {
            title.unit = Unit::Time(86_400.0);
        }
    }
    let mut notes = Notes::new();
    let unread = without_values(whole);
    let reasons = reasons(&unread);
    let channels = channels_of(file, &header, rows, settings, (None, None), &mut notes);
    let mut channels = match channels {
        Err(error) if !reasons.is_empty() => {
            return Err(refuse(file, format!("{}; of the others: {error}", list(&reasons)), SAVE_VALUES));
        }
        channels => channels?,
    };
    for (column, formulas) in unread {
        if settings.listing {
            let channel = Channel::new(clean(&split_unit(&column).0), QuantityKind::Other);
            channels.push(ReadChannel::without_readable_file(channel, no_values(formulas)));
        }
        notes.push(FormulasWithoutValues { column, formulas });
    }
    Ok(recording(channels, Details::default(), settings, notes))
}

/// Title of the columns of formulas without values, and how many these are.
fn without_values(sheet: &Sheet) -> Vec<(String, usize)> {
    let of_column = |(column, count): (&u32, &usize)| {
        let words =
            sheet.cells.values().filter_map(|cells| cells.get(column)).filter(|cell| matches!(cell, Data::String(_)));
        let title = words.take(3).map(Data::to_string).collect::<Vec<String>>().join(" ");
        let title = if title.is_empty() { format!("column {}", column + 1) } else { title };
        (title, *count)
    };
    sheet.formulas.iter().map(of_column).collect()
}

fn no_values(formulas: usize) -> String {
    format!("its {formulas} formulas have no stored values, or 0 all over")
}

fn reasons(unread: &[(String, usize)]) -> Vec<String> {
    unread.iter().map(|(title, formulas)| format!("column {title:?}: {}", no_values(*formulas))).collect()
}

remarks! {
    /// Remarks of workbooks.
    pub REMARKS;

    /// A column of formulas has no stored values.
    CR066 FormulasWithoutValues { column: String, formulas: usize }
    bears on (About::Record, Weight::Slight)
    decided "A workbook stores the value of a formula beside it. Programs that write formulas without computing them \
             leave it out or write 0."
    means "The column is no channel. Where it is the pulse or the time, the record lacks it."
    remedy "open the workbook in a spreadsheet program and save it: that stores the values of formulas"
    says format!("not read: column {column:?}: {}. To have it, {SAVE_VALUES}", no_values(*formulas));
}
