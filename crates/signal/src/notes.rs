//! Remarks of a computation: what each concerns, how much it changes there, and the list of them.

use std::fmt;
use std::str::FromStr;

// What a note concerns, and how much it changes there.

/// What a note concerns: one of the things that a report shows.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum About {
    /// The channel that the crash is read from: whether it is the right one, its sign, its unit, its samples.
    Pulse,
    /// The mass of the vehicle.
    Mass,
    /// The impact speed.
    ImpactSpeed,
    /// Time zero and the time axis.
    Time,
    /// Velocity, crush and the numbers made from them.
    Motion,
    /// A lumped model or one of its candidates, by name or id.
    Model(String),
    /// What is predicted.
    Predictions,
    /// Criteria of occupants.
    Occupants,
    /// Force on the barrier.
    WallForce,
    /// Identified models of inputs and outputs.
    IdentifiedModels,
    /// An identification method that gave no model, or not all that were asked of it, by name.
    Method(String),
    /// Another channel than the pulse, by id.
    Channel(String),
    /// The file as it was read.
    Record,
}

/// Words of the kinds that need no name.
const PLAIN: [(About, &str); 10] = [
    (About::Pulse, "pulse"),
    (About::Mass, "mass"),
    (About::ImpactSpeed, "impact-speed"),
    (About::Time, "time"),
    (About::Motion, "motion"),
    (About::Predictions, "predictions"),
    (About::Occupants, "occupants"),
    (About::WallForce, "wall-force"),
    (About::IdentifiedModels, "identified-models"),
    (About::Record, "record"),
];

const MODEL: &str = "model:";

const METHOD: &str = "method:";

const CHANNEL: &str = "channel:";

impl About {
    /// What notes of a stage concern that do not say it.
    pub fn of_stage(stage: &str) -> Self {
        match stage {
            "filter" => Self::Pulse,
            "integrate" => Self::Motion,
            "identify" => Self::IdentifiedModels,
            "parameter-solve" | "simulate" => Self::Model(String::new()),
            "predict" => Self::Predictions,
            _ => Self::Record,
        }
    }
}

/// The text form of records: `pulse`, `model:kelvin/direct-fit/1`, `channel:96`.
impl fmt::Display for About {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(name) => write!(f, "{MODEL}{name}"),
            Self::Method(name) => write!(f, "{METHOD}{name}"),
            Self::Channel(id) => write!(f, "{CHANNEL}{id}"),
            plain => f.write_str(PLAIN.iter().find(|(about, _)| about == plain).map_or("record", |(_, word)| word)),
        }
    }
}

/// Text that names nothing a report shows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not what a note can concern")]
pub struct UnknownAbout(String);

impl FromStr for About {
    type Err = UnknownAbout;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if let Some(name) = text.strip_prefix(MODEL) {
            return Ok(Self::Model(name.to_owned()));
        }
        if let Some(name) = text.strip_prefix(METHOD) {
            return Ok(Self::Method(name.to_owned()));
        }
        if let Some(id) = text.strip_prefix(CHANNEL) {
            return Ok(Self::Channel(id.to_owned()));
        }
        let plain = PLAIN.iter().find(|(_, word)| *word == text).map(|(about, _)| about.clone());
        plain.ok_or_else(|| UnknownAbout(text.to_owned()))
    }
}

/// What becomes of what is shown, if the note is true.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// Nothing: it is good to know.
    None = 0,
    /// It stays within what its interval says, or a part of little interest changes.
    Slight = 1,
    /// Numbers may be off by more than their intervals say.
    Marked = 2,
    /// It may be another thing than it is taken for: wrong channel, sign, unit, mass.
    Decisive = 3,
}

impl Weight {
    /// 0 to 3, as records have it.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// The weight of a number; what is beyond 3 is decisive.
    pub const fn of_number(number: u8) -> Self {
        match number {
            0 => Self::None,
            1 => Self::Slight,
            2 => Self::Marked,
            _ => Self::Decisive,
        }
    }
}

/// What a note concerns and how much it changes there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConcernContext {
    /// What it concerns.
    pub about: About,
    /// How much it changes there.
    pub weight: Weight,
}

// Remarks that a stage leaves for the reader of its result.

/// How much a note matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Good to know.
    Info,
    /// May change a conclusion.
    Warning,
}

impl Severity {
    /// What stands in front of the sentence where it is printed alone.
    pub const fn mark(self) -> &'static str {
        match self {
            Self::Info => "",
            Self::Warning => "warning: ",
        }
    }
}

/// A remark in plain words. It is printed with the [mark](Severity::mark) of its severity.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// How much it matters.
    pub severity: Severity,
    /// One sentence, units included.
    pub text: String,
    /// What it concerns and how much it changes there; `None`: what the stage concerns, with the least weight.
    pub bearing: Option<ConcernContext>,
    /// Its code and its explanation; `None`: a sentence of another program.
    pub kind: Option<&'static Kind>,
    /// What the sentence is made from, names with units.
    pub values: Vec<(&'static str, Value)>,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.severity.mark(), self.text)
    }
}

impl Note {
    /// Something good to know.
    pub fn info(text: impl Into<String>) -> Self {
        Self { severity: Severity::Info, text: text.into(), bearing: None, kind: None, values: Vec::new() }
    }

    /// Something that may change a conclusion.
    pub fn warning(text: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::info(text) }
    }

    /// The same, with what it concerns and how much it changes there.
    #[must_use]
    pub fn bears_on(mut self, about: About, weight: Weight) -> Self {
        self.severity = if weight == Weight::None { Severity::Info } else { Severity::Warning };
        self.bearing = Some(ConcernContext { about, weight });
        self
    }

    /// The same sentence with others in front of it and behind it.
    #[must_use]
    pub fn within(mut self, front: &str, behind: &str) -> Self {
        self.text = format!("{front}{}{behind}", self.text);
        self
    }
}

/// The notes of one computation, in the order they were made.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Notes(Vec<Note>);

impl Notes {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds something good to know.
    pub fn info(&mut self, text: impl Into<String>) {
        self.0.push(Note::info(text));
    }

    /// Adds something that may change a conclusion.
    pub fn warning(&mut self, text: impl Into<String>) {
        self.0.push(Note::warning(text));
    }

    /// Puts a remark before all others: what the rest rests on is in doubt.
    pub fn push_first(&mut self, remark: impl Into<Note>) {
        self.0.insert(0, remark.into());
    }

    /// Adds a remark.
    pub fn push(&mut self, remark: impl Into<Note>) {
        self.0.push(remark.into());
    }

    /// The notes in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Note> {
        self.0.iter()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Appends the notes of a part of the computation.
    pub fn extend(&mut self, other: Self) {
        self.0.extend(other.0);
    }

    /// The text forms, in order.
    pub fn to_texts(&self) -> Vec<String> {
        self.0.iter().map(Note::to_string).collect()
    }
}

// Kinds of remarks: a struct with the values of its sentence, a stable code, and what explains it.

/// What all remarks of a kind share.
#[derive(Debug, PartialEq, Eq)]
pub struct Kind {
    /// Stable name: `CR`, the number of the stage in the chain (0: the formats that ingest reads), two digits.
    pub code: &'static str,
    /// How much it changes where it is raised.
    pub weight: Weight,
    /// What was found, how it is decided (threshold and source), what it means for the result, what to do.
    pub explanation: [&'static str; 4],
}

impl Kind {
    /// What was found, in general.
    pub fn found(&self) -> &'static str {
        self.explanation[0].trim()
    }
}

/// What a sentence is made from.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A finite number; the name of the value has its unit.
    Number(f64),
    /// A name, a list of names, a text of the file.
    Text(String),
}

/// Values that a remark can hold.
pub trait Stated {
    /// As records have it; nothing of a value that is not known or not finite.
    fn stated(&self) -> Option<Value>;
}

impl Stated for f64 {
    fn stated(&self) -> Option<Value> {
        self.is_finite().then_some(Value::Number(*self))
    }
}

/// Whole numbers of records: up to 2^53 they are exact in `f64`, which no count of this project reaches.
macro_rules! whole_numbers {
    ($($type:ty),*) => {$(
        impl Stated for $type {
            fn stated(&self) -> Option<Value> {
                Some(Value::Number(*self as f64))
            }
        }
    )*};
}
whole_numbers!(u8, u16, u32, u64, usize, i32, i64);

impl Stated for String {
    fn stated(&self) -> Option<Value> {
        Some(Value::Text(self.clone()))
    }
}

impl Stated for &str {
    fn stated(&self) -> Option<Value> {
        Some(Value::Text((*self).to_owned()))
    }
}

impl<T: Stated> Stated for Option<T> {
    fn stated(&self) -> Option<Value> {
        self.as_ref().and_then(Stated::stated)
    }
}

/// Names, as a sentence lists them.
impl Stated for Vec<String> {
    fn stated(&self) -> Option<Value> {
        (!self.is_empty()).then(|| Value::Text(self.join(", ")))
    }
}

/// Makes a struct of every kind of remark of a module, its sentence, and the list of the kinds.
///
/// ```
/// use crumple_signal::{About, Note, Weight, remarks};
///
/// remarks! {
///     /// Remarks of this module.
///     pub REMARKS;
///
///     /// The sampling rate is low for the class of the filter.
///     CR299 LowRate { rate_hz: f64, cfc: u16 }
///     bears on (About::Pulse, Weight::Slight)
///     decided "SAE J211-1 asks for ten times the class."
///     means "The filter is not that of the class."
///     remedy "record faster, or ask for a lower class"
///     says format!("{rate_hz:.0} Hz are few for CFC {cfc}");
/// }
///
/// let note = Note::from(LowRate { rate_hz: 1000.0, cfc: 180 });
/// assert_eq!(note.to_string(), "warning: 1000 Hz are few for CFC 180");
/// assert_eq!((REMARKS[0].code, note.values.len()), ("CR299", 2));
/// ```
#[macro_export]
macro_rules! remarks {
    (
        $(#[doc = $list:literal])+
        $visible:vis $all:ident;
        $(
            $(#[doc = $found:literal])+
            $code:ident $name:ident { $($field:ident : $type:ty),* $(,)? }
            bears on ($about:expr, $weight:expr)
            decided $decided:literal
            means $means:literal
            remedy $remedy:literal
            says $text:expr;
        )+
    ) => {
        $(#[doc = $list])+
        $visible const $all: &[&$crate::Kind] = &[$(&<$name>::KIND),+];
        $(
            $(#[doc = $found])+
            #[derive(Debug, Clone)]
            #[allow(missing_docs, reason = "fields are named after what they are")]
            $visible struct $name { $(pub $field: $type),* }

            impl $name {
                /// Its code and its explanation.
                $visible const KIND: $crate::Kind = $crate::Kind {
                    code: stringify!($code),
                    weight: $weight,
                    explanation: [concat!($($found),+), $decided, $means, $remedy],
                };
            }

            impl From<$name> for $crate::Note {
                fn from(remark: $name) -> Self {
                    let $name { $($field),* } = &remark;
                    let values = [$((stringify!($field), $crate::Stated::stated($field))),*];
                    let values: Vec<(&str, Option<$crate::Value>)> = Vec::from(values);
                    let values = values.into_iter().filter_map(|(name, value)| Some((name, value?))).collect();
                    let text: String = $text.into();
                    Self { kind: Some(&$name::KIND), values, ..$crate::Note::info(text) }.bears_on($about, $weight)
                }
            }
        )+
    };
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn text_forms_are_read_back() {
        let named = [
            About::Model("kelvin/direct-fit/1".to_owned()),
            About::Method("okid".to_owned()),
            About::Channel("96".to_owned()),
        ];
        for about in PLAIN.iter().map(|(about, _)| about.clone()).chain(named) {
            assert_eq!(about.to_string().parse(), Ok(about));
        }
        assert!("elsewhere".parse::<About>().is_err());
        for weight in [Weight::None, Weight::Slight, Weight::Marked, Weight::Decisive] {
            assert_eq!(Weight::of_number(weight.number()), weight);
        }
    }
}
