//! Flags and pipeline keys of the stage.

#![allow(rustdoc::invalid_html_tags, reason = "help texts are read on a terminal, where <name> stands for a value")]

use std::fmt;
use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use crumple_lumped::ModelKind;
use crumple_lumped_fit::{FireflyUnits, FitQuantity, MassFit, Method, SensorPlace, SolveSettings};
use crumple_signal::Uncertain;
use crumple_signal::value::{Acceleration, Mass, Speed, Time};
use serde::{Deserialize, Serialize, Serializer};

use crate::stage::own_models::{AskedModel, ModelParser};

// Values by their names.

/// A value by its name, read alike from a flag and from a pipeline file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Named<T>(pub T);

impl<T: FromStr<Err: fmt::Display>> FromStr for Named<T> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.parse().map(Self).map_err(|error: T::Err| error.to_string())
    }
}

impl<T: fmt::Display> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl<'de, T: FromStr<Err: fmt::Display>> Deserialize<'de> for Named<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

/// The parser of a flag that takes one of these names: a mistyped one is answered with the nearest.
fn one_of<T>(names: Vec<&'static str>) -> impl TypedValueParser<Value = Named<T>>
where
    T: FromStr<Err: fmt::Display> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Named<T>>())
}

/// A channel on a place of the model: `front=103`, or `wall`, the force on the barrier.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSensor {
    pub place: SensorPlace,
    pub channel: String,
}

impl FromStr for PlacedSensor {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "wall" {
            return Ok(Self { place: SensorPlace::Wall, channel: "barrier/force".to_owned() });
        }
        let (place, channel) = text
            .split_once('=')
            .filter(|(_, channel)| !channel.is_empty())
            .ok_or_else(|| format!("sensor {text:?} is not place=channel, as in compartment=93,front=103,wall"))?;
        Ok(Self { place: place.parse()?, channel: channel.to_owned() })
    }
}

impl fmt::Display for PlacedSensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.place, self.channel)
    }
}

/// A paper whose printed solutions are added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Paper {
    Tfest,
}

// Flags and keys.

/// `--models`, from the table of solvers.
fn models_help() -> String {
    let names = |models: &[ModelKind]| models.iter().map(|model| model.name()).collect::<Vec<_>>().join(", ");
    let left_out: Vec<_> = SolveSettings::all_models()
        .iter()
        .copied()
        .filter(|model| !SolveSettings::default_models().contains(model))
        .collect();
    format!(
        "Models to solve for: {}, files of own models (my_car.toml) [default: all families but {}]",
        names(SolveSettings::all_models()),
        names(&left_out)
    )
}

/// `--method`, from the table of solvers.
fn methods_help() -> String {
    let describe = |method: &Method| {
        let models: Vec<_> = method.models().collect();
        let suffix = if models.len() == SolveSettings::all_models().len() {
            String::new()
        } else {
            format!(" [{}]", models.iter().map(|model| model.name()).collect::<Vec<_>>().join(", "))
        };
        format!("{method}: {}{suffix}", method.about())
    };
    let by_default = |model: &ModelKind| {
        let methods: Vec<_> = Method::default_of(*model).map(Method::name).collect();
        format!("{model} {}", methods.join(", "))
    };
    format!(
        "Methods. {} [default: {}]",
        Method::ALL.iter().map(describe).collect::<Vec<_>>().join("; "),
        SolveSettings::all_models().iter().map(by_default).collect::<Vec<_>>().join("; ")
    )
}

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    // The texts of these two come from the table of solvers.
    #[allow(missing_docs, reason = "the help text is made from the table")]
    #[arg(long, value_name = "NAME", value_delimiter = ',', help = models_help(), hide_possible_values = true,
        value_parser = ModelParser)]
    pub models: Vec<Named<AskedModel>>,

    #[allow(missing_docs, reason = "the help text is made from the table")]
    #[arg(long, value_name = "NAME", value_delimiter = ',', help = methods_help(), hide_possible_values = true,
        value_parser = one_of::<Method>(Method::ALL.iter().map(|method| method.name()).collect()))]
    pub method: Vec<Named<Method>>,

    /// Firefly search: units of distance, physical (as printed) or unit (every variable over its range) [default: unit]
    ///
    /// In physical units the attraction of two fireflies underflows to zero, and each walks at random.
    #[arg(long, value_name = "UNITS")]
    pub firefly_units: Option<Named<FireflyUnits>>,

    /// Firefly search: generations of 40 fireflies [default: 500]
    #[arg(long, value_name = "NUMBER")]
    pub firefly_generations: Option<usize>,

    /// Firefly search: seed of its random numbers [default: 1]
    #[arg(long, value_name = "NUMBER")]
    pub firefly_seed: Option<u64>,

    /// L-SHADE search: evaluations after which the descent takes over [default: 20000]
    #[arg(long, value_name = "NUMBER")]
    pub l_shade_evaluations: Option<u64>,

    /// L-SHADE search: seed of its random numbers [default: 1]
    #[arg(long, value_name = "NUMBER")]
    pub l_shade_seed: Option<u64>,

    /// What of the motion direct-fit and l-shade fit: displacement, velocity or acceleration [default: displacement]
    ///
    /// Displacement is smooth and carries the crush; acceleration shows stiff parts and every wiggle the model cannot
    /// follow.
    #[arg(long, value_name = "QUANTITY")]
    pub fit_quantity: Option<Named<FitQuantity>>,

    /// Sensors to fit together, as place=channel: compartment=93,front=103 [default: compartment=<the pulse>]
    ///
    /// Places: compartment (the last mass), front or engine (the mass next to the barrier), chassis (the one in front
    /// of the compartment), occupant (the last mass of a chain where it is called so, behind the compartment), m1, m2,
    /// ... A sensor in front tells the two dual double models apart. The motion of every channel comes from
    /// crumple-integrate (--channels there).
    #[arg(long, value_name = "PLACE=CHANNEL", value_delimiter = ',')]
    pub sensors: Vec<Named<PlacedSensor>>,

    /// Masses of the double and triple model in a fit: known, free (with the total known), or the bounds of every
    /// share, such as 0.1..0.4 [default: known]
    #[arg(long, value_name = "HOW")]
    pub fit_masses: Option<Named<MassFit>>,

    /// Triple model: masses of engine, suspension and chassis, and compartment [default: the front mass halved, the
    /// rest]
    #[arg(long, value_name = "MASS", value_delimiter = ',')]
    pub triple_masses: Vec<Mass>,

    /// Fit the elastoplastic model as one that stays attached after rebound and swings on [default: false]
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    pub stay_attached: Option<bool>,

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

    /// How far that share may be off, up or down, all values alike: enters the intervals of the double and triple model
    /// [default: 0.1 of an assumed share, 0 of a given one]
    #[arg(long, value_name = "SHARE")]
    pub front_mass_uncertainty: Option<f64>,

    /// Start of the fit window after time zero [default: 0 s]
    #[arg(long, value_name = "TIME")]
    pub fit_from: Option<Time>,

    /// End of the fit window after time zero [default: time of dynamic crush, or the end of a record without one]
    #[arg(long, value_name = "TIME")]
    pub fit_to: Option<Time>,

    /// Follow the likelihood of every parameter while all others are fitted again: 95 % intervals that need not be
    /// symmetric, and open ends where the record does not bound a parameter [default: false]
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    pub profile: Option<bool>,

    /// Repeat every fit with the misfit shuffled in blocks, so many times, for 95 % intervals without a formula; 200 is
    /// usual [default: 0]
    #[arg(long, value_name = "NUMBER")]
    pub bootstrap: Option<usize>,

    /// Uncertainty of the test mass, "10 kg normal" (standard deviation, also without the word) or "10 kg uniform"
    /// (half width): propagated to the parameters [default: 0 kg]
    #[arg(long, value_name = "MASS")]
    pub mass_uncertainty: Option<Uncertain<Mass>>,

    /// Uncertainty of the impact speed, e.g. "0.1 km/h uniform": propagated to crush and parameters [default: in
    /// intervals 0.1 km/h uniform, not propagated]
    #[arg(long, value_name = "SPEED")]
    pub speed_uncertainty: Option<Uncertain<Speed>>,

    /// Uncertainty of the zero level of every accelerometer, e.g. "0.05 g uniform": propagated likewise [default: 0
    /// m/s^2]
    #[arg(long, value_name = "ACCELERATION")]
    pub bias_uncertainty: Option<Uncertain<Acceleration>>,

    /// Add the solutions that a paper lists, from its own printed numbers and as it typed them, labelled: tfest (both
    /// splits of the mass; 284.6 kg for 284.4 kg in one equation) [default: none]
    #[arg(long, value_name = "PAPER", hide_possible_values = true)]
    pub paper: Option<Paper>,

    /// Repetitions of the propagation of these uncertainties [default: 200]
    #[arg(long, value_name = "NUMBER")]
    pub repetitions: Option<usize>,

    /// Choice of candidates: what a model without plastic deformation is charged beside the evidence; 0 takes this term
    /// off [default: 10]
    #[arg(long, value_name = "NUMBER")]
    pub plastic_prior: Option<f64>,

    /// Choice of candidates: coefficient of restitution of vehicles in general, where the record shows none [default:
    /// 0.15]
    #[arg(long, value_name = "NUMBER")]
    pub restitution_prior: Option<f64>,

    /// Choice of candidates: standard deviation of the logarithm of the restitution; 0 takes this term off [default:
    /// 0.35]
    #[arg(long, value_name = "NUMBER")]
    pub restitution_deviation: Option<f64>,

    /// Choice of candidates: displacement fit as measured from which a model is adequate, percent [default: 90]
    #[arg(long, value_name = "PERCENT")]
    pub adequate_fit: Option<f64>,

    /// Choice of candidates: standard deviation of the crush of a plastic model at lower speeds, beside what the record
    /// itself shows, percent [default: 1]
    #[arg(long, value_name = "PERCENT")]
    pub lower_speed_limit: Option<f64>,

    /// Rate factor of a force-deflection curve, s/m: a prior, force grows by this share for each m/s [default: 0.004]
    #[arg(long, value_name = "S_PER_M")]
    pub rate_factor: Option<f64>,

    /// Chains of masses to be fitted, stated in the pipeline file: `[parameter-solve.chain.<name>]`.
    #[arg(skip)]
    pub chain: toml::Table,
}
