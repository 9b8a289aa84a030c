//! The header of an LVM file and those of its segments.

use std::collections::BTreeMap;

use crate::IngestError;
use crate::formats::lvm::lines::{Lines, is_blank, is_mark, words};
use crate::formats::text::numbers;

/// How many X columns the rows have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum XColumns {
    /// The first field is empty.
    No,
    /// The first field, for all channels.
    One,
    /// One before each channel.
    Multi,
}

/// What the file's header says.
#[derive(Debug, Clone)]
pub struct FileHeader {
    /// Tab or comma.
    pub separator: u8,
    /// The decimal mark, if stated. Files of Writer_Version 0.92 do not.
    pub decimal: Option<u8>,
    /// X columns.
    pub x_columns: XColumns,
    /// All keys with their first value.
    pub keys: BTreeMap<String, String>,
}

/// What a segment's header says: values by key, by column of the rows (0 is the key's own).
#[derive(Debug, Clone, Default)]
pub struct SegmentHeader {
    /// Values of each key.
    pub keys: BTreeMap<String, Vec<String>>,
    /// Titles of the columns.
    pub titles: Vec<String>,
    /// Columns of the channels.
    pub columns: Vec<usize>,
}

/// Reads up to the first `***End_of_Header***`.
pub fn file_header(lines: &mut Lines) -> Result<FileHeader, IngestError> {
    let mut keys = BTreeMap::new();
    let mut after_key = None;
    lines.take()?;
    loop {
        let Some(line) = lines.take()? else { return Err(no_end(lines)) };
        if is_mark(line.bytes, "End_of_Header") {
            break;
        }
        // Which of both it is, the header says itself.
        let Some(end) = line.bytes.iter().position(|b| matches!(b, b'\t' | b',')) else { continue };
        after_key.get_or_insert(line.bytes[end]);
        let separator = line.bytes[end];
        let [key, value] = [&line.bytes[..end], &line.bytes[end + 1..]];
        let value = value.strip_suffix(&[separator]).unwrap_or(value);
        keys.entry(crate::formats::text::lines::decode(key.trim_ascii()))
            .or_insert_with(|| crate::formats::text::lines::decode(value.trim_ascii()));
    }
    let key = |name: &str| keys.get(name).map(String::as_str).unwrap_or_default();
    let separator = match key("Separator") {
        "Tab" => b'\t',
        "Comma" => b',',
        _ => after_key.unwrap_or(b'\t'),
    };
    // With commas for both, the value of the key is between two separators.
    let decimal = match key("Decimal_Separator") {
        "." => Some(b'.'),
        "," => Some(b','),
        "" if keys.contains_key("Decimal_Separator") && separator == b'\t' => Some(b','),
        _ => None,
    };
    if separator == b',' && decimal == Some(b',') {
        return Err(IngestError::content(
            lines.place(),
            "decimal commas between commas",
            "another decimal mark than the separator",
            "save the measurement with tabs between the columns",
        ));
    }
    let x_columns = match key("X_Columns") {
        "No" => XColumns::No,
        "Multi" => XColumns::Multi,
        _ => XColumns::One,
    };
    Ok(FileHeader { separator, decimal, x_columns, keys })
}

/// Reads the header of the next segment and the line of titles below; `None` at the end of the file.
pub fn segment_header(lines: &mut Lines, file: &FileHeader) -> Result<Option<SegmentHeader>, IngestError> {
    let mut header = SegmentHeader::default();
    loop {
        let Some(line) = lines.take()? else {
            return if header.keys.is_empty() { Ok(None) } else { Err(no_end(lines)) };
        };
        if is_mark(line.bytes, "End_of_Header") {
            break;
        }
        if is_mark(line.bytes, "Start_Special") {
            while let Some(line) = lines.take()?
                && !is_mark(line.bytes, "End_Special")
            {}
            continue;
        }
        if is_blank(line.bytes) {
            continue;
        }
        let fields = words(line.bytes, file.separator);
        header.keys.insert(fields[0].clone(), fields);
    }
    header.titles = match lines.take()? {
        Some(line) => words(line.bytes, file.separator),
        None => return Err(no_end(lines)),
    };
    let step = if file.x_columns == XColumns::Multi { 2 } else { 1 };
    let room = (header.titles.len().saturating_sub(1)).div_ceil(step);
    let count = match header.keys.get("Channels").and_then(|fields| fields.get(1)) {
        Some(text) => text.parse::<usize>().ok().filter(|n| (1..=room).contains(n)).ok_or_else(|| {
            IngestError::content(
                lines.place(),
                format!("{text:?} channels are announced, there are {} column titles", header.titles.len()),
                "a title for each channel",
                "the file may be damaged: save the measurement again",
            )
        })?,
        None => {
            header.titles[1..].iter().step_by(step).filter(|title| *title != "Comment" && !title.is_empty()).count()
        }
    };
    header.columns = (0..count).map(|k| 1 + k * step).collect();
    Ok(Some(header))
}

fn no_end(lines: &Lines) -> IngestError {
    IngestError::content(
        lines.place(),
        "the file ends in a header",
        "***End_of_Header***, a line of column titles and rows",
        "the file may be cut short: save or download it again",
    )
}

impl SegmentHeader {
    /// The value of a key for the channel in a column; empty if there is none.
    pub fn text(&self, key: &str, column: usize) -> &str {
        self.keys.get(key).and_then(|fields| fields.get(column)).map_or("", String::as_str)
    }

    /// The same as a finite number.
    pub fn number(&self, key: &str, column: usize, decimal: u8) -> Option<f64> {
        numbers::field(self.text(key, column).as_bytes(), decimal).map(|number| number.value)
    }

    /// The decimal mark where the file states none: the comma if interval or start have one.
    pub fn decimal(&self) -> u8 {
        let comma = |key: &str| self.keys.get(key).is_some_and(|fields| fields.iter().any(|f| f.contains(',')));
        if comma("Delta_X") || comma("X0") { b',' } else { b'.' }
    }
}
