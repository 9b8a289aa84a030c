//! What waves say of the free numbers of a chain, linearised about a minimum.

use std::collections::BTreeMap;

use crumple_estimation::statistics::lag_1_autocorrelation;
use nalgebra::DMatrix;

use crate::Observation;
use crate::chain::coordinates::ChainCoordinates;
use crate::uncertainty::identifiability::{NamedCoordinate, direction_in_words};
use crumple_estimation::minimise::levenberg_marquardt::Optimum;
use crumple_estimation::statistics::{Covariance, covariance_of_blocks};

/// Both ends of an interval; `None`: open.
type Ends = (Option<f64>, Option<f64>);

/// How well the free numbers are known, linearised about the minimum; see
/// [`covariance`](crumple_estimation::statistics::covariance).
#[derive(Debug, Clone, PartialEq)]
pub struct LinearisedUncertainty {
    /// Standard deviations, in the unit of each; none without a bound on it.
    pub standard_deviation: BTreeMap<String, f64>,
    /// 95 % intervals of everything that was free, with the mass that is the rest; `None`: open.
    pub interval: BTreeMap<String, (Option<f64>, Option<f64>)>,
    /// Names in the order of the correlation.
    pub order: Vec<String>,
    /// Correlation of the logarithms.
    pub correlation: Vec<Vec<f64>>,
    /// Condition of the sensitivities with columns of one length; `None` without full rank.
    pub condition: Option<f64>,
    /// Directions that the record determines, of as many as `order` has.
    pub rank: usize,
    /// The direction it determines least, in words.
    pub weakest_direction: Option<String>,
    /// Lag-1 autocorrelation of the misfit.
    pub residual_autocorrelation: f64,
    /// Independent samples that the misfit is worth.
    pub effective_samples: f64,
    /// Half-widths of the intervals of all coordinates, where they are known.
    pub(crate) half_width: Vec<Option<f64>>,
}

/// An interval of a logarithm that reaches over a factor of `e^9` says nothing.
const LARGEST_HALF_WIDTH: f64 = 9.0;

/// What residuals and sensitivities say of the parameters that are not on a bound.
pub(crate) fn linearised(
    coordinates: &ChainCoordinates,
    waves: &Observation,
    minimum: &Optimum,
    misfit: &[f64],
    sensitivities: &DMatrix<f64>,
) -> Option<LinearisedUncertainty> {
    let kept: Vec<usize> =
        (0..minimum.theta.len()).filter(|&i| !minimum.on_bound[i] && sensitivities.column(i).norm() > 0.0).collect();
    let covariance = covariance_of_blocks(&sensitivities.select_columns(&kept), misfit, &waves.blocks())?;
    let mut standard_deviation = BTreeMap::new();
    // What is on a bound, or moves nothing, is open.
    let mut interval: BTreeMap<String, Ends> =
        coordinates.all_names().into_iter().map(|name| (name, (None, None))).collect();
    let mut half_width = vec![None; minimum.theta.len()];
    for (k, &i) in kept.iter().enumerate() {
        let (value, half) = (minimum.theta[i].exp(), covariance.half_width[k]);
        if half < LARGEST_HALF_WIDTH {
            let name = &coordinates.names[i];
            half_width[i] = Some(half);
            standard_deviation.insert(name.clone(), value * covariance.matrix[(k, k)].max(0.0).sqrt());
            interval.insert(name.clone(), (Some(value * (-half).exp()), Some(value * half.exp())));
        }
    }
    if let Some((name, deviation, ends)) = of_the_rest(coordinates, &minimum.theta, &kept, &covariance, &half_width) {
        standard_deviation.insert(name.clone(), deviation);
        interval.insert(name, ends);
    }
    let named: Vec<NamedCoordinate> = kept
        .iter()
        .map(|&i| NamedCoordinate {
            name: coordinates.names[i].clone(),
            kind: coordinates.kind(i),
            logarithmic: true,
            slope: minimum.theta[i].exp(),
        })
        .collect();
    let split = waves.split(misfit);
    Some(LinearisedUncertainty {
        standard_deviation,
        interval,
        order: named.iter().map(|n| n.name.clone()).collect(),
        correlation: covariance.correlation().row_iter().map(|row| row.iter().copied().collect()).collect(),
        condition: Some(covariance.condition).filter(|c| c.is_finite()),
        rank: covariance.rank,
        weakest_direction: direction_in_words(&named, &covariance, waves.waves.first()?.quantity),
        residual_autocorrelation: split.iter().map(|misfit| lag_1_autocorrelation(misfit)).sum::<f64>()
            / split.len() as f64,
        effective_samples: covariance.effective_samples,
        half_width,
    })
}

/// Name, deviation and interval of the mass that is the rest: of one free mass its interval mirrored, of several the
/// deviation of their sum with the widest factor of theirs. `None` where a free mass is on a bound or open.
fn of_the_rest(
    coordinates: &ChainCoordinates,
    theta: &[f64],
    kept: &[usize],
    covariance: &Covariance,
    half_width: &[Option<f64>],
) -> Option<(String, f64, Ends)> {
    coordinates.free_rest()?;
    let name = coordinates.all_names().pop()?;
    let value = *coordinates.values(theta).last()?;
    let masses: Vec<usize> = (0..theta.len()).filter(|&i| coordinates.is_mass(i)).collect();
    let halves = masses.iter().map(|&i| half_width[i]).collect::<Option<Vec<f64>>>()?;
    let places = masses.iter().map(|i| kept.iter().position(|k| k == i)).collect::<Option<Vec<usize>>>()?;
    let value_of = |a: usize| theta[masses[a]].exp();
    let pairs = (0..masses.len()).flat_map(|a| (0..masses.len()).map(move |b| (a, b)));
    let variance: f64 = pairs.map(|(a, b)| value_of(a) * covariance.matrix[(places[a], places[b])] * value_of(b)).sum();
    let deviation = variance.max(0.0).sqrt();
    let ends = if let [half] = halves[..] {
        let total = value + value_of(0);
        ((total - value_of(0) * half.exp()).max(0.0), total - value_of(0) * (-half).exp())
    } else {
        let factor = |(half, k): (&f64, &usize)| half / covariance.matrix[(*k, *k)].sqrt();
        let half = halves.iter().zip(&places).map(factor).fold(1.96, f64::max) * deviation;
        ((value - half).max(0.0), value + half)
    };
    (ends.0.is_finite() && ends.1.is_finite()).then_some((name, deviation, (Some(ends.0), Some(ends.1))))
}
