//! Numbers as instruments print them, from bytes.

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

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NumberStyle {
    /// `.` or `,`.
    pub decimal: u8,
    /// `-50,000` is a whole number: it is known that the comma is no decimal mark.
    pub lone_groups: bool,
}

impl NumberStyle {
    /// With a decimal point.
    pub const POINT: Self = Self { decimal: b'.', lone_groups: false };
    /// With a decimal comma.
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
                let number = field(text.as_bytes(), b'.').unwrap();
                prop_assert_eq!(number.value.to_bits(), text.parse::<f64>().unwrap().to_bits(), "{}", text);
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
