//! What every method starts from: inputs and outputs sampled together, Markov parameters, parts and thinned copies of
//! them.

use std::f64::consts::PI;

use crumple_numerics::linalg::{dot, real_transform};
use crumple_numerics::lti::{Complex, StateSpace};
use nalgebra::DMatrix;

use crate::{EraError, IdentifyError};

/// Rows of a matrix, contiguous.
pub(crate) fn rows_of(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// Columns of a matrix, contiguous.
pub(crate) fn columns_of(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.column_iter().map(|column| column.iter().copied().collect()).collect()
}

// Low-pass filtering and thinning of records, for methods whose horizon counts in samples.

/// Part of a signal's largest spectral line above which a frequency counts as part of the signal.
const LEVEL: f64 = 0.01;

/// Samples per period of the highest frequency that counts: room for the filter's edge.
const SAMPLES_PER_PERIOD: f64 = 8.0;

/// Half length of the anti-alias filter, in samples of the thinned record.
const HALF_LENGTH: usize = 3;

/// By how many samples a record can be thinned before a frequency that counts in any of its signals comes near the new
/// Nyquist frequency, and at most so far that `needed` samples are left. 1: leave it as it is.
///
/// The frequency is the highest whose line in the amplitude spectrum (straight line through the ends removed, Hann
/// window) reaches 1 % of the largest. Noise that broad is not told from a signal: a white one keeps every sample.
pub fn automatic_thinning(data: &IoData, needed: usize) -> usize {
    let samples = data.samples();
    let mut highest = 0;
    for signal in data.inputs().iter().chain(data.outputs()) {
        let Some(spectrum) = spectrum(detrended(signal)) else { return 1 };
        let largest = spectrum.iter().map(|x| x.norm()).fold(0.0, f64::max);
        if let Some(last) = spectrum.iter().rposition(|x| x.norm() > LEVEL * largest) {
            highest = highest.max(last);
        }
    }
    // Line k is k cycles over the record.
    let by_band = samples as f64 / (SAMPLES_PER_PERIOD * highest.max(1) as f64);
    let by_length = samples as f64 / (needed + 2 * HALF_LENGTH) as f64;
    (by_band.min(by_length).floor() as usize).max(1)
}

/// Spectrum of a signal in a Hann window; line `k` is `k` cycles over the record. `None` of no samples.
pub(crate) fn spectrum(mut signal: Vec<f64>) -> Option<Vec<Complex>> {
    let samples = signal.len();
    if samples == 0 {
        return None;
    }
    for (k, x) in signal.iter_mut().enumerate() {
        *x *= 0.5 - 0.5 * (2.0 * PI * (k as f64 + 0.5) / samples as f64).cos();
    }
    let transform = real_transform(samples).forward;
    let mut spectrum = transform.make_output_vec();
    transform.process(&mut signal, &mut spectrum).ok()?;
    Some(spectrum)
}

fn detrended(signal: &[f64]) -> Vec<f64> {
    let n = signal.len();
    let (first, last) = (signal[0], signal[n - 1]);
    let slope = if n > 1 { (last - first) / (n - 1) as f64 } else { 0.0 };
    signal.iter().enumerate().map(|(k, x)| x - first - slope * k as f64).collect()
}

/// Every `every`-th sample behind a symmetric low-pass filter, the same for all signals, so that a linear system
/// between them stays one with the same poles. Three thinned samples at each end, which the filter cannot reach, go.
///
/// Windowed sinc (Hann) with its half-amplitude point at the new Nyquist frequency. Between the thinned samples an
/// input is no longer held, so the input matrices found on such data are approximate: find them on the whole record.
/// Errors: nothing left.
pub fn thinned(data: &IoData, every: usize) -> Result<IoData, IdentifyError> {
    if every <= 1 {
        return Ok(data.clone());
    }
    let half = HALF_LENGTH * every;
    let mut filter: Vec<f64> = (0..=2 * half)
        .map(|k| {
            let x = (k as f64 - half as f64) / every as f64;
            let sinc = if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
            sinc * (0.5 + 0.5 * (PI * (k as f64 - half as f64) / (half as f64 + 1.0)).cos())
        })
        .collect();
    let sum: f64 = filter.iter().sum();
    filter.iter_mut().for_each(|f| *f /= sum);
    let cut = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> {
        signals.iter().map(|s| s.windows(filter.len()).step_by(every).map(|w| dot(w, &filter)).collect()).collect()
    };
    IoData::new(cut(data.inputs()), cut(data.outputs()), data.sample_time_s() * every as f64)
}

// The end of the contact force, where a free decay begins.

/// Index of the first sample after the last one at which `force` reaches `share` of its largest magnitude: from there
/// on the force is smaller for good. `None` for a force that is zero throughout, or still that large at the last
/// sample.
///
/// `force` may be a barrier force or the deceleration of a vehicle, which is that force over its mass. A share of the
/// peak is a rule, not a measurement: too small and noise or a late ripple of the filter decides, too large and the
/// force still drives the motion that is taken for free. From 2 to 10 % is usual.
pub fn end_of_contact(force: &[f64], share: f64) -> Option<usize> {
    let peak = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let last = force.iter().rposition(|f| f.abs() > 0.0 && f.abs() >= share * peak)?;
    (last + 1 < force.len()).then_some(last + 1)
}

// What an input does between its samples.

/// What the input does between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// It keeps the value of the last sample.
    Zero,
    /// It goes straight to the next sample: right for sampled accelerations, error O(dt²).
    First,
}

// Inputs and outputs of a system, sampled together.

/// Signals that drive a system and signals it answers with, all of one length and one sampling interval.
///
/// Built by [`IoData::new`]: at least one output, every sample finite. No inputs: a free decay.
#[derive(Debug, Clone, PartialEq)]
pub struct IoData {
    inputs: Vec<Vec<f64>>,
    outputs: Vec<Vec<f64>>,
    sample_time_s: f64,
}

impl IoData {
    /// Checks lengths and values. Errors: no output or no sample, different lengths, not finite, sampling interval.
    pub fn new(inputs: Vec<Vec<f64>>, outputs: Vec<Vec<f64>>, sample_time_s: f64) -> Result<Self, IdentifyError> {
        if !(sample_time_s.is_finite() && sample_time_s > 0.0) {
            return Err(crumple_numerics::lti::LtiError::SampleTime(sample_time_s).into());
        }
        let samples = outputs.first().map_or(0, Vec::len);
        if samples == 0 {
            return Err(IdentifyError::NoOutput);
        }
        for (kind, signals) in [("input", &inputs), ("output", &outputs)] {
            for (number, signal) in signals.iter().enumerate() {
                if signal.len() != samples {
                    return Err(IdentifyError::Lengths { kind, number, found: signal.len(), expected: samples });
                }
                if let Some(index) = signal.iter().position(|x| !x.is_finite()) {
                    return Err(IdentifyError::NotFinite { kind, number, index });
                }
            }
        }
        Ok(Self { inputs, outputs, sample_time_s })
    }

    /// One input, one output.
    pub fn single(input: Vec<f64>, output: Vec<f64>, sample_time_s: f64) -> Result<Self, IdentifyError> {
        Self::new(vec![input], vec![output], sample_time_s)
    }

    /// Driving signals.
    pub fn inputs(&self) -> &[Vec<f64>] {
        &self.inputs
    }

    /// Answering signals.
    pub fn outputs(&self) -> &[Vec<f64>] {
        &self.outputs
    }

    /// Sampling interval, s.
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Number of samples of each signal.
    pub fn samples(&self) -> usize {
        self.outputs[0].len()
    }

    /// The samples from `first` up to, not including, `end`; both are cut to the record.
    /// Errors: nothing left.
    pub fn slice(&self, first: usize, end: usize) -> Result<Self, IdentifyError> {
        let end = end.min(self.samples());
        let cut = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> {
            signals.iter().map(|s| s[first.min(end)..end].to_vec()).collect()
        };
        Self::new(cut(&self.inputs), cut(&self.outputs), self.sample_time_s)
    }

    /// The same with a constant subtracted from every signal: its mean over the first `samples`.
    pub fn centred_on_first(&self, samples: usize) -> Self {
        let centre = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let centred = |s: &Vec<f64>| {
                let head = &s[..samples.clamp(1, s.len())];
                let mean = head.iter().sum::<f64>() / head.len() as f64;
                s.iter().map(|x| x - mean).collect()
            };
            signals.iter().map(centred).collect()
        };
        Self { inputs: centre(&self.inputs), outputs: centre(&self.outputs), sample_time_s: self.sample_time_s }
    }

    /// The same with every input late by `samples`; zeros come before.
    pub fn delayed(&self, samples: usize) -> Self {
        let shift = |u: &Vec<f64>| {
            let kept = u.len().saturating_sub(samples);
            std::iter::repeat_n(0.0, u.len() - kept).chain(u[..kept].iter().copied()).collect()
        };
        Self { inputs: self.inputs.iter().map(shift).collect(), ..self.clone() }
    }

    /// Root mean square of every input; 1 for a silent one.
    pub(crate) fn input_scales(&self) -> Vec<f64> {
        self.inputs.iter().map(|u| scale(u)).collect()
    }

    /// Root mean square of every output; 1 for a silent one.
    pub fn output_scales(&self) -> Vec<f64> {
        self.outputs.iter().map(|y| scale(y)).collect()
    }
}

/// Root mean square of a signal, without overflow; 1 for zeros.
///
/// The largest sample is taken out before squaring, so that squares neither overflow nor vanish.
pub(crate) fn scale(signal: &[f64]) -> f64 {
    let largest = signal.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 {
        return 1.0;
    }
    let sum: f64 = signal.iter().map(|x| (x / largest).powi(2)).sum();
    largest * (sum / signal.len() as f64).sqrt()
}

// Markov parameters: what a system answers to a unit impulse.

/// Markov parameters of a system, one sequence for every pair of an output and an input, all of one length.
///
/// Sample 0 of a sequence is the direct term `D`, sample `k` is `C A^(k-1) B`. Records of one free decay on several
/// sensors are those of one input.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkovParameters<'a> {
    sequences: Vec<&'a [f64]>,
    inputs: usize,
}

impl<'a> MarkovParameters<'a> {
    /// `sequences[i * inputs + j]` is what output `i` answers to input `j`.
    /// Errors: no sequence, a number that `inputs` does not divide, other lengths, a sample that is not finite.
    pub fn new(sequences: Vec<&'a [f64]>, inputs: usize) -> Result<Self, EraError> {
        if inputs == 0 || sequences.is_empty() || !sequences.len().is_multiple_of(inputs) {
            return Err(EraError::Sequences { sequences: sequences.len(), inputs });
        }
        let samples = sequences[0].len();
        for (number, sequence) in sequences.iter().enumerate() {
            if sequence.len() != samples {
                return Err(EraError::Lengths { number, found: sequence.len(), expected: samples });
            }
            if let Some(index) = sequence.iter().position(|y| !y.is_finite()) {
                return Err(EraError::NotFinite { index });
            }
        }
        Ok(Self { sequences, inputs })
    }

    /// Number of outputs, `q`.
    pub fn outputs(&self) -> usize {
        self.sequences.len() / self.inputs
    }

    /// Number of inputs, `m`.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Samples of each sequence, the direct term included.
    pub fn samples(&self) -> usize {
        self.sequences[0].len()
    }

    /// What output `i` answers to input `j`.
    pub fn sequence(&self, i: usize, j: usize) -> &'a [f64] {
        self.sequences[i * self.inputs + j]
    }

    /// All sequences, in the order of [`MarkovParameters::new`].
    pub fn sequences(&self) -> &[&'a [f64]] {
        &self.sequences
    }
}

/// Markov parameters of a discrete model, in the order of [`MarkovParameters::new`]. Those of an unstable model may
/// overflow, which the caller has to check.
///
/// `samples` values each: `D`, `C B`, `C A B`, ... for every pair of an output and an input.
pub fn markov_parameters(model: &StateSpace, samples: usize) -> Vec<Vec<f64>> {
    let (a, c) = (rows_of(&model.a), rows_of(&model.c));
    let m = model.b.ncols();
    let mut sequences = vec![Vec::with_capacity(samples); c.len() * m];
    for (j, b) in columns_of(&model.b).into_iter().enumerate() {
        let mut x = b;
        let mut next = vec![0.0; x.len()];
        for k in 0..samples {
            for (i, c) in c.iter().enumerate() {
                sequences[i * m + j].push(if k == 0 { model.d[(i, j)] } else { dot(c, &x) });
            }
            if k > 0 {
                for (next, a) in next.iter_mut().zip(&a) {
                    *next = dot(a, &x);
                }
                std::mem::swap(&mut x, &mut next);
            }
        }
    }
    sequences
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;

    fn wave(frequency_hz: f64, noise: f64) -> IoData {
        let y = (0..2000)
            .map(|k| (2.0 * PI * frequency_hz * f64::from(k) * 1e-4).sin() + noise * (uniform_at(0, k as usize) - 0.5));
        IoData::new(Vec::new(), vec![y.collect()], 1e-4).unwrap()
    }

    #[test]
    fn the_step_follows_the_band_and_noise_keeps_everything() {
        // 10 kHz / (8 * 100 Hz) = 12.5, a line or two wider by the window.
        assert!((10..=12).contains(&automatic_thinning(&wave(100.0, 0.0), 20)));
        assert_eq!(automatic_thinning(&wave(100.0, 0.0), 500), 3);
        assert_eq!(automatic_thinning(&wave(100.0, 2.0), 20), 1);
        assert_eq!(automatic_thinning(&wave(100.0, 0.0), 5000), 1);
    }

    #[test]
    fn a_slow_wave_passes_and_a_fast_one_does_not() {
        let slow = thinned(&wave(50.0, 0.0), 10).unwrap();
        let size = |data: &IoData| data.outputs()[0].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        // 50 Hz is a tenth of the new Nyquist frequency: within the ripple of the window.
        assert!((size(&slow) - 1.0).abs() < 0.02, "{}", size(&slow));
        assert!((slow.sample_time_s() - 1e-3).abs() < 1e-18 && slow.samples() == 194);
        assert!(size(&thinned(&wave(1500.0, 0.0), 10).unwrap()) < 0.02);
    }

    #[test]
    fn begins_after_the_last_large_sample() {
        let force = [0.0, 5.0, -10.0, 0.2, 1.0, 0.3, -0.2, 0.0];
        assert_eq!(end_of_contact(&force, 0.1), Some(5));
        assert_eq!(end_of_contact(&force, 0.5), Some(3));
        assert_eq!(end_of_contact(&force, 0.0), Some(7));
        assert_eq!(end_of_contact(&[0.0; 4], 0.1), None);
        assert_eq!(end_of_contact(&[0.0, 1.0, 2.0], 0.1), None);
    }

    #[test]
    fn says_which_signal_is_wrong() {
        let error = IoData::new(vec![vec![0.0; 3]], vec![vec![0.0; 4]], 1.0).unwrap_err();
        assert_eq!(error.to_string(), "input 1 has 3 samples, the first output has 4");
        let error = IoData::new(vec![], vec![vec![0.0, f64::NAN]], 1.0).unwrap_err();
        assert_eq!(error.to_string(), "sample 1 of output 1 is not a finite number");
        assert!(IoData::new(vec![], vec![], 1.0).is_err());
        assert!(IoData::new(vec![], vec![vec![1.0]], 0.0).is_err());
    }
}
