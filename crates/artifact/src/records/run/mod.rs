//! Records any stage may write: its notes, and the diagnosis of a run without a result.
//! Uses no other room.

mod diagnosis;
mod notes;

pub use diagnosis::DiagnosisV1;
pub use notes::NotesV1;
