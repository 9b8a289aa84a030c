//! The vehicle pulse index: an occupant on a belt with slack, moved by the pulse.
//!
//! The index is the largest belt force over the occupant's mass: what a pulse does to somebody restrained, in one
//! number.

use crumple_signal::{Acceleration, Signal};

use crate::Metric;
use crate::metric::definitions::VPI;

/// The occupant and belt of the vehicle pulse index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VpiOptions {
    /// Slack of the belt, m.
    pub slack_m: f64,
    /// Stiffness of the belt, N/m.
    pub stiffness_n_per_m: f64,
    /// Mass of the occupant, kg.
    pub mass_kg: f64,
}

impl Default for VpiOptions {
    fn default() -> Self {
        Self { slack_m: 0.03, stiffness_n_per_m: 2500.0, mass_kg: 1.0 }
    }
}

/// Longest step, in radians of the belt's oscillation: one extreme of the elongation a step.
const LONGEST_STEP_RAD: f64 = 0.5;

/// Vehicle pulse index, m/s²; the window is the moment of the largest belt force, from time zero.
///
/// A mass that flies free until the slack is used up, then hangs on a linear spring: `d'' = -a - ω²·max(0, d - s)`,
/// `d(0) = d'(0) = 0`, `VPI = max ω²·(d - s)`. Solved exactly for an acceleration that is linear between samples:
/// cubic in free flight, sine and cosine on the belt; what remains is the sampling, O(T²). Constant deceleration a:
/// `a + sqrt(a² + 2·a·s·ω²)`. Starts at the first sample at or after time zero. A record that ends while the belt
/// still stretches gives a lower bound, and says so. ISO/TR 12353-3.
pub fn vpi(acceleration: &Signal<Acceleration>, time_zero_s: f64, options: VpiOptions) -> Metric {
    let zero = acceleration.index_at_or_after(time_zero_s);
    let a = &acceleration.samples()[zero..];
    let dt = acceleration.dt_s();
    let omega = (options.stiffness_n_per_m / options.mass_kg).sqrt();
    if !(omega > 0.0 && omega.is_finite() && options.slack_m >= 0.0) {
        return Metric::absent(&VPI, "mass and stiffness of the occupant must be positive, the slack not negative");
    }
    if omega * dt > LONGEST_STEP_RAD {
        return Metric::absent(&VPI, &format!("the sampling interval of {dt} s is too long for this belt"));
    }

    // u = d - s: belt elongation when positive.
    let (mut u, mut rate) = (-options.slack_m, 0.0);
    let (mut largest, mut at_s) = (0.0, None);
    // Nearly every step is a whole interval: its sine and cosine are computed once.
    let whole = (dt, (omega * dt).sin_cos());
    for (k, pair) in a.windows(2).enumerate() {
        let mut start = Segment { u, rate, a: pair[0], slope: (pair[1] - pair[0]) / dt, omega, whole };
        let (mut done, mut left) = (0.0, dt);
        // Free flight and belt alternate at most a few times in one interval; each part is exact.
        for _ in 0..8 {
            let part = start.until_contact_changes(left);
            if start.on_belt() {
                let top = start.top(part).unwrap_or(part);
                let height = start.at(top).0;
                if height > largest {
                    (largest, at_s) = (height, Some(acceleration.time_s(zero + k) + done + top));
                }
            }
            let (u_end, rate_end) = start.at(part);
            done += part;
            left -= part;
            start = Segment {
                // At a change of contact the elongation is zero; the sign of the rate says what follows.
                u: if left > 0.0 { 0.0 } else { u_end },
                rate: rate_end,
                a: start.a + start.slope * part,
                ..start
            };
            if left <= 0.0 {
                break;
            }
        }
        (u, rate) = (start.u, start.rate);
    }
    let Some(at_s) = at_s else {
        return Metric::absent(&VPI, &format!("the slack of {} m is not used up in the record", options.slack_m));
    };
    let index = Metric::with_value(&VPI, omega * omega * largest).over(at_s - time_zero_s, at_s - time_zero_s);
    if u >= largest && rate > 0.0 {
        return index.remarked("lower bound: the record ends while the belt still stretches");
    }
    index
}

/// One stretch of the motion with a linear vehicle acceleration `a + slope·τ`.
#[derive(Debug, Clone, Copy)]
struct Segment {
    u: f64,
    rate: f64,
    a: f64,
    slope: f64,
    omega: f64,
    /// A sampling interval, with sine and cosine of the belt's oscillation over it.
    whole: (f64, (f64, f64)),
}

impl Segment {
    /// Whether the belt carries load: the slack is used up, or is just now.
    fn on_belt(&self) -> bool {
        self.u > 0.0 || (self.u == 0.0 && (self.rate > 0.0 || (self.rate == 0.0 && self.a < 0.0)))
    }

    /// Elongation and its rate after τ, as long as the contact does not change.
    fn at(&self, tau: f64) -> (f64, f64) {
        let Self { u, rate, a, slope, omega, whole } = *self;
        if !self.on_belt() {
            return (u + tau * (rate - tau * (a / 2.0 + tau * slope / 6.0)), rate - tau * (a + tau * slope / 2.0));
        }
        // Particular solution p + q·τ with ω²(p + qτ) = -(a + slope·τ).
        let (p, q) = (-a / (omega * omega), -slope / (omega * omega));
        let (sine, cosine) = if tau == whole.0 { whole.1 } else { (omega * tau).sin_cos() };
        let (c, s) = (u - p, (rate - q) / omega);
        (p + q * tau + c * cosine + s * sine, q + omega * (s * cosine - c * sine))
    }

    /// The part of `left` until the elongation changes sign; `left` if it does not.
    fn until_contact_changes(&self, left: f64) -> f64 {
        let belt = self.on_belt();
        let other = |u: f64| if belt { u < 0.0 } else { u > 0.0 };
        if !other(self.at(left).0) {
            return left;
        }
        bisect(left, |tau| other(self.at(tau).0))
    }

    /// The moment of largest elongation inside `part`, if the rate passes zero downwards there.
    fn top(&self, part: f64) -> Option<f64> {
        (self.rate > 0.0 && self.at(part).1 < 0.0).then(|| bisect(part, |tau| self.at(tau).1 < 0.0))
    }
}

/// The first of two neighbouring numbers in `0..=high` at which `passed` is true; it is true at `high`.
fn bisect(mut high: f64, passed: impl Fn(f64) -> bool) -> f64 {
    let mut low = 0.0;
    // Each step halves the interval: 60 steps reach the last bit of an interval that starts at zero.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if passed(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(a: f64, n: usize, dt: f64) -> Metric {
        vpi(&Signal::new(0.0, dt, vec![-a; n]).unwrap(), 0.0, VpiOptions::default())
    }

    #[test]
    fn a_constant_deceleration_is_met_exactly_at_any_rate() {
        for (a, dt) in [(200.0, 1e-4), (50.0, 5e-3), (431.7, 1e-3)] {
            let exact = a + (a * a + 2.0 * a * 0.03 * 2500.0_f64).sqrt();
            // No error of the rule is left: rounding of some hundred steps.
            let index = constant(a, (0.2 / dt) as usize, dt).value.unwrap();
            assert!((index / exact - 1.0).abs() < 1e-11, "{index} {exact}");
        }
    }

    #[test]
    fn a_record_that_ends_early_gives_a_lower_bound_or_nothing() {
        let early = constant(200.0, 400, 1e-4);
        assert!(early.value.is_some() && early.definition.ends_with("while the belt still stretches"));
        assert_eq!(constant(200.0, 100, 1e-4).definition, "absent: the slack of 0.03 m is not used up in the record");
        assert!(constant(200.0, 100, 0.1).value.is_none());
    }
}
