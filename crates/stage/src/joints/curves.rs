//! What rows compute from curves: values between samples, running integrals, delays.

use crumple_signal::Sampled;

/// Samples that a comparison looks at: more tell no more of a pulse, and a long record costs no more than a short one.
const LOOKED_AT: usize = 4096;

/// The value of a curve at a time, straight between samples; `None` outside of it.
pub(crate) fn value_at(curve: &Sampled, time_s: f64) -> Option<f64> {
    between(curve.t0_s(), curve.dt_s(), curve.samples(), time_s)
}

fn between(t0_s: f64, dt_s: f64, samples: &[f64], time_s: f64) -> Option<f64> {
    let place = (time_s - t0_s) / dt_s;
    // A time that is a sample's may lie a rounding beside it.
    let last = samples.len().checked_sub(1)? as f64;
    if !(-1e-6..=last + 1e-6).contains(&place) {
        return None;
    }
    let place = place.clamp(0.0, last);
    let (index, share) = (place.floor() as usize, place.fract());
    let next = samples.get(index + 1).copied().unwrap_or(samples[index]);
    Some(samples[index] + share * (next - samples[index]))
}

/// The end of a curve, s.
pub(crate) fn end_of(curve: &Sampled) -> f64 {
    curve.time_s(curve.len().saturating_sub(1))
}

/// The integral of a curve from its start to each sample, by the trapezoidal rule.
pub(crate) struct Running {
    t0_s: f64,
    dt_s: f64,
    sums: Vec<f64>,
}

impl Running {
    pub(crate) fn of(curve: &Sampled) -> Self {
        let mut sum = 0.0;
        let steps = curve.samples().windows(2).map(|pair| {
            sum += (pair[0] + pair[1]) / 2.0 * curve.dt_s();
            sum
        });
        Self { t0_s: curve.t0_s(), dt_s: curve.dt_s(), sums: std::iter::once(0.0).chain(steps).collect() }
    }

    /// The integral from `from_s` to `to_s`; `None` where the curve does not reach that far.
    pub(crate) fn over(&self, from_s: f64, to_s: f64) -> Option<f64> {
        let at = |time_s| between(self.t0_s, self.dt_s, &self.sums, time_s);
        Some(at(to_s)? - at(from_s)?)
    }
}

/// Times on the grid of a curve from `from_s` to `to_s`, not more than are looked at.
pub(crate) fn times(curve: &Sampled, from_s: f64, to_s: f64) -> impl Iterator<Item = f64> {
    let index = |time_s: f64| ((time_s - curve.t0_s()) / curve.dt_s()).clamp(0.0, curve.len() as f64);
    let (first, end) = (index(from_s).ceil() as usize, index(to_s).floor() as usize + 1);
    let end = end.min(curve.len());
    let stride = (end.saturating_sub(first)).div_ceil(LOOKED_AT).max(1);
    (first..end).step_by(stride).map(|index| curve.time_s(index))
}

/// Largest less least value of a curve over a part of it.
pub(crate) fn range(curve: &Sampled, from_s: f64, to_s: f64) -> f64 {
    let values = times(curve, from_s, to_s).filter_map(|time_s| value_at(curve, time_s));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    (high - low).max(0.0)
}

/// Largest difference of two courses over a part of a curve's time, with its place and both values there.
pub(crate) fn farthest(
    times: impl Iterator<Item = f64>,
    course: impl Fn(f64) -> Option<f64>,
    other: impl Fn(f64) -> Option<f64>,
) -> Option<(f64, f64, f64)> {
    let pairs = times.filter_map(|time_s| Some((time_s, course(time_s)?, other(time_s)?)));
    pairs.max_by(|a, b| (a.1 - a.2).abs().total_cmp(&(b.1 - b.2).abs()))
}

/// Longest delay that is looked for, s: later than this a pulse has another start, which is a row of its own.
const LONGEST_DELAY_S: f64 = 0.02;

/// Times of a pulse that are compared for its delay, s from contact.
const PULSE_S: (f64, f64) = (-0.05, 0.25);

/// By how much `late` lies behind `curve`, s: the place of the largest cross-correlation, between steps by a parabola.
///
/// A filter without phase has a symmetric response, so that the correlation of its output with its input is symmetric
/// about zero and largest there; a causal one moves it by its group delay. `None` where one of both is empty there.
pub(crate) fn delay_s(curve: &Sampled, late: &Sampled) -> Option<f64> {
    let from_s = PULSE_S.0.max(curve.t0_s()).max(late.t0_s());
    let to_s = PULSE_S.1.min(end_of(curve)).min(end_of(late));
    let step_s = (curve.dt_s().max(late.dt_s()) / 2.0).max((to_s - from_s) / 2048.0);
    let count = ((to_s - from_s) / step_s).floor();
    if !(count >= 16.0) {
        return None;
    }
    let sampled = |of: &Sampled| -> Option<Vec<f64>> {
        (0..count as usize).map(|k| value_at(of, from_s + k as f64 * step_s)).collect()
    };
    let (a, b) = (sampled(curve)?, sampled(late)?);
    let lags = ((LONGEST_DELAY_S / step_s) as usize).min(a.len() / 4).max(1);
    // At a positive lag the late curve is read so much later. Both ends are left out alike at every lag, with one step
    // more for the parabola.
    let product = |lag: isize| -> f64 {
        let middle = lags + 1..a.len() - lags - 1;
        middle.map(|k| a[k] * b[k.saturating_add_signed(lag)]).sum()
    };
    let lags = lags as isize;
    let best = (-lags..=lags).max_by(|x, y| product(*x).total_cmp(&product(*y)))?;
    let (before, at, after) = (product(best - 1), product(best), product(best + 1));
    let curvature = before - 2.0 * at + after;
    let beside = if best.abs() < lags && curvature < 0.0 { (before - after) / (2.0 * curvature) } else { 0.0 };
    Some((best as f64 + beside) * step_s)
}
