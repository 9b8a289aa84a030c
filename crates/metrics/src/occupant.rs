//! Channels of an occupant: resultant, 3 ms clips, ride-down against the vehicle.

use crumple_signal::{Acceleration, Signal};

use crate::metric::definitions::{CLIP_CONTIGUOUS, CLIP_CUMULATIVE, OCCUPANT_TRAVEL, RESTRAINT, RIDE_DOWN};
use crate::metric::value::same_grid;
use crate::{Metric, MetricsError, Window, sums};

/// Resultant of components at one place, sample by sample: `sqrt(x² + y² + z²)`.
///
/// Formed after filtering (SAE J211-1: filtering comes before every non-linear operation). Of fewer than three axes it
/// is nowhere above the resultant of all three, and neither is what grows with it (HIC, 3 ms clip). Errors: no
/// component, components on different grids.
pub fn resultant(components: &[&Signal<Acceleration>]) -> Result<Signal<Acceleration>, MetricsError> {
    let Some((first, others)) = components.split_first() else { return Err(MetricsError::Empty) };
    for other in others {
        same_grid(("one component", first), ("another", other))?;
    }
    let length = |k: usize| components.iter().fold(0.0_f64, |length, a| length.hypot(a.samples()[k]));
    Ok(first.with_samples((0..first.len()).map(length).collect())?)
}

/// Duration of the 3 ms clip, s.
pub const CLIP_3MS_S: f64 = 0.003;

/// Highest level that a single peak exceeds for `duration_s` without a break, m/s²; window of that stay on the
/// signal's own axis (SAE J1727, "contiguous").
///
/// The signal is linear between samples, crossings are interpolated; the level comes by bisection to the last bits.
/// Half-sine of height A and length D: `A·cos(π·duration/(2D))`. Absent for a record shorter than the duration. Time:
/// some 60 passes.
pub fn clip_contiguous(resultant: &Signal<Acceleration>, duration_s: f64) -> Metric {
    let level_held =
        level(resultant, duration_s, |a, level| longest_stay(a, level).map_or(0.0, |(from, to)| to - from));
    match level_held {
        Ok(level) => {
            let metric = Metric::with_value(&CLIP_CONTIGUOUS, level);
            let stay = longest_stay(resultant.samples(), level).map(|(from, to)| Window {
                from_s: resultant.t0_s() + from * resultant.dt_s(),
                to_s: resultant.t0_s() + to * resultant.dt_s(),
            });
            Metric { window: stay, ..metric }
        }
        Err(reason) => Metric::absent(&CLIP_CONTIGUOUS, &reason),
    }
}

/// Highest level that is exceeded for `duration_s` in total, m/s² (FMVSS 208, UN R94, Euro NCAP: "cumulative").
///
/// As [`clip_contiguous`], but all stays above the level count together; never below it. The window is the whole
/// record.
pub fn clip_cumulative(resultant: &Signal<Acceleration>, duration_s: f64) -> Metric {
    match level(resultant, duration_s, total_time) {
        Ok(level) => Metric::with_value(&CLIP_CUMULATIVE, level).over(resultant.t0_s(), resultant.end_s()),
        Err(reason) => Metric::absent(&CLIP_CUMULATIVE, &reason),
    }
}

/// The highest level at which `time(samples, level)`, in sampling intervals, still reaches the duration.
fn level(resultant: &Signal<Acceleration>, duration_s: f64, time: impl Fn(&[f64], f64) -> f64) -> Result<f64, String> {
    let a = resultant.samples();
    let needed = duration_s / resultant.dt_s();
    // The slack is that of decimal intervals: 31 samples at 0.1 ms are 3 ms.
    let span = a.len().saturating_sub(1) as f64;
    if !(needed > 0.0 && span >= needed * (1.0 - 1e-9)) {
        return Err(format!("the record is shorter than {duration_s} s"));
    }
    let needed = needed.min(span);
    let (mut low, mut high) = a.iter().fold((a[0], a[0]), |(low, high), &a| (low.min(a), high.max(a)));
    // To the last bits of the largest value: a level near zero has bits down to the smallest number.
    let enough = 0.25 * f64::EPSILON * low.abs().max(high.abs());
    loop {
        let middle = low + (high - low) / 2.0;
        if !(middle > low && middle < high && high - low > enough) {
            return Ok(low);
        }
        if time(a, middle) >= needed { low = middle } else { high = middle }
    }
}

/// Part of the interval from sample value p to q that lies at or above the level: its ends, 0..=1.
fn above(p: f64, q: f64, level: f64) -> Option<(f64, f64)> {
    match (p >= level, q >= level) {
        (true, true) => Some((0.0, 1.0)),
        (true, false) => Some((0.0, (p - level) / (p - q))),
        (false, true) => Some(((level - p) / (q - p), 1.0)),
        (false, false) => None,
    }
}

/// Time at or above the level, in sampling intervals, crossings interpolated linearly.
fn total_time(a: &[f64], level: f64) -> f64 {
    a.windows(2).filter_map(|pair| above(pair[0], pair[1], level)).map(|(from, to)| to - from).sum()
}

/// The longest stay at or above the level, in samples from the first; the earliest of equals.
fn longest_stay(a: &[f64], level: f64) -> Option<(f64, f64)> {
    let (mut best, mut since): (Option<(f64, f64)>, Option<f64>) = (None, None);
    for (k, pair) in a.windows(2).enumerate() {
        let Some((from, to)) = above(pair[0], pair[1], level) else {
            since = None;
            continue;
        };
        let start = *since.get_or_insert(k as f64 + from);
        let end = k as f64 + to;
        if best.is_none_or(|(from, to)| end - start > to - from) {
            best = Some((start, end));
        }
        if pair[1] < level {
            since = None;
        }
    }
    best
}

/// Where the occupant's energy goes.
#[derive(Debug, Clone, PartialEq)]
pub struct RideDown {
    /// Share that the vehicle's crush takes.
    pub efficiency: Metric,
    /// Share that the restraint takes.
    pub restraint: Metric,
    /// Largest travel of the occupant in the vehicle, m; the window is its moment.
    pub largest_travel: Metric,
    /// Share that is left at the end, `(v_o/v0)²`.
    pub left: f64,
}

impl RideDown {
    /// The three shares less 1: rounding for an occupant at rest in its seat at both ends.
    pub fn residual(&self) -> Option<f64> {
        Some(self.efficiency.value? + self.restraint.value? + self.left - 1.0)
    }
}

/// Ride-down of an occupant with deceleration `occupant` in a vehicle with `vehicle`, both from time zero at
/// `impact_speed_m_per_s`, over the whole of both signals.
///
/// `μ = (2/v0²)·∫(-a_o)·v dt`, restraint `(2/v0²)·∫(-a_o)(v_o - v) dt`, products and velocities by the trapezoid in
/// time. Error O(T²). Both and the energy left sum to 1 up to `T²/4·(a_o(end)² - a_o(0)²)/v0²`: the rest telescopes.
/// Errors: grids that differ, a speed that is not positive.
pub fn ride_down(
    vehicle: &Signal<Acceleration>,
    occupant: &Signal<Acceleration>,
    impact_speed_m_per_s: f64,
) -> Result<RideDown, MetricsError> {
    same_grid(("the vehicle's acceleration", vehicle), ("the occupant's acceleration", occupant))?;
    let v0 = impact_speed_m_per_s;
    if !(v0.is_finite() && v0 > 0.0) {
        return Err(MetricsError::ImpactSpeed(v0));
    }
    let dt = vehicle.dt_s();
    let v = sums::cumulative_from(v0, vehicle.samples(), dt);
    let a_o = occupant.samples();
    let v_o = sums::cumulative_from(v0, a_o, dt);
    let (mut crush, mut belt, mut travel) = (0.0, 0.0, 0.0);
    let mut largest = (0.0, 0);
    for k in 1..v.len() {
        crush -= dt * (a_o[k - 1] * v[k - 1] + a_o[k] * v[k]) / 2.0;
        belt -= dt * (a_o[k - 1] * (v_o[k - 1] - v[k - 1]) + a_o[k] * (v_o[k] - v[k])) / 2.0;
        travel += dt * ((v_o[k - 1] - v[k - 1]) + (v_o[k] - v[k])) / 2.0;
        if travel > largest.0 {
            largest = (travel, k);
        }
    }
    let share = 2.0 / (v0 * v0);
    let (from_s, to_s, at_s) = (vehicle.t0_s(), vehicle.end_s(), vehicle.time_s(largest.1));
    Ok(RideDown {
        efficiency: Metric::with_value(&RIDE_DOWN, share * crush).over(from_s, to_s),
        restraint: Metric::with_value(&RESTRAINT, share * belt).over(from_s, to_s),
        largest_travel: Metric::with_value(&OCCUPANT_TRAVEL, largest.0).over(at_s, at_s),
        left: (v_o[v_o.len() - 1] / v0).powi(2),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_components_make_a_length_and_one_its_magnitude() {
        let signal = |level: f64| Signal::new(0.0, 0.5, vec![0.0, level]).unwrap();
        let length = resultant(&[&signal(2.0), &signal(-3.0), &signal(6.0)]).unwrap();
        // 7 in whole numbers, a unit in the last place of each root.
        assert!((length.samples()[1] - 7.0).abs() < 1e-14, "{length:?}");
        assert_eq!(resultant(&[&signal(-3.0)]).unwrap().samples(), [0.0, 3.0]);
        assert!(resultant(&[]).is_err());
        assert!(resultant(&[&signal(1.0), &Signal::new(0.1, 0.5, vec![0.0, 1.0]).unwrap()]).is_err());
    }

    #[test]
    fn a_triangle_is_cut_where_it_is_as_wide_as_the_duration() {
        // Height 4 over 4 s: at level L it is 4 - L wide.
        let a = Signal::new(1.0, 1.0, vec![0.0, 2.0, 4.0, 2.0, 0.0]).unwrap();
        let metric = clip_contiguous(&a, 1.0);
        // Bisection ends at neighbouring numbers; the width is computed to some 1e-15.
        assert!((metric.value.unwrap() - 3.0).abs() < 1e-14);
        let window = metric.window.unwrap();
        assert!((window.from_s - 2.5).abs() < 1e-14 && (window.to_s - 3.5).abs() < 1e-14);
    }

    #[test]
    fn of_equal_stays_the_first_is_the_longest() {
        let peaks = [0.0, 4.0, 0.0, 4.0, 0.0];
        assert_eq!(longest_stay(&peaks, 2.0), Some((0.5, 1.5)));
        assert_eq!(longest_stay(&[0.0, 4.0, 0.0, 4.0, 4.0, 0.0], 2.0), Some((2.5, 4.5)));
        assert_eq!(longest_stay(&[0.0, 4.0, 2.0, 4.0, 0.0], 2.0), Some((0.5, 3.5)), "it may touch the level");
        assert_eq!((longest_stay(&peaks, 5.0), total_time(&peaks, 2.0)), (None, 2.0));
    }

    #[test]
    fn two_peaks_add_up_in_the_cumulative_kind_only() {
        let a = Signal::new(0.0, 1.0, vec![0.0, 4.0, 0.0, 4.0, 0.0]).unwrap();
        assert!((clip_contiguous(&a, 1.0).value.unwrap() - 2.0).abs() < 1e-14);
        assert!((clip_cumulative(&a, 1.0).value.unwrap() - 3.0).abs() < 1e-14);
    }

    #[test]
    fn a_record_of_exactly_the_duration_has_a_level_and_a_shorter_one_has_none() {
        let clip_of = |n| clip_contiguous(&Signal::new(0.0, 1e-4, vec![5.0; n]).unwrap(), CLIP_3MS_S).value;
        assert_eq!(clip_of(31), Some(5.0));
        assert_eq!(clip_of(30), None);
        assert_eq!(clip_cumulative(&Signal::new(0.0, 1e-4, vec![]).unwrap(), CLIP_3MS_S).value, None);
    }

    #[test]
    fn an_occupant_tied_to_the_vehicle_rides_down_with_it() {
        let a = Signal::new(0.0, 0.5, vec![-1.0; 9]).unwrap();
        let shares = ride_down(&a, &a, 4.0).unwrap();
        assert_eq!((shares.efficiency.value, shares.restraint.value, shares.left), (Some(1.0), Some(0.0), 0.0));
        assert_eq!(shares.residual(), Some(0.0));
        assert_eq!(ride_down(&a, &a, 0.0).unwrap_err().to_string(), "impact speed 0 m/s is not a positive number");
    }
}
