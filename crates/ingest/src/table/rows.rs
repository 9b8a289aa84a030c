//! The rows of a table: numbers by columns.

use super::layout::{Delimiter, Layout, decimal_comma};
use super::numbers::{Number, is_gap, scan, unquoted};
use super::text::{comment, decode, line_at};
use crate::{IngestError, Place};

/// The numbers of a table.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// One vector a column, all of one length.
    pub columns: Vec<Vec<f64>>,
    /// Most significant digits printed in each column.
    pub digits: Vec<u32>,
    /// Line number of each row.
    pub lines: Vec<u32>,
}

/// Reads all rows. `name(k)` names column `k` in messages.
///
/// A row in the plain form (numbers, single delimiters) is read straight from the bytes; any other line is taken apart
/// field by field, which also finds the place of what is wrong.
pub fn read(text: &[u8], layout: &Layout, file: &str, name: impl Fn(usize) -> String) -> Result<Rows, IngestError> {
    let columns = layout.columns;
    // The first row tells how many there will be, near enough to spare most of the growth.
    let first_length = text[layout.first_row..].iter().position(|b| *b == b'\n').unwrap_or(0) + 1;
    let expected_rows = ((text.len() - layout.first_row) / first_length + 1).min((1 << 24) / columns);
    let mut rows = Rows {
        columns: (0..columns).map(|_| Vec::with_capacity(expected_rows)).collect(),
        digits: vec![0; columns],
        lines: Vec::with_capacity(expected_rows),
    };
    let mut row = vec![Number { value: 0.0, digits: 0 }; columns];
    let (mut offset, mut number) = (layout.first_row, layout.first_line);
    while offset < text.len() {
        if let Some(next) = plain_row(text, offset, layout, &mut row) {
            rows.push(&row, number);
            offset = next;
        } else {
            let (line, next) = line_at(text, offset, number, file)?;
            if !line.bytes.trim_ascii().is_empty() && comment(line.bytes).is_none() && line.bytes != [0x1A] {
                careful_row(line.bytes, layout, &mut row, &Place::line(file, number), &name)?;
                rows.push(&row, number);
            }
            offset = next;
        }
        number += 1;
    }
    Ok(rows)
}

impl Rows {
    fn push(&mut self, row: &[Number], line: usize) {
        for ((column, digits), number) in self.columns.iter_mut().zip(&mut self.digits).zip(row) {
            column.push(number.value);
            *digits = (*digits).max(number.digits);
        }
        self.lines.push(u32::try_from(line).unwrap_or(u32::MAX));
    }
}

/// A row in the plain form, and where the next line starts.
#[inline]
fn plain_row(text: &[u8], offset: usize, layout: &Layout, row: &mut [Number]) -> Option<usize> {
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

fn plain_row_of_blanks(text: &[u8], offset: usize, layout: &Layout, row: &mut [Number]) -> Option<usize> {
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
    row: &mut [Number],
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
    use super::super::layout::sniff;
    use super::*;

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
        assert_eq!(rows.lines, [3, 5]);
    }
}
