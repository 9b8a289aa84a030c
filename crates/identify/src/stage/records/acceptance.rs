//! Which fits may pass as results.

use crumple_signal::Notes;
use crumple_sysid::{IdentifyError, IoData, fit_measures, mirrored_poles, simulate_fitted, weak_fit};

use crate::stage::records::discrete_model::Found;

/// Fits below this, percent, do not pass without a word.
const LEAST_FIT_PERCENT: f64 = -100.0;

/// What stands in the notes of a model that was made steady.
const MIRRORED: &str = "growing poles, mirrored at the unit circle";

/// A model of an estimated impulse response with its growing poles mirrored at the unit circle, which a note tells; without
/// the models beside it then, which belong to the poles as they were.
pub fn steady(found: Found, data: &IoData) -> Result<Found, IdentifyError> {
    let Some((model, mirrored)) = mirrored_poles(&found.model, data)? else { return Ok(found) };
    let Found { parameters, singular_values, mut notes, chosen, .. } = found;
    notes.push(format!(
        "warning: {mirrored} {MIRRORED}, inputs and initial state fitted again: the impulse response does not hold these modes"
    ));
    Ok(Found { singular_values, notes, chosen, ..Found::new(model, parameters) })
}

/// Simulates a model on the record it was identified from.
///
/// Errors: a simulation that misses the record by more than twice what its mean does (fit below -100 %) and accounts for none
/// of its variance. Where it accounts for some, the level of the record is what is missed, and a note says so; another where the
/// errors have more than half of the variance.
pub fn simulated(mut found: Found, data: &IoData) -> Result<(Vec<Vec<f64>>, Found), IdentifyError> {
    let simulated = simulate_fitted(&found.model, data)?.0;
    for (measured, model) in data.outputs().iter().zip(&simulated) {
        let fit = match fit_measures(measured, model) {
            Some(fit) => fit,
            None => return Err(misses(f64::NEG_INFINITY, &found)),
        };
        match fit.fit_percent.filter(|fit| *fit < LEAST_FIT_PERCENT) {
            Some(percent) if fit.vaf_percent.is_none_or(|vaf| vaf <= 0.0) => return Err(misses(percent, &found)),
            _ => found.notes.extend(fit.fit_percent.and_then(said).map(|text| format!("warning: {text}"))),
        }
    }
    Ok((simulated, found))
}

fn misses(fit_percent: f64, found: &Found) -> IdentifyError {
    let largest = found.model.poles().unwrap_or_default().iter().map(|z| z.norm()).fold(0.0, f64::max);
    let why = if largest > 1.0 {
        format!("a pole grows by a factor {largest:.6} a sample")
    } else if found.notes.iter().any(|note| note.contains(MIRRORED)) {
        format!("it has {MIRRORED}, and is nothing without them")
    } else {
        "none of its poles grows".to_owned()
    };
    IdentifyError::Misses { fit_percent, limit: LEAST_FIT_PERCENT, why }
}

/// What is said of a fit that passes: that the level of the record is missed, or most of its variance.
fn said(percent: f64) -> Option<String> {
    if percent < LEAST_FIT_PERCENT {
        return Some(format!(
            "fit {percent:.1} %: the model misses the level of the record; a linear model has no constant, see --remove-mean"
        ));
    }
    weak_fit(percent)
}

/// The same note for a model that was fitted to the simulation itself, so that it is no worse than silence.
pub fn note_on_fit(id: &str, fit_percent: Option<f64>, notes: &mut Notes) {
    if let Some(text) = fit_percent.and_then(said) {
        notes.warning(format!("{id}: {text}"));
    }
}
