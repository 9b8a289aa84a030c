//! Assessment of a model at the minimum of its misfit: covariance, intervals, correlation, profiles and bootstrap.
//!
//! The covariance is the sandwich `(J'J)^-1 J' L J (J'J)^-1` with the autocovariance `L` of the residuals, see
//! [`covariance`](crumple_numerics::estimation::statistics::covariance); coordinates are logarithms, or near zero
//! shares of a scale. Its intervals are valid while the model is true and the response straight over the interval. The
//! profile drops the second condition, the bootstrap makes no use of a formula; neither drops the first.

use std::collections::BTreeMap;

use crumple_lumped::{Model, ModelKind, ParameterKind};
use crumple_numerics::estimation::statistics::{
    Block, Covariance, SensorError, covariance_of_blocks, lag_1_autocorrelation,
};
use nalgebra::DMatrix;

use crate::candidate::Minimum;
use crate::fit::as_measured::near;
use crate::free::coordinates::Coordinates;
use crate::free::parametric::Parametric;
use crate::record::observation::Observation;
use crate::record::sensor_noise::SensorNoise;
use crate::uncertainty::block_bootstrap::{BlockBootstrap, replicate};
use crate::uncertainty::identifiability::{NamedCoordinate, weakest_direction};
use crate::uncertainty::least_misfit::LeastMisfit;
use crate::uncertainty::likelihood::curve_posterior::curve_intervals;
use crate::uncertainty::likelihood::profile_likelihood::{Profile, Profiled};
use crate::uncertainty::likelihood::source_misfit::{AtSource, Ends, holding};

/// What is computed beyond the covariance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AssessmentOptions {
    /// Profile likelihood of every parameter.
    pub profile: bool,
    /// Replicates of a block bootstrap; 0: none.
    pub bootstrap: usize,
}

/// A 95 % interval by parameter, in its unit; `None`: open on that side, the record does not bound it.
pub type Intervals = BTreeMap<String, (Option<f64>, Option<f64>)>;

/// How well the free numbers of a candidate are determined.
#[derive(Debug, Clone, PartialEq)]
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

/// Assesses a model at the minimum of its misfit; `None` where no parameter is determined.
///
/// `given`: the values to assess, where they are not those of the minimum, such as a closed form that follows two
/// events instead of the whole curve. Their intervals are those of the minimum, as the shortest that also hold
/// these values; the deviation holds the distance `a` from it, `s² + a²`.
///
/// A parameter at zero is assessed from its one side. One at another bound, or without effect in the window, is left
/// out of the matrices and has an open interval. Where masses are fitted, the last one is the rest of the total and
/// follows from the others.
pub fn assess(minimum: &Minimum, given: Option<&Model>, options: AssessmentOptions) -> Option<Assessment> {
    let coordinates = minimum.coordinates();
    let of_given = |model: &Model| {
        let values = model.parameters();
        minimum.free.iter().map(|p| values[p.name]).collect::<Vec<f64>>()
    };
    let at = AtMinimum {
        coordinates: &coordinates,
        observed: &minimum.observed,
        theta: &coordinates.start(),
        on_bound: &minimum.on_bound,
        misfit: &minimum.misfit_m,
        sensitivities: &minimum.sensitivity_m,
        of_curves: curve_intervals(minimum),
    };
    let mut assessment = at.assess(given.map(of_given).as_deref(), options)?;
    open_knots_beside_open_ones(minimum.model.kind(), &mut assessment.interval);
    Some(assessment)
}

/// With one of two knots of a curve open, or fixed, the other may be either of them.
fn open_knots_beside_open_ones(model: ModelKind, interval: &mut Intervals) {
    for kind in [ParameterKind::Length, ParameterKind::Rate] {
        let knots = || model.parameters().iter().filter(|p| p.kind == kind && !p.of_the_test).map(|p| p.name);
        let is_closed = |name: &str| matches!(interval.get(name), Some((Some(_), Some(_))));
        if !knots().all(is_closed) {
            interval.extend(knots().map(|name| (name.to_owned(), (None, None))));
        }
    }
}

/// A minimum of anything with free numbers. Misfit and sensitivities by the coordinates are weighted, in the unit of
/// the first wave: one row for each sample, wave after wave.
pub(crate) struct AtMinimum<'a, M> {
    /// The free numbers.
    pub coordinates: &'a Coordinates<M>,
    /// What they were fitted to.
    pub observed: &'a Observation,
    /// Coordinates of the minimum.
    pub theta: &'a [f64],
    /// Which of them stand on a bound.
    pub on_bound: &'a [bool],
    /// Misfit there.
    pub misfit: &'a [f64],
    /// One column for each coordinate.
    pub sensitivities: &'a DMatrix<f64>,
    /// Intervals of all free numbers, where they are known beside the minimum; they are extended to its values.
    pub of_curves: Option<Intervals>,
}

impl<M: Parametric> AtMinimum<'_, M> {
    /// See [`assess`]; `given`: values of the free numbers, in their order.
    pub fn assess(&self, given: Option<&[f64]>, options: AssessmentOptions) -> Option<Assessment> {
        let (free, theta, names) = (&self.coordinates.free, self.theta, self.coordinates.names());
        // What stands on zero is assessed from its one side; what stands on the end of the search is not assessed.
        // Neither is what moves nothing in the window: it stays open on both sides.
        let on_zero = |i: usize| free[i].value(theta[i]) == 0.0;
        let assessed = |i: &usize| (!self.on_bound[*i] || on_zero(*i)) && self.sensitivities.column(*i).norm() > 0.0;
        let kept: Vec<usize> = (0..theta.len()).filter(assessed).collect();
        let columns = self.sensitivities.select_columns(&kept);
        let source = AtSource::of(self.coordinates, self.observed, theta, &kept);
        let covariance = self.covariance(&columns, source.as_ref())?;
        let mut standard_deviation = BTreeMap::new();
        let value = |i: usize| given.map_or_else(|| free[i].value(theta[i]), |values| values[i]);
        let mut interval: Intervals = names.iter().map(|name| (name.clone(), (None, None))).collect();
        for (k, &i) in kept.iter().enumerate() {
            let value = value(i);
            let coordinate = free[i].coordinate(value);
            let away = Some(coordinate - theta[i]).filter(|away| given.is_some() && away.is_finite()).unwrap_or(0.0);
            let deviation = (covariance.matrix[(k, k)].max(0.0) + away * away).sqrt();
            let half = covariance.half_width[k];
            if half.is_finite() {
                standard_deviation.insert(names[i].clone(), deviation * free[i].slope(coordinate).abs());
            }
            let (fitted, slope) = (free[i].value(theta[i]), free[i].slope(theta[i]));
            let ends = around(fitted, half, free[i].is_logarithmic(), slope);
            interval.insert(names[i].clone(), holding(&free[i], (theta[i], theta[i] + away), ends));
        }
        let least_misfit = source.as_ref().map(|source| source.least_misfit(&names));
        if let Some(source) = source.filter(|source| given.is_none() && source.explains()) {
            let curved = source.curved(&names, (theta, &kept), &covariance);
            interval.extend(curved.into_iter().map(|(i, ends)| (names[i].clone(), ends)));
        }
        match &self.of_curves {
            Some(of_curves) => interval.extend((0..names.len()).filter_map(|i| {
                let (low, high) = of_curves.get(&names[i])?;
                let ends = (low.map(|low| low.min(value(i))), high.map(|high| high.max(value(i))));
                Some((names[i].clone(), ends))
            })),
            None => self.bound_knots(&kept, (&names, &value), &mut interval),
        }
        // A mass that a bound holds leaves the rest of the total open too.
        let is_mass = |i: &usize| free[*i].kind == ParameterKind::Mass;
        let masses: Vec<usize> = (0..theta.len()).filter(is_mass).collect();
        let rest = self.coordinates.free_rest(theta);
        let with_rest = rest.is_some() && masses.iter().all(|i| kept.contains(i));
        if let Some((name, value)) = &rest {
            let places: Vec<usize> = masses.iter().filter_map(|i| kept.iter().position(|k| k == i)).collect();
            let slopes: Vec<f64> = masses.iter().map(|&i| free[i].slope(theta[i])).collect();
            let mut ends = (None, None);
            if with_rest {
                let first = interval.get(&names[masses[0]]).copied().unwrap_or_default();
                let total = value + free[masses[0]].value(theta[masses[0]]);
                let (deviation, found) = of_the_rest(*value, (&places, &slopes), &covariance, (total, first));
                standard_deviation.insert(name.clone(), deviation);
                ends = found;
            }
            interval.insert(name.clone(), ends);
        }
        let (quantity, waves) = (self.observed.waves.first()?.quantity, self.observed.split(self.misfit));
        let named: Vec<NamedCoordinate> = kept.iter().map(|&i| self.named(i, &names)).collect();
        let rest_name = rest.map(|(name, _)| name).filter(|_| with_rest);
        Some(Assessment {
            parameters: kept.iter().map(|&i| names[i].clone()).collect(),
            standard_deviation,
            interval,
            correlation: covariance.correlation().row_iter().map(|row| row.iter().copied().collect()).collect(),
            condition: Some(covariance.condition).filter(|c| c.is_finite()),
            rank: covariance.rank,
            weakest_direction: weakest_direction(&named, &covariance, quantity),
            residual_autocorrelation: waves.iter().map(|misfit| lag_1_autocorrelation(misfit)).sum::<f64>()
                / waves.len() as f64,
            effective_samples: covariance.effective_samples,
            profile: if options.profile { self.profiles(&names, (&kept, &covariance), &rest_name) } else { Vec::new() },
            bootstrap: (options.bootstrap > 0).then(|| self.bootstrap(options.bootstrap, names, rest_name)).flatten(),
            least_misfit,
        })
    }

    /// The intervals of knots: open above where they leave the range of the knot; where the noise of the sensors is
    /// known, those that are still closed by the likelihood over that range if it explains the misfit, and open if it
    /// does not. They hold the value.
    fn bound_knots(
        &self,
        kept: &[usize],
        (names, value): (&[String], &impl Fn(usize) -> f64),
        interval: &mut Intervals,
    ) {
        let free = &self.coordinates.free;
        let is_knot = |i: &usize| matches!(free[*i].kind, ParameterKind::Length | ParameterKind::Rate);
        let mut closed = Vec::new();
        for i in kept.iter().copied().filter(is_knot) {
            let Some((low, high)) = interval.get_mut(&names[i]) else { continue };
            *high = high.filter(|high| *high < free[i].value(free[i].axis.upper));
            if low.is_some() && high.is_some() {
                closed.push(i);
            }
        }
        if closed.is_empty() || self.observed.waves.iter().any(|wave| SensorNoise::of(wave).is_none()) {
            return;
        }
        let source = AtSource::of_knots(self.coordinates, self.observed, self.theta, kept);
        for i in closed {
            let (low, high) = source.as_ref().and_then(|source| source.whole_range(names, i)).unwrap_or_default();
            let ends = (low.map(|low| low.min(value(i))), high.map(|high| high.max(value(i))));
            interval.insert(names[i].clone(), ends);
        }
    }

    /// The covariance from the noise of the sensors where that is known, and from the misfit where the noise does not
    /// explain it.
    fn covariance(&self, columns: &DMatrix<f64>, source: Option<&AtSource<'_, M>>) -> Option<Covariance> {
        let waves = &self.observed.waves;
        let noises = source.map(|source| &source.noises);
        let middle_of = |k: usize| {
            move |rows: &DMatrix<f64>| noises.map_or_else(|| rows.tr_mul(rows), |of| of[k].0.middle(&waves[k], rows))
        };
        let middles: Vec<_> = (0..waves.len()).map(middle_of).collect();
        let sensor = |k: usize| {
            let (noise, explains_residuals) = &noises?[k];
            let explains_residuals = *explains_residuals;
            Some(SensorError { middle: &middles[k], freedom: noise.freedom, explains_residuals })
        };
        let blocks = self.observed.blocks().into_iter().enumerate();
        let blocks: Vec<Block<'_>> =
            blocks.map(|(k, (samples, resolution))| Block { samples, resolution, sensor: sensor(k) }).collect();
        covariance_of_blocks(columns, self.misfit, &blocks)
    }

    fn named(&self, i: usize, names: &[String]) -> NamedCoordinate {
        let (number, name) = (&self.coordinates.free[i], names[i].clone());
        let logarithmic = number.is_logarithmic();
        NamedCoordinate { name, kind: number.kind, logarithmic, slope: number.slope(self.theta[i]) }
    }

    /// The profile of every free number, and of the rest of the total.
    fn profiles(
        &self,
        names: &[String],
        (kept, covariance): (&[usize], &Covariance),
        rest: &Option<String>,
    ) -> Vec<Profile> {
        let (free, theta) = (&self.coordinates.free, self.theta);
        let problem = near(self.coordinates, self.observed);
        let bounds: Vec<(f64, f64)> = free.iter().map(|number| (number.axis.lower, number.axis.upper)).collect();
        let half_width = |i| kept.iter().position(|&k| k == i).map(|k| covariance.half_width[k]);
        let expected: Vec<Option<f64>> = (0..theta.len()).map(half_width).collect();
        let floor = self.observed.unresolved();
        let least = self.misfit.iter().map(|r| (r / problem.unit).powi(2)).sum::<f64>() + floor;
        let effective_samples = covariance.effective_samples.max(theta.len() as f64 + 1.0);
        let mut profiles = Profiled {
            names,
            at: theta,
            bounds: &bounds,
            value: &|i, coordinate| free[i].value(coordinate),
            ends_at_zero: &|i| !free[i].is_logarithmic(),
            refit: &|fixed, coordinate, others| problem.follow_others(fixed, coordinate, others),
            // The sum of squares with that of the resolution.
            rise: &|cost| effective_samples * ((cost + floor) / least).ln(),
            expected: &expected,
        }
        .profiles();
        profiles.extend(rest.as_ref().and_then(|rest| self.profile_of_the_rest(rest, &profiles)));
        profiles
    }

    /// The profile of the rest of the total: that of the one free mass mirrored, `m_rest = m - m_free`. `None` with
    /// several free masses.
    fn profile_of_the_rest(&self, rest: &str, profiles: &[Profile]) -> Option<Profile> {
        let free = &self.coordinates.free;
        let mut masses = (0..self.theta.len()).filter(|&i| free[i].kind == ParameterKind::Mass);
        let (mass, None) = (masses.next()?, masses.next()) else { return None };
        let mirrored = profiles.get(mass)?;
        let total = self.coordinates.free_rest(self.theta)?.1 + free[mass].value(self.theta[mass]);
        Some(Profile {
            parameter: rest.to_owned(),
            low: mirrored.high.map(|kg| total - kg),
            high: mirrored.low.map(|kg| total - kg),
            points: mirrored.points.iter().rev().map(|(kg, rise)| (total - kg, *rise)).collect(),
        })
    }

    fn bootstrap(&self, replicates: usize, mut names: Vec<String>, rest: Option<String>) -> Option<BlockBootstrap> {
        let coordinates = self.coordinates;
        let with_rest = rest.is_some();
        names.extend(rest);
        replicate(self.observed, self.misfit, replicates, names, |resampled| {
            let theta = near(coordinates, resampled).follow(self.theta)?.theta;
            let values = coordinates.free.iter().zip(&theta).map(|(number, x)| number.value(*x));
            Some(values.chain(coordinates.free_rest(&theta).filter(|_| with_rest).map(|(_, kg)| kg)).collect())
        })
    }
}

/// The interval of a coordinate as values: log-normal, `p e^(±h)`, open from `h = 9` on; near zero normal, `p ± h u`,
/// cut at zero, with `u` the derivative by the coordinate.
fn around(value: f64, half: f64, logarithmic: bool, slope: f64) -> Ends {
    if logarithmic && value > 0.0 {
        let known = half < 9.0;
        (known.then(|| value * (-half).exp()), known.then(|| value * half.exp()))
    } else {
        let half = half * slope;
        (Some((value - half).max(0.0)), Some(value + half).filter(|high| high.is_finite()))
    }
}

/// Standard deviation and 95 % interval, kg, of the mass that is the rest of the total.
///
/// The variance is `g' C g` with `g` the derivatives of the free masses by their coordinates, at these places of the
/// covariance. With one free mass the interval is that of the free mass mirrored in the total; with several it is
/// normal, with the widest of the factors between their deviation and half-width.
fn of_the_rest(
    value: f64,
    (places, slopes): (&[usize], &[f64]),
    covariance: &Covariance,
    (total, of_first): (f64, Ends),
) -> (f64, Ends) {
    let both = || places.iter().zip(slopes);
    let variance: f64 = both().flat_map(|(i, a)| both().map(move |(j, b)| a * covariance.matrix[(*i, *j)] * b)).sum();
    let deviation = variance.max(0.0).sqrt();
    let ends = if let [_] = places {
        let rest = |end: Option<f64>| end.map(|kg| (total - kg).max(0.0));
        (rest(of_first.1), rest(of_first.0))
    } else {
        let factor = |i: &usize| covariance.half_width[*i] / covariance.matrix[(*i, *i)].sqrt();
        let half = places.iter().map(factor).fold(1.96, f64::max) * deviation;
        if half.is_finite() { (Some((value - half).max(0.0)), Some(value + half)) } else { (None, None) }
    };
    (deviation, ends)
}

/// Parameters with an open interval on at least one side, by name.
pub fn undetermined(assessment: &Assessment) -> Vec<&str> {
    let open = assessment.interval.iter().filter(|(_, (low, high))| low.is_none() || high.is_none());
    open.map(|(name, _)| name.as_str()).collect()
}
