//! Waveforms of several quantities, scaled so that ERA can take them together.

use crumple_sysid::{EraError, MarkovParameters, Realization};

use crate::stage::waves::input_output::WindowedWave;

/// The samples of waveforms as ERA is given them: of different quantities each divided by its root mean square, for
/// sequences count by their size.
pub struct ScaledWaves<'a> {
    waves: &'a [WindowedWave],
    /// Divisors and the divided samples; empty where the quantity is one.
    scales: Vec<f64>,
    scaled: Vec<Vec<f64>>,
}

impl<'a> ScaledWaves<'a> {
    /// Of waveforms sampled together, at least one.
    pub fn new(waves: &'a [WindowedWave]) -> Self {
        if waves.iter().all(|wave| wave.quantity == waves[0].quantity) {
            return Self { waves, scales: Vec::new(), scaled: Vec::new() };
        }
        let scales: Vec<f64> = waves.iter().map(|wave| root_mean_square(wave.sampled.samples())).collect();
        let divided = |(wave, scale): (&WindowedWave, &f64)| wave.sampled.samples().iter().map(|x| x / scale).collect();
        let scaled = waves.iter().zip(&scales).map(divided).collect();
        Self { waves, scales, scaled }
    }

    /// One a waveform.
    pub fn slices(&self) -> Vec<&[f64]> {
        if self.scaled.is_empty() {
            return self.waves.iter().map(|wave| wave.sampled.samples()).collect();
        }
        self.scaled.iter().map(Vec::as_slice).collect()
    }

    /// The same as Markov parameters of one impulse.
    pub fn markov(&self) -> Result<MarkovParameters<'_>, EraError> {
        MarkovParameters::new(self.slices(), 1)
    }

    /// Other samples of the same waveforms, divided alike.
    pub fn divided(&self, samples: &[Vec<f64>]) -> Vec<Vec<f64>> {
        if self.scales.is_empty() {
            return samples.to_vec();
        }
        samples.iter().zip(&self.scales).map(|(y, scale)| y.iter().map(|x| x / scale).collect()).collect()
    }

    /// The model of the samples as they are.
    pub fn unscaled(&self, model: Realization) -> Realization {
        if self.scales.is_empty() { model } else { model.with_outputs_times(&self.scales) }
    }
}

/// 1 for silence.
fn root_mean_square(samples: &[f64]) -> f64 {
    let largest = samples.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 {
        return 1.0;
    }
    let sum: f64 = samples.iter().map(|x| (x / largest).powi(2)).sum();
    largest * (sum / samples.len() as f64).sqrt()
}
