//! Record: why a run has no acceptable result.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Why a stage has no acceptable result, or not the one that later stages need. Topic `/diagnosis`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosisV1 {
    /// The stage.
    pub stage: String,
    /// The reason, in words.
    pub reason: String,
    /// The stage has a result nevertheless, but not what later stages work on.
    #[serde(default)]
    pub has_result: bool,
}
