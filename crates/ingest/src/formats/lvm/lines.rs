//! Lines of an LVM file, one after the other, split into fields.

use crate::formats::text::lines::{Line, decode, line_at};
use crate::{IngestError, Place};

/// A reading position between lines.
#[derive(Debug, Clone)]
pub struct Lines<'a> {
    file: &'a str,
    text: &'a [u8],
    offset: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    /// Starts at the first line.
    pub fn new(file: &'a str, text: &'a [u8]) -> Self {
        Self { file, text, offset: 0, number: 1 }
    }

    /// The next line, not taken. A line over 1 MiB is refused.
    pub fn peek(&self) -> Result<Option<Line<'a>>, IngestError> {
        Ok(self.line()?.map(|(line, _)| line))
    }

    /// Takes the next line.
    pub fn take(&mut self) -> Result<Option<Line<'a>>, IngestError> {
        let Some((line, next)) = self.line()? else { return Ok(None) };
        self.offset = next;
        self.number += 1;
        Ok(Some(line))
    }

    fn line(&self) -> Result<Option<(Line<'a>, usize)>, IngestError> {
        if self.offset >= self.text.len() {
            return Ok(None);
        }
        line_at(self.text, self.offset, self.number, self.file).map(Some)
    }

    /// The file's name.
    pub fn file(&self) -> &'a str {
        self.file
    }

    /// The place of the last line taken.
    pub fn place(&self) -> Place {
        Place::line(self.file, self.number.saturating_sub(1).max(1))
    }
}

/// Whether a line holds nothing but separators and blanks.
pub fn is_blank(line: &[u8]) -> bool {
    line.iter().all(|b| b.is_ascii_whitespace() || *b == b',')
}

/// Whether a line is the mark `***name***`.
pub fn is_mark(line: &[u8], name: &str) -> bool {
    line.trim_ascii_start().strip_prefix(b"***").is_some_and(|rest| {
        let rest = rest.to_ascii_lowercase();
        rest.strip_prefix(name.to_ascii_lowercase().as_bytes()).is_some_and(|rest| rest.starts_with(b"***"))
    })
}

/// The fields of a line as words.
pub fn words(line: &[u8], separator: u8) -> Vec<String> {
    line.split(|b| *b == separator).map(|field| decode(field.trim_ascii())).collect()
}
