//! The order of a subspace model, where it is left to the record.

use crumple_sysid::{
    Contender, IdentifyError, IoData, Subspace, autoregressive_effective_samples, select, simulate_fitted,
};
use rayon::prelude::*;

/// Errors below this share of the root mean square of an output are rounding: models that are exact compare by their
/// parameters.
const ROUNDING: f64 = 1e-10;

/// The order from 1 to `highest` whose model has the smallest BIC of its simulation; `None` where no order has a model.
///
/// The models come from one factorisation, of `whole` or, if `thin`, of every n-th sample of it; all are simulated on
/// `whole`. Criteria count the effective samples of the model with the smallest loss; of several outputs the losses are
/// multiplied. BIC asks for more than AICc where records are long, and finds the true order of many samples.
pub fn automatic_order(subspace: &Subspace<'_>, thin: bool, whole: &IoData, highest: usize) -> Option<usize> {
    let orders: Vec<usize> = (1..=highest.min(subspace.highest_order())).collect();
    let contenders: Vec<(usize, Contender)> =
        orders.par_iter().filter_map(|order| Some((*order, contender(subspace, thin, whole, *order).ok()?))).collect();
    let all: Vec<Contender> = contenders.iter().map(|(_, contender)| contender.clone()).collect();
    match select(&all) {
        Some(selection) => contenders.iter().find(|(_, c)| c.id == selection.best_by_bic).map(|(order, _)| *order),
        None => contenders.first().map(|(order, _)| *order),
    }
}

fn contender(subspace: &Subspace<'_>, thin: bool, whole: &IoData, order: usize) -> Result<Contender, IdentifyError> {
    let candidate = if thin { subspace.realize_on(order, whole)? } else { subspace.realize(order)? };
    let (simulated, _) = simulate_fitted(&candidate.model, whole)?;
    let (m, q) = (whole.inputs().len(), whole.outputs().len());
    let mut log_loss = 0.0;
    let mut effective = 0.0;
    for (measured, model) in whole.outputs().iter().zip(&simulated) {
        let error: Vec<f64> = measured.iter().zip(model).map(|(y, yh)| y - yh).collect();
        let mean_square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64;
        let floor = (ROUNDING * ROUNDING * mean_square(measured)).max(f64::MIN_POSITIVE);
        let loss = mean_square(&error);
        if !loss.is_finite() {
            return Err(IdentifyError::NotConverged("simulation"));
        }
        log_loss += loss.max(floor).ln();
        effective += autoregressive_effective_samples(&error);
    }
    Ok(Contender {
        id: order.to_string(),
        parameters: order * (m + q + 1) + m * q,
        loss: (log_loss / q as f64).exp(),
        effective_samples: effective,
        validation_fit_percent: None,
    })
}
