//! A channel file: keyword lines, then one sample a line.

use crate::formats::iso_mme::header::Header;
use crate::formats::text::lines::{decode, line_at, without_mark};
use crate::formats::text::numbers::{field, is_gap};
use crate::{IngestError, Place};

/// A channel file, its samples as written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChannelFile {
    /// Keyword lines.
    pub header: Header,
    /// Samples; gaps (`NOVALUE`) at the ends are left off.
    pub samples: Vec<f64>,
    /// Gaps left off before the first sample.
    pub gaps_before: usize,
    /// Gaps left off after the last.
    pub gaps_after: usize,
    /// Header lines that are neither keyword nor number.
    pub odd_lines: Vec<usize>,
    /// Samples after those that the header announces, left off.
    pub surplus: usize,
    /// Line of the first number with a decimal comma.
    pub decimal_comma: Option<usize>,
}

impl ChannelFile {
    /// Reads a file. The header ends at the first line without a colon that is a number or `NOVALUE`.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, IngestError> {
        let text = without_mark(bytes);
        let mut parsed = Self::default();
        let (mut offset, mut number, mut in_header) = (0, 1, true);
        let mut first_blank = None;
        // Gaps since the last number: at the end they are left off, before a number they are an error.
        let mut gap: Option<(usize, usize)> = None;
        while offset < text.len() {
            let (line, next) = line_at(&text, offset, number, file)?;
            let bytes = line.bytes.trim_ascii();
            let at = number;
            (offset, number) = (next, number + 1);
            if bytes.is_empty() || bytes == [0x1A] {
                first_blank = first_blank.or((!in_header).then_some(at));
                continue;
            }
            let value = sample(bytes);
            if in_header {
                if value.is_none() {
                    if !parsed.header.push(file, at, bytes)? {
                        parsed.odd_lines.push(at);
                    }
                    continue;
                }
                in_header = false;
            }
            if let Some(blank) = first_blank {
                return Err(damaged(file, blank, "a blank line between the samples".to_owned()));
            }
            match value {
                Some(Sample::Number(x, comma)) => {
                    if let Some((line, count)) = gap.take() {
                        if !parsed.samples.is_empty() {
                            return Err(inner_gap(file, line, count));
                        }
                        parsed.gaps_before = count;
                    }
                    if comma && parsed.decimal_comma.is_none() {
                        parsed.decimal_comma = Some(at);
                    }
                    parsed.samples.push(x);
                }
                Some(Sample::Gap) => gap = Some(gap.map_or((at, 1), |(line, count)| (line, count + 1))),
                None => {
                    let start = decode(&bytes[..bytes.len().min(40)]);
                    return Err(damaged(file, at, format!("{start:?} is not a finite number")));
                }
            }
        }
        parsed.gaps_after = gap.map_or(0, |(_, count)| count);
        if parsed.samples.is_empty() {
            let found = if parsed.gaps_after > 0 { "nothing but NOVALUE" } else { "no samples" };
            return Err(IngestError::content(
                Place::line(file, number.saturating_sub(1).max(1)),
                found,
                "a header, then one number a line",
                "the channel holds no data: choose another, or export the test again",
            ));
        }
        parsed.keep_announced();
        Ok(parsed)
    }

    /// Leaves off what comes after the announced number of samples, gaps included.
    fn keep_announced(&mut self) {
        let count = self.gaps_before + self.samples.len() + self.gaps_after;
        let Some(announced) = self.header.number("number of samples").filter(|n| *n >= 1.0 && n.fract() == 0.0) else {
            return;
        };
        // A count inside the gaps before the first sample would leave nothing.
        if announced < count as f64 && announced as usize > self.gaps_before {
            self.surplus = count - announced as usize;
            let of_samples = self.surplus.saturating_sub(self.gaps_after);
            self.gaps_after = self.gaps_after.saturating_sub(self.surplus);
            self.samples.truncate(self.samples.len() - of_samples);
        }
    }
}

enum Sample {
    /// A number, and whether it has a decimal comma.
    Number(f64, bool),
    Gap,
}

fn sample(bytes: &[u8]) -> Option<Sample> {
    if let Some(number) = field(bytes, b'.') {
        return Some(Sample::Number(number.value, false));
    }
    if let Some(number) = field(bytes, b',') {
        return Some(Sample::Number(number.value, true));
    }
    (is_gap(bytes) && !bytes.contains(&b':')).then_some(Sample::Gap)
}

fn damaged(file: &str, line: usize, found: String) -> IngestError {
    IngestError::content(
        Place::line(file, line),
        found,
        "one finite number a line, or NOVALUE",
        "the file may be damaged there: export the test again",
    )
}

fn inner_gap(file: &str, line: usize, count: usize) -> IngestError {
    IngestError::content(
        Place::line(file, line),
        format!("{count} samples are NOVALUE, with numbers before and after"),
        "samples without gaps",
        "cut the record before the gap, or fill it in the program that made it: gaps are not filled here",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_ends_at_the_first_number() {
        let text = b"Channel code :X\nan odd line\nUnit :g\n\n-1.42109e-013\r\n+1.234560E+01 \n 3 \n\n \n";
        let file = ChannelFile::parse("a.001", text).unwrap();
        assert_eq!(file.samples, [-1.421_09e-13, 12.3456, 3.0]);
        assert_eq!((file.odd_lines.as_slice(), file.header.text("unit")), (&[2][..], Some("g")));
    }

    #[test]
    fn gaps_at_the_ends_are_left_off_and_inside_refused() {
        let file = ChannelFile::parse("a.001", b"Unit :g\nNOVALUE  \nNOVALUE\n1\n2,5\nNOVALUE\n").unwrap();
        assert_eq!((file.samples.as_slice(), file.gaps_before, file.gaps_after), (&[1.0, 2.5][..], 2, 1));
        assert_eq!(file.decimal_comma, Some(5));
        let error = ChannelFile::parse("a.001", b"Unit :g\n1\nNOVALUE\nNOVALUE\n2\n").unwrap_err();
        assert_eq!(error.to_string(), "a.001, line 3: 2 samples are NOVALUE, with numbers before and after");
    }

    #[test]
    fn damage_is_found_at_its_line() {
        let refused = |text: &[u8]| ChannelFile::parse("a.001", text).unwrap_err().to_string();
        assert_eq!(refused(b"Unit :g\n1\n2\nx\n"), "a.001, line 4: \"x\" is not a finite number");
        assert_eq!(refused(b"Unit :g\n1\n\n2\n"), "a.001, line 3: a blank line between the samples");
        assert_eq!(refused(b"Unit :g\n"), "a.001, line 1: no samples");
        assert_eq!(refused(b"Unit :g\nNOVALUE\n"), "a.001, line 2: nothing but NOVALUE");
    }
}
