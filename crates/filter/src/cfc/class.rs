//! The channel frequency classes of SAE J211-1 and ISO 6487.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// A channel frequency class of SAE J211-1 and ISO 6487. The number is F_H in Hz: flat up to there.
///
/// Both passes of the class filter have -3 dB at F_H/0.6 and fall by 24 dB an octave beyond. The class depends on the
/// use of a channel (SAE J211-1 Table 1): structure for plots, barrier and belt forces CFC 60; structure to be
/// integrated and the chest CFC 180; components CFC 600; the head CFC 1000. A lower class cannot be undone.
///
/// Classes are ordered by frequency, so `a <= b` says that a channel of class `a` needs no filter to be of class `b`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cfc {
    /// Vehicle structure, for plots and comparison; -3 dB at 100 Hz.
    Cfc60,
    /// Vehicle structure for integration, chest; -3 dB at 300 Hz.
    Cfc180,
    /// Components; -3 dB at 1000 Hz.
    Cfc600,
    /// Head; -3 dB at 1667 Hz.
    Cfc1000,
}

impl Cfc {
    /// All classes, lowest first.
    pub const ALL: [Self; 4] = [Self::Cfc60, Self::Cfc180, Self::Cfc600, Self::Cfc1000];

    /// 60, 180, 600 or 1000.
    pub const fn number(self) -> u16 {
        match self {
            Self::Cfc60 => 60,
            Self::Cfc180 => 180,
            Self::Cfc600 => 600,
            Self::Cfc1000 => 1000,
        }
    }

    /// F_H, Hz: the class as a frequency.
    pub fn frequency_hz(self) -> f64 {
        f64::from(self.number())
    }

    /// The lowest sampling rate for which the filter is meant, Hz: ten times the class (SAE J211-1), which is six times
    /// the -3 dB frequency. CFC 60 needs 600 Hz, CFC 1000 needs 10 kHz.
    pub fn lowest_rate_hz(self) -> f64 {
        10.0 * self.frequency_hz()
    }
}

impl fmt::Display for Cfc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.number().fmt(f)
    }
}

/// The class a channel is brought to, or `none`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Class {
    /// Filter to this class.
    Cfc(Cfc),
    /// Do not filter.
    None,
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cfc(cfc) => cfc.fmt(f),
            Self::None => f.write_str("none"),
        }
    }
}

impl FromStr for Class {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        Cfc::ALL
            .into_iter()
            .map(Self::Cfc)
            .chain([Self::None])
            .find(|class| class.to_string() == text)
            .ok_or_else(|| format!("unknown channel frequency class {text:?}, expected 60, 180, 600, 1000 or none"))
    }
}

/// A number for a class, the text `none` otherwise: as a pipeline table says it.
impl Serialize for Class {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Cfc(cfc) => serializer.serialize_u16(cfc.number()),
            Self::None => serializer.serialize_str("none"),
        }
    }
}

impl<'de> Deserialize<'de> for Class {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ClassVisitor;

        impl de::Visitor<'_> for ClassVisitor {
            type Value = Class;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("60, 180, 600, 1000 or \"none\"")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Class, E> {
                text.parse().map_err(E::custom)
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Class, E> {
                self.visit_str(&number.to_string())
            }

            fn visit_u64<E: de::Error>(self, number: u64) -> Result<Class, E> {
                self.visit_str(&number.to_string())
            }
        }

        deserializer.deserialize_any(ClassVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_is_read_back_from_text_and_from_a_table() {
        for class in Cfc::ALL.map(Class::Cfc).into_iter().chain([Class::None]) {
            assert_eq!(class.to_string().parse(), Ok(class));
            assert_eq!(serde_json::from_str::<Class>(&serde_json::to_string(&class).unwrap()).unwrap(), class);
        }
    }

    #[test]
    fn a_class_that_does_not_exist_is_answered_with_those_that_do() {
        let error = serde_json::from_str::<Class>("61").unwrap_err().to_string();
        assert!(
            error.contains("unknown channel frequency class \"61\", expected 60, 180, 600, 1000 or none"),
            "{error}"
        );
    }
}
