//! How far two numbers may be apart, and the unit of a number by the name of its field.

use serde_json::Value;

use crate::differences::Reason;

/// `a` and `b` are the same if `|a - b| <= abs + rel * scale`.
///
/// The scale is `max(|a|, |b|)`; for a sample the largest magnitude of its waveform, for a number in a list or matrix
/// of numbers the largest in it, for a part of a complex number the larger part: a small value that came out of large
/// ones carries their rounding error, not its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Absolute part, in the unit of the number.
    pub abs: f64,
    /// Relative part.
    pub rel: f64,
}

/// The share within which an engineer calls two values the same that are no times, lengths or velocities.
pub const SAME_SHARE: f64 = 5e-3;

impl Tolerance {
    /// Equal numbers only.
    pub const ZERO: Self = Self { abs: 0.0, rel: 0.0 };

    /// What an engineer calls the same: 0.1 ms, 1 mm, 0.01 m/s, else 0.5 %.
    pub(crate) fn engineering(place: &str, unit: Option<Unit>) -> Self {
        match unit {
            // A sampling interval is not a time of an event.
            Some(Unit::Second) if place.ends_with("sample_time_s") => tolerance(0.0, 1e-9),
            Some(Unit::Second) => tolerance(1e-4, 0.0),
            Some(Unit::Metre) => tolerance(1e-3, 0.0),
            Some(Unit::MetrePerSecond) => tolerance(1e-2, 0.0),
            None => tolerance(1e-9, SAME_SHARE),
        }
    }

    /// Whether two numbers are the same within it.
    pub fn allows(self, a: f64, b: f64, scale: f64) -> bool {
        (a - b).abs() <= self.abs + self.rel * scale
    }
}

/// How far apart two values may be, or why they are not compared.
pub(crate) type Allowed = Result<Tolerance, Reason>;

pub(crate) const fn tolerance(abs: f64, rel: f64) -> Tolerance {
    Tolerance { abs, rel }
}

// The unit of a number in a record, read off the field's name: names carry units.

/// Units for which engineers have a tolerance of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unit {
    Second,
    Metre,
    MetrePerSecond,
}

impl Unit {
    /// From a field name such as `dynamic_crush_m`; the fields `value`, `low` and `high` take the unit beside them.
    pub(crate) fn of_field(key: &str, beside: Option<&Value>) -> Option<Self> {
        if matches!(key, "value" | "low" | "high") {
            return Self::from_symbol(beside?.as_str()?);
        }
        if key.ends_with("_m_per_s") {
            Some(Self::MetrePerSecond)
        } else if key.ends_with("_per_m") || key.ends_with("_per_s") {
            None
        } else if key.ends_with("_m") {
            Some(Self::Metre)
        } else if key.ends_with("_s") {
            Some(Self::Second)
        } else {
            None
        }
    }

    /// From an SI symbol such as `m/s`.
    pub(crate) fn from_symbol(symbol: &str) -> Option<Self> {
        match symbol {
            "s" => Some(Self::Second),
            "m" => Some(Self::Metre),
            "m/s" => Some(Self::MetrePerSecond),
            _ => None,
        }
    }
}
