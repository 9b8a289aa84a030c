//! The load of an occupant behind a restraint, from the pulse alone: OLC and the vehicle pulse index.
//!
//! The occupant load criterion.
//!
//! The occupant flies free over 65 mm and is then brought to the speed of the vehicle at a constant deceleration over
//! 235 mm of restraint: that deceleration is the criterion.
//!
//! The vehicle pulse index: an occupant on a belt with slack, moved by the pulse.
//!
//! The index is the largest belt force over the occupant's mass: what a pulse does to somebody restrained, in one
//! number.

use crumple_signal::{Acceleration, Displacement, Signal, Velocity};

use crate::metric::definitions::{OLC, VPI};
use crate::metric::value::same_grid;
use crate::{Metric, MetricsError};

/// The two lengths of the occupant load criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OlcOptions {
    /// Free flight, m: 65 mm.
    pub free_flight_m: f64,
    /// Travel in the restraint, m: 235 mm (0.0235 in a tool's manual is a misprint).
    pub restraint_m: f64,
}

impl Default for OlcOptions {
    fn default() -> Self {
        Self { free_flight_m: 0.065, restraint_m: 0.235 }
    }
}

/// Occupant load criterion, m/s²; window t1..t2 from contact, t = 0.
///
/// With `s(t) = ∫ (v0 - v) dt = v0·t - x`: free flight at v0 until `s(t1)` = 65 mm; then a constant deceleration that
/// ends, after 235 mm more, at the vehicle's own speed: the first root t2 of `G(t) = s - (v0 - v)·(t - t1)/2 - 0.3 m`,
/// and `OLC = (v0 - v(t2))/(t2 - t1)`. s, G and v are linear between samples; t1 and t2 on the grid would err by 0.3 %.
/// Constant deceleration a: `t1 = sqrt(0.13/a)`, `t2 = 0.6/(a·t1)`. Absent where a length is not reached.
/// Euro NCAP TB 027.
pub fn olc(
    velocity: &Signal<Velocity>,
    displacement: &Signal<Displacement>,
    impact_speed_m_per_s: f64,
    options: OlcOptions,
) -> Result<Metric, MetricsError> {
    same_grid(("the velocity", velocity), ("the displacement", displacement))?;
    let (v, x, v0) = (velocity.samples(), displacement.samples(), impact_speed_m_per_s);
    let OlcOptions { free_flight_m, restraint_m } = options;
    let t = |k: usize| velocity.time_s(k);
    let s = |k: usize| v0 * t(k) - x[k];

    let zero = velocity.index_at_or_after(0.0);
    let Some(k1) = (zero..v.len()).find(|&k| s(k) >= free_flight_m) else {
        return Ok(Metric::absent(&OLC, &format!("the free flight of {free_flight_m} m is not reached in the record")));
    };
    let (t1, v1) = if k1 > zero {
        let w = (free_flight_m - s(k1 - 1)) / (s(k1) - s(k1 - 1));
        (t(k1 - 1) + w * velocity.dt_s(), v[k1 - 1] + w * (v[k1] - v[k1 - 1]))
    } else {
        (t(k1), v[k1])
    };

    let g = |k: usize| s(k) - (v0 - v[k]) * (t(k) - t1) / 2.0 - free_flight_m - restraint_m;
    let mut before = (t1, v1, -restraint_m);
    for (k, &v_now) in v.iter().enumerate().skip(k1) {
        let now = (t(k), v_now, g(k));
        if now.2 >= 0.0 && now.0 > before.0 {
            let w = -before.2 / (now.2 - before.2);
            let t2 = before.0 + w * (now.0 - before.0);
            let v2 = before.1 + w * (now.1 - before.1);
            return Ok(Metric::with_value(&OLC, (v0 - v2) / (t2 - t1)).over(t1, t2));
        }
        before = now;
    }
    Ok(Metric::absent(&OLC, &format!("the restraint travel of {restraint_m} m is not reached in the record")))
}

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

/// Vehicle pulse index, m/s²; the window is the moment of the largest belt force, from contact, t = 0.
///
/// A mass that flies free until the slack is used up, then hangs on a linear spring: `d'' = -a - ω²·max(0, d - s)`,
/// `d(0) = d'(0) = 0`, `VPI = max ω²·(d - s)`. Solved exactly for an acceleration that is linear between samples:
/// cubic in free flight, sine and cosine on the belt; what remains is the sampling, O(T²). Constant deceleration a:
/// `a + sqrt(a² + 2·a·s·ω²)`. Starts at the first sample at or after contact. A record that ends while the belt
/// still stretches gives a lower bound, and says so. ISO/TR 12353-3.
pub fn vpi(acceleration: &Signal<Acceleration>, options: VpiOptions) -> Metric {
    followed(acceleration, options, gains)
}

/// The index, followed as long as `gains` of the samples and their interval say that it may still grow.
fn followed(acceleration: &Signal<Acceleration>, options: VpiOptions, gains: fn(&[f64], f64) -> Vec<f64>) -> Metric {
    let zero = acceleration.index_at_or_after(0.0);
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
    let (mut u, mut rate) = (-options.slack_m, 0.0_f64);
    let (mut largest, mut at_s) = (0.0, None);
    // Nearly every step is a whole interval: its sine and cosine are computed once.
    let whole = (dt, (omega * dt).sin_cos());
    let omega_squared = omega * omega;
    let gains = gains(a, dt);
    for (k, pair) in a.windows(2).enumerate() {
        // What is left of the pulse may add less to the oscillation than the largest elongation is above it.
        if k % BLOCK == 0 {
            let oscillation = rate.hypot(omega * f64::max(u, 0.0));
            if (oscillation + gains[k / BLOCK]) * (1.0 + 1e-9) < omega * largest {
                break;
            }
        }
        let (mut vehicle, slope) = (pair[0], (pair[1] - pair[0]) / dt);
        let (mut done, mut left) = (0.0, dt);
        // Free flight and belt alternate at most a few times in one interval; each part is exact.
        for _ in 0..8 {
            let segment = Segment::new(u, rate, vehicle, slope, (omega, omega_squared), whole);
            let (part, end) = segment.until_contact_changes(left);
            if segment.is_on_belt {
                let (top, height) = segment.top(part, end).map_or((part, end.0), |top| (top, segment.at(top).0));
                if height > largest {
                    (largest, at_s) = (height, Some(acceleration.time_s(zero + k) + done + top));
                }
            }
            done += part;
            left -= part;
            // At a change of contact the elongation is zero; the sign of the rate says what follows.
            (u, rate) = (if left > 0.0 { 0.0 } else { end.0 }, end.1);
            vehicle += slope * part;
            if left <= 0.0 {
                break;
            }
        }
    }
    let Some(at_s) = at_s else {
        return Metric::absent(&VPI, &format!("the slack of {} m is not used up in the record", options.slack_m));
    };
    let index = Metric::with_value(&VPI, omega * omega * largest).over(at_s, at_s);
    if u >= largest && rate > 0.0 {
        return index.as_lower_bound("lower bound: the record ends while the belt still stretches");
    }
    index
}

/// Samples between two looks at what may still come.
const BLOCK: usize = 64;

/// From the first sample of every block on the integral of |a|, m/s: the most by which `sqrt(d'² + ω²·max(0, d - s)²)`
/// may grow, on the belt and in free flight.
fn gains(a: &[f64], dt: f64) -> Vec<f64> {
    let mut left = 0.0;
    let mut gains: Vec<f64> = a
        .chunks(BLOCK)
        .rev()
        .map(|block| {
            // An interval counts half of both of its samples, a line between them is below that.
            left += dt * block.iter().map(|a| a.abs()).sum::<f64>();
            left
        })
        .collect();
    gains.reverse();
    gains
}

/// One stretch of the motion with a linear vehicle acceleration `a + slope·τ`.
#[derive(Debug, Clone, Copy)]
struct Segment {
    u: f64,
    rate: f64,
    a: f64,
    slope: f64,
    omega: f64,
    /// Whether the belt carries load: the slack is used up, or is just now.
    is_on_belt: bool,
    /// On the belt `p + q·τ + c·cos(ωτ) + s·sin(ωτ)`: the particular solution `ω²(p + qτ) = -(a + slope·τ)` and what is
    /// left of the start.
    belt: [f64; 4],
    /// A sampling interval, with sine and cosine of the belt's oscillation over it.
    whole: (f64, (f64, f64)),
}

impl Segment {
    fn new(
        u: f64,
        rate: f64,
        a: f64,
        slope: f64,
        (omega, omega_squared): (f64, f64),
        whole: (f64, (f64, f64)),
    ) -> Self {
        let is_on_belt = u > 0.0 || (u == 0.0 && (rate > 0.0 || (rate == 0.0 && a < 0.0)));
        let mut belt = [0.0; 4];
        if is_on_belt {
            let (p, q) = (-a / omega_squared, -slope / omega_squared);
            belt = [p, q, u - p, (rate - q) / omega];
        }
        Self { u, rate, a, slope, omega, is_on_belt, belt, whole }
    }

    /// Elongation and its rate after τ, as long as the contact does not change.
    fn at(&self, tau: f64) -> (f64, f64) {
        let Self { u, rate, a, slope, omega, is_on_belt, belt: [p, q, c, s], whole } = *self;
        if !is_on_belt {
            return (u + tau * (rate - tau * (a / 2.0 + tau * slope / 6.0)), rate - tau * (a + tau * slope / 2.0));
        }
        let (sine, cosine) = if tau == whole.0 { whole.1 } else { (omega * tau).sin_cos() };
        (p + q * tau + c * cosine + s * sine, q + omega * (s * cosine - c * sine))
    }

    /// The part of `left` until the elongation changes sign, `left` if it does not, and elongation and rate there.
    fn until_contact_changes(&self, left: f64) -> (f64, (f64, f64)) {
        let has_changed = |u: f64| if self.is_on_belt { u < 0.0 } else { u > 0.0 };
        let end = self.at(left);
        if !has_changed(end.0) {
            return (left, end);
        }
        let part = bisect(left, |tau| has_changed(self.at(tau).0));
        (part, self.at(part))
    }

    /// The moment of largest elongation inside `part`, if the rate passes zero downwards there.
    fn top(&self, part: f64, end: (f64, f64)) -> Option<f64> {
        (self.rate > 0.0 && end.1 < 0.0).then(|| bisect(part, |tau| self.at(tau).1 < 0.0))
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

    fn constant(a: f64, v0: f64, n: usize, dt: f64) -> Metric {
        let at = |k: usize| k as f64 * dt;
        let v = Signal::new(0.0, dt, (0..n).map(|k| v0 - a * at(k)).collect()).unwrap();
        let x = Signal::new(0.0, dt, (0..n).map(|k| v0 * at(k) - a * at(k) * at(k) / 2.0).collect()).unwrap();
        olc(&v, &x, v0, OlcOptions::default()).unwrap()
    }

    #[test]
    fn a_constant_deceleration_follows_the_formula() {
        for a in [50.0, 200.0, 431.0] {
            let olc = constant(a, 30.0, 4000, 1e-4);
            let t1 = (0.13_f64 / a).sqrt();
            let t2 = 0.6 / (a * t1);
            let window = olc.window.unwrap();
            // s is quadratic, its chord is off by a·T²/8 = 5e-7 m of slopes above 2 m/s.
            assert!((window.from_s - t1).abs() < 2e-7 && (window.to_s - t2).abs() < 1e-6, "{window:?}");
            assert!((olc.value.unwrap() / (a * t2 / (t2 - t1)) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn a_pulse_that_is_too_short_or_too_soft_says_which_length_is_missing() {
        assert_eq!(
            constant(200.0, 30.0, 200, 1e-4).definition,
            "absent: the free flight of 0.065 m is not reached in the record"
        );
        assert_eq!(
            constant(200.0, 30.0, 400, 1e-4).definition,
            "absent: the restraint travel of 0.235 m is not reached in the record"
        );
    }

    fn constant_pulse(a: f64, n: usize, dt: f64) -> Metric {
        vpi(&Signal::new(0.0, dt, vec![-a; n]).unwrap(), VpiOptions::default())
    }

    #[test]
    fn a_constant_deceleration_is_met_exactly_at_any_rate() {
        for (a, dt) in [(200.0, 1e-4), (50.0, 5e-3), (431.7, 1e-3)] {
            let exact = a + (a * a + 2.0 * a * 0.03 * 2500.0_f64).sqrt();
            // No error of the rule is left: rounding of some hundred steps.
            let index = constant_pulse(a, (0.2 / dt) as usize, dt).value.unwrap();
            assert!((index / exact - 1.0).abs() < 1e-11, "{index} {exact}");
        }
    }

    #[test]
    fn not_to_follow_what_cannot_outdo_the_largest_changes_no_bit() {
        // Three pushes of 20 to 80 ms each, noise, a wrong zero level: one of the pushes decides, and it is each of
        // them.
        let share = |number: u32, stream: f64| (f64::from(number) * stream).fract();
        let mut decided_by = [0; 3];
        for number in 1..200 {
            let push = |k: usize, place: u32| {
                let from = 0.15 * f64::from(place);
                let (height, length) =
                    (300.0 * share(number * 3 + place, 0.618_034), 0.02 + 0.06 * share(number * 3 + place, 0.754_878));
                let phase = (k as f64 * 1e-4 - from) / length;
                if (0.0..1.0).contains(&phase) { -height * (phase * std::f64::consts::PI).sin() } else { 0.0 }
            };
            let rest = |k: usize| 4.0 * (share(number, 0.324_718) - 0.5) + 3.0 * (k as f64 * 0.7).sin();
            let sample = |k: usize| (0..3).map(|place| push(k, place)).sum::<f64>() + rest(k);
            let a = Signal::new(0.0, 1e-4, (0..5000).map(sample).collect()).unwrap();
            let to_the_end = followed(&a, VpiOptions::default(), |a, _| vec![f64::INFINITY; a.len()]);
            assert_eq!(vpi(&a, VpiOptions::default()), to_the_end, "{number}");
            decided_by[(to_the_end.window.map_or(0.0, |window| window.to_s) / 0.15) as usize % 3] += 1;
        }
        assert!(decided_by.iter().all(|count| *count > 5), "{decided_by:?}");
    }

    #[test]
    fn a_record_that_ends_early_gives_a_lower_bound_or_nothing() {
        let early = constant_pulse(200.0, 400, 1e-4);
        assert!(early.value.is_some() && early.definition.ends_with("while the belt still stretches"));
        assert_eq!(
            constant_pulse(200.0, 100, 1e-4).definition,
            "absent: the slack of 0.03 m is not used up in the record"
        );
        assert!(constant_pulse(200.0, 100, 0.1).value.is_none());
    }
}
