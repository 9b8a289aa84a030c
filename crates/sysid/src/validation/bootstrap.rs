//! Uncertainty of a model by fitting it again to records with new noise.

use crumple_numerics::estimation::statistics::{quantile, standard_deviation};
use crumple_numerics::lti::{Complex, Mode};
use rayon::prelude::*;

use crate::validation::residual_resampling::{Resampling, ResidualNoise};

/// Share of the replicates below and above the intervals.
const TAIL: f64 = 0.05;

/// Share of the replicates that must have led to a model for a result to be given.
const LEAST_SUCCESS: f64 = 0.5;

/// Settings of [`bootstrap`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BootstrapOptions {
    /// Number of replicates.
    pub replicates: usize,
    /// Replicate `i` draws from stream `i` of this seed.
    pub seed: u64,
    /// How new noise is drawn.
    pub resampling: Resampling,
}

impl Default for BootstrapOptions {
    /// 200 replicates in blocks.
    fn default() -> Self {
        Self { replicates: 200, seed: 1, resampling: Resampling::Blocks }
    }
}

/// What is compared between models.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sample {
    /// Continuous poles, 1/s.
    pub poles: Vec<Complex>,
    /// Zeros, 1/s; empty where the method has none.
    pub zeros: Vec<Complex>,
    /// Frequency response on a grid of the caller's; empty where there is no input.
    pub response: Vec<Complex>,
}

/// Spread of one number over the replicates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Standard deviation.
    pub deviation: f64,
    /// 5 % of the replicates lie below.
    pub lower: f64,
    /// 5 % lie above.
    pub upper: f64,
}

impl Spread {
    fn from_values(mut values: Vec<f64>) -> Option<Self> {
        values.retain(|x| x.is_finite());
        values.sort_by(f64::total_cmp);
        Some(Self {
            deviation: standard_deviation(&values)?,
            lower: quantile(&values, TAIL)?,
            upper: quantile(&values, 1.0 - TAIL)?,
        })
    }
}

/// Spread of a frequency response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPoint {
    /// Modulus, below and above.
    pub magnitude: (f64, f64),
    /// Phase relative to that of the model, below and above, rad.
    pub phase_change_rad: (f64, f64),
}

/// What the replicates say.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualBootstrap {
    /// Replicates that led to a model.
    pub replicates: usize,
    /// Those that did not.
    pub failed: usize,
    /// How noise was drawn, in words.
    pub noise: String,
    /// Natural frequency, rad/s, of every pole in the order of the model.
    pub frequency: Vec<Option<Spread>>,
    /// Damping ratio likewise.
    pub damping: Vec<Option<Spread>>,
    /// Real part of every zero.
    pub zero_re: Vec<Option<Spread>>,
    /// Imaginary part of every zero.
    pub zero_im: Vec<Option<Spread>>,
    /// Frequency response on the caller's grid.
    pub band: Vec<Option<BandPoint>>,
}

/// Fits again and again: to the model's own output with noise like its residuals.
///
/// `model` is the fit whose uncertainty is asked for, `simulated` its output, `residual` what it leaves of the record,
/// `parameters` their number. `refit` gets a new output of the same length and returns what the estimator makes of it;
/// `None` is a failure that is counted. Replicates run in parallel and are collected by index. Poles and zeros of a
/// replicate are given to the nearest of the model, each once.
///
/// This is the spread that noise like the residuals causes if the model is true. It knows nothing of a wrong structure,
/// and percentile intervals of 200 replicates are themselves uncertain by a tenth of their length. The bias of the
/// estimator is not taken out. Efron & Tibshirani, *An Introduction to the ResidualBootstrap*, 1993.
pub fn bootstrap(
    model: &Sample,
    simulated: &[f64],
    residual: &[f64],
    parameters: usize,
    options: BootstrapOptions,
    refit: impl Fn(&[f64]) -> Option<Sample> + Sync,
) -> Option<ResidualBootstrap> {
    bootstrap_outputs(model, &[simulated.to_vec()], &[residual.to_vec()], parameters, options, |y| refit(&y[0]))
}

/// The same for several outputs: their noise is drawn together, so that what residuals have in common stays common.
pub fn bootstrap_outputs(
    model: &Sample,
    simulated: &[Vec<f64>],
    residuals: &[Vec<f64>],
    parameters: usize,
    options: BootstrapOptions,
    refit: impl Fn(&[Vec<f64>]) -> Option<Sample> + Sync,
) -> Option<ResidualBootstrap> {
    let noises = ResidualNoise::for_outputs(residuals, parameters, options.resampling, options.seed);
    let samples: Vec<Sample> = (0..options.replicates)
        .into_par_iter()
        .map(|index| {
            let with_noise = |(simulated, noise): (&Vec<f64>, &ResidualNoise)| {
                simulated.iter().zip(noise.replicate(index)).map(|(y, e)| y + e).collect()
            };
            refit(&simulated.iter().zip(&noises).map(with_noise).collect::<Vec<Vec<f64>>>())
        })
        .collect::<Vec<_>>()
        .into_iter()
        .flatten()
        .collect();
    if samples.len() < 2 || (samples.len() as f64) < LEAST_SUCCESS * options.replicates as f64 {
        return None;
    }
    let poles: Vec<Vec<Option<Complex>>> = samples.iter().map(|s| matched(&model.poles, &s.poles)).collect();
    let zeros: Vec<Vec<Option<Complex>>> = samples.iter().map(|s| matched(&model.zeros, &s.zeros)).collect();
    let spread = |matches: &[Vec<Option<Complex>>], count: usize, number: &dyn Fn(Complex) -> Option<f64>| {
        (0..count)
            .map(|k| {
                let values: Vec<f64> = matches.iter().filter_map(|replicate| number(replicate[k]?)).collect();
                if (values.len() as f64) < LEAST_SUCCESS * samples.len() as f64 {
                    None
                } else {
                    Spread::from_values(values)
                }
            })
            .collect::<Vec<Option<Spread>>>()
    };
    let (p, z) = (model.poles.len(), model.zeros.len());
    Some(ResidualBootstrap {
        replicates: samples.len(),
        failed: options.replicates - samples.len(),
        noise: noises.first()?.describe(),
        frequency: spread(&poles, p, &|s| Some(s.norm())),
        damping: spread(&poles, p, &|s| Mode::continuous(s).damping_ratio),
        zero_re: spread(&zeros, z, &|s| Some(s.re)),
        zero_im: spread(&zeros, z, &|s| Some(s.im)),
        band: model.response.iter().enumerate().map(|(k, h)| band_point(*h, &samples, k)).collect(),
    })
}

/// The same for a regression: its equation errors are drawn again, and `record` makes of them the output that the model
/// would have had with them.
///
/// Noise added to the output instead would correlate the regressors with the errors of the equation, and the replicates
/// would be biased against the fit they belong to. `residual` are the one-step prediction errors, `parameters` the
/// coefficients of the regression. If the errors are white this is the spread of the estimator; if they are not, the
/// spread about its bias. Freedman, Ann. Stat. 12, 1984.
pub fn bootstrap_equation_errors(
    model: &Sample,
    residual: &[f64],
    parameters: usize,
    options: BootstrapOptions,
    record: impl Fn(&[f64]) -> Option<Vec<f64>> + Sync,
    refit: impl Fn(&[f64]) -> Option<Sample> + Sync,
) -> Option<ResidualBootstrap> {
    let none = vec![0.0; residual.len()];
    let bootstrap = bootstrap(model, &none, residual, parameters, options, |errors| refit(&record(errors)?))?;
    Some(ResidualBootstrap {
        noise: format!("{}, of the one-step prediction, through 1/A", bootstrap.noise),
        ..bootstrap
    })
}

fn band_point(h: Complex, samples: &[Sample], k: usize) -> Option<BandPoint> {
    let values: Vec<Complex> = samples.iter().filter_map(|s| s.response.get(k).copied()).collect();
    let magnitude = Spread::from_values(values.iter().map(|x| x.norm()).collect())?;
    let phase = Spread::from_values(values.iter().map(|x| (x / h).arg()).collect())?;
    Some(BandPoint { magnitude: (magnitude.lower, magnitude.upper), phase_change_rad: (phase.lower, phase.upper) })
}

/// For every entry of `reference` one of `candidates`, the closest pairs first; `None` where none is left.
fn matched(reference: &[Complex], candidates: &[Complex]) -> Vec<Option<Complex>> {
    let mut pairs: Vec<(f64, usize, usize)> = reference
        .iter()
        .enumerate()
        .flat_map(|(i, r)| candidates.iter().enumerate().map(move |(j, f)| ((r - f).norm(), i, j)))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut result = vec![None; reference.len()];
    let mut used = vec![false; candidates.len()];
    for (_, i, j) in pairs {
        if result[i].is_none() && !used[j] {
            result[i] = Some(candidates[j]);
            used[j] = true;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;

    #[test]
    fn poles_go_to_their_nearest_each_once() {
        let c = Complex::new;
        let reference = [c(-1.0, 5.0), c(-1.0, -5.0), c(-3.0, 0.0)];
        let estimated = [c(-2.9, 0.0), c(-1.1, -5.2), c(-1.1, 5.2)];
        assert_eq!(matched(&reference, &estimated), [Some(estimated[2]), Some(estimated[1]), Some(estimated[0])]);
        assert_eq!(matched(&reference[..2], &estimated[..1]), [Some(estimated[0]), None]);
    }

    #[test]
    fn intervals_of_an_exact_regression_hold_estimate_and_truth() {
        use crate::{ArxOrder, IoData, arx};
        const DT_S: f64 = 0.01;
        let (a, b) = ([-1.6, 0.8], [0.3, 0.5, 0.2]);
        let sample = |model: &crate::Arx| {
            let poles = model.state_space().ok()?.poles().ok()?;
            let poles = poles.into_iter().filter(|z| z.im > 0.0).filter_map(|z| Some(Mode::discrete(z, DT_S)?.pole));
            Some(Sample { poles: poles.collect(), ..Sample::default() }).filter(|sample| sample.poles.len() == 1)
        };
        // z² - 1.6 z + 0.8 = 0.
        let truth = Mode::continuous(Mode::discrete(Complex::new(0.8, 0.4), DT_S).unwrap().pole);
        let order = ArxOrder { na: 2, nb: 3, nk: 0 };
        // By frequency and by damping: records whose interval holds the estimate, and the truth.
        let mut holds = [[0; 2]; 2];
        for stream in 0..20 {
            let u: Vec<f64> = (0..800).map(|k| uniform_at(300 + stream, k) - 0.5).collect();
            let mut y = vec![0.0; 800];
            for k in 2..800 {
                let white = 0.2 * (uniform_at(400 + stream, k) - 0.5);
                y[k] = white - a[0] * y[k - 1] - a[1] * y[k - 2] + b[0] * u[k] + b[1] * u[k - 1] + b[2] * u[k - 2];
            }
            let data = IoData::single(u.clone(), y.clone(), DT_S).unwrap();
            let model = arx(&data, order).unwrap();
            let errors: Vec<f64> = y.iter().zip(model.predict(&data)).map(|(y, yh)| y - yh).skip(2).collect();
            let estimated = bootstrap_equation_errors(
                &sample(&model).unwrap(),
                &errors,
                5,
                BootstrapOptions::default(),
                |errors| model.with_errors(&data, errors),
                |y| sample(&arx(&IoData::single(u.clone(), y.to_vec(), DT_S).ok()?, order).ok()?),
            )
            .unwrap();
            let estimate = Mode::continuous(sample(&model).unwrap().poles[0]);
            let spreads = [estimated.frequency[0].unwrap(), estimated.damping[0].unwrap()];
            for (holds, mode) in holds.iter_mut().zip([estimate, truth]) {
                let numbers = [mode.natural_frequency_rad_per_s, mode.damping_ratio.unwrap()];
                for ((holds, spread), x) in holds.iter_mut().zip(&spreads).zip(numbers) {
                    *holds += i32::from((spread.lower..=spread.upper).contains(&x));
                }
            }
        }
        // The estimate lies in the middle of its replicates. The truth: 90 % of 20, and a binomial number falls below
        // 14 once in 400.
        assert!(holds[0].iter().all(|h| *h >= 18) && holds[1].iter().all(|h| *h >= 14), "{holds:?}");
    }

    #[test]
    fn spread_of_a_mean_is_its_standard_error_and_failures_count() {
        // The estimator is the mean of the record, shown as a pole.
        let n = 400;
        let residual: Vec<f64> = (0..n).map(|k| uniform_at(5, k) - 0.5).collect();
        let model = Sample { poles: vec![Complex::new(-7.0, 0.0)], ..Sample::default() };
        let mean = |y: &[f64]| y.iter().sum::<f64>() / y.len() as f64;
        let refit = |y: &[f64]| {
            let mean = mean(y);
            (mean > -7.03).then(|| Sample { poles: vec![Complex::new(mean, 0.0)], ..Sample::default() })
        };
        let estimated = bootstrap(&model, &vec![-7.0; n], &residual, 1, BootstrapOptions::default(), refit).unwrap();
        // Deviation 1/sqrt(12 n) = 0.0144; 200 replicates know theirs to 5 %, the residuals to 3 %, cutting off the
        // lowest 2 % takes some 5 %: four times the root of the squares.
        let spread = estimated.frequency[0].unwrap();
        assert!((spread.deviation / 0.0144 - 1.0).abs() < 0.28, "{spread:?}");
        assert!(
            estimated.failed > 0 && estimated.failed < 20 && estimated.replicates + estimated.failed == 200,
            "{estimated:?}"
        );
        assert!(bootstrap(&model, &vec![-7.0; n], &residual, 1, BootstrapOptions::default(), |_| None).is_none());
    }
}
