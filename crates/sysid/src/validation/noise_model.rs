//! The noise of a record: added to the output, or run through the system itself.
//!
//! Two models of it are enough for what records hold: output error `y = B/F u + v`, `v` white or an autoregression of
//! its own, and ARX, `A y = B u + e`. The one-step prediction error decides between them by Schwarz's criterion (Ljung,
//! *System Identification*, 2nd ed. 1999, ch. 7 and 16). What it leaves is white, or no interval can be drawn from it.

use crumple_numerics::estimation::random::RandomNumbers;
use crumple_numerics::estimation::statistics::chi_square_95;
use crumple_numerics::linalg::dot;
use crumple_numerics::lti::{Complex, Mode, StateSpace};
use nalgebra::DMatrix;

use crate::output_error::options::OutputErrorOptions;
use crate::output_error::output_error::{OutputError, output_error, output_error_from};
use crate::{ArxOrder, IdentifyError, IoData, Subspace, SubspaceOptions, Weighting, arx, simulate_fitted};

/// Highest order of the autoregression of the errors of a simulation.
const HIGHEST_AUTOREGRESSION: usize = 6;

/// Lags of the test of whiteness.
const LAGS: usize = 25;

/// Errors are white up to so many times the 95 % point of the test.
const WHITE_UP_TO: f64 = 2.0;

/// Draws that a replicate forgets before its first sample.
const WARM_UP: usize = 400;

/// Errors below this share of the root mean square of an output are rounding.
const ROUNDING: f64 = 1e-9;

/// What makes the noise of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseKind {
    /// It is added to the output.
    OutputError,
    /// It goes through the poles of the system.
    Arx,
}

/// Burg's recursion on a signal: autoregressions of the orders 0, 1, 2, ...
///
/// `D(q) v = e`, `D` with its leading 1; variance of `e`: `mean(v²) prod (1 - kappa²)`. The mean is not removed. Burg,
/// *Maximum Entropy Spectral Analysis*, 1975.
pub(crate) fn burg(signal: &[f64], highest: usize) -> Vec<(f64, Vec<f64>)> {
    let n = signal.len();
    let (mut forward, mut backward) = (signal.to_vec(), signal.to_vec());
    let mut coefficients = vec![1.0];
    let mut variance = dot(signal, signal) / n.max(1) as f64;
    let mut all = vec![(variance, coefficients.clone())];
    for order in 1..=highest.min(n.saturating_sub(1)) {
        let product = dot(&forward[order..], &backward[order - 1..n - 1]);
        let squares =
            dot(&forward[order..], &forward[order..]) + dot(&backward[order - 1..n - 1], &backward[order - 1..n - 1]);
        let reflection = if squares > 0.0 { 2.0 * product / squares } else { 0.0 };
        let mut next = coefficients.clone();
        next.push(0.0);
        for (k, x) in coefficients.iter().rev().enumerate() {
            next[k + 1] -= reflection * x;
        }
        coefficients = next;
        for k in (order..n).rev() {
            let (f, b) = (forward[k], backward[k - 1]);
            (forward[k], backward[k]) = (f - reflection * b, b - reflection * f);
        }
        variance *= 1.0 - reflection * reflection;
        all.push((variance, coefficients.clone()));
    }
    all
}

/// `D(q) v`, without the first samples that lack their past.
pub(crate) fn whitened(signal: &[f64], filter: &[f64]) -> Vec<f64> {
    let order = filter.len() - 1;
    (order..signal.len()).map(|k| filter.iter().enumerate().map(|(i, d)| d * signal[k - i]).sum()).collect()
}

/// Statistic of Ljung & Box (Biometrika 65, 1978) over 25 lags, about zero; 0 for errors of zeros.
fn ljung_box(errors: &[f64]) -> f64 {
    let (n, energy) = (errors.len(), dot(errors, errors));
    if energy <= 0.0 {
        return 0.0;
    }
    let count = n as f64;
    let squares = (1..=LAGS.min(n.saturating_sub(1))).map(|lag| {
        let correlation = dot(&errors[lag..], &errors[..n - lag]) / energy;
        correlation * correlation / (count - lag as f64)
    });
    count * (count + 2.0) * squares.sum::<f64>()
}

/// How white the one-step prediction errors of an output are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whiteness {
    /// Statistic of Ljung and Box over 25 lags.
    pub ljung_box: f64,
    /// Its 95 % point with the degrees of freedom that the model leaves.
    pub limit_95: f64,
    /// Whether it is at most twice that.
    pub is_white: bool,
}

impl Whiteness {
    fn new(errors: &[f64], spent: usize) -> Self {
        let limit_95 = chi_square_95(LAGS.saturating_sub(spent).max(1) as f64);
        let ljung_box = ljung_box(errors);
        Self { ljung_box, limit_95, is_white: ljung_box <= WHITE_UP_TO * limit_95 }
    }
}

/// How new noise is made of innovations.
#[derive(Debug, Clone, PartialEq)]
enum Filter {
    /// `1/D` of every output.
    Each(Vec<Vec<f64>>),
    /// `1/A` of all together: `A_1, A_2, ...`.
    Together(Vec<DMatrix<f64>>),
}

/// The noise model of a record, with the system that belongs to it.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseModel {
    /// Which of the two.
    pub kind: NoiseKind,
    /// The sampled system without noise.
    pub model: StateSpace,
    /// Its poles, 1/s.
    pub poles: Vec<Complex>,
    /// Its output on the recorded input, without noise.
    pub simulated: Vec<Vec<f64>>,
    /// Mean square of the errors of the output-error simulation, by output; empty where that has no model.
    pub losses: Vec<f64>,
    /// Variances of the innovations of the autoregressions of orders 0, 1, ... of these errors, by output.
    pub variances: Vec<Vec<f64>>,
    /// Schwarz's criterion of output error with each of these orders for all outputs.
    pub bic_output_error: Vec<f64>,
    /// That of ARX, where it has a model.
    pub bic_arx: Option<f64>,
    /// The smallest.
    pub bic: f64,
    /// `D(q)` of every output with its leading 1; empty for ARX.
    pub autoregressions: Vec<Vec<f64>>,
    /// Of every output.
    pub whiteness: Vec<Whiteness>,
    filter: Filter,
    /// Innovations of every output at the same times, centred, scaled for the parameters that the fit took.
    innovations: Vec<Vec<f64>>,
}

/// How a noise model is looked for.
#[derive(Debug, Clone, Copy)]
pub struct NoiseOptions<'a> {
    /// Poles of the system.
    pub order: usize,
    /// Whether the record starts from rest.
    pub from_rest: bool,
    /// Sampled poles of models that are near: starts of the output-error fit.
    pub near: &'a [Vec<Complex>],
    /// Whether those are the only starts.
    pub near_alone: bool,
}

impl NoiseOptions<'_> {
    /// Of an order, in motion at the start, from the models of regressions.
    pub fn new(order: usize) -> Self {
        Self { order, from_rest: false, near: &[], near_alone: false }
    }
}

/// The best output-error fit from models of regressions and from what is near; of all starts of the engine where these
/// lead nowhere.
///
/// Noise that went through the system has optima of its own, in which output error follows the noise: a search from
/// everywhere finds them.
pub(crate) fn best_output_error(data: &IoData, options: NoiseOptions<'_>) -> Result<OutputError, IdentifyError> {
    from_starts(data, data, options)
}

/// The same with starts from another form of the record.
fn from_starts(data: &IoData, record: &IoData, options: NoiseOptions<'_>) -> Result<OutputError, IdentifyError> {
    let fit = OutputErrorOptions { from_rest: options.from_rest, ..OutputErrorOptions::new(options.order) };
    let mut starts = options.near.to_vec();
    if !options.near_alone {
        starts.extend(regressions(record, options.order));
    }
    match output_error_from(data, fit, &starts) {
        Err(_) if !options.near_alone => output_error(data, fit),
        result => result,
    }
}

/// Block rows of a subspace model, at least.
const BLOCK_ROWS: usize = 10;

/// Sampled poles of an ARX model and of subspace models of two horizons, of the order each.
fn regressions(data: &IoData, order: usize) -> Vec<Vec<Complex>> {
    let lags = order.div_ceil(data.outputs().len());
    let arx = arx(data, ArxOrder { na: lags, nb: lags + 1, nk: 0 }).and_then(|model| model.state_space());
    let subspace = |block_rows: usize| {
        let options = SubspaceOptions { weighting: Weighting::N4sid, block_rows, direct: true };
        Some(Subspace::new(data, options).ok()?.realize(order).ok()?.model)
    };
    let horizons = [(order + 2).max(BLOCK_ROWS), 3 * order + 2];
    let models = arx.ok().into_iter().chain(horizons.into_iter().filter_map(subspace));
    models.filter_map(|model| model.poles().ok()).collect()
}

/// One of the two models with its criterion.
struct Candidate {
    bic: f64,
    kind: NoiseKind,
    model: StateSpace,
    simulated: Vec<Vec<f64>>,
    filter: Filter,
    errors: Vec<Vec<f64>>,
    /// Parameters of every output.
    share: usize,
    /// Degrees of freedom that the test loses, by output.
    spent: Vec<usize>,
}

/// Finds the noise model of a record.
///
/// Free motion, a record without inputs, is the response to a unit sample at its start. Criteria: `N ln V + (p + d)
/// ln N`, `p` the poles and numerators of the system in both models, the motion at the start in neither; of several
/// outputs the sum, each with an autoregression of its own. An ARX model whose poles grow is no noise model. Errors:
/// neither has a model of this order.
pub fn noise_model(data: &IoData, options: NoiseOptions<'_>) -> Result<NoiseModel, IdentifyError> {
    let (n, m, q) = (options.order, data.inputs().len(), data.outputs().len());
    let samples = data.samples() as f64;
    let fit = if m > 0 {
        best_output_error(data, options)
    } else {
        let impulse = (0..data.samples()).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect();
        let driven = IoData::new(vec![impulse], data.outputs().to_vec(), data.sample_time_s())?;
        from_starts(&driven, data, NoiseOptions { from_rest: true, ..options })
    };
    let parameters = n + q * m * (n + 1);
    let (mut losses, mut variances, mut bic_output_error) = (Vec::new(), Vec::new(), Vec::new());
    let (by_fit, why) = match fit {
        Ok(fit) => {
            let errors = errors_of(data, &fit.simulated);
            let regressions: Vec<Vec<(f64, Vec<f64>)>> =
                errors.iter().map(|v| burg(v, HIGHEST_AUTOREGRESSION)).collect();
            let criterion = |variance: f64, d: usize| samples * floor(variance).ln() + d as f64 * samples.ln();
            let system = parameters as f64 * samples.ln();
            let orders = regressions.iter().map(Vec::len).min().unwrap_or(0);
            bic_output_error =
                (0..orders).map(|d| system + regressions.iter().map(|r| criterion(r[d].0, d)).sum::<f64>()).collect();
            losses = regressions.iter().map(|r| r[0].0).collect();
            variances = regressions.iter().map(|r| r.iter().map(|(v, _)| *v).collect()).collect();
            (Some(by_autoregressions(fit, &errors, &regressions, system, parameters, criterion)), None)
        }
        Err(error) => (None, Some(error)),
    };
    let by_arx = by_arx(data, n);
    let bic_arx = by_arx.as_ref().map(|candidate| candidate.bic);
    let best = match (by_fit, by_arx) {
        (Some(a), Some(b)) => Some(if b.bic < a.bic { b } else { a }),
        (a, b) => a.or(b),
    };
    let Some(best) = best else {
        return Err(why.unwrap_or(IdentifyError::NoStart { method: "a noise model", starts: 0 }));
    };
    let dt_s = data.sample_time_s();
    let exact = |(e, y): (&Vec<f64>, &Vec<f64>)| dot(e, e).sqrt() <= ROUNDING * dot(y, y).sqrt();
    let whiteness = best.errors.iter().zip(data.outputs()).zip(&best.spent).map(|((errors, y), spent)| {
        let whiteness = Whiteness::new(errors, *spent);
        // A fit to rounding has no noise that could be anything.
        Whiteness { is_white: whiteness.is_white || exact((errors, y)), ..whiteness }
    });
    let whiteness = whiteness.collect();
    let length = best.errors.iter().map(Vec::len).min().unwrap_or(0);
    let innovations = best.errors.iter().zip(&best.spent).map(|(errors, _)| {
        let kept = &errors[errors.len() - length..];
        let mean = kept.iter().sum::<f64>() / length.max(1) as f64;
        let factor = (length as f64 / length.saturating_sub(best.share).max(1) as f64).sqrt();
        kept.iter().map(|e| (e - mean) * factor).collect()
    });
    let innovations = innovations.collect();
    Ok(NoiseModel {
        kind: best.kind,
        poles: best.model.poles()?.into_iter().filter_map(|z| Some(Mode::discrete(z, dt_s)?.pole)).collect(),
        model: best.model,
        simulated: best.simulated,
        losses,
        variances,
        bic_output_error,
        bic_arx,
        bic: best.bic,
        autoregressions: match &best.filter {
            Filter::Each(filters) => filters.clone(),
            Filter::Together(_) => Vec::new(),
        },
        whiteness,
        filter: best.filter,
        innovations,
    })
}

/// No logarithm of zero.
fn floor(variance: f64) -> f64 {
    variance.max(f64::MIN_POSITIVE)
}

fn errors_of(data: &IoData, simulated: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let error = |(y, yh): (&Vec<f64>, &Vec<f64>)| y.iter().zip(yh).map(|(y, yh)| y - yh).collect();
    data.outputs().iter().zip(simulated).map(error).collect()
}

/// Output error with the autoregression of every output that has the smallest criterion.
fn by_autoregressions(
    fit: OutputError,
    errors: &[Vec<f64>],
    regressions: &[Vec<(f64, Vec<f64>)>],
    system: f64,
    parameters: usize,
    criterion: impl Fn(f64, usize) -> f64,
) -> Candidate {
    let best_order = |all: &Vec<(f64, Vec<f64>)>| {
        let criteria = all.iter().enumerate().map(|(d, (variance, _))| (d, criterion(*variance, d)));
        criteria.reduce(|best, next| if next.1 < best.1 { next } else { best }).unwrap_or((0, f64::INFINITY))
    };
    let orders: Vec<(usize, f64)> = regressions.iter().map(best_order).collect();
    let filters: Vec<Vec<f64>> =
        regressions.iter().zip(&orders).map(|(all, (d, _))| all.get(*d).map_or(vec![1.0], |r| r.1.clone())).collect();
    let most = orders.iter().map(|(d, _)| *d).max().unwrap_or(0);
    Candidate {
        bic: system + orders.iter().map(|(_, criterion)| criterion).sum::<f64>(),
        kind: NoiseKind::OutputError,
        model: fit.model,
        simulated: fit.simulated,
        errors: errors.iter().zip(&filters).map(|(v, filter)| whitened(v, filter)).collect(),
        filter: Filter::Each(filters),
        share: parameters.div_ceil(errors.len().max(1)) + most,
        spent: orders.iter().map(|(d, _)| *d).collect(),
    }
}

/// ARX of as many lags of all outputs as make the order; its rows begin after them.
fn by_arx(data: &IoData, order: usize) -> Option<Candidate> {
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let lags = order.div_ceil(q);
    let model = arx(data, ArxOrder { na: lags, nb: lags + 1, nk: 0 }).ok()?;
    let system = model.state_space().ok()?;
    if system.poles().ok()?.iter().any(|z| z.norm() >= 1.0) {
        return None;
    }
    let samples = data.samples() as f64;
    let of_output = q * lags + m * (lags + 1);
    let predicted = model.predict(data);
    let errors: Vec<Vec<f64>> = errors_of(data, &predicted).into_iter().map(|e| e[lags..].to_vec()).collect();
    let logarithms: f64 = model.losses.iter().map(|loss| floor(*loss).ln()).sum();
    Some(Candidate {
        bic: samples * logarithms + (q * of_output) as f64 * samples.ln(),
        kind: NoiseKind::Arx,
        simulated: simulate_fitted(&system, data).ok()?.0,
        model: system,
        errors,
        filter: Filter::Together(model.a),
        share: of_output,
        spent: vec![lags; q],
    })
}

impl NoiseModel {
    /// The one of two with the smaller criterion.
    pub(crate) fn or_smaller(self, other: Self) -> Self {
        if other.bic < self.bic { other } else { self }
    }

    /// Whether the errors of every output are white, so that intervals can be drawn from them.
    pub fn is_white(&self) -> bool {
        self.whiteness.iter().all(|whiteness| whiteness.is_white)
    }

    /// A record as it might have been measured instead, replicate `index`: the output without noise, and noise of new
    /// innovations in random order, those of all outputs of the same times. The same for any number of threads.
    pub fn replicate(&self, seed: u64, index: usize) -> Vec<Vec<f64>> {
        let samples = self.simulated.first().map_or(0, Vec::len);
        let count = self.innovations.first().map_or(0, Vec::len);
        if count == 0 {
            return self.simulated.clone();
        }
        let mut random = RandomNumbers::of_stream(seed, index);
        let places: Vec<usize> = (0..samples + WARM_UP).map(|_| random.below(count)).collect();
        let mut noise: Vec<Vec<f64>> = vec![Vec::with_capacity(places.len()); self.simulated.len()];
        for (k, place) in places.iter().enumerate() {
            for i in 0..noise.len() {
                let past: f64 = match &self.filter {
                    Filter::Each(filters) => {
                        let own = filters[i][1..].iter().enumerate();
                        own.filter_map(|(lag, d)| Some(d * noise[i][k.checked_sub(lag + 1)?])).sum()
                    }
                    Filter::Together(a) => {
                        let lags = a.iter().enumerate().filter_map(|(lag, a)| Some((k.checked_sub(lag + 1)?, a)));
                        lags.map(|(at, a)| (0..noise.len()).map(|j| a[(i, j)] * noise[j][at]).sum::<f64>()).sum()
                    }
                };
                let now = self.innovations[i][*place] - past;
                noise[i].push(now);
            }
        }
        let with_noise = |(y, v): (&Vec<f64>, &Vec<f64>)| y.iter().zip(&v[WARM_UP..]).map(|(y, v)| y + v).collect();
        self.simulated.iter().zip(&noise).map(with_noise).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    /// A second-order system, its output with noise of deviation 0.1 and this filter `1/D`.
    fn record(noise: &[f64], seed: u64) -> IoData {
        let mut random = RandomNumbers::seeded(seed);
        let u: Vec<f64> = (0..600).map(|_| random.uniform() - 0.5).collect();
        let (mut y, mut v) = (vec![0.0; 600], vec![0.0; 600]);
        for k in 2..600 {
            y[k] = 1.7 * y[k - 1] - 0.95 * y[k - 2] + 0.2 * u[k - 1] + 0.1 * u[k - 2];
            v[k] = 0.1 * random.normal() - (1..noise.len().min(k + 1)).map(|i| noise[i] * v[k - i]).sum::<f64>();
        }
        IoData::single(u, y.iter().zip(&v).map(|(y, v)| y + v).collect(), 0.01).unwrap()
    }

    #[test]
    fn noise_is_told_by_the_way_it_took() {
        for (filter, kind, order) in [
            (&[1.0][..], NoiseKind::OutputError, 0),
            (&[1.0, -0.9], NoiseKind::OutputError, 1),
            (&[1.0, -1.7, 0.95], NoiseKind::Arx, 0),
        ] {
            let noise = noise_model(&record(filter, 5), NoiseOptions::new(2)).unwrap();
            assert_eq!((noise.kind, noise.is_white()), (kind, true), "{filter:?}");
            assert_eq!(noise.autoregressions.first().map_or(0, |d| d.len() - 1), order);
        }
        // A sum of twelve white samples is neither.
        let sum: Vec<f64> = (0..13).map(|k| f64::from(u8::from(k == 0)) - 0.8 * f64::from(u8::from(k == 12))).collect();
        assert!(!noise_model(&record(&sum, 5), NoiseOptions::new(2)).unwrap().is_white());
    }

    #[test]
    fn replicates_have_variance_and_correlation_of_the_noise() {
        let noise = noise_model(&record(&[1.0, -0.9], 6), NoiseOptions::new(2)).unwrap();
        let (mut power, mut product) = (0.0, 0.0);
        for index in 0..60 {
            let y = &noise.replicate(3, index)[0];
            let v: Vec<f64> = y.iter().zip(&noise.simulated[0]).map(|(y, m)| y - m).collect();
            power += dot(&v, &v);
            product += dot(&v[1..], &v[..v.len() - 1]);
        }
        // Variance and coefficient of what was fitted; 36,000 samples of correlation time 19 know both to 3 %.
        let d = noise.autoregressions[0][1];
        let variance = dot(&noise.innovations[0], &noise.innovations[0]) / noise.innovations[0].len() as f64;
        assert!((power / 36_000.0 / (variance / (1.0 - d * d)) - 1.0).abs() < 0.1, "{power}");
        assert!((product / power + d).abs() < 0.03, "{product}");
    }
}
