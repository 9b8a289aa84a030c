use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Why a stage has no acceptable result. Topic `/diagnosis`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosisV1 {
    /// The stage.
    pub stage: String,
    /// The reason, in words.
    pub reason: String,
}
