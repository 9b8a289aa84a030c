//! The 3 ms clip, contiguous and cumulative.

use crumple_signal::{Acceleration, Signal};

use crate::metric::definitions::{CLIP_CONTIGUOUS, CLIP_CUMULATIVE};
use crate::{Metric, Window};

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
