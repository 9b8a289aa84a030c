//! The double spring-mass-damper fitted to the displacement of the compartment alone.

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_signal::Notes;

use crate::candidate::note::infos;
use crate::solvers::sensors;
use crate::solvers::task::Task;
use crate::{Candidate, DoubleFitOptions, SolveError, fit_double, masses};

/// Error of a displacement integrated twice by the trapezoidal rule at 10 kHz, m: that of known records is at most
/// 1.3e-6 m. Minima whose errors differ by less are not told apart.
const DISPLACEMENT_RESOLUTION_M: f64 = 1.3e-6;

/// Every pair of dual models that the record cannot tell from the best, two candidates each; with several sensors,
/// another quantity or free masses the fit to sensors instead.
///
/// The two candidates of a pair are numbered `2 k + 1` and `2 k + 2` and name each other as equivalent. A model that
/// is its own dual is one candidate without standard deviations: front and rear can move against each other there
/// without a change of the record in first order.
pub(crate) fn direct_fit(task: &Task<'_>, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    if !task.fits_displacement_alone() {
        return sensors::fit(task, notes);
    }
    let (kind, test, settings) = (task.model, task.test, task.settings);
    let (m1_kg, m2_kg, split) = masses(test.mass_kg, settings.split)?;
    notes.info(format!("{kind}: {split}"));
    let Some(displacement) = test.displacement else {
        notes.warning(format!("{kind}: not fitted, there is no displacement"));
        return Ok(Vec::new());
    };
    let to_s = settings.fit_to_s.or(test.time_of_dynamic_crush_s);
    if to_s.is_none() {
        notes.warning(format!("{kind}: fitted up to the end of the record, since there is no dynamic crush"));
    }
    let options = DoubleFitOptions {
        m1_kg,
        m2_kg,
        impact_speed_m_per_s: test.impact_speed_m_per_s,
        time_zero_s: test.time_zero_s,
        from_s: settings.fit_from_s,
        to_s,
        samples: settings.fit_samples,
        starts: settings.fit_starts,
        resolution_m: DISPLACEMENT_RESOLUTION_M,
    };
    let pairs = match fit_double(displacement, &options) {
        Ok(pairs) => pairs,
        Err(error @ SolveError::NoFit { .. }) => {
            notes.warning(format!("{kind}: {error}"));
            return Ok(Vec::new());
        }
        Err(error) => return Err(error),
    };
    let window = &pairs[0].fit;
    let window = format!("fitted from {:.2} ms to {:.2} ms after time zero", 1e3 * window.from_s, 1e3 * window.to_s);
    notes.info(format!(
        "{kind}: {window}; one compartment accelerometer cannot tell its two dual solutions apart, a second one on the \
         front can"
    ));
    if pairs.len() > 1 {
        notes.warning(format!(
            "{kind}: {} pairs of parameter sets fit equally well within the accuracy of the displacement; the record \
             does not determine the parameters",
            pairs.len()
        ));
    }
    let mut candidates = Vec::new();
    for (place, pair) in pairs.iter().enumerate() {
        let is_own_dual = coincides_with_its_dual(&pair.models);
        for dual in 0..if is_own_dual { 1 } else { 2 } {
            let mut remarks = vec![split.clone(), window.clone()];
            if is_own_dual {
                remarks.push(
                    "its own dual, listed once, counts twice: front and rear can move against each other without a \
                     change of the record in first order, so there are no standard deviations"
                        .to_owned(),
                );
            }
            if let Some(u) = pair.uncertainty[dual].as_ref().filter(|_| !is_own_dual) {
                let widened = u.residual_autocorrelation.map_or_else(String::new, |correlation| {
                    format!(", widened for a residual autocorrelation of {correlation:.4}")
                });
                remarks.push(format!(
                    "standard deviations: linearised{widened}; they hold for the given masses and if the model is \
                     true, and say nothing of other solutions"
                ));
            }
            let mut fit = pair.fit.clone();
            if dual == 1 {
                fit.active_bounds = exchanged(&fit.active_bounds);
            }
            candidates.push(Candidate {
                model: Model::DoubleSpringMassDamper(pair.models[dual]),
                method: task.method,
                index: 2 * place + dual + 1,
                equivalent_to: (!is_own_dual).then_some(2 * place + 2 - dual),
                fit: Some(fit),
                uncertainty: pair.uncertainty[dual].clone().filter(|_| !is_own_dual),
                notes: infos(remarks),
            });
        }
    }
    Ok(candidates)
}

/// Whether the models of a pair agree to 1e-4. The error is flat to fourth order there, so a fit to 1e-16 leaves that
/// much.
fn coincides_with_its_dual([a, b]: &[DoubleSpringMassDamper; 2]) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= 1e-4 * x.abs().max(y.abs());
    near(a.k1_n_per_m, b.k1_n_per_m) && near(a.c1_n_s_per_m, b.c1_n_s_per_m)
}

/// Names of active bounds for the dual, which exchanges front and rear, in the order of the parameters.
fn exchanged(bounds: &[&'static str]) -> Vec<&'static str> {
    use crate::fit::double::pair::NAMES;
    let dual = [NAMES[1], NAMES[0], NAMES[3], NAMES[2]];
    let mut names: Vec<_> =
        NAMES.iter().zip(dual).filter(|(name, _)| bounds.contains(name)).map(|(_, other)| other).collect();
    names.sort_by_key(|name| NAMES.iter().position(|n| n == name));
    names
}
