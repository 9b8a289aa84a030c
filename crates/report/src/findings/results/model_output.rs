//! An output of an identified model beside the measured one, and what is left between them.

use crumple_artifact::records::EvidenceV1;
use crumple_signal::{QuantityKind, Sampled};

/// Lags to either side that correlations of errors are shown at.
const LAGS: usize = 25;

/// One output of an identified model.
#[derive(Debug, Clone, Default)]
pub struct ModelOutput {
    /// Channel.
    pub channel: String,
    /// Fit of the samples that the model was identified from, percent.
    pub fit_percent: Option<f64>,
    /// What speaks for the model at this output.
    pub evidence: Option<EvidenceV1>,
    /// What it measures.
    pub quantity: Option<QuantityKind>,
    /// The record, times from time zero.
    pub measured: Option<Sampled>,
    /// The output of the model; that of unseen samples with the start fitted.
    pub simulated: Option<Sampled>,
    /// First unseen sample, s.
    pub unseen_from_s: Option<f64>,
}

/// Correlation of the errors of a simulation with themselves or with an input.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorCorrelation {
    /// Lag in samples and correlation.
    pub at_lags: Vec<[f64; 2]>,
    /// 95 % limit for white errors, independent of the input: `1.96/sqrt(N)`.
    pub limit: f64,
}

impl ErrorCorrelation {
    /// Lags outside the limits, those of lag 0 of the errors themselves left out.
    pub fn outside(&self) -> usize {
        self.at_lags.iter().filter(|[lag, r]| *lag != 0.0 && r.abs() > self.limit).count()
    }
}

impl ModelOutput {
    /// Simulated less measured over the samples that the model was identified from, and the first of them in the
    /// record; `None` without both curves.
    fn errors(&self) -> Option<(Vec<f64>, f64)> {
        let (measured, simulated) = (self.measured.as_ref()?, self.simulated.as_ref()?);
        let first = measured.index_at_or_after(simulated.t0_s() - 0.5 * simulated.dt_s());
        let used = self.unseen_from_s.map_or(simulated.len(), |from| {
            simulated.index_at_or_after(from - 0.5 * simulated.dt_s()).min(simulated.len())
        });
        let record = measured.samples().get(first..first + used)?;
        let errors: Vec<f64> = record.iter().zip(simulated.samples()).map(|(y, yh)| y - yh).collect();
        (errors.len() > LAGS).then_some((errors, simulated.t0_s()))
    }

    /// Autocorrelation of the errors of the simulation from lag 0 on.
    pub fn autocorrelation(&self) -> Option<ErrorCorrelation> {
        let (errors, _) = self.errors()?;
        let at = |lag: usize| (lag as f64, product(&errors[lag..], &errors), product(&errors, &errors));
        correlation(errors.len(), (0..=LAGS).map(at))
    }

    /// Correlation of the errors with an input, at negative lags with what the input does after them.
    pub fn correlation_with(&self, input: &Sampled) -> Option<ErrorCorrelation> {
        let (errors, start_s) = self.errors()?;
        let first = input.index_at_or_after(start_s - 0.5 * input.dt_s());
        let input = input.samples().get(first..first + errors.len())?;
        let size = (product(&errors, &errors) * product(input, input)).sqrt();
        let before = (1..=LAGS).rev().map(|lag| (-(lag as f64), product(&errors, &input[lag..]), size));
        let after = (0..=LAGS).map(|lag| (lag as f64, product(&errors[lag..], input), size));
        correlation(errors.len(), before.chain(after))
    }
}

/// Sum of the products as far as both go.
fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// From lag, covariance and size; `None` where something does not vary.
fn correlation(samples: usize, at_lags: impl Iterator<Item = (f64, f64, f64)>) -> Option<ErrorCorrelation> {
    let at_lags: Option<Vec<[f64; 2]>> = at_lags
        .map(|(lag, covariance, size)| (size > 0.0 && size.is_finite()).then(|| [lag, covariance / size]))
        .collect();
    Some(ErrorCorrelation { at_lags: at_lags?, limit: 1.96 / (samples as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_that_follow_the_input_late_correlate_at_that_lag_alone() {
        // Values of one that look random, from the fractional parts of multiples of an irrational number.
        let input: Vec<f64> = (0..1000).map(|k| (f64::from(k * k) * 0.618_033_988_75).fract() - 0.5).collect();
        let late = |lag: usize| (0..800).map(|k| if k < lag { 0.0 } else { input[k - lag] }).collect::<Vec<f64>>();
        let sampled = |samples: Vec<f64>| Sampled::new(0.0, 0.01, samples).ok();
        let output = ModelOutput {
            measured: sampled([late(3), vec![9.0; 200]].concat()),
            simulated: sampled(vec![0.0; 1000]),
            unseen_from_s: Some(8.0),
            ..ModelOutput::default()
        };
        let with_input = output.correlation_with(&sampled(input.clone()).unwrap()).unwrap();
        assert_eq!((with_input.at_lags.len(), with_input.at_lags[0][0]), (2 * LAGS + 1, -25.0));
        let at = |lag: f64| with_input.at_lags.iter().find(|[l, _]| *l == lag).unwrap()[1];
        // 800 of the 1000 samples of the input are over the errors, three of them without an answer.
        assert!(at(3.0) > 0.9 && at(0.0).abs() < 0.2, "{with_input:?}");
        let own = output.autocorrelation().unwrap();
        assert_eq!(own.at_lags[0], [0.0, 1.0]);
        // 1.96/sqrt(800): the unseen samples do not count.
        assert!((own.limit - 1.96 / 800_f64.sqrt()).abs() < 1e-15);
    }
}
