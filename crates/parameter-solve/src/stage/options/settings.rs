//! What the flags and keys of the stage come to.

use crumple_lumped::ModelKind;
use crumple_lumped_fit::{
    DEFAULT_MODELS, FRONT_MASS_FRACTION, FireflyOptions, FireflyUnits, FitQuantity, LShadeOptions, METHODS, MODELS,
    MassFit, MassSplit, Method, ONE_MASS_RATE_S_PER_M, REPETITIONS, SelectionRules, SensorPlace, SolveSettings,
};
use crumple_signal::value::{Mass, Time};
use crumple_stage::{Usage, nearest};

use crate::stage::options::assessment::AssessmentSettings;
use crate::stage::options::chain_table::FittedChain;
use crate::stage::options::flags::Options;

/// Between 15 and 35 % in front, transverse engines and long fronts alike.
const FRONT_MASS_UNCERTAINTY: f64 = 0.1;

/// Rate factor at most, s/m: the force is doubled at 10 m/s.
const MOST_RATE_S_PER_M: f64 = 0.1;
/// Shares of masses that are free.
const FREE_SHARES: (f64, f64) = (0.02, 0.95);

/// Options with every default filled in. What of it goes to the provenance, and in which words, is in `provenance`.
#[derive(Debug, Clone)]
pub struct StageSettings {
    /// Mass given by flag, kg.
    pub mass_kg: Option<f64>,
    /// Share of the mass in front, whether masses are given or not.
    pub front_mass_fraction: f64,
    /// The paper whose printed solutions are added.
    pub paper: Option<&'static str>,
    /// Place and channel of each sensor.
    pub places: Vec<(SensorPlace, String)>,
    /// What is assessed beyond the covariance.
    pub assessment: AssessmentSettings,
    /// Chains to be fitted.
    pub chain: Vec<FittedChain>,
    /// What the library is asked for.
    pub solve: SolveSettings,
    /// How a candidate is chosen.
    pub selection: SelectionRules,
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
        let split = mass_split(&options);
        let units = match options.firefly_units.as_deref() {
            None | Some("unit") => FireflyUnits::Unit,
            Some("physical") => FireflyUnits::Physical,
            Some(other) => return Err(unknown("firefly-units", other, &["physical", "unit"])),
        };
        let firefly = firefly(&options, units);
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
        let triple = triple_masses(&options)?;
        let solve = SolveSettings {
            triple,
            mass_fit,
            quantity,
            rate_factor_s_per_m: rate_factor(options.rate_factor)?,
            release: !options.stay_attached.unwrap_or(false),
            l_shade,
            models,
            methods,
            split,
            fit_from_s: options.fit_from.map_or(0.0, Time::si),
            fit_to_s: options.fit_to.map(Time::si),
            firefly,
            ..SolveSettings::default()
        };
        let assessment = assessment_settings(&options)?;
        let selection = selection_rules(&options)?;
        Ok(Self {
            selection,
            mass_kg: options.mass.map(Mass::si),
            front_mass_fraction: fraction.unwrap_or(FRONT_MASS_FRACTION),
            paper,
            places,
            chain: Vec::new(),
            assessment,
            solve,
        })
    }
}

/// How the mass divides, by the flags given.
fn mass_split(options: &Options) -> MassSplit {
    match (options.m1.map(Mass::si), options.m2.map(Mass::si)) {
        (Some(m1), Some(m2)) => MassSplit::Both(m1, m2),
        (Some(m1), None) => MassSplit::Front(m1),
        (None, Some(m2)) => MassSplit::Rear(m2),
        (None, None) => MassSplit::FrontFraction(options.front_mass_fraction.unwrap_or(FRONT_MASS_FRACTION)),
    }
}

/// The firefly search: what is not given is as printed.
fn firefly(options: &Options, units: FireflyUnits) -> FireflyOptions {
    let printed = FireflyOptions::default();
    FireflyOptions {
        units,
        generations: options.firefly_generations.unwrap_or(printed.generations),
        seed: options.firefly_seed.unwrap_or(printed.seed),
        ..printed
    }
}

/// The three masses of the triple model, where they are given.
fn triple_masses(options: &Options) -> Result<Option<[f64; 3]>, Usage> {
    Ok(match options.triple_masses[..] {
        [] => None,
        [a, b, c] => Some([a.si(), b.si(), c.si()]),
        _ => {
            return Err(Usage::new(format!(
                "triple-masses has {} masses, expected three",
                options.triple_masses.len()
            ))
            .hint("--triple-masses 150kg,200kg,900kg: engine, suspension and chassis, compartment"));
        }
    })
}

/// How far the share of the mass in front may be off: by default not at all where masses are given or fitted.
fn front_mass_uncertainty(options: &Options) -> Result<f64, Usage> {
    let split = mass_split(options);
    let (share, by_fraction) = match split {
        MassSplit::FrontFraction(share) => (share, true),
        _ => (FRONT_MASS_FRACTION, false),
    };
    let fitted = options.fit_masses.as_deref().is_some_and(|how| how != "known");
    let assumed = by_fraction && options.front_mass_fraction.is_none() && !fitted;
    match options.front_mass_uncertainty {
        None => Ok(if assumed { FRONT_MASS_UNCERTAINTY } else { 0.0 }),
        Some(half) if !(half >= 0.0 && half < share.min(1.0 - share)) => Err(Usage::new(format!(
            "front-mass-uncertainty is {half} of a share of {share}, expected at least 0 and less than {}",
            share.min(1.0 - share)
        ))),
        Some(half) if half > 0.0 && (!by_fraction || fitted) => Err(Usage::new(format!(
            "front-mass-uncertainty is {half}, but the masses are {}",
            if fitted { "fitted" } else { "given" }
        ))),
        Some(half) => Ok(half),
    }
}

/// What is assessed beyond the covariance, and how uncertain the inputs are.
fn assessment_settings(options: &Options) -> Result<AssessmentSettings, Usage> {
    Ok(AssessmentSettings {
        front_mass_uncertainty: front_mass_uncertainty(options)?,
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
    })
}

/// Rate factor of a force-deflection curve, s/m.
fn rate_factor(given: Option<f64>) -> Result<f64, Usage> {
    match given {
        Some(rate) if !(0.0..=MOST_RATE_S_PER_M).contains(&rate) => {
            Err(Usage::new(format!("rate-factor is {rate}, expected s/m from 0 to {MOST_RATE_S_PER_M}")))
        }
        given => Ok(given.unwrap_or(ONE_MASS_RATE_S_PER_M)),
    }
}

/// How a candidate is chosen.
fn selection_rules(options: &Options) -> Result<SelectionRules, Usage> {
    let default = SelectionRules::default();
    let number = |name: &str, given: Option<f64>, default: f64, (low, high): (f64, f64)| match given {
        Some(value) if !(value >= low && value <= high) => {
            Err(Usage::new(format!("{name} is {value}, expected a number from {low} to {high}")))
        }
        given => Ok(given.unwrap_or(default)),
    };
    Ok(SelectionRules {
        plastic_prior: number("plastic-prior", options.plastic_prior, default.plastic_prior, (0.0, 1e3))?,
        restitution_prior: number(
            "restitution-prior",
            options.restitution_prior,
            default.restitution_prior,
            (0.01, 1.0),
        )?,
        restitution_deviation: number(
            "restitution-deviation",
            options.restitution_deviation,
            default.restitution_deviation,
            (0.0, 10.0),
        )?,
        lower_speed_limit_percent: number(
            "lower-speed-limit",
            options.lower_speed_limit,
            default.lower_speed_limit_percent,
            (0.0, 100.0),
        )?,
        adequate_fit_percent: number("adequate-fit", options.adequate_fit, default.adequate_fit_percent, (0.0, 100.0))?,
        ..default
    })
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
fn sensor(text: &str) -> Result<(SensorPlace, String), Usage> {
    let hint = "--sensors compartment=93,front=103,wall";
    if text == "wall" {
        return Ok((SensorPlace::Wall, "barrier/force".to_owned()));
    }
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
        assert_eq!(sensor("engine=103").unwrap(), (SensorPlace::Front, "103".to_owned()));
        assert_eq!(sensor("m2=7").unwrap(), (SensorPlace::Mass(2), "7".to_owned()));
        for text in ["103", "roof=103", "front=", "m0=3"] {
            assert!(sensor(text).is_err(), "{text}");
        }
        assert_eq!(mass_fit(Some("0.1..0.4")), Ok(MassFit::Shares { lower: 0.1, upper: 0.4 }));
        for text in ["0.4..0.1", "0..0.4", "loose", "0.1..NaN"] {
            assert!(mass_fit(Some(text)).is_err(), "{text}");
        }
    }

    #[test]
    fn a_share_of_the_mass_is_uncertain_where_it_is_assumed() {
        let half =
            |options| StageSettings::try_from(options).map(|settings| settings.assessment.front_mass_uncertainty);
        assert_eq!(half(Options::default()), Ok(0.1));
        assert_eq!(half(Options { front_mass_fraction: Some(0.3), ..Options::default() }), Ok(0.0));
        assert_eq!(half(Options { m1: Some(Mass::from_si(300.0)), ..Options::default() }), Ok(0.0));
        assert_eq!(half(Options { fit_masses: Some("free".to_owned()), ..Options::default() }), Ok(0.0));
        assert_eq!(half(Options { front_mass_uncertainty: Some(0.0), ..Options::default() }), Ok(0.0));
        let given =
            Options { front_mass_fraction: Some(0.3), front_mass_uncertainty: Some(0.05), ..Options::default() };
        assert_eq!(half(given), Ok(0.05));
        assert!(half(Options { front_mass_uncertainty: Some(0.25), ..Options::default() }).is_err());
        let masses =
            Options { m1: Some(Mass::from_si(300.0)), front_mass_uncertainty: Some(0.1), ..Options::default() };
        assert!(half(masses).is_err());
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
            Options { front_mass_uncertainty: Some(0.05), ..Options::default() },
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
            Options { plastic_prior: Some(0.0), ..Options::default() },
            Options { restitution_prior: Some(0.1), ..Options::default() },
            Options { restitution_deviation: Some(0.5), ..Options::default() },
            Options { adequate_fit: Some(95.0), ..Options::default() },
            Options { rate_factor: Some(0.008), ..Options::default() },
            Options { lower_speed_limit: Some(2.0), ..Options::default() },
        ] {
            assert_ne!(json(options), default);
        }
    }
}
