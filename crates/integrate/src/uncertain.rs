//! Uncertainties as a person states them: a value with its unit and a distribution.

use std::fmt;
use std::str::FromStr;

use crumple_integrate::{Distribution, Spread, Uncertainty, UsedStart};
use crumple_signal::STANDARD_GRAVITY_M_PER_S2;
use crumple_signal::unit::UnitError;
use crumple_signal::value::{Level, Share, Speed, Time};
use crumple_stage::Usage;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::options::Options;

/// An uncertainty: a value with its unit, and the distribution it is the size of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain<V> {
    size: V,
    distribution: Distribution,
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

impl<V> Uncertain<V> {
    fn spread(self, si: impl Fn(V) -> f64) -> Spread {
        Spread { size: si(self.size), distribution: self.distribution }
    }
}

/// Repetitions where none are stated: the ends of an interval are then uncertain by a ninth of a standard deviation.
const REPLICATES: u32 = 400;
/// Fewer have no 5 % quantile.
const FEWEST_REPLICATES: u32 = 20;
/// More do not make an interval better that rests on stated uncertainties.
const MOST_REPLICATES: u32 = 100_000;

/// `None` where nothing is uncertain or no repetitions are wanted.
pub fn uncertainty(options: &Options) -> Result<Option<Uncertainty>, Usage> {
    let replicates = options.uncertainty_replicates.unwrap_or(REPLICATES);
    if replicates != 0 && !(FEWEST_REPLICATES..=MOST_REPLICATES).contains(&replicates) {
        return Err(Usage::new(format!(
            "{replicates} replicates, expected 0 or a number from {FEWEST_REPLICATES} to {MOST_REPLICATES}"
        )));
    }
    let stated = Uncertainty {
        impact_speed_m_per_s: options.speed_uncertainty.map(|u| u.spread(Speed::si)),
        zero_level_m_per_s2: options.zero_level_uncertainty.map(|u| u.spread(Level::si)),
        gain: options.gain_uncertainty.map(|u| u.spread(Share::si)),
        time_zero_s: options.time_zero_uncertainty.map(|u| u.spread(Time::si)),
        replicates: replicates as usize,
        seed: options.uncertainty_seed.unwrap_or(1),
    };
    let inputs = [stated.impact_speed_m_per_s, stated.zero_level_m_per_s2, stated.gain, stated.time_zero_s];
    Ok((replicates > 0 && inputs.into_iter().any(|input| input.is_some())).then_some(stated))
}

/// What the intervals rest on, in words.
pub fn uncertainty_note(uncertainty: &Uncertainty, start: UsedStart) -> String {
    let Uncertainty { impact_speed_m_per_s, zero_level_m_per_s2, gain, time_zero_s, replicates, seed } = uncertainty;
    let inputs = [
        ("impact speed", impact_speed_m_per_s, 3.6, "km/h"),
        ("zero level", zero_level_m_per_s2, 1.0 / STANDARD_GRAVITY_M_PER_S2, "g"),
        ("gain", gain, 1e2, "%"),
        ("time zero", time_zero_s, 1e3, "ms"),
    ];
    let stated = inputs.into_iter().filter_map(|(name, spread, factor, unit)| {
        let Spread { size, distribution } = (*spread)?;
        // Rounded to what was typed: 0.1 km/h is not 0.09999999999999999.
        let size = (1e9 * size * factor).round() / 1e9;
        Some(match distribution {
            Distribution::Normal => format!("{name} {size} {unit} (standard deviation, normal)"),
            Distribution::Uniform => format!("{name} +-{size} {unit} (uniform)"),
        })
    });
    let moved = match (time_zero_s, start) {
        (None, _) => "",
        (Some(_), UsedStart::RecordStart) => {
            "; an error of time zero moves the crush by v0 times it and every time by it, not the velocity, which is \
             integrated from the start of the record"
        }
        (Some(_), UsedStart::TimeZero) => {
            "; an error of time zero cuts the record there: it moves the crush by v0 times it, and the velocity by what \
             the pulse does in it"
        }
    };
    let stated: Vec<String> = stated.collect();
    format!("intervals are 5-95 % of {replicates} replicates (seed {seed}) with {}{moved}", stated.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_and_its_distribution_are_read_and_written() {
        let read = |text: &str| text.parse::<Uncertain<Share>>().map(|u| (u.size.si(), u.distribution));
        assert_eq!(read("1 %"), Ok((0.01, Distribution::Normal)));
        assert_eq!(read("1% uniform"), Ok((0.01, Distribution::Uniform)));
        let typed: Uncertain<Share> = "0.7 % uniform".parse().unwrap();
        assert_eq!(typed.to_string().parse(), Ok(typed));
        assert_eq!(typed.to_string(), format!("{} share uniform", 0.7 * 1e-2));
        assert!(read("1").unwrap_err().contains("has no unit: write a share, e.g. 1 %"));
        assert!(read("-1 %").unwrap_err().contains("is negative"));
        assert!("0.1 km/h triangular".parse::<Uncertain<Speed>>().is_err());
    }

    #[test]
    fn nothing_uncertain_or_no_repetitions_is_none() {
        assert_eq!(uncertainty(&Options::default()).unwrap(), None);
        let speed = "0.1 m/s".parse().ok();
        let stated =
            |uncertainty_replicates| Options { speed_uncertainty: speed, uncertainty_replicates, ..Options::default() };
        assert_eq!(uncertainty(&stated(None)).unwrap().map(|u| (u.replicates, u.seed)), Some((400, 1)));
        assert_eq!(uncertainty(&stated(Some(0))).unwrap(), None);
        assert!(uncertainty(&stated(Some(3))).is_err());
    }
}
