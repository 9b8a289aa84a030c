//! Kinds of remarks: a struct with the values of its sentence, a stable code, and what explains it.
//!
//! [`remarks!`](crate::remarks!) makes a struct of every kind, its sentence, and the list of the kinds of a module. A
//! new kind is a new entry there: codes, `crumple explain`, the page docs/remarks.md and records follow from it.

use crate::notes::Weight;

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
