//! Assessment of a model at the minimum of its misfit: covariance, intervals, correlation, profiles and bootstrap.
//!
//! The covariance is the sandwich `(J'J)^-1 J' L J (J'J)^-1` with the autocovariance `L` of the residuals, see
//! [`covariance`](crumple_numerics::estimation::statistics::covariance); coordinates are logarithms, or near zero
//! shares of a scale. Its intervals are valid while the model is true and the response straight over the interval. The
//! profile drops the second condition, the bootstrap makes no use of a formula; neither drops the first.

use std::collections::BTreeMap;

use crumple_lumped::{Model, ModelKind, ParameterKind};
use crumple_numerics::estimation::random::{RandomNumbers, circular_blocks};
use crumple_numerics::estimation::statistics::{
    Block, Covariance, NORMAL_95, SensorError, covariance_of_blocks, geyer_autocorrelation_time, lag_1_autocorrelation,
    quantile,
};
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::candidate::{Assessment, BlockBootstrap, Intervals, Minimum, Profile};
use crate::coordinates::Coordinates;
use crate::fit::as_measured::near;
use crate::record::observation::Observation;
use crate::record::sensor::FitQuantity;
use crate::record::sensor_noise::SensorNoise;
use crate::uncertainty::acceleration_likelihood::{AccelerationLikelihood, Ends, holding, widened};
use crate::uncertainty::curve_posterior::curve_intervals;
use crate::uncertainty::mass_division::Profiled;

/// Parameters whose part of the weakest direction is below this share of the largest part are not named.
const WORTH_NAMING: f64 = 0.2;
/// A combination whose relative standard deviation is above this is called not determined.
const LOOSE: f64 = 0.5;

/// A coordinate of a fit with the name of its parameter, for that sentence.
#[derive(Debug, Clone)]
pub(crate) struct NamedCoordinate {
    /// The parameter, with its unit.
    pub name: String,
    /// What it is.
    pub kind: ParameterKind,
    /// Whether the coordinate is its logarithm.
    pub logarithmic: bool,
    /// Derivative of the parameter by the coordinate.
    pub slope: f64,
}

impl NamedCoordinate {
    /// The parameter without its unit: `k1` of `k1_n_per_m`.
    fn symbol(&self) -> String {
        self.kind.symbol_of(&self.name).replace('_', " ")
    }
}

/// The weakest direction as a sentence: which parameters can move together how far, and how little the response
/// changes then.
///
/// `quantity`: that of the sensitivities; of several waves that of the first, with the others weighted. With two
/// parameters the combination that remains determined is named too: moving `k1` by `d1` and `k2` by `d2` changes
/// nothing, so only `k1 - (d1/d2) k2` is known. `None` with fewer than two parameters.
pub(crate) fn weakest_direction(
    free: &[NamedCoordinate],
    covariance: &Covariance,
    quantity: FitQuantity,
) -> Option<String> {
    let along = &covariance.weakest;
    if free.len() < 2 || along.len() != free.len() {
        return None;
    }
    let variance = (along.transpose() * &covariance.matrix * along)[(0, 0)].max(0.0);
    let deviation = if covariance.rank < free.len() { f64::INFINITY } else { variance.sqrt() };
    let largest = along.amax();
    let mut parts: Vec<usize> = (0..free.len()).filter(|&i| along[i].abs() >= WORTH_NAMING * largest).collect();
    // Largest first; of equal ones the first.
    parts.sort_by(|&a, &b| along[b].abs().total_cmp(&along[a].abs()));
    let lead = *parts.first()?;
    let sign = along[lead].signum();
    // One percent of the leading parameter (of its scale, where the value is near zero).
    let unit = 0.01 / along[lead].abs();
    let named: Vec<String> = parts
        .iter()
        .map(|&i| {
            let suffix = if free[i].logarithmic { "" } else { " of its scale" };
            format!("{} {:+.2} %{suffix}", free[i].symbol(), 100.0 * unit * sign * along[i])
        })
        .collect();
    let moved = format!(
        "{} {} the {quantity} by only {} rms",
        named.join(", "),
        if named.len() == 1 { "moves" } else { "together move" },
        size(unit * covariance.weakest_change_m, quantity)
    );
    let determined = match parts[..] {
        [_] => format!("{} is the least determined", free[lead].symbol()),
        [a, b] if deviation > LOOSE => {
            let slope = |i: usize| along[i] * free[i].slope;
            let (first, second) = if comes_before(&free[a], &free[b], a < b) { (a, b) } else { (b, a) };
            let factor = -slope(first) / slope(second);
            let sign = if factor < 0.0 { '-' } else { '+' };
            format!("only {} {sign} {:.3} {} is determined", free[first].symbol(), factor.abs(), free[second].symbol())
        }
        _ if deviation > LOOSE => {
            let names: Vec<_> = parts.iter().map(|&i| free[i].symbol()).collect();
            format!("{} are not determined one by one", names.join(", "))
        }
        _ => "the least determined combination".to_owned(),
    };
    let width = if deviation.is_finite() {
        format!("standard deviation along it {:.2} %", 100.0 * deviation)
    } else {
        "nothing bounds it".to_owned()
    };
    Some(format!("{determined}: {moved}; {width}"))
}

/// Two parameters of one kind are ordered by name, others as in the model.
fn comes_before(a: &NamedCoordinate, b: &NamedCoordinate, in_the_model: bool) -> bool {
    if a.kind == b.kind { a.name < b.name } else { in_the_model }
}

/// A change of the response in a sentence: displacements in mm, others in the SI unit.
fn size(value: f64, quantity: FitQuantity) -> String {
    if quantity != FitQuantity::Displacement {
        return format!("{value:.2e} {}", quantity.unit());
    }
    let m = value;
    if m >= 1e-4 { format!("{:.2} mm", 1e3 * m) } else { format!("{m:.2e} m") }
}

/// Seed of the generators; replicate `i` uses its stream `i`.
const SEED: u64 = 1;
/// Length of a block in autocorrelation times of the misfit.
const BLOCK_TIMES: f64 = 2.0;
/// A block is at most one part in so many of the window.
const LARGEST_SHARE: usize = 3;

/// Fits the model to its own response with the misfit added in shuffled blocks, many times, and takes percentiles.
///
/// Moving blocks on a circle (Politis & Romano, "A circular block-resampling procedure for stationary data", 1992),
/// two autocorrelation times long but at most a third of the window, so that the correlation in time is kept. Several
/// waves are shuffled in the same blocks of time: an error that they share stays shared. Every replicate descends
/// from the minimum and draws from its own stream of a fixed seed, so the result does not depend on the number of
/// threads.
///
/// Contains no other minimum, and no error that is the same in the whole record. `misfit`: the weighted residuals;
/// `fit`: the values of `names` for a resampled record. `None` with fewer than 20 fits.
pub(crate) fn replicate(
    observed: &Observation,
    misfit: &[f64],
    replicates: usize,
    names: Vec<String>,
    fit: impl Fn(&Observation) -> Option<Vec<f64>> + Sync,
) -> Option<BlockBootstrap> {
    let misfits = observed.split(misfit);
    let n = misfits.first()?.len();
    // In samples of the first wave; the same blocks of time for all.
    let time = misfits
        .iter()
        .map(|samples| geyer_autocorrelation_time(samples) * n as f64 / samples.len() as f64)
        .fold(0.0, f64::max);
    let block = ((BLOCK_TIMES * time).ceil() as usize).clamp(1, n / LARGEST_SHARE);
    let fits: Vec<Option<Vec<f64>>> = (0..replicates)
        .into_par_iter()
        .map(|index| {
            let places = circular_blocks(&mut RandomNumbers::of_stream(SEED, index), n, block);
            let mut resampled = observed.clone();
            for (wave, misfit) in resampled.waves.iter_mut().zip(&misfits) {
                let samples = misfit.len();
                for (k, sample) in wave.samples.iter_mut().enumerate() {
                    let drawn = places[k * n / samples] * samples / n;
                    // The misfit is model minus record, times the weight.
                    *sample += (misfit[k] - misfit[drawn]) / wave.weight;
                }
            }
            fit(&resampled)
        })
        .collect();
    let fits: Vec<Vec<f64>> = fits.into_iter().flatten().collect();
    if fits.len() < 20 {
        return None;
    }
    let interval = names
        .into_iter()
        .enumerate()
        .map(|(i, name)| {
            let mut values: Vec<f64> = fits.iter().map(|f| f[i]).collect();
            (name, (percentile(&mut values, 0.025), percentile(&mut values, 0.975)))
        })
        .collect();
    Some(BlockBootstrap { replicates: fits.len(), block, interval })
}

/// The quantile `share` of values, by linear interpolation between order statistics; sorts them. `None` without
/// values.
pub(crate) fn percentile(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    quantile(values, share)
}

/// What is computed beyond the covariance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AssessmentOptions {
    /// Profile likelihood of every parameter.
    pub profile: bool,
    /// Replicates of a block bootstrap; 0: none.
    pub bootstrap: usize,
}

impl Minimum {
    /// Assesses a model at the minimum of its misfit; `None` where no parameter is determined.
    ///
    /// `given`: the values to assess, where they are not those of the minimum, such as a closed form that follows two
    /// events instead of the whole curve. Their intervals are those of the minimum, as the shortest that also hold
    /// these values; the deviation holds the distance `a` from it, `s² + a²`.
    ///
    /// A parameter at zero is assessed from its one side. One at another bound, or without effect in the window, is
    /// left out of the matrices and has an open interval. Where masses are fitted, the last one is the rest of the
    /// total and follows from the others.
    pub fn assess(&self, given: Option<&Model>, options: AssessmentOptions) -> Option<Assessment> {
        self.assess_with(given.map(|model| (model, false)), &DMatrix::zeros(self.free.len(), 0), options)
    }

    /// The same with uncertain inputs: `by_inputs`, the change of each coordinate by one deviation of each. `given`:
    /// also whether the values are those of a fit.
    pub(crate) fn assess_with(
        &self,
        given: Option<(&Model, bool)>,
        by_inputs: &DMatrix<f64>,
        options: AssessmentOptions,
    ) -> Option<Assessment> {
        let coordinates = self.coordinates();
        let of_given = |(model, is_of_fit): (&Model, bool)| {
            let values = model.values();
            Given { values: self.free.iter().map(|p| values[p.index]).collect(), is_of_fit }
        };
        let at = AtMinimum {
            coordinates: &coordinates,
            observed: &self.observed,
            theta: &coordinates.start(),
            on_bound: &self.on_bound,
            misfit: &self.misfit_m,
            sensitivities: &self.sensitivity_m,
            by_inputs,
            of_curves: curve_intervals(self),
        };
        let mut assessment = at.assess(given.map(of_given).as_ref(), options)?;
        open_knots_beside_open_ones(self.model.kind(), &mut assessment.interval);
        Some(assessment)
    }
}

impl Assessment {
    /// Extends every closed interval to the value of its parameter in a model: one that is written beside a value holds
    /// it, where that stands on a bound of its search, too.
    pub fn hold(&mut self, model: &Model) {
        let values = model.parameters();
        for (name, (low, high)) in &mut self.interval {
            let Some(value) = values.get(name.as_str()) else { continue };
            *low = low.map(|low| low.min(*value));
            *high = high.map(|high| high.max(*value));
        }
    }
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

/// Values of the free numbers to assess in place of those of the minimum.
struct Given {
    values: Vec<f64>,
    /// Whether they are those of a fit.
    is_of_fit: bool,
}

/// A minimum of anything with free numbers. Misfit and sensitivities by the coordinates are weighted, in the unit of
/// the first wave: one row for each sample, wave after wave.
struct AtMinimum<'a> {
    /// The free numbers.
    coordinates: &'a Coordinates,
    /// What they were fitted to.
    observed: &'a Observation,
    /// Coordinates of the minimum.
    theta: &'a [f64],
    /// Which of them stand on a bound.
    on_bound: &'a [bool],
    /// Misfit there.
    misfit: &'a [f64],
    /// One column for each coordinate.
    sensitivities: &'a DMatrix<f64>,
    /// Change of every coordinate by one deviation of each uncertain input.
    by_inputs: &'a DMatrix<f64>,
    /// Intervals of all free numbers, where they are known beside the minimum; they are extended to its values.
    of_curves: Option<Intervals>,
}

impl AtMinimum<'_> {
    /// See [`Minimum::assess`].
    fn assess(&self, given: Option<&Given>, options: AssessmentOptions) -> Option<Assessment> {
        let (free, theta, names) = (&self.coordinates.free, self.theta, self.coordinates.names());
        // What stands on zero is assessed from its one side; what stands on the end of the search is not assessed.
        // Neither is what moves nothing in the window: it stays open on both sides.
        let on_zero = |i: usize| free[i].value(theta[i]) == 0.0;
        let assessed = |i: &usize| (!self.on_bound[*i] || on_zero(*i)) && self.sensitivities.column(*i).norm() > 0.0;
        let kept: Vec<usize> = (0..theta.len()).filter(assessed).collect();
        let columns = self.sensitivities.select_columns(&kept);
        let source = AccelerationLikelihood::of(self.coordinates, self.observed, theta, &kept);
        let mut covariance = self.covariance(&columns, source.as_ref())?;
        covariance.add(&self.by_inputs.select_rows(&kept));
        let mut standard_deviation = BTreeMap::new();
        let value = |i: usize| given.map_or_else(|| free[i].value(theta[i]), |given| given.values[i]);
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
        let is_of_fit = given.is_none_or(|given| given.is_of_fit);
        if let Some(source) = source.filter(|source| is_of_fit && source.explains()) {
            let held = |i: usize| Some(free[i].coordinate(value(i))).filter(|x| x.is_finite()).unwrap_or(theta[i]);
            let held: Vec<f64> = (0..theta.len()).map(held).collect();
            let curved = source.curved(&names, (theta, &held, &kept), (&covariance, self.by_inputs));
            interval.extend(curved.into_iter().map(|(i, ends)| (names[i].clone(), ends)));
        }
        match &self.of_curves {
            Some(of_curves) => interval.extend((0..names.len()).filter_map(|i| {
                let (low, high) = self.widened(i, *of_curves.get(&names[i])?);
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

    /// An interval about the minimum with the uncertain inputs.
    fn widened(&self, i: usize, ends: Ends) -> Ends {
        widened(&self.coordinates.free[i], self.theta[i], self.by_inputs.row(i).norm(), ends)
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
            *high = high.filter(|high| *high < free[i].value(free[i].bounds.1));
            if low.is_some() && high.is_some() {
                closed.push(i);
            }
        }
        if closed.is_empty() || self.observed.waves.iter().any(|wave| SensorNoise::of(wave).is_none()) {
            return;
        }
        let source = AccelerationLikelihood::of_knots(self.coordinates, self.observed, self.theta, kept);
        for i in closed {
            let ends = source.as_ref().and_then(|source| source.whole_range(names, i)).unwrap_or_default();
            let (low, high) = self.widened(i, ends);
            let ends = (low.map(|low| low.min(value(i))), high.map(|high| high.max(value(i))));
            interval.insert(names[i].clone(), ends);
        }
    }

    /// The covariance from the noise of the sensors where that is known, and from the misfit where the noise does not
    /// explain it.
    fn covariance(&self, columns: &DMatrix<f64>, source: Option<&AccelerationLikelihood<'_>>) -> Option<Covariance> {
        let waves = &self.observed.waves;
        let noises = source.map(|source| &source.noises);
        let middle_of = |k: usize| {
            move |rows: &DMatrix<f64>| {
                noises.map_or_else(|| rows.tr_mul(rows), |of| of[k].0.projected_noise_covariance(&waves[k], rows))
            }
        };
        let projected: Vec<_> = (0..waves.len()).map(middle_of).collect();
        let sensor = |k: usize| {
            let (noise, explains_residuals) = &noises?[k];
            let explains_residuals = *explains_residuals;
            Some(SensorError { projected_noise_covariance: &projected[k], freedom: noise.freedom, explains_residuals })
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
        let bounds: Vec<(f64, f64)> = free.iter().map(|number| number.bounds).collect();
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
        let half = places.iter().map(factor).fold(NORMAL_95, f64::max) * deviation;
        if half.is_finite() { (Some((value - half).max(0.0)), Some(value + half)) } else { (None, None) }
    };
    (deviation, ends)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_numerics::estimation::statistics::covariance;
    use nalgebra::DMatrix;

    fn spring(name: &str, value: f64) -> NamedCoordinate {
        let kind = ParameterKind::Stiffness;
        NamedCoordinate { name: name.to_owned(), kind, logarithmic: true, slope: value }
    }

    #[test]
    fn two_springs_of_which_only_a_sum_acts_are_named_with_their_combination() {
        // Displacement depends on k1 + 0.9 k2, and hardly on the rest; coordinates are logarithms.
        let (k1, k2) = (3e5, 6e5);
        let j = DMatrix::from_fn(100, 2, |i, k| {
            let t = i as f64 / 100.0;
            let by_value = if k == 0 { t } else { 0.9 * t + 1e-7 * (20.0 * t).sin() };
            by_value * if k == 0 { k1 } else { k2 } * 1e-6
        });
        let noise: Vec<f64> = (0..100).map(|i| 1e-3 * (f64::from(i * i)).sin()).collect();
        let estimate = covariance(&j, &noise, 0.0).unwrap();
        let text = weakest_direction(
            &[spring("k1_n_per_m", k1), spring("k2_n_per_m", k2)],
            &estimate,
            FitQuantity::Displacement,
        )
        .unwrap();
        assert!(text.starts_with("only k1 + 0.900 k2 is determined: k1 +1.00 %, k2 -0.56 %"), "{text}");
    }
}
