//! Which fits are accepted as results, and which of them get a warning.

use crumple_signal::Notes;
use crumple_sysid::{IdentifyError, IoData, MissReason, fit_measures, mirrored_poles, simulate_fitted, weak_fit};

use crate::stage::records::discrete_model::DiscreteModel;

/// A fit below this (percent) gets a warning, or is refused where the model accounts for none of the variance either.
const LEAST_FIT_PERCENT: f64 = -100.0;

/// A modulus within this of 1 is on the unit circle, as far as the eigenvalues of a double pole are known: their
/// rounding is the root of that of the numbers.
const ROUNDING: f64 = 1e-8;

/// A model of an estimated impulse response with its growing poles mirrored at the unit circle, and a note of it;
/// without the models beside it then, which belong to the poles as they were.
pub fn mirror_growing_poles(model: DiscreteModel, data: &IoData) -> Result<DiscreteModel, IdentifyError> {
    let Some((state_space, mirrored_poles)) = mirrored_poles(&model.state_space, data)? else { return Ok(model) };
    let DiscreteModel { parameters, singular_values, mut notes, choices, .. } = model;
    notes.warning(format!(
        "{mirrored_poles} unstable poles were mirrored into the unit circle, and the input matrix and the initial \
         state were fitted again: these modes are not in the impulse response"
    ));
    Ok(DiscreteModel { singular_values, notes, mirrored_poles, choices, ..DiscreteModel::new(state_space, parameters) })
}

/// Simulates a model on the record it was identified from.
///
/// Errors: a simulation that misses the record by more than twice what its mean does (fit below -100 %) and accounts
/// for none of its variance. Where it accounts for some, the level of the record is what is missed, and a note says so;
/// another where the errors have more than half of the variance.
pub fn simulate_accepted(
    mut model: DiscreteModel,
    data: &IoData,
) -> Result<(Vec<Vec<f64>>, DiscreteModel), IdentifyError> {
    let simulated = simulate_fitted(&model.state_space, data)?.0;
    for (measured, response) in data.outputs().iter().zip(&simulated) {
        let fit = match fit_measures(measured, response) {
            Some(fit) => fit,
            None => return Err(miss(f64::NEG_INFINITY, &model)),
        };
        match fit.fit_percent.filter(|fit| *fit < LEAST_FIT_PERCENT) {
            Some(percent) if fit.vaf_percent.is_none_or(|vaf| vaf <= 0.0) => return Err(miss(percent, &model)),
            _ => {
                if let Some(text) = fit.fit_percent.and_then(fit_warning) {
                    model.notes.warning(text);
                }
            }
        }
    }
    Ok((simulated, model))
}

/// The error of a model that misses the record, with what is known of its poles.
fn miss(fit_percent: f64, model: &DiscreteModel) -> IdentifyError {
    let largest = match model.state_space.poles() {
        Ok(poles) => poles.iter().map(|z| z.norm()).fold(0.0, f64::max),
        Err(error) => return error.into(),
    };
    let why = match largest {
        factor if factor > 1.0 + ROUNDING => MissReason::Grows { factor },
        _ if model.mirrored_poles > 0 => MissReason::Mirrored,
        modulus if modulus >= 1.0 - ROUNDING => MissReason::Marginal,
        _ => MissReason::Stable,
    };
    IdentifyError::Misses { fit_percent, limit: LEAST_FIT_PERCENT, why }
}

/// The warning about a fit that passes: that the level of the record is missed, or most of its variance.
fn fit_warning(percent: f64) -> Option<String> {
    if percent < LEAST_FIT_PERCENT {
        return Some(format!(
            "fit {percent:.1} %: the model misses the level of the record; a linear model has no constant, see \
             --remove-mean"
        ));
    }
    weak_fit(percent)
}

/// The same warning for a model that was fitted to the simulation itself, so that it is no worse than silence.
pub fn note_on_fit(id: &str, fit_percent: Option<f64>, notes: &mut Notes) {
    if let Some(text) = fit_percent.and_then(fit_warning) {
        notes.warning(format!("{id}: {text}"));
    }
}
