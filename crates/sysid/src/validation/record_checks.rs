//! What is wrong with a record before any model of it is believed: constant channels, a trend, outliers.

use crate::output_error::output_error::OutputError;
use crate::validation::bootstrap::median;
use crate::validation::noise_model::{NoiseModel, NoiseOptions, best_output_error, noise_model};
use crate::{IdentifyError, IoData};

/// Share of the largest magnitude that a constant channel may vary by: rounding.
const CONSTANT: f64 = 1e-12;

/// Scaled median absolute deviations beyond which an error is that of an outlier.
const OUTLIER: f64 = 6.0;

/// Samples on either side of an error that it is compared with: two outliers in a row stand out of five.
const NEIGHBOURS: usize = 2;

/// The median absolute deviation of normal values times this is their standard deviation.
const SCALED: f64 = 1.4826;

/// More outliers than this share of the samples are none: the model is wrong.
const LARGEST_SHARE: f64 = 0.01;

/// A pole that moves by less than this over the record integrates.
const INTEGRATES: f64 = 0.5;

/// Samples up to which fewer poles are tried for a trend: a long record tells a line from slow poles.
const FEWER_UP_TO: usize = 2000;

/// Fits in which outliers are replaced.
const ROUNDS: usize = 3;

/// Whether a channel does not vary by more than rounding.
pub fn is_constant(signal: &[f64]) -> bool {
    let (low, high) = signal.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    signal.is_empty() || high - low <= CONSTANT * low.abs().max(high.abs())
}

/// Constant channels of a record, by number.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Constants {
    /// Inputs that methods run without, if others are left.
    pub inputs_left_out: Vec<usize>,
    /// Outputs that no method can identify.
    pub outputs: Vec<usize>,
    /// Whether there are inputs and all of them are constant.
    pub all_inputs: bool,
}

impl Constants {
    /// Of inputs and outputs.
    pub fn of(inputs: &[Vec<f64>], outputs: &[Vec<f64>]) -> Self {
        let constant = |signals: &[Vec<f64>]| -> Vec<usize> {
            signals.iter().enumerate().filter(|(_, signal)| is_constant(signal)).map(|(place, _)| place).collect()
        };
        let (left_out, outputs) = (constant(inputs), constant(outputs));
        let all_inputs = !inputs.is_empty() && left_out.len() == inputs.len();
        Self { inputs_left_out: left_out, outputs, all_inputs }
    }
}

/// Intercept and slope by sample of the straight line through a signal, by least squares.
pub fn straight_line(signal: &[f64]) -> (f64, f64) {
    let middle = (signal.len() as f64 - 1.0) / 2.0;
    let mean = signal.iter().sum::<f64>() / signal.len().max(1) as f64;
    let (mut product, mut square) = (0.0, 0.0);
    for (k, x) in signal.iter().enumerate() {
        let t = k as f64 - middle;
        product += t * (x - mean);
        square += t * t;
    }
    let slope = if square > 0.0 { product / square } else { 0.0 };
    (mean - slope * middle, slope)
}

/// Whether an output follows a straight line beside its model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trend {
    /// Whether it does.
    pub is_there: bool,
    /// Slope of the straight line through the output, a sample.
    pub slope: f64,
    /// By how much the criterion falls without the straight lines.
    pub bic_gain: f64,
}

/// Compares the noise models of one output with means removed from all channels, and with straight lines removed: the
/// lines must gain more than `ln N` in Schwarz's criterion.
///
/// A test on the errors of one fit does not find a trend: free poles have taken the line in. The order that a record
/// with a trend asks for has one or two such poles, so that fewer are tried too. Errors: no fit.
pub fn trend(data: &IoData, order: usize) -> Result<Trend, IdentifyError> {
    let without = |lines: bool| {
        let signal = |x: &Vec<f64>| -> Vec<f64> {
            let (intercept, slope) = straight_line(x);
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            let level = |k: usize| if lines { intercept + slope * k as f64 } else { mean };
            x.iter().enumerate().map(|(k, x)| x - level(k)).collect()
        };
        let all = |signals: &[Vec<f64>]| signals.iter().map(signal).collect();
        IoData::new(all(data.inputs()), all(data.outputs()), data.sample_time_s())
    };
    let (level, straight) = (without(false)?, without(true)?);
    let [mut beside_level, mut beside_line] = both_noise_models(&level, &straight, order)?;
    let least = if data.samples() > FEWER_UP_TO { order } else { order.saturating_sub(2).max(1) };
    for fewer in least..order {
        let Ok([of_level, of_line]) = both_noise_models(&level, &straight, fewer) else { continue };
        beside_level = beside_level.or_smaller(of_level);
        beside_line = beside_line.or_smaller(of_line);
    }
    let bic_gain = beside_level.bic - beside_line.bic;
    let slope = straight_line(&data.outputs()[0]).1;
    // A system that integrates drifts by itself.
    let duration_s = data.samples() as f64 * data.sample_time_s();
    let integrates = beside_line.poles.iter().any(|s| s.norm() * duration_s < INTEGRATES);
    Ok(Trend { is_there: !integrates && bic_gain > (data.samples() as f64).ln(), slope, bic_gain })
}

/// Noise models of two forms of a record, each from the poles of the other too: a better start is no gain.
fn both_noise_models(level: &IoData, straight: &IoData, order: usize) -> Result<[NoiseModel; 2], IdentifyError> {
    let options = NoiseOptions::new(order);
    let first = noise_model(straight, options)?;
    let of_level = noise_model(level, NoiseOptions { near: &[first.model.poles()?], ..options })?;
    let near = [of_level.model.poles()?];
    let again = noise_model(straight, NoiseOptions { near: &near, near_alone: true, ..options });
    Ok([of_level, again.map_or(first.clone(), |again| first.or_smaller(again))])
}

/// Samples of every output that stand out of the errors of an output-error fit, and the fit with them replaced by what
/// the model says; none where they are more than 1 % of the samples. Errors: no fit.
pub fn outliers(data: &IoData, order: usize, from_rest: bool) -> Result<(Vec<Vec<usize>>, OutputError), IdentifyError> {
    let options = NoiseOptions { from_rest, ..NoiseOptions::new(order) };
    let first = best_output_error(data, options)?;
    let mut fit = first.clone();
    let mut found: Vec<Vec<usize>> = vec![Vec::new(); data.outputs().len()];
    for _ in 0..ROUNDS {
        let mut is_new = false;
        for ((found, y), yh) in found.iter_mut().zip(data.outputs()).zip(&fit.simulated) {
            let errors: Vec<f64> = y.iter().zip(yh).map(|(y, yh)| y - yh).collect();
            let now = standing_out(&errors);
            is_new |= now != *found;
            *found = now;
        }
        if found.iter().map(Vec::len).max().unwrap_or(0) as f64 > LARGEST_SHARE * data.samples() as f64 {
            return Ok((vec![Vec::new(); found.len()], first));
        }
        if !is_new {
            break;
        }
        let mut outputs = data.outputs().to_vec();
        for ((y, yh), found) in outputs.iter_mut().zip(&fit.simulated).zip(&found) {
            found.iter().for_each(|k| y[*k] = yh[*k]);
        }
        let replaced = IoData::new(data.inputs().to_vec(), outputs, data.sample_time_s())?;
        let near = [fit.model.poles()?];
        fit = best_output_error(&replaced, NoiseOptions { near: &near, near_alone: true, ..options })?;
    }
    Ok((found, fit))
}

/// Places of errors that lie further from the median than six scaled median absolute deviations, from that of all and
/// from that of the [`NEIGHBOURS`]: a mode that the model misses is large over many samples, and no outlier.
fn standing_out(errors: &[f64]) -> Vec<usize> {
    let beside = |k: usize| {
        let near = &errors[k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(errors.len())];
        (errors[k] - median(near.to_vec())).abs()
    };
    let middle = median(errors.to_vec());
    let from_all: Vec<f64> = errors.iter().map(|e| (e - middle).abs()).collect();
    let from_near: Vec<f64> = (0..errors.len()).map(beside).collect();
    let reach = |distances: &[f64]| OUTLIER * SCALED * median(distances.to_vec());
    let (far, beside) = (reach(&from_all), reach(&from_near));
    (0..errors.len()).filter(|k| from_all[*k] > far && from_near[*k] > beside).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn constants_are_told_from_channels_that_vary_a_little() {
        let constant = vec![2.5; 20];
        let level: Vec<f64> = (0..20).map(|k| 1000.0 + 1e-6 * f64::from(k)).collect();
        let rounding: Vec<f64> = (0..20).map(|k| 3.0 + 1e-14 * f64::from(k)).collect();
        assert!(is_constant(&constant) && !is_constant(&level) && is_constant(&rounding) && is_constant(&[0.0; 3]));
        let found = Constants::of(&[constant.clone(), level.clone()], std::slice::from_ref(&rounding));
        assert_eq!(found, Constants { inputs_left_out: vec![0], outputs: vec![0], all_inputs: false });
        assert!(Constants::of(std::slice::from_ref(&constant), std::slice::from_ref(&level)).all_inputs);
        assert_eq!(Constants::of(&[], &[level]), Constants::default());
    }

    #[test]
    fn a_line_is_found_through_its_samples() {
        let signal: Vec<f64> = (0..50).map(|k| 3.0 - 0.25 * f64::from(k)).collect();
        let (intercept, slope) = straight_line(&signal);
        assert!((intercept - 3.0).abs() < 1e-12 && (slope + 0.25).abs() < 1e-14);
    }
}
