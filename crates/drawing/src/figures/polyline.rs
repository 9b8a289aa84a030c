//! A line through points as the text of a path, in as few characters as its resolution takes.

use std::fmt::Write;

/// Appends a start and the steps from each point to the next, in multiples of so many hundredths of a unit.
pub fn polyline(out: &mut String, points: &[[f64; 2]], hundredths_a_step: i64) {
    let rounded = |x: f64| (100.0 * x / hundredths_a_step as f64).round() as i64 * hundredths_a_step;
    let mut last = [0_i64; 2];
    for (place, point) in points.iter().enumerate() {
        let here = point.map(rounded);
        out.push_str(match place {
            0 => "M",
            1 => "l",
            _ => "",
        });
        hundredths(out, here[0] - last[0], place > 1);
        hundredths(out, here[1] - last[1], true);
        last = here;
    }
}

/// A number of hundredths as few characters: `3`, `-.25`, `1.5`; a blank goes before what does not start with a sign.
fn hundredths(out: &mut String, value: i64, blank: bool) {
    if value < 0 {
        out.push('-');
    } else if blank {
        out.push(' ');
    }
    let (whole, part) = (value.unsigned_abs() / 100, value.unsigned_abs() % 100);
    if whole > 0 || part == 0 {
        let _ = write!(out, "{whole}");
    }
    if part > 0 {
        let _ = if part % 10 == 0 { write!(out, ".{}", part / 10) } else { write!(out, ".{part:02}") };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hundredths_are_short() {
        let text = |value, blank| {
            let mut out = String::new();
            hundredths(&mut out, value, blank);
            out
        };
        assert_eq!([text(300, true), text(-25, true), text(150, false), text(0, true)], [" 3", "-.25", "1.5", " 0"]);
    }

    #[test]
    fn steps_of_a_coarse_line_do_not_add_up_their_rounding() {
        let points: Vec<[f64; 2]> = (0..=30).map(|k| [f64::from(k) * 0.33, 1.0]).collect();
        let mut out = String::new();
        polyline(&mut out, &points, 10);
        let steps = out.split('l').nth(1).unwrap().split_whitespace().step_by(2);
        let sum: f64 = steps.map(|step| step.parse::<f64>().unwrap()).sum();
        assert!(out.starts_with("M0 1l.3 0 .4 0") && (sum - 9.9).abs() < 1e-9, "{out}");
    }
}
