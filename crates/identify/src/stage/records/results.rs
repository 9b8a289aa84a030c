//! Where the models of a run go.

use crumple_stage::Output;

use crate::stage::records::selection::Comparison;

/// The artifact, and the comparison that every model of the run is entered into.
pub struct Results<'a> {
    /// Compares models of one output once all are there.
    pub comparison: Comparison,
    /// Records, notes and the summary.
    pub out: &'a mut Output,
}
