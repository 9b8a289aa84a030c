//! What is assessed beyond the covariance, and how uncertain the inputs are.

use crumple_lumped_fit::{AssessmentOptions, Distribution, InputUncertainty, largest_draw};
use crumple_stage::Usage;
use serde::Serialize;

/// What is assessed beyond the covariance; part of the settings.
#[derive(Debug, Clone, Serialize)]
pub struct AssessmentSettings {
    pub profile: bool,
    pub bootstrap: usize,
    /// Half width of the share of the mass in front; 0 where masses are given or fitted.
    pub front_mass_uncertainty: f64,
    pub mass_uncertainty_kg: f64,
    pub speed_uncertainty_m_per_s: f64,
    pub bias_uncertainty_m_per_s2: f64,
    pub time_zero_uncertainty_s: f64,
    /// Of mass, speed, zero level and time zero.
    #[serde(serialize_with = "names", skip_serializing_if = "all_normal")]
    pub distributions: [Distribution; 4],
    pub repetitions: usize,
}

fn all_normal(distributions: &[Distribution; 4]) -> bool {
    distributions.iter().all(|distribution| *distribution == Distribution::Normal)
}

fn names<S: serde::Serializer>(distributions: &[Distribution; 4], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(distributions.iter().map(|distribution| distribution.name()))
}

impl AssessmentSettings {
    /// The flags that say how well parameters are known, as far as they are given.
    pub fn flags(&self) -> Vec<&'static str> {
        let inputs = [
            ("--mass-uncertainty", self.mass_uncertainty_kg),
            ("--speed-uncertainty", self.speed_uncertainty_m_per_s),
            ("--bias-uncertainty", self.bias_uncertainty_m_per_s2),
            ("--time-zero-uncertainty", self.time_zero_uncertainty_s),
        ];
        let switches = [("--profile", self.profile), ("--bootstrap", self.bootstrap > 0)];
        let switches = switches.into_iter().filter(|(_, given)| *given).map(|(flag, _)| flag);
        switches.chain(inputs.into_iter().filter(|(_, value)| *value > 0.0).map(|(flag, _)| flag)).collect()
    }

    /// How uncertain the inputs are.
    pub fn inputs(&self) -> InputUncertainty {
        InputUncertainty {
            mass_kg: self.mass_uncertainty_kg,
            impact_speed_m_per_s: self.speed_uncertainty_m_per_s,
            bias_m_per_s2: self.bias_uncertainty_m_per_s2,
            time_zero_s: self.time_zero_uncertainty_s,
            distributions: self.distributions,
        }
    }

    /// What looks from a minimum.
    pub fn options(&self) -> AssessmentOptions {
        AssessmentOptions { profile: self.profile, bootstrap: self.bootstrap }
    }

    /// Refuses uncertainties of which a draw could make the mass or the speed zero.
    pub fn check(&self, mass_kg: Option<f64>, impact_speed_m_per_s: f64) -> Result<(), Usage> {
        let reaches = |flag: &str, size: f64, distribution: Distribution, value: f64, unit: &str| {
            let largest = largest_draw(distribution);
            if largest * size < value {
                return Ok(());
            }
            let what = match distribution {
                Distribution::Normal => "draws of up to 6 standard deviations",
                Distribution::Uniform => "draws of up to the half width",
            };
            Err(Usage::new(format!(
                "{flag} is {size} {unit} on {value} {unit}: {what} reach zero, expected less than {:.4} {unit}",
                value / largest
            )))
        };
        let [of_mass, of_speed, ..] = self.distributions;
        if let Some(mass_kg) = mass_kg {
            reaches("mass-uncertainty", self.mass_uncertainty_kg, of_mass, mass_kg, "kg")?;
        }
        reaches("speed-uncertainty", self.speed_uncertainty_m_per_s, of_speed, impact_speed_m_per_s, "m/s")
    }
}
