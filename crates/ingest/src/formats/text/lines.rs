//! Lines and numbers of text files.

use std::borrow::Cow;

use crate::{Place, Result, refuse_size};

/// Longest line that is taken for one, bytes.
pub const LINE_LIMIT: usize = 1 << 20;

/// A line of a file without its end, and its number from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line<'a> {
    pub bytes: &'a [u8],
    /// Counted from 1.
    pub number: usize,
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
pub fn line_at<'a>(text: &'a [u8], offset: usize, number: usize, file: &str) -> Result<(Line<'a>, usize)> {
    let rest = &text[offset..];
    let window = &rest[..rest.len().min(LINE_LIMIT + 1)];
    let (length, next) = match window.iter().position(|b| *b == b'\n') {
        Some(end) => (end, offset + end + 1),
        None if rest.len() <= LINE_LIMIT => (rest.len(), text.len()),
        None => {
            return refuse_size(
                Place::line(file, number),
                format!("the line is longer than {} MiB", LINE_LIMIT >> 20),
                "lines of a table of numbers",
            );
        }
    };
    let bytes = &rest[..length];
    Ok((Line { bytes: bytes.strip_suffix(b"\r").unwrap_or(bytes), number, offset }, next))
}

/// A reading position between the lines of a text.
pub struct Lines<'a> {
    file: &'a str,
    text: &'a [u8],
    /// Where the next line starts.
    pub offset: usize,
    pub number: usize,
}

impl<'a> Lines<'a> {
    /// Starts at the first line. `file` names it in messages.
    pub fn new(file: &'a str, text: &'a [u8]) -> Self {
        Self { file, text, offset: 0, number: 1 }
    }

    /// The next line, not taken. A line over 1 MiB is refused.
    pub fn peek(&self) -> Result<Option<Line<'a>>> {
        Ok(self.line()?.map(|(line, _)| line))
    }

    /// Takes the next line.
    pub fn take(&mut self) -> Result<Option<Line<'a>>> {
        let Some((line, next)) = self.line()? else { return Ok(None) };
        (self.offset, self.number) = (next, self.number + 1);
        Ok(Some(line))
    }

    fn line(&self) -> Result<Option<(Line<'a>, usize)>> {
        let is_end = self.offset >= self.text.len();
        if is_end { Ok(None) } else { line_at(self.text, self.offset, self.number, self.file).map(Some) }
    }

    /// The place of the last line taken.
    pub fn place(&self) -> Place {
        Place::line(self.file, self.number.saturating_sub(1).max(1))
    }
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

/// A number, and how finely it is printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParsedNumber {
    /// Its value, finite.
    pub value: f64,
    /// Significant digits printed, leading zeros not counted.
    pub digits: u32,
}

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Reads the number at the start of `bytes` and says how many bytes it takes.
///
/// Takes `1`, `-.206786E-02` and `1.5D+03` (Fortran), `+1.234560E+01`, `1E-04`; the decimal mark is `decimal`.
/// Correctly rounded: where mantissa and power of ten are exact in f64 one multiplication or division is (Clinger
/// 1990), elsewhere the standard library's parser is asked. `None` where there is no finite number.
#[inline]
pub fn scan(bytes: &[u8], decimal: u8) -> Option<(ParsedNumber, usize)> {
    let mut at = 0;
    let negative = match bytes.first() {
        Some(b'-') => {
            at = 1;
            true
        }
        Some(b'+') => {
            at = 1;
            false
        }
        _ => false,
    };
    let mut mantissa = 0_u64;
    let mut digits = 0_u32;
    let mut any = false;
    while let Some(d) = bytes.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        // Past 19 digits the value is wrong, and not used.
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
        digits += u32::from(mantissa != 0 || digits != 0);
        any = true;
        at += 1;
    }
    let mut exponent = 0_i64;
    if bytes.get(at) == Some(&decimal) {
        at += 1;
        while let Some(d) = bytes.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
            digits += u32::from(mantissa != 0 || digits != 0);
            any = true;
            exponent -= 1;
            at += 1;
        }
    }
    if !any {
        return None;
    }
    if let Some((power, length)) = scan_exponent(&bytes[at..]) {
        exponent += power;
        at += length;
    }
    let value = if digits <= 19 && mantissa <= 1 << 53 && (-22..=22).contains(&exponent) {
        let m = mantissa as f64;
        let magnitude = if exponent < 0 { m / POWERS[(-exponent) as usize] } else { m * POWERS[exponent as usize] };
        if negative { -magnitude } else { magnitude }
    } else {
        parse_slowly(&bytes[..at], decimal)?
    };
    value.is_finite().then_some((ParsedNumber { value, digits }, at))
}

/// `e-04`, `E+3`, `D02`: the power and its length.
fn scan_exponent(bytes: &[u8]) -> Option<(i64, usize)> {
    if !matches!(bytes.first(), Some(b'e' | b'E' | b'd' | b'D')) {
        return None;
    }
    let signed = matches!(bytes.get(1), Some(b'+' | b'-'));
    let start = 1 + usize::from(signed);
    let length = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
    if length == 0 {
        return None;
    }
    // Beyond five digits every exponent overflows or underflows alike.
    let power = bytes[start..start + length].iter().fold(0_i64, |p, b| (p * 10 + i64::from(b - b'0')).min(99_999));
    Some((if bytes[1] == b'-' { -power } else { power }, start + length))
}

#[cold]
fn parse_slowly(bytes: &[u8], decimal: u8) -> Option<f64> {
    if decimal == b'.' && !bytes.iter().any(|b| matches!(b, b'd' | b'D')) {
        return std::str::from_utf8(bytes).ok()?.parse().ok();
    }
    let plain: String = bytes
        .iter()
        .map(|b| match *b {
            b if b == decimal => '.',
            b'd' | b'D' => 'e',
            b => char::from(b),
        })
        .collect();
    plain.parse().ok()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NumberStyle {
    /// `.` or `,`.
    pub decimal: u8,
    /// `-50,000` is a whole number: it is known that the comma is no decimal mark.
    pub lone_groups: bool,
}

impl NumberStyle {
    pub const POINT: Self = Self { decimal: b'.', lone_groups: false };
    pub const COMMA: Self = Self { decimal: b',', lone_groups: false };

    /// The number that is the whole of a field, blanks and one pair of quotes around it aside. Thousands may be apart.
    pub fn field(self, bytes: &[u8]) -> Option<ParsedNumber> {
        let bytes = unquoted(bytes);
        let whole = scan(bytes, self.decimal).filter(|(_, length)| *length == bytes.len()).map(|(number, _)| number);
        whole.or_else(|| grouped(bytes, self))
    }
}

/// [`NumberStyle::field`] with a decimal mark, where a lone group may be decimals.
pub fn field(bytes: &[u8], decimal: u8) -> Option<ParsedNumber> {
    NumberStyle { decimal, lone_groups: false }.field(bytes)
}

/// `1,234.5`, `1.234,5`, `1'234.5`, `1 234`: one to three digits, then groups of three. A comma or a point between
/// thousands counts only where a decimal mark or a second group follows: `1,234` alone may be 1.234. A minus sign as
/// word processors print it counts as one.
#[cold]
fn grouped(bytes: &[u8], style: NumberStyle) -> Option<ParsedNumber> {
    const MINUS: &[u8] = "\u{2212}".as_bytes();
    if let Some(magnitude) = bytes.strip_prefix(MINUS) {
        return style.field(&[b"-", magnitude].concat());
    }
    let decimal = style.decimal;
    let (sign, unsigned) = match bytes {
        [b'-' | b'+', rest @ ..] => (&bytes[..1], rest),
        _ => (&bytes[..0], bytes),
    };
    let digits = |bytes: &[u8]| bytes.iter().take_while(|b| b.is_ascii_digit()).count();
    let lead = digits(unsigned);
    let mark = MARKS.into_iter().find(|m| unsigned[lead..].starts_with(m) && **m != [decimal])?;
    let mut plain = [sign, &unsigned[..lead]].concat();
    let (mut rest, mut groups) = (&unsigned[lead..], 0);
    while let Some(group) = rest.strip_prefix(mark).filter(|group| digits(group) == 3) {
        plain.extend(&group[..3]);
        (rest, groups) = (&group[3..], groups + 1);
    }
    // `0,123` is a decimal comma whatever other cells say.
    let plain_lead = !unsigned.starts_with(b"0");
    let certain = groups > 1
        || rest.first() == Some(&decimal)
        || !matches!(mark, [b',' | b'.'])
        || style.lone_groups && plain_lead;
    plain.extend(rest);
    let (number, length) = scan(&plain, decimal)?;
    ((1..=3).contains(&lead) && groups > 0 && certain && length == plain.len()).then_some(number)
}

/// What stands between thousands; the blanks that do not break, in latin-1 and UTF-8.
const MARKS: [&[u8]; 7] = [b",", b".", b"'", b" ", b"\xA0", b"\xC2\xA0", b"\xE2\x80\xAF"];

/// A field without the blanks and the quotes around it.
pub fn unquoted(bytes: &[u8]) -> &[u8] {
    let bytes = bytes.trim_ascii();
    match bytes {
        [b'"', inner @ .., b'"'] | [b'\'', inner @ .., b'\''] => inner.trim_ascii(),
        _ => bytes,
    }
}

/// Text that stands where a number is missing: `NaN`, `inf`, `n/a`, `NOVALUE`, or nothing.
pub fn is_gap(bytes: &[u8]) -> bool {
    let text = unquoted(bytes).to_ascii_lowercase();
    let text = text.strip_prefix(b"-").or(text.strip_prefix(b"+")).unwrap_or(&text);
    // What Excel and the C library of Windows print where there is no number.
    let of_excel = [&b"#n/a"[..], b"#div/0!", b"#value!", b"#num!", b"#ref!", b"#name?", b"#null!"];
    let of_windows = [&b"1.#qnan"[..], b"1.#ind", b"1.#inf"];
    let others = [&b""[..], b"nan", b"inf", b"infinity", b"n/a", b"na", b"null", b"none", b"novalue"];
    of_excel.contains(&text) || of_windows.contains(&text) || others.contains(&text)
}

/// `(12.5)` or `12.5-`: a negative number as accounts write it.
pub fn is_negative_of_accounts(text: &[u8]) -> bool {
    let in_brackets = text.strip_prefix(b"(").and_then(|text| text.strip_suffix(b")"));
    let number = in_brackets.or_else(|| text.strip_suffix(b"-"));
    number.is_some_and(|text| text.first().is_some_and(u8::is_ascii_digit))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

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

    #[test]
    fn thousands_may_be_apart_where_nothing_else_can_be_meant() {
        let parsed = |text: &str, decimal| field(text.as_bytes(), decimal).map(|n| n.value);
        for (text, decimal, value) in [
            ("1,234.5", b'.', 1234.5),
            ("\"-12,345,678\"", b'.', -12_345_678.0),
            ("1.234,5", b',', 1234.5),
            ("1'234", b'.', 1234.0),
            ("1 234.50e-1", b'.', 123.45),
            ("1\u{a0}234,5", b',', 1234.5),
            ("1\u{202f}234,5", b',', 1234.5),
        ] {
            assert_eq!(parsed(text, decimal), Some(value), "{text}");
        }
        for text in ["1,234", "1234,567.0", "1,23.0", ",123.0", "1,,234.0", "1,234'567.0", "1,234.5 g", "0x1,234.0"] {
            assert_eq!(parsed(text, b'.'), None, "{text}");
        }
        assert_eq!(field(b"1\xA0234,5", b',').map(|n| (n.value, n.digits)), Some((1234.5, 5)));
    }

    #[test]
    fn reads_the_forms_seen_in_files() {
        for (text, value, digits) in [
            ("-.206786E-02", -0.002_067_86, 6),
            ("1.5D+03", 1500.0, 2),
            ("+1.234560E+01", 12.3456, 7),
            ("1E-04", 1e-4, 1),
            ("-3.93852E-11", -3.938_52e-11, 6),
            ("-1.42109e-013", -1.421_09e-13, 6),
            ("-0.0200", -0.02, 3),
            ("5.", 5.0, 1),
            ("0.0", 0.0, 0),
        ] {
            let number = field(text.as_bytes(), b'.').unwrap();
            assert_eq!((number.value, number.digits), (value, digits), "{text}");
        }
        assert_eq!(field(b"\" -1,5 \"", b',').unwrap().value, -1.5);
    }

    #[test]
    fn refuses_what_is_no_finite_number() {
        for text in ["", "-", ".", "e5", "nan", "inf", "1e999", "1.2.3", "0x10", "1 2", "--1", "1,5"] {
            assert_eq!(field(text.as_bytes(), b'.'), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn agrees_with_the_standard_library(
            x in any::<f64>().prop_filter("finite", |x| x.is_finite()),
            digits in 0_usize..20,
        ) {
            for text in [format!("{x}"), format!("{x:e}"), format!("{x:.digits$e}"), format!("{:.digits$}", x % 1e9)] {
                // Rounded to few digits, the largest numbers are infinite.
                let expected = text.parse().ok().filter(|value: &f64| value.is_finite()).map(f64::to_bits);
                prop_assert_eq!(field(text.as_bytes(), b'.').map(|n| n.value.to_bits()), expected, "{}", text);
            }
        }

        #[test]
        fn any_bytes_give_an_answer(
            bytes in proptest::collection::vec(any::<u8>(), 0..40),
            decimal in prop::sample::select(vec![b'.', b',']),
        ) {
            if let Some((number, length)) = scan(&bytes, decimal) {
                prop_assert!(number.value.is_finite() && length <= bytes.len());
            }
        }
    }
}
