//! A channel file of ISO-MME: header lines, values.

use crate::formats::text::lines::{Lines, decode, field, is_gap, without_mark};
use crate::{GAPS_ARE_NOT_FILLED, IngestError, Place, Result, refuse, refuse_size};

/// More lines before the first sample than this are no header.
const LINE_COUNT_LIMIT: usize = 10_000;

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

/// Whether the start of a file is a text of lines `keyword :value`: half of those that say something at least.
pub fn has_keyword_lines(head: &[u8]) -> bool {
    if head.contains(&0) {
        return false;
    }
    let lines = || head.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let keywords = lines()
        .filter(|line| line.iter().position(|b| *b == b':').is_some_and(|at| at > 0 && line[0].is_ascii_alphabetic()));
    let keywords = keywords.count();
    keywords >= 1 && 2 * keywords >= lines().count()
}

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
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self> {
        let text = without_mark(bytes);
        let mut header = Self::default();
        let mut lines = Lines::new(file, &text);
        while let Some(line) = lines.take()? {
            header.push(file, line.number, line.bytes)?;
        }
        Ok(header)
    }

    /// Takes a line, split at its first colon. Returns whether there was one.
    pub fn push(&mut self, file: &str, line: usize, bytes: &[u8]) -> Result<bool> {
        if line > LINE_COUNT_LIMIT {
            return refuse_size(
                Place::line(file, line),
                format!("more than {LINE_COUNT_LIMIT} lines of keywords"),
                "a header of some thirty lines, then one number a line",
            );
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

/// A channel file, its samples as written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChannelFile {
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
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self> {
        let text = without_mark(bytes);
        let mut parsed = Self::default();
        let mut lines = Lines::new(file, &text);
        let (mut in_header, mut first_blank) = (true, None);
        // Gaps since the last number: at the end they are left off, before a number they are an error.
        let mut gap: Option<(usize, usize)> = None;
        while let Some(line) = lines.take()? {
            let (bytes, at) = (line.bytes.trim_ascii(), line.number);
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
            return refuse(
                lines.place(),
                found,
                "a header, then one number a line",
                "the channel holds no data: choose another, or export the test again",
            );
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
        GAPS_ARE_NOT_FILLED,
    )
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
