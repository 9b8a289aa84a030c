//! The rows of a table: numbers by columns.

use std::io::Read;

use rayon::prelude::*;

use crate::formats::table::layout::{Cells, Delimiter, Layout, decimal_comma, is_blank_row};
use crate::formats::text::lines::{
    LINE_LIMIT, ParsedNumber, comment, decode, is_gap, is_negative_of_accounts, line_at, scan, unquoted,
};
use crate::recording::content::{LineNumbers, MINIMUM_SAMPLES};
use crate::time::stamp;
use crate::{IngestError, Place, Result, refuse};

#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// One vector a column: of one length, NaN in a gap; empty, where the column is left out.
    pub columns: Vec<Vec<f64>>,
    pub cells: Vec<Cells>,
    /// Most significant digits printed in each column; 0: its numbers are binary.
    pub digits: Vec<u32>,
    pub lines: LineNumbers,
    /// Lines before the first row and after the last that are left out.
    pub left_out: Vec<LeftOut>,
    /// A column that the first rows leave blank, and that is left out, is filled later.
    pub begins_late: bool,
}

/// A line that is left out, as no other row lies beyond it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    pub line: usize,
    pub what: Remnant,
}

/// What stands before the first or after the last row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remnant {
    /// A row without values, or with its time alone.
    Gap,
    /// Text, the start of it.
    Footer(String),
}

pub const GAPS: &str = "export without that column, cut the record before the gap, or fill the gap in the program \
that made the file";

/// Reads all rows of a text in memory. `name(k)` names column `k` in messages.
///
/// A row in the plain form (numbers, single delimiters) is read straight from the bytes; any other line is taken apart
/// field by field, which also finds the place of what is wrong.
pub fn read(text: &[u8], layout: &Layout, file: &str, name: impl Fn(usize) -> String) -> Result<Rows> {
    let body = &text[layout.first_row..];
    let threads = if body.len() < WORTH_THREADS { 1 } else { rayon::current_num_threads() };
    read_in_parts(body, layout, file, name, threads)
}

/// Shorter texts are read before a second thread has started.
const WORTH_THREADS: usize = 1 << 20;

/// Reads the rows in so many parts at once; what they come to does not depend on the number.
fn read_in_parts(
    body: &[u8],
    layout: &Layout,
    file: &str,
    name: impl Fn(usize) -> String,
    parts: usize,
) -> Result<Rows> {
    let most_rows = (1 << 24) / layout.columns;
    let pieces = whole_lines(body, parts);
    if let [first, others @ ..] = &pieces[..]
        && !others.is_empty()
    {
        // Lines that are left out stand where the record starts or ends: between parts they are found line by line.
        let read = |piece: &[u8], line: usize, length: usize| {
            let mut parser = Parser::new(layout, length, piece, most_rows, file, |_: usize| String::new());
            parser.line = line;
            parser.feed(piece).ok().filter(|()| parser.error.is_none() && parser.rows.left_out.is_empty())?;
            Some((parser.rows, parser.line))
        };
        // The first has room for all; lines of the others count from their own start.
        let (rows, rest) = rayon::join(
            || read(first, layout.first_line, body.len()),
            || others.par_iter().map(|piece| read(piece, 0, piece.len())).collect::<Option<Vec<_>>>(),
        );
        if let (Some((mut rows, mut line)), Some(rest)) = (rows, rest) {
            for (part, lines) in rest {
                rows.append(part, line);
                line += lines;
            }
            return Ok(rows);
        }
        // Something is wrong somewhere: line after line its place is found.
    }
    let mut parser = Parser::new(layout, body.len(), body, most_rows, file, name);
    parser.feed(body)?;
    parser.finish()
}

/// The text in parts of about one length, each of whole lines.
fn whole_lines(body: &[u8], parts: usize) -> Vec<&[u8]> {
    let mut pieces = Vec::with_capacity(parts);
    let mut rest = body;
    for left in (2..=parts).rev() {
        let Some(end) = rest[rest.len() / left..].iter().position(|b| *b == b'\n') else { break };
        let (piece, behind) = rest.split_at(rest.len() / left + end + 1);
        pieces.push(piece);
        rest = behind;
    }
    pieces.push(rest);
    pieces
}

/// A text that is read piece by piece.
pub struct Pieces<'a, R> {
    /// Stands at the first row.
    pub source: R,
    /// Bytes left of it.
    pub length: usize,
    pub head: &'a [u8],
    /// Bytes read at a time.
    pub piece: usize,
}

/// Reads all rows piece by piece, so that the text itself is never in memory as a whole. `done` is told of the bytes of
/// each piece.
pub fn read_stream(
    mut from: Pieces<impl Read>,
    layout: &Layout,
    file: &str,
    name: impl Fn(usize) -> String,
    mut done: impl FnMut(u64),
) -> Result<Rows> {
    let mut parser = Parser::new(layout, from.length, from.head, usize::MAX, file, name);
    let mut buffer = Vec::with_capacity(from.piece + LINE_LIMIT);
    loop {
        let before = buffer.len();
        let got = (&mut from.source).take(from.piece as u64).read_to_end(&mut buffer).map_err(|error| {
            IngestError::content(file, error.to_string(), "a readable file", "check the disk and try again")
        })?;
        if got == 0 {
            parser.feed(&buffer)?;
            return parser.finish();
        }
        // Whole lines only; the rest waits for the next piece.
        if let Some(end) = buffer[before..].iter().rposition(|b| *b == b'\n') {
            let end = before + end + 1;
            parser.feed(&buffer[..end])?;
            buffer.drain(..end);
        } else if buffer.len() > LINE_LIMIT {
            parser.feed(&buffer)?;
        }
        done(got as u64);
    }
}

/// Rows read so far, and the line that comes next.
struct Parser<'a, F> {
    layout: &'a Layout<'a>,
    file: &'a str,
    name: F,
    rows: Rows,
    row: Vec<ParsedNumber>,
    line: usize,
    /// Lines that are no rows, and the error they are if a row follows.
    remnants: Vec<LeftOut>,
    error: Option<IngestError>,
}

impl<'a, F: Fn(usize) -> String> Parser<'a, F> {
    /// The first rows tell how many there will be, near enough to spare most of the growth.
    fn new(layout: &'a Layout, length: usize, head: &[u8], most_rows: usize, file: &'a str, name: F) -> Self {
        let head = &head[..head.len().min(1 << 16)];
        let lines = head.iter().filter(|b| **b == b'\n').count().max(1);
        let expected_rows = (length / (head.len() / lines).max(1) + length / 256 + 2).min(most_rows);
        let columns = layout.columns;
        let rows = Rows {
            columns: (0..columns).map(|_| Vec::with_capacity(expected_rows)).collect(),
            cells: layout.cells.clone(),
            digits: vec![0; columns],
            lines: LineNumbers::default(),
            left_out: Vec::new(),
            begins_late: false,
        };
        let row = vec![ParsedNumber { value: 0.0, digits: 0 }; columns];
        Self { layout, file, name, rows, row, line: layout.first_line, remnants: Vec::new(), error: None }
    }

    /// The rows; what stands behind the last of them is left out.
    fn finish(mut self) -> Result<Rows> {
        match self.error.filter(|_| self.rows.lines.len() == 0) {
            Some(error) => Err(error),
            None => {
                self.rows.left_out.append(&mut self.remnants);
                Ok(self.rows)
            }
        }
    }

    /// Adds the row just read. Gaps before the first row are left out; whatever stands between rows is an error.
    #[inline]
    fn push_row(&mut self) -> Result<()> {
        if self.error.is_some() {
            self.settle_remnants()?;
        }
        self.rows.push(&self.row, self.line);
        Ok(())
    }

    #[cold]
    fn settle_remnants(&mut self) -> Result<()> {
        let is_start = self.rows.lines.len() == 0 && self.remnants.iter().all(|left_out| left_out.what == Remnant::Gap);
        match self.error.take() {
            Some(error) if !is_start => Err(self.another_table().unwrap_or(error)),
            _ => {
                self.rows.left_out.append(&mut self.remnants);
                Ok(())
            }
        }
    }

    /// Another table below a whole one and lines of text that are not the names again.
    fn another_table(&self) -> Option<IngestError> {
        let text = |left_out: &LeftOut| match &left_out.what {
            Remnant::Footer(text) => Some(text.clone()),
            Remnant::Gap => None,
        };
        let texts: Vec<String> = self.remnants.iter().filter_map(text).collect();
        let above: Vec<String> = self.layout.header.iter().map(|line| decode(line.bytes.trim_ascii())).collect();
        let is_long = self.rows.lines.len() >= MINIMUM_SAMPLES && texts.iter().any(|text| !above.contains(text));
        // The names of the columns are no title: what is below them lacks them.
        let title = |own: &[String], others: &[String]| {
            let is_names = |text: &String| self.layout.delimiter.split(text.as_bytes()).len() == self.layout.columns;
            let last = own.len() - usize::from(own.last().is_some_and(is_names));
            own[..last].iter().rfind(|text| !others.contains(text)).map(|text| format!("--skip-to {text:?}"))
        };
        let hint = match (title(&above, &texts), title(&texts, &above)) {
            (Some(first), Some(second)) => format!("{first} takes the first one, {second} the next"),
            (None, Some(second)) => format!("{second} takes the second one; the first one needs a file of its own"),
            _ => "split the file there, or put a remark into a comment line (# ...)".to_owned(),
        };
        let is_whole = is_long && !self.rows.go_on_in(&self.row, texts.len());
        Some(IngestError::content(
            Place::line(self.file, self.remnants.first().filter(|_| is_whole)?.line),
            format!("text below a table ({:?}), then a second table or curve", texts.first()?),
            "one table, or to be told which",
            hint,
        ))
    }

    /// Reads a line that is not in the plain form of a row.
    fn feed_line(&mut self, line: &[u8]) -> Result<()> {
        let is_nothing = is_blank_row(line) || line == [0x1A];
        if is_nothing || comment(line).is_some() {
            return Ok(());
        }
        let Layout { blank, trailing, columns, .. } = self.layout;
        if !blank.is_empty() || *trailing > 0 {
            let fields = self.layout.delimiter.split(line);
            let last = columns + blank.len()..columns + blank.len() + trailing;
            let is_filled = |k: usize| fields.get(k).is_some_and(|text| !unquoted(text).is_empty());
            self.rows.begins_late |= fields.len() == last.end && blank.iter().copied().chain(last).any(is_filled);
        }
        let place = Place::line(self.file, self.line);
        let Err(error) = careful_row(line, self.layout, &mut self.row, &place, &self.name) else {
            return self.push_row();
        };
        let text = || Remnant::Footer(decode(line.trim_ascii()).chars().take(40).collect());
        let is_in_text = self.remnants.last().is_some_and(|last| last.what != Remnant::Gap);
        let what = remnant(line, self.layout).or_else(|| is_in_text.then(text));
        let Some(what) = what.filter(|_| self.remnants.len() < REMNANTS) else {
            return Err(self.error.take().unwrap_or(error));
        };
        self.remnants.push(LeftOut { line: self.line, what });
        self.error.get_or_insert(error);
        Ok(())
    }

    /// Reads whole lines.
    fn feed(&mut self, text: &[u8]) -> Result<()> {
        let mut offset = 0;
        while offset < text.len() {
            if let Some(next) = plain_row(text, offset, self.layout, &mut self.row) {
                self.push_row()?;
                offset = next;
            } else {
                let (line, next) = line_at(text, offset, self.line, self.file)?;
                self.feed_line(line.bytes)?;
                offset = next;
            }
            self.line += 1;
        }
        Ok(())
    }
}

impl Rows {
    #[inline]
    fn push(&mut self, row: &[ParsedNumber], line: usize) {
        for ((column, digits), number) in self.columns.iter_mut().zip(&mut self.digits).zip(row) {
            column.push(number.value);
            *digits = (*digits).max(number.digits);
        }
        self.lines.push(line);
    }

    /// Adds the rows of a part whose lines are counted from `line`.
    fn append(&mut self, part: Self, line: usize) {
        for (column, of_part) in self.columns.iter_mut().zip(&part.columns) {
            column.extend_from_slice(of_part);
        }
        for (digits, of_part) in self.digits.iter_mut().zip(&part.digits) {
            *digits = (*digits).max(*of_part);
        }
        self.lines.append(&part.lines, line);
        self.begins_late |= part.begins_late;
    }
}

/// Most lines that may stand before the first row or after the last.
const REMNANTS: usize = 1000;

/// What a line is that is no row, if the record may begin after it or end before it: a row of gaps, with its time at
/// most, or text. A row that is cut short is neither.
fn remnant(line: &[u8], layout: &Layout) -> Option<Remnant> {
    let fields = layout.without_blanks(layout.delimiter.split(line));
    let is_number = |(k, text): (usize, &&[u8])| match layout.cells.get(k) {
        Some(Cells::Stamps(_)) => stamp(&decode(unquoted(text))).is_some(),
        _ => layout.style.field(text).is_some(),
    };
    let numbers = fields.iter().enumerate().filter(|cell| is_number(*cell)).count();
    let is_words = |k: usize| layout.cells.get(k) == Some(&Cells::Words) && numbers > 0;
    let gaps = fields.iter().enumerate().filter(|(k, text)| is_gap(text) || is_words(*k)).count();
    if numbers + gaps == fields.len() {
        let is_whole = fields.len() >= layout.columns;
        return (is_whole && numbers <= usize::from(layout.columns > 1)).then_some(Remnant::Gap);
    }
    let starts_with_text = fields.first().is_some_and(|first| !is_gap(first) && !is_number((0, first)));
    starts_with_text.then(|| Remnant::Footer(decode(line.trim_ascii()).chars().take(40).collect()))
}

/// A row in the plain form, and where the next line starts.
#[inline]
fn plain_row(text: &[u8], offset: usize, layout: &Layout, row: &mut [ParsedNumber]) -> Option<usize> {
    if layout.cells.iter().any(|cells| *cells != Cells::Numbers) {
        return None;
    }
    let Delimiter::Byte(delimiter) = layout.delimiter else { return plain_row_of_blanks(text, offset, layout, row) };
    if !layout.blank.is_empty() {
        return None;
    }
    let mut at = offset;
    let last = row.len() - 1;
    for (k, cell) in row.iter_mut().enumerate() {
        let (number, length) = scan(text.get(at..)?, layout.style.decimal)?;
        *cell = number;
        at += length;
        let delimiters = if k < last { 1 } else { layout.trailing };
        for _ in 0..delimiters {
            if text.get(at) != Some(&delimiter) {
                return None;
            }
            at += 1;
        }
    }
    end_of_line(text, at)
}

fn plain_row_of_blanks(text: &[u8], offset: usize, layout: &Layout, row: &mut [ParsedNumber]) -> Option<usize> {
    let mut at = offset;
    for cell in row.iter_mut() {
        let start = at;
        while matches!(text.get(at), Some(b' ' | b'\t')) {
            at += 1;
        }
        if at == start && at != offset {
            return None;
        }
        let (number, length) = scan(text.get(at..)?, layout.style.decimal)?;
        *cell = number;
        at += length;
    }
    end_of_line(text, at)
}

fn end_of_line(text: &[u8], at: usize) -> Option<usize> {
    match &text[at..] {
        [] => Some(at),
        [b'\n', ..] => Some(at + 1),
        [b'\r', b'\n', ..] => Some(at + 2),
        _ => None,
    }
}

/// What to do about names of columns that stand once more between the rows.
const REPEATED_HEADER: &str = "the names of the columns again: remove such lines between the rows";

fn repeats_header(line: &[u8], layout: &Layout) -> bool {
    layout.header.iter().any(|name| name.bytes.trim_ascii() == line.trim_ascii())
}

fn careful_row(
    line: &[u8],
    layout: &Layout,
    row: &mut [ParsedNumber],
    place: &Place,
    name: impl Fn(usize) -> String,
) -> Result<()> {
    let mut fields = layout.without_blanks(layout.delimiter.split(line));
    if fields.len() == row.len() + layout.trailing {
        fields.truncate(row.len());
    }
    while fields.len() > row.len() && fields.last().is_some_and(|f| unquoted(f).is_empty()) {
        fields.pop();
    }
    let columns = row.len();
    if fields.len() != columns {
        let mut found = format!("{} fields, the first row has {columns}", fields.len());
        let are_numbers = fields.iter().all(|text| layout.style.field(text).is_some());
        if layout.delimiter == Delimiter::Byte(b',') && fields.len() > columns && !line.contains(&b'.') && are_numbers {
            found.push_str(": decimal commas between comma-separated fields, perhaps");
            return Err(decimal_comma(place.clone(), found));
        }
        let hint = if repeats_header(line, layout) {
            REPEATED_HEADER
        } else {
            "the file may be cut short or damaged there: export it again, mend the line, or end the record above"
        };
        return refuse(
            place.clone(),
            found,
            format!("{columns} numbers separated by {}", layout.delimiter.name()),
            hint,
        );
    }
    let (mut numbers, mut gap) = (0, None);
    for (k, (cell, text)) in row.iter_mut().zip(&fields).enumerate() {
        let bare = unquoted(text);
        let number = match layout.cells[k] {
            Cells::Words => Some(GAP),
            Cells::Stamps(first) => {
                stamp(&decode(bare)).map(|time| ParsedNumber { value: time.since(first), digits: 1 })
            }
            Cells::Whole(first) => decode(bare)
                .parse::<i64>()
                .ok()
                .map(|whole| ParsedNumber { value: whole.wrapping_sub(first) as f64, digits: 19 }),
            Cells::Numbers => match scan(bare, layout.style.decimal) {
                Some((number, length)) if length == bare.len() => Some(number),
                _ => layout.style.field(bare),
            },
        };
        *cell = match number {
            Some(number) => number,
            None if is_gap(text) => {
                gap.get_or_insert(k);
                GAP
            }
            None => {
                return Err(no_number(line, layout, bare, place.clone().in_nth_column(k, &name(k))));
            }
        };
        numbers += usize::from(!cell.value.is_nan());
    }
    match gap.filter(|_| numbers <= usize::from(columns > 1)) {
        Some(k) => {
            let place = place.clone().in_nth_column(k, &name(k));
            Err(no_number(line, layout, unquoted(fields[k]), place))
        }
        None => Ok(()),
    }
}

/// Where no number is.
const GAP: ParsedNumber = ParsedNumber { value: f64::NAN, digits: 0 };

fn no_number(line: &[u8], layout: &Layout, bare: &[u8], place: Place) -> IngestError {
    let found = if bare.is_empty() {
        "an empty field".to_owned()
    } else {
        format!("{:?} is not a finite number", decode(&bare[..bare.len().min(40)]))
    };
    let hint = if is_gap(bare) {
        GAPS
    } else if repeats_header(line, layout) {
        REPEATED_HEADER
    } else if is_negative_of_accounts(bare) {
        "export negative numbers with their sign in front: -12.5"
    } else {
        "export it again, or write the number that belongs there: without its line the steps of time would not be equal"
    };
    IngestError::content(place, found, "a finite number in every field", hint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::table::layout::sniff;

    fn rows(text: &str) -> Result<Rows> {
        let layout = sniff(text.as_bytes(), "t.csv", 2)?;
        read(text.as_bytes(), &layout, "t.csv", |k| format!("c{k}"))
    }

    #[test]
    fn plain_and_awkward_rows_read_alike() {
        let awkward = "t,a\n0,1.5\r\n\n 1 , \"2.5\" \n# half time\n2,-3.5,\n";
        assert_eq!(rows(awkward).unwrap().columns, [[0.0, 1.0, 2.0], [1.5, 2.5, -3.5]]);
        assert_eq!(rows("0,5;1\n1,5;2\n").unwrap().columns, [[0.5, 1.5], [1.0, 2.0]]);
        assert_eq!(rows("  0.5   1\n\t1.5\t2  \n").unwrap().columns, [[0.5, 1.5], [1.0, 2.0]]);
    }

    #[test]
    fn no_row_is_taken_for_a_header_and_what_is_wrong_with_one_is_said_at_its_place() {
        for (text, said) in [
            ("t,a\n0,1\n1,NaN\n2,3\n", "t.csv, line 3, column 2 (c1): \"NaN\" is not a finite number"),
            ("t,a\n0,1\n1,\n2,3\n", "t.csv, line 3, column 2 (c1): an empty field"),
            ("t,a\n0,1\n1,2,2.5\n2,3\n3,4\n", "t.csv, line 3: 3 fields, the first row has 2"),
            ("t,a,b\n0,1,1\n1,2,2\n2,3,3\n3,4", "t.csv, line 5: 2 fields, the first row has 3"),
        ] {
            assert_eq!(rows(text).unwrap_err().to_string(), said);
        }
    }

    #[test]
    fn lines_are_counted_through_comments() {
        let rows = rows("# x\nt,a\n0,1\n\n1,2\n").unwrap();
        assert_eq!((rows.lines.of_row(0), rows.lines.of_row(1), rows.lines.of_row(2), rows.lines.len()), (3, 5, 0, 2));
    }

    fn many_rows() -> String {
        let remark = |k| if k % 90 == 7 { "# half time\n\n" } else { "" };
        (0..500).fold("# c\nt,a\n".to_owned(), |text, k| text + &format!("{k}.5,{}\n{}", k * k, remark(k)))
    }

    #[test]
    fn parts_read_at_once_give_the_same_rows_and_the_same_errors() {
        let text = many_rows();
        let layout = sniff(text.as_bytes(), "t.csv", 2).unwrap();
        let whole = rows(&text).unwrap();
        let broken = text.replace("400.5,160000", "400.5,x");
        let expected = rows(&broken).unwrap_err();
        for parts in [1, 2, 3, 7, 100, 5000] {
            let read = |text: &str| {
                let body = &text.as_bytes()[layout.first_row..];
                read_in_parts(body, &layout, "t.csv", |k| format!("c{k}"), parts)
            };
            let rows = read(&text).unwrap();
            assert_eq!((&rows.columns, &rows.digits), (&whole.columns, &whole.digits), "{parts}");
            let lines = |rows: &Rows| (0..=rows.lines.len()).map(|row| rows.lines.of_row(row)).collect::<Vec<_>>();
            assert_eq!(lines(&rows), lines(&whole), "{parts}");
            assert_eq!(read(&broken).unwrap_err(), expected, "{parts}");
        }
    }

    fn pieces(body: &[u8], piece: usize) -> Pieces<'_, &[u8]> {
        Pieces { source: body, length: body.len(), head: body, piece }
    }

    #[test]
    fn pieces_of_any_size_give_the_same_rows() {
        let text = many_rows() + "500.5,1";
        let whole = rows(&text).unwrap();
        let layout = sniff(text.as_bytes(), "t.csv", 2).unwrap();
        let body = &text.as_bytes()[layout.first_row..];
        for piece in [1, 7, 64, 1000, 1 << 20] {
            let mut told = 0;
            let rows = read_stream(pieces(body, piece), &layout, "t.csv", |k| format!("c{k}"), |n| told += n).unwrap();
            assert_eq!((&rows.columns, &rows.digits, &rows.lines), (&whole.columns, &whole.digits, &whole.lines));
            assert_eq!(told, body.len() as u64);
        }
        let broken = text.replace("400.5,160000", "400.5,x");
        let body = &broken.as_bytes()[layout.first_row..];
        let error = read_stream(pieces(body, 64), &layout, "t.csv", |k| format!("c{k}"), |_| {}).unwrap_err();
        assert_eq!(error, rows(&broken).unwrap_err());
    }
}
