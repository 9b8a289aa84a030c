//! The settings as they stand in the provenance of an artifact: every default filled in, in names, numbers and SI
//! units.
//!
//! This is part of the file format. Names, order and meaning of the fields stay when the settings of the code change.

use crumple_lumped_fit::{FireflyUnits, MassFit, MassSplit};
use serde::{Serialize, Serializer};

use crate::stage::options::assessment::AssessmentSettings;
use crate::stage::options::chain_table::FittedChain;
use crate::stage::options::settings::StageSettings;

/// The fields in the order of the file.
#[derive(Serialize)]
struct Provenance<'a> {
    models: Vec<&'static str>,
    /// `default` where none was asked for.
    methods: Vec<&'static str>,
    mass_kg: Option<f64>,
    m1_kg: Option<f64>,
    m2_kg: Option<f64>,
    front_mass_fraction: f64,
    fit_from_s: f64,
    fit_to_s: Option<f64>,
    fit_samples: usize,
    fit_starts: usize,
    firefly_units: &'static str,
    firefly_generations: usize,
    firefly_seed: u64,
    l_shade_evaluations: u64,
    l_shade_seed: u64,
    fit_quantity: &'static str,
    /// Place and channel of each sensor.
    sensors: Vec<(String, &'a str)>,
    fit_masses: Option<(f64, f64)>,
    triple_masses_kg: Option<[f64; 3]>,
    stay_attached: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    paper: Option<&'static str>,
    #[serde(flatten)]
    assessment: &'a AssessmentSettings,
    plastic_prior: f64,
    restitution_prior: f64,
    restitution_deviation: f64,
    adequate_fit_percent: f64,
    lower_speed_limit_percent: f64,
    rate_factor_s_per_m: f64,
    #[serde(skip_serializing_if = "is_empty")]
    chain: &'a [FittedChain],
}

fn is_empty(chains: &[FittedChain]) -> bool {
    chains.is_empty()
}

impl<'a> Provenance<'a> {
    fn of(settings: &'a StageSettings) -> Self {
        let solve = &settings.solve;
        let (m1_kg, m2_kg) = match solve.split {
            MassSplit::FrontFraction(_) => (None, None),
            MassSplit::Front(m1) => (Some(m1), None),
            MassSplit::Rear(m2) => (None, Some(m2)),
            MassSplit::Both(m1, m2) => (Some(m1), Some(m2)),
        };
        let methods: Vec<&str> = solve.methods.iter().map(|method| method.name()).collect();
        Self {
            models: solve.models.iter().map(|model| model.name()).collect(),
            methods: if methods.is_empty() { vec!["default"] } else { methods },
            mass_kg: settings.mass_kg,
            m1_kg,
            m2_kg,
            front_mass_fraction: settings.front_mass_fraction,
            fit_from_s: solve.fit_from_s,
            fit_to_s: solve.fit_to_s,
            fit_samples: solve.fit_samples,
            fit_starts: solve.fit_starts,
            firefly_units: match solve.firefly.units {
                FireflyUnits::Unit => "unit",
                FireflyUnits::Physical => "physical",
            },
            firefly_generations: solve.firefly.generations,
            firefly_seed: solve.firefly.seed,
            l_shade_evaluations: solve.l_shade.evaluations,
            l_shade_seed: solve.l_shade.seed,
            fit_quantity: solve.quantity.name(),
            sensors: settings.places.iter().map(|(place, channel)| (place.to_string(), channel.as_str())).collect(),
            fit_masses: match solve.mass_fit {
                MassFit::Known => None,
                MassFit::Shares { lower, upper } => Some((lower, upper)),
            },
            triple_masses_kg: solve.triple,
            stay_attached: !solve.release,
            paper: settings.paper,
            assessment: &settings.assessment,
            plastic_prior: settings.selection.plastic_prior,
            restitution_prior: settings.selection.restitution_prior,
            restitution_deviation: settings.selection.restitution_deviation,
            adequate_fit_percent: settings.selection.adequate_fit_percent,
            lower_speed_limit_percent: settings.selection.lower_speed_limit_percent,
            rate_factor_s_per_m: settings.solve.rate_factor_s_per_m,
            chain: &settings.chain,
        }
    }
}

impl Serialize for StageSettings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Provenance::of(self).serialize(serializer)
    }
}
