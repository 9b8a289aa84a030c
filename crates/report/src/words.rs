//! Numbers with their units and names of metrics.

use crate::drawing::numbers::{self, LONG_S, MILLI, NBSP, digits_of_interval};
pub use crate::drawing::numbers::{Rounding, at_most, decimals, signed, significant};
use crumple_artifact::records::IntervalSourceV1;
use crumple_signal::display::{decimals_shown, factor_shown, shown as in_display, unit_shown};
use crumple_signal::key_quantities::KeyQuantity;

/// Name in a record, name where that is not the name of the record with blanks.
const NAMES: [(&str, &str); 4] = [
    ("clip_3ms_contiguous", "3 ms clip, contiguous"),
    ("clip_3ms_cumulative", "3 ms clip, cumulative"),
    ("energy_equivalent_speed", "energy equivalent speed (EES, BEV)"),
    ("recorded_ees", "EES"),
];

/// Name in a record, trade name, for instance "HIC15".
const TRADE_NAMES: [(&str, &str); 17] = [
    ("asi", "ASI"),
    ("cora", "CORA"),
    ("gsi", "GSI"),
    ("hic", "HIC"),
    ("hic15", "HIC15"),
    ("hic36", "HIC36"),
    ("hic_d", "HIC(d)"),
    ("iso18571", "ISO/TS 18571"),
    ("oiv_x", "OIV x"),
    ("oiv_y", "OIV y"),
    ("olc", "OLC"),
    ("ora_x", "ORA x"),
    ("ora_y", "ORA y"),
    ("phd", "PHD"),
    ("sm25", "SM25"),
    ("thiv", "THIV"),
    ("vpi", "VPI"),
];

/// A value in SI with four significant digits in the unit people use.
pub fn value(value: f64, si: &str) -> String {
    let (factor, unit) = numbers::unit(si);
    with_unit(significant(factor * value, 4), unit)
}

/// A number with so many decimals and its unit, which metric pages have: `749.9 mm`, to a reader of inches `29.52 in`.
pub fn quantity(value: f64, places: usize, unit: &str) -> String {
    with_unit(cell(value, places, unit), unit_shown(unit))
}

/// The number of [`quantity`] alone, below the head of its column.
pub fn cell(value: f64, places: usize, unit: &str) -> String {
    decimals(factor_shown(unit) * value, decimals_shown(places, unit))
}

/// The same with its sign.
pub fn signed_cell(value: f64, places: usize, unit: &str) -> String {
    signed(factor_shown(unit) * value, decimals_shown(places, unit))
}

/// A number with so many significant digits and its unit: `656 kN`.
pub fn significant_quantity(value: f64, digits: usize, unit: &str) -> String {
    with_unit(significant(factor_shown(unit) * value, digits), unit_shown(unit))
}

/// A value in SI by the digits that its interval supports, if it has one, and with so many decimals at most: `749 mm`,
/// `700 mm` of 500 to 900. `shown`: factor to the unit, decimals, unit.
pub fn rounded(value: f64, ends: Option<(f64, f64)>, shown: (f64, usize, &'static str)) -> String {
    let shown = in_display(shown);
    with_unit(rounding(ends, shown).show(shown.0 * value), shown.2)
}

/// Ends of an interval or of a spread, SI, rounded as the value: `741 to 759`.
pub fn ends((low, high): (f64, f64), interval: Option<(f64, f64)>, shown: (f64, usize, &'static str)) -> String {
    let shown = in_display(shown);
    let [low, high] = [low, high].map(|end| rounding(interval, shown).show(shown.0 * end));
    between(&low, &high)
}

/// `750 mm (90 %: 741 to 759)`.
pub fn with_interval(
    value: f64,
    interval: Option<(f64, f64)>,
    source: Option<IntervalSourceV1>,
    quantity: &KeyQuantity,
) -> String {
    let number = rounded(value, interval, quantity.shown());
    let Some((low, high)) = interval else { return number };
    let level = level(source.and_then(IntervalSourceV1::level_percent));
    format!("{number} ({level}{})", ends((low, high), interval, quantity.shown()))
}

fn rounding(interval: Option<(f64, f64)>, (factor, places, _): (f64, usize, &str)) -> Rounding {
    Rounding::of_quantity(interval.map(|(low, high)| (factor * low, factor * high)), places)
}

/// A value in SI and its interval in the unit people use, with the digits that the interval supports: `749.9 mm` and
/// `741.2 to 759.3 mm`.
pub fn value_and_range(value: f64, (low, high): (f64, f64), si: &str) -> [String; 2] {
    let (factor, unit) = numbers::unit(si);
    let rounding = Rounding::of_interval(factor * low, factor * high).unwrap_or(Rounding::WITHOUT_INTERVAL);
    let [value, low, high] = [value, low, high].map(|number| rounding.show(factor * number));
    [with_unit(value, unit), with_unit(between(&low, &high), unit)]
}

/// A deviation with its sign and its unit.
pub fn deviation(value: f64, places: usize, unit: &str) -> String {
    with_unit(signed_cell(value, places, unit), unit_shown(unit))
}

/// Two values in SI in the unit people use: `741.2 to 759.3 mm`.
pub fn range(low: f64, high: f64, si: &str) -> String {
    let (factor, unit) = numbers::unit(si);
    let digits = digits_of_interval(low, high, 4);
    let [low, high] = [low, high].map(|end| significant(factor * end, digits));
    with_unit(between(&low, &high), unit)
}

/// `0.0 to 120.0 ms`, or in s where that is the fitting unit.
pub fn times(from_s: f64, to_s: f64) -> String {
    let (factor, unit) = if to_s - from_s > LONG_S { (1.0, "s") } else { (MILLI, "ms") };
    let [from, to] = [from_s, to_s].map(|time| decimals(factor * time, 1));
    format!("{} {unit}", between(&from, &to))
}

/// `low to high`.
pub fn between(low: &str, high: &str) -> String {
    format!("{low} to {high}")
}

/// `90 %: ` before an interval; nothing where it has no level.
pub fn level(percent: Option<u8>) -> String {
    percent.map_or_else(String::new, |percent| format!("{percent}{NBSP}%: "))
}

/// Name of a metric or a measured quantity: `peak_acceleration` is "peak acceleration", `hic15` by its trade name
/// "HIC15".
pub fn metric(name: &str) -> String {
    let word = TRADE_NAMES.iter().chain(&NAMES).find(|(known, _)| *known == name);
    match word {
        Some((_, word)) => (*word).to_owned(),
        None => name.replace('_', " "),
    }
}

/// A number with its unit; without one, the number alone.
pub fn with_unit(number: String, unit: &str) -> String {
    if unit.is_empty() { number } else { format!("{number}{NBSP}{unit}") }
}

/// `is` behind 1, `are` behind any other count.
pub fn verb(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::key_quantities::CRUSH;

    #[test]
    fn a_key_number_and_its_interval_end_at_one_place() {
        let crush = |value, low, high| with_interval(value, Some((low, high)), None, &CRUSH);
        assert_eq!(crush(0.7499, 0.7412, 0.7593), "750\u{a0}mm (741 to 759)");
        assert_eq!(crush(0.7439, 0.5412, 0.9593), "740\u{a0}mm (540 to 960)");
        assert_eq!(with_interval(0.7499, None, None, &CRUSH), "750\u{a0}mm");
        assert_eq!(ends((0.7311, 0.7522), Some((0.541, 0.959)), CRUSH.shown()), "730 to 750");
    }

    #[test]
    fn numbers_carry_their_unit() {
        assert_eq!(quantity(749.93, 1, "mm"), "749.9\u{a0}mm");
        assert_eq!(times(0.0, 0.0741), "0.0 to 74.1 ms");
        assert_eq!(range(0.7412, 0.7593, "m"), "741.2 to 759.3\u{a0}mm");
        assert_eq!(range(0.75, 0.75, "1"), "0.7500 to 0.7500");
        assert_eq!(value_and_range(0.7499, (0.7, 0.8), "m"), ["750\u{a0}mm", "700 to 800\u{a0}mm"]);
        assert_eq!((metric("delta_v"), metric("hic15")), ("delta v".to_owned(), "HIC15".to_owned()));
    }
}
