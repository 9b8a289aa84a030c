//! Time zero: where it comes from, and a check against the pulse.

use crumple_signal::{About, Notes, STANDARD_GRAVITY_M_PER_S2, Sampled, SignalError, Weight};

use crate::{IngestError, Place};

/// Level of the threshold rule, m/s^2 (0.5 g).
pub const THRESHOLD_M_PER_S2: f64 = 0.5 * STANDARD_GRAVITY_M_PER_S2;
/// How long the level must be kept, s.
pub const HOLD_S: f64 = 0.003;
/// Difference from the record's time zero that is worth a note, s.
const WORTH_A_NOTE_S: f64 = 0.005;
/// Samples smoothed at a time.
const BLOCK: usize = 1 << 18;
/// Width of the moving mean before the check, s: its -3 dB frequency is about 100 Hz, that of CFC 60.
pub const SMOOTHING_S: f64 = 0.0044;

/// The same samples with the file's time `zero_s` as t = 0.
pub fn shift(wave: &Sampled, zero_s: f64) -> Result<Sampled, SignalError> {
    // To the picosecond, so that 0.02 - 0.012 is 0.008.
    let t0_s = ((wave.t0_s() - zero_s) * 1e12).round() / 1e12;
    Sampled::new(t0_s, wave.dt_s(), wave.samples().to_vec())
}

/// Refuses a pulse that does not contain t = 0.
pub fn require_contact(file: &str, pulse: &Sampled) -> Result<(), IngestError> {
    let (start, end) = (pulse.t0_s(), pulse.end_s());
    if start <= pulse.dt_s() && end > 0.0 {
        return Ok(());
    }
    Err(IngestError::content(
        Place::file(file),
        format!("the record runs from {start:.6} s to {end:.6} s and does not contain t = 0"),
        "t = 0 at first contact",
        format!("state the time of first contact on the file's axis, such as --time-zero {:.3}s", start.max(0.0)),
    ))
}

/// First time at which the magnitude reaches the threshold and stays there for [`HOLD_S`]: the crossing by linear
/// interpolation, s. `None` if it never does. A rule of thumb: it lags true contact by a fraction of a millisecond.
pub fn threshold_crossing(times: &Sampled, samples: &[f64], zero_level: f64) -> Option<f64> {
    let hold = (HOLD_S / times.dt_s()).round().max(1.0) as usize;
    let magnitude = |k: usize| (samples[k] - zero_level).abs();
    let mut run = 0;
    for k in 0..samples.len() {
        run = if magnitude(k) >= THRESHOLD_M_PER_S2 { run + 1 } else { 0 };
        // `hold` intervals need one sample more.
        if run > hold {
            let first = k - hold;
            if first == 0 {
                return Some(times.time_s(0));
            }
            let (before, after) = (magnitude(first - 1), magnitude(first));
            let part = (THRESHOLD_M_PER_S2 - before) / (after - before);
            return Some(times.time_s(first - 1) + part * times.dt_s());
        }
    }
    None
}

/// A note if the smoothed pulse rises clearly before or after t = 0.
pub fn check(pulse: &Sampled, zero_level: Option<f64>, notes: &mut Notes) {
    let Some(crossing) = smoothed_crossing(pulse, zero_level.unwrap_or(0.0)) else {
        notes.concern(
            About::Pulse,
            Weight::Decisive,
            "the pulse never exceeds 0.5 g for 3 ms: check its channel and unit",
        );
        return;
    };
    if crossing.abs() > WORTH_A_NOTE_S {
        notes.info(format!(
            "the pulse first exceeds 0.5 g for 3 ms at {:.1} ms: check time zero (--time-zero shifts the axis)",
            crossing * 1e3
        ));
    }
}

/// [`threshold_crossing`] of the moving mean, block by block: a long record is not copied.
fn smoothed_crossing(pulse: &Sampled, zero_level: f64) -> Option<f64> {
    // An interval of next to nothing makes them longer than any record.
    let half = ((SMOOTHING_S / pulse.dt_s() / 2.0) as usize).min(pulse.len());
    // A run that reaches over the start of a block is found again in it.
    let overlap = (HOLD_S / pulse.dt_s()).round().clamp(1.0, pulse.len() as f64) as usize + 2;
    (0..pulse.len()).step_by(BLOCK).find_map(|start| {
        let (from, to) = (start.saturating_sub(overlap), (start + BLOCK).min(pulse.len()));
        let (low, high) = (from.saturating_sub(half), (to + half).min(pulse.len()));
        let smooth = moving_mean(&pulse.samples()[low..high], half);
        threshold_crossing(&pulse.slice(from, to), &smooth[from - low..to - low], zero_level)
    })
}

/// Centred mean over `2 half + 1` samples, fewer at the ends.
pub fn moving_mean(samples: &[f64], half: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(samples.len() + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for x in samples {
        sum += x;
        sums.push(sum);
    }
    (0..samples.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half + 1).min(samples.len()));
            (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_keeps_round_times() {
        let wave = Sampled::new(0.02, 1e-4, vec![0.0; 10]).unwrap();
        assert_eq!(shift(&wave, 0.012).unwrap().t0_s(), 0.008);
    }

    #[test]
    fn the_crossing_is_interpolated_and_must_hold() {
        // 1 g per 10 ms from t = 0, with a spike of 1 ms before it: the threshold is reached at 5 ms.
        let g = STANDARD_GRAVITY_M_PER_S2;
        let at = |t: f64| if t < -0.01 && t > -0.011 { 9.0 * g } else { -t.max(0.0) * 100.0 * g };
        let wave = Sampled::new(-0.05, 3e-4, (0..500).map(|k| at(-0.05 + f64::from(k) * 3e-4)).collect()).unwrap();
        let crossing = threshold_crossing(&wave, wave.samples(), 0.0).unwrap();
        // Exact for a ramp but for rounding.
        assert!((crossing - 0.005).abs() < 1e-12, "{crossing}");
    }

    #[test]
    fn zero_level_and_crossing_agree_with_another_implementation() {
        // 0.35 g offset, half sine of -22 g and 90 ms from t = 0, 10 kHz from -50 ms; an independent script gives 0.35
        // g from 401 samples and 0.651145457828 ms, printed to 1e-15 s.
        let g = STANDARD_GRAVITY_M_PER_S2;
        let at = |t: f64| {
            0.35 - if (0.0..=0.09).contains(&t) { 22.0 * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 }
        };
        let wave = Sampled::new(-0.05, 1e-4, (0..2501).map(|k| g * at(f64::from(k - 500) * 1e-4)).collect()).unwrap();
        let pre = crate::recording::quality::measure(&wave, 0.0, true).pre_event.unwrap();
        assert!((pre.zero_level / g - 0.35).abs() < 1e-9 && pre.samples == 401);
        let crossing = threshold_crossing(&wave, wave.samples(), pre.zero_level).unwrap();
        assert!((crossing - 0.000_651_145_457_828).abs() < 1e-9, "{crossing}");
    }

    #[test]
    fn a_record_without_time_zero_is_refused() {
        let late = Sampled::new(12.0, 1e-4, vec![0.0; 100]).unwrap();
        let error = require_contact("a.csv", &late).unwrap_err();
        assert!(error.to_string().contains("does not contain t = 0"), "{error}");
        assert!(error.hint().contains("--time-zero 12.000s"));
        require_contact("a.csv", &Sampled::new(0.0, 1e-4, vec![0.0; 100]).unwrap()).unwrap();
    }
}
