//! Flags and pipeline keys of the stage, and the settings they come to.

use crumple_lumped::ModelKind;
use crumple_parameter_solve::{
    DEFAULT_METHODS, DEFAULT_MODELS, FireflyOptions, FireflyUnits, METHODS, MODELS, MassSplit, Method, SolveSettings,
};
use crumple_signal::value::{Mass, Time};
use crumple_stage::{Usage, nearest};
use serde::{Deserialize, Serialize};

/// Samples fitted at most, and starts of a fit: enough for four parameters, see the fit's documentation.
const FIT_SAMPLES: usize = 250;
const FIT_STARTS: usize = 24;
/// Engine and front structure of a passenger car are about a quarter of it; an assumption, and said so in a note.
const FRONT_MASS_FRACTION: f64 = 0.25;

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Models to solve for: kelvin, elastoplastic, maxwell, nonlinear-1, nonlinear-2, double-spring-mass-damper
    /// [default: all but nonlinear-1]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub models: Vec<String>,

    /// Methods: closed-form (from the crash events), direct-fit (to the displacement), coefficient-matching (from an
    /// identified model with four poles: every solution), curve-fit (from four real exponentials, as the ERA paper prints
    /// it: for reproduction only), firefly (nonlinear-2) [default: closed-form,direct-fit]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub method: Vec<String>,

    /// Firefly search: units of distance, physical (as printed) or unit (every variable over its range) [default: unit]
    ///
    /// In physical units the attraction of two fireflies underflows to zero, and each walks at random.
    #[arg(long, value_name = "UNITS")]
    pub firefly_units: Option<String>,

    /// Firefly search: generations of 40 fireflies [default: 500]
    #[arg(long, value_name = "NUMBER")]
    pub firefly_generations: Option<usize>,

    /// Firefly search: seed of its random numbers [default: 1]
    #[arg(long, value_name = "NUMBER")]
    pub firefly_seed: Option<u64>,

    /// Mass of the vehicle, with its unit, instead of the test's
    #[arg(long, value_name = "MASS")]
    pub mass: Option<Mass>,

    /// Double model: mass of the chassis and front structure, next to the barrier [default: from the fraction]
    #[arg(long, value_name = "MASS")]
    pub m1: Option<Mass>,

    /// Double model: mass of the passenger compartment [default: the rest]
    #[arg(long, value_name = "MASS")]
    pub m2: Option<Mass>,

    /// Double model: share of the mass in front of the compartment, between 0 and 1 [default: 0.25, an assumption]
    ///
    /// One accelerometer in the compartment does not tell how the mass divides, and the parameters depend on it.
    #[arg(long, value_name = "SHARE")]
    pub front_mass_fraction: Option<f64>,

    /// Start of the fit window after time zero [default: 0 s]
    #[arg(long, value_name = "TIME")]
    pub fit_from: Option<Time>,

    /// End of the fit window after time zero [default: time of dynamic crush, or the end of a record without one]
    #[arg(long, value_name = "TIME")]
    pub fit_to: Option<Time>,
}

/// Options with every default filled in.
#[derive(Debug, Serialize)]
pub struct StageSettings {
    models: Vec<&'static str>,
    methods: Vec<&'static str>,
    /// Mass given by flag, kg.
    pub mass_kg: Option<f64>,
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
    #[serde(skip)]
    pub solve: SolveSettings,
}

impl TryFrom<Options> for StageSettings {
    type Error = Usage;

    fn try_from(options: Options) -> Result<Self, Usage> {
        let models = if options.models.is_empty() {
            DEFAULT_MODELS.to_vec()
        } else {
            let named = options.models.iter().map(|name| model(name)).collect::<Result<Vec<_>, _>>()?;
            // Named twice is meant once.
            named.iter().enumerate().filter(|(k, kind)| !named[..*k].contains(kind)).map(|(_, kind)| *kind).collect()
        };
        let methods = if options.method.is_empty() {
            DEFAULT_METHODS.to_vec()
        } else {
            options.method.iter().map(|name| method(name)).collect::<Result<_, _>>()?
        };
        let fraction = options.front_mass_fraction;
        if let Some(fraction) = fraction
            && !(fraction > 0.0 && fraction < 1.0)
        {
            return Err(Usage::new(format!("front-mass-fraction is {fraction}, expected a number between 0 and 1")));
        }
        let split = match (options.m1.map(Mass::si), options.m2.map(Mass::si)) {
            (Some(m1), Some(m2)) => MassSplit::Both(m1, m2),
            (Some(m1), None) => MassSplit::Front(m1),
            (None, Some(m2)) => MassSplit::Rear(m2),
            (None, None) => MassSplit::FrontFraction(fraction.unwrap_or(FRONT_MASS_FRACTION)),
        };
        let units = match options.firefly_units.as_deref() {
            None | Some("unit") => FireflyUnits::Unit,
            Some("physical") => FireflyUnits::Physical,
            Some(other) => return Err(unknown("firefly-units", other, &["physical", "unit"])),
        };
        let printed = FireflyOptions::default();
        let firefly = FireflyOptions {
            units,
            generations: options.firefly_generations.unwrap_or(printed.generations),
            seed: options.firefly_seed.unwrap_or(printed.seed),
            ..printed
        };
        let solve = SolveSettings {
            models,
            methods,
            split,
            fit_from_s: options.fit_from.map_or(0.0, Time::si),
            fit_to_s: options.fit_to.map(Time::si),
            fit_samples: FIT_SAMPLES,
            fit_starts: FIT_STARTS,
            firefly,
        };
        Ok(Self {
            models: solve.models.iter().map(|m| m.name()).collect(),
            methods: solve.methods.iter().map(|m| m.name()).collect(),
            mass_kg: options.mass.map(Mass::si),
            m1_kg: options.m1.map(Mass::si),
            m2_kg: options.m2.map(Mass::si),
            front_mass_fraction: fraction.unwrap_or(FRONT_MASS_FRACTION),
            fit_from_s: solve.fit_from_s,
            fit_to_s: solve.fit_to_s,
            fit_samples: solve.fit_samples,
            fit_starts: solve.fit_starts,
            firefly_units: if units == FireflyUnits::Unit { "unit" } else { "physical" },
            firefly_generations: firefly.generations,
            firefly_seed: firefly.seed,
            solve,
        })
    }
}

fn model(name: &str) -> Result<ModelKind, Usage> {
    let choices = MODELS.map(ModelKind::name);
    match name.parse() {
        Ok(kind) if MODELS.contains(&kind) => Ok(kind),
        Ok(kind) => Err(Usage::new(format!("there is no solver for the model {kind} yet"))
            .hint(format!("there are: {}", choices.join(", ")))),
        Err(_) => Err(unknown("model", name, &choices)),
    }
}

fn method(name: &str) -> Result<Method, Usage> {
    name.parse().map_err(|_: String| unknown("method", name, &METHODS.map(Method::name)))
}

fn unknown(what: &str, name: &str, choices: &[&str]) -> Usage {
    let hint = match nearest(name, choices.iter().copied()) {
        Some(near) => format!("did you mean {near:?}?"),
        None => format!("there are: {}", choices.join(", ")),
    };
    Usage::new(format!("unknown {what} {name:?}")).hint(hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_method_or_model_is_answered_with_the_nearest() {
        let options = Options { method: vec!["closed-from".to_owned()], ..Options::default() };
        let error = StageSettings::try_from(options).unwrap_err();
        assert_eq!(error, Usage::new("unknown method \"closed-from\"").hint("did you mean \"closed-form\"?"));
        let options = Options { models: vec!["triple-spring-mass-damper".to_owned()], ..Options::default() };
        assert!(StageSettings::try_from(options).unwrap_err().to_string().contains("no solver"));
    }

    #[test]
    fn everything_that_changes_the_result_is_in_the_provenance() {
        let json = |options| serde_json::to_string(&StageSettings::try_from(options).unwrap()).unwrap();
        let default = json(Options::default());
        for options in [
            Options { models: vec!["kelvin".to_owned()], ..Options::default() },
            Options { method: vec!["closed-form".to_owned()], ..Options::default() },
            Options { mass: Some(Mass::from_si(900.0)), ..Options::default() },
            Options { m1: Some(Mass::from_si(900.0)), ..Options::default() },
            Options { m2: Some(Mass::from_si(900.0)), ..Options::default() },
            Options { front_mass_fraction: Some(0.3), ..Options::default() },
            Options { fit_from: Some(Time::from_si(0.01)), ..Options::default() },
            Options { fit_to: Some(Time::from_si(0.05)), ..Options::default() },
        ] {
            assert_ne!(json(options), default);
        }
    }
}
