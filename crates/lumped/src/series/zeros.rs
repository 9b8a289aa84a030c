//! Where a series on its step falls through zero, and where it is largest.

use crate::exact::falling_zero::falling_zero;
use crate::motion::collision::Extremum;
use crate::series::step::{ORDER, Series, horner, value, values};

/// Parts of a step on which a change of sign is looked for.
const PARTS: usize = 8;
/// A later value is larger if it is so by more than rounding: on a plateau the first counts.
const LARGER: f64 = 1.0 + 1e-14;

/// The ends of the parts of a step.
fn parts(length_s: f64) -> [f64; PARTS] {
    std::array::from_fn(|part| length_s * (part + 1) as f64 / PARTS as f64)
}

/// First instant within a step at which a quantity that was positive before is so no more. `is_positive`: whether it
/// was before the step, for at its start may stand the rounding of a zero; says so of its end.
pub(crate) fn falls(series: &Series, length_s: f64, is_positive: &mut bool) -> Option<f64> {
    let mut low = 0.0;
    for (high, at) in parts(length_s).into_iter().zip(values(series, &parts(length_s))) {
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
    let rate: Series = std::array::from_fn(|k| if k < ORDER { (k + 1) as f64 * series[k + 1] } else { 0.0 });
    let mut see = |tau: f64| {
        let size = size(value(series, tau));
        if size > peak.value * LARGER {
            *peak = Extremum { time_s: start_s + tau, value: size };
        }
    };
    see(0.0);
    let (mut low, mut before) = (0.0, rate[0]);
    for (high, after) in parts(length_s).into_iter().zip(values(&rate, &parts(length_s))) {
        if before * after < 0.0 {
            let sign = before.signum();
            let falling = |tau: f64| {
                let (rate, change) = horner(&rate, tau);
                (sign * rate, sign * change)
            };
            see(falling_zero(low, high, falling));
        }
        (low, before) = (high, after);
    }
    see(length_s);
}
