//! A signal file of an EV5 set: one sample a line, either `Y` or `X Y`; numbers may be in Fortran form.

use crate::formats::text::numbers::scan;
use crate::{IngestError, Place};

/// The numbers of a signal file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SignalFile {
    /// X column, empty where the file has none.
    pub x: Vec<f64>,
    /// Most significant digits printed in it.
    pub x_digits: u32,
    /// Y column.
    pub y: Vec<f64>,
}

/// Reads the file. The first line decides whether there is an X column.
pub fn parse(file: &str, bytes: &[u8]) -> Result<SignalFile, IngestError> {
    let mut signal = SignalFile { y: Vec::with_capacity(bytes.len() / 16), ..SignalFile::default() };
    for (index, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let line = line.trim_ascii();
        if line.is_empty() || line == [0x1A] {
            continue;
        }
        let refuse = |found: String| {
            IngestError::content(
                Place::line(file, index + 1),
                found,
                "one sample a line: its value, or its time and its value",
                "the file may be damaged: download the test again",
            )
        };
        let not_a_number = |rest: &[u8]| {
            let word: String = String::from_utf8_lossy(&rest[..rest.len().min(30)]).into_owned();
            refuse(format!("{word:?} is not a finite number"))
        };
        let (first, length) = scan(line, b'.').ok_or_else(|| not_a_number(line))?;
        let rest = &line[length..];
        let second = rest.trim_ascii_start();
        let second = second.strip_prefix(b",").unwrap_or(second).trim_ascii_start();
        let has_x = !second.is_empty();
        if has_x && second.len() == rest.len() {
            return Err(not_a_number(line));
        }
        if !signal.y.is_empty() && has_x == signal.x.is_empty() {
            return Err(refuse(format!(
                "{} numbers, the lines above have {}",
                1 + usize::from(has_x),
                2 - usize::from(has_x)
            )));
        }
        if has_x {
            let (value, length) = scan(second, b'.').ok_or_else(|| not_a_number(second))?;
            if length != second.len() {
                return Err(not_a_number(second));
            }
            signal.x.push(first.value);
            signal.x_digits = signal.x_digits.max(first.digits);
            signal.y.push(value.value);
        } else {
            signal.y.push(first.value);
        }
    }
    if signal.y.len() < 2 {
        return Err(IngestError::content(
            Place::file(file),
            format!("{} samples", signal.y.len()),
            "one sample a line",
            "the file may be cut short: download the test again",
        ));
    }
    Ok(signal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_and_fortran_numbers() {
        let xy = parse("v.001", b"-0.050000\t0.114681\r\n-0.049900\t-.306171E+00\r\n").unwrap();
        assert_eq!((xy.x, xy.y, xy.x_digits), (vec![-0.05, -0.0499], vec![0.114_681, -0.306_171], 5));
        let y = parse("v.001", b"  -.206786E-02\n0.285321E-01\n").unwrap();
        assert_eq!((y.x, y.y), (vec![], vec![-0.002_067_86, 0.028_532_1]));
    }

    #[test]
    fn errors_name_the_line() {
        let error = |bytes: &[u8]| parse("v.001", bytes).unwrap_err().to_string();
        assert_eq!(error(b"0 1\n1 x\n"), "v.001, line 2: \"x\" is not a finite number");
        assert_eq!(error(b"0 1\n1\n"), "v.001, line 2: 1 numbers, the lines above have 2");
        assert_eq!(error(b"0 1 2\n"), "v.001, line 1: \"1 2\" is not a finite number");
        assert_eq!(error(b""), "v.001: 0 samples");
    }
}
