//! The rows of a segment.

use crate::formats::lvm::header::{FileHeader, SegmentHeader, XColumns};
use crate::formats::lvm::lines::{Lines, is_blank};
use crate::formats::text::lines::decode;
use crate::formats::text::numbers;
use crate::{IngestError, Place};

/// The samples of each channel of a segment.
///
/// Channels may have different numbers of samples: the rows then end in empty fields. An empty field before a sample is
/// refused. The printed X are a check only: rounded to a microsecond, they must not leave the grid by half an interval.
pub fn read(
    lines: &mut Lines,
    file: &FileHeader,
    header: &SegmentHeader,
    decimal: u8,
) -> Result<Vec<Vec<f64>>, IngestError> {
    let channels = header.columns.len();
    let last_column = header.columns.last().copied().unwrap_or(0);
    let mut channel_of = vec![None; last_column + 1];
    for (k, column) in header.columns.iter().enumerate() {
        channel_of[*column] = Some(k);
    }
    let mut clocks: Vec<Option<Clock>> = header
        .columns
        .iter()
        .enumerate()
        .map(|(k, column)| match file.x_columns {
            XColumns::No => None,
            XColumns::One if k > 0 => None,
            _ => header.number("Delta_X", *column, decimal).filter(|dt| *dt > 0.0).map(Clock::new),
        })
        .collect();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); channels];
    let mut row = 0;
    while let Some(line) = lines.peek()? {
        let start = line.bytes.split(|b| *b == file.separator).next().unwrap_or_default();
        // Words in front: the next segment.
        if !start.trim_ascii().is_empty() && numbers::field(start, decimal).is_none() && !numbers::is_gap(start) {
            break;
        }
        lines.take()?;
        if is_blank(line.bytes) {
            continue;
        }
        let mut x = None;
        for (column, field) in line.bytes.split(|b| *b == file.separator).enumerate().take(last_column + 1) {
            let Some(k) = channel_of[column] else {
                x = numbers::field(field, decimal).map(|number| number.value);
                continue;
            };
            let field = numbers::unquoted(field);
            if field.is_empty() {
                continue;
            }
            let place = || {
                Place::line(lines.file(), line.number).in_column(format!("{} ({})", column + 1, header.titles[column]))
            };
            if values[k].len() < row {
                return Err(IngestError::content(
                    place(),
                    "a sample after empty fields",
                    "samples without gaps",
                    "cut the record before the gap, or fill it in the program that made it: gaps are not filled here",
                ));
            }
            let value = match numbers::field(field, decimal) {
                Some(number) => number.value,
                None if numbers::is_gap(field) => f64::NAN,
                None => {
                    return Err(IngestError::content(
                        place(),
                        format!("{:?} is not a finite number", decode(&field[..field.len().min(40)])),
                        "a finite number or nothing in every field",
                        "save the measurement again, or write the number that belongs there: without its line all \
                         later samples would come too early",
                    ));
                }
            };
            values[k].push(value);
            if let (Some(clock), Some(x)) = (&mut clocks[k], x)
                && let Some(expected) = clock.off(x, row)
            {
                return Err(IngestError::content(
                    place(),
                    format!("X is {x}, the row is at {expected} by X0 and Delta_X"),
                    "rows at equal steps of Delta_X",
                    "the recording was interrupted there, or several were saved under one header: split the file",
                ));
            }
        }
        row += 1;
    }
    Ok(values)
}

/// A printed X column against its interval.
struct Clock {
    dt: f64,
    first: Option<f64>,
}

impl Clock {
    fn new(dt: f64) -> Self {
        Self { dt, first: None }
    }

    /// The X that row `row` should have, if it is not near it.
    fn off(&mut self, x: f64, row: usize) -> Option<f64> {
        // X is printed to the microsecond, to seven digits where it is large; both ends are rounded. Where it starts is
        // not checked.
        let expected = *self.first.get_or_insert(x) + row as f64 * self.dt;
        let rounding = if expected.abs() < 1e6 { 1.1e-6 } else { 1.1e-6 * expected.abs() };
        let slack = 0.5 * self.dt + rounding;
        ((x - expected).abs() > slack).then_some(expected)
    }
}
