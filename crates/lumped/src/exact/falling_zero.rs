//! Where a distance that is positive first meets zero.
//!
//! Events (a knot, a change of sign, the end of contact) are zeros of a distance along a motion whose value and rate
//! are both known in closed form or as a series. Newton's method needs a few evaluations there; the bracket keeps it
//! from leaving the step.

/// Steps below this share of the instant may be rounding.
const STALLED: f64 = 1e-10;

/// Zero of a function that is positive at `low` and not at `high`, by Newton's method kept inside the bracket.
///
/// `distance` gives value and rate. A Newton step that leaves the bracket, or that a rate of zero makes no number, is
/// replaced by the middle; ends when a step is two roundings of the instant, when small steps no longer shrink, which
/// is the rounding of the distance, or after 60.
///
/// `low` and `high` in s; the result lies between them, right to two roundings for a distance known to rounding.
pub(crate) fn falling_zero(mut low: f64, mut high: f64, distance: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut tau = 0.5 * (low + high);
    let mut before = f64::INFINITY;
    for _ in 0..60 {
        let (d, rate) = distance(tau);
        if d > 0.0 {
            low = tau;
        } else {
            high = tau;
        }
        let newton = tau - d / rate;
        let inside = newton > low && newton < high;
        let next = if inside { newton } else { 0.5 * (low + high) };
        let (step, wanted) = ((next - tau).abs(), (newton - tau).abs());
        // Newton's steps shrink by their square.
        let stalled = inside && before <= STALLED * tau && step >= 0.5 * before;
        if step.min(wanted) <= 2.0 * f64::EPSILON * tau || stalled {
            break;
        }
        (tau, before) = (next, if inside { step } else { f64::INFINITY });
    }
    tau
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_is_found_to_rounding_and_a_flat_start_does_not_stop_it() {
        // Two roundings of the answer, as the last step allows.
        let zero = falling_zero(0.0, 2.0, |t| (2.0 - t * t, -2.0 * t));
        assert!((zero - 2.0_f64.sqrt()).abs() <= 2.0 * f64::EPSILON * 1.5, "{zero}");
        // At the middle the rate is zero, and Newton's step no number.
        let zero = falling_zero(-1.0, 1.0, |t| (0.125 - t * t * t, -3.0 * t * t));
        assert!((zero - 0.5).abs() <= 2.0 * f64::EPSILON, "{zero}");
    }
}
