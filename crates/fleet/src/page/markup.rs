//! Text and numbers in HTML.

use std::fmt::Write as _;

/// Text for an element or a quoted attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

/// A path below the folder of the fleet as a link.
pub(crate) fn link(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' | b',' | b'=' => {
                out.push(char::from(byte));
            }
            byte => {
                // Writing to a string does not fail.
                let _ = write!(out, "%{byte:02X}");
            }
        }
    }
    out
}

/// A number with so many significant digits, all digits in front of the point kept.
pub(crate) fn number(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { String::new() };
    }
    let order = value.abs().log10().floor() as i32;
    let decimals = usize::try_from(digits - 1 - order).unwrap_or(0);
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_name_is_markup_or_leaves_a_link() {
        assert_eq!(escaped("<a b=\"c\">&"), "&lt;a b=&quot;c&quot;&gt;&amp;");
        assert_eq!(link("runs/a b#1/default,filter.cfc=60"), "runs/a%20b%231/default,filter.cfc=60");
    }

    #[test]
    fn numbers_keep_their_digits() {
        let said = [412.34, 0.012345, 12345.6, -1.5, 0.0].map(|value| number(value, 3));
        assert_eq!(said, ["412", "0.0123", "12346", "-1.50", "0"]);
    }
}
