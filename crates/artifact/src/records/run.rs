//! Records any stage may write: its notes, what speaks against its result, and the diagnosis of a run without one.

use std::collections::BTreeMap;

use crumple_signal::{About, Note, Severity, Value, Weight};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

// Record: what speaks against a result, with its weight and what it concerns.

/// What speaks against the result of a stage. Topic `/concerns`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ConcernsV2 {
    /// The concerns, in the order in which the stage met them.
    pub concerns: Vec<ConcernV1>,
}

/// What speaks against the result of a stage as it was written before: a JSON array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct ConcernsV1(pub Vec<ConcernV1>);

impl From<ConcernsV1> for ConcernsV2 {
    fn from(earlier: ConcernsV1) -> Self {
        Self { concerns: earlier.0 }
    }
}

/// One warning of `/notes`, or the diagnosis of a stage without a result, as a program can rank it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RemarkV1 {
    /// Stable name of what is said, e.g. `CR203`; `crumple explain CR203` says what it means. Empty: a sentence of a
    /// program that gives none.
    #[serde(default)]
    pub code: String,
    /// The stage whose result it is about.
    pub stage: String,
    /// What it concerns, as in [`ConcernV1`].
    pub about: String,
    /// How much it changes there, 1 to 3, as in [`ConcernV1`] of a stage; 0: it is good to know.
    pub weight: u8,
    /// What the sentence is made from; names carry units.
    #[serde(default)]
    pub values: BTreeMap<String, ValueV1>,
    /// One sentence.
    pub text: String,
    /// One thing to do about it.
    pub remedy: Option<String>,
    /// The command of the program from elsewhere that wrote what it is about.
    #[serde(default)]
    pub written_by: Option<String>,
}

/// What a sentence is made from: in JSON a number or a text.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemas", schemars(untagged))]
pub enum ValueV1 {
    /// A number in the unit that its name has.
    Number(f64),
    /// A name, a list of names, a text of the file.
    Text(String),
}

/// JSON tells numbers from texts, a form of bytes alone does not.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum InJson {
    Number(f64),
    Text(String),
}

#[derive(Serialize, Deserialize)]
enum InBytes {
    Number(f64),
    Text(String),
}

impl Serialize for ValueV1 {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match (self.clone(), serializer.is_human_readable()) {
            (Self::Number(number), true) => InJson::Number(number).serialize(serializer),
            (Self::Text(text), true) => InJson::Text(text).serialize(serializer),
            (Self::Number(number), false) => InBytes::Number(number).serialize(serializer),
            (Self::Text(text), false) => InBytes::Text(text).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ValueV1 {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            return Ok(match InJson::deserialize(deserializer)? {
                InJson::Number(number) => Self::Number(number),
                InJson::Text(text) => Self::Text(text),
            });
        }
        Ok(match InBytes::deserialize(deserializer)? {
            InBytes::Number(number) => Self::Number(number),
            InBytes::Text(text) => Self::Text(text),
        })
    }
}

impl From<&Value> for ValueV1 {
    fn from(value: &Value) -> Self {
        match value {
            Value::Number(number) => Self::Number(*number),
            Value::Text(text) => Self::Text(text.clone()),
        }
    }
}

impl RemarkV1 {
    /// A remark of a stage; one that does not say what it concerns is about what the stage makes.
    pub fn new(stage: &str, note: &Note) -> Self {
        let (about, weight) = match (&note.bearing, note.severity) {
            (Some(bearing), _) => (bearing.about.clone(), bearing.weight),
            (None, Severity::Warning) => (About::of_stage(stage), Weight::Slight),
            (None, Severity::Info) => (About::of_stage(stage), Weight::None),
        };
        Self {
            code: note.kind.map_or("", |kind| kind.code).to_owned(),
            stage: stage.to_owned(),
            about: about.to_string(),
            weight: weight.number(),
            values: note.values.iter().map(|(name, value)| ((*name).to_owned(), value.into())).collect(),
            text: note.text.clone(),
            remedy: note.kind.map(|kind| kind.explanation[3].to_owned()),
            written_by: None,
        }
    }

    /// Whether it may change a conclusion.
    pub fn is_warning(&self) -> bool {
        self.weight > 0
    }

    /// What stands in front of its sentence where it is printed alone.
    pub fn mark(&self) -> &'static str {
        if self.is_warning() { Severity::Warning.mark() } else { Severity::Info.mark() }
    }

    /// Whether it says what another remark says: of one code with equal values, or without a code in one sentence.
    pub fn says_the_same(&self, other: &Self) -> bool {
        let is_equal_without_code = !self.code.is_empty() || self.text == other.text;
        self.code == other.code && self.values == other.values && is_equal_without_code
    }

    /// Its sentence with its code behind it.
    pub fn with_code(&self) -> String {
        if self.code.is_empty() { self.text.clone() } else { format!("{} [{}]", self.text, self.code) }
    }
}

// Record: what a stage remarks.

/// What a stage remarks of its result. Topic `/remarks`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RemarksV1 {
    /// The remarks, strongest first; equals in the order in which the stage met them.
    pub remarks: Vec<RemarkV1>,
}

// Record: why a run has no acceptable result.

/// Why a stage has no acceptable result, or not the one that later stages need. Topic `/diagnosis`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct NotesV1 {
    /// The stage that made them.
    pub stage: String,
    /// One sentence each; `warning: ` in front where it may change a conclusion.
    pub notes: Vec<String>,
}
