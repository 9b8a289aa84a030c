//! Values that a person types on a command line or in a pipeline file: a number and its unit.
//!
//! Each is SI inside, reads with [`FromStr`](std::str::FromStr) or serde from text such as `35 km/h`, refuses a
//! bare number, and writes itself in SI with its unit.

use crate::QuantityKind;
use crate::units::unit::{Dimension, UnitError, parse_value};

macro_rules! value {
    ($(#[$doc:meta] $name:ident($dimension:expr, $unit:literal)),* $(,)?) => {$(
        #[$doc]
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// From a number in the SI unit.
            pub const fn from_si(value: f64) -> Self {
                Self(value)
            }

            /// The number in the SI unit.
            pub const fn si(self) -> f64 {
                self.0
            }
        }

        impl std::str::FromStr for $name {
            type Err = UnitError;

            fn from_str(text: &str) -> Result<Self, UnitError> {
                parse_value(text, $dimension).map(Self)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "{} {}", self.0, $unit)
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(TextVisitor).and_then(|text| {
                    text.parse().map_err(serde::de::Error::custom)
                })
            }
        }
    )*};
}

value! {
    /// A mass, kg.
    Mass(Dimension::Mass, "kg"),
    /// A speed, m/s.
    Speed(Dimension::Signal(QuantityKind::Velocity), "m/s"),
    /// An acceleration, m/s².
    Acceleration(Dimension::Signal(QuantityKind::Acceleration), "m/s^2"),
    /// A time or duration, s.
    Time(Dimension::Time, "s"),
    /// A length, m.
    Length(Dimension::Signal(QuantityKind::Displacement), "m"),
    /// A frequency, Hz.
    Frequency(Dimension::Frequency, "Hz"),
    /// A level of acceleration, m/s².
    Level(Dimension::Signal(QuantityKind::Acceleration), "m/s^2"),
    /// A share of something, typed in percent.
    Share(Dimension::Share, "share"),
    /// A stiffness, N/m.
    Stiffness(Dimension::Stiffness, "N/m"),
    /// A damping, N·s/m.
    Damping(Dimension::Damping, "N*s/m"),
    /// A force, N.
    Force(Dimension::Signal(QuantityKind::Force), "N"),
    /// A pressure, Pa.
    Pressure(Dimension::Signal(QuantityKind::Pressure), "Pa"),
    /// An area, m².
    Area(Dimension::Area, "m2"),
}

/// Takes text, and bare numbers as text so that the answer to them is about the unit.
struct TextVisitor;

impl serde::de::Visitor<'_> for TextVisitor {
    type Value = String;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a number with its unit in quotes, such as \"35 km/h\"")
    }

    fn visit_str<E>(self, text: &str) -> Result<String, E> {
        Ok(text.to_owned())
    }

    fn visit_i64<E>(self, value: i64) -> Result<String, E> {
        Ok(value.to_string())
    }

    fn visit_u64<E>(self, value: u64) -> Result<String, E> {
        Ok(value.to_string())
    }

    fn visit_f64<E>(self, value: f64) -> Result<String, E> {
        Ok(value.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_what_it_reads_to_the_last_bit() {
        let speed: Speed = "57.09 km/h".parse().unwrap();
        let json = serde_json::to_string(&speed).unwrap();
        assert_eq!(serde_json::from_str::<Speed>(&json).unwrap(), speed);
    }

    #[test]
    fn a_bare_number_in_a_table_is_asked_back() {
        let error = serde_json::from_str::<Mass>("873").unwrap_err().to_string();
        assert!(error.contains("\"873\" has no unit"), "{error}");
    }
}
