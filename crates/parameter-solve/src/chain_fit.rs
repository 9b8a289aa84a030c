//! Chains of masses fitted to the motion of one or several sensors, and judged.

use std::collections::BTreeMap;

use crumple_lumped::{Instants, SecantChain};
use crumple_metrics::lag_1_autocorrelation;
use nalgebra::DMatrix;

use crate::covariance::covariance_of_blocks;
use crate::free_chain::{FreeChain, StatedChain};
use crate::free_model::{FreeModel, places};
use crate::identifiability::{Named, direction_in_words};
use crate::least_squares::{Optimum, Response, differences};
use crate::sensor_fit::{Search, all, bounds, distinct, fit_sensors};
use crate::sensor_problem::Observed as Seen;
use crate::window::Window;
use crate::{Observed, SolveError, StopReason};

/// Sets that are reported at most, and how near their errors must be to the best.
const REPORTED: usize = 3;
const AS_GOOD: f64 = 1.01;
/// Rounds of weighing sensors seen through their filters, and the change of a level that is worth another.
const WEIGHINGS: usize = 8;
const LEVEL_MOVED: f64 = 1e-3;
/// The least level of a sensor, as a share of its record.
const LEAST_LEVEL: f64 = 1e-6;

/// One way to meet the record with the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainSolution {
    /// The chain.
    pub chain: SecantChain,
    /// Names of what was free, as in [`SecantChain::parameters`]; a mass that is the rest comes last.
    pub free: Vec<String>,
    /// Those that stopped on a bound.
    pub on_bound: Vec<String>,
    /// Root mean square error of every wave, in its unit, and the level its residuals were divided by.
    pub rmse: Vec<f64>,
    /// See there.
    pub noise: Vec<f64>,
    /// Samples compared.
    pub samples: usize,
    /// Iterations of the descent that ended here.
    pub iterations: u32,
    /// Model evaluations of all starts.
    pub evaluations: u64,
    /// Why it stopped.
    pub stop_reason: StopReason,
    /// What the record says of the free numbers; `None` where there is nothing to judge by.
    pub knowledge: Option<ChainKnowledge>,
}

/// How well the free numbers are known, linearised about the minimum; see [`covariance`](crate::covariance).
#[derive(Debug, Clone, PartialEq)]
pub struct ChainKnowledge {
    /// Standard deviations, in the unit of each; none without a bound on it.
    pub standard_deviation: BTreeMap<String, f64>,
    /// 95 % intervals; `None`: open.
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
}

/// Fits the free numbers of a chain to waves, each of a mass by its index (`None`: the last).
///
/// Least squares in the logarithms within bounds: Levenberg-Marquardt on analytic sensitivities, or on differences where a
/// coefficient has knots, from the start that was given and from evenly spread (Halton) points; sensors weighed by their noise
/// levels as in the fits of the other models. `through_filter`: whether the measurement of every wave is known: then the
/// minima are followed to those of the misfit as measured. Deterministic for any number of threads; a global minimum is likely, not
/// proven. Errors: a chain without meaning, waves of masses it does not have, no start with a finite response.
pub fn fit_chain(
    stated: &StatedChain,
    observed: &Observed,
    through_filter: bool,
    starts: usize,
) -> Result<Vec<ChainSolution>, SolveError> {
    let masses = stated.elements.len();
    let length_s = observed.waves.iter().map(|w| w.time_s(w.samples.len() - 1)).fold(0.0, f64::max);
    if length_s <= 0.0 {
        return Err(SolveError::Value { name: "number of waves", value: 0.0, expected: "one or more" });
    }
    let family = FreeChain::new(stated, length_s)?;
    let index = |mass: Option<usize>| mass.unwrap_or(masses - 1);
    if let Some(strange) = observed.waves.iter().map(|wave| index(wave.mass)).find(|mass| *mass >= masses) {
        return Err(SolveError::Value {
            name: "number of a mass with a sensor",
            value: (strange + 1) as f64,
            expected: "a mass of the chain",
        });
    }
    let mut waves = observed.clone();
    let seen: Vec<Seen> = waves
        .waves
        .iter()
        .map(|wave| Seen {
            mass: index(wave.mass),
            quantity: wave.quantity,
            window: Window {
                first_s: wave.time_s(0),
                dt_s: wave.stride as f64 * wave.measurement.dt_s,
                samples: wave.samples.clone(),
            },
            noise: wave.size().max(f64::MIN_POSITIVE),
        })
        .collect();
    let starts = starts.max(6 * family.names.len());
    let search = Search::Starts(starts, vec![family.start.clone()]);
    let weigh = vec![true; seen.len()];
    let found = fit_sensors(&family, observed.impact_speed_m_per_s, seen, &weigh, &search)
        .ok_or(SolveError::NoFit { starts })?;
    for (wave, sensor) in waves.waves.iter_mut().zip(&found.sensors) {
        wave.weight = found.sensors[0].noise / sensor.noise;
    }
    let (mut minima, mut evaluations) = (found.minima, found.evaluations);
    if through_filter {
        for _ in 0..WEIGHINGS {
            let problem = ThroughFilters::new(&family, &waves);
            let points = minima.iter().map(|m| m.theta.clone()).collect();
            let (next, spent) = all(&problem, points, &bounds(&family, 200, 1e-12));
            evaluations += spent;
            minima = distinct(next);
            let Some(best) = minima.first() else { break };
            let levels = problem.levels(&best.theta).unwrap_or_default();
            if !reweigh(&mut waves, &levels) {
                break;
            }
        }
    } else {
        waves = waves.unfiltered();
    }
    let best = minima.first().ok_or(SolveError::NoFit { starts })?.cost;
    minima.retain(|minimum| minimum.cost.sqrt() <= AS_GOOD * best.sqrt());
    minima.truncate(REPORTED);
    let report = |minimum: &Optimum| solution(&family, &waves, &found.sensors, through_filter, minimum, evaluations);
    Ok(minima.iter().filter_map(report).collect())
}

/// Weighs the waves by the root mean square misfit of each; whether that changed anything.
fn reweigh(waves: &mut Observed, rmse: &[f64]) -> bool {
    let levels: Vec<f64> = waves
        .waves
        .iter()
        .zip(rmse)
        .map(|(wave, rmse)| rmse.max(LEAST_LEVEL * wave.size()).max(f64::MIN_POSITIVE))
        .collect();
    let mut moved = false;
    for (wave, level) in waves.waves.iter_mut().zip(&levels).skip(1) {
        let weight = levels[0] / level;
        moved |= (weight / wave.weight).ln().abs() > LEVEL_MOVED;
        wave.weight = weight;
    }
    moved
}

fn solution(
    family: &FreeChain,
    waves: &Observed,
    sensors: &[Seen],
    through_filter: bool,
    minimum: &Optimum,
    evaluations: u64,
) -> Option<ChainSolution> {
    let chain = family.model(&minimum.theta)?;
    let measured = ThroughFilters::new(family, waves);
    let direct =
        crate::sensor_problem::SensorProblem { family, impact_speed_m_per_s: waves.impact_speed_m_per_s, sensors };
    let rmse = if through_filter { measured.levels(&minimum.theta)? } else { direct.rmse(&minimum.theta)? };
    // Both in the unit of the first wave, times the weights.
    let (unit, residuals, sensitivities) = if through_filter {
        (measured.unit, residuals(&measured, &minimum.theta)?, derivatives(&measured, family, &minimum.theta)?)
    } else {
        (sensors[0].noise, residuals(&direct, &minimum.theta)?, derivatives(&direct, family, &minimum.theta)?)
    };
    let misfit: Vec<f64> = residuals.iter().map(|r| r * unit).collect();
    let knowledge = knowledge(family, waves, minimum, &misfit, &(sensitivities * unit));
    let mut free = family.names.clone();
    if let Some(rest) = family.rest().filter(|_| (0..free.len()).any(|i| family.is_mass(i))) {
        free.push(format!("m{}_kg", rest + 1));
    }
    let held = family.names.iter().zip(&minimum.on_bound).filter(|(_, held)| **held);
    let first = rmse.first().copied().unwrap_or(0.0).max(LEAST_LEVEL * waves.waves[0].size());
    Some(ChainSolution {
        chain,
        free,
        on_bound: held.map(|(name, _)| name.clone()).collect(),
        noise: waves.waves.iter().map(|wave| first / wave.weight).collect(),
        rmse,
        samples: misfit.len(),
        iterations: minimum.iterations,
        evaluations,
        stop_reason: minimum.stop,
        knowledge,
    })
}

fn residuals(problem: &impl Response, theta: &[f64]) -> Option<Vec<f64>> {
    let mut residuals = vec![0.0; problem.rows()];
    problem.residuals(theta, &mut residuals).then_some(residuals)
}

fn derivatives(problem: &impl Response, family: &FreeChain, theta: &[f64]) -> Option<DMatrix<f64>> {
    let mut own = DMatrix::zeros(problem.rows(), theta.len());
    match problem.sensitivities(theta, &mut own) {
        Some(true) => Some(own),
        Some(false) => None,
        None => differences(problem, theta, &residuals(problem, theta)?, &bounds(family, 0, 0.0)),
    }
}

/// What residuals and sensitivities say of the parameters that are not on a bound.
fn knowledge(
    family: &FreeChain,
    waves: &Observed,
    minimum: &Optimum,
    misfit: &[f64],
    sensitivities: &DMatrix<f64>,
) -> Option<ChainKnowledge> {
    let kept: Vec<usize> =
        (0..minimum.theta.len()).filter(|&i| !minimum.on_bound[i] && sensitivities.column(i).norm() > 0.0).collect();
    let found = covariance_of_blocks(&sensitivities.select_columns(&kept), misfit, &waves.blocks())?;
    let mut standard_deviation = BTreeMap::new();
    // What is on a bound, or moves nothing, is open.
    let mut interval: BTreeMap<String, (Option<f64>, Option<f64>)> =
        family.names.iter().map(|name| (name.clone(), (None, None))).collect();
    for (k, &i) in kept.iter().enumerate() {
        let (value, half) = (minimum.theta[i].exp(), found.half_width[k]);
        // Beyond a factor of e^9 nothing is said.
        if half < 9.0 {
            let name = &family.names[i];
            standard_deviation.insert(name.clone(), value * found.matrix[(k, k)].max(0.0).sqrt());
            interval.insert(name.clone(), (Some(value * (-half).exp()), Some(value * half.exp())));
        }
    }
    let named: Vec<Named> = kept
        .iter()
        .map(|&i| Named { name: family.names[i].clone(), logarithmic: true, slope: minimum.theta[i].exp() })
        .collect();
    let split = waves.split(misfit);
    Some(ChainKnowledge {
        standard_deviation,
        interval,
        order: named.iter().map(|n| n.name.clone()).collect(),
        correlation: found.correlation().row_iter().map(|row| row.iter().copied().collect()).collect(),
        condition: Some(found.condition).filter(|c| c.is_finite()),
        rank: found.rank,
        weakest_direction: direction_in_words(&named, &found, waves.waves.first()?.quantity),
        residual_autocorrelation: split.iter().map(|own| lag_1_autocorrelation(own)).sum::<f64>() / split.len() as f64,
        effective_samples: found.effective_samples,
    })
}

/// Residuals of the chain as measured: sampled, filtered and integrated like every wave.
struct ThroughFilters<'a> {
    family: &'a FreeChain,
    waves: &'a Observed,
    /// One unit of residual, in the unit of the first wave.
    unit: f64,
}

impl<'a> ThroughFilters<'a> {
    fn new(family: &'a FreeChain, waves: &'a Observed) -> Self {
        Self { family, waves, unit: waves.scale_m() }
    }

    /// Root mean square misfit of every wave, in its unit.
    fn levels(&self, theta: &[f64]) -> Option<Vec<f64>> {
        let misfit: Vec<f64> = residuals(self, theta)?.iter().map(|r| r * self.unit).collect();
        Some(self.waves.rmse(&misfit))
    }

    /// What is measured of every wave's motion, and of its derivatives by these places.
    fn measured(&self, chain: &SecantChain, places: &[usize]) -> Option<Vec<Vec<Vec<f64>>>> {
        let v0 = self.waves.impact_speed_m_per_s;
        let last = chain.masses_kg().len() - 1;
        let of = |wave: &crate::SeenWave| {
            let what = (wave.mass.unwrap_or(last), wave.quantity);
            let respond = |at: &Instants| self.family.sensitivity(chain, v0, at, places);
            wave.measurement.of_motions(what, v0, wave.last(), respond).ok()
        };
        self.waves.waves.iter().map(of).collect()
    }
}

impl Response for ThroughFilters<'_> {
    fn rows(&self) -> usize {
        self.waves.rows()
    }

    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(chain) = self.family.model(theta) else { return false };
        let Some(measured) = self.measured(&chain, &[]) else { return false };
        let mut row = 0;
        for (wave, found) in self.waves.waves.iter().zip(&measured) {
            let picked = found[0].get(wave.first..).unwrap_or_default().iter().step_by(wave.stride);
            for (model, record) in picked.zip(&wave.samples) {
                out[row] = (model - record) * wave.weight / self.unit;
                row += 1;
            }
        }
        row == out.len() && out.iter().all(|r| r.is_finite())
    }

    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> Option<bool> {
        let chain = self.family.chain(theta)?;
        let places = places(&chain);
        let Some(measured) = self.family.model(theta).and_then(|model| self.measured(&model, &places)) else {
            return Some(false);
        };
        let mut first = 0;
        for (wave, found) in self.waves.waves.iter().zip(&measured) {
            for (j, by) in chain.iter().enumerate() {
                for k in 0..wave.samples.len() {
                    let at = wave.first + k * wave.stride;
                    let change: Option<f64> = by
                        .iter()
                        .map(|(place, factor)| {
                            let p = places.binary_search(place).ok()?;
                            Some(factor * found.get(p + 1)?.get(at)?)
                        })
                        .sum();
                    let Some(change) = change else { return Some(false) };
                    out[(first + k, j)] = change * wave.weight / self.unit;
                }
            }
            first += wave.samples.len();
        }
        Some(true)
    }
}
