//! Records any stage may write: its notes, what speaks against its result, and the diagnosis of a run without one.

mod concerns;
mod diagnosis;
mod notes;

pub use concerns::{ConcernV1, ConcernsV1, ConcernsV2};
pub use diagnosis::DiagnosisV1;
pub use notes::NotesV1;
