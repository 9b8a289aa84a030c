//! A parameter set with how it was found, how it was fitted and how well it is known, and its parameters in words.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use crumple_lumped::{Chain, Model, ParameterKind, parameter_kind};
use crumple_numerics::estimation::minimise::StopReason;
use crumple_numerics::estimation::work::Work;
use crumple_signal::Note;
use nalgebra::DMatrix;

use crate::closed_form::unloads_rigidly;
use crate::coordinates::Coordinates;
use crate::parameters::{FitParameter, mass_of};
use crate::record::observation::{MOST_WORK, Observation, ObservedWave};
use crate::record::sensor::{FitQuantity, SensorFit, SensorPlace, errors_in_words, note_of_errors};

/// How parameters are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Method {
    /// From the events of the crash, by formula.
    ClosedForm,
    /// By fitting the response to the record.
    DirectFit,
    /// From the characteristic polynomial of an identified model.
    CoefficientMatching,
    /// From exponents and amplitudes as the ERA paper does it, for reproduction.
    CurveFit,
    /// By the firefly search of the single-mass paper.
    Firefly,
    /// By the general global search, ended by a descent.
    LShade,
    /// By the interior-point method of the single-mass paper.
    InteriorPoint,
}

/// Name in candidate ids and pipeline files, and what the method is in a few words, in the order of the variants. The
/// names are part of the file format.
const TABLE: [(Method, &str, &str); 7] = [
    (Method::ClosedForm, "closed-form", "from the crash events"),
    (Method::DirectFit, "direct-fit", "to the motion of the test"),
    (Method::CoefficientMatching, "coefficient-matching", "from an identified model with four poles: every solution"),
    (Method::CurveFit, "curve-fit", "from four real exponentials, as the ERA paper prints it: for reproduction only"),
    (Method::Firefly, "firefly", "population search of the single-mass paper"),
    (Method::LShade, "l-shade", "general global search, then a descent"),
    (Method::InteriorPoint, "interior-point", "side constraints as in the single-mass paper"),
];

impl Method {
    /// All methods.
    pub const ALL: [Self; TABLE.len()] = {
        let mut methods = [Self::ClosedForm; TABLE.len()];
        let mut k = 0;
        while k < TABLE.len() {
            methods[k] = TABLE[k].0;
            k += 1;
        }
        methods
    };

    /// The name in candidate ids and pipeline files.
    pub const fn name(self) -> &'static str {
        TABLE[self as usize].1
    }

    /// What it is, in a few words.
    pub const fn about(self) -> &'static str {
        TABLE[self as usize].2
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|m| m.name() == text)
            .ok_or_else(|| format!("unknown method {text:?}, expected one of {}", Self::ALL.map(Self::name).join(", ")))
    }
}

// The minimum of a misfit as measured: what a candidate is made from and assessed by.

/// A model at the minimum of its misfit, with the sensitivities there. Metres stand for the unit of the first wave.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The model.
    pub model: Model,
    /// Its free parameters.
    pub free: Vec<FitParameter>,
    /// Index of the mass that is the rest of a known total.
    pub(crate) rest: Option<usize>,
    /// Which of them stopped on a bound.
    pub on_bound: Vec<bool>,
    /// The waves it was fitted to, with their weights.
    pub observed: Observation,
    /// Model minus record, m.
    pub misfit_m: Vec<f64>,
    /// Change of the displacement by each free parameter's coordinate, m; columns as `free`.
    pub sensitivity_m: DMatrix<f64>,
    /// Model evaluations spent.
    pub evaluations: u64,
    /// Iterations.
    pub iterations: u32,
    /// Why it stopped.
    pub stop_reason: StopReason,
}

impl Minimum {
    /// Bounds the work on it to that of so many fits.
    pub fn limit_work(&mut self, fits: usize) {
        self.observed.set_work(&Work::limited(MOST_WORK.saturating_mul(fits as u64)));
    }

    /// Without such a bound.
    pub fn release_work(&mut self) {
        self.observed.set_work(&Work::default());
    }

    /// Root mean square misfit, m.
    pub fn rmse_m(&self) -> f64 {
        (self.misfit_m.iter().map(|r| r * r).sum::<f64>() / self.misfit_m.len() as f64).sqrt()
    }

    /// The fit repeated with other waves or values, from these coordinates and without leaving the minimum.
    pub(crate) fn coordinates(&self) -> Coordinates {
        Coordinates::new(self.model.clone(), self.free.clone()).with_rest(self.rest, mass_of(&self.model))
    }

    /// The free parameters as they are described at their values here.
    pub(crate) fn redescribed(&self) -> Vec<FitParameter> {
        let values = self.model.values();
        self.free.iter().map(|p| p.described_at(values[p.index])).collect()
    }

    /// Names of what was free; a mass that is the rest of the total comes last.
    pub fn free_names(&self) -> Vec<String> {
        let coordinates = self.coordinates();
        let rest = coordinates.free_rest(&coordinates.start()).map(|(name, _)| name);
        coordinates.names().into_iter().chain(rest).collect()
    }

    /// Names of the free parameters that stopped on a bound.
    pub(crate) fn names_on_bound(&self) -> impl Iterator<Item = String> {
        let stopped = self.free.iter().zip(&self.on_bound).filter(|(_, on_bound)| **on_bound);
        stopped.map(|(p, _)| p.name.to_string())
    }
}

// A parameter set with the record of how it was fitted.
//
// A [`Candidate`] is one answer for one model by one method. A record can have several: dual models, other minima,
// other roots of a polynomial. They are numbered by `index`, and none is left out because another fits as well.

/// One set of parameters, with how it was found and what was assumed.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The model with its parameters.
    pub model: Model,
    /// How they were found.
    pub method: Method,
    /// Name of the chain that a person stated, if it is a fit of one: it stands in the place of the method in its id.
    pub stated: Option<String>,
    /// Place among the solutions of this model and method, from 1.
    pub index: usize,
    /// Index of another solution of the same model and method that gives exactly the same record.
    pub equivalent_to: Option<usize>,
    /// Another solution that gives exactly the same record, and that what was stated or a bound leaves out.
    pub excluded_dual: Option<Chain>,
    /// Whether masses were fitted and no wave is of another mass than the last: their division is then in the record
    /// by a formula, and in practice not.
    pub division_undecided: bool,
    /// How it was fitted; `None` for a closed form.
    pub fit: Option<Fit>,
    /// Standard deviations that the method brings along, such as those of matched coefficients.
    pub uncertainty: Option<Uncertainty>,
    /// The minimum of the misfit as measured at these values, or nearest to them: what they are assessed by. `None`
    /// without a record.
    pub minimum: Option<Minimum>,
    /// How well its parameters are known, once it was assessed.
    pub assessed: Option<Assessed>,
    /// Reductions and assumptions, in words.
    pub notes: Vec<Note>,
}

impl Candidate {
    /// Number `index` of these parameters, without a fit or an equivalent.
    pub fn new(model: Model, method: Method, index: usize, notes: Vec<Note>) -> Self {
        Self {
            model,
            method,
            stated: None,
            index,
            equivalent_to: None,
            excluded_dual: None,
            division_undecided: false,
            fit: None,
            uncertainty: None,
            minimum: None,
            assessed: None,
            notes,
        }
    }

    /// `<model>/<method>/<index>`, of a chain `chain/<name>/<index>`.
    pub fn id(&self) -> String {
        self.id_of(self.index)
    }

    /// Id of the candidate it is equivalent to.
    pub fn equivalent_id(&self) -> Option<String> {
        self.equivalent_to.map(|index| self.id_of(index))
    }

    /// Whether the values are those of a fit at its minimum, and not only near one.
    pub fn is_at_minimum(&self) -> bool {
        self.fit.is_some() && self.minimum.as_ref().is_some_and(|minimum| minimum.model == self.model)
    }

    /// Fitted to something else than the displacement of the pulse.
    pub fn is_of_sensors(&self) -> bool {
        self.fit.as_ref().is_some_and(|fit| fit.quantity != FitQuantity::Displacement || !fit.sensors.is_empty())
    }

    /// Parameters that the fit left on a bound of the search.
    pub fn fixed_at_bound(&self) -> Vec<&str> {
        self.fit.as_ref().map_or_else(Vec::new, |fit| fixed_at_bound(&self.model, &fit.active_bounds, fit.to_s))
    }

    /// The name that stands for how it was found, in its id and its record: the method, or that of the stated chain.
    pub fn found_by(&self) -> &str {
        self.stated.as_deref().unwrap_or(self.method.name())
    }

    /// Names of its parameters in words, separated by commas: see `in_words`.
    pub fn in_words<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> String {
        all_in_words(&self.model, names)
    }

    /// Whether it unloads along the line that stands for a rigid one, which is no number of the record.
    pub fn unloads_rigidly(&self) -> bool {
        self.method == Method::ClosedForm && matches!(&self.model, Model::Elastoplastic(m) if unloads_rigidly(m))
    }

    /// Whether it is compared through the filter of its record.
    pub fn is_as_measured(&self) -> bool {
        self.minimum.as_ref().is_some_and(|minimum| minimum.observed.is_as_measured())
    }

    fn id_of(&self, index: usize) -> String {
        format!("{}/{}/{index}", self.model.kind(), self.found_by())
    }
}

/// Record of a fit by iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Window, s after time zero.
    pub from_s: f64,
    /// End of the window: time of the last sample used.
    pub to_s: f64,
    /// Samples used.
    pub samples: usize,
    /// What was fitted.
    pub quantity: FitQuantity,
    /// Root mean square error over them, unit of the quantity; of several sensors that of the first.
    pub rmse: f64,
    /// Iterations of the descent that ended here, on the thinned and on the whole window.
    pub iterations: u32,
    /// Model evaluations of all starts.
    pub evaluations: u64,
    /// Why the best start stopped.
    pub stop_reason: StopReason,
    /// Names of the parameters that stopped on a bound.
    pub active_bounds: Vec<String>,
    /// How far each sensor was missed; none where the compartment's displacement alone was fitted.
    pub sensors: Vec<SensorFit>,
}

impl Fit {
    /// The record of a fit to waves with these root mean square errors, each in its unit. `sensors`: channel and number
    /// of the mass of each wave, none where they are not told apart; `descent`: iterations, evaluations and why it
    /// stopped.
    pub(crate) fn of_waves(
        observed: &Observation,
        rmse: &[f64],
        sensors: Vec<(String, usize)>,
        descent: (u32, u64, StopReason),
        active_bounds: Vec<String>,
    ) -> Self {
        let (first, level) = (&observed.waves[0], observed.noise_levels(rmse)[0]);
        let sensor = |(((channel, mass), rmse), wave): (((String, usize), &f64), &ObservedWave)| SensorFit {
            channel,
            mass,
            quantity: wave.quantity,
            rmse: *rmse,
            noise: level / wave.weight,
        };
        let (iterations, evaluations, stop_reason) = descent;
        Self {
            from_s: first.time_s(0),
            to_s: first.time_s(first.samples.len() - 1),
            samples: observed.rows(),
            quantity: first.quantity,
            rmse: rmse[0],
            iterations,
            evaluations,
            stop_reason,
            active_bounds,
            sensors: sensors.into_iter().zip(rmse).zip(&observed.waves).map(sensor).collect(),
        }
    }

    /// The remark on the root mean square error of each sensor, which sit on these places in their order.
    pub fn errors_remark(&self, places: impl IntoIterator<Item = SensorPlace>) -> String {
        let errors = self.sensors.iter().zip(places);
        let errors = errors.map(|(fit, place)| (fit.rmse, fit.quantity, fit.channel.as_str(), place.to_string()));
        note_of_errors(&errors_in_words(errors), None)
    }
}

/// Standard deviations to first order that a method brings along.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// What it was made from, in words.
    pub method: &'static str,
    /// Standard deviation by parameter, in its unit; a parameter on a bound has none.
    pub standard_deviation: BTreeMap<&'static str, f64>,
    /// Condition number of the sensitivity matrix, columns scaled to one length.
    pub condition: f64,
    /// Lag-1 autocorrelation of the residuals that entered; `None` where none did.
    pub residual_autocorrelation: Option<f64>,
}

/// The note on parameters that stopped on a bound; `None` where none did.
///
/// Zero is the limit of what is physical, and an answer: a damper of zero is a spring alone. Any other bound is that
/// of the search: the value is the bound's and nothing of the record.
pub(crate) fn bounds_remark(model: &Model, active_bounds: &[impl AsRef<str>]) -> Option<String> {
    let names = active_bounds.iter().map(AsRef::as_ref);
    let (zero, other): (Vec<&str>, Vec<&str>) = names.partition(|name| model.value(name) == Some(0.0));
    let zero = (!zero.is_empty()).then(|| format!("zero, the lowest possible value: {}", all_in_words(model, zero)));
    let other = (!other.is_empty())
        .then(|| format!("parameters at a search limit, not identifiable: {}", all_in_words(model, other)));
    match (zero, other) {
        (Some(zero), Some(other)) => Some(format!("{zero}; {other}")),
        (zero, other) => zero.or(other),
    }
}

/// A damper of a chain below this share of `M/T`, of the mass and the window of a fit, stands for none: the least that
/// searches in logarithms reach is 1e-5 of it.
const NO_DAMPER: f64 = 1e-4;

/// Of the parameters on a bound those whose bound is not zero: the value is that of the search, so it is fixed in the
/// fit and has no interval. A damper of a chain of masses (the Kelvin model is one) on its lower bound is not fixed:
/// it goes to zero. `window_s`: end of the window, s after contact.
pub(crate) fn fixed_at_bound<'a>(model: &Model, on_bound: &'a [impl AsRef<str>], window_s: f64) -> Vec<&'a str> {
    let is_chain =
        matches!(model, Model::Kelvin(_) | Model::DoubleSpringMassDamper(_) | Model::TripleSpringMassDamper(_));
    let least = if is_chain { NO_DAMPER * mass_of(model) / window_s } else { 0.0 };
    let is_damper = |name: &str| model.parameter_kind(name) == Some(ParameterKind::Damping);
    let nothing = |name: &str| if is_damper(name) { least } else { 0.0 };
    let is_fixed = |name: &&str| model.value(name).is_some_and(|value| value > nothing(name));
    on_bound.iter().map(AsRef::as_ref).filter(is_fixed).collect()
}

// Names of parameters for notes and messages, made from their kind.

/// The name of a parameter in a sentence: `stiffness k2 at 0.31 m`, `damping c1 at rest`, `unloading stiffness`,
/// `mass m1`.
///
/// A value at a knot of a nonlinear model is named with the place of its knot, m or m/s: the first spring knot is at
/// contact, the first damper knot at rest. A name that the model does not have is given without its unit.
pub(crate) fn in_words(model: &Model, name: &str) -> String {
    let parameter = model.kind().parameter(name);
    let kind = parameter.map(|parameter| parameter.kind).or_else(|| parameter_kind("", name));
    let Some(kind) = kind else { return name.replace('_', " ") };
    let stem = kind.symbol_of(name).replace('_', " ");
    let length = |m: f64| format!("at {m:.3} m");
    let speed = |v: f64| format!("at {v:.2} m/s");
    let at_contact = || "at contact".to_owned();
    let at_rest = || "at rest".to_owned();
    if let Model::LoadPaths(_) = model
        && let Some((path, rest)) = stem.split_once(' ')
    {
        return match (kind, rest.strip_prefix("knot")) {
            (ParameterKind::Force, Some(number)) => format!("force at knot {number} of the {path} load path"),
            (ParameterKind::Length, Some(number)) => format!("deflection of knot {number} of the {path} load path"),
            (ParameterKind::RateFactor, _) => format!("rate factor of the {path} load path"),
            _ => format!("unloading stiffness of the {path} load path"),
        };
    }
    match (kind, stem.strip_prefix("knot")) {
        (ParameterKind::Force, Some(number)) => return format!("force at knot {number}"),
        (ParameterKind::Length, Some(number)) => return format!("deflection of knot {number}"),
        (ParameterKind::RateFactor, _) => return "rate factor".to_owned(),
        _ => {}
    }
    let place = match (model, stem.as_str()) {
        (Model::Nonlinear1(_) | Model::Nonlinear2(_), "k1") => Some(at_contact()),
        (Model::Nonlinear1(_) | Model::Nonlinear2(_), "c1") => Some(at_rest()),
        (Model::Nonlinear1(m), "k2") => Some(length(m.crush_m)),
        (Model::Nonlinear1(m), "c2") => Some(speed(m.v_thresh_m_per_s)),
        (Model::Nonlinear1(m), "c3") => Some(speed(m.v0_m_per_s)),
        (Model::Nonlinear2(m), "k2") => Some(length(m.x1_m)),
        (Model::Nonlinear2(m), "k3") => Some(length(m.crush_m)),
        (Model::Nonlinear2(m), "c2") => Some(speed(m.v1_m_per_s)),
        (Model::Nonlinear2(m), "c3") => Some(speed(m.v2_m_per_s)),
        (Model::Nonlinear2(m), "c4") => Some(speed(m.v0_m_per_s)),
        _ => None,
    };
    let is_numbered = matches!(stem.as_bytes(), [_, digit] if digit.is_ascii_digit());
    let kind = match kind {
        ParameterKind::Rate if !is_numbered => return "speed of the damper's knot".to_owned(),
        ParameterKind::Stiffness if is_numbered => "stiffness ",
        ParameterKind::Damping if is_numbered => "damping ",
        ParameterKind::Mass if is_numbered => "mass ",
        ParameterKind::Length if is_numbered => "displacement of the spring's knot ",
        ParameterKind::Rate if parameter.is_some_and(|parameter| !parameter.of_the_test) => {
            "speed of the damper's knot "
        }
        _ => "",
    };
    let place = place.map(|place| format!(" {place}")).unwrap_or_default();
    format!("{kind}{stem}{place}")
}

/// Several of these names, separated by commas.
pub(crate) fn all_in_words<'a>(model: &Model, names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().map(|name| in_words(model, name)).collect::<Vec<_>>().join(", ")
}

/// A 95 % interval by parameter, in its unit; `None`: open on that side, the record does not bound it.
pub type Intervals = BTreeMap<String, (Option<f64>, Option<f64>)>;

/// How well the free numbers of a candidate are determined.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Assessment {
    /// The parameters assessed, in the order of the matrices.
    pub parameters: Vec<String>,
    /// Standard deviations, in the unit of each; those on a bound of the search have none.
    pub standard_deviation: BTreeMap<String, f64>,
    /// 95 % intervals of the linearisation: log-normal, or normal and cut at zero for a value near zero.
    pub interval: Intervals,
    /// Correlation of the estimates (of their logarithms), rows as `parameters`; those on a bound are left out.
    pub correlation: Vec<Vec<f64>>,
    /// Condition number of the sensitivities with columns of one length; `None` without full rank.
    pub condition: Option<f64>,
    /// Directions that the record determines.
    pub rank: usize,
    /// The direction determined least, in words.
    pub weakest_direction: Option<String>,
    /// Lag-1 autocorrelation of the misfit.
    pub residual_autocorrelation: f64,
    /// Independent samples that the misfit is worth.
    pub effective_samples: f64,
    /// Profile likelihood intervals, where asked for.
    pub profile: Vec<Profile>,
    /// Bootstrap, where asked for.
    pub bootstrap: Option<BlockBootstrap>,
    /// Where the accelerations are met best, near the minimum; `None` for a model with knots, and where the noise of a
    /// sensor is not known.
    pub least_misfit: Option<LeastMisfit>,
}

/// Where a model meets the accelerations best: a fit to the displacement, which sums their errors twice, is elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastMisfit {
    /// The free numbers there, by name, in the unit of each.
    pub parameters: BTreeMap<String, f64>,
    /// Those of them that stand on no bound.
    pub inside: Vec<String>,
}

/// The profile of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Name with unit.
    pub parameter: String,
    /// Lower end of the 95 % interval; `None`: open, the record does not bound it from below.
    pub low: Option<f64>,
    /// Upper end; `None`: open.
    pub high: Option<f64>,
    /// Value and rise of `2 ln L` at every grid point, by rising value.
    pub points: Vec<(f64, f64)>,
}

impl Profile {
    /// Whether the record bounds the parameter on both sides.
    pub fn identifiable(&self) -> bool {
        self.low.is_some() && self.high.is_some()
    }
}

/// Percentiles of the parameters over the replicates.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockBootstrap {
    /// Replicates that led to a fit.
    pub replicates: usize,
    /// Samples in a block.
    pub block: usize,
    /// From the 2.5th to the 97.5th percentile.
    pub interval: BTreeMap<String, (Option<f64>, Option<f64>)>,
}

/// Percentiles over the repetitions.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagation {
    /// Repetitions that led to a result.
    pub repetitions: usize,
    /// 5th and 95th percentile by name: the parameters, and `dynamic_crush_m` of the model.
    pub interval_90: BTreeMap<String, (f64, f64)>,
    /// Standard deviation by name.
    pub standard_deviation: BTreeMap<String, f64>,
}

/// How well the parameters of a candidate are determined, and how that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Assessed {
    /// Covariance, intervals, profiles and bootstrap.
    pub assessment: Assessment,
    /// The estimator repeated with uncertain inputs, where asked for.
    pub propagation: Option<Propagation>,
    /// What the propagation repeated, in words: a fit or a closed form.
    pub repeated: &'static str,
    /// Half width of the share of the mass in front that is in the intervals; 0: none.
    pub front_mass_uncertainty: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::{Kelvin, Maxwell, ModelKind};

    #[test]
    fn the_table_follows_the_variants() {
        for (k, method) in Method::ALL.into_iter().enumerate() {
            assert_eq!(method as usize, k);
            assert_eq!(method.name().parse(), Ok(method));
        }
    }

    #[test]
    fn zero_is_an_answer_and_another_bound_is_not() {
        let model = Model::Kelvin(Kelvin { mass_kg: 1.0, stiffness_n_per_m: 2.0, damping_n_s_per_m: 0.0 });
        let said = |names: &[&'static str]| bounds_remark(&model, names);
        assert_eq!(said(&[]), None);
        assert_eq!(said(&["damping_n_s_per_m"]).as_deref(), Some("zero, the lowest possible value: damping"));
        let both = said(&["stiffness_n_per_m", "damping_n_s_per_m"]);
        let text =
            "zero, the lowest possible value: damping; parameters at a search limit, not identifiable: stiffness";
        assert_eq!(both.as_deref(), Some(text));
    }

    #[test]
    fn a_damper_at_nothing_is_free_to_be_zero_and_a_large_one_is_held() {
        // 1e-4 of 1000 kg over 0.1 s is 1 N s/m.
        let kelvin = |c: f64| Model::Kelvin(Kelvin { mass_kg: 1e3, stiffness_n_per_m: 1e5, damping_n_s_per_m: c });
        let both = ["stiffness_n_per_m", "damping_n_s_per_m"];
        assert_eq!(fixed_at_bound(&kelvin(0.1), &both, 0.1), both[..1]);
        assert_eq!(fixed_at_bound(&kelvin(10.0), &both, 0.1), both);
        // In series a damper of nothing is no model.
        let maxwell = Maxwell { mass_kg: 1e3, stiffness_n_per_m: 1e5, damping_n_s_per_m: 0.1 };
        assert_eq!(fixed_at_bound(&Model::Maxwell(maxwell), &both, 0.1), both);
    }

    #[test]
    fn no_parameter_of_any_model_is_named_by_its_field() {
        for kind in ModelKind::ALL {
            let names = kind.parameter_names();
            let values = names.iter().enumerate().map(|(k, name)| ((*name).to_owned(), 1.0 + k as f64)).collect();
            let model = Model::from_parameters(kind, &values).unwrap();
            for name in names {
                let words = in_words(&model, name);
                assert!(!words.contains('_') && !words.is_empty(), "{kind} {name}: {words}");
            }
        }
    }

    #[test]
    fn a_knot_is_named_with_its_place() {
        let names = ModelKind::Nonlinear2.parameter_names();
        let values = names.iter().enumerate().map(|(k, name)| ((*name).to_owned(), 0.25 + k as f64)).collect();
        let model = Model::from_parameters(ModelKind::Nonlinear2, &values).unwrap();
        assert_eq!(in_words(&model, "k2_n_per_m"), "stiffness k2 at 4.250 m");
        assert_eq!(
            all_in_words(&model, ["c1_n_s_per_m", "v1_m_per_s"]),
            "damping c1 at rest, speed of the damper's knot v1"
        );
    }
}
