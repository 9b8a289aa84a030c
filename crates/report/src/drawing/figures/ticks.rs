//! Where an axis is marked, and with which numbers.

use crate::drawing::numbers::{decimals, superscript};

/// Marks of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Ticks {
    /// Places and their numbers; without a number a line of the grid alone.
    pub at: Vec<(f64, String)>,
    /// The power of ten that the numbers are to be multiplied with.
    pub exponent: i32,
}

/// Numbers of axes that reach this far, or no farther than that, have their power of ten in the title.
const LARGE: f64 = 1e5;
const SMALL: f64 = 1e-2;

/// About `count` marks at multiples of 1, 2 or 5 times a power of ten.
pub fn linear([low, high]: [f64; 2], count: usize, whole: bool) -> Ticks {
    let step = nice_step((high - low) / count.max(1) as f64);
    let step = if whole { step.max(1.0) } else { step };
    let size = low.abs().max(high.abs());
    let exponent = if (SMALL..LARGE).contains(&size) { 0 } else { 3 * (size.log10() / 3.0).floor() as i32 };
    let unit = 10_f64.powi(exponent);
    let places = (-(step / unit).log10().floor()).max(0.0) as usize;
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let at = (0..=(last - first).clamp(0.0, 50.0) as i32)
        .map(|k| step * (first + f64::from(k)))
        .map(|x| (x, decimals(x / unit, places)))
        .collect();
    Ticks { at, exponent }
}

/// Whole decades where there are several; within two or fewer of them 1, 2, 5. Lines at every other multiple.
pub fn logarithmic([low, high]: [f64; 2], count: usize) -> Ticks {
    let decades = (high / low).log10();
    let named: &[u32] = if decades <= 2.5 { &[1, 2, 5] } else { &[1] };
    let every = (decades / count.max(1) as f64).ceil().max(1.0) as i32;
    let from = low.log10().floor() as i32;
    let mut at = Vec::new();
    for power in from..=high.log10().ceil() as i32 {
        for multiple in 1..10 {
            let x = f64::from(multiple) * 10_f64.powi(power);
            if x < low * (1.0 - 1e-9) || x > high * (1.0 + 1e-9) || (decades > 6.0 && multiple > 1) {
                continue;
            }
            let is_named = named.contains(&multiple) && power.rem_euclid(every) == 0;
            at.push((x, if is_named { power_of_ten(multiple, power) } else { String::new() }));
        }
    }
    Ticks { at, exponent: 0 }
}

/// 0.02, 500, 10⁻⁵.
fn power_of_ten(multiple: u32, power: i32) -> String {
    match power {
        -3..=4 => decimals(f64::from(multiple) * 10_f64.powi(power), usize::try_from(-power).unwrap_or(0)),
        _ if multiple == 1 => format!("10{}", superscript(power)),
        _ => format!("{multiple}·10{}", superscript(power)),
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `x`.
fn nice_step(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    let power = 10_f64.powf(x.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * power).find(|step| *step >= x * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(ticks: &Ticks) -> Vec<&str> {
        ticks.at.iter().map(|(_, text)| text.as_str()).filter(|text| !text.is_empty()).collect()
    }

    #[test]
    fn linear_marks_are_round_and_have_the_digits_they_need() {
        assert_eq!(named(&linear([-48.0, 11.0], 6, false)), ["−40", "−30", "−20", "−10", "0", "10"]);
        assert_eq!(named(&linear([0.0, 0.11], 6, false)), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]);
        assert_eq!(named(&linear([0.0, 3.0], 6, true)), ["0", "1", "2", "3"]);
        let large = linear([0.0, 3.1e5], 3, false);
        assert_eq!((named(&large), large.exponent), (vec!["0", "200"], 3));
    }

    #[test]
    fn logarithmic_marks_are_decades_or_one_two_five() {
        assert_eq!(named(&logarithmic([0.9, 60.0], 6)), ["1", "2", "5", "10", "20", "50"]);
        assert_eq!(named(&logarithmic([1e-5, 1e3], 4)), ["10⁻⁴", "0.01", "1", "100"]);
        assert_eq!(logarithmic([1.0, 10.0], 6).at.len(), 10);
    }
}
