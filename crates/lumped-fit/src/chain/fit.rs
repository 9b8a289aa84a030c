//! Chains of masses fitted to the motion of one or several sensors.
//!
//! In three steps: a search from many starts on the motion itself, the noise levels of the sensors and the minimum in
//! turn, and, where all filters are known, the same with each wave sampled, filtered and integrated like its record.
//! What is left of equal minima and duals is reported with covariance and duals.

use crumple_lumped::{Chain, ParameterKind};

use crate::chain::coordinates::{ChainCoordinates, StatedChain};
use crate::chain::dual::{ChainDual, DualOf, dual_of, sees_the_last_only};
use crate::fit::descents::{AS_GOOD, REPORTED, all, bounds, distinct};
use crate::fit::problem::Problem;
use crate::fit::search::{Search, search};
use crate::uncertainty::assessment::{Assessment, AssessmentOptions, AtMinimum};
use crate::{Fit, Observation, SolveError};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Optimum, derivatives};

/// Rounds of weighing sensors seen through their filters, and the change of a weight that is worth another.
const WEIGHINGS: usize = 8;
/// Relative change of a weight for which the sensors are weighed once more.
const WORTH_ANOTHER: f64 = 1e-3;
/// Coordinates of the logarithms that differ by less are those of one set.
const SAME: f64 = 0.01;

/// One way to meet the record with the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainSolution {
    /// The chain.
    pub chain: Chain,
    /// Names of what was free, as in [`Chain::parameters`]; a mass that is the rest comes last.
    pub free: Vec<String>,
    /// How it was fitted; a sensor for each wave, without the name of its channel.
    pub fit: Fit<String>,
    /// Covariance and intervals of the free numbers; `None` where nothing is determined.
    pub linearised: Option<Assessment>,
    /// The chain with the same masses and the same motion of the last one; `None` where a wave tells the two apart, or
    /// there is none.
    pub dual: Option<ChainDual>,
    /// Whether masses were fitted and no wave is of another mass than the last: their division is then in the
    /// record by a formula, and in practice not.
    pub division_undecided: bool,
    /// The logarithms of what was free.
    pub(crate) theta: Vec<f64>,
}

/// Fits the free numbers of a chain to waves, each of a mass by its index from the barrier on (`None`: the last).
///
/// Weighted least squares of the logarithms within bounds, by Levenberg-Marquardt on analytic sensitivities, from the
/// stated start and from Halton points, at least six for each free number. The weight of a wave is that of its noise
/// level, `1/s_w`, `s_w` the root mean square residual of the wave, found in turn with the fit.
///
/// The minima are followed to those of the misfit as measured: after sampling, filter and integration, where these are
/// known.
///
/// Solutions come best first, each with its dual next to it, the softer first spring first. At most three sets within
/// 1 % of the least weighted error are reported. Deterministic for any number of threads. A global minimum is likely,
/// not proven.
///
/// Errors: a chain without meaning, a wave of a mass that the chain does not have, no start with a finite response.
pub fn fit_chain(
    stated: &StatedChain,
    observed: &Observation,
    starts: usize,
) -> Result<Vec<ChainSolution>, SolveError> {
    let masses = stated.elements.len();
    let length_s = observed.waves.iter().map(|w| w.time_s(w.samples.len() - 1)).fold(0.0, f64::max);
    if length_s <= 0.0 {
        return Err(SolveError::Value { name: "number of waves", value: 0.0, expected: "one or more" });
    }
    let coordinates = ChainCoordinates::new(stated, length_s)?;
    let index = |mass: Option<usize>| mass.unwrap_or(masses - 1);
    if let Some(strange) = observed.waves.iter().map(|wave| index(wave.mass)).find(|mass| *mass >= masses) {
        return Err(SolveError::Value {
            name: "number of a mass with a sensor",
            value: (strange + 1) as f64,
            expected: "a mass of the chain",
        });
    }
    let starts = starts.max(6 * coordinates.numbers.free.len());
    let how = Search::Starts(starts, vec![coordinates.numbers.start()]);
    let searched = search(&coordinates.numbers, observed, &how).ok_or(SolveError::NoFit { starts })?;
    let mut waves = observed.clone();
    for (wave, found) in waves.waves.iter_mut().zip(&searched.observed.waves) {
        wave.weight = found.weight;
    }
    let (mut minima, mut evaluations) = (searched.minima, searched.evaluations);
    for _ in 0..WEIGHINGS {
        let problem = Problem::new(&coordinates.numbers, &waves, 0.0);
        let points = minima.iter().map(|m| m.theta.clone()).collect();
        let (next, spent) = all(&problem, points, &bounds(&coordinates.numbers, 200, 1e-12));
        evaluations += spent;
        minima = distinct(&coordinates.numbers, next);
        let Some(best) = minima.first() else { break };
        let rmse = problem.rmse(&best.theta).unwrap_or_default();
        if !waves.weigh(&rmse, WORTH_ANOTHER) {
            break;
        }
    }
    let best = minima.first().ok_or(SolveError::NoFit { starts })?.cost;
    minima.retain(|minimum| minimum.cost.sqrt() <= AS_GOOD * best.sqrt());
    let problem = Problem::new(&coordinates.numbers, &waves, 0.0);
    let mut solutions: Vec<ChainSolution> = Vec::new();
    let mut sets = 0;
    for minimum in &minima {
        let known = solutions.iter().any(|f| f.theta.iter().zip(&minimum.theta).all(|(a, b)| (a - b).abs() < SAME));
        if known || sets == REPORTED {
            continue;
        }
        let Some(mut primal) = solution(&problem, minimum, evaluations) else { continue };
        sets += 1;
        let place = solutions.len() + 1;
        let dual =
            sees_the_last_only(&waves, masses).then(|| dual_of(&coordinates, &primal.chain, &primal.theta)).flatten();
        let other = match dual {
            Some(DualOf::At(theta)) => {
                // What the search stopped at is the bound of the minimum: that of the other place in its dual.
                let on_bound = coordinates.exchanged(&minimum.on_bound);
                solution(&problem, &Optimum { theta, on_bound, ..minimum.clone() }, evaluations)
            }
            Some(DualOf::Outside(chain)) => {
                primal.dual = Some(ChainDual::NotAsStated(chain));
                None
            }
            None => None,
        };
        match other {
            // The one with the softer first spring comes first, whichever was found first.
            Some(mut other) => {
                if other.first_spring() < primal.first_spring() {
                    std::mem::swap(&mut primal, &mut other);
                }
                primal.dual = Some(ChainDual::Solution(place + 1));
                other.dual = Some(ChainDual::Solution(place));
                solutions.extend([primal, other]);
            }
            None => solutions.push(primal),
        }
    }
    Ok(solutions)
}

impl ChainSolution {
    /// Stiffness of the spring next to the barrier at no compression, N/m: orders a solution and its dual.
    fn first_spring(&self) -> f64 {
        self.chain.springs().first().map_or(0.0, |spring| spring.at(0.0))
    }
}

/// A minimum with errors of every wave, noise levels and linearised uncertainty; `None` where the response there is
/// not finite.
fn solution(problem: &Problem<'_, Chain>, minimum: &Optimum, evaluations: u64) -> Option<ChainSolution> {
    let (coordinates, waves) = (problem.coordinates, problem.observed);
    let chain = coordinates.model(&minimum.theta)?;
    let misfit = problem.misfit(&minimum.theta)?;
    let mut free = coordinates.names();
    let on_bound = free.iter().zip(&minimum.on_bound).filter(|(_, on_bound)| **on_bound);
    let on_bound = on_bound.map(|(name, _)| name.clone()).collect();
    let masses = coordinates.masses();
    let sensors = waves.waves.iter().map(|wave| (String::new(), wave.mass.unwrap_or(masses - 1) + 1)).collect();
    let descent = (minimum.iterations, evaluations, minimum.stop);
    let fit = Fit::of_waves(waves, &waves.rmse(&misfit), sensors, descent, on_bound);
    let free_masses = coordinates.free.iter().any(|number| number.kind == ParameterKind::Mass);
    free.extend(coordinates.free_rest(&minimum.theta).map(|(name, _)| name));
    Some(ChainSolution {
        chain,
        free,
        fit,
        linearised: assess_at(problem, (&minimum.theta, &minimum.on_bound), AssessmentOptions::default()),
        dual: None,
        division_undecided: free_masses && masses > 1 && sees_the_last_only(waves, masses),
        theta: minimum.theta.clone(),
    })
}

/// The assessment of a minimum at these coordinates, of which these stand on a bound.
pub(crate) fn assess_at(
    problem: &Problem<'_, Chain>,
    (theta, on_bound): (&[f64], &[bool]),
    options: AssessmentOptions,
) -> Option<Assessment> {
    let sensitivities = derivatives(problem, theta)? * problem.unit;
    let misfit = problem.misfit(theta)?;
    let (coordinates, observed) = (problem.coordinates, problem.observed);
    let at = AtMinimum {
        coordinates,
        observed,
        theta,
        on_bound,
        misfit: &misfit,
        sensitivities: &sensitivities,
        of_curves: None,
    };
    at.assess(None, options)
}
