//! Bytes of a table as text: marks, encodings, line ends, comments.

use std::borrow::Cow;

use crate::{IngestError, Place};

/// Longest line that is taken for one, bytes.
pub const LINE_LIMIT: usize = 1 << 20;

/// A line of a file without its end, and its number from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line<'a> {
    /// The bytes.
    pub bytes: &'a [u8],
    /// Counted from 1.
    pub number: usize,
    /// Offset of the first byte.
    pub offset: usize,
}

/// The text behind a byte-order mark; UTF-16 becomes UTF-8, old Macintosh line ends become line feeds.
pub fn without_mark(bytes: &[u8]) -> Cow<'_, [u8]> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
        let text: String = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        Cow::Owned(text.into_bytes())
    };
    let text = match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => Cow::Borrowed(rest),
        [0xFF, 0xFE, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    };
    let head = &text[..text.len().min(LINE_LIMIT)];
    if head.contains(&b'\r') && !head.contains(&b'\n') {
        return Cow::Owned(text.iter().map(|b| if *b == b'\r' { b'\n' } else { *b }).collect());
    }
    text
}

/// Whether the bytes can be a text at all: no zero byte, few control characters.
pub fn is_text(bytes: &[u8]) -> bool {
    let head = without_mark(&bytes[..bytes.len().min(8192)]);
    let control =
        head.iter().filter(|b| b.is_ascii_control() && !matches!(b, b'\t' | b'\n' | b'\r' | 0x0C | 0x1A)).count();
    !head.contains(&0) && control * 50 <= head.len()
}

/// Words in UTF-8, else in Windows-1252 (of which latin-1 is a part as far as printed letters go).
pub fn decode(bytes: &[u8]) -> String {
    const HIGH: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}', '‘',
        '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
    ];
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes
            .iter()
            .map(|b| match *b {
                b @ 0x80..=0x9F => HIGH[usize::from(b - 0x80)],
                b => char::from(b),
            })
            .collect(),
    }
}

/// The line that starts at `offset`, and where the next one starts.
pub fn line_at<'a>(text: &'a [u8], offset: usize, number: usize, file: &str) -> Result<(Line<'a>, usize), IngestError> {
    let rest = &text[offset..];
    let window = &rest[..rest.len().min(LINE_LIMIT + 1)];
    let (length, next) = match window.iter().position(|b| *b == b'\n') {
        Some(end) => (end, offset + end + 1),
        None if rest.len() <= LINE_LIMIT => (rest.len(), text.len()),
        None => {
            return Err(IngestError::TooLarge {
                place: Place::line(file, number),
                found: format!("the line is longer than {} MiB", LINE_LIMIT >> 20),
                limit: "lines of a table of numbers".to_owned(),
            });
        }
    };
    let bytes = &rest[..length];
    Ok((Line { bytes: bytes.strip_suffix(b"\r").unwrap_or(bytes), number, offset }, next))
}

/// What a comment line says: the text behind `#`, `%`, `//` or `;`. A `;` counts only where no number follows (it may
/// be an empty first field).
///
/// A `#` alone in its cell is the name of a column.
pub fn comment(line: &[u8]) -> Option<&[u8]> {
    let line = line.trim_ascii_start();
    let cell = line.strip_prefix(b"\"#\"").or(line.strip_prefix(b"#"));
    if cell.is_some_and(|rest| matches!(rest.first(), Some(b',' | b';' | b'\t'))) {
        return None;
    }
    let line = line
        .strip_prefix(b"\"")
        .filter(|rest| rest.starts_with(b"#"))
        .map_or(line, |r| r.strip_suffix(b"\"").unwrap_or(r));
    if let Some(rest) = line.strip_prefix(b";") {
        return (!rest.contains(&b';')).then_some(rest.trim_ascii());
    }
    line.strip_prefix(b"//").or_else(|| line.strip_prefix(b"#").or_else(|| line.strip_prefix(b"%"))).map(without_marks)
}

/// `##`, `%%`, `///`: repeated marks belong to the mark.
fn without_marks(text: &[u8]) -> &[u8] {
    let start = text.iter().position(|b| !matches!(b, b'#' | b'%' | b'/')).unwrap_or(text.len());
    text[start..].trim_ascii()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_marks_and_old_encodings() {
        assert_eq!(&*without_mark(b"\xEF\xBB\xBFa,b\r\n"), b"a,b\r\n");
        assert_eq!(&*without_mark(b"\xFF\xFEt\0,\0a\0\n\0"), b"t,a\n");
        assert_eq!(&*without_mark(b"1,2\r3,4\r"), b"1,2\n3,4\n");
        assert_eq!(decode(b"Verz\xF6gerung"), "Verzögerung");
        assert_eq!(decode("Verzögerung".as_bytes()), "Verzögerung");
    }

    #[test]
    fn knows_comments_and_empty_first_fields() {
        assert_eq!(comment(b"# mass: 1 kg"), Some(&b"mass: 1 kg"[..]));
        assert_eq!(comment(b"  // x"), Some(&b"x"[..]));
        assert_eq!(comment(b"%% x"), Some(&b"x"[..]));
        assert_eq!(comment(b"; a remark"), Some(&b"a remark"[..]));
        assert_eq!(comment(b";1,5;2"), None);
        assert_eq!(comment(b"1,2"), None);
        assert_eq!((comment(b"#,a_g"), comment(b"\"#\",a_g")), (None, None));
    }

    #[test]
    fn garbage_is_no_text() {
        assert!(!is_text(&[0, 1, 2, 3, 250]));
        assert!(!is_text(b"abc\x01\x02\x03\x04"));
        assert!(is_text(b"t,a\n0,1\n"));
    }
}
