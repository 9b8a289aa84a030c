//! Simulation of a model on a record, and how well it fits.
//!
//! Fit in percent is the one of MATLAB's `compare` and of the field: 100 is a perfect curve, 0 is no better than the
//! mean of the record, and below zero the model is worse than that constant. Variance accounted for forgives a wrong
//! level, fit does not.

use crumple_metrics::{fit_percent, rmse};
use crumple_numerics::lti::{StateSpace, simulate};

use crate::simulation::initial_state::initial_state;
use crate::{IdentifyError, IoData};

/// Measures of fit of one output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitMeasures {
    /// `100 (1 - |y - yh| / |y - mean y|)`; `None` for a constant output.
    pub fit_percent: Option<f64>,
    /// Variance accounted for, `100 (1 - var(y - yh) / var y)`; `None` for a constant output.
    pub vaf_percent: Option<f64>,
    /// Root mean square of `y - yh`, unit of the output.
    pub rmse: f64,
    /// Largest `|y - yh|`, unit of the output.
    pub max_abs: f64,
}

/// Measures of `model` against `measured`; `None` where the lengths differ, are zero, or the model has overflowed.
pub fn fit_measures(measured: &[f64], model: &[f64]) -> Option<FitMeasures> {
    if measured.len() != model.len() || measured.is_empty() {
        return None;
    }
    let n = measured.len() as f64;
    let mean = |signal: &mut dyn Iterator<Item = f64>| signal.sum::<f64>() / n;
    let error = || measured.iter().zip(model).map(|(y, yh)| y - yh);
    let centre = mean(&mut measured.iter().copied());
    let error_mean = mean(&mut error());
    let variance = mean(&mut measured.iter().map(|y| (y - centre).powi(2)));
    let error_square = mean(&mut error().map(|e| e * e));
    if !(error_square.is_finite() && variance.is_finite()) {
        return None;
    }
    let moving = variance > 0.0;
    Some(FitMeasures {
        fit_percent: fit_percent(measured, model),
        vaf_percent: moving.then(|| 100.0 * (1.0 - mean(&mut error().map(|e| (e - error_mean).powi(2))) / variance)),
        rmse: rmse(measured, model)?,
        max_abs: error().fold(0.0, |m, e| m.max(e.abs())),
    })
}

/// Simulates a discrete model on a record, with the initial state that fits it best in the sense of least squares over
/// all outputs, each divided by its root mean square. This is the simulation of MATLAB's `compare`: unlike a one-step
/// prediction it never sees the measured output.
///
/// Returns the outputs and the state. Errors: a continuous model, other numbers of channels, a model that grows beyond
/// the range of `f64`.
pub fn simulate_fitted(model: &StateSpace, data: &IoData) -> Result<(Vec<Vec<f64>>, Vec<f64>), IdentifyError> {
    let rest = vec![0.0; model.order()];
    let silent;
    let inputs = if model.b.ncols() == 0 {
        // Without an input nothing else tells the length.
        silent = vec![vec![0.0; data.samples()]];
        &silent[..]
    } else {
        data.inputs()
    };
    let forced = if model.b.ncols() == 0 {
        vec![vec![0.0; data.samples()]; model.c.nrows()]
    } else {
        simulate(model, inputs, &rest)?
    };
    let x0 = initial_state(model, data, &forced)?;
    let mut outputs = forced;
    let free = crate::simulation::initial_state::free_outputs(model, &x0, data.samples());
    for (output, free) in outputs.iter_mut().zip(free) {
        for (y, f) in output.iter_mut().zip(free) {
            *y += f;
        }
    }
    Ok((outputs, x0))
}

/// Measures of [`simulate_fitted`], one entry per output; `None` where they are undefined.
pub fn compare(model: &StateSpace, data: &IoData) -> Result<Vec<Option<FitMeasures>>, IdentifyError> {
    let (outputs, _) = simulate_fitted(model, data)?;
    Ok(data.outputs().iter().zip(&outputs).map(|(y, yh)| fit_measures(y, yh)).collect())
}

/// Fit of several records together: `100 (1 - |all errors| / |all deviations from each record's mean|)`, so that a
/// record counts by its size. For one record that of [`fit_percent`].
pub(crate) fn common_fit_percent(pairs: &[(&[f64], &[f64])]) -> Option<f64> {
    if let [(measured, model)] = pairs {
        return fit_percent(measured, model);
    }
    let (mut missed, mut spread) = (0.0, 0.0);
    for (measured, model) in pairs {
        let mean = measured.iter().sum::<f64>() / measured.len() as f64;
        spread += distance(measured, &vec![mean; measured.len()])?.powi(2);
        missed += distance(measured, model)?.powi(2);
    }
    let fit = 100.0 * (1.0 - (missed / spread).sqrt());
    (spread > 0.0 && fit.is_finite()).then_some(fit)
}

/// Root mean square error of several records together.
///
/// `sqrt(sum of all squared errors / number of all samples)`, in the unit that the records share.
pub(crate) fn common_rmse(pairs: &[(&[f64], &[f64])]) -> Option<f64> {
    if let [(measured, model)] = pairs {
        return rmse(measured, model);
    }
    let count: usize = pairs.iter().map(|(measured, _)| measured.len()).sum();
    let missed = pairs.iter().map(|(measured, model)| Some(distance(measured, model)?.powi(2))).sum::<Option<f64>>()?;
    Some((missed / count as f64).sqrt()).filter(|rmse| rmse.is_finite())
}

/// Euclidean distance; `None` if the lengths differ, are zero, or the result is not finite.
fn distance(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() != b.len() || a.is_empty() {
        return None;
    }
    Some(a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()).filter(|d| d.is_finite())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn measures_of_a_known_error() {
        let y = [1.0, -1.0, 1.0, -1.0];
        let fit = fit_measures(&y, &[0.5, -1.5, 0.5, -1.5]).unwrap();
        assert_eq!((fit.fit_percent, fit.vaf_percent), (Some(50.0), Some(100.0)));
        assert_eq!((fit.rmse, fit.max_abs), (0.5, 0.5));
        assert_eq!(fit_measures(&[2.0, 2.0], &[2.0, 2.0]).unwrap().fit_percent, None);
        assert_eq!(fit_measures(&y, &[f64::INFINITY; 4]), None);
    }

    #[test]
    fn records_count_by_their_size() {
        let (y, z) = ([1.0, 3.0], [10.0, 30.0]);
        // Deviations 2 + 200 squared, errors 2 of the small record only: 1 - sqrt(2/202).
        let fit = common_fit_percent(&[(&y, &[2.0, 2.0]), (&z, &z)]).unwrap();
        assert!((fit - 100.0 * (1.0 - (2.0_f64 / 202.0).sqrt())).abs() < 1e-12, "{fit}");
        assert_eq!(common_rmse(&[(&y, &[2.0, 2.0]), (&z, &z)]), Some((2.0_f64 / 4.0).sqrt()));
        assert_eq!(common_fit_percent(&[(&y, &y)]), fit_percent(&y, &y));
        assert_eq!(common_rmse(&[(&y, &[1.0]), (&z, &z)]), None);
    }
}
