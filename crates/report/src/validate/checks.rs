//! Energies and quality of a simulation: value, limit, source, and whether the file says it at all.

use std::collections::BTreeMap;

use crumple_signal::Sampled;
use serde::Serialize;

use super::requirements::Requirement;

/// Where the limits come from that a comparison has by itself.
const CRASHMETRICS: &str = "crashmetrics 0.6.0";
/// Both sides of the momentum of the wall.
const OWN: &str = "Crumple";

/// What became of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Within its limit.
    Passed,
    /// Beyond it.
    Failed,
    /// The file has no such number, or 0 in all states: not computed or none, which cannot be told.
    NotInFile,
}

impl Outcome {
    /// For people.
    pub fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::NotInFile => "not in the file",
        }
    }
}

/// One number of the quality of a simulation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Its name, as a requirement has it.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Its value.
    pub value: Option<f64>,
    /// The least that it may be.
    pub at_least: Option<f64>,
    /// The most.
    pub at_most: Option<f64>,
    /// Who says so.
    pub source: String,
    /// What became of it.
    pub outcome: Outcome,
}

/// The records of the whole model: energies (J), momentum, speed, masses, by their names.
#[derive(Debug, Clone, Default)]
pub struct ModelRecords(pub BTreeMap<String, Sampled>);

/// What the checks need beside the records of the model.
#[derive(Debug, Clone, Copy, Default)]
pub struct Impact<'a> {
    /// Mass, kg.
    pub mass_kg: Option<f64>,
    /// Force on the wall, N.
    pub wall: Option<&'a Sampled>,
}

impl ModelRecords {
    /// A record that is not 0 in all states.
    fn get(&self, names: &[&str]) -> Option<&Sampled> {
        let found = names.iter().find_map(|name| self.0.get(*name))?;
        found.samples().iter().any(|x| *x != 0.0).then_some(found)
    }

    fn largest(&self, names: &[&str]) -> Option<f64> {
        Some(self.get(names)?.samples().iter().fold(0.0, |most: f64, x| most.max(x.abs())))
    }

    /// Total energy: as the solver wrote it, else the sum of its parts.
    pub fn total(&self) -> Option<Vec<f64>> {
        if let Some(total) = self.get(&["total_energy"]) {
            return Some(total.samples().to_vec());
        }
        let mut sum = self.get(&["internal_energy"])?.samples().to_vec();
        self.get(&["kinetic_energy"])?;
        for part in ["kinetic_energy", "rotation_energy", "spring_energy", "contact_energy", "hourglass_energy"] {
            let values = self.0.get(part).map(Sampled::samples).unwrap_or_default();
            sum.iter_mut().zip(values).for_each(|(sum, x)| *sum += x);
        }
        Some(sum)
    }

    /// Total over initial total and external work, in the state where it is farthest from 1.
    fn energy_ratio(&self) -> Option<f64> {
        let total = self.total()?;
        let initial = *total.first().filter(|initial| **initial > 0.0)?;
        let work = self.0.get("external_work").map(Sampled::samples).unwrap_or_default();
        let ratios = total.iter().enumerate().map(|(k, x)| x / (initial + work.get(k).unwrap_or(&0.0)));
        ratios.reduce(|far, x| if (x - 1.0).abs() > (far - 1.0).abs() { x } else { far })
    }

    fn of_initial(&self, energy: Option<f64>) -> Option<f64> {
        Some(energy? / self.total()?.first().copied().filter(|initial| *initial > 0.0)?)
    }

    fn added_mass(&self, mass_kg: Option<f64>) -> Option<f64> {
        let percent = self.largest(&["percent_increase", "percent_added_mass"]).map(|percent| percent / 100.0);
        percent.or_else(|| Some(self.largest(&["added_mass"])? / mass_kg?))
    }

    /// Impulse of the wall over the change of momentum of the whole model.
    fn wall_impulse(&self, impact: Impact<'_>) -> Option<f64> {
        let force = impact.wall?;
        let impulse: f64 = force.samples().windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) * force.dt_s()).sum();
        let change = |wave: &Sampled| Some((wave.samples().last()? - wave.samples().first()?).abs());
        let of_speed = || Some(impact.mass_kg? * change(self.get(&["global_x_velocity"])?)?);
        let momentum = self.get(&["x_momentum"]).and_then(change).or_else(of_speed)?;
        (momentum > 0.0).then(|| impulse.abs() / momentum)
    }

    /// All checks. A requirement of a check's name stands in place of its limit.
    pub fn checks(&self, impact: Impact<'_>, requirements: &[Requirement]) -> Vec<Check> {
        let negative = self
            .get(&["sliding_interface_energy", "contact_energy"])
            .map(|wave| wave.samples().iter().fold(0.0, |most: f64, x| most.max(-x)));
        let hourglass = self.largest(&["hourglass_energy"]).zip(self.largest(&["internal_energy"]));
        let within = |share: f64| (Some(1.0 - share), Some(1.0 + share));
        let damping = self.of_initial(self.largest(&["system_damping_energy"]));
        let rows = [
            ("energy-ratio", "total over initial and external energy", self.energy_ratio(), within(0.05), CRASHMETRICS),
            (
                "hourglass",
                "hourglass over internal energy",
                hourglass.map(|(h, i)| h / i),
                (None, Some(0.1)),
                CRASHMETRICS,
            ),
            ("contact-energy", "negative contact energy", self.of_initial(negative), (None, Some(0.05)), CRASHMETRICS),
            ("damping", "damping energy", damping, (None, Some(0.05)), CRASHMETRICS),
            ("added-mass", "added mass", self.added_mass(impact.mass_kg), (None, Some(0.05)), CRASHMETRICS),
            ("wall-impulse", "wall impulse over change of momentum", self.wall_impulse(impact), within(0.02), OWN),
        ];
        let check = |(name, what, value, (at_least, at_most), source): (_, _, Option<f64>, _, &str)| {
            let of_user: Vec<&Requirement> = requirements.iter().filter(|one| one.name == name).collect();
            let mut check =
                Check { name, what, value, at_least, at_most, source: source.to_owned(), outcome: Outcome::NotInFile };
            for own in of_user {
                check.at_least = own.at_least.or(check.at_least);
                check.at_most = own.at_most.or(check.at_most);
                check.source.clone_from(&own.source);
            }
            let is_within = |x: f64| check.at_least.is_none_or(|y| x >= y) && check.at_most.is_none_or(|y| x <= y);
            check.outcome = match value {
                None => Outcome::NotInFile,
                Some(x) if is_within(x) => Outcome::Passed,
                Some(_) => Outcome::Failed,
            };
            check
        };
        rows.into_iter().map(check).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn records(list: &[(&str, [f64; 3])]) -> ModelRecords {
        let wave = |values: &[f64; 3]| Sampled::new(0.0, 0.1, values.to_vec()).unwrap();
        ModelRecords(list.iter().map(|(name, values)| ((*name).to_owned(), wave(values))).collect())
    }

    fn outcome(checks: &[Check], name: &str) -> (Option<f64>, Outcome) {
        checks.iter().find(|check| check.name == name).map(|check| (check.value, check.outcome)).unwrap()
    }

    #[test]
    fn energies_are_passed_failed_or_not_in_the_file() {
        let model = records(&[
            ("total_energy", [100.0, 100.0, 93.0]),
            ("internal_energy", [0.0, 80.0, 90.0]),
            ("hourglass_energy", [0.0, 4.0, 4.5]),
            ("sliding_interface_energy", [0.0, 0.0, 0.0]),
            ("system_damping_energy", [0.0, 1.0, 7.0]),
            ("global_x_velocity", [10.0, 5.0, -2.0]),
        ]);
        let force = Sampled::new(0.0, 0.1, vec![0.0, 1200.0, 0.0]).unwrap();
        let impact = Impact { mass_kg: Some(10.0), wall: Some(&force) };
        let checks = model.checks(impact, &[]);
        assert_eq!(outcome(&checks, "energy-ratio"), (Some(0.93), Outcome::Failed));
        assert_eq!(outcome(&checks, "hourglass"), (Some(0.05), Outcome::Passed));
        // Zero in all states is not computed or none.
        assert_eq!(outcome(&checks, "contact-energy"), (None, Outcome::NotInFile));
        assert_eq!(outcome(&checks, "damping"), (Some(0.07), Outcome::Failed));
        assert_eq!(outcome(&checks, "added-mass"), (None, Outcome::NotInFile));
        assert_eq!(outcome(&checks, "wall-impulse"), (Some(1.0), Outcome::Passed));
        let tight = Requirement::read("hourglass<=2%", "ours.txt").unwrap();
        let checks = model.checks(impact, &[tight]);
        assert_eq!(outcome(&checks, "hourglass").1, Outcome::Failed);
        assert!(checks.iter().any(|check| check.source == "ours.txt"));
    }

    #[test]
    fn without_a_total_its_parts_are_summed() {
        let model = records(&[
            ("internal_energy", [0.0, 50.0, 101.0]),
            ("kinetic_energy", [100.0, 49.0, 0.0]),
            ("hourglass_energy", [0.0, 0.5, 1.0]),
        ]);
        let ratio = outcome(&model.checks(Impact::default(), &[]), "energy-ratio").0.unwrap();
        assert!((ratio - 1.02).abs() < 1e-12, "{ratio}");
        assert!(ModelRecords::default().checks(Impact::default(), &[]).iter().all(|c| c.outcome == Outcome::NotInFile));
    }
}
