//! What the flags and keys of the stage come to, and how that stands in the provenance.

use crumple_lumped::ModelKind;
use crumple_lumped_fit::{
    AssessmentOptions, FireflyOptions, InputUncertainty, MassFit, MassSplit, Method, ONE_MASS_RATE_S_PER_M,
    SelectionRules, SolveSettings, TIME_ZERO_S,
};
use crumple_numerics::estimation::minimise::l_shade::LShadeOptions;
use crumple_signal::value::{Mass, Time};
use crumple_signal::{Distribution, Spread};
use crumple_stage::{Usage, option};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::stage::chains::FittedChain;
use crate::stage::options::{Named, Options, Paper, PlacedSensor};
use crate::stage::own_models::{AskedModel, StatedLaw, read_laws};

/// Between 15 and 35 % in front, transverse engines and long fronts alike.
const FRONT_MASS_UNCERTAINTY: f64 = 0.1;

/// Rate factor at most, s/m: the force is doubled at 10 m/s.
const MOST_RATE_S_PER_M: f64 = 0.1;
/// Options with every default filled in.
#[derive(Debug, Clone)]
pub struct StageSettings {
    /// Mass given by flag, kg.
    pub mass_kg: Option<f64>,
    /// Share of the mass in front, whether masses are given or not.
    pub front_mass_fraction: f64,
    /// The paper whose printed solutions are added.
    pub paper: Option<Paper>,
    /// The sensors, each on its place.
    pub places: Vec<PlacedSensor>,
    /// What is assessed beyond the covariance.
    pub assessment: AssessmentSettings,
    /// Chains to be fitted.
    pub chain: Vec<FittedChain>,
    /// Own models to be fitted.
    pub own: Vec<StatedLaw>,
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
    type Error = anyhow::Error;

    fn try_from(options: Options) -> anyhow::Result<Self> {
        let fraction = options.front_mass_fraction.unwrap_or(MassSplit::USUAL_FRONT);
        if !(fraction > 0.0 && fraction < 1.0) {
            return Err(
                Usage::new(format!("front-mass-fraction is {fraction}, expected a number between 0 and 1")).into()
            );
        }
        let default = SolveSettings::default();
        let family = |model: &Named<AskedModel>| if let AskedModel::Family(kind) = model.0 { Some(kind) } else { None };
        let named: Vec<ModelKind> = options.models.iter().filter_map(family).collect();
        if let Some(kind) = named.iter().find(|kind| !SolveSettings::all_models().contains(kind)) {
            let names: Vec<_> = SolveSettings::all_models().iter().map(|model| model.name()).collect();
            return Err(Usage::new(format!("there is no solver for the model {kind}"))
                .hint(format!("there are: {}", names.join(", ")))
                .into());
        }
        let methods: Vec<Method> = options.method.iter().map(|method| method.0).collect();
        let solve = SolveSettings {
            models: if options.models.is_empty() { default.models } else { once(&named) },
            methods: once(&methods),
            split: mass_split(&options),
            triple: triple_masses(&options)?,
            mass_fit: options.fit_masses.map_or(default.mass_fit, |how| how.0),
            quantity: options.fit_quantity.map_or(default.quantity, |quantity| quantity.0),
            rate_factor_s_per_m: rate_factor(options.rate_factor)?,
            release: !options.stay_attached.unwrap_or(false),
            fit_from_s: options.fit_from.map_or(default.fit_from_s, Time::si),
            fit_to_s: options.fit_to.map(Time::si),
            firefly: FireflyOptions {
                units: options.firefly_units.map_or(default.firefly.units, |units| units.0),
                generations: options.firefly_generations.unwrap_or(default.firefly.generations),
                seed: options.firefly_seed.unwrap_or(default.firefly.seed),
                ..default.firefly
            },
            l_shade: LShadeOptions {
                evaluations: options.l_shade_evaluations.unwrap_or(default.l_shade.evaluations),
                seed: options.l_shade_seed.unwrap_or(default.l_shade.seed),
            },
            ..default
        };
        let chain = options.chain.iter().map(|(name, table)| FittedChain::read(name, table));
        Ok(Self {
            chain: chain.collect::<Result<_, _>>()?,
            own: read_laws(&options.models)?,
            selection: selection_rules(&options)?,
            assessment: assessment_settings(&options)?,
            mass_kg: options.mass.map(Mass::si),
            front_mass_fraction: fraction,
            paper: options.paper,
            places: options.sensors.into_iter().map(|sensor| sensor.0).collect(),
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
        (None, None) => MassSplit::FrontFraction(options.front_mass_fraction.unwrap_or(MassSplit::USUAL_FRONT)),
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
            .hint(format!(
                "{}: engine, suspension and chassis, compartment",
                option("parameter-solve", "triple-masses", "150kg,200kg,900kg")
            )));
        }
    })
}

/// How far the share of the mass in front may be off: by default not at all where masses are given or fitted.
fn front_mass_uncertainty(options: &Options) -> Result<f64, Usage> {
    let split = mass_split(options);
    let (share, by_fraction) = match split {
        MassSplit::FrontFraction(share) => (share, true),
        _ => (MassSplit::USUAL_FRONT, false),
    };
    let fitted = options.fit_masses.is_some_and(|how| how.0 != MassFit::Known);
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

impl StageSettings {
    /// The same with the uncertainty of contact that the test states: for intervals, and where other inputs are
    /// uncertain for what is repeated.
    pub fn with_contact(&self, uncertainty_s: Option<Spread>) -> Self {
        let mut with = self.clone();
        if let Some(Spread { size, distribution }) = uncertainty_s {
            let of_intervals = &mut with.assessment.of_intervals;
            of_intervals.contact_s = size;
            of_intervals.distributions[3] = distribution;
        }
        let inputs = &mut with.assessment.inputs;
        if let Some(Spread { size, distribution }) = uncertainty_s.filter(|_| inputs.any()) {
            inputs.contact_s = size;
            inputs.distributions[3] = distribution;
        }
        with
    }
}

/// What is assessed beyond the covariance, and how uncertain the inputs are.
fn assessment_settings(options: &Options) -> Result<AssessmentSettings, Usage> {
    Ok(AssessmentSettings {
        front_mass_uncertainty: front_mass_uncertainty(options)?,
        profile: options.profile.unwrap_or(false),
        bootstrap: replicates("bootstrap", options.bootstrap.unwrap_or(0))?,
        inputs: InputUncertainty {
            mass_kg: options.mass_uncertainty.map_or(0.0, |u| u.size.si()),
            impact_speed_m_per_s: options.speed_uncertainty.map_or(0.0, |u| u.size.si()),
            bias_m_per_s2: options.bias_uncertainty.map_or(0.0, |u| u.size.si()),
            // The test states it.
            contact_s: 0.0,
            distributions: [
                options.mass_uncertainty.map(|u| u.distribution).unwrap_or_default(),
                options.speed_uncertainty.map(|u| u.distribution).unwrap_or_default(),
                options.bias_uncertainty.map(|u| u.distribution).unwrap_or_default(),
                Distribution::default(),
            ],
        },
        of_intervals: inputs_of_intervals(options),
        repetitions: replicates("repetitions", options.repetitions.unwrap_or(InputUncertainty::REPETITIONS))?,
    })
}

/// The inputs whose errors are in every interval: time zero and impact speed, as usual where nobody states them, and a
/// stated zero level.
fn inputs_of_intervals(options: &Options) -> InputUncertainty {
    let usual = Spread::USUAL_SPEED;
    let speed = options.speed_uncertainty.map_or(usual, |u| Spread { size: u.size.si(), distribution: u.distribution });
    let of_bias = options.bias_uncertainty.map(|u| u.distribution).unwrap_or_default();
    InputUncertainty {
        impact_speed_m_per_s: speed.size,
        bias_m_per_s2: options.bias_uncertainty.map_or(0.0, |u| u.size.si()),
        contact_s: TIME_ZERO_S,
        distributions: [Distribution::Normal, speed.distribution, of_bias, Distribution::Normal],
        mass_kg: 0.0,
    }
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
    let (plastic, of_restitution) = (options.plastic_prior, options.restitution_prior);
    let (deviation, lower_speeds, fit) =
        (options.restitution_deviation, options.lower_speed_limit, options.adequate_fit);
    Ok(SelectionRules {
        plastic_prior: number("plastic-prior", plastic, default.plastic_prior, (0.0, 1e3))?,
        restitution_prior: number("restitution-prior", of_restitution, default.restitution_prior, (0.01, 1.0))?,
        restitution_deviation: number("restitution-deviation", deviation, default.restitution_deviation, (0.0, 10.0))?,
        lower_speed_limit_percent: number(
            "lower-speed-limit",
            lower_speeds,
            default.lower_speed_limit_percent,
            (0.0, 100.0),
        )?,
        adequate_fit_percent: number("adequate-fit", fit, default.adequate_fit_percent, (0.0, 100.0))?,
        ..default
    })
}

// The settings as they stand in the provenance of an artifact: every default filled in, in names, numbers and SI units.

impl Serialize for StageSettings {
    /// This is part of the file format. Names and meaning of the entries stay when the settings of the code change.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (solve, asked, rules) = (&self.solve, &self.assessment, &self.selection);
        let (m1_kg, m2_kg) = match solve.split {
            MassSplit::FrontFraction(_) => (None, None),
            MassSplit::Front(m1) => (Some(m1), None),
            MassSplit::Rear(m2) => (None, Some(m2)),
            MassSplit::Both(m1, m2) => (Some(m1), Some(m2)),
        };
        let mut methods: Vec<&str> = solve.methods.iter().map(|method| method.name()).collect();
        if methods.is_empty() {
            methods.push("default");
        }
        let shares = match solve.mass_fit {
            MassFit::Known => None,
            MassFit::Shares { lower, upper } => Some((lower, upper)),
        };
        let places: Vec<(String, &str)> =
            self.places.iter().map(|sensor| (sensor.place.to_string(), sensor.channel.as_str())).collect();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("models", &solve.models.iter().map(|model| model.name()).collect::<Vec<_>>())?;
        map.serialize_entry("methods", &methods)?;
        map.serialize_entry("mass_kg", &self.mass_kg)?;
        map.serialize_entry("m1_kg", &m1_kg)?;
        map.serialize_entry("m2_kg", &m2_kg)?;
        map.serialize_entry("fit_to_s", &solve.fit_to_s)?;
        map.serialize_entry("fit_samples", &solve.fit_samples)?;
        map.serialize_entry("fit_starts", &solve.fit_starts)?;
        map.serialize_entry("firefly_units", &Named(solve.firefly.units))?;
        map.serialize_entry("firefly_generations", &solve.firefly.generations)?;
        map.serialize_entry("firefly_seed", &solve.firefly.seed)?;
        map.serialize_entry("l_shade_evaluations", &solve.l_shade.evaluations)?;
        map.serialize_entry("l_shade_seed", &solve.l_shade.seed)?;
        map.serialize_entry("fit_quantity", solve.quantity.name())?;
        map.serialize_entry("sensors", &places)?;
        map.serialize_entry("fit_masses", &shares)?;
        map.serialize_entry("triple_masses_kg", &solve.triple)?;
        map.serialize_entry("stay_attached", &!solve.release)?;
        map.serialize_entry("profile", &asked.profile)?;
        map.serialize_entry("bootstrap", &asked.bootstrap)?;
        map.serialize_entry("repetitions", &asked.repetitions)?;
        let numbers = [
            ("front_mass_fraction", self.front_mass_fraction),
            ("fit_from_s", solve.fit_from_s),
            ("front_mass_uncertainty", asked.front_mass_uncertainty),
            ("mass_uncertainty_kg", asked.inputs.mass_kg),
            ("interval_speed_deviation_m_per_s", asked.of_intervals.deviations()[1]),
            ("speed_uncertainty_m_per_s", asked.inputs.impact_speed_m_per_s),
            ("bias_uncertainty_m_per_s2", asked.inputs.bias_m_per_s2),
            ("plastic_prior", rules.plastic_prior),
            ("restitution_prior", rules.restitution_prior),
            ("restitution_deviation", rules.restitution_deviation),
            ("adequate_fit_percent", rules.adequate_fit_percent),
            ("lower_speed_limit_percent", rules.lower_speed_limit_percent),
            ("rate_factor_s_per_m", solve.rate_factor_s_per_m),
        ];
        numbers.iter().try_for_each(|(name, value)| map.serialize_entry(name, value))?;
        if asked.inputs.distributions != [Distribution::Normal; 4] {
            map.serialize_entry("distributions", &asked.inputs.distributions.map(Distribution::name))?;
        }
        if let Some(paper) = self.paper {
            map.serialize_entry("paper", &paper)?;
        }
        if !self.chain.is_empty() {
            map.serialize_entry("chain", &self.chain)?;
        }
        if !self.own.is_empty() {
            map.serialize_entry("own", &self.own)?;
        }
        map.end()
    }
}

// What is assessed beyond the covariance, and how uncertain the inputs are.

/// What is assessed beyond the covariance; part of the settings.
#[derive(Debug, Clone)]
pub struct AssessmentSettings {
    pub profile: bool,
    pub bootstrap: usize,
    /// Half width of the share of the mass in front; 0 where masses are given or fitted.
    pub front_mass_uncertainty: f64,
    /// How uncertain the inputs are, where that is stated: for what is repeated.
    pub inputs: InputUncertainty,
    /// How uncertain they are, stated or not: for the intervals.
    pub of_intervals: InputUncertainty,
    pub repetitions: usize,
}

impl AssessmentSettings {
    /// The flags that say how well parameters are known, as far as they are given.
    pub fn flags(&self) -> Vec<&'static str> {
        let inputs = [
            ("--mass-uncertainty", self.inputs.mass_kg),
            ("--speed-uncertainty", self.inputs.impact_speed_m_per_s),
            ("--bias-uncertainty", self.inputs.bias_m_per_s2),
        ];
        let switches = [("--profile", self.profile), ("--bootstrap", self.bootstrap > 0)];
        let switches = switches.into_iter().filter(|(_, given)| *given).map(|(flag, _)| flag);
        switches.chain(inputs.into_iter().filter(|(_, value)| *value > 0.0).map(|(flag, _)| flag)).collect()
    }

    /// What looks from a minimum.
    pub fn options(&self) -> AssessmentOptions {
        AssessmentOptions { profile: self.profile, bootstrap: self.bootstrap }
    }

    /// Refuses uncertainties of which a draw could make the mass or the speed zero.
    pub fn check(&self, mass_kg: Option<f64>, impact_speed_m_per_s: f64) -> Result<(), Usage> {
        let reaches = |flag: &str, size: f64, distribution: Distribution, value: f64, unit: &str| {
            let largest = distribution.largest();
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
        let [of_mass, of_speed, ..] = self.inputs.distributions;
        if let Some(mass_kg) = mass_kg {
            reaches("mass-uncertainty", self.inputs.mass_kg, of_mass, mass_kg, "kg")?;
        }
        reaches("speed-uncertainty", self.inputs.impact_speed_m_per_s, of_speed, impact_speed_m_per_s, "m/s")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped_fit::SensorPlace;

    #[test]
    fn a_mistyped_method_or_model_is_refused_with_those_that_there_are() {
        let error = toml::from_str::<Options>("method = [\"closed-from\"]").unwrap_err().to_string();
        assert!(error.contains("unknown method \"closed-from\", expected one of closed-form"), "{error}");
        assert!(toml::from_str::<Options>("models = [\"quadruple\"]").is_err());
        let options = Options { models: vec![Named(AskedModel::Family(ModelKind::Chain))], ..Options::default() };
        assert!(StageSettings::try_from(options).unwrap_err().to_string().contains("no solver for the model chain"));
    }

    #[test]
    fn sensors_and_masses_are_read_or_refused() {
        let sensor = |place, channel: &str| Ok(PlacedSensor { place, channel: channel.to_owned() });
        assert_eq!("engine=103".parse(), sensor(SensorPlace::Front, "103"));
        assert_eq!("m2=7".parse(), sensor(SensorPlace::Mass(2), "7"));
        for text in ["103", "roof=103", "front=", "m0=3"] {
            assert!(text.parse::<PlacedSensor>().is_err(), "{text}");
        }
        assert_eq!("0.1..0.4".parse(), Ok(MassFit::Shares { lower: 0.1, upper: 0.4 }));
        for text in ["0.4..0.1", "0..0.4", "loose", "0.1..NaN"] {
            assert!(text.parse::<MassFit>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_share_of_the_mass_is_uncertain_where_it_is_assumed() {
        let half =
            |options| StageSettings::try_from(options).map(|settings| settings.assessment.front_mass_uncertainty).ok();
        assert_eq!(half(Options::default()), Some(0.1));
        assert_eq!(half(Options { front_mass_fraction: Some(0.3), ..Options::default() }), Some(0.0));
        assert_eq!(half(Options { m1: Some(Mass::from_si(300.0)), ..Options::default() }), Some(0.0));
        assert_eq!(half(Options { fit_masses: "free".parse().ok(), ..Options::default() }), Some(0.0));
        assert_eq!(half(Options { front_mass_uncertainty: Some(0.0), ..Options::default() }), Some(0.0));
        let given =
            Options { front_mass_fraction: Some(0.3), front_mass_uncertainty: Some(0.05), ..Options::default() };
        assert_eq!(half(given), Some(0.05));
        assert_eq!(half(Options { front_mass_uncertainty: Some(0.25), ..Options::default() }), None);
        let masses =
            Options { m1: Some(Mass::from_si(300.0)), front_mass_uncertainty: Some(0.1), ..Options::default() };
        assert_eq!(half(masses), None);
    }

    #[test]
    fn everything_that_changes_the_result_is_in_the_provenance() {
        let json = |options| serde_json::to_string(&StageSettings::try_from(options).unwrap()).unwrap();
        let default = json(Options::default());
        for options in [
            Options { models: vec![Named(AskedModel::Family(ModelKind::Kelvin))], ..Options::default() },
            Options { method: vec![Named(Method::ClosedForm)], ..Options::default() },
            Options { mass: Some(Mass::from_si(900.0)), ..Options::default() },
            Options { m1: Some(Mass::from_si(900.0)), ..Options::default() },
            Options { m2: Some(Mass::from_si(900.0)), ..Options::default() },
            Options { front_mass_fraction: Some(0.3), ..Options::default() },
            Options { front_mass_uncertainty: Some(0.05), ..Options::default() },
            Options { fit_from: Some(Time::from_si(0.01)), ..Options::default() },
            Options { fit_to: Some(Time::from_si(0.05)), ..Options::default() },
            Options { fit_quantity: "velocity".parse().ok(), ..Options::default() },
            Options { sensors: vec!["front=9".parse().unwrap()], ..Options::default() },
            Options { fit_masses: "free".parse().ok(), ..Options::default() },
            Options { triple_masses: vec![Mass::from_si(9.0); 3], ..Options::default() },
            Options { stay_attached: Some(true), ..Options::default() },
            Options { l_shade_evaluations: Some(9), ..Options::default() },
            Options { l_shade_seed: Some(9), ..Options::default() },
            Options { profile: Some(true), ..Options::default() },
            Options { bootstrap: Some(200), ..Options::default() },
            Options { mass_uncertainty: "10 kg".parse().ok(), ..Options::default() },
            Options { speed_uncertainty: "0.1 m/s".parse().ok(), ..Options::default() },
            Options { bias_uncertainty: "0.05 g uniform".parse().ok(), ..Options::default() },
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

    #[test]
    fn the_contact_of_the_test_is_uncertain_where_another_input_is() {
        let of_test = Some(Spread { size: 5e-4, distribution: Distribution::Uniform });
        let with = |options: Options| StageSettings::try_from(options).unwrap().with_contact(of_test).assessment.inputs;
        assert!(!with(Options::default()).any());
        let inputs = with(Options { mass_uncertainty: "10 kg".parse().ok(), ..Options::default() });
        assert_eq!((inputs.contact_s, inputs.distributions[3]), (5e-4, Distribution::Uniform));
    }
}
