//! All candidates for one test.

use crumple_signal::Notes;

use crate::solver::{Task, solvers_of};
use crate::{Candidate, Evidence, SolveError, SolveSettings};

/// Finds every candidate that the settings ask for and the test allows; the notes say what is missing and why.
///
/// Errors: only what makes every model senseless or an option impossible: a mass, speed, mass split or window without meaning.
pub fn solve(
    evidence: &Evidence<'_>,
    settings: &SolveSettings,
    notes: &mut Notes,
) -> Result<Vec<Candidate>, SolveError> {
    crate::error::positive("mass_kg", evidence.mass_kg)?;
    crate::error::positive("impact_speed_m_per_s", evidence.impact_speed_m_per_s)?;
    let mut candidates = Vec::new();
    for &model in &settings.models {
        let solvers = solvers_of(model, &settings.methods);
        if solvers.is_empty() {
            notes.warning(format!("{model}: none of the methods asked for solves this model"));
        }
        for solver in solvers {
            let Some(solve) = solver.solve else { continue };
            let task = Task { model, method: solver.method, evidence, settings };
            candidates.extend(solve(&task, notes)?);
        }
    }
    // Extreme events lead beyond the range of numbers; such a set is no result.
    candidates.retain(|candidate| {
        let finite = candidate.model.parameters().values().all(|value| value.is_finite());
        if !finite {
            notes.warning(format!("{}: left out, a parameter is beyond the range of numbers", candidate.id()));
        }
        finite
    });
    Ok(candidates)
}
