//! Where a series on its step turns, falls through zero, is largest.

use crate::exact::falling_zero::falling_zero;
use crate::motion::collision::Extremum;
use crate::series::step::{ORDER, Series, horner, value, values};

/// Parts of a step on which a change of sign is looked for.
pub(crate) const PARTS: usize = 8;
/// A later value is larger if it is so by more than rounding: on a plateau the first counts.
const LARGER: f64 = 1.0 + 1e-14;

/// The ends of the parts of a step.
fn parts(length_s: f64) -> [f64; PARTS] {
    std::array::from_fn(|part| length_s * (part + 1) as f64 / PARTS as f64)
}

/// Visits the instants at which a series turns between `from` and the end of part `count`: an instant before, the
/// instant, and whether it is a lowest one. A part holds one at the most.
pub(crate) fn turns(
    series: &Series,
    from: f64,
    parts: &[f64; PARTS],
    count: usize,
    mut visit: impl FnMut(f64, f64, bool),
) {
    let rate: Series = std::array::from_fn(|k| if k < ORDER { (k + 1) as f64 * series[k + 1] } else { 0.0 });
    let (mut low, mut before) = (from, value(&rate, from));
    for (high, after) in parts[..count].iter().zip(values(&rate, parts)).filter(|(high, _)| **high > from) {
        if before * after < 0.0 {
            let sign = before.signum();
            let falling = |tau: f64| {
                let (rate, change) = horner(&rate, tau);
                (sign * rate, sign * change)
            };
            visit(low, falling_zero(low, *high, falling), sign < 0.0);
        }
        (low, before) = (*high, after);
    }
}

/// First instant within a step at which a quantity that was positive before is so no more. `is_positive`: whether it
/// was before the step, for at its start may stand the rounding of a zero; says so of its end.
pub(crate) fn falls(series: &Series, length_s: f64, is_positive: &mut bool) -> Option<f64> {
    let parts = parts(length_s);
    // The ends of the parts, and what is lowest within one: before its end.
    let mut looks = [f64::NAN; 2 * PARTS];
    for (look, end) in looks.iter_mut().skip(1).step_by(2).zip(parts) {
        *look = end;
    }
    turns(series, 0.0, &parts, PARTS, |_, bottom, is_lowest| {
        let part = parts.partition_point(|end| *end < bottom);
        if is_lowest && part < PARTS {
            looks[2 * part] = bottom;
        }
    });
    let mut low = 0.0;
    for high in looks.into_iter().filter(|look| !look.is_nan()) {
        let at = value(series, high);
        if *is_positive && at <= 0.0 {
            return Some(falling_zero(low, high, |tau| horner(series, tau)));
        }
        *is_positive = at > 0.0;
        low = high;
    }
    None
}

/// Takes the largest value of `size` of a quantity on a step that starts at `start_s`: at its ends, or inside where it
/// turns.
pub(crate) fn largest(series: &Series, size: fn(f64) -> f64, start_s: f64, length_s: f64, peak: &mut Extremum) {
    let mut see = |tau: f64| {
        let size = size(value(series, tau));
        if size > peak.value * LARGER {
            *peak = Extremum { time_s: start_s + tau, value: size };
        }
    };
    see(0.0);
    turns(series, 0.0, &parts(length_s), PARTS, |_, tau, _| see(tau));
    see(length_s);
}
