//! How a table is written: delimiter, decimal mark, header lines, number of columns.

use crate::formats::text::lines::{Line, NumberStyle, comment, decode, is_gap, line_at, unquoted};
use crate::time::{Instant, stamp};
use crate::{IngestError, Place, Result, refuse, refuse_size};

/// Lines looked at, comments and blank lines aside.
const SAMPLE_LINES: usize = 120;
const LINES_LOOKED_AT: usize = 10_000;
/// Rows after the first that must agree with it.
const AGREEING_ROWS: usize = 3;
/// More columns than this are taken for a mistake.
pub const COLUMN_LIMIT: usize = 4096;

/// What stands between fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delimiter {
    /// One byte: tab, semicolon, comma.
    Byte(u8),
    /// Any run of blanks and tabs.
    Blanks,
}

impl Delimiter {
    pub fn name(self) -> &'static str {
        match self {
            Self::Byte(b'\t') => "tab",
            Self::Byte(b';') => "semicolon",
            Self::Byte(_) => "comma",
            Self::Blanks => "blanks",
        }
    }

    /// The fields of a line, quotes kept. A delimiter inside double quotes is part of the field.
    pub fn split(self, line: &[u8]) -> Vec<&[u8]> {
        match self {
            Self::Blanks => line.split(u8::is_ascii_whitespace).filter(|f| !f.is_empty()).collect(),
            Self::Byte(delimiter) => {
                let mut quoted = false;
                line.split(|b| {
                    quoted ^= *b == b'"';
                    *b == delimiter && !quoted
                })
                .collect()
            }
        }
    }
}

/// All whole numbers up to this one are kept by a number of 64 bits.
pub const KEPT: u64 = 1 << 53;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cells {
    Numbers,
    /// Whole numbers with more digits than a number keeps, counted from this one.
    Whole(i64),
    /// Times of the day or of a calendar, in s from this one.
    Stamps(Instant),
    /// Words, which are not read.
    Words,
}

impl Cells {
    /// What a cell, which is no gap, makes of its column.
    fn of(text: &[u8], style: NumberStyle) -> Self {
        let bare = decode(unquoted(text));
        if let Some(whole) = bare.parse::<i64>().ok().filter(|n| n.unsigned_abs() > KEPT) {
            return Self::Whole(whole);
        }
        if style.field(text).is_some() {
            return Self::Numbers;
        }
        stamp(&bare).map_or(Self::Words, Self::Stamps)
    }

    fn is_alike(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }
}

/// How a table is written, and the lines before its rows.
#[derive(Debug, Clone)]
pub struct Layout<'a> {
    pub delimiter: Delimiter,
    pub style: NumberStyle,
    /// Fields of a row that some row fills.
    pub columns: usize,
    pub cells: Vec<Cells>,
    /// Fields before the last of these that every row leaves blank, by their index among all fields.
    pub blank: Vec<usize>,
    /// Blank fields at the end of every row.
    pub trailing: usize,
    pub first_row: usize,
    pub first_line: usize,
    /// Comment lines before the rows, marks removed.
    pub comments: Vec<Line<'a>>,
    /// Other lines before the rows: names, units, or free text.
    pub header: Vec<Line<'a>>,
}

impl Layout<'_> {
    /// What the columns hold: what the first row that fills each says.
    fn cells_of(&self, rows: &[Line]) -> Vec<Cells> {
        let mut cells = vec![None; self.columns];
        for row in rows {
            let fields = self.without_blanks(self.delimiter.split(row.bytes));
            for (cell, text) in cells.iter_mut().zip(fields).filter(|(cell, text)| cell.is_none() && !is_gap(text)) {
                *cell = Some(Cells::of(text, self.style));
            }
        }
        cells.into_iter().map(|cell| cell.unwrap_or(Cells::Numbers)).collect()
    }

    /// The fields of a line without those that every row leaves blank; a line of fewer fields keeps all of its own.
    pub fn without_blanks<T>(&self, mut fields: Vec<T>) -> Vec<T> {
        if fields.len() >= self.columns + self.blank.len() {
            for k in self.blank.iter().rev() {
                fields.remove(*k);
            }
        }
        fields
    }
}

#[derive(Debug, Clone, Copy)]
struct Way {
    delimiter: Delimiter,
    style: NumberStyle,
}

/// The ways a table is written, most particular first. The last of them: thousands apart in whole numbers, `-50,000`,
/// which is read so only where other cells show that the point is the decimal mark.
const WAYS: [Way; 12] = {
    const fn way(delimiter: Delimiter, decimal: u8, lone_groups: bool) -> Way {
        Way { delimiter, style: NumberStyle { decimal, lone_groups } }
    }
    [
        way(Delimiter::Byte(b'\t'), b'.', false),
        way(Delimiter::Byte(b'\t'), b',', false),
        way(Delimiter::Byte(b';'), b'.', false),
        way(Delimiter::Byte(b';'), b',', false),
        way(Delimiter::Byte(b','), b'.', false),
        way(Delimiter::Blanks, b'.', false),
        way(Delimiter::Blanks, b',', false),
        // Every number in quotes: "0,0001","-1,5".
        way(Delimiter::Byte(b','), b',', false),
        way(Delimiter::Byte(b'\t'), b'.', true),
        way(Delimiter::Byte(b';'), b'.', true),
        way(Delimiter::Byte(b','), b'.', true),
        way(Delimiter::Blanks, b'.', true),
    ]
};

/// Fields of a row; `None` where something else than numbers stands. `NaN` and gaps count as numbers here, so that
/// they are refused at their place and not taken for names.
fn row_fields(line: &[u8], way: Way) -> Option<usize> {
    let fields = way.delimiter.split(line);
    let numbers = fields.iter().filter(|text| way.style.field(text).is_some()).count();
    let gaps = fields.iter().filter(|text| is_gap(text)).count();
    (numbers > 0 && numbers + gaps == fields.len()).then_some(fields.len())
}

/// The rows under a way of writing.
#[derive(Debug, Clone, PartialEq, Eq)]
struct FirstRow {
    line: usize,
    columns: usize,
    blank: Vec<usize>,
    trailing: usize,
}

/// The first row under a way of writing. Lines with one number before it are text. `agree` asks the next rows to have
/// as many fields. Fields that no row fills are blank.
fn first_row(lines: &[Line], fields_of: &[Option<usize>], way: Way, agree: bool, least: usize) -> Option<FirstRow> {
    let first = fields_of.iter().position(|fields| fields.is_some_and(|fields| fields >= least))?;
    let fields = fields_of[first]?;
    if agree && !fields_of[first..].iter().take(AGREEING_ROWS).all(|other| *other == Some(fields)) {
        return None;
    }
    let mut is_blank = vec![true; fields];
    for (line, _) in lines[first..].iter().zip(&fields_of[first..]).filter(|(_, other)| **other == Some(fields)) {
        for (is_blank, text) in is_blank.iter_mut().zip(way.delimiter.split(line.bytes)) {
            *is_blank &= unquoted(text).is_empty();
        }
    }
    let trailing = is_blank.iter().rev().take_while(|blank| **blank).count();
    let blank: Vec<usize> = (0..fields - trailing).filter(|k| is_blank[*k]).collect();
    let columns = fields - trailing - blank.len();
    (columns >= least).then_some(FirstRow { line: first, columns, blank, trailing })
}

/// Of the columns that the first rows leave blank, those that one of the lines below fills are none: a slower channel,
/// or one that begins late. These lines join the others.
fn fill_late<'a>(
    row: &mut FirstRow,
    lines: &mut Vec<Line<'a>>,
    delimiter: Delimiter,
    mut below: impl Iterator<Item = Line<'a>>,
) {
    let fields = row.columns + row.blank.len() + row.trailing;
    let mut blank: Vec<usize> = row.blank.iter().copied().chain(fields - row.trailing..fields).collect();
    while !blank.is_empty()
        && let Some(line) = below.next()
    {
        let (cells, before) = (delimiter.split(line.bytes), blank.len());
        blank.retain(|k| cells.len() != fields || unquoted(cells[*k]).is_empty());
        if blank.len() < before {
            lines.push(line);
        }
    }
    row.trailing = (0..fields).rev().take_while(|k| blank.contains(k)).count();
    row.columns = fields - blank.len();
    blank.retain(|k| *k < fields - row.trailing);
    row.blank = blank;
}

/// Looks at the first lines of a table and says how it is written. Rows have `least` columns and more.
pub fn sniff<'a>(text: &'a [u8], file: &str, least: usize) -> Result<Layout<'a>> {
    let mut comments: Vec<(usize, Line<'a>)> = Vec::new();
    let mut lines: Vec<Line<'a>> = Vec::new();
    let (mut offset, mut number) = (0, 1);
    while offset < text.len() && lines.len() < SAMPLE_LINES && number <= LINES_LOOKED_AT {
        let (line, next) = line_at(text, offset, number, file)?;
        if let Some(words) = comment(line.bytes) {
            comments.push((lines.len(), Line { bytes: words, ..line }));
        } else if is_open_quote(line.bytes)
            && let Some((cell, after, last)) = whole_cell(text, line, next)
        {
            lines.push(cell);
            (offset, number) = (after, last + 1);
            continue;
        } else if !is_blank_row(line.bytes) {
            lines.push(line);
        }
        (offset, number) = (next, number + 1);
    }
    let fields_by_way: Vec<Vec<_>> =
        WAYS.iter().map(|way| lines.iter().map(|line| row_fields(line.bytes, *way)).collect()).collect();
    let single_column = lines
        .iter()
        .enumerate()
        .find(|(k, _)| fields_by_way.iter().any(|fields: &Vec<Option<usize>>| fields[*k].is_some()))
        .map(|(_, line)| line.number);
    // The way that sees the earliest row, so that no row is taken for text; of several the one whose rows agree.
    let plain = WAYS
        .iter()
        .zip(&fields_by_way)
        .flat_map(|(way, fields)| {
            [true, false].map(|agree| (way, agree, first_row(&lines, fields, *way, agree, least)))
        })
        .filter_map(|(way, agree, row)| row.map(|row| (way, agree, row)))
        .filter(|(way, _, row)| !way.style.lone_groups || decimal_mark(&lines[row.line..], **way) == Some(b'.'))
        .min_by_key(|(_, agree, row)| (row.line, !agree))
        .map(|(way, _, row)| (*way, row));
    let best = match plain {
        None => mixed_rows(&lines, file, least)?,
        plain => plain,
    };
    if let Some((way, mut row)) = best {
        let below = std::iter::from_fn(|| {
            let (line, next) = line_at(text, offset, number, file).ok().filter(|_| offset < text.len())?;
            (offset, number) = (next, number + 1);
            Some(line)
        });
        fill_late(&mut row, &mut lines, way.delimiter, below.filter(|line| comment(line.bytes).is_none()));
        let FirstRow { line: first, columns, blank, trailing } = row;
        if columns > COLUMN_LIMIT {
            let expected = format!("at most {COLUMN_LIMIT} columns, one sample a row");
            return refuse_size(Place::line(file, lines[first].number), format!("{columns} columns"), expected);
        }
        refuse_doubtful_commas(way, &lines[first..], file)?;
        let mut layout = Layout {
            delimiter: way.delimiter,
            style: way.style,
            columns,
            cells: Vec::new(),
            blank,
            trailing,
            first_row: lines[first].offset,
            first_line: lines[first].number,
            comments: comments.iter().filter(|(before, _)| *before <= first).map(|(_, line)| *line).collect(),
            // A row of gaps is no header.
            header: lines[..first].iter().filter(|line| !is_row_of_gaps(line.bytes, way.delimiter)).copied().collect(),
        };
        layout.cells = layout.cells_of(&lines[first..]);
        refuse_broken_decimal_commas(&layout, &lines[first..], file)?;
        return Ok(layout);
    }
    if lines.is_empty() && offset < text.len() {
        let expected = format!("the first row within the first {LINES_LOOKED_AT} lines: leave comment lines out");
        let found = format!("{LINES_LOOKED_AT} lines of comments and blanks, and no row yet");
        return refuse_size(Place::line(file, number), found, expected);
    }
    Err(no_rows(&lines, single_column, file))
}

/// Whether a line holds nothing but delimiters and empty quotes, as spreadsheets write below the last row.
pub fn is_blank_row(line: &[u8]) -> bool {
    line.iter().all(|b| matches!(b, b',' | b';' | b'"') || b.is_ascii_whitespace())
}

/// Whether a line holds `NaN` and the like alone.
fn is_row_of_gaps(line: &[u8], delimiter: Delimiter) -> bool {
    delimiter.split(line).iter().all(|text| is_gap(text))
}

/// Whether a quote is left open at the end of a line.
fn is_open_quote(line: &[u8]) -> bool {
    line.iter().filter(|b| **b == b'"').count() % 2 == 1
}

/// Lines that a cell of a header may be broken into.
const CELL_LINES: usize = 6;

/// A line whose last cell goes on in the next ones (`"Time` / `(s)","Accel` / `(g)"`), the offset after it and the
/// number of its last line. `None` where no line closes the quote: it is an inch mark, say.
fn whole_cell<'a>(text: &'a [u8], line: Line<'a>, next: usize) -> Option<(Line<'a>, usize, usize)> {
    let (mut end, mut number) = (next, line.number);
    for _ in 1..CELL_LINES {
        let rest = text.get(end..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|b| *b == b'\n').map_or(rest.len(), |at| at + 1);
        (end, number) = (end + length, number + 1);
        let bytes = text[line.offset..end].trim_ascii_end();
        if !is_open_quote(bytes) {
            return Some((Line { bytes, ..line }, end, number));
        }
    }
    None
}

/// The decimal mark that the cells of some rows show: a mark with other than three digits behind it, or with a zero
/// before it, stands between no thousands. `None` where they leave it open.
fn decimal_mark(rows: &[Line], way: Way) -> Option<u8> {
    rows.iter().find_map(|row| {
        way.delimiter.split(row.bytes).into_iter().find_map(|cell| {
            let cell = unquoted(cell);
            let mark = *cell.iter().rfind(|b| matches!(b, b'.' | b','))?;
            let at = cell.iter().rposition(|b| *b == mark)?;
            let lead = cell[..at].strip_prefix(b"-").or(cell[..at].strip_prefix(b"+")).unwrap_or(&cell[..at]);
            let digits = cell[at + 1..].iter().take_while(|b| b.is_ascii_digit()).count();
            (digits != 3 || matches!(lead, b"" | b"0") || cell[at + 1 + digits..].starts_with(b"e")).then_some(mark)
        })
    })
}

/// `"-50,000","-17"`: -50 or fifty thousand? Refused, unless a semicolon stands between the fields, every number has
/// its comma, or some number shows what the comma is.
fn refuse_doubtful_commas(way: Way, rows: &[Line], file: &str) -> Result<()> {
    if way.style.decimal != b',' || way.delimiter == Delimiter::Byte(b';') || decimal_mark(rows, way).is_some() {
        return Ok(());
    }
    let cells = |row: &Line| -> Vec<String> {
        let fields = way.delimiter.split(row.bytes).into_iter();
        fields.filter(|cell| way.style.field(cell).is_some()).map(|cell| decode(unquoted(cell))).collect()
    };
    if rows.iter().all(|row| cells(row).iter().all(|cell| cell.contains(','))) {
        return Ok(());
    }
    let doubtful = rows.iter().find_map(|row| Some((row.number, cells(row).into_iter().find(|c| c.contains(','))?)));
    let Some((line, cell)) = doubtful else { return Ok(()) };
    refuse(
        Place::line(file, line),
        format!("{cell:?} may be a whole number with its thousands apart, or one with a decimal comma"),
        "numbers that can be read in one way only",
        "export again without thousands separators and with a decimal point",
    )
}

/// `0,0001,-1,23`: a decimal comma in a table whose delimiter is the comma as well cannot be read back.
fn refuse_broken_decimal_commas(layout: &Layout, rows: &[Line], file: &str) -> Result<()> {
    let whole_numbers = || {
        rows.iter().all(|row| !row.bytes.contains(&b'.') && !row.bytes.contains(&b'e') && !row.bytes.contains(&b'E'))
    };
    if (layout.delimiter, layout.style.decimal) != (Delimiter::Byte(b','), b'.')
        || layout.cells.iter().any(|cells| *cells != Cells::Numbers)
        || layout.columns < 3
        || !whole_numbers()
    {
        return Ok(());
    }
    let names = layout.header.last().map(|line| Delimiter::Byte(b',').split(line.bytes).len());
    let broken = match names {
        Some(names) => layout.columns > names,
        None => layout.columns.is_multiple_of(2),
    };
    if !broken {
        return Ok(());
    }
    let names = names.map_or_else(|| "no header".to_owned(), |n| format!("{n} names"));
    Err(decimal_comma(
        Place::line(file, layout.first_line),
        format!("{} whole numbers in a row, {names}: decimal commas between comma-separated fields", layout.columns),
    ))
}

/// The refusal of a table whose delimiter is also its decimal mark.
pub fn decimal_comma(place: Place, found: String) -> IngestError {
    IngestError::content(
        place,
        found,
        "a decimal point, or another delimiter than the comma",
        "export again with a decimal point, or with semicolons or tabs between the fields",
    )
}

fn no_rows(lines: &[Line], single_column: Option<usize>, file: &str) -> IngestError {
    let expected = "rows of numbers: a time column and at least one acceleration column";
    if let Some(line) = single_column {
        let hint = "export the time column too, or state --sample-time; a signal file of an NHTSA test is read by \
            giving its .EV5 file";
        return IngestError::content(Place::line(file, line), "one number in a row", expected, hint);
    }
    let Some(first) = lines.first() else {
        let found = "nothing but comments and blank lines";
        return IngestError::content(file, found, expected, "check that the export is complete");
    };
    let start = decode(&first.bytes[..first.bytes.len().min(60)]);
    let found = format!("no rows of numbers in the first {} lines, which start {:?}", lines.len(), start.trim());
    let hint = "export the record as CSV: one sample a row, numbers between commas, semicolons, tabs or blanks";
    IngestError::content(Place::line(file, first.number), found, expected, hint)
}

/// `-1.5 g`: a number with something behind it that has no digit.
fn number_with_unit(text: &str) -> Option<&str> {
    let (number, unit) = text.split_at(text.find(|c: char| c.is_alphabetic() || c == '%' || c == '°')?);
    let is_number = NumberStyle::POINT.field(number.as_bytes()).or(NumberStyle::COMMA.field(number.as_bytes()));
    is_number.filter(|_| !unit.contains(|c: char| c.is_ascii_digit()) || unit.starts_with("m/s")).map(|_| unit)
}

/// The rows of a table with times of the day or words in some column: five lines alike, by the way of writing that sees
/// the most numbers in them. Refused: numbers with their unit behind them.
fn mixed_rows(lines: &[Line], file: &str, least: usize) -> Result<Option<(Way, FirstRow)>> {
    /// Rows that must look alike: as many fields, numbers, times and words in the same columns.
    const ALIKE: usize = 5;
    let with_units = |line: &Line, way: Way| {
        let fields = way.delimiter.split(line.bytes);
        let units: Vec<_> = fields.iter().map(|f| number_with_unit(&decode(unquoted(f))).is_some()).collect();
        units.contains(&true).then_some(units)
    };
    let mut best: Option<(usize, Way, FirstRow)> = None;
    for way in WAYS {
        let kinds: Vec<Vec<Option<Cells>>> = lines
            .iter()
            .map(|line| way.delimiter.split(line.bytes))
            .map(|fields| fields.iter().map(|f| (!is_gap(f)).then(|| Cells::of(f, way.style))).collect())
            .collect();
        let are_alike = |a: &[Option<Cells>], b: &[Option<Cells>]| {
            a.len() == b.len() && a.iter().zip(b).all(|pair| !matches!(pair, (Some(a), Some(b)) if !a.is_alike(*b)))
        };
        let counted = |row: &[Option<Cells>]| row.iter().flatten().filter(|c| **c != Cells::Words).count();
        let first = kinds.windows(ALIKE).zip(lines).position(|(rows, line)| {
            let is_row = counted(&rows[0]) > 0 && rows[0].iter().flatten().count() > 1;
            (is_row || rows[0].len() > 1 && with_units(line, way).is_some_and(|units| !units.contains(&false)))
                && rows.iter().all(|row| are_alike(&rows[0], row))
        });
        let Some(first) = first else { continue };
        if let Some(column) = with_units(&lines[first], way).and_then(|units| units.iter().position(|unit| *unit)) {
            return Err(unit_behind_a_number(lines, first, column, way, file));
        }
        let fields_of: Vec<Option<usize>> = (0..lines.len())
            .map(|k| (k >= first && are_alike(&kinds[first], &kinds[k])).then_some(kinds[k].len()))
            .collect();
        let numbers = counted(&kinds[first]);
        if let Some(row) = first_row(lines, &fields_of, way, false, least)
            && best.as_ref().is_none_or(|(most, ..)| numbers > *most)
        {
            best = Some((numbers, way, row));
        }
    }
    Ok(best.map(|(_, way, row)| (way, row)))
}

fn unit_behind_a_number(lines: &[Line], row: usize, column: usize, way: Way, file: &str) -> IngestError {
    let fields = way.delimiter.split(lines[row].bytes);
    let text = decode(unquoted(fields[column]));
    let names = row.checked_sub(1).map(|k| way.delimiter.split(lines[k].bytes)).filter(|n| n.len() == fields.len());
    let number = column + 1;
    let title = names.map_or_else(|| number.to_string(), |n| format!("{number} ({})", decode(unquoted(n[column]))));
    IngestError::content(
        Place::line(file, lines[row].number).in_column(title),
        format!("text in a row of numbers: {:?}", text.chars().take(40).collect::<String>()),
        "numbers in every column",
        "export the numbers without the unit behind them, and put it into the name of the column: accel_g",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(text: &str) -> (&'static str, char, usize, usize) {
        let layout = sniff(text.as_bytes(), "t.csv", 2).unwrap();
        (layout.delimiter.name(), char::from(layout.style.decimal), layout.columns, layout.header.len())
    }

    #[test]
    fn finds_delimiter_decimal_mark_and_header() {
        assert_eq!(way("time_s,accel_g\n0,1\n0.1,2\n"), ("comma", '.', 2, 1));
        assert_eq!(way("t;a\ns;g\n0,0;1,5\n0,1;2,5\n"), ("semicolon", ',', 2, 2));
        assert_eq!(way("0,1\t1,5\n0,2\t2,5\n"), ("tab", ',', 2, 0));
        assert_eq!(way("# x\n\n  0.1   1.5 \n  0.2 -2.5\n"), ("blanks", '.', 2, 0));
        assert_eq!(way("0,1 1,5\n0,2 2,5\n"), ("blanks", ',', 2, 0));
        assert_eq!(way("a, b\n0.1, 1.5\n0.2, 2.5\n"), ("comma", '.', 2, 1));
        assert_eq!(way("\"t\",\"a\"\n\"0.1\",\"1.5\"\n\"0.2\",\"2\"\n"), ("comma", '.', 2, 1));
        assert_eq!(way("t;a;\n0;1;\n1;2;\n"), ("semicolon", '.', 2, 1));
        assert_eq!(way("1;2\n0,5;nan\n1,5;4\n"), ("semicolon", ',', 2, 0));
    }

    #[test]
    fn refuses_decimal_commas_between_commas() {
        for text in
            ["t,a\n0,0001,-1,23\n0,0002,-1,24\n", "0,0001,-1,23\n0,0002,-1,24\n", "t,a\n-0,02,0\n-0,01,0\n0,01,1,5"]
        {
            let error = sniff(text.as_bytes(), "t.csv", 2).unwrap_err().to_string();
            assert!(error.contains("decimal comma"), "{error}");
        }
        // Three columns of whole numbers under three names are what they look like.
        assert_eq!(way("t,a,b\n1,2,3\n2,3,4\n"), ("comma", '.', 3, 1));
    }

    #[test]
    fn says_what_it_found_where_there_are_no_rows() {
        let error = sniff(b"dear sir,\nthe record\n", "a.txt", 2).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a.txt, line 1: no rows of numbers in the first 2 lines, which start \"dear sir,\""
        );
        let error = sniff(b"a\n1\n2\n3\n", "a.txt", 2).unwrap_err();
        assert_eq!(error.to_string(), "a.txt, line 2: one number in a row");
    }
}
