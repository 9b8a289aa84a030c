//! The rows of a table: numbers by columns.

use std::io::Read;

use rayon::prelude::*;

use crate::formats::table::layout::{Delimiter, Layout, decimal_comma};
use crate::formats::text::lines::{LINE_LIMIT, comment, decode, line_at};
use crate::formats::text::numbers::{ParsedNumber, field, is_gap, scan, unquoted};
use crate::{IngestError, Place};

/// The numbers of a table.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// One vector a column, all of one length.
    pub columns: Vec<Vec<f64>>,
    /// Most significant digits printed in each column.
    pub digits: Vec<u32>,
    /// Line number of each row.
    pub lines: LineNumbers,
}

/// Line numbers of rows, as runs of rows on consecutive lines: a few bytes for a table without comments, however long.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LineNumbers {
    /// First row of a run, and its line.
    runs: Vec<(usize, usize)>,
    rows: usize,
}

impl LineNumbers {
    /// Adds a row.
    #[inline]
    fn push(&mut self, line: usize) {
        let follows = self.runs.last().is_some_and(|(row, first)| first + (self.rows - row) == line);
        if !follows {
            self.runs.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// Adds the rows of a part whose lines are counted from `line`.
    fn append(&mut self, part: &Self, line: usize) {
        for (k, (row, first)) in part.runs.iter().enumerate() {
            let end = part.runs.get(k + 1).map_or(part.rows, |next| next.0);
            self.push(line + first);
            self.rows += end - row - 1;
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// The line of a row; 0 past the end.
    pub fn of_row(&self, row: usize) -> usize {
        let run = self.runs.partition_point(|(first, _)| *first <= row);
        self.runs.get(run.wrapping_sub(1)).filter(|_| row < self.rows).map_or(0, |(first, line)| line + (row - first))
    }
}

/// Reads all rows of a text in memory. `name(k)` names column `k` in messages.
///
/// A row in the plain form (numbers, single delimiters) is read straight from the bytes; any other line is taken apart
/// field by field, which also finds the place of what is wrong.
pub fn read(text: &[u8], layout: &Layout, file: &str, name: impl Fn(usize) -> String) -> Result<Rows, IngestError> {
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
) -> Result<Rows, IngestError> {
    let most_rows = (1 << 24) / layout.columns;
    let pieces = whole_lines(body, parts);
    if let [first, others @ ..] = &pieces[..]
        && !others.is_empty()
    {
        let read = |piece: &[u8], line: usize, length: usize| {
            let mut parser = Parser::new(layout, length, piece, most_rows, file, |_: usize| String::new());
            parser.line = line;
            parser.feed(piece).ok().map(|()| (parser.rows, parser.line))
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
    Ok(parser.rows)
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
    /// Its start.
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
) -> Result<Rows, IngestError> {
    let mut parser = Parser::new(layout, from.length, from.head, usize::MAX, file, name);
    let mut buffer = Vec::with_capacity(from.piece + LINE_LIMIT);
    loop {
        let before = buffer.len();
        let got = (&mut from.source).take(from.piece as u64).read_to_end(&mut buffer).map_err(|error| {
            IngestError::content(
                Place::file(file),
                error.to_string(),
                "a readable file",
                "check the disk and try again",
            )
        })?;
        if got == 0 {
            parser.feed(&buffer)?;
            return Ok(parser.rows);
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
            digits: vec![0; columns],
            lines: LineNumbers::default(),
        };
        let row = vec![ParsedNumber { value: 0.0, digits: 0 }; columns];
        Self { layout, file, name, rows, row, line: layout.first_line }
    }

    /// Reads whole lines.
    fn feed(&mut self, text: &[u8]) -> Result<(), IngestError> {
        let mut offset = 0;
        while offset < text.len() {
            if let Some(next) = plain_row(text, offset, self.layout, &mut self.row) {
                self.rows.push(&self.row, self.line);
                offset = next;
            } else {
                let (line, next) = line_at(text, offset, self.line, self.file)?;
                if !line.bytes.trim_ascii().is_empty() && comment(line.bytes).is_none() && line.bytes != [0x1A] {
                    let place = Place::line(self.file, self.line);
                    careful_row(line.bytes, self.layout, &mut self.row, &place, &self.name)?;
                    self.rows.push(&self.row, self.line);
                }
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
    }
}

/// A row in the plain form, and where the next line starts.
#[inline]
fn plain_row(text: &[u8], offset: usize, layout: &Layout, row: &mut [ParsedNumber]) -> Option<usize> {
    let Delimiter::Byte(delimiter) = layout.delimiter else { return plain_row_of_blanks(text, offset, layout, row) };
    let mut at = offset;
    let last = row.len() - 1;
    for (k, cell) in row.iter_mut().enumerate() {
        let (number, length) = scan(text.get(at..)?, layout.decimal)?;
        *cell = number;
        at += length;
        if k < last || layout.trailing {
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
        let (number, length) = scan(text.get(at..)?, layout.decimal)?;
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

fn careful_row(
    line: &[u8],
    layout: &Layout,
    row: &mut [ParsedNumber],
    place: &Place,
    name: impl Fn(usize) -> String,
) -> Result<(), IngestError> {
    let mut fields = layout.delimiter.split(line);
    while fields.len() > row.len() && fields.last().is_some_and(|f| unquoted(f).is_empty()) {
        fields.pop();
    }
    let columns = row.len();
    if fields.len() != columns {
        let found = format!("{} fields, the first row has {columns}", fields.len());
        if layout.delimiter == Delimiter::Byte(b',') && fields.len() > columns && !line.contains(&b'.') {
            return Err(decimal_comma(
                place.clone(),
                format!("{found}: decimal commas between comma-separated fields, perhaps"),
            ));
        }
        return Err(IngestError::content(
            place.clone(),
            found,
            format!("{columns} numbers separated by {}", layout.delimiter.name()),
            "the file may be cut short or damaged there: export it again, or remove the line",
        ));
    }
    for (k, (cell, text)) in row.iter_mut().zip(&fields).enumerate() {
        let bare = unquoted(text);
        match scan(bare, layout.decimal) {
            Some((number, length)) if length == bare.len() => *cell = number,
            _ if let Some(number) = field(bare, layout.decimal) => *cell = number,
            _ => {
                let place = place.clone().in_column(format!("{} ({})", k + 1, name(k)));
                let found = if bare.is_empty() {
                    "an empty field".to_owned()
                } else {
                    format!("{:?} is not a finite number", decode(&bare[..bare.len().min(40)]))
                };
                let hint = if is_gap(text) {
                    "cut the record before the gap, or fill it in the program that made it: gaps are not filled here"
                } else {
                    "export it again, or remove the line"
                };
                return Err(IngestError::content(place, found, "a finite number in every field", hint));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::table::layout::sniff;

    fn rows(text: &str) -> Result<Rows, IngestError> {
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
    fn a_nan_is_refused_at_its_place() {
        let error = rows("t,a\n0,1\n1,NaN\n2,3\n").unwrap_err();
        assert_eq!(error.to_string(), "t.csv, line 3, column 2 (c1): \"NaN\" is not a finite number");
        let error = rows("t,a\n0,1\n1,\n2,3\n").unwrap_err().to_string();
        assert!(error.starts_with("t.csv, line 3"), "{error}");
    }

    #[test]
    fn no_row_is_taken_for_a_header() {
        let error = rows("t,a\n0,1\n1,2,2.5\n2,3\n3,4\n").unwrap_err();
        assert_eq!(error.to_string(), "t.csv, line 3: 3 fields, the first row has 2");
    }

    #[test]
    fn a_cut_row_is_refused_at_its_line() {
        let error = rows("t,a,b\n0,1,1\n1,2,2\n2,3,3\n3,4").unwrap_err();
        assert_eq!(error.to_string(), "t.csv, line 5: 2 fields, the first row has 3");
    }

    #[test]
    fn lines_are_counted_through_comments() {
        let rows = rows("# x\nt,a\n0,1\n\n1,2\n").unwrap();
        assert_eq!((rows.lines.of_row(0), rows.lines.of_row(1), rows.lines.of_row(2), rows.lines.len()), (3, 5, 0, 2));
    }

    #[test]
    fn parts_read_at_once_give_the_same_rows_and_the_same_errors() {
        let mut text = "# c\nt,a\n".to_owned();
        for k in 0..500 {
            text.push_str(&format!("{k}.5,{}\n{}", k * k, if k % 90 == 7 { "# half time\n\n" } else { "" }));
        }
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
        let mut text = "# c\nt,a\n".to_owned();
        for k in 0..500 {
            text.push_str(&format!("{k}.5,{}\n{}", k * k, if k % 90 == 7 { "# half time\n\n" } else { "" }));
        }
        text.push_str("500.5,1");
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
