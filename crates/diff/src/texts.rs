//! Texts with measured numbers in them, such as notes: the words exactly, the decimal numbers by tolerance.

use crate::Tolerance;

/// Whether two texts say the same. Only numbers with a decimal point are taken as measured: the digits of names,
/// counts and digests are part of the words.
pub(crate) fn same_words(a: &str, b: &str, tolerance: Tolerance) -> bool {
    if a == b {
        return true;
    }
    if tolerance == Tolerance::ZERO {
        return false;
    }
    let (a, b) = (unsigned_zeros(a), unsigned_zeros(b));
    let (a, b) = (split(&a), split(&b));
    a.len() == b.len()
        && a.iter().zip(&b).all(|pair| match pair {
            (Piece::Words(x), Piece::Words(y)) => x == y,
            (Piece::Decimal(x), Piece::Decimal(y)) => tolerance.allows(*x, *y, x.abs().max(y.abs())),
            (Piece::Count(x), Piece::Count(y)) => x == y,
            _ => false,
        })
}

/// Whether two texts are equal but for the sign of a zero.
pub(crate) fn same_words_exactly(a: &str, b: &str) -> bool {
    unsigned_zeros(a) == unsigned_zeros(b)
}

/// The text with `-0.00` written `0.00`.
fn unsigned_zeros(text: &str) -> String {
    let is_zero = |rest: &str| match decimal(rest) {
        Some((value, _)) => value == 0.0,
        None => count(rest).is_some_and(|(_, length)| rest[..length].bytes().all(|digit| digit == b'0')),
    };
    let is_sign = |at: usize, c: char| {
        let goes_on = text[..at].ends_with(|c: char| c.is_alphanumeric() || matches!(c, '.' | '_' | '-' | '/' | ':'));
        matches!(c, '-' | '\u{2212}') && !goes_on && is_zero(&text[at + c.len_utf8()..])
    };
    text.char_indices().filter(|(at, c)| !is_sign(*at, *c)).map(|(_, c)| c).collect()
}

/// Whether two texts differ in nothing but numbers: decimal ones, and whole ones that stand alone.
pub(crate) fn same_but_for_numbers(a: &str, b: &str) -> bool {
    let number = |piece: &Piece<'_>| !matches!(piece, Piece::Words(_));
    let (a, b) = (unsigned_zeros(a), unsigned_zeros(b));
    let (a, b) = (split(&a), split(&b));
    a.len() == b.len()
        && a.iter().zip(&b).all(|(x, y)| match (x, y) {
            (Piece::Words(x), Piece::Words(y)) => x == y,
            _ => number(x) && number(y),
        })
}

#[derive(Debug, PartialEq)]
enum Piece<'a> {
    Words(&'a str),
    Decimal(f64),
    /// A whole number that is no part of a name.
    Count(&'a str),
}

fn split(text: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut words_from = 0;
    let mut at = 0;
    while at < text.len() {
        let before = &text[..at];
        let starts_word = !before.ends_with(|c: char| c.is_alphanumeric() || c == '.' || c == '_');
        let number =
            decimal(&text[at..]).map(|(value, length)| (Piece::Decimal(value), length)).or_else(|| count(&text[at..]));
        match number.filter(|(piece, _)| {
            starts_word && !(matches!(piece, Piece::Count(_)) && before.ends_with(['-', '/', ':']))
        }) {
            Some((piece, length)) => {
                pieces.extend([Piece::Words(&text[words_from..at]), piece]);
                at += length;
                words_from = at;
            }
            None => at += text[at..].chars().next().map_or(1, char::len_utf8),
        }
    }
    pieces.push(Piece::Words(&text[words_from..]));
    pieces
}

/// A number such as `1.25` or `1.25e-3` at the start of a text, and its length; the sign stays with the words.
fn decimal(text: &str) -> Option<(f64, usize)> {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let whole = digits(0);
    if whole == 0 || text.as_bytes().get(whole) != Some(&b'.') {
        return None;
    }
    let fraction = digits(whole + 1);
    let mut length = whole + 1 + fraction;
    if fraction == 0 {
        return None;
    }
    if matches!(text.as_bytes().get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.as_bytes().get(length + 1), Some(b'-' | b'+')));
        let exponent = text.get(length + 1 + sign..).map_or(0, |_| digits(length + 1 + sign));
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    // Version numbers and the like go on: 0.1.0, 2.5x.
    let goes_on = text[length..].starts_with(|c: char| c.is_alphanumeric())
        || (text[length..].starts_with('.') && text[length + 1..].starts_with(|c: char| c.is_ascii_digit()));
    if goes_on { None } else { Some((text[..length].parse().ok()?, length)) }
}

/// A whole number at the start of a text that does not go on as a name, a version or a decimal number, and its length.
fn count(text: &str) -> Option<(Piece<'_>, usize)> {
    let length = text.bytes().take_while(u8::is_ascii_digit).count();
    let rest = &text[length..];
    let goes_on = rest.starts_with(|c: char| c.is_alphanumeric() || c == '_')
        || (rest.starts_with(['.', '-', '/', ':']) && rest[1..].starts_with(|c: char| c.is_alphanumeric()));
    (length > 0 && !goes_on).then_some((Piece::Count(&text[..length]), length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_of_a_printed_number_may_differ_and_the_words_may_not() {
        let same = |a, b| same_words(a, b, Tolerance { abs: 1e-12, rel: 1e-9 });
        assert!(same("e is 1.0704680751920001, above 1", "e is 1.0704680751920003, above 1"));
        assert!(same("at -2.5e-3 s.", "at -2.5000000000001e-3 s."));
        assert!(!same("at -2.5 s", "at 2.5 s"));
        assert!(!same("zero level 0.01", "zero level 0.02"));
        assert!(!same("e is 1.5", "e was 1.5000000000001"));
        assert!(!same("12345678901", "12345678902"), "a count");
        assert!(!same("version 0.1.0000000000001", "version 0.1.0"));
        assert!(!same("blake3:1.00000000000001f", "blake3:1.0f"), "part of a word");
        assert!(!same_words("1.0", "1.00", Tolerance::ZERO));
        assert!(same("µ 3.5 µ", "µ 3.50 µ"));
        assert!(!same("1.", "1.5"));
        assert!(!same("1.5e", "1.5"));
        assert!(same("it is 1.5.", "it is 1.5000000000001."), "the end of a sentence");
        assert!(same("1.5. 2", "1.5000000000001. 2") && !same("1.5.2", "1.5000000000001.2"));
        assert!(same("2.5e+3", "2500.0000000001") && same("2.5e3 s", "2500.0 s") && !same("2.5e-", "2.5e"));
    }

    #[test]
    fn a_zero_has_no_sign_in_a_text() {
        let same = |a, b| same_words(a, b, Tolerance { abs: 1e-12, rel: 1e-9 });
        for (a, b) in
            [("at -0.00 s", "at 0.00 s"), ("\u{2212}0.0 mm", "0.0 mm"), ("-0 km/h", "0 km/h"), ("-0.0", "0.0")]
        {
            assert!(same(a, b) && same_words_exactly(a, b) && same_but_for_numbers(a, b), "{a}, {b}");
        }
        for (a, b) in [("at -0.01 s", "at 0.01 s"), ("era-0", "era0"), ("1-0.00", "10.00"), ("-0.0.1", "0.0.1")] {
            assert!(!same(a, b) && !same_words_exactly(a, b), "{a}, {b}");
        }
    }

    #[test]
    fn texts_may_be_alike_but_for_their_numbers() {
        assert!(same_but_for_numbers("zero level 0.01 m/s^2 of 30 samples", "zero level 1.5e-3 m/s^2 of 31 samples"));
        assert!(same_but_for_numbers("the mass is 900 kg", "the mass is 900.5 kg"));
        assert!(!same_but_for_numbers("at -2.5 s", "at 2.5 s"));
        assert!(!same_but_for_numbers("era-4: fit 3.5 %", "era-6: fit 3.5 %"), "names");
        assert!(!same_but_for_numbers("kelvin/fit/1 is best", "kelvin/fit/2 is best"), "names");
        assert!(!same_but_for_numbers("k1_n_per_m", "k2_n_per_m"));
        assert!(!same_but_for_numbers("version 0.1.0", "version 0.2.0"));
        assert!(!same_but_for_numbers("30 samples", "30 samples are clipped"));
        assert!(!same_but_for_numbers("5mm wide", "6mm wide") && !same_but_for_numbers("5_a", "6_a"), "names");
        assert!(!same_but_for_numbers("on 5/a", "on 6/a") && same_but_for_numbers("it is 5.", "it is 6."));
    }
}
