//! Record: the notes of a stage.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Remarks a stage leaves for the reader. Topic `/notes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NotesV1 {
    /// The stage that made them.
    pub stage: String,
    /// One sentence each; `warning: ` in front where it may change a conclusion.
    pub notes: Vec<String>,
}
