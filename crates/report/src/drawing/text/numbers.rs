//! Numbers as crash engineers write them: g, km/h, mm, ms, kN.

pub use crumple_signal::key_quantities::{G_PER_M_PER_S2, KILO, KM_PER_H_PER_M_PER_S, MILLI};

/// What stands where a record does not show a value.
pub const ABSENT: &str = "–";
/// A space that does not break the line, between a number and its unit.
pub const NBSP: char = '\u{a0}';

/// A number with so many significant digits, without an exponent between 1e-3 and 1e6, with a true minus sign.
///
/// Integers keep all their digits: 1719, not 1720, whatever the number of digits asked for.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return ABSENT.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    let scientific = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let text = if (-3..6).contains(&exponent) {
        let decimals = i32::try_from(digits).ok().and_then(|d| usize::try_from(d - 1 - exponent).ok()).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        format!("{mantissa}·10{}", superscript(exponent))
    };
    minus(&text)
}

/// Digits that an interval deserves: two of the distance between its ends, so that they differ in print, and at least
/// so many of the larger end.
pub fn digits_of_interval(low: f64, high: f64, at_least: usize) -> usize {
    /// No end is known to more.
    const MOST: usize = 9;
    let size = low.abs().max(high.abs());
    let orders = (size / (high - low).abs()).log10().ceil();
    // Not finite where the ends are equal or not numbers, and then there is nothing to tell apart.
    if orders.is_finite() && orders > 0.0 {
        (orders as usize + 1).clamp(at_least, MOST.max(at_least))
    } else {
        at_least
    }
}

/// A number with so many decimals and a true minus sign.
pub fn decimals(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return ABSENT.to_owned();
    }
    let text = format!("{value:.decimals$}");
    // "-0.0" says nothing that "0.0" does not.
    if text.starts_with('-') && !text.contains(|c: char| c.is_ascii_digit() && c != '0') {
        return text[1..].to_owned();
    }
    minus(&text)
}

/// A signed deviation: `+12.3`, `−4.5`.
pub fn signed(value: f64, places: usize) -> String {
    let text = decimals(value, places);
    if value > 0.0 && text.contains(|c: char| c.is_ascii_digit() && c != '0') { format!("+{text}") } else { text }
}

fn minus(text: &str) -> String {
    text.replacen('-', "−", 1)
}

/// An exponent in raised digits.
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |c: char| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]);
    exponent.to_string().chars().map(digit).collect()
}

/// Up to so many decimals, without trailing zeros: 873 and 14.25, not 873.00.
pub fn at_most(value: f64, places: usize) -> String {
    let text = decimals(value, places);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The unit people use for an SI unit, and the factor to it.
///
/// A unit that is not known stays as it is.
pub fn unit(si: &str) -> (f64, &str) {
    match si {
        "m/s^2" => (G_PER_M_PER_S2, "g"),
        "m/s" => (KM_PER_H_PER_M_PER_S, "km/h"),
        "m" => (MILLI, "mm"),
        "s" => (MILLI, "ms"),
        "N" => (KILO, "kN"),
        "N/m" => (KILO, "kN/m"),
        "N*s/m" | "N s/m" => (KILO, "kN·s/m"),
        "J" => (KILO, "kJ"),
        "m^2/s^2" => (1.0, "J/kg"),
        "N/m^2" => (1.0, "N/m²"),
        "1" | "" => (1.0, ""),
        other => (1.0, other),
    }
}

/// A longer stretch of time than this is told in s, a shorter one in ms.
pub const LONG_S: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_are_kept_and_integers_are_whole() {
        assert_eq!(significant(321_912.4 * KILO, 4), "321.9");
        assert_eq!(significant(1719.0, 4), "1719");
        assert_eq!(significant(-0.074_312, 4), "−0.07431");
        assert_eq!(significant(9.999_96, 4), "10.00");
        assert_eq!(significant(1.234e-7, 3), "1.23·10⁻⁷");
        assert_eq!(significant(f64::NAN, 3), ABSENT);
    }

    #[test]
    fn ends_of_a_narrow_interval_differ_in_print() {
        let shown = |low, high| {
            let digits = digits_of_interval(low, high, 3);
            (significant(low, digits), significant(high, digits))
        };
        assert_eq!(shown(899.72, 900.28), ("899.72".to_owned(), "900.28".to_owned()));
        assert_eq!(shown(495.2, 889.1), ("495".to_owned(), "889".to_owned()));
        assert_eq!(shown(3.0, 3.0), ("3.00".to_owned(), "3.00".to_owned()));
        assert_eq!(digits_of_interval(f64::NAN, 1.0, 3), 3);
    }

    #[test]
    fn a_deviation_has_its_sign_and_zero_has_none() {
        assert_eq!(signed(1.26, 1), "+1.3");
        assert_eq!(signed(-1.26, 1), "−1.3");
        assert_eq!(signed(-0.01, 1), "0.0");
    }

    #[test]
    fn a_velocity_is_in_km_per_h_and_an_unknown_unit_stays() {
        assert_eq!(unit("m/s"), (3.6, "km/h"));
        assert_eq!(unit("1"), (1.0, ""));
        assert_eq!(unit("furlong"), (1.0, "furlong"));
    }
}
