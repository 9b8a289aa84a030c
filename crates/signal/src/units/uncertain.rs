//! Uncertainties as a person states them: a value with its unit, and a distribution.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::units::unit::UnitError;

/// How the error of an input is distributed about zero.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// Normal; the size is the standard deviation.
    #[default]
    Normal,
    /// Equally likely everywhere within limits; the size is the half width.
    Uniform,
}

impl Distribution {
    /// The name used in options and notes.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Uniform => "uniform",
        }
    }

    /// Largest error that is drawn, in units of its size. One normal deviate in 5e8 is larger, and cut to it.
    pub const fn largest(self) -> f64 {
        match self {
            Self::Normal => 6.0,
            Self::Uniform => 1.0,
        }
    }

    /// The standard deviation of an error of this size: of a uniform one the half width over the root of 3.
    pub fn deviation(self, size: f64) -> f64 {
        match self {
            Self::Normal => size,
            Self::Uniform => size / 3.0_f64.sqrt(),
        }
    }
}

/// How far an input may be off: the error has mean 0 and is independent of the errors of other inputs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Standard deviation or half width, in the unit of the input; 0: certain.
    pub size: f64,
    /// Which of the two.
    pub distribution: Distribution,
}

/// Half width of a 90 % interval in standard deviations of a normal distribution.
pub const HALF_OF_90_PERCENT: f64 = 1.644_853_626_951_472_7;

impl Spread {
    /// Uncertainty of an impact speed, m/s, where nobody states it: 0.1 km/h to either side, as a laboratory's light
    /// barriers measure it.
    pub const USUAL_SPEED: Self = Self { size: 0.1 / 3.6, distribution: Distribution::Uniform };

    /// Its standard deviation.
    pub fn deviation(self) -> f64 {
        self.distribution.deviation(self.size)
    }
}

/// `0.05 g uniform` is a half width, `0.1 km/h normal` and `0.1 km/h` are standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain<V> {
    /// Standard deviation or half width, with its unit.
    pub size: V,
    /// Which of the two.
    pub distribution: Distribution,
}

impl<V: FromStr<Err = UnitError>> FromStr for Uncertain<V> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = [Distribution::Normal, Distribution::Uniform]
            .into_iter()
            .find_map(|distribution| Some((text.trim().strip_suffix(distribution.name())?, distribution)));
        let (size, distribution) = named.unwrap_or((text, Distribution::default()));
        let size = size.trim();
        if size.starts_with('-') {
            return Err(format!("{text:?} is negative, expected a standard deviation or a half width"));
        }
        Ok(Self { size: size.parse().map_err(|error: UnitError| error.to_string())?, distribution })
    }
}

impl<V: fmt::Display> fmt::Display for Uncertain<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.size, self.distribution.name())
    }
}

impl<V: fmt::Display> Serialize for Uncertain<V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de, V: FromStr<Err = UnitError>> Deserialize<'de> for Uncertain<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::value::{Mass, Share, Speed};

    #[test]
    fn a_value_is_a_standard_deviation_unless_it_is_called_uniform() {
        let read = |text: &str| text.parse::<Uncertain<Mass>>().map(|u| (u.size.si(), u.distribution));
        assert_eq!(read("10 kg"), Ok((10.0, Distribution::Normal)));
        assert_eq!(read("10kg normal"), Ok((10.0, Distribution::Normal)));
        assert_eq!(read("10kg uniform"), Ok((10.0, Distribution::Uniform)));
        assert!(read("-1 kg").unwrap_err().contains("is negative"));
        assert!("0.1 km/h triangular".parse::<Uncertain<Speed>>().is_err() && read("10").is_err());
    }

    #[test]
    fn a_value_and_its_distribution_are_written_as_they_are_read() {
        let typed: Uncertain<Share> = "0.7 % uniform".parse().unwrap();
        assert_eq!(typed.to_string().parse(), Ok(typed));
        assert_eq!(typed.to_string(), format!("{} share uniform", 0.7 * 1e-2));
        assert!("1".parse::<Uncertain<Share>>().unwrap_err().contains("has no unit: write a share, e.g. 1 %"));
    }
}
