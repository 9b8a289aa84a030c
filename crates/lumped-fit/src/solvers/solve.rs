//! All candidates of a test: every solver that the settings ask for.

use crumple_signal::{About, Notes, Weight};
use rayon::prelude::*;

use crate::solvers::table::solvers_of;
use crate::solvers::task::Task;
use crate::{Candidate, SolveError, SolveSettings, TestData};

/// Solves for every model by every method that the settings ask for and the test allows; the notes say what is
/// missing and why.
///
/// Solvers run in parallel and know nothing of each other; candidates and notes come in the order of the settings,
/// whatever the number of threads. A record too coarse for a fit (that of an event data recorder) still gives the
/// closed forms. A set with a parameter beyond the range of numbers is left out with a warning.
///
/// Errors: a mass, speed, mass split or window without meaning, which no model can be solved with.
pub fn solve(test: &TestData<'_>, settings: &SolveSettings, notes: &mut Notes) -> Result<Vec<Candidate>, SolveError> {
    crate::error::positive("mass_kg", test.mass_kg)?;
    crate::error::positive("impact_speed_m_per_s", test.impact_speed_m_per_s)?;
    // Solvers know nothing of each other; candidates and notes keep the order of the settings for any number of
    // threads.
    let results: Vec<(Result<Vec<Candidate>, SolveError>, Notes)> = settings
        .models
        .par_iter()
        .flat_map_iter(|&model| {
            let solvers = solvers_of(model, &settings.methods);
            let mut none = Notes::new();
            if solvers.is_empty() {
                none.warning(format!("{model}: none of the methods asked for solves this model"));
            }
            let solved = solvers.into_iter().filter_map(move |solver| {
                let mut notes = Notes::new();
                let task = Task { model, method: solver.method, test, settings };
                let mut result = solver.solve?(&task, &mut notes);
                // A record that is too coarse for a fit (an event data recorder's) still has its events for the closed
                // forms.
                if let Err(error @ SolveError::TooFewSamples { .. }) = &result {
                    notes.warning(format!("{model}: not fitted by {}: {error}", solver.method.name()));
                    result = Ok(Vec::new());
                }
                Some((result, notes))
            });
            let about = About::Model(model.to_string());
            let all = std::iter::once((Ok(Vec::new()), none)).chain(solved);
            all.map(move |(result, notes)| (result, notes.all_about(&about)))
        })
        .collect();
    let mut candidates = Vec::new();
    for (result, remarks) in results {
        notes.extend(remarks);
        candidates.extend(result?);
    }
    // Extreme events lead beyond the range of numbers; such a set is no result.
    candidates.retain(|candidate| {
        let finite = candidate.model.parameters().values().all(|value| value.is_finite());
        if !finite {
            let text = format!("{}: left out, a parameter is beyond the range of numbers", candidate.id());
            notes.concern(About::Model(candidate.id()), Weight::Slight, text);
        }
        finite
    });
    Ok(candidates)
}
