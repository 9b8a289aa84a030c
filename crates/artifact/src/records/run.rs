//! Records any stage may write: its notes, what speaks against its result, and the diagnosis of a run without one.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

// Record: what speaks against a result, with its weight and what it concerns.

/// What speaks against the result of a stage. Topic `/concerns`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConcernsV2 {
    /// The concerns, in the order in which the stage met them.
    pub concerns: Vec<ConcernV1>,
}

/// What speaks against the result of a stage as it was written before: a JSON array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct ConcernsV1(pub Vec<ConcernV1>);

impl From<ConcernsV1> for ConcernsV2 {
    fn from(earlier: ConcernsV1) -> Self {
        Self { concerns: earlier.0 }
    }
}

/// One warning of `/notes`, or the diagnosis of a stage without a result, as a program can rank it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConcernV1 {
    /// The stage that says it.
    pub stage: String,
    /// How severe it is.
    pub severity: SeverityV1,
    /// What it concerns: `pulse`, `mass`, `impact-speed`, `time`, `motion`, `model:<model or candidate>`,
    /// `predictions`, `occupants`, `wall-force`, `identified-models`, `method:<identification method that gave no
    /// model, or none of an order>`, `channel:<id>`, `record`.
    pub about: String,
    /// How much it changes there: 1 it stays within the intervals, 2 numbers may be off by more, 3 it may be another
    /// thing than it is taken for.
    pub weight: u8,
    /// One sentence.
    pub text: String,
    /// One thing to do about it.
    pub remedy: Option<String>,
}

/// How severe a concern is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SeverityV1 {
    /// It may change a conclusion.
    #[default]
    Warning,
    /// The stage has no acceptable result, or none that later stages work on.
    NoResult,
}

impl ConcernV1 {
    /// Whether it is the diagnosis of a stage without a result.
    pub fn is_no_result(&self) -> bool {
        self.severity == SeverityV1::NoResult
    }
}

// What a run says, as a program reads it.

/// One remark of a run: a code with values, and the sentence made from them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RemarkV1 {
    /// Stable name of what is said, e.g. `CR203`; `crumple explain CR203` says what it means.
    pub code: String,
    /// The stage whose result it is about.
    pub stage: String,
    /// What it concerns, as in [`ConcernV1`].
    pub about: String,
    /// How much it changes there, 1 to 3, as in [`ConcernV1`] of a stage.
    pub weight: u8,
    /// The numbers of the sentence; names carry units.
    pub values: BTreeMap<String, f64>,
    /// One sentence.
    pub text: String,
    /// One thing to do about it.
    pub remedy: Option<String>,
    /// The command of the program from elsewhere that wrote what it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub written_by: Option<String>,
}

// Record: why a run has no acceptable result.

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

// Record: the notes of a stage.

/// Remarks a stage leaves for the reader. Topic `/notes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NotesV1 {
    /// The stage that made them.
    pub stage: String,
    /// One sentence each; `warning: ` in front where it may change a conclusion.
    pub notes: Vec<String>,
}
