//! Record: physical parameters, the fit they come from and their uncertainty.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::MatchingSweepV1;

/// One set of physical parameters. Topic `/parameters/<model>/<method>/<index>`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct CandidateV1 {
    /// Model: `kelvin`, `elastoplastic`, `maxwell`, `double-spring-mass-damper`, ...
    pub model: String,
    /// Method that found it, e.g. `closed-form`.
    pub method: String,
    /// Parameters by name with unit, e.g. `stiffness_n_per_m`.
    pub parameters: BTreeMap<String, f64>,
    /// Whether every parameter is positive and so a passive structure.
    pub physical: bool,
    /// Id of a candidate that gives exactly the same record on this sensor.
    pub equivalent_to: Option<String>,
    /// How it was fitted; `null` for a closed form.
    pub fit: Option<FitV1>,
    /// How well the parameters are determined.
    pub uncertainty: Option<UncertaintyV1>,
    /// Reductions and assumptions, in words.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The candidate beside the test; `null`: nobody has compared it yet, or it is of several tests.
    #[serde(default)]
    pub evaluation: Option<EvaluationV1>,
    /// Of a fitted double model the sets with its poles over the division of its mass; `null` of any other, of the
    /// second of two duals, and where the fit stopped on a bound other than zero, so that the poles are the bound's.
    #[serde(default)]
    pub mass_divisions: Option<MassDivisionsV1>,
    /// Text of the law of an own model, from which its motion is computed again; `null` of any other model.
    #[serde(default)]
    pub law: Option<String>,
}

/// Real parameter sets of the double model with the poles of a fitted one, over the division of its total mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct MassDivisionsV1 {
    /// Bound of m2/m1 above which no set is physical; `null`: no division has one.
    pub largest_mass_ratio: Option<f64>,
    /// The sets.
    pub sweep: Vec<MatchingSweepV1>,
}

/// A candidate beside the test, measured as the record was, over one window.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct EvaluationV1 {
    /// Compared window: start, s after contact.
    pub from_s: f64,
    /// Compared window: end.
    pub to_s: f64,
    /// Displacement fit, percent, of the model sampled, filtered and integrated as the record was.
    pub fit_as_measured_percent: Option<f64>,
    /// Dynamic crush of the model over that of the test, less 1; `null`: it never stops.
    pub crush_error: Option<f64>,
    /// Time of dynamic crush of the model over that of the test, less 1; `null`: it never stops.
    pub time_error: Option<f64>,
    /// Restitution of the model less that of the test; `null`: the test shows none, or the model never stops.
    pub restitution_error: Option<f64>,
    /// Coefficient of restitution of the model in the test; `null`: it does not come back.
    pub coefficient_of_restitution: Option<f64>,
    /// Misfit of the force on the wall, percent of its root mean square; `null`: the test has no such force.
    pub force_misfit_percent: Option<f64>,
    /// Of the sensors on other masses the one that it follows worst.
    pub worst_sensor: Option<String>,
    /// Its displacement fit there, percent.
    pub worst_sensor_fit_percent: Option<f64>,
    /// Of a plastic model, the largest relative error of the crush at lower speeds that the record itself shows.
    pub crush_error_at_lower_speeds: Option<f64>,
}

impl CandidateV1 {
    /// Why the value of a parameter is in doubt; `None` where it is not.
    ///
    /// Zero on a bound is the limit of what is physical, and an answer. Elsewhere a bound is not the record's, and a
    /// standard deviation as large as a value that is not zero, or an interval open at both ends, says that the value
    /// is one of many.
    pub fn doubt(&self, name: &str) -> Option<Doubt> {
        let value = *self.parameters.get(name)?;
        if self.fit.as_ref().is_some_and(|fit| fit.active_bounds.iter().any(|other| other == name)) {
            return (value != 0.0).then_some(Doubt::OnBound);
        }
        let known = self.uncertainty.as_ref()?;
        let open = [&known.interval_low, &known.interval_high].iter().all(|end| end.get(name) == Some(&None));
        let loose = value != 0.0 && known.standard_deviation.get(name).is_some_and(|d| *d >= value.abs());
        (open || loose).then_some(Doubt::NotDetermined)
    }

    /// Parameters that were asked of the record: those of which a deviation, an interval or a bound is known.
    pub fn asked(&self) -> impl Iterator<Item = &str> {
        self.parameters.keys().map(String::as_str).filter(|name| {
            let has_interval =
                |u: &UncertaintyV1| u.standard_deviation.contains_key(*name) || u.interval_low.contains_key(*name);
            let is_at_bound = |fit: &FitV1| fit.active_bounds.iter().any(|bound| bound == name);
            self.uncertainty.as_ref().is_some_and(has_interval) || self.fit.as_ref().is_some_and(is_at_bound)
        })
    }

    /// Names of the parameters that the record does not determine.
    pub fn undetermined(&self) -> Vec<&str> {
        self.asked().filter(|name| self.doubt(name).is_some()).collect()
    }

    /// How sure a parameter is that was asked of the record; `None` for one that was given.
    ///
    /// Open is what is in [`CandidateV1::doubt`]. Of what is not, an interval between ends of one sign, one of them
    /// more than ten times the other, gives an order of magnitude and no more; so does one that is open at one end, and
    /// one of a zero that reaches beyond a tenth of what matters: of the force, the spring or the damper that by itself
    /// stops the masses within the window of the fit.
    pub fn certainty(&self, name: &str) -> Option<Certainty> {
        if !self.asked().any(|asked| asked == name) {
            return None;
        }
        if self.doubt(name).is_some() {
            return Some(Certainty::Open);
        }
        let end = |ends: &BTreeMap<String, Option<f64>>| ends.get(name).copied();
        let ends = self.uncertainty.as_ref().and_then(|u| end(&u.interval_low).zip(end(&u.interval_high)));
        let is_zero = self.parameters.get(name) == Some(&0.0);
        let is_wide = ends.is_some_and(|ends| match ends {
            (Some(low), Some(high)) if is_zero => {
                let largest = low.abs().max(high.abs());
                self.size_that_matters(name).is_some_and(|size| ORDER_OF_MAGNITUDE * largest > size)
            }
            (Some(low), Some(high)) => {
                low * high > 0.0 && low.abs().max(high.abs()) > ORDER_OF_MAGNITUDE * low.abs().min(high.abs())
            }
            _ => true,
        });
        Some(if is_wide { Certainty::OrderOfMagnitude } else { Certainty::Determined })
    }

    /// What a damper or a spring, by the unit of its name, is compared with where it is zero: `M/T` and `M/T²`, with
    /// the masses M and the window T of the fit. Of a force, the largest of the candidate. `None` of other numbers.
    fn size_that_matters(&self, name: &str) -> Option<f64> {
        let of_unit = |unit: &'static str| self.parameters.iter().filter(move |(name, _)| name.ends_with(unit));
        let per_time = |power: i32| {
            let window_s = self.fit.as_ref().map(|fit| fit.to_s).filter(|to_s| *to_s > 0.0)?;
            Some(of_unit("_kg").map(|(_, mass_kg)| mass_kg).sum::<f64>() / window_s.powi(power))
        };
        if name.ends_with("_n_s_per_m") {
            per_time(1)
        } else if name.ends_with("_n_per_m") {
            per_time(2)
        } else {
            name.ends_with("_n").then(|| of_unit("_n").fold(0.0, |largest: f64, (_, force)| largest.max(force.abs())))
        }
    }

    /// Names of the parameters of one certainty.
    pub fn parameters_of(&self, certainty: Certainty) -> Vec<&str> {
        self.asked().filter(|name| self.certainty(name) == Some(certainty)).collect()
    }
}

/// Ratio of the ends of a 95 % interval above which a parameter counts as known to an order of magnitude only.
const ORDER_OF_MAGNITUDE: f64 = 10.0;

/// Why the value of a parameter is in doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// Its search stopped at its limit, which is not the record's.
    OnBound,
    /// The record fits as well with other values.
    NotDetermined,
}

/// How sure a record is of a parameter that was asked of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Certainty {
    /// The record determines it.
    Determined,
    /// Its 95 % interval spans more than a factor of 10, is open at one end, or is that of a zero that may be more than
    /// a tenth of what matters.
    OrderOfMagnitude,
    /// It may be anything: on a bound of its search, or without an interval.
    Open,
}

/// A fit by iteration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct FitV1 {
    /// Channel fitted.
    pub channel: String,
    /// Quantity fitted, e.g. `displacement`.
    pub quantity: String,
    /// Window, s from time zero: start.
    pub from_s: f64,
    /// Window: end.
    pub to_s: f64,
    /// Samples fitted.
    pub samples: u64,
    /// Root mean square error over the window, unit of the quantity.
    pub rmse: f64,
    /// Iterations of the best start.
    pub iterations: u32,
    /// Model evaluations of all starts.
    pub evaluations: u64,
    /// Why the best start stopped, e.g. `gradient-converged`.
    pub stop_reason: String,
    /// Parameters that stopped on a bound.
    pub active_bounds: Vec<String>,
    /// Every sensor fitted, where there is more to say than above: several sensors, or another than the pulse's
    /// displacement.
    #[serde(default)]
    pub sensors: Vec<SensorFitV1>,
}

/// One sensor of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SensorFitV1 {
    /// Its channel.
    pub channel: String,
    /// Number of the mass it sits on, from 1 at the barrier.
    pub mass: u32,
    /// Quantity fitted, e.g. `velocity`.
    pub quantity: String,
    /// Root mean square error over the window, unit of the quantity.
    pub rmse: f64,
    /// Noise level that its residuals were divided by, unit of the quantity.
    pub noise: f64,
}

/// Uncertainty of parameters.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct UncertaintyV1 {
    /// How it was found, e.g. `linearised`.
    pub method: String,
    /// Standard deviation by parameter.
    pub standard_deviation: BTreeMap<String, f64>,
    /// Condition number of the scaled sensitivity matrix.
    pub condition: Option<f64>,
    /// Lower end of the 95 % interval by parameter; `null`: open, the record does not bound it.
    #[serde(default)]
    pub interval_low: BTreeMap<String, Option<f64>>,
    /// Upper end of the 95 % interval by parameter; `null`: open.
    #[serde(default)]
    pub interval_high: BTreeMap<String, Option<f64>>,
    /// Parameters in the order of the correlation matrix.
    #[serde(default)]
    pub order: Vec<String>,
    /// Correlation of the estimates, rows as `order`.
    #[serde(default)]
    pub correlation: Vec<Vec<f64>>,
    /// Directions in the space of the parameters that the record determines at all.
    pub rank: Option<u32>,
    /// The direction determined least, in words.
    pub weakest_direction: Option<String>,
    /// Independent samples that the misfit is worth.
    pub effective_samples: Option<f64>,
    /// Profile likelihood by parameter, where asked for.
    #[serde(default)]
    pub profile: Vec<ProfileV1>,
    /// Block bootstrap, where asked for.
    pub bootstrap: Option<ReplicatesV1>,
    /// Effect of uncertain mass, speed, zero level and time zero, where stated.
    pub propagation: Option<ReplicatesV1>,
}

/// The likelihood of one parameter while all others follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ProfileV1 {
    /// Parameter.
    pub parameter: String,
    /// Lower end of the 95 % interval; `null`: open.
    pub low: Option<f64>,
    /// Upper end; `null`: open.
    pub high: Option<f64>,
    /// Whether both ends exist.
    pub identifiable: bool,
    /// Values of the parameter, rising.
    pub values: Vec<f64>,
    /// Rise of `2 ln L` above its least at each.
    pub rise: Vec<f64>,
}

/// Intervals read from repetitions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ReplicatesV1 {
    /// What was repeated, in words.
    pub method: String,
    /// Repetitions that led to a result.
    pub replicates: u64,
    /// Share of the results between the ends, e.g. 0.95.
    pub coverage: f64,
    /// Lower end by parameter.
    pub low: BTreeMap<String, f64>,
    /// Upper end by parameter.
    pub high: BTreeMap<String, f64>,
}
