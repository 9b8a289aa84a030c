//! The occupant of a prediction: a mass behind a restraint.

use crumple_lumped::{ForceDeflection, Occupant};
use crumple_signal::value::{Force, Frequency, Length, Mass, Stiffness};
use crumple_stage::Usage;
use serde::Deserialize;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::described::Described;

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
