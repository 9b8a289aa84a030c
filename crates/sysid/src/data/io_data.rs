//! Inputs and outputs of a system, sampled together.

use crate::IdentifyError;

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
            return Err(crumple_lti::LtiError::SampleTime(sample_time_s).into());
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

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
