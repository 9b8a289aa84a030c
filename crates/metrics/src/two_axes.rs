//! A change of velocity along two axes: its total, and the direction from which the force came.

use crumple_signal::Sampled;

use crate::metric::definitions::{DIRECTION_OF_FORCE, LATERAL_OF_TOTAL, TOTAL_DELTA_V};
use crate::{Interval, IntervalBy, Metric};

/// Last moment that counts, s from contact (49 CFR 563.5).
pub(crate) const LAST_S: f64 = 0.3;
/// Angle of an hour of a clock, degrees.
const HOUR: f64 = 30.0;
/// Less to one side than this is straight ahead, degrees: half of what is printed.
const STRAIGHT: f64 = 0.5;

/// The first row from contact on, and what counts as zero: the value at contact where the table begins before it.
pub(crate) fn row_at_contact(change: &Sampled) -> (usize, f64) {
    // 1e-6 of a sample: the slack of decimal time stamps.
    let first = change.index_at_or_after(-1e-6 * change.dt_s());
    let start = if first > 0 { change.samples().get(first).copied().unwrap_or(0.0) } else { 0.0 };
    (first, start)
}

/// The largest change of velocity in the plane, m/s, its part along y, and the angle at which its force came, degrees.
///
/// `along` is a change of velocity along x (a frontal impact is negative), `across` one along y (to the right is
/// positive, SAE J211), both m/s. The total is the largest `sqrt(x² + y²)` at a sample of `along` from contact to
/// `until_s`, 300 ms at most (49 CFR 563.5 of the resultant). A force acts along the change of velocity, so it came
/// from `atan2(|y|, -x)` off straight ahead: 0 from ahead, 90 from a side, 180 from behind. The side and the hour of
/// the clock (SAE J224) stand in the definition. `half_steps` are the half widths of what is known of both, m/s: the
/// interval goes over their corners.
pub fn total_and_direction(
    along: &Sampled,
    across: &Sampled,
    until_s: f64,
    half_steps: Option<[f64; 2]>,
) -> [Metric; 3] {
    let (first_x, x0) = row_at_contact(along);
    let (_, y0) = row_at_contact(across);
    let last_s = until_s.min(LAST_S) + 1e-6 * along.dt_s();
    let pairs = (first_x..along.len()).take_while(|k| along.time_s(*k) <= last_s).filter_map(|k| {
        let time_s = along.time_s(k);
        Some((time_s, along.samples()[k] - x0, across.at(time_s)? - y0))
    });
    let largest = pairs.reduce(|a, b| if b.1.hypot(b.2) > a.1.hypot(a.2) { b } else { a });
    let Some((time_s, x, y)) = largest.filter(|(_, x, y)| x.hypot(*y) > 0.0) else {
        let why = "no change of velocity along both axes from time zero on";
        return [&TOTAL_DELTA_V, &LATERAL_OF_TOTAL, &DIRECTION_OF_FORCE]
            .map(|definition| Metric::absent(definition, why));
    };
    let angle = |x: f64, y: f64| y.abs().atan2(-x).to_degrees();
    let corners = half_steps.map(|[of_x, of_y]| {
        let near = (y.abs() - of_y).max(0.0);
        let ends = [[x - of_x, near], [x - of_x, y.abs() + of_y], [x + of_x, near], [x + of_x, y.abs() + of_y]];
        let least = [(x.abs() - of_x).max(0.0), near];
        (least[0].hypot(near), (x.abs() + of_x).hypot(y.abs() + of_y), ends.map(|[x, y]| angle(x, y)))
    });
    let of_total = corners.map(|(low, high, _)| Interval { low, high, by: IntervalBy::Resolution });
    let of_angle = corners.map(|(_, _, ends)| Interval {
        low: ends.into_iter().fold(f64::INFINITY, f64::min),
        high: ends.into_iter().fold(0.0, f64::max),
        by: IntervalBy::Resolution,
    });
    let degrees = angle(x, y);
    // What pushes the vehicle to the right came from its left.
    let side = match y {
        _ if !(STRAIGHT..=180.0 - STRAIGHT).contains(&degrees) => "",
        y if y > 0.0 => "from the left, ",
        _ => "from the right, ",
    };
    let clockwise = if y > 0.0 { 360.0 - degrees } else { degrees };
    let hour = match (clockwise / HOUR).round() as u32 % 12 {
        0 => 12,
        hour => hour,
    };
    let total = Metric::with_value(&TOTAL_DELTA_V, x.hypot(y)).over(time_s, time_s);
    let lateral = Metric::with_value(&LATERAL_OF_TOTAL, y).over(time_s, time_s);
    let of_lateral = half_steps.map(|[_, of_y]| Interval { low: y - of_y, high: y + of_y, by: IntervalBy::Resolution });
    let direction = Metric::with_value(&DIRECTION_OF_FORCE, degrees).over(time_s, time_s);
    [
        Metric { interval: of_total, ..total },
        Metric { interval: of_lateral, ..lateral },
        Metric { interval: of_angle, ..direction.remarked(&format!("{side}{hour} o'clock")) },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(km_per_h: f64) -> Sampled {
        let at = |k: usize| km_per_h / 3.6 * (k as f64 / 10.0).min(1.0);
        Sampled::new(0.0, 0.01, (0..20).map(at).collect()).unwrap()
    }

    fn of(x: f64, y: f64) -> [Metric; 3] {
        total_and_direction(&ramp(x), &ramp(y), f64::INFINITY, Some([0.5 / 3.6; 2]))
    }

    #[test]
    fn total_side_and_hour() {
        let [total, lateral, direction] = of(-45.0, 18.0);
        assert!((3.6 * lateral.value.unwrap() - 18.0).abs() < 1e-9);
        assert!((3.6 * total.value.unwrap() - 2349.0_f64.sqrt()).abs() < 1e-9);
        assert!((direction.value.unwrap() - 0.4_f64.atan().to_degrees()).abs() < 1e-9);
        assert!(direction.definition.ends_with("from the left, 11 o'clock"), "{}", direction.definition);
        // By hand: 44.5 and 17.5 at least, 45.5 and 18.5 at most; the angle the other way round.
        let Interval { low, high, .. } = total.interval.unwrap();
        assert!((3.6 * low - 44.5_f64.hypot(17.5)).abs() < 1e-9 && (3.6 * high - 45.5_f64.hypot(18.5)).abs() < 1e-9);
        let Interval { low, high, .. } = direction.interval.unwrap();
        assert!((low - (17.5_f64 / 45.5).atan().to_degrees()).abs() < 1e-9);
        assert!((high - (18.5_f64 / 44.5).atan().to_degrees()).abs() < 1e-9);
    }

    #[test]
    fn each_side_has_its_hour() {
        for (x, y, degrees, words) in [
            (-40.0, 0.0, 0.0, ": 12 o'clock"),
            (0.0, -20.0, 90.0, "from the right, 3 o'clock"),
            (0.0, 20.0, 90.0, "from the left, 9 o'clock"),
            (30.0, 0.0, 180.0, ": 6 o'clock"),
            (-20.0, -20.0, 45.0, "from the right, 2 o'clock"),
        ] {
            let [_, lateral, direction] = of(x, y);
            assert!((direction.value.unwrap() - degrees).abs() < 1e-9, "{x} {y}");
            let hour = words.trim_start_matches(": ");
            assert!(direction.definition.ends_with(hour), "{x} {y}: {}", direction.definition);
            assert_eq!(direction.definition.contains(" the left,"), lateral.value > Some(0.0), "{x} {y}");
            assert_eq!(direction.definition.contains(" the right,"), lateral.value < Some(0.0), "{x} {y}");
        }
    }

    #[test]
    fn what_does_not_move_has_no_direction() {
        assert!(of(0.0, 0.0).iter().all(|metric| metric.value.is_none()));
    }
}
