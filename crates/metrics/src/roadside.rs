//! Criteria of roadside hardware: ASI, THIV, PHD, OIV, ORA.
//!
//! The free head or occupant in the cabin: THIV and PHD of EN 1317-1, OIV and ridedown acceleration of MASH.
//!
//! The occupant is a free point at the vehicle's speed in a box 0.6 m ahead and 0.3 m to either side ([`FlailSpace`]):
//! the speed at which it meets a wall is the impact velocity (OIV, THIV), the largest 10 ms mean afterwards the
//! ride-down acceleration (ORA, PHD). OIV takes the axes one by one, THIV the plane with the yaw of the vehicle.

use std::f64::consts::SQRT_2;

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal, phaseless_low_pass};

use crate::metric::definitions::{ASI_1998, ASI_2010, ASI_2010_TWO_PASS, OIV_X, OIV_Y, ORA_X, ORA_Y, PHD, THIV};
use crate::metric::value::same_grid;
use crate::sums::{cumulative, cumulative_from, in_samples, window_end};
use crate::{Definition, Metric, MetricsError};

/// Length of the mean of 1998, s.
const ASI_MEAN_S: f64 = 0.05;
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
    let Some((whole, fraction)) = in_samples(ASI_MEAN_S, dt).filter(|_| u32::try_from(padding).is_ok()) else {
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
    let mean = |v: &Vec<f64>, k: usize| (window_end(v, k, whole, fraction) - v[k]) / ASI_MEAN_S;
    let (largest, index) = largest(starts.map(|k| [mean(&sums[0], k), mean(&sums[1], k), mean(&sums[2], k)]), limits);
    let from_s = t0_s + (index as f64 - padding as f64) * dt;
    Metric::with_value(&ASI_1998, largest).over(from_s, from_s + ASI_MEAN_S)
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

/// Length of the mean after the impact, s.
const RIDE_DOWN_MEAN_S: f64 = 0.01;

/// The cabin around the head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlailSpace {
    /// Free distance ahead, m: 0.6.
    pub ahead_m: f64,
    /// Free distance to each side, m: 0.3.
    pub aside_m: f64,
    /// Position of the head ahead of the reference point, m.
    pub head_x_m: f64,
}

impl Default for FlailSpace {
    fn default() -> Self {
        Self { ahead_m: 0.6, aside_m: 0.3, head_x_m: 0.0 }
    }
}

/// Theoretical head impact velocity (m/s, window: the flight) and post-impact head deceleration (m/s², window: its
/// 10 ms), times on the signals' own axis.
///
/// ψ = ∫ψ̇; the accelerations are turned into the ground frame and integrated by the trapezoid; the head flies on at
/// the vehicle's first velocity, which therefore cancels and is not asked for. It hits at the first of
/// `xb = x0 + 0.6 m`, `yb = ±0.3 m` in the cabin's axes, the moment interpolated linearly. `THIV = sqrt(Vx² + Vy²)` of
/// the head against the cabin there, yaw included. PHD is the largest resultant of the 10 ms means of both
/// accelerations over windows that start after the impact. Constant deceleration a without yaw: THIV = `sqrt(1.2·a)`.
/// Absent where the head hits nothing. EN 1317-1.
pub fn thiv_phd(
    ax: &Signal<Acceleration>,
    ay: &Signal<Acceleration>,
    yaw_rate_rad_per_s: &Sampled,
    space: FlailSpace,
) -> Result<(Metric, Metric), MetricsError> {
    same_grid(("the x acceleration", ax), ("the y acceleration", ay))?;
    same_grid(("the x acceleration", ax), ("the yaw rate", yaw_rate_rad_per_s))?;
    let yaw = cumulative(yaw_rate_rad_per_s.samples(), ax.dt_s());
    let flight = Flight::new(ax, ay, &yaw, yaw_rate_rad_per_s.samples(), space);
    let Some(end) = flight.end(space) else {
        let reason = "the head reaches no surface in the record";
        return Ok((Metric::absent(&THIV, reason), Metric::absent(&PHD, reason)));
    };
    let [vx, vy] = end.rates;
    let thiv = Metric::with_value(&THIV, vx.hypot(vy)).over(ax.t0_s(), end.time_s);
    let phd = largest_mean(&PHD, end.time_s, ax, &[ax, ay]);
    Ok((thiv, phd))
}

/// Occupant impact velocities along x and y (m/s, window: the flight) and occupant ridedown accelerations along x and
/// y (m/s², window: the 10 ms), times on the signals' own axis.
///
/// As [`thiv_phd`] without yaw and per axis; velocities with their sign, occupant against cabin: positive ahead
/// when the vehicle brakes. Ridedown is the 10 ms mean of largest magnitude, with its magnitude.
pub fn oiv_ora(
    ax: &Signal<Acceleration>,
    ay: &Signal<Acceleration>,
    space: FlailSpace,
) -> Result<[Metric; 4], MetricsError> {
    same_grid(("the x acceleration", ax), ("the y acceleration", ay))?;
    let zeros = vec![0.0; ax.len()];
    let flight = Flight::new(ax, ay, &zeros, &zeros, space);
    let Some(end) = flight.end(space) else {
        let reason = "the occupant reaches no surface in the record";
        return Ok([&OIV_X, &OIV_Y, &ORA_X, &ORA_Y].map(|definition| Metric::absent(definition, reason)));
    };
    let velocity = |definition, value| Metric::with_value(definition, value).over(ax.t0_s(), end.time_s);
    Ok([
        velocity(&OIV_X, end.rates[0]),
        velocity(&OIV_Y, end.rates[1]),
        largest_mean(&ORA_X, end.time_s, ax, &[ax]),
        largest_mean(&ORA_Y, end.time_s, ax, &[ay]),
    ])
}

/// Position and velocity of the head in the cabin's axes, sample by sample.
struct Flight {
    t0_s: f64,
    dt_s: f64,
    position: Vec<[f64; 2]>,
    rates: Vec<[f64; 2]>,
}

struct Impact {
    time_s: f64,
    rates: [f64; 2],
}

impl Flight {
    fn new(
        ax: &Signal<Acceleration>,
        ay: &Signal<Acceleration>,
        yaw: &[f64],
        yaw_rate: &[f64],
        space: FlailSpace,
    ) -> Self {
        let (n, dt_s) = (ax.len(), ax.dt_s());
        let (ax, ay, t0_s) = (ax.samples(), ay.samples(), ax.t0_s());
        let ground_x: Vec<f64> = (0..n).map(|k| ax[k] * yaw[k].cos() - ay[k] * yaw[k].sin()).collect();
        let ground_y: Vec<f64> = (0..n).map(|k| ax[k] * yaw[k].sin() + ay[k] * yaw[k].cos()).collect();
        // Relative to the head, which keeps the speed: no difference of two large distances.
        let (rate_x, rate_y) = (cumulative(&ground_x, dt_s), cumulative(&ground_y, dt_s));
        let (dx, dy) = (cumulative_from(-space.head_x_m, &rate_x, dt_s), cumulative(&rate_y, dt_s));
        let (mut position, mut rates) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for k in 0..n {
            let (sine, cosine) = yaw[k].sin_cos();
            let (x, y) = (-dx[k], -dy[k]);
            let (vx, vy) = (-rate_x[k], -rate_y[k]);
            let (xb, yb) = (x * cosine + y * sine, -x * sine + y * cosine);
            position.push([xb, yb]);
            rates.push([vx * cosine + vy * sine + yb * yaw_rate[k], -vx * sine + vy * cosine - xb * yaw_rate[k]]);
        }
        Self { t0_s, dt_s, position, rates }
    }

    /// The first moment at which the head touches a surface.
    fn end(&self, space: FlailSpace) -> Option<Impact> {
        // Distance to the surface ahead and to both sides; negative beyond.
        let gaps = |[x, y]: [f64; 2]| [space.head_x_m + space.ahead_m - x, space.aside_m - y, space.aside_m + y];
        for (k, pair) in self.position.windows(2).enumerate() {
            let (before, after) = (gaps(pair[0]), gaps(pair[1]));
            let hit = before.iter().zip(&after).filter(|(_, after)| **after <= 0.0).map(|(b, a)| b / (b - a));
            let Some(w) = hit.fold(None, |first: Option<f64>, w| Some(first.map_or(w, |f| f.min(w)))) else { continue };
            let (r, s) = (self.rates[k], self.rates[k + 1]);
            return Some(Impact {
                time_s: self.t0_s + (k as f64 + w) * self.dt_s,
                rates: [r[0] + w * (s[0] - r[0]), r[1] + w * (s[1] - r[1])],
            });
        }
        None
    }
}

/// Largest resultant of the 10 ms means of the given components over windows that start on a sample after `after_s`.
fn largest_mean(definition: &Definition, after_s: f64, grid: &Sampled, components: &[&Signal<Acceleration>]) -> Metric {
    let short = || Metric::absent(definition, "the record ends less than 10 ms after the impact");
    let Some((whole, fraction)) = in_samples(RIDE_DOWN_MEAN_S, grid.dt_s()) else { return short() };
    let sums: Vec<Vec<f64>> = components.iter().map(|a| cumulative(a.samples(), a.dt_s())).collect();
    let mut best: Option<(f64, usize)> = None;
    let starts = grid.len().saturating_sub(whole + usize::from(fraction > 0.0));
    for k in grid.index_at_or_after(after_s)..starts {
        let square = |v: &Vec<f64>| ((window_end(v, k, whole, fraction) - v[k]) / RIDE_DOWN_MEAN_S).powi(2);
        let squared: f64 = sums.iter().map(square).sum();
        if best.is_none_or(|(largest, _)| squared > largest) {
            best = Some((squared, k));
        }
    }
    let Some((squared, k)) = best else { return short() };
    Metric::with_value(definition, squared.sqrt()).over(grid.time_s(k), grid.time_s(k) + RIDE_DOWN_MEAN_S)
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
