//! The occupant of all predictions: as a person describes it, or fitted to a sensor of the test.

use crate::{FittedRestraint, MeasuredRide};
use crumple_lumped::{ForceDeflection, Occupant};
use crumple_signal::value::{Force, Frequency, Length, Mass, Stiffness};
use crumple_signal::{About, Note, Sampled, Weight, remarks};
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, Refused, Usage};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A text such as `barrier mass=1400kg pressure=342kPa`, or a table with the same keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Described {
    /// Words of the command line.
    Text(String),
    /// A table of the pipeline file.
    Table(toml::Table),
}

impl std::str::FromStr for Described {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self::Text(text.to_owned()))
    }
}

impl Described {
    /// The keys and values as the fields of `T`. Words without a sign of equality come first and are the value of
    /// `name`, blanks included: a folder may have some. Errors: keys that `T` does not have, values it refuses.
    pub fn read<T: DeserializeOwned>(&self, what: &str, name: &str) -> Result<T, Usage> {
        let table = match self {
            Self::Table(table) => table.clone(),
            Self::Text(text) => {
                let mut words = text.split(' ').peekable();
                let mut first = Vec::new();
                while let Some(word) = words.next_if(|word| !word.contains('=')) {
                    first.push(word);
                }
                let mut table = toml::Table::new();
                let named = first.join(" ").trim().to_owned();
                if !named.is_empty() {
                    table.insert(name.to_owned(), named.into());
                }
                for word in words.filter(|word| !word.is_empty()) {
                    let Some((key, value)) = word.split_once('=') else {
                        let problem = format!("{word:?} of the {what} is not key=value");
                        return Err(Usage::new(problem).hint("no blank between a number and its unit: mass=1400kg"));
                    };
                    table.insert(key.to_owned(), value.into());
                }
                table
            }
        };
        table.try_into().map_err(|error: toml::de::Error| {
            Usage::new(format!("the {what}: {}", error.to_string().trim().replace('\n', " ")))
        })
    }
}

/// Mass that a restraint holds of a seated adult, kg: well known, without a source at hand. Only force over mass
/// matters.
const SEATED_KG: f64 = 75.0;
/// Deflection over which a force limit lasts at the most, m: an occupant is stopped before.
const ONE_M: f64 = 1.0;

/// What a person may say of an occupant.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OccupantTable {
    pub mass: Option<Mass>,
    pub stiffness: Option<Stiffness>,
    /// Natural frequency in place of the stiffness, which then needs no mass.
    pub frequency: Option<Frequency>,
    pub slack: Option<Length>,
    pub force_limit: Option<Force>,
    /// Of the way back; as stiff as the way in if nothing is said.
    pub unloading_stiffness: Option<Stiffness>,
    /// Channel on the chest that the restraint is fitted to, in place of all numbers but the mass.
    pub sensor: Option<String>,
}

/// What is known of a restraint before a test is read.
#[derive(Debug, Clone, PartialEq)]
pub enum Restraint {
    /// All of it.
    Stated(Occupant),
    /// The channel that it is fitted to, and the occupant's mass, kg.
    OfSensor(String, f64),
}

/// Reads the restraint. Errors: numbers without meaning, numbers beside a sensor.
pub fn restraint(table: &OccupantTable) -> Result<Restraint, Usage> {
    let Some(sensor) = &table.sensor else { return occupant(table).map(Restraint::Stated) };
    let given = [table.stiffness.is_some(), table.frequency.is_some(), table.slack.is_some()];
    if given.into_iter().chain([table.force_limit.is_some(), table.unloading_stiffness.is_some()]).any(|given| given) {
        return Err(Usage::new("the occupant's restraint is fitted to its sensor or stated, not both")
            .hint("--occupant \"sensor=CHANNEL mass=75kg\", or \"stiffness=60kN/m slack=30mm force_limit=5kN\""));
    }
    Ok(Restraint::OfSensor(sensor.clone(), mass_of(table)?))
}

/// The occupant's mass, kg. Errors: one that is not positive.
fn mass_of(table: &OccupantTable) -> Result<f64, Usage> {
    let mass_kg = table.mass.map_or(SEATED_KG, Mass::si);
    if !(mass_kg > 0.0 && mass_kg.is_finite()) {
        return Err(Usage::new(format!("the occupant's mass is {mass_kg} kg, expected a positive mass")));
    }
    Ok(mass_kg)
}

/// Builds the occupant. Errors: no stiffness, numbers without meaning.
fn occupant(table: &OccupantTable) -> Result<Occupant, Usage> {
    let mass_kg = mass_of(table)?;
    let by_frequency = |frequency: Frequency| mass_kg * (2.0 * std::f64::consts::PI * frequency.si()).powi(2);
    let stiffness = match (table.stiffness, table.frequency) {
        (Some(stiffness), None) => stiffness.si(),
        (None, Some(frequency)) => by_frequency(frequency),
        _ => {
            return Err(Usage::new("an occupant needs the stiffness of its restraint, or its natural frequency").hint(
                "--occupant \"stiffness=60kN/m slack=30mm force_limit=5kN\", frequency=4.5Hz for a stiffness, or \
                 sensor=CHANNEL on its chest, which it is fitted to",
            ));
        }
    };
    let refused = |error| Usage::new(format!("the occupant's restraint: {error}"));
    let unloading = table.unloading_stiffness.map_or(stiffness, Stiffness::si);
    let mut restraint = ForceDeflection::new(&[(0.0, 0.0), (ONE_M, stiffness * ONE_M)], unloading)
        .and_then(|restraint| restraint.with_gap(table.slack.map_or(0.0, Length::si)))
        .map_err(refused)?;
    if let Some(limit) = table.force_limit {
        restraint = restraint.with_limit(limit.si()).map_err(refused)?;
    }
    Ok(Occupant { mass_kg, restraint })
}

/// It in words.
pub fn words(occupant: &Occupant) -> String {
    let restraint = &occupant.restraint;
    let stiffness = restraint.static_force_n(1e-6) * 1e6;
    let limit = restraint.limit_n().map_or_else(String::new, |limit| format!(", limit {:.1} kN", 1e-3 * limit));
    format!("{:.0} kg, {:.1} kN/m, slack {:.0} mm{limit}", occupant.mass_kg, 1e-3 * stiffness, 1e3 * restraint.gap_m())
}

/// Spacing of the motions that a restraint is fitted to, s: that of the pulses of predictions.
const SPACING_S: f64 = 5e-4;
/// The longest that an occupant is followed, s.
const LONGEST_S: f64 = 0.3;

/// An occupant that rides.
#[derive(Debug, Default)]
pub struct Rider {
    pub occupant: Option<Occupant>,
    /// One standard deviation of its restraint up and down, along each direction.
    pub ends: Vec<[Occupant; 2]>,
    /// It in words.
    pub words: Option<String>,
    /// The restraint that was fitted, and how well.
    pub remark: Option<Note>,
}

/// The occupant of a test. Errors: a sensor that is not there or that no restraint follows.
pub fn rider(restraint: Option<&Restraint>, input: &Inputs) -> anyhow::Result<Rider> {
    Ok(match restraint {
        None => Rider::default(),
        Some(Restraint::Stated(occupant)) => {
            Rider { occupant: Some(occupant.clone()), words: Some(words(occupant)), ..Rider::default() }
        }
        Some(Restraint::OfSensor(channel, mass_kg)) => {
            let fitted = fitted(input, channel, *mass_kg)?;
            let remark = Note::from(in_numbers(&fitted, channel));
            let words = remark.text.strip_prefix(OCCUPANT).map(str::to_owned);
            // Without a deviation of its numbers nothing is said of them.
            let remark = Some(remark).filter(|_| !fitted.ends.is_empty());
            Rider { occupant: Some(fitted.occupant), ends: fitted.ends, words, remark }
        }
    })
}

/// The restraint that follows a channel of the test.
fn fitted(input: &Inputs, channel: &str, mass_kg: f64) -> anyhow::Result<FittedRestraint> {
    let events: EventsV1 = input.record_if("/events")?.ok_or_else(|| {
        Refused::new("no test with events: a restraint is fitted to one test")
            .hint("state it: --occupant stiffness=...")
    })?;
    let velocity = |channel: &str| {
        let wave = input.wave_if(&format!("{channel}/velocity")).map(|wave| &wave.sampled);
        wave.ok_or_else(|| {
            Refused::new(format!("the velocity of channel {channel} is not there"))
                .hint("channels = [\"all\", \"CHANNEL\"] of [integrate] integrates a sensor on the chest")
        })
    };
    let (vehicle, chest) = (velocity(&events.channel)?, velocity(channel)?);
    let ride = ride(vehicle, chest);
    let restraint = ride.restraint(mass_kg).ok_or_else(|| {
        Refused::new(format!("no restraint follows {channel}: it does not move ahead of the compartment and back"))
    })?;
    Ok(restraint)
}

/// Both motions from contact on, as far as both go.
fn ride(vehicle: &Sampled, chest: &Sampled) -> MeasuredRide {
    let times = (0..=(LONGEST_S / SPACING_S) as usize).map(|k| k as f64 * SPACING_S);
    let both = times.map_while(|t| vehicle.at(t).zip(chest.at(t)));
    let (compartment_m_per_s, chest_m_per_s) = both.unzip();
    MeasuredRide { dt_s: SPACING_S, compartment_m_per_s, chest_m_per_s }
}

fn in_numbers(fitted: &FittedRestraint, channel: &str) -> OccupantFitted {
    OccupantFitted {
        mass_kg: fitted.occupant.mass_kg,
        channel: channel.to_owned(),
        stiffness_n_per_m: fitted.stiffness_n_per_m.value,
        stiffness_deviation_n_per_m: fitted.stiffness_n_per_m.deviation,
        slack_m: fitted.slack_m.value,
        slack_deviation_m: fitted.slack_m.deviation,
        limit_n: fitted.limit_n.map(|limit| limit.value),
        limit_deviation_n: fitted.limit_n.map(|limit| limit.deviation),
        misfit_m_per_s: fitted.misfit_m_per_s,
        peak_error_percent: 100.0 * (fitted.peak_ratio - 1.0),
        excursion_error_percent: 100.0 * (fitted.excursion_ratio - 1.0),
    }
}

/// What the sentence of a fitted restraint begins with.
const OCCUPANT: &str = "occupant: ";

remarks! {
    /// Remarks of the occupant.
    pub REMARKS;

    /// The restraint of the occupant was fitted to a sensor on the chest.
    CR707 OccupantFitted {
        mass_kg: f64, channel: String, stiffness_n_per_m: f64, stiffness_deviation_n_per_m: f64, slack_m: f64,
        slack_deviation_m: f64, limit_n: Option<f64>, limit_deviation_n: Option<f64>, misfit_m_per_s: f64,
        peak_error_percent: f64, excursion_error_percent: f64
    }
    bears on (About::Predictions, Weight::None)
    decided "Stiffness and slack are found by least squares of the velocity of the chest, up to its largest way ahead \
             of the compartment; a force limit too where the corrected Akaike criterion asks for one. Each has one \
             standard deviation."
    means "The intervals of the predicted occupant hold these deviations. What the restraint misses of the peak and of \
           the way it may miss at other speeds too."
    remedy "nothing; --occupant with stiffness and slack states a restraint instead"
    says {
        let number = |value: f64, deviation: f64, unit: f64, name: &str| {
            format!("{:.1} +- {:.1} {name}", value / unit, deviation / unit)
        };
        let limit = limit_n.zip(*limit_deviation_n).map_or_else(
            || "no force limit that the sensor shows".to_owned(),
            |(value, deviation)| format!("limit {}", number(value, deviation, 1e3, "kN")),
        );
        format!(
            "{OCCUPANT}{mass_kg:.0} kg, restraint fitted to {channel}: {}, slack {}, {limit}; its velocity is missed \
             by {misfit_m_per_s:.2} m/s root mean square, its peak by {peak_error_percent:+.1} %, its way ahead of \
             the compartment by {excursion_error_percent:+.1} %",
            number(*stiffness_n_per_m, *stiffness_deviation_n_per_m, 1e3, "kN/m"),
            number(*slack_m, *slack_deviation_m, 1e-3, "mm"),
        )
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::occupant::Described;
    use crumple_signal::value::Mass;

    #[derive(Debug, Default, PartialEq, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Thing {
        name: Option<String>,
        mass: Option<Mass>,
    }

    #[test]
    fn a_text_is_its_name_and_its_keys() {
        let read = |text: &str| Described::Text(text.to_owned()).read::<Thing>("thing", "name");
        let barrier = Thing { name: Some("barrier".to_owned()), mass: Some(Mass::from_si(1400.0)) };
        assert_eq!(read("barrier mass=1400kg").unwrap(), barrier);
        assert_eq!(read("my runs/a").unwrap().name.as_deref(), Some("my runs/a"));
        assert!(read("barrier weight=1400kg").unwrap_err().to_string().contains("weight"));
        assert!(read("barrier mass=1400 kg").is_err());
        assert!(read("barrier mass=1400").unwrap_err().to_string().contains("has no unit"));
        let table = "name = 'barrier'\nmass = '1400 kg'".parse().unwrap();
        assert_eq!(Described::Table(table).read::<Thing>("thing", "name").unwrap(), barrier);
    }

    fn read(text: &str) -> Result<Occupant, Usage> {
        occupant(&Described::Text(text.to_owned()).read("occupant", "name")?)
    }

    #[test]
    fn a_restraint_is_stated_or_fitted() {
        let read = |text: &str| {
            let table = Described::Text(text.to_owned()).read("occupant", "name").unwrap();
            restraint(&table)
        };
        assert_eq!(read("sensor=CHST mass=60kg").unwrap(), Restraint::OfSensor("CHST".to_owned(), 60.0));
        assert_eq!(read("sensor=CHST").unwrap(), Restraint::OfSensor("CHST".to_owned(), SEATED_KG));
        assert!(read("sensor=CHST slack=30mm").is_err() && read("sensor=CHST mass=0kg").is_err());
        assert!(matches!(read("stiffness=60kN/m").unwrap(), Restraint::Stated(_)));
    }

    #[test]
    fn a_frequency_is_a_stiffness_over_a_mass() {
        let by_stiffness = read("stiffness=60kN/m slack=30mm force_limit=5kN").unwrap();
        assert_eq!(words(&by_stiffness), "75 kg, 60.0 kN/m, slack 30 mm, limit 5.0 kN");
        // sqrt(60e3/75)/2pi = 4.5016 Hz.
        let by_frequency = read("frequency=4.501581580785529Hz").unwrap();
        assert!((by_frequency.restraint.static_force_n(0.1) - 6e3).abs() < 1e-6);
        for text in ["", "mass=75kg", "stiffness=0kN/m", "stiffness=1kN/m frequency=1Hz", "stiffness=1kN/m slack=-1mm"]
        {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
