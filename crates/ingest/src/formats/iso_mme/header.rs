//! Lines `Keyword                     :value` of test files, channel lists and channel files.

use crate::formats::text::lines::{decode, line_at, without_mark};
use crate::{IngestError, Place};

/// More lines before the first sample than this are no header.
pub const LINE_COUNT_LIMIT: usize = 10_000;

/// Keywords that tell an ISO-MME file from another text, each in front of a colon.
const TELLING: [&[u8]; 7] = [
    b"channel code",
    b"data format edition number",
    b"instrumentation standard",
    b"number of channels",
    b"name of channel 001",
    b"test object number",
    b"laboratory test ref. number",
];

/// Whether the start of a file looks like one of an ISO-MME test.
pub fn recognises(head: &[u8]) -> bool {
    let text = without_mark(head).to_ascii_lowercase();
    if text.windows(5).any(|w| w == b"-----") {
        return false;
    }
    text.split(|b| *b == b'\n').any(|line| {
        let Some(colon) = line.iter().position(|b| *b == b':') else { return false };
        TELLING.contains(&line[..colon].trim_ascii())
    })
}

/// Whether the start of a file is a text of lines `keyword :value`: three at least, and half of those that say
/// something.
pub fn has_keyword_lines(head: &[u8]) -> bool {
    if head.contains(&0) {
        return false;
    }
    let lines = || head.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let keywords = lines()
        .filter(|line| line.iter().position(|b| *b == b':').is_some_and(|at| at > 0 && line[0].is_ascii_alphabetic()));
    let keywords = keywords.count();
    keywords >= 3 && 2 * keywords >= lines().count()
}

/// One line.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Entry {
    line: usize,
    /// Small letters, single blanks.
    keyword: String,
    /// As written.
    title: String,
    value: String,
}

/// The lines of a file in order; keywords may repeat.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Header {
    entries: Vec<Entry>,
}

impl Header {
    /// Reads a file that is nothing but such lines. Others are left out.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, IngestError> {
        let text = without_mark(bytes);
        let mut header = Self::default();
        let (mut offset, mut number) = (0, 1);
        while offset < text.len() {
            let (line, next) = line_at(&text, offset, number, file)?;
            header.push(file, number, line.bytes)?;
            (offset, number) = (next, number + 1);
        }
        Ok(header)
    }

    /// Takes a line, split at its first colon. Returns whether there was one.
    pub fn push(&mut self, file: &str, line: usize, bytes: &[u8]) -> Result<bool, IngestError> {
        if line > LINE_COUNT_LIMIT {
            return Err(IngestError::TooLarge {
                place: Place::line(file, line),
                found: format!("more than {LINE_COUNT_LIMIT} lines of keywords"),
                limit: "a header of some thirty lines, then one number a line".to_owned(),
            });
        }
        let Some(colon) = bytes.iter().position(|b| *b == b':') else { return Ok(false) };
        let title = decode(bytes[..colon].trim_ascii());
        let keyword = title.to_lowercase().split_whitespace().collect::<Vec<_>>().join(" ");
        self.entries.push(Entry { line, keyword, title, value: decode(bytes[colon + 1..].trim_ascii()) });
        Ok(true)
    }

    /// The first known value of a keyword; empty, `NOVALUE` and the like are unknown.
    pub fn text(&self, keyword: &str) -> Option<&str> {
        self.entries.iter().filter(|e| e.keyword == keyword).find_map(|e| stated_value(&e.value))
    }

    /// The line of a keyword.
    pub fn line(&self, keyword: &str) -> Option<usize> {
        self.entries.iter().find(|e| e.keyword == keyword).map(|e| e.line)
    }

    /// A finite number; a decimal comma is taken.
    pub fn number(&self, keyword: &str) -> Option<f64> {
        number(self.text(keyword)?)
    }

    /// All known entries as keyword in small letters and value.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().filter_map(|e| Some((e.keyword.as_str(), stated_value(&e.value)?)))
    }

    /// All known entries whose keyword is not in the list, as `Keyword: value`, repeated ones included.
    pub fn others(&self, keywords: &[&str]) -> Vec<String> {
        self.entries
            .iter()
            .filter(|e| !keywords.contains(&e.keyword.as_str()))
            .filter_map(|e| Some(format!("{}: {}", e.title, stated_value(&e.value)?)))
            .collect()
    }
}

/// A number of a header value, alone.
pub fn number(text: &str) -> Option<f64> {
    text.parse().or_else(|_| text.replace(',', ".").parse()).ok().filter(|x: &f64| x.is_finite())
}

fn stated_value(value: &str) -> Option<&str> {
    let upper = value.to_ascii_uppercase();
    (!matches!(upper.as_str(), "" | "NOVALUE" | "NONE" | "NO VALUE" | "N/A" | "UNKNOWN" | "-")).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_split_at_the_first_colon_and_trimmed() {
        let text = b"\xEF\xBB\xBFTitle                       :a: b \r\nTEST\tobject  number :1\r\nno colon\nComments \
            :x\nComments :y\nUnit :NOVALUE\n";
        let header = Header::parse("a.mme", text).unwrap();
        assert_eq!(header.text("title"), Some("a: b"));
        assert_eq!(header.number("test object number"), Some(1.0));
        assert_eq!((header.text("unit"), header.line("unit")), (None, Some(6)));
        assert_eq!(header.others(&["title", "test object number"]), ["Comments: x", "Comments: y"]);
        let latin = Header::parse("a.mme", b"Location :T\xEAte\n").unwrap();
        assert_eq!(latin.text("location"), Some("T\u{ea}te"));
    }

    #[test]
    fn a_next_line_control_does_not_end_a_line() {
        let header = Header::parse("a.mme", b"Title :a\x85b\n").unwrap();
        assert_eq!(header.text("title"), Some("a\u{2026}b"));
    }

    #[test]
    fn endless_headers_are_refused() {
        let text = "Comments :x\n".repeat(LINE_COUNT_LIMIT + 1);
        let error = Header::parse("a.mme", text.as_bytes()).unwrap_err();
        assert_eq!(error.to_string(), "a.mme, line 10001: more than 10000 lines of keywords");
    }

    #[test]
    fn ev5_and_tables_are_left_alone() {
        assert!(recognises(b"Test object number          :1\r\n"));
        assert!(!recognises(b"# channel code: 3\n----- EV5 -----\n"));
        assert!(!recognises(b"-0.05\t0.1\n"));
    }
}
