//! Numbers as crash engineers write them: g, km/h, mm, ms, kN.

use crumple_signal::display::{factor_shown, unit_shown};
pub use crumple_signal::key_quantities::{G_PER_M_PER_S2, KILO, KM_PER_H_PER_M_PER_S, MILLI};

/// What stands where a record does not show a value.
pub const ABSENT: &str = "–";
/// A space that does not break the line, between a number and its unit.
pub const NBSP: char = '\u{a0}';

/// Digits that an integer keeps.
const INTEGER_DIGITS: usize = 4;

/// A number with so many significant digits, without an exponent between 1e-3 and 1e6, with a true minus sign.
///
/// Integers keep four digits, 1719 and not 1720, however few are asked for; beyond them they are rounded: 51290.
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
    let text = if PLAIN.contains(&exponent) {
        let place = |digits: usize| exponent + 1 - i32::try_from(digits).unwrap_or(i32::MAX);
        let decimals = usize::try_from(-place(digits)).unwrap_or(0);
        let coarsest = place(digits.max(INTEGER_DIGITS));
        format!("{:.decimals$}", if coarsest > 0 { at_place(value, coarsest) } else { value })
    } else {
        format!("{mantissa}·10{}", superscript(exponent))
    };
    minus(&text)
}

/// How a value and its interval are rounded: what is shown has no digit that the interval does not support.
///
/// Two digits of half the width count: value and both ends end at that decimal place, tens and hundreds too. Where the
/// ends have one sign and differ by more than a factor of ten, each number has two digits of its own instead. A number
/// that would become zero keeps one digit. Rounding keeps the order: an end never crosses the value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    last: LastDigit,
    /// The finest place, whatever the interval supports.
    finest: Option<i32>,
}

/// Where a rounded number ends.
#[derive(Debug, Clone, Copy, PartialEq)]
enum LastDigit {
    /// So many significant digits.
    Significant(i32),
    /// At this power of ten.
    Place(i32),
}

impl Rounding {
    /// Of a value without an interval.
    pub const WITHOUT_INTERVAL: Self = Self { last: LastDigit::Significant(4), finest: None };

    /// To so many decimals.
    pub fn to_decimals(decimals: usize) -> Self {
        let place = i32::try_from(decimals).map_or(i32::MIN, |decimals| -decimals);
        Self { last: LastDigit::Place(place), finest: Some(place) }
    }

    /// To whole numbers, and to four digits below.
    pub fn to_integers(value: f64) -> Self {
        Self { last: LastDigit::Place(place_of_digits(value, 4).min(0)), finest: None }
    }

    /// By an interval, in the unit that is shown; `None` where it has no width.
    pub fn of_interval(low: f64, high: f64) -> Option<Self> {
        let half_width = 0.5 * (high - low).abs();
        let (small, large) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
        if !half_width.is_finite() || half_width == 0.0 {
            return None;
        }
        let last = if low * high > 0.0 && large > FACTOR_OF_A_WIDE_INTERVAL * small {
            LastDigit::Significant(2)
        } else {
            LastDigit::Place((order(half_width) - 1).max(order(large) + 1 - MOST_DIGITS))
        };
        Some(Self { last, finest: None })
    }

    /// By the ends that are known. A number with one end is known to its order of magnitude.
    pub fn of_ends(low: Option<f64>, high: Option<f64>) -> Option<Self> {
        match (low, high) {
            (Some(low), Some(high)) => Self::of_interval(low, high),
            (None, None) => None,
            _ => Some(Self { last: LastDigit::Significant(2), finest: None }),
        }
    }

    /// By an interval, where there is one, with so many decimals at most.
    pub fn of_quantity(ends: Option<(f64, f64)>, decimals: usize) -> Self {
        let fixed = Self::to_decimals(decimals);
        let by_interval = ends.and_then(|(low, high)| Self::of_interval(low, high));
        by_interval.map_or(fixed, |rounding| Self { finest: fixed.finest, ..rounding })
    }

    /// The place at which a number ends.
    fn place(self, value: f64) -> i32 {
        let place = match self.last {
            LastDigit::Significant(digits) => place_of_digits(value, digits),
            LastDigit::Place(place) if at_place(value, place) == 0.0 => place.min(place_of_digits(value, 1)),
            LastDigit::Place(place) => place,
        };
        self.finest.map_or(place, |finest| place.max(finest))
    }

    /// The number in digits, with a true minus sign.
    pub fn show(self, value: f64) -> String {
        if !value.is_finite() {
            return ABSENT.to_owned();
        }
        if value == 0.0 && self.finest.is_none() {
            return "0".to_owned();
        }
        let place = self.place(value);
        let rounded = at_place(value, place);
        let exponent = order(rounded);
        if self.finest.is_none() && rounded != 0.0 && !PLAIN.contains(&exponent) {
            return significant(rounded, usize::try_from(exponent + 1 - place).unwrap_or(1));
        }
        decimals(rounded, usize::try_from(-place).unwrap_or(0))
    }
}

/// Factor between the ends of an interval above which each number has digits of its own.
const FACTOR_OF_A_WIDE_INTERVAL: f64 = 10.0;

/// No number is known to more digits: a sensor is not calibrated to a thousandth.
const MOST_DIGITS: i32 = 4;

/// Exponents of numbers that are written without one.
const PLAIN: std::ops::Range<i32> = -3..6;

/// Exponent of the first digit; 0 of zero.
fn order(value: f64) -> i32 {
    let scientific = format!("{value:e}");
    scientific.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// The place at which so many digits end; of 9.96 with two it is that of 10.
fn place_of_digits(value: f64, digits: i32) -> i32 {
    let place = order(value) + 1 - digits;
    order(at_place(value, place)) + 1 - digits
}

/// The value to the nearest multiple of this power of ten.
fn at_place(value: f64, place: i32) -> f64 {
    if place > 0 {
        let unit = 10_f64.powi(place);
        return (value / unit).round() * unit;
    }
    // By its digits: exact where a division would not be.
    let places = usize::try_from(-place).unwrap_or(0);
    format!("{value:.places$}").parse().unwrap_or(value)
}

/// Digits that a range of values deserves: two of the distance between its ends, so that they differ in print, and at
/// least so many of the larger end.
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

/// The unit people use for an SI unit, and the factor to it: metric, or that of [`Display::now`].
///
/// A unit that is not known stays as it is.
///
/// [`Display::now`]: crumple_signal::Display::now
pub fn unit(si: &str) -> (f64, &str) {
    let (factor, unit) = metric_unit(si);
    (factor * factor_shown(unit), unit_shown(unit))
}

fn metric_unit(si: &str) -> (f64, &str) {
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
        assert_eq!((significant(1719.0, 2), significant(51_292.0, 4)), ("1719".to_owned(), "51290".to_owned()));
        assert_eq!(significant(47_782.0, 6), "47782.0");
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

    /// A value and its interval as they are shown.
    fn rounded(value: f64, low: f64, high: f64) -> String {
        let rounding = Rounding::of_interval(low, high).unwrap_or(Rounding::WITHOUT_INTERVAL);
        format!("{} ({} to {})", rounding.show(value), rounding.show(low), rounding.show(high))
    }

    #[test]
    fn a_value_has_the_digits_of_its_interval() {
        assert_eq!(rounded(47_782.0, 22_656.0, 104_254.0), "48000 (23000 to 104000)");
        assert_eq!(rounded(51_292.0, 33_536.0, 66_830.0), "51000 (34000 to 67000)");
        assert_eq!(rounded(700.002_9, 699.994, 700.045), "700.0 (700.0 to 700.0)");
        assert_eq!(rounded(700.0, 681.2, 720.4), "700 (681 to 720)");
        assert_eq!(rounded(330.0, 328.448, 331.559), "330.0 (328.4 to 331.6)");
        assert_eq!(rounded(0.0, 0.0, 1721.0), "0 (0 to 1720)");
        assert_eq!(rounded(-47_782.0, -104_254.0, -22_656.0), "−48000 (−104000 to −23000)");
    }

    #[test]
    fn numbers_of_a_wide_interval_have_two_digits_each_and_none_becomes_zero() {
        assert_eq!(rounded(2727.7, 10.118, 735_330.0), "2700 (10 to 740000)");
        assert_eq!(rounded(352.9, 9.96, 114_445_272.0), "350 (10 to 1.1·10⁸)");
        assert_eq!(rounded(0.62, 0.0, 380.0), "0.6 (0 to 380)");
        assert_eq!(rounded(3.0, -0.4, 800.0), "3 (−0.4 to 800)");
    }

    #[test]
    fn without_an_interval_there_are_four_digits() {
        assert_eq!(rounded(51_292.0, 3.0, 3.0), "51290 (3.000 to 3.000)");
        assert_eq!(rounded(51_292.0, f64::NAN, 3.0), "51290 (– to 3.000)");
        assert_eq!(Rounding::of_ends(None, None), None);
        let one_end = Rounding::of_ends(Some(4.0), None).unwrap();
        assert_eq!((one_end.show(51_292.0), one_end.show(0.0412)), ("51000".to_owned(), "0.041".to_owned()));
        let mass = |kg: f64| Rounding::to_integers(kg).show(kg);
        assert_eq!([218.25, 873.0, 1400.0, 15_875.0].map(mass), ["218.2", "873.0", "1400", "15875"]);
    }

    #[test]
    fn a_key_number_has_no_more_decimals_than_its_interval() {
        let crush = |value: f64, low, high| Rounding::of_quantity(Some((low, high)), 0).show(value);
        assert_eq!((crush(749.9, 741.2, 759.3), crush(749.9, 600.0, 900.0)), ("750".to_owned(), "750".to_owned()));
        assert_eq!((crush(743.0, 600.0, 900.0), crush(0.2, 0.0, 1.0)), ("740".to_owned(), "0".to_owned()));
        assert_eq!(Rounding::of_quantity(Some((3.0, 3.0)), 1).show(3.0), "3.0");
        assert_eq!(Rounding::of_quantity(None, 2).show(0.0), "0.00");
    }

    /// Numbers from 1e-5 to 1e7 of both signs, always the same.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
            let sign = if state & (1 << 10) == 0 { 1.0 } else { -1.0 };
            sign * 10_f64.powf(12.0 * share - 5.0)
        }
    }

    /// A shown number read back.
    fn read(shown: &str) -> f64 {
        let (mantissa, exponent) = shown.split_once("·10").unwrap_or((shown, ""));
        let raised = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == c);
        let size = exponent.chars().filter_map(raised).fold(0, |all, digit| 10 * all + digit);
        let size = i32::try_from(size).unwrap();
        let exponent = if exponent.starts_with('⁻') { -size } else { size };
        format!("{}e{exponent}", mantissa.replace('−', "-")).parse().unwrap()
    }

    #[test]
    fn what_is_shown_keeps_the_order_and_is_read_back_within_half_a_unit() {
        let mut next = numbers();
        for _ in 0..20_000 {
            let mut sorted = [next(), next(), next()];
            if next() > 0.0 {
                // Narrow, as most intervals are.
                let width = 1e-3 * next();
                sorted = [sorted[0], sorted[0] * (1.0 + width), sorted[0] * (1.0 + 2.0 * width)];
            }
            sorted.sort_by(f64::total_cmp);
            let [low, value, high] = sorted;
            let Some(rounding) = Rounding::of_interval(low, high) else { continue };
            let shown = sorted.map(|number| rounding.show(number));
            let back = [0, 1, 2].map(|k| read(&shown[k]));
            assert!(back[0] <= back[1] && back[1] <= back[2], "{shown:?} of {sorted:?}");
            let half_width = 0.5 * (high - low);
            for (number, back) in sorted.into_iter().zip(back) {
                let unit = 10_f64.powi(rounding.place(number));
                // A share of 1e-9 for the rounding of the numbers themselves.
                let half = 0.5 * unit + 1e-9 * number.abs();
                assert!((number - back).abs() <= half, "{number} is {back}, {shown:?}");
                let digits = order(back) + 1 - rounding.place(number);
                let is_narrow = rounding.last != LastDigit::Significant(2);
                let is_supported = if is_narrow { unit >= 0.009 * half_width || digits <= 1 } else { digits <= 2 };
                assert!(is_supported, "{shown:?} of {value} within {half_width}");
            }
        }
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
