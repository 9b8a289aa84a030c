//! How a table is written: delimiter, decimal mark, header lines, number of columns.

use crate::formats::text::lines::{Line, comment, decode, line_at};
use crate::formats::text::numbers::{field, is_gap, unquoted};
use crate::{IngestError, Place};

/// Lines looked at, comments and blank lines aside.
const SAMPLE_LINES: usize = 120;
/// Lines looked at in all.
const LINES_LOOKED_AT: usize = 10_000;
/// Rows after the first that must agree with it.
const AGREEING_ROWS: usize = 3;
/// More columns than this are taken for a mistake.
const COLUMN_LIMIT: usize = 4096;

/// What stands between fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delimiter {
    /// One byte: tab, semicolon, comma.
    Byte(u8),
    /// Any run of blanks and tabs.
    Blanks,
}

impl Delimiter {
    /// In words, for messages.
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

/// How a table is written, and the lines before its rows.
#[derive(Debug, Clone)]
pub struct Layout<'a> {
    /// Between fields.
    pub delimiter: Delimiter,
    /// `.` or `,`.
    pub decimal: u8,
    /// Fields of a row that hold numbers.
    pub columns: usize,
    /// Rows end in a delimiter with nothing behind it.
    pub trailing: bool,
    /// Offset of the first row.
    pub first_row: usize,
    /// Line number of the first row.
    pub first_line: usize,
    /// Comment lines before the rows, marks removed.
    pub comments: Vec<Line<'a>>,
    /// Other lines before the rows: names, units, or free text.
    pub header: Vec<Line<'a>>,
}

/// The ways a table is written, most particular first.
const WAYS: [(Delimiter, u8); 8] = [
    (Delimiter::Byte(b'\t'), b'.'),
    (Delimiter::Byte(b'\t'), b','),
    (Delimiter::Byte(b';'), b'.'),
    (Delimiter::Byte(b';'), b','),
    (Delimiter::Byte(b','), b'.'),
    (Delimiter::Blanks, b'.'),
    (Delimiter::Blanks, b','),
    // Every number in quotes: "0,0001","-1,5".
    (Delimiter::Byte(b','), b','),
];

/// Fields of a row, and whether the last is empty; `None` where something else than numbers stands. `NaN` and gaps
/// count as numbers here, so that they are refused at their place and not taken for names.
fn row_shape(line: &[u8], delimiter: Delimiter, decimal: u8) -> Option<(usize, bool)> {
    let fields = delimiter.split(line);
    let numbers = fields.iter().filter(|text| field(text, decimal).is_some()).count();
    let gaps = fields.iter().filter(|text| is_gap(text)).count();
    let trailing = fields.len() > 1 && fields.last().is_some_and(|f| unquoted(f).is_empty());
    (numbers > 0 && numbers + gaps == fields.len()).then_some((fields.len(), trailing))
}

/// The first row under a way of writing: its index, the columns, and whether rows end in an empty field. Lines with one
/// number before it are text. `agree` asks the next rows to have as many fields.
fn first_row(shapes: &[Option<(usize, bool)>], agree: bool, least: usize) -> Option<(usize, usize, bool)> {
    let first = shapes.iter().position(|shape| shape.is_some_and(|(fields, _)| fields >= least))?;
    let (fields, _) = shapes[first]?;
    let rows = || shapes[first..].iter().take(AGREEING_ROWS);
    if agree && !rows().all(|shape| shape.is_some_and(|(other, _)| other == fields)) {
        return None;
    }
    let trailing = rows().flatten().all(|(_, trailing)| *trailing);
    Some((first, fields - usize::from(trailing), trailing))
}

/// Looks at the first lines of a table and says how it is written. Rows have `least` columns and more.
pub fn sniff<'a>(text: &'a [u8], file: &str, least: usize) -> Result<Layout<'a>, IngestError> {
    let mut comments: Vec<(usize, Line<'a>)> = Vec::new();
    let mut lines: Vec<Line<'a>> = Vec::new();
    let (mut offset, mut number) = (0, 1);
    while offset < text.len() && lines.len() < SAMPLE_LINES && number <= LINES_LOOKED_AT {
        let (line, next) = line_at(text, offset, number, file)?;
        if let Some(words) = comment(line.bytes) {
            comments.push((lines.len(), Line { bytes: words, ..line }));
        } else if !line.bytes.trim_ascii().is_empty() {
            lines.push(line);
        }
        (offset, number) = (next, number + 1);
    }
    let shapes_by_way: Vec<Vec<_>> = WAYS
        .iter()
        .map(|(delimiter, decimal)| lines.iter().map(|line| row_shape(line.bytes, *delimiter, *decimal)).collect())
        .collect();
    let single_column = lines
        .iter()
        .enumerate()
        .find(|(k, _)| shapes_by_way.iter().any(|shapes: &Vec<Option<(usize, bool)>>| shapes[*k].is_some()))
        .map(|(_, line)| line.number);
    // The way that sees the earliest row, so that no row is taken for text; of several the one whose rows agree.
    let best = WAYS
        .iter()
        .zip(&shapes_by_way)
        .flat_map(|(way, shapes)| [true, false].map(|agree| (way, agree, first_row(shapes, agree, least))))
        .filter_map(|(way, agree, row)| row.filter(|(_, columns, _)| *columns >= least).map(|row| (way, agree, row)))
        .min_by_key(|(_, agree, (first, ..))| (*first, !agree));
    if let Some(((delimiter, decimal), _, (first, columns, trailing))) = best {
        let (delimiter, decimal) = (*delimiter, *decimal);
        if columns > COLUMN_LIMIT {
            return Err(IngestError::TooLarge {
                place: Place::line(file, lines[first].number),
                found: format!("{columns} columns"),
                limit: format!("at most {COLUMN_LIMIT} columns, one sample a row"),
            });
        }
        let layout = Layout {
            delimiter,
            decimal,
            columns,
            trailing,
            first_row: lines[first].offset,
            first_line: lines[first].number,
            comments: comments.iter().filter(|(before, _)| *before <= first).map(|(_, line)| *line).collect(),
            header: lines[..first].to_vec(),
        };
        refuse_broken_decimal_commas(&layout, &lines[first..], file)?;
        return Ok(layout);
    }
    if lines.is_empty() && offset < text.len() {
        return Err(IngestError::TooLarge {
            place: Place::line(file, number),
            found: format!("{LINES_LOOKED_AT} lines of comments and blanks, and no row yet"),
            limit: format!("the first row within the first {LINES_LOOKED_AT} lines: leave comment lines out"),
        });
    }
    Err(no_rows(&lines, single_column, file))
}

/// `0,0001,-1,23`: a decimal comma in a table whose delimiter is the comma as well cannot be read back.
fn refuse_broken_decimal_commas(layout: &Layout, rows: &[Line], file: &str) -> Result<(), IngestError> {
    let whole_numbers = || {
        rows.iter().all(|row| !row.bytes.contains(&b'.') && !row.bytes.contains(&b'e') && !row.bytes.contains(&b'E'))
    };
    if (layout.delimiter, layout.decimal) != (Delimiter::Byte(b','), b'.') || layout.columns < 3 || !whole_numbers() {
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
    const EXPECTED: &str = "rows of numbers: a time column and at least one acceleration column";
    if let Some(line) = single_column {
        return IngestError::content(
            Place::line(file, line),
            "one number in a row",
            EXPECTED,
            "export the time column too, or state --sample-time; a signal file of an NHTSA test is read by giving its \
             .EV5 file",
        );
    }
    if let Some(error) = text_column(lines, file) {
        return error;
    }
    let Some(first) = lines.first() else {
        return IngestError::content(
            Place::file(file),
            "nothing but comments and blank lines",
            EXPECTED,
            "check that the export is complete",
        );
    };
    let start: String = decode(&first.bytes[..first.bytes.len().min(60)]);
    IngestError::content(
        Place::line(file, first.number),
        format!("no rows of numbers in the first {} lines, which start {:?}", lines.len(), start.trim()),
        EXPECTED,
        "export the record as CSV with one sample a row",
    )
}

/// Rows that would be rows of numbers but for words in some column: which one, where, and what to do.
fn text_column(lines: &[Line], file: &str) -> Option<IngestError> {
    /// Rows that must look alike: as many fields, numbers and words in the same columns.
    const ALIKE: usize = 5;
    let shape = |line: &Line, (delimiter, decimal): (Delimiter, u8)| -> Vec<bool> {
        delimiter.split(line.bytes).iter().map(|f| field(f, decimal).is_some() || is_gap(f)).collect()
    };
    WAYS.into_iter().find_map(|way| {
        let shapes: Vec<Vec<bool>> = lines.iter().map(|line| shape(line, way)).collect();
        // One number at least, or it is prose.
        let is_row = |shape: &[bool]| shape.contains(&true) && shape.contains(&false);
        let first =
            shapes.windows(ALIKE).position(|rows| is_row(&rows[0]) && rows.iter().all(|row| *row == rows[0]))?;
        let column = shapes[first].iter().position(|number| !number)?;
        let text = decode(unquoted(way.0.split(lines[first].bytes)[column]));
        let names =
            first.checked_sub(1).map(|k| way.0.split(lines[k].bytes)).filter(|n| n.len() == shapes[first].len());
        let number = column + 1;
        let title = names.map_or_else(|| number.to_string(), |n| format!("{number} ({})", decode(unquoted(n[column]))));
        let is_clock = text.contains(':') && text.bytes().any(|b| b.is_ascii_digit());
        Some(IngestError::content(
            Place::line(file, lines[first].number).in_column(title),
            format!("text in a row of numbers: {:?}", text.chars().take(40).collect::<String>()),
            "numbers in every column",
            if is_clock {
                "export the time in seconds from the start, not as a time of day, or leave the column out and state \
                 --sample-time"
            } else {
                "leave the column of text out of the export, or move what it says into comment lines (# ...)"
            },
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(text: &str) -> (&'static str, char, usize, usize) {
        let layout = sniff(text.as_bytes(), "t.csv", 2).unwrap();
        (layout.delimiter.name(), char::from(layout.decimal), layout.columns, layout.header.len())
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
