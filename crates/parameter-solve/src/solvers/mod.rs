//! The functions of the table of solvers.

use crumple_lumped::Model;
use crumple_signal::Notes;

use crate::Candidate;
use crate::solver::Task;

pub(crate) mod closed_forms;
pub(crate) mod double;
pub(crate) mod sensors;
pub(crate) mod single_mass;

/// A candidate that nothing was fitted for.
fn unfitted(task: &Task<'_>, model: Model, notes: Vec<String>) -> Candidate {
    Candidate { model, method: task.method, index: 1, equivalent_to: None, fit: None, uncertainty: None, notes }
}

/// Time and depth of dynamic crush; a note where the record has none.
fn crush_of(task: &Task<'_>, notes: &mut Notes) -> Option<(f64, f64)> {
    let events = task.evidence.time_of_dynamic_crush_s.zip(task.evidence.dynamic_crush_m);
    if events.is_none() {
        notes.warning(format!(
            "{}: not solved, since the velocity of the record never reaches zero: it has no dynamic crush",
            task.model
        ));
    }
    events
}
