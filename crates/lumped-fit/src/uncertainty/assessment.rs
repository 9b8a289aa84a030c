//! Assessment of a model at the minimum of its misfit: covariance, intervals, correlation, profiles and bootstrap.
//!
//! The covariance is the sandwich `(J'J)^-1 J' L J (J'J)^-1` with the autocovariance `L` of the residuals, see
//! [`covariance`](crumple_estimation::statistics::covariance); coordinates are those of [`FreeParameter`]. Its
//! intervals are valid while the model is true and the response straight over the interval. The profile drops the
//! second condition, the bootstrap makes no use of a formula; neither drops the first.

use std::collections::BTreeMap;

use crate::candidate::minimum::Minimum;
use crate::free::free_parameter::{FreeParameter, masses_of, rest_mass};
use crate::uncertainty::block_bootstrap::{BlockBootstrap, bootstrap};
use crate::uncertainty::identifiability::weakest_direction;
use crate::uncertainty::profile_likelihood::{Profile, profile};
use crumple_estimation::statistics::lag_1_autocorrelation;
use crumple_estimation::statistics::{Covariance, covariance_of_blocks};
use crumple_lumped::{Model, ParameterKind};

/// What is computed beyond the covariance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AssessmentOptions {
    /// Profile likelihood of every parameter.
    pub profile: bool,
    /// Replicates of a block bootstrap; 0: none.
    pub bootstrap: usize,
}

/// A 95 % interval by parameter, in its unit; `None`: open on that side, the record does not bound it.
pub type Intervals = BTreeMap<&'static str, (Option<f64>, Option<f64>)>;

/// How well the parameters of one candidate are determined.
#[derive(Debug, Clone, PartialEq)]
pub struct Assessment {
    /// The parameters assessed, in the order of the matrices.
    pub parameters: Vec<&'static str>,
    /// Standard deviations, in the unit of each; those on a bound of the search have none.
    pub standard_deviation: BTreeMap<&'static str, f64>,
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
}

/// Assesses a model at the minimum of its misfit; `None` where no parameter is determined.
///
/// `given`: the values to assess, where they are not those of the minimum, such as a closed form that follows two
/// events instead of the whole curve. Intervals stand around these values and are widened by their distance `a` from
/// the minimum as one more standard deviation, `h² + (1.96 a)²`: another way to take the same model from the record
/// gives values so far apart.
///
/// A parameter at zero is assessed from its one side. One at another bound, or without effect in the window, is left
/// out of the matrices and has an open interval. Where masses are fitted, the last one is the rest of the total and
/// follows from the others.
pub fn assess(refined: &Minimum, given: Option<&Model>, options: AssessmentOptions) -> Option<Assessment> {
    let observed = &refined.observed;
    // What stands on zero is assessed from its one side; what stands on the end of the search is not assessed.
    // Neither is what moves nothing in the window: it stays open on both sides.
    let assessed = |i: &usize| {
        (!refined.on_bound[*i] || refined.free[*i].value == 0.0) && refined.sensitivity_m.column(*i).norm() > 0.0
    };
    let kept: Vec<usize> = (0..refined.free.len()).filter(assessed).collect();
    let free: Vec<FreeParameter> = kept.iter().map(|&i| refined.free[i]).collect();
    let j_m = refined.sensitivity_m.select_columns(&kept);
    let covariance = covariance_of_blocks(&j_m, &refined.misfit_m, &observed.blocks())?;
    let values = given.unwrap_or(&refined.model).parameters();
    let mut standard_deviation = BTreeMap::new();
    let mut interval = Intervals::new();
    for (i, parameter) in free.iter().enumerate() {
        let value = values[parameter.name];
        let away = parameter.coordinate(value) - parameter.coordinate(parameter.value);
        let away = if given.is_some() && away.is_finite() { away } else { 0.0 };
        let deviation = (covariance.matrix[(i, i)].max(0.0) + away * away).sqrt();
        let half = (covariance.half_width[i].powi(2) + (1.96 * away).powi(2)).sqrt();
        if half.is_finite() {
            standard_deviation.insert(parameter.name, deviation * parameter.slope(parameter.coordinate(value)).abs());
        }
        interval.insert(parameter.name, around(parameter, value, half));
    }
    for (i, parameter) in refined.free.iter().enumerate() {
        if !kept.contains(&i) {
            interval.insert(parameter.name, (None, None));
        }
    }
    // A mass that a bound holds leaves the rest of the total open too.
    let model = given.unwrap_or(&refined.model);
    let all_masses = free.iter().filter(|p| p.kind == ParameterKind::Mass).count() + 1 == masses_of(model).len();
    if let Some((rest, value)) = rest_mass(model, &refined.free) {
        let (deviation, ends) = of_the_rest(value, &free, &covariance, &interval);
        if all_masses {
            standard_deviation.insert(rest, deviation);
        }
        interval.insert(rest, if all_masses { ends } else { (None, None) });
    }
    let correlation = covariance.correlation();
    let waves = observed.split(&refined.misfit_m);
    let quantity = observed.waves.first()?.quantity;
    Some(Assessment {
        parameters: free.iter().map(|p| p.name).collect(),
        standard_deviation,
        interval,
        correlation: correlation.row_iter().map(|row| row.iter().copied().collect()).collect(),
        condition: Some(covariance.condition).filter(|c| c.is_finite()),
        rank: covariance.rank,
        weakest_direction: weakest_direction(&free, &covariance, quantity),
        residual_autocorrelation: waves.iter().map(|misfit| lag_1_autocorrelation(misfit)).sum::<f64>()
            / waves.len() as f64,
        effective_samples: covariance.effective_samples,
        profile: if options.profile {
            let half_width = |i| kept.iter().position(|&k| k == i).map(|k| covariance.half_width[k]);
            let expected: Vec<Option<f64>> = (0..refined.free.len()).map(half_width).collect();
            let mut profiles = profile(refined, &expected, covariance.effective_samples);
            profiles.extend(profile_of_the_rest(refined, &profiles).filter(|_| all_masses));
            profiles
        } else {
            Vec::new()
        },
        bootstrap: (options.bootstrap > 0).then(|| bootstrap(refined, options.bootstrap, all_masses)).flatten(),
    })
}

/// The interval of a coordinate as values: log-normal, `p e^(±h)`, open from `h = 9` on; near zero normal, `p ± h u`,
/// cut at zero.
fn around(parameter: &FreeParameter, value: f64, half: f64) -> (Option<f64>, Option<f64>) {
    if parameter.logarithmic && value > 0.0 {
        let known = half < 9.0;
        (known.then(|| value * (-half).exp()), known.then(|| value * half.exp()))
    } else {
        let half = half * parameter.unit;
        (Some((value - half).max(0.0)), Some(value + half).filter(|high| high.is_finite()))
    }
}

/// Standard deviation and 95 % interval, kg, of the mass that is the rest of the total.
///
/// The variance is `g' C g` with `g` the derivatives of the free masses by their coordinates. With one free mass the
/// interval is that of the free mass mirrored in the total; with two it is normal, with the wider of the factors
/// between their deviation and half-width.
fn of_the_rest(
    value: f64,
    free: &[FreeParameter],
    covariance: &Covariance,
    interval: &Intervals,
) -> (f64, (Option<f64>, Option<f64>)) {
    let masses: Vec<usize> = (0..free.len()).filter(|&i| free[i].kind == ParameterKind::Mass).collect();
    let slope = |i: usize| free[i].slope(free[i].coordinate(free[i].value));
    let pairs = masses.iter().flat_map(|&i| masses.iter().map(move |&j| (i, j)));
    let variance: f64 = pairs.map(|(i, j)| slope(i) * covariance.matrix[(i, j)] * slope(j)).sum();
    let deviation = variance.max(0.0).sqrt();
    let ends = match masses[..] {
        [mass] => {
            let (low, high) = interval[free[mass].name];
            let total = value + free[mass].value;
            let rest = |end: Option<f64>| end.map(|kg| (total - kg).max(0.0));
            (rest(high), rest(low))
        }
        _ => {
            let factor = |i: &usize| covariance.half_width[*i] / covariance.matrix[(*i, *i)].sqrt();
            let half = masses.iter().map(factor).fold(1.96, f64::max) * deviation;
            if half.is_finite() { (Some((value - half).max(0.0)), Some(value + half)) } else { (None, None) }
        }
    };
    (deviation, ends)
}

/// The profile of the rest of the total: that of the one free mass mirrored. `None` with two free masses.
fn profile_of_the_rest(refined: &Minimum, profiles: &[Profile]) -> Option<Profile> {
    let (parameter, value) = rest_mass(&refined.model, &refined.free)?;
    let mut masses = refined.free.iter().filter(|p| p.kind == ParameterKind::Mass);
    let (mass, None) = (masses.next()?, masses.next()) else { return None };
    let mirrored = profiles.iter().find(|p| p.parameter == mass.name)?;
    let total = value + mass.value;
    Some(Profile {
        parameter,
        low: mirrored.high.map(|kg| total - kg),
        high: mirrored.low.map(|kg| total - kg),
        points: mirrored.points.iter().rev().map(|(kg, rise)| (total - kg, *rise)).collect(),
    })
}

/// Parameters with an open interval on at least one side, by name.
pub fn undetermined(assessment: &Assessment) -> Vec<&'static str> {
    assessment
        .interval
        .iter()
        .filter(|(_, (low, high))| low.is_none() || high.is_none())
        .map(|(name, _)| *name)
        .collect()
}
