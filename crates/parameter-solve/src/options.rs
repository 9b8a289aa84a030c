//! Flags and pipeline keys of the stage, and the settings they come to.

use crumple_lumped::ModelKind;
use crumple_parameter_solve::{
    DEFAULT_MODELS, FireflyOptions, FireflyUnits, FitQuantity, LShadeOptions, METHODS, MODELS, MassFit, MassSplit,
    Method, Place, REPETITIONS, SolveSettings, solvers_of,
};
use crumple_signal::Uncertain;
use crumple_signal::value::{Acceleration, Mass, Speed, Time};
use crumple_stage::{Usage, nearest};
use serde::{Deserialize, Serialize};

use crate::chain_table::FittedChain;
use crate::judging::Judging;

/// Samples fitted at most, and starts of a fit: enough for four parameters, see the fit's documentation.
const FIT_SAMPLES: usize = 250;
const FIT_STARTS: usize = 24;
/// Engine and front structure of a passenger car are about a quarter of it; an assumption, and said so in a note.
const FRONT_MASS_FRACTION: f64 = 0.25;

/// Shares of masses that are free.
const FREE_SHARES: (f64, f64) = (0.02, 0.95);

/// `--models`, from the table of solvers.
fn models_help() -> String {
    let names = |models: &[ModelKind]| models.iter().map(|model| model.name()).collect::<Vec<_>>().join(", ");
    let left_out: Vec<_> = MODELS.iter().copied().filter(|model| !DEFAULT_MODELS.contains(model)).collect();
    format!("Models to solve for: {} [default: all but {}]", names(&MODELS), names(&left_out))
}

/// `--method`, from the table of solvers.
fn methods_help() -> String {
    let describe = |method: &Method| {
        let models: Vec<_> = method.models().collect();
        let of = if models.len() == MODELS.len() {
            String::new()
        } else {
            format!(" [{}]", models.iter().map(|model| model.name()).collect::<Vec<_>>().join(", "))
        };
        format!("{method}: {}{of}", method.about())
    };
    let by_default = |model: &ModelKind| {
        let methods: Vec<_> = solvers_of(*model, &[]).iter().map(|solver| solver.method.name()).collect();
        format!("{model} {}", methods.join(", "))
    };
    format!(
        "Methods. {} [default: {}]",
        METHODS.iter().map(describe).collect::<Vec<_>>().join("; "),
        MODELS.iter().map(by_default).collect::<Vec<_>>().join("; ")
    )
}

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    // The texts of these two come from the table of solvers.
    #[allow(missing_docs, reason = "the help text is made from the table")]
    #[arg(long, value_name = "NAME", value_delimiter = ',', help = models_help())]
    pub models: Vec<String>,

    #[allow(missing_docs, reason = "the help text is made from the table")]
    #[arg(long, value_name = "NAME", value_delimiter = ',', help = methods_help())]
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

    /// L-SHADE search: evaluations after which the descent takes over [default: 20000]
    #[arg(long, value_name = "NUMBER")]
    pub l_shade_evaluations: Option<u64>,

    /// L-SHADE search: seed of its random numbers [default: 1]
    #[arg(long, value_name = "NUMBER")]
    pub l_shade_seed: Option<u64>,

    /// What of the motion direct-fit and l-shade fit: displacement, velocity or acceleration [default: displacement]
    ///
    /// Displacement is smooth and carries the crush; acceleration shows stiff parts and every wiggle the model cannot follow.
    #[arg(long, value_name = "QUANTITY")]
    pub fit_quantity: Option<String>,

    /// Sensors to fit together, as place=channel: compartment=93,front=103 [default: compartment=<the pulse>]
    ///
    /// Places: compartment (the last mass), front or engine (the mass next to the barrier), chassis (the one in front of the
    /// compartment), m1, m2, ... A sensor in front tells the two dual double models apart. The motion of every channel
    /// comes from crumple-integrate (--channels there).
    #[arg(long, value_name = "PLACE=CHANNEL", value_delimiter = ',')]
    pub sensors: Vec<String>,

    /// Masses of the double and triple model in a fit: known, free (with the total known), or the bounds of every share,
    /// such as 0.1..0.4 [default: known]
    #[arg(long, value_name = "HOW")]
    pub fit_masses: Option<String>,

    /// Triple model: masses of engine, suspension and chassis, and compartment [default: the front mass halved, the rest]
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

    /// Uncertainty of the test mass, "10 kg normal" (standard deviation, also without the word) or "10 kg uniform" (half width):
    /// propagated to the parameters [default: 0 kg]
    #[arg(long, value_name = "MASS")]
    pub mass_uncertainty: Option<Uncertain<Mass>>,

    /// Uncertainty of the impact speed, e.g. "0.1 km/h uniform": propagated to crush and parameters [default: 0 m/s]
    #[arg(long, value_name = "SPEED")]
    pub speed_uncertainty: Option<Uncertain<Speed>>,

    /// Uncertainty of the zero level of every accelerometer, e.g. "0.05 g uniform": propagated likewise [default: 0 m/s^2]
    #[arg(long, value_name = "ACCELERATION")]
    pub bias_uncertainty: Option<Uncertain<Acceleration>>,

    /// Uncertainty of time zero, e.g. "0.5 ms uniform": propagated likewise [default: 0 s]
    #[arg(long, value_name = "TIME")]
    pub time_zero_uncertainty: Option<Uncertain<Time>>,

    /// Add the solutions that a paper lists, from its own printed numbers and as it typed them, labelled: tfest (both splits of
    /// the mass; 284.6 kg for 284.4 kg in one equation) [default: none]
    #[arg(long, value_name = "PAPER")]
    pub paper: Option<String>,

    /// Repetitions of the propagation of these uncertainties [default: 200]
    #[arg(long, value_name = "NUMBER")]
    pub repetitions: Option<usize>,

    /// Chains of masses to be fitted, stated in the pipeline file: `[parameter-solve.chain.<name>]`.
    #[arg(skip)]
    pub chain: toml::Table,
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
    l_shade_evaluations: u64,
    l_shade_seed: u64,
    fit_quantity: &'static str,
    /// Place and channel of each sensor.
    sensors: Vec<(String, String)>,
    fit_masses: Option<(f64, f64)>,
    triple_masses_kg: Option<[f64; 3]>,
    stay_attached: bool,
    /// The paper whose printed solutions are added.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paper: Option<&'static str>,
    #[serde(skip)]
    pub places: Vec<(Place, String)>,
    #[serde(flatten)]
    pub judging: Judging,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chain: Vec<FittedChain>,
    #[serde(skip)]
    pub solve: SolveSettings,
}

/// Replicates of an interval: none, or as many as have a 2.5 % quantile and the memory holds.
fn replicates(name: &str, count: usize) -> Result<usize, Usage> {
    if count == 0 || (20..=100_000).contains(&count) {
        return Ok(count);
    }
    Err(Usage::new(format!("{name} is {count}, expected 0 or a number from 20 to 100000")))
}

/// Named twice is meant once.
fn once<T: Copy + PartialEq>(named: &[T]) -> Vec<T> {
    named.iter().enumerate().filter(|(k, one)| !named[..*k].contains(one)).map(|(_, one)| *one).collect()
}

impl TryFrom<Options> for StageSettings {
    type Error = Usage;

    fn try_from(options: Options) -> Result<Self, Usage> {
        let models = if options.models.is_empty() {
            DEFAULT_MODELS.to_vec()
        } else {
            let named = options.models.iter().map(|name| model(name)).collect::<Result<Vec<_>, _>>()?;
            once(&named)
        };
        let methods = once(&options.method.iter().map(|name| method(name)).collect::<Result<Vec<_>, _>>()?);
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
        let l_shade = LShadeOptions {
            evaluations: options.l_shade_evaluations.unwrap_or(LShadeOptions::default().evaluations),
            seed: options.l_shade_seed.unwrap_or(LShadeOptions::default().seed),
        };
        let quantity = match options.fit_quantity.as_deref() {
            None => FitQuantity::default(),
            Some(name) => {
                name.parse().map_err(|_: String| unknown("quantity", name, &FitQuantity::ALL.map(FitQuantity::name)))?
            }
        };
        let paper = match options.paper.as_deref() {
            None => None,
            Some("tfest") => Some("tfest"),
            Some(other) => return Err(unknown("paper", other, &["tfest"])),
        };
        let places = options.sensors.iter().map(|text| sensor(text)).collect::<Result<Vec<_>, _>>()?;
        let mass_fit = mass_fit(options.fit_masses.as_deref())?;
        let triple = match options.triple_masses[..] {
            [] => None,
            [a, b, c] => Some([a.si(), b.si(), c.si()]),
            _ => {
                return Err(Usage::new(format!(
                    "triple-masses has {} masses, expected three",
                    options.triple_masses.len()
                ))
                .hint("--triple-masses 150kg,200kg,900kg: engine, suspension and chassis, compartment"));
            }
        };
        let solve = SolveSettings {
            triple,
            mass_fit,
            quantity,
            release: !options.stay_attached.unwrap_or(false),
            l_shade,
            models,
            methods,
            split,
            fit_from_s: options.fit_from.map_or(0.0, Time::si),
            fit_to_s: options.fit_to.map(Time::si),
            fit_samples: FIT_SAMPLES,
            fit_starts: FIT_STARTS,
            firefly,
        };
        let judging = Judging {
            profile: options.profile.unwrap_or(false),
            bootstrap: replicates("bootstrap", options.bootstrap.unwrap_or(0))?,
            mass_uncertainty_kg: options.mass_uncertainty.map_or(0.0, |u| u.size.si()),
            speed_uncertainty_m_per_s: options.speed_uncertainty.map_or(0.0, |u| u.size.si()),
            bias_uncertainty_m_per_s2: options.bias_uncertainty.map_or(0.0, |u| u.size.si()),
            time_zero_uncertainty_s: options.time_zero_uncertainty.map_or(0.0, |u| u.size.si()),
            distributions: [
                options.mass_uncertainty.map(|u| u.distribution).unwrap_or_default(),
                options.speed_uncertainty.map(|u| u.distribution).unwrap_or_default(),
                options.bias_uncertainty.map(|u| u.distribution).unwrap_or_default(),
                options.time_zero_uncertainty.map(|u| u.distribution).unwrap_or_default(),
            ],
            repetitions: replicates("repetitions", options.repetitions.unwrap_or(REPETITIONS))?,
        };
        Ok(Self {
            models: solve.models.iter().map(|m| m.name()).collect(),
            methods: if solve.methods.is_empty() {
                vec!["default"]
            } else {
                solve.methods.iter().map(|m| m.name()).collect()
            },
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
            l_shade_evaluations: l_shade.evaluations,
            l_shade_seed: l_shade.seed,
            fit_quantity: quantity.name(),
            sensors: places.iter().map(|(place, channel)| (place.to_string(), channel.clone())).collect(),
            fit_masses: match mass_fit {
                MassFit::Known => None,
                MassFit::Shares { lower, upper } => Some((lower, upper)),
            },
            triple_masses_kg: triple,
            stay_attached: !solve.release,
            paper,
            places,
            chain: Vec::new(),
            judging,
            solve,
        })
    }
}

fn model(name: &str) -> Result<ModelKind, Usage> {
    let choices: Vec<_> = MODELS.iter().map(|model| model.name()).collect();
    match name.parse() {
        Ok(kind) if MODELS.contains(&kind) => Ok(kind),
        Ok(kind) => Err(Usage::new(format!("there is no solver for the model {kind} yet"))
            .hint(format!("there are: {}", choices.join(", ")))),
        Err(_) => Err(unknown("model", name, &choices)),
    }
}

/// `front=103`.
fn sensor(text: &str) -> Result<(Place, String), Usage> {
    let hint = "--sensors compartment=93,front=103";
    let (place, channel) = text
        .split_once('=')
        .filter(|(_, channel)| !channel.is_empty())
        .ok_or_else(|| Usage::new(format!("sensor {text:?} is not place=channel")).hint(hint))?;
    Ok((place.parse().map_err(|error: String| Usage::new(error).hint(hint))?, channel.to_owned()))
}

/// `known`, `free` or `0.1..0.4`.
fn mass_fit(text: Option<&str>) -> Result<MassFit, Usage> {
    match text {
        None | Some("known") => Ok(MassFit::Known),
        Some("free") => Ok(MassFit::Shares { lower: FREE_SHARES.0, upper: FREE_SHARES.1 }),
        Some(text) => text
            .split_once("..")
            .and_then(|(low, high)| Some((low.parse().ok()?, high.parse().ok()?)))
            .filter(|(lower, upper)| *lower > 0.0 && lower < upper && *upper < 1.0)
            .map(|(lower, upper)| MassFit::Shares { lower, upper })
            .ok_or_else(|| {
                Usage::new(format!(
                    "fit-masses is {text:?}, expected known, free or bounds such as 0.1..0.4 within 0 and 1"
                ))
            }),
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
        let options = Options { models: vec!["quadruple-spring-mass-damper".to_owned()], ..Options::default() };
        assert!(StageSettings::try_from(options).unwrap_err().to_string().contains("unknown model"));
    }

    #[test]
    fn sensors_and_masses_are_read_or_refused() {
        assert_eq!(sensor("engine=103").unwrap(), (Place::Front, "103".to_owned()));
        assert_eq!(sensor("m2=7").unwrap(), (Place::Mass(2), "7".to_owned()));
        for text in ["103", "roof=103", "front=", "m0=3"] {
            assert!(sensor(text).is_err(), "{text}");
        }
        assert_eq!(mass_fit(Some("0.1..0.4")), Ok(MassFit::Shares { lower: 0.1, upper: 0.4 }));
        for text in ["0.4..0.1", "0..0.4", "loose", "0.1..NaN"] {
            assert!(mass_fit(Some(text)).is_err(), "{text}");
        }
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
            Options { fit_quantity: Some("velocity".to_owned()), ..Options::default() },
            Options { sensors: vec!["front=9".to_owned()], ..Options::default() },
            Options { fit_masses: Some("free".to_owned()), ..Options::default() },
            Options { triple_masses: vec![Mass::from_si(9.0); 3], ..Options::default() },
            Options { stay_attached: Some(true), ..Options::default() },
            Options { l_shade_evaluations: Some(9), ..Options::default() },
            Options { l_shade_seed: Some(9), ..Options::default() },
            Options { profile: Some(true), ..Options::default() },
            Options { bootstrap: Some(200), ..Options::default() },
            Options { mass_uncertainty: "10 kg".parse().ok(), ..Options::default() },
            Options { speed_uncertainty: "0.1 m/s".parse().ok(), ..Options::default() },
            Options { bias_uncertainty: "0.05 g uniform".parse().ok(), ..Options::default() },
            Options { time_zero_uncertainty: "0.5 ms".parse().ok(), ..Options::default() },
            Options { repetitions: Some(50), ..Options::default() },
        ] {
            assert_ne!(json(options), default);
        }
    }
}
