//! Covariance of the fitted parameters of a chain, linearised about a minimum.
//!
//! The sandwich estimate of [`covariance_of_blocks`] on the logarithms of the free numbers, one block for each wave;
//! intervals are log-normal, so that masses, springs and dampers stay positive.

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

/// How well the free numbers of a chain are determined, to first order about the minimum; see
/// [`covariance`](crumple_estimation::statistics::covariance) for the formula.
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

/// Half-width of the interval of a logarithm from which the interval is called open: it spans a factor of `e^18`.
const LARGEST_HALF_WIDTH: f64 = 9.0;

/// Standard deviations, 95 % intervals and correlation from residuals and sensitivities at a minimum.
///
/// `misfit` holds the weighted residuals of all waves one after the other, `sensitivities` their derivatives by the
/// logarithms, both in the unit of the first wave: one row for each sample, one column for each free number. Numbers
/// on a bound and numbers without effect are left out of the matrices and have an open interval. Intervals are
/// log-normal, `p e^(±h)`, with `h` the half-width in the logarithm. `None` where nothing is determined.
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

/// Name, standard deviation and 95 % interval of the mass that is the rest of the total, kg.
///
/// Its variance is that of the sum of the free masses, `g' C g` with `g_a = m_a` and `C` the covariance of their
/// logarithms. With one free mass the interval is that of the free mass mirrored in the total; with several it is
/// normal, with the widest factor between deviation and half-width among theirs. `None` where a free mass is on a
/// bound or has an open interval.
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
