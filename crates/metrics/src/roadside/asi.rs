//! The acceleration severity index of EN 1317, versions of 1998 and 2010.

use std::f64::consts::SQRT_2;

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Signal, phaseless_low_pass};

use crate::metric::definitions::{ASI_1998, ASI_2010, ASI_2010_TWO_PASS};
use crate::metric::grid::same_grid;
use crate::sums::window_end;
use crate::sums::{cumulative, in_samples};
use crate::{Metric, MetricsError};

/// Length of the mean of 1998, s.
const MEAN_S: f64 = 0.05;
/// Zeros that surround the record for the mean of 1998, s.
const PADDING_S: f64 = 0.5;
/// Frequency of the filter of 2010, Hz.
const CUTOFF_HZ: f64 = 13.0;

/// How the accelerations are smoothed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AsiMethod {
    /// Forward mean over 50 ms, EN 1317-1:1998. The record is at rest before and after: 0.5 s of zeros on either side.
    MovingAverage,
    /// Phaseless four-pole Butterworth, EN 1317-1:2010, 13 Hz as the design frequency of each of the two passes.
    #[default]
    ButterworthPerPass,
    /// The same with 13 Hz as the -3 dB frequency of both passes together: the standard can be read either way.
    ButterworthBothPasses,
}

/// Limits of the acceleration severity index, m/s²: 12 g ahead, 9 g aside, 10 g vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AsiLimits {
    /// Along x, y and z.
    pub limits_m_per_s2: [f64; 3],
}

impl Default for AsiLimits {
    fn default() -> Self {
        Self { limits_m_per_s2: [12.0, 9.0, 10.0].map(|g: f64| g * STANDARD_GRAVITY_M_PER_S2) }
    }
}

/// Acceleration severity index: the maximum over time of `sqrt((āx/12)² + (āy/9)² + (āz/10)²)`, ā in g smoothed by
/// `method`; the window is the 50 ms of the mean, or the moment, on the signals' own axis.
///
/// Input at CFC 180. Means are exact for signals linear between samples; the filter errs at the ends of a record that
/// is not at rest there. Errors: signals on different grids. EN 1317-1.
pub fn asi(
    [x, y, z]: [&Signal<Acceleration>; 3],
    limits: AsiLimits,
    method: AsiMethod,
) -> Result<Metric, MetricsError> {
    same_grid(("the x acceleration", x), ("the y acceleration", y))?;
    same_grid(("the x acceleration", x), ("the z acceleration", z))?;
    let dt = x.dt_s();
    let (definition, frequency_hz) = match method {
        AsiMethod::MovingAverage => return Ok(moving_average([x, y, z], limits)),
        AsiMethod::ButterworthPerPass => (&ASI_2010, CUTOFF_HZ),
        // Both passes leave 1/(1 + r⁴) of a frequency r times the design frequency: 1/√2 at r = (√2 - 1)^(1/4).
        AsiMethod::ButterworthBothPasses => (&ASI_2010_TWO_PASS, CUTOFF_HZ / (SQRT_2 - 1.0).powf(0.25)),
    };
    let smooth = |signal: &Signal<Acceleration>| phaseless_low_pass(signal.samples(), dt, frequency_hz);
    let (Some(x_smooth), Some(y_smooth), Some(z_smooth)) = (smooth(x), smooth(y), smooth(z)) else {
        return Ok(Metric::absent(definition, "the record is too short or its rate too low for a 13 Hz filter"));
    };
    let components = x_smooth.iter().zip(&y_smooth).zip(&z_smooth).map(|((&x, &y), &z)| [x, y, z]);
    let (largest, index) = largest(components, limits);
    let at_s = x.time_s(index);
    Ok(Metric::with_value(definition, largest).over(at_s, at_s))
}

/// ASI of 1998: means over 50 ms, the record continued by half a second of zeros on either side.
fn moving_average(signals: [&Signal<Acceleration>; 3], limits: AsiLimits) -> Metric {
    let (dt, t0_s) = (signals[0].dt_s(), signals[0].t0_s());
    let padding = in_samples(PADDING_S, dt).map_or(0, |(whole, _)| whole);
    let Some((whole, fraction)) = in_samples(MEAN_S, dt).filter(|_| padding < 1 << 32) else {
        return Metric::absent(&ASI_1998, "the sampling interval gives no window of 50 ms");
    };
    let sums = signals.map(|signal| {
        let mut padded = vec![0.0; signal.len() + 2 * padding];
        padded[padding..padding + signal.len()].copy_from_slice(signal.samples());
        cumulative(&padded, dt)
    });
    let starts = 0..sums[0].len().saturating_sub(whole + usize::from(fraction > 0.0));
    if starts.is_empty() {
        return Metric::absent(&ASI_1998, "the record is shorter than the window of 50 ms");
    }
    let mean = |v: &Vec<f64>, k: usize| (window_end(v, k, whole, fraction) - v[k]) / MEAN_S;
    let (largest, index) = largest(starts.map(|k| [mean(&sums[0], k), mean(&sums[1], k), mean(&sums[2], k)]), limits);
    let from_s = t0_s + (index as f64 - padding as f64) * dt;
    Metric::with_value(&ASI_1998, largest).over(from_s, from_s + MEAN_S)
}

/// The largest index and its position, the first of equals.
fn largest(components: impl Iterator<Item = [f64; 3]>, limits: AsiLimits) -> (f64, usize) {
    let [x, y, z] = limits.limits_m_per_s2;
    let mut best = (0.0, 0);
    for (k, [ax, ay, az]) in components.enumerate() {
        let squared = (ax / x) * (ax / x) + (ay / y) * (ay / y) + (az / z) * (az / z);
        if squared > best.0 {
            best = (squared, k);
        }
    }
    (best.0.sqrt(), best.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(g: f64) -> Signal<Acceleration> {
        Signal::new(0.0, 1e-3, vec![g * STANDARD_GRAVITY_M_PER_S2; 1001]).unwrap()
    }

    #[test]
    fn a_constant_at_the_limits_is_the_root_of_three() {
        let (x, y, z) = (constant(-12.0), constant(9.0), constant(10.0));
        for method in [AsiMethod::MovingAverage, AsiMethod::ButterworthPerPass, AsiMethod::ButterworthBothPasses] {
            let index = asi([&x, &y, &z], AsiLimits::default(), method).unwrap().value.unwrap();
            // Rounding of means and of a filter of DC gain 1.
            assert!((index - 3.0_f64.sqrt()).abs() < 1e-10, "{method:?} {index}");
        }
    }

    #[test]
    fn refuses_signals_of_different_lengths() {
        let short = Signal::new(0.0, 1e-3, vec![1.0; 5]).unwrap();
        let full = constant(1.0);
        assert!(asi([&full, &short, &full], AsiLimits::default(), AsiMethod::default()).is_err());
        let metric = asi([&short, &short, &short], AsiLimits::default(), AsiMethod::default()).unwrap();
        assert!(metric.value.is_some());
    }
}
