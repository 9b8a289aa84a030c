//! The delay between two channels, by the maximum of their correlation.

use crumple_numerics::linalg::{Complex64, RealTransform, real_transform};
use crumple_signal::Sampled;

use crate::FilterError;

/// Refinements of the maximum between samples; three are enough from a grid twice as fine as the record.
const REFINEMENTS: usize = 30;

/// How far one channel lags another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// Delay of the channel against the reference, s; positive: the channel is late.
    pub delay_s: f64,
    /// Correlation coefficient of the two at that delay, `c(τ)/√(Σx²·Σy²)`, -1 to 1. No means are subtracted, so a
    /// zero level that is left in both raises it.
    pub correlation: f64,
}

/// Estimates the delay of a channel against a reference from the maximum of their cross-correlation,
/// `c(τ) = ∫ x(t)·y(t + τ) dt` with |τ| up to `longest_s`.
///
/// The correlation is made from the spectra (records padded with zeros, so that nothing wraps round) and its maximum is
/// sought between samples too, on the trigonometric interpolant, by Newton's method. Exact for a band-limited pulse
/// that lies inside both records; a record cut in the middle of its pulse shifts the estimate towards zero. The sensors
/// must see the same motion: between different places of a structure the figure is travel time and shape together. The
/// zero level must be removed. Both records need the same rate. Memory: some six times a record.
///
/// On band-limited pulses inside both records the delay is right to 1e-10 s. On the grid the search ends at the last
/// lag within `longest_s`; the refinement may go beyond it by up to one sample.
///
/// # Errors
/// Rates that differ by more than 1e-9 of themselves, or a record without signal.
pub fn delay(channel: &Sampled, reference: &Sampled, longest_s: f64) -> Result<Delay, FilterError> {
    let dt_s = reference.dt_s();
    if (channel.dt_s() - dt_s).abs() > 1e-9 * dt_s {
        return Err(FilterError::Rates { channel_hz: channel.rate_hz(), reference_hz: reference.rate_hz() });
    }
    let energy = |s: &Sampled| s.samples().iter().map(|x| x * x).sum::<f64>();
    let norm = (energy(channel) * energy(reference)).sqrt();
    if !(norm.is_finite() && norm > 0.0) {
        return Err(FilterError::NothingToAlign);
    }
    let n = (channel.len() + reference.len()).next_power_of_two();
    let RealTransform { forward, inverse } = real_transform(n);
    let spectrum = |s: &Sampled| {
        let mut padded = s.samples().to_vec();
        padded.resize(n, 0.0);
        let mut spectrum = forward.make_output_vec();
        forward.process(&mut padded, &mut spectrum).map(|()| spectrum).map_err(|_| FilterError::NothingToAlign)
    };
    let mut cross = spectrum(reference)?;
    for (x, y) in cross.iter_mut().zip(spectrum(channel)?) {
        *x = x.conj() * y;
    }

    let mut correlation = inverse.make_output_vec();
    inverse.process(&mut cross.clone(), &mut correlation).map_err(|_| FilterError::NothingToAlign)?;
    // Lags are between indices; the records' starts may differ.
    let offset_s = channel.t0_s() - reference.t0_s();
    let half = (n / 2).cast_signed() - 1;
    let lag_of = |t_s: f64| ((t_s - offset_s) / dt_s).clamp(-(half as f64), half as f64);
    let (from, to) = (lag_of(-longest_s).ceil() as isize, lag_of(longest_s).floor() as isize);
    let best = (from..=to)
        .max_by(|a, b| {
            let at = |lag: isize| correlation[lag.rem_euclid(n.cast_signed()) as usize];
            at(*a).total_cmp(&at(*b))
        })
        .unwrap_or(0);
    let lag = refine(&cross, n, best as f64);
    let peak = derivatives(&cross, n, lag)[0];
    Ok(Delay { delay_s: offset_s + lag * dt_s, correlation: (peak / norm).clamp(-1.0, 1.0) })
}

/// Newton's method on the slope of the correlation, kept within one sample of the start; lags in samples. It ends at a
/// step below 1e-12 samples, or where the curvature is not negative and there is no maximum to go to.
fn refine(cross: &[Complex64], n: usize, start: f64) -> f64 {
    let mut lag = start;
    for _ in 0..REFINEMENTS {
        let [_, slope, curvature] = derivatives(cross, n, lag);
        if curvature >= 0.0 {
            break;
        }
        let step = (-slope / curvature).clamp(-0.5, 0.5);
        lag = (lag + step).clamp(start - 1.0, start + 1.0);
        if step.abs() < 1e-12 {
            break;
        }
    }
    lag
}

/// Value, slope and curvature of the trigonometric interpolant of the correlation at a lag in samples:
/// `c(l) = (1/n)·Re Σ s_k·C_k·e^(j·w_k·l)` with `w_k = 2πk/n`, `s_0 = 1`, `s_k = 2`, and its derivatives to l. `cross`
/// holds the n/2 + 1 values `C_k` of the cross-spectrum; one call costs n/2 of them.
fn derivatives(cross: &[Complex64], n: usize, lag: f64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    // The term at half the sampling rate has no shifted form and is left out; that at frequency 0 counts once.
    for (k, c) in cross.iter().enumerate().take(n / 2) {
        let w = 2.0 * std::f64::consts::PI * k as f64 / n as f64;
        let term = c * Complex64::cis(w * lag) * if k == 0 { 1.0 } else { 2.0 };
        sums[0] += term.re;
        sums[1] -= w * term.im;
        sums[2] -= w * w * term.re;
    }
    sums.map(|sum| sum / n as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pulse of limited band: a Gaussian of 4 samples' width has nothing left at half the rate (1e-34).
    fn pulse(shift_s: f64, t0_s: f64, n: usize) -> Sampled {
        let dt_s = 1e-4;
        let at = |t: f64| (-((t - shift_s) / 4e-4).powi(2) / 2.0).exp() * (1.0 + ((t - shift_s) / 1e-3));
        Sampled::new(t0_s, dt_s, (0..n).map(|k| -300.0 * at(t0_s + k as f64 * dt_s)).collect()).unwrap()
    }

    #[test]
    fn a_shifted_pulse_gives_its_shift_to_a_millionth_of_a_sample() {
        let reference = pulse(0.02, 0.0, 500);
        for shift_s in [0.0, 1e-4, 3.7e-5, -5.55e-5, 1.234_567e-3, -2e-3] {
            for (t0_s, n) in [(0.0, 500), (-0.01, 700)] {
                let lag = delay(&pulse(0.02 + shift_s, t0_s, n), &reference, 5e-3).unwrap();
                assert!((lag.delay_s - shift_s).abs() < 1e-10, "{shift_s}: {lag:?}");
                assert!((lag.correlation - 1.0).abs() < 1e-9, "{lag:?}");
            }
        }
    }

    #[test]
    fn refuses_other_rates_and_silence() {
        let reference = pulse(0.02, 0.0, 500);
        let slow = Sampled::new(0.0, 2e-4, vec![1.0; 10]).unwrap();
        assert_eq!(
            delay(&slow, &reference, 5e-3).unwrap_err().to_string(),
            "the channel is sampled at 5000 Hz, the one to align it to at 10000 Hz: one rate is needed"
        );
        let silent = Sampled::new(0.0, 1e-4, vec![0.0; 10]).unwrap();
        assert!(delay(&silent, &reference, 5e-3).is_err());
    }
}
