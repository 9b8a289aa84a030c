//! A line through points as the text of a path, in as few characters as its resolution takes.

/// Appends a start and the steps from each point to the next, in multiples of so many hundredths of a unit.
pub fn polyline(out: &mut String, points: &[[f64; 2]], hundredths_a_step: i64) {
    let rounded = |x: f64| (100.0 * x / hundredths_a_step as f64).round() as i64 * hundredths_a_step;
    let (mut last, mut before) = ([0_i64; 2], 0);
    for (place, point) in points.iter().enumerate() {
        let here = point.map(rounded);
        out.push_str(match place {
            0 => "M",
            1 => "l",
            _ => "",
        });
        let step = [here[0] - last[0], here[1] - last[1]];
        hundredths(out, step[0], (place > 1).then_some(before));
        hundredths(out, step[1], Some(step[0]));
        (last, before) = (here, step[1]);
    }
}

/// A number of hundredths as few characters: `3`, `-.25`, `1.5`. Between it and the previous number stands a blank,
/// unless it starts with a sign, or with a point after a number that has one already.
fn hundredths(out: &mut String, value: i64, previous: Option<i64>) {
    let (whole, part) = (value.unsigned_abs() / 100, value.unsigned_abs() % 100);
    let starts_with_a_point = whole == 0 && part > 0;
    if value < 0 {
        out.push('-');
    } else if previous.is_some_and(|before| !(starts_with_a_point && before % 100 != 0)) {
        out.push(' ');
    }
    if whole > 0 || part == 0 {
        digits(out, whole);
    }
    if part > 0 {
        out.push('.');
        out.push(digit(part / 10));
        if part % 10 > 0 {
            out.push(digit(part % 10));
        }
    }
}

/// A whole number: pages are mostly these, and formatting takes ten times as long.
fn digits(out: &mut String, number: u64) {
    if number >= 10 {
        digits(out, number / 10);
    }
    out.push(digit(number % 10));
}

/// The digit of a number below 10.
fn digit(number: u64) -> char {
    char::from(b'0' + number as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hundredths_are_short() {
        let text = |value, previous| {
            let mut out = String::new();
            hundredths(&mut out, value, previous);
            out
        };
        let after_3 = [300, -25, 0, 25].map(|value| text(value, Some(300)));
        assert_eq!(after_3, [" 3", "-.25", " 0", " .25"]);
        assert_eq!([1_205, -98_060].map(|value| text(value, None)), ["12.05", "-980.6"]);
        assert_eq!([text(150, None), text(25, Some(-150)), text(125, Some(150))], ["1.5", ".25", " 1.25"]);
    }

    #[test]
    fn steps_of_a_coarse_line_do_not_add_up_their_rounding() {
        let points: Vec<[f64; 2]> = (0..=30).map(|k| [f64::from(k) * 0.33, 1.0]).collect();
        let mut out = String::new();
        polyline(&mut out, &points, 10);
        let steps = out.split('l').nth(1).unwrap().split(' ').step_by(2);
        let sum: f64 = steps.map(|step| step.parse::<f64>().unwrap()).sum();
        assert!(out.starts_with("M0 1l.3 0 .4 0") && (sum - 9.9).abs() < 1e-9, "{out}");
    }
}
