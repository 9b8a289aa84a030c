//! Noise for the bootstrap, drawn from the residuals of a fit.
//!
//! A bootstrap of a simulation asks how a model would vary if the same record were measured again. Its residuals are
//! correlated in time; drawn one by one they would look whiter, and the spread would come out too small. Both ways
//! here keep the correlation: blocks of residuals, or a regression that makes it.

use crumple_numerics::estimation::random::{RandomNumbers, circular_blocks};
use crumple_numerics::estimation::statistics::sokal_autocorrelation_time;
use crumple_numerics::linalg::dot;

/// How new noise is drawn from residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resampling {
    /// Blocks of neighbouring residuals, put together at random, so that their correlation survives (circular block
    /// bootstrap, Politis & Romano 1992).
    Blocks,
    /// An autoregression fitted to the residuals, driven by its own innovations in random order.
    Autoregression,
}

impl Resampling {
    /// Name in options and records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blocks => "blocks",
            Self::Autoregression => "autoregression",
        }
    }
}

/// Residuals prepared for drawing: mean removed, and enlarged by `sqrt(N/(N - p))` for the parameters that the fit
/// took.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ResidualNoise {
    residual: Vec<f64>,
    kind: Kind,
    seed: u64,
}

/// How noise is drawn, with what that takes: the length of a block, or the regression and what drives it.
#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Blocks { length: usize },
    Autoregression { coefficients: Vec<f64>, innovations: Vec<f64> },
}

impl Kind {
    /// The regression with its innovations on this record, their mean removed.
    fn autoregression(residual: &[f64], coefficients: Vec<f64>) -> Self {
        let mut innovations: Vec<f64> = (coefficients.len()..residual.len())
            .map(|k| residual[k] - coefficients.iter().enumerate().map(|(i, a)| a * residual[k - 1 - i]).sum::<f64>())
            .collect();
        let mean = innovations.iter().sum::<f64>() / innovations.len().max(1) as f64;
        innovations.iter_mut().for_each(|e| *e -= mean);
        Self::Autoregression { coefficients, innovations }
    }
}

/// Residuals with their mean removed, times `sqrt(N/(N - p))`: a fit with `p` parameters leaves them smaller than the
/// noise.
fn prepared(residual: &[f64], parameters: usize) -> Vec<f64> {
    let n = residual.len();
    let mean = residual.iter().sum::<f64>() / n.max(1) as f64;
    let free = n.saturating_sub(parameters).max(1) as f64;
    let factor = (n as f64 / free).sqrt();
    residual.iter().map(|e| (e - mean) * factor).collect()
}

impl ResidualNoise {
    /// From the residuals of a fit with a number of parameters.
    ///
    /// Block length: `(sqrt 6 rho/(1 - rho²))^(2/3) N^(1/3)`, the best for a first-order autoregression of the
    /// residuals' autocorrelation time `(1 + rho)/(1 - rho)` (Carlstein, Ann. Stat. 14, 1986), at most a quarter of the
    /// record. Order of the autoregression: by Akaike's criterion up to `10 log10 N` (Yule-Walker).
    #[cfg(test)]
    pub fn new(residual: &[f64], parameters: usize, resampling: Resampling, seed: u64) -> Self {
        let residual = prepared(residual, parameters);
        let kind = match resampling {
            Resampling::Blocks => Kind::Blocks { length: block_length(&residual) },
            Resampling::Autoregression => Kind::autoregression(&residual, autoregression(&residual)),
        };
        Self { residual, kind, seed }
    }

    /// From the residuals of several outputs of one model, of one length: replicates of one index are drawn at the same
    /// places, so that what the outputs have in common stays common. The longest of the outputs' blocks (the highest of
    /// their orders) is that of all; each output takes its share of the parameters.
    pub fn for_outputs(residuals: &[Vec<f64>], parameters: usize, resampling: Resampling, seed: u64) -> Vec<Self> {
        let share = parameters.div_ceil(residuals.len().max(1));
        let residuals: Vec<Vec<f64>> = residuals.iter().map(|e| prepared(e, share)).collect();
        let length = residuals.iter().map(|e| block_length(e)).max().unwrap_or(1);
        let mut regressions: Vec<Vec<f64>> = match resampling {
            Resampling::Blocks => Vec::new(),
            Resampling::Autoregression => residuals.iter().map(|e| autoregression(e)).collect(),
        };
        let order = regressions.iter().map(Vec::len).max().unwrap_or(0);
        regressions.iter_mut().for_each(|a| a.resize(order, 0.0));
        let mut regressions = regressions.into_iter();
        residuals
            .into_iter()
            .map(|residual| {
                let kind = match regressions.next() {
                    Some(coefficients) => Kind::autoregression(&residual, coefficients),
                    None => Kind::Blocks { length },
                };
                Self { residual, kind, seed }
            })
            .collect()
    }

    /// How it is drawn, in words.
    pub fn describe(&self) -> String {
        match &self.kind {
            Kind::Blocks { length } => format!("residuals in blocks of {length} samples"),
            Kind::Autoregression { coefficients, .. } => {
                format!("an autoregression of order {} of the residuals", coefficients.len())
            }
        }
    }

    /// Noise of replicate `index`, of the length of the record: the same for any number of threads.
    pub fn replicate(&self, index: usize) -> Vec<f64> {
        let n = self.residual.len();
        if n == 0 {
            return Vec::new();
        }
        let mut random = RandomNumbers::of_stream(self.seed, index);
        match &self.kind {
            Kind::Blocks { length } => {
                circular_blocks(&mut random, n, *length).into_iter().map(|place| self.residual[place]).collect()
            }
            Kind::Autoregression { coefficients, innovations } => {
                if innovations.is_empty() {
                    return vec![0.0; n];
                }
                // Long enough to forget that it starts from zero.
                let warm_up = 20 * coefficients.len() + 200;
                let mut noise: Vec<f64> = Vec::with_capacity(n + warm_up);
                for k in 0..n + warm_up {
                    let past: f64 = coefficients
                        .iter()
                        .enumerate()
                        .filter_map(|(i, a)| Some(a * noise[k.checked_sub(i + 1)?]))
                        .sum();
                    noise.push(past + innovations[random.below(innovations.len())]);
                }
                noise.split_off(warm_up)
            }
        }
    }
}

/// Carlstein's rule with `rho` from the autocorrelation time `(1 + rho)/(1 - rho)`; between 1 and a quarter of the
/// record.
fn block_length(residual: &[f64]) -> usize {
    let time = sokal_autocorrelation_time(residual);
    let rho = (time - 1.0) / (time + 1.0);
    let n = residual.len() as f64;
    let length = (6.0_f64.sqrt() * rho / (1.0 - rho * rho)).powf(2.0 / 3.0) * n.cbrt();
    (length.ceil() as usize).clamp(1, (residual.len() / 4).max(1))
}

/// Coefficients `a` of `e[k] = sum a_i e[k-i] + w[k]` by the recursion of Levinson and Durbin, of the order with the
/// least `N ln V + 2 p`.
fn autoregression(residual: &[f64]) -> Vec<f64> {
    let n = residual.len();
    let highest = ((10.0 * (n.max(1) as f64).log10()) as usize).min(n / 4);
    let covariance = |lag: usize| dot(&residual[lag..], &residual[..n - lag]);
    let mut error = if n > 0 { covariance(0) } else { 0.0 };
    let mut a: Vec<f64> = Vec::new();
    let mut best = (n as f64 * error.max(f64::MIN_POSITIVE).ln(), Vec::new());
    for order in 1..=highest {
        if error.is_nan() || error <= 0.0 {
            break;
        }
        let missing = covariance(order) - a.iter().enumerate().map(|(i, a)| a * covariance(order - 1 - i)).sum::<f64>();
        let reflection = missing / error;
        let mut next: Vec<f64> = a.iter().zip(a.iter().rev()).map(|(x, y)| x - reflection * y).collect();
        next.push(reflection);
        a = next;
        error *= 1.0 - reflection * reflection;
        let criterion = n as f64 * error.max(f64::MIN_POSITIVE).ln() + 2.0 * order as f64;
        if criterion < best.0 {
            best = (criterion, a.clone());
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_numerics::estimation::random::uniform_at;

    fn autoregressive(rho: f64, n: usize) -> Vec<f64> {
        let mut e = 0.0;
        (0..n + 100)
            .map(|k| {
                e = rho * e + uniform_at(3, k) - 0.5;
                e
            })
            .skip(100)
            .collect()
    }

    fn lag_one(e: &[f64]) -> f64 {
        dot(&e[1..], &e[..e.len() - 1]) / dot(e, e)
    }

    #[test]
    fn new_noise_has_variance_and_correlation_of_the_residuals() {
        let residual = autoregressive(0.8, 4000);
        let variance = dot(&residual, &residual) / 4000.0;
        for resampling in [Resampling::Blocks, Resampling::Autoregression] {
            let noise = ResidualNoise::new(&residual, 0, resampling, 7);
            let new: Vec<f64> = (0..50).flat_map(|i| noise.replicate(i)).collect();
            let ratio = dot(&new, &new) / new.len() as f64 / variance;
            // 200,000 samples of correlation time 9: 1 %, three times; blocks of length l lose 1/l of lag one: 3 %.
            assert!((ratio - 1.0).abs() < 0.03, "{resampling:?}: {ratio}");
            assert!((lag_one(&new) - lag_one(&residual)).abs() < 0.03, "{resampling:?}: {}", noise.describe());
        }
    }

    #[test]
    fn white_residuals_are_drawn_one_by_one_and_time_is_that_of_the_autoregression() {
        let white = autoregressive(0.0, 4000);
        // The estimate of a time of 1 wanders by some 0.1; the block stays below a handful.
        assert!(block_length(&white) <= 8, "{}", block_length(&white));
        assert!(autoregression(&white).len() <= 6);
        // (1 + 0.8)/(1 - 0.8) = 9, known to sqrt(2 (2 M + 1)/N) = 0.2 with a window of M = 45.
        let time = sokal_autocorrelation_time(&autoregressive(0.8, 4000));
        assert!((time - 9.0).abs() < 0.6 * 9.0, "{time}");
        assert_eq!(sokal_autocorrelation_time(&[0.0; 10]), 1.0);
    }

    #[test]
    fn what_outputs_have_in_common_stays_common() {
        let common = autoregressive(0.7, 2000);
        let own: Vec<f64> = common.iter().enumerate().map(|(k, e)| 2.0 * e + 0.1 * (uniform_at(9, k) - 0.5)).collect();
        let correlation = |a: &[f64], b: &[f64]| dot(a, b) / (dot(a, a) * dot(b, b)).sqrt();
        let there = correlation(&common, &own);
        for resampling in [Resampling::Blocks, Resampling::Autoregression] {
            let noise = ResidualNoise::for_outputs(&[common.clone(), own.clone()], 10, resampling, 3);
            let estimated = correlation(&noise[0].replicate(2), &noise[1].replicate(2));
            // Two draws at the same places: as far as 2000 samples know a correlation near one.
            assert!((estimated - there).abs() < 0.02, "{resampling:?}: {estimated} {there}");
            assert_eq!(
                ResidualNoise::for_outputs(std::slice::from_ref(&common), 10, resampling, 3)[0],
                ResidualNoise::new(&common, 10, resampling, 3)
            );
        }
    }

    #[test]
    fn replicates_differ_and_depend_on_seed_and_index_alone() {
        let residual = autoregressive(0.5, 300);
        let noise = ResidualNoise::new(&residual, 10, Resampling::Blocks, 1);
        assert_eq!(noise.replicate(4), noise.replicate(4));
        assert!(noise.replicate(4) != noise.replicate(5));
        assert!(noise.replicate(4) != ResidualNoise::new(&residual, 10, Resampling::Blocks, 2).replicate(4));
        assert!(ResidualNoise::new(&[], 3, Resampling::Autoregression, 1).replicate(0).is_empty());
    }
}
