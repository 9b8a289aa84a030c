//! Choices by the one-step prediction error: number of states, delay, and which of several models to use.

use crumple_numerics::lti::Complex;
use rayon::prelude::*;

use crate::output_error::options::OutputErrorOptions;
use crate::output_error::output_error::output_error;
use crate::validation::noise_model::{NoiseKind, NoiseModel, NoiseOptions, burg, noise_model};
use crate::{ArxOrder, IdentifyError, InformationCriteria, IoData, arx_from};

/// Highest order of the autoregression of a simulation's errors.
const HIGHEST_AUTOREGRESSION: usize = 6;

/// By so many points a model must follow unseen samples better to be recommended before one of a single state.
const BETTER_BY_POINTS: f64 = 2.0;

/// A fit of unseen samples that lies further (percent) below the fit of those that a model was identified from is that
/// of another system.
const LARGEST_LOSS_PERCENT: f64 = 30.0;

// The number of states.

/// ARX models of orders 1, 2, ... (as many past outputs as inputs, from the delay on), all on the same rows: mean
/// square of the prediction errors and Schwarz's criterion of each. Errors: those of the regressions.
pub fn arx_orders(data: &IoData, delay: usize, highest: usize) -> Result<Vec<(f64, f64)>, IdentifyError> {
    let of_order = |n: usize| {
        let model = arx_from(data, ArxOrder { na: n, nb: n, nk: delay }, highest + delay)?;
        let parameters = n * (1 + data.inputs().len());
        Ok((model.losses[0], InformationCriteria::new(model.losses[0], model.rows as f64, parameters).bic))
    };
    (1..=highest).map(of_order).collect()
}

/// Place of the smallest criterion.
pub fn smallest(criteria: impl IntoIterator<Item = f64>) -> Option<usize> {
    let all = criteria.into_iter().enumerate().filter(|(_, criterion)| criterion.is_finite());
    all.reduce(|best, next| if next.1 < best.1 { next } else { best }).map(|(place, _)| place)
}

/// Noise models of the orders 1 to `highest`, those that there are, each by its order; output error of an order starts
/// also from the optimum of the order below and a real pole at ±0.5.
pub fn noise_of_orders(data: &IoData, from_rest: bool, highest: usize) -> Vec<(usize, NoiseModel)> {
    let mut all: Vec<(usize, NoiseModel)> = Vec::new();
    let mut below: Vec<Complex> = Vec::new();
    for order in 1..=highest {
        let near: Vec<Vec<Complex>> =
            [0.5, -0.5].map(|pole| below.iter().copied().chain([Complex::new(pole, 0.0)]).collect()).into();
        let near = if below.is_empty() && order > 1 { Vec::new() } else { near };
        let options = NoiseOptions { from_rest, near: &near, ..NoiseOptions::new(order) };
        let Ok(noise) = noise_model(data, options) else { continue };
        below = match noise.kind {
            NoiseKind::OutputError => noise.model.poles().unwrap_or_default(),
            NoiseKind::Arx => Vec::new(),
        };
        all.push((order, noise));
    }
    all
}

// The delay.

/// Lags by which an input may act, tried one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayScan {
    /// The lags; a zero-order hold takes one of its own.
    pub lags: Vec<usize>,
    /// Schwarz's criterion of ARX of every lag.
    pub bic_arx: Vec<f64>,
    /// That of output error with an autoregression of its errors.
    pub bic_output_error: Vec<f64>,
    /// The noise model with the smallest criterion of all, which decides.
    pub noise: NoiseKind,
    /// Its best lag.
    pub lag: usize,
    /// Whether that is the last one tried, or the first and not 0.
    pub at_edge: bool,
}

/// Tries the lags `first ..= last` with `order` poles and as many numerator terms from the lag on, all on the same
/// rows. `None`: the record is too short, or no lag has a model.
pub fn delay_scan(data: &IoData, order: usize, first: usize, last: usize) -> Option<DelayScan> {
    let lags: Vec<usize> = (first..=last).collect();
    let rows = data.samples().checked_sub(last + order).filter(|rows| *rows > 4 * order + 2)? as f64;
    let parameters = (order * (1 + data.inputs().len())) as f64;
    let criteria: Vec<(f64, f64)> = lags
        .par_iter()
        .map(|lag| {
            let of_output = |output: &Vec<f64>| {
                let single = IoData::new(data.inputs().to_vec(), vec![output.clone()], data.sample_time_s()).ok()?;
                let arx = arx_from(&single, ArxOrder { na: order, nb: order, nk: *lag }, last + order).ok()?;
                let arx = rows * arx.losses[0].max(f64::MIN_POSITIVE).ln() + parameters * rows.ln();
                Some((arx, by_output_error(&single, order, *lag, last + order)?))
            };
            let all: Option<Vec<(f64, f64)>> = data.outputs().iter().map(of_output).collect();
            all.map_or((f64::INFINITY, f64::INFINITY), |all| {
                all.iter().fold((0.0, 0.0), |sum, next| (sum.0 + next.0, sum.1 + next.1))
            })
        })
        .collect();
    let (bic_arx, bic_output_error): (Vec<f64>, Vec<f64>) = criteria.into_iter().unzip();
    let best = |criteria: &[f64]| smallest(criteria.iter().copied()).map(|place| (place, criteria[place]));
    let (arx, output_error) = (best(&bic_arx), best(&bic_output_error));
    let (noise, place) = match (arx, output_error) {
        (Some(arx), Some(other)) if arx.1 < other.1 => (NoiseKind::Arx, arx.0),
        (_, Some(other)) => (NoiseKind::OutputError, other.0),
        (arx, None) => (NoiseKind::Arx, arx?.0),
    };
    let lag = lags[place];
    let at_edge = lag == last || (lag == first && first > 0);
    Some(DelayScan { lags, bic_arx, bic_output_error, noise, lag, at_edge })
}

/// Criterion of output error of one lag on the rows from `from` on, in motion at their start.
fn by_output_error(data: &IoData, order: usize, lag: usize, from: usize) -> Option<f64> {
    // Without a direct term the numerator begins one sample late.
    let moved = match lag {
        0 => {
            let ahead = |u: &Vec<f64>| u[1..].iter().copied().chain([0.0]).collect();
            IoData::new(data.inputs().iter().map(ahead).collect(), data.outputs().to_vec(), data.sample_time_s())
                .ok()?
        }
        _ => data.delayed(lag - 1),
    };
    let rows = moved.slice(from, data.samples()).ok()?;
    let options = OutputErrorOptions { direct: false, random_starts: 0, ..OutputErrorOptions::new(order) };
    let fit = output_error(&rows, options).ok()?;
    let errors: Vec<f64> = rows.outputs()[0].iter().zip(&fit.simulated[0]).map(|(y, yh)| y - yh).collect();
    let count = errors.len() as f64;
    let parameters = order * (1 + data.inputs().len());
    let criteria = burg(&errors, HIGHEST_AUTOREGRESSION)
        .into_iter()
        .enumerate()
        .map(|(d, (variance, _))| count * variance.max(f64::MIN_POSITIVE).ln() + (parameters + d) as f64 * count.ln());
    criteria.reduce(f64::min)
}

// Which model to use.

/// A model that may be recommended.
#[derive(Debug, Clone, PartialEq)]
pub struct Recommendable {
    /// Its name.
    pub id: String,
    /// Number of its states.
    pub order: usize,
    /// Schwarz's criterion of its simulation; differences will do.
    pub bic: f64,
    /// Fit of samples that it has not seen with the start fitted, mean over the outputs, percent.
    pub validation_percent: Option<f64>,
}

/// The model to use, and the one with the smallest criterion where it was passed over; `None` without models.
///
/// The smallest criterion decides. Where that is a model of a single state and models of higher order follow unseen
/// samples better by two points or more, the smallest criterion among those does.
pub fn recommended(models: &[Recommendable]) -> Option<(&Recommendable, Option<&Recommendable>)> {
    let least = |among: &mut dyn Iterator<Item = &Recommendable>| -> Option<usize> {
        let best = among.reduce(|best, next| if next.bic < best.bic { next } else { best })?;
        models.iter().position(|model| std::ptr::eq(model, best))
    };
    let best = &models[least(&mut models.iter())?];
    let Some(own) = best.validation_percent.filter(|_| best.order == 1) else { return Some((best, None)) };
    let is_better = |model: &&Recommendable| {
        model.order > 1 && model.validation_percent.is_some_and(|other| other >= own + BETTER_BY_POINTS)
    };
    match least(&mut models.iter().filter(is_better)) {
        Some(place) => Some((&models[place], Some(best))),
        None => Some((best, None)),
    }
}

/// What unseen samples say of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnUnseen {
    /// It follows them about as well as those that it was identified from.
    Holds,
    /// Worse than their mean does: a fit below 0.
    BelowZero,
    /// More than 30 points worse than those that it was identified from.
    FarBelow,
}

impl OnUnseen {
    /// By the fit of the samples that a model was identified from and by that of the unseen ones, percent.
    pub fn of(fit_percent: Option<f64>, unseen_fit_percent: f64) -> Self {
        match fit_percent {
            _ if unseen_fit_percent < 0.0 => Self::BelowZero,
            Some(fit) if unseen_fit_percent < fit - LARGEST_LOSS_PERCENT => Self::FarBelow,
            _ => Self::Holds,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn one_state_stays_unless_unseen_samples_ask_for_more() {
        let model = |id: &str, order, bic, percent| Recommendable {
            id: id.to_owned(),
            order,
            bic,
            validation_percent: Some(percent),
        };
        let all = [model("a", 1, -9.0, 50.0), model("b", 3, -7.0, 52.0), model("c", 4, -8.0, 51.9)];
        let (best, passed_over) = recommended(&all).unwrap();
        assert_eq!((best.id.as_str(), passed_over.map(|model| model.id.as_str())), ("b", Some("a")));
        assert_eq!(recommended(&all[..1]).unwrap().1, None);
        assert_eq!(recommended(&all[1..]).unwrap().0.id, "c");
        assert_eq!(recommended(&[]), None);
    }
}
