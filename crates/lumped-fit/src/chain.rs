//! Chains of masses: as they are stated for a fit, the fit to the motion of one or several sensors, and its duals.
//!
//! Every mass, spring and damper is given or free. Free ones are fitted as logarithms, so that each trial is positive;
//! bounds that are not stated follow from the size of the chain, see [`coordinates`](crate::coordinates). A fit has
//! three steps: a search from many starts on the motion itself, the noise levels of the sensors and the minimum in
//! turn, and, where all filters are known, the same with each wave sampled, filtered and integrated like its record.
//!
//! With `mu = (m1 + m2)/m2` the dual of two masses has `k1' = mu k2`, `k2' = k1/mu` and dampers alike: it exchanges
//! front and rear. A sensor on the last mass alone cannot tell the two apart, see [`DoubleSpringMassDamper::dual`].

use std::f64::consts::FRAC_PI_2;

use crumple_lumped::{Chain, DoubleSpringMassDamper, LumpedError, Model, ParameterKind, PiecewiseLinear};
use crumple_numerics::estimation::minimise::levenberg_marquardt::Optimum;
use serde::Serialize;

use crate::candidate::{Candidate, Fit, Method};
use crate::coordinates::{Coordinates, DAMPER_BOUNDS, DAMPER_STARTS, SPRING_BOUNDS, SPRING_STARTS};
use crate::error::SolveError;
use crate::fit::as_measured::finish;
use crate::fit::problem::Problem;
use crate::fit::search::{AS_GOOD, REPORTED, Search, all, bounds, distinct, search};
use crate::parameters::{FitParameter, Map};
use crate::record::observation::Observation;

/// A number that is given or to be found. Masses in kg, stiffness in N/m, damping in N·s/m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Stated {
    /// Given.
    Fixed(f64),
    /// Found between bounds, from a start; what is `None` is taken from the size of the other numbers.
    Free {
        /// Where the search starts first.
        start: Option<f64>,
        /// Smallest value, above zero.
        lower: Option<f64>,
        /// Largest value.
        upper: Option<f64>,
    },
}

/// A mass of the chain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StatedMass {
    /// Given or free.
    Own(Stated),
    /// What the other masses leave of the total.
    Rest,
}

/// A mass with the spring and damper in front of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedElement {
    /// The mass, kg.
    pub mass_kg: StatedMass,
    /// Stiffness in N/m at knots of the compression in m; one knot at zero is a constant. Places of knots are given.
    pub stiffness: Vec<(f64, Stated)>,
    /// Damping in N·s/m at knots of the rate of the compression in m/s.
    pub damping: Vec<(f64, Stated)>,
}

/// A chain from the barrier on, to be fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedChain {
    /// Its masses.
    pub elements: Vec<StatedElement>,
    /// Total mass, kg, which a mass that is the rest needs, and the bounds of masses without any.
    pub total_mass_kg: Option<f64>,
}

/// A stated chain with the logarithms of its free numbers, in the order: mass, springs, dampers of the first element,
/// then of the next.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ChainCoordinates {
    /// What a fit moves; it starts where stated, else in the middle of the box.
    pub numbers: Coordinates,
    /// Whether a person gave the lower and the upper bound of each.
    given_bounds: Vec<(bool, bool)>,
}

/// What is read of a stated chain so far.
struct Reading<'a> {
    stated: &'a StatedChain,
    /// Whether a mass is stated to be the rest, wherever it stands.
    leaves_a_rest: bool,
    free: Vec<FitParameter>,
    given_bounds: Vec<(bool, bool)>,
}

/// Bounds of springs and where searches start, in their unit; of dampers.
const SPRINGS: [(f64, f64); 2] = [SPRING_BOUNDS, SPRING_STARTS];
const DAMPERS: [(f64, f64); 2] = [DAMPER_BOUNDS, DAMPER_STARTS];
/// Bounds of free masses as shares of the total, and the shares between which searches start.
const MASSES: [(f64, f64); 2] = [(1e-3, 0.999), (0.05, 0.6)];
/// Two numbers nearer than this, relatively, are the same.
const ROUNDING: f64 = 1e-9;
/// A start that is given is the middle of a range from a fifth to five times it, in which the other starts lie.
pub(crate) const AROUND: f64 = 5.0;

impl ChainCoordinates {
    /// Reads a stated chain for a fit over a window that ends `length_s` after contact.
    ///
    /// Errors: nothing that is free, a rest without a total or stated twice, given masses that leave nothing for the
    /// rest, numbers and bounds without meaning, a coefficient whose first knot is not at zero.
    pub fn new(stated: &StatedChain, length_s: f64) -> Result<Self, SolveError> {
        let fixed: f64 = stated.elements.iter().filter_map(|e| fixed_kg(e.mass_kg)).sum();
        let total_kg = stated.total_mass_kg.unwrap_or(fixed);
        let total_kg = if total_kg > 0.0 { total_kg } else { 1.0 };
        let (spring, damper) = (total_kg * (FRAC_PI_2 / length_s).powi(2), total_kg / length_s);
        let is_rest = |element: &StatedElement| element.mass_kg == StatedMass::Rest;
        let leaves_a_rest = stated.elements.iter().any(is_rest);
        let mut reading = Reading { stated, leaves_a_rest, free: Vec::new(), given_bounds: Vec::new() };
        let (mut masses, mut springs, mut dampers) = (Vec::new(), Vec::new(), Vec::new());
        let mut rest = None;
        // Places among the numbers of the chain: masses, values of springs, values of dampers.
        let mut next_spring = stated.elements.len();
        let mut next_damper = next_spring + stated.elements.iter().map(|e| e.stiffness.len()).sum::<usize>();
        for (i, element) in stated.elements.iter().enumerate() {
            for law in [&element.stiffness, &element.damping] {
                if let Some((knot, _)) = law.first().filter(|(knot, _)| *knot != 0.0) {
                    let expected = "zero, where a coefficient that is fitted begins";
                    return Err(SolveError::Value { name: "first knot", value: *knot, expected });
                }
            }
            masses.push(match element.mass_kg {
                StatedMass::Own(mass) => {
                    let name = || format!("m{}_kg", i + 1);
                    reading.take(mass, (ParameterKind::Mass, i), (total_kg, MASSES), name)?
                }
                StatedMass::Rest => {
                    let total = stated.total_mass_kg.ok_or(SolveError::RestWithoutTotal)?;
                    if rest.replace(i).is_some() {
                        return Err(SolveError::TwoRests);
                    }
                    crate::error::positive("total mass", total)?;
                    if fixed >= total {
                        return Err(SolveError::NothingLeft { total_kg: total, given_kg: fixed });
                    }
                    total - fixed
                }
            });
            let kinds = (ParameterKind::Stiffness, ParameterKind::Damping);
            springs.push(reading.law(&element.stiffness, (kinds.0, i, &mut next_spring), (spring, SPRINGS))?);
            dampers.push(reading.law(&element.damping, (kinds.1, i, &mut next_damper), (damper, DAMPERS))?);
        }
        if reading.free.is_empty() {
            return Err(SolveError::NothingFree);
        }
        // What is given must make a chain, whatever the free numbers are.
        let start = chain_of(&masses, &springs, &dampers)?;
        let numbers = Coordinates::new(Model::Chain(start), reading.free).with_rest(rest, total_kg);
        Ok(Self { numbers, given_bounds: reading.given_bounds })
    }

    /// Numbers whose bounds were all stated.
    pub fn within(numbers: Coordinates) -> Self {
        let given_bounds = vec![(true, true); numbers.free.len()];
        Self { numbers, given_bounds }
    }

    /// The coordinates of a chain, if it is one that was stated: numbers that were given have their values to a
    /// rounding, free ones lie within the bounds that were stated. Bounds of the search alone exclude nothing. `None`
    /// otherwise.
    pub fn point(&self, chain: &Chain) -> Option<Vec<f64>> {
        let other = chain.values();
        if other.len() != self.numbers.template.values().len() {
            return None;
        }
        let within = |((number, x), (lower, upper)): ((&FitParameter, f64), &(bool, bool))| {
            let low = if *lower { number.bounds.0 } else { f64::NEG_INFINITY };
            let high = if *upper { number.bounds.1 } else { f64::INFINITY };
            // The logarithm of what is not positive is no number, or minus infinity.
            let is_within = x.is_finite() && x >= low - ROUNDING && x <= high + ROUNDING;
            is_within.then(|| x.clamp(low, high))
        };
        let free = self.numbers.free.iter().zip(self.numbers.coordinates_of(&Model::Chain(chain.clone())));
        let theta = free.zip(&self.given_bounds).map(within).collect::<Option<Vec<f64>>>()?;
        let own = self.numbers.model(&theta)?.values();
        let same = |(value, other): (&f64, &f64)| (value - other).abs() <= 4.0 * ROUNDING * value.abs();
        own.iter().zip(&other).all(same).then_some(theta)
    }

    /// A flag of every free number, carried over to the dual of two masses, in which the first and second spring
    /// change places, and so do the dampers.
    pub fn exchanged(&self, of: &[bool]) -> Vec<bool> {
        // Masses, springs, dampers, two of each.
        let other = |index: usize| if index < 2 { index } else { index ^ 1 };
        let free = &self.numbers.free;
        let at = |index: usize| free.iter().position(|number| number.index == other(index));
        free.iter().map(|number| at(number.index).is_some_and(|k| of.get(k) == Some(&true))).collect()
    }
}

/// The chain of these masses, kg, and laws, `(knot, value)` each. Errors: a mass that is not positive, knots that do
/// not rise.
fn chain_of(masses: &[f64], springs: &[Vec<(f64, f64)>], dampers: &[Vec<(f64, f64)>]) -> Result<Chain, LumpedError> {
    let laws = |of: &[Vec<(f64, f64)>]| -> Result<Vec<PiecewiseLinear>, LumpedError> {
        of.iter().map(|points| PiecewiseLinear::new(points)).collect()
    };
    Chain::new(masses, &laws(springs)?, &laws(dampers)?)
}

/// A mass that is given, kg.
fn fixed_kg(mass: StatedMass) -> Option<f64> {
    match mass {
        StatedMass::Own(Stated::Fixed(kg)) => Some(kg),
        _ => None,
    }
}

impl Reading<'_> {
    /// Adds the values of a law in front of mass `i`, from `next` on among the numbers of the chain.
    fn law(
        &mut self,
        points: &[(f64, Stated)],
        (kind, i, next): (ParameterKind, usize, &mut usize),
        scale: (f64, [(f64, f64); 2]),
    ) -> Result<Vec<(f64, f64)>, SolveError> {
        let symbol = if kind == ParameterKind::Stiffness { 'k' } else { 'c' };
        let (number, unit) = (i + 1, kind.unit_in_name());
        let mut law = Vec::new();
        for (j, (knot, value)) in (1..).zip(points) {
            let name = || match points {
                [_] => format!("{symbol}{number}_{unit}"),
                _ => format!("{symbol}{number}_knot{j}_{unit}"),
            };
            law.push((*knot, self.take(*value, (kind, *next), scale, name)?));
            *next += 1;
        }
        Ok(law)
    }

    /// Adds one number to the chain and gives its value at the start of the fit.
    ///
    /// A given number is only passed on. A free one gets bounds: those stated, else `bounds` times `size`, widened so
    /// that what was stated is never outside (springs and dampers to a thousandth and a thousand times it). Its start
    /// is the one stated, else the geometric mean of the range in which searches start. Errors: numbers that are not
    /// positive, bounds that do not rise, a free mass without a total and without both bounds.
    fn take(
        &mut self,
        stated: Stated,
        (kind, index): (ParameterKind, usize),
        (size, [bounds, searched]): (f64, [(f64, f64); 2]),
        name: impl FnOnce() -> String,
    ) -> Result<f64, SolveError> {
        let (start, lower, upper) = match stated {
            Stated::Fixed(value) => return Ok(value),
            Stated::Free { start, lower, upper } => (start, lower, upper),
        };
        let name = name();
        let given = [lower, start, upper];
        for value in given.iter().flatten() {
            if !(value.is_finite() && *value > 0.0) {
                return Err(SolveError::Bounds { name, problem: format!("{value} is not positive") });
            }
        }
        let known: Vec<f64> = given.into_iter().flatten().collect();
        if known.windows(2).any(|pair| pair[0] > pair[1]) || (lower.is_some() && lower == upper) {
            let problem = "lower, start and upper do not rise".to_owned();
            return Err(SolveError::Bounds { name, problem });
        }
        // Bounds of the search are widened to what was stated, however far outside it is.
        let least = known.first().copied().unwrap_or(size);
        let most = known.last().copied();
        let is_mass_of_no_total = kind == ParameterKind::Mass && self.stated.total_mass_kg.is_none();
        if is_mass_of_no_total && (lower.is_none() || upper.is_none()) {
            let problem = "without a mass of the vehicle a free mass needs both bounds".to_owned();
            return Err(SolveError::Bounds { name, problem });
        }
        let from = lower.unwrap_or((bounds.0 * size).min(1e-3 * least));
        // Where a mass is the rest, a free one leaves something for it, unless it was started beyond.
        let unsaid = if self.leaves_a_rest { 0.0 } else { size };
        let beyond = if bounds.1 < 1.0 { most.unwrap_or(unsaid) } else { 1e3 * most.unwrap_or(size) };
        let to = upper.unwrap_or((bounds.1 * size).max(beyond));
        if from >= to {
            let problem = format!("nothing is left between {from} and {to}");
            return Err(SolveError::Bounds { name, problem });
        }
        let (low, high) = match (start, lower, upper) {
            (Some(start), ..) => (start / AROUND, start * AROUND),
            (None, Some(lower), Some(upper)) => (lower, upper),
            _ => (searched.0 * size, searched.1 * size),
        };
        let (low, high) = (low.clamp(from, to), high.clamp(from, to));
        let value = start.unwrap_or((low * high).sqrt());
        let (bounds, starts) = ((from.ln(), to.ln()), (low.ln(), high.ln()));
        self.free.push(FitParameter::of_search((index, name.into(), kind), Map::Logarithm(1.0), bounds, starts));
        self.given_bounds.push((lower.is_some(), upper.is_some()));
        Ok(value)
    }
}

/// Two chains whose springs and dampers are nearer than this are one.
const OWN_DUAL: f64 = 1e-6;

/// The dual chain; `None` for any but two masses with constant coefficients.
pub(crate) fn dual(chain: &Chain) -> Option<Chain> {
    let ([m1_kg, m2_kg], [k1, k2], [c1, c2]) = (chain.masses_kg(), chain.springs(), chain.dampers()) else {
        return None;
    };
    let double = DoubleSpringMassDamper {
        m1_kg: *m1_kg,
        m2_kg: *m2_kg,
        k1_n_per_m: k1.as_constant()?,
        k2_n_per_m: k2.as_constant()?,
        c1_n_s_per_m: c1.as_constant()?,
        c2_n_s_per_m: c2.as_constant()?,
    }
    .dual();
    let laws = |values: [f64; 2]| values.map(PiecewiseLinear::constant);
    let (springs, dampers) =
        (laws([double.k1_n_per_m, double.k2_n_per_m]), laws([double.c1_n_s_per_m, double.c2_n_s_per_m]));
    Chain::new(&[double.m1_kg, double.m2_kg], &springs, &dampers).ok()
}

/// The values of the springs, then of the dampers, from the barrier on; `None` where a law has knots.
fn constants(chain: &Chain) -> Option<Vec<f64>> {
    chain.springs().iter().chain(chain.dampers()).map(PiecewiseLinear::as_constant).collect()
}

/// Whether all waves are of the last mass. Only then does a chain of two have an equivalent dual.
pub(crate) fn sees_the_last_only(waves: &Observation, masses: usize) -> bool {
    waves.waves.iter().all(|wave| wave.mass.is_none_or(|mass| mass + 1 == masses))
}

/// The dual of a minimum, where it has one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum DualOf {
    /// At these coordinates of the stated chain.
    At(Vec<f64>),
    /// Outside of what was stated.
    Outside(Chain),
}

/// The dual of the chain at `theta`; `None` where it has none, or is its own.
pub(crate) fn dual_of(coordinates: &ChainCoordinates, chain: &Chain, theta: &[f64]) -> Option<DualOf> {
    let dual = dual(chain)?;
    // By value, not by name: a law with knots of one value is a constant under another name.
    let (own, other) = (constants(chain)?, constants(&dual)?);
    if own.iter().zip(&other).all(|(value, other)| (value - other).abs() <= OWN_DUAL * value.abs()) {
        return None;
    }
    Some(match coordinates.point(&dual) {
        Some(point) if point.len() == theta.len() => DualOf::At(point),
        _ => DualOf::Outside(dual),
    })
}

/// Rounds of weighing sensors seen through their filters, and the change of a weight that is worth another.
const WEIGHINGS: usize = 8;
/// Relative change of a weight for which the sensors are weighed once more.
const WORTH_ANOTHER: f64 = 1e-3;
/// Coordinates of the logarithms that differ by less are those of one set.
const SAME: f64 = 0.01;

impl StatedChain {
    /// Fits the free numbers of a chain to waves, each of a mass by its index from the barrier on (`None`: the last).
    ///
    /// Weighted least squares of the logarithms within bounds, by Levenberg-Marquardt on analytic sensitivities, from
    /// the stated start and from Halton points, at least six for each free number. The weight of a wave is that of its
    /// noise level, `1/s_w`, `s_w` the root mean square residual of the wave, found in turn with the fit.
    ///
    /// The minima are followed to those of the misfit as measured: after sampling, filter and integration, where these
    /// are known.
    ///
    /// Candidates come best first, each with its dual next to it, the softer first spring first. At most three sets
    /// within 1 % of the least weighted error are reported. Their fits have a sensor for each wave, without the name of
    /// its channel. Deterministic for any number of threads. A global minimum is likely, not proven.
    ///
    /// Errors: a chain without meaning, a wave of a mass that the chain does not have, no start with a finite response.
    pub fn fit(&self, observed: &Observation, starts: usize) -> Result<Vec<Candidate>, SolveError> {
        let length_s = observed.waves.iter().map(|w| w.window_s().1).fold(0.0, f64::max);
        if length_s <= 0.0 {
            return Err(SolveError::Value { name: "number of waves", value: 0.0, expected: "one or more" });
        }
        fit_stated(&ChainCoordinates::new(self, length_s)?, observed, starts)
    }
}

/// Fits the numbers of a stated model, see [`StatedChain::fit`].
pub(crate) fn fit_stated(
    coordinates: &ChainCoordinates,
    observed: &Observation,
    starts: usize,
) -> Result<Vec<Candidate>, SolveError> {
    let masses = coordinates.numbers.masses();
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
    let mut solutions: Vec<Candidate> = Vec::new();
    let mut places: Vec<Vec<f64>> = Vec::new();
    let mut sets = 0;
    for minimum in &minima {
        let known = places.iter().any(|other| other.iter().zip(&minimum.theta).all(|(a, b)| (a - b).abs() < SAME));
        if known || sets == REPORTED {
            continue;
        }
        let Some(mut primal) = solution(&problem, minimum, evaluations) else { continue };
        sets += 1;
        let place = solutions.len() + 1;
        places.push(minimum.theta.clone());
        let dual = match &primal.model {
            Model::Chain(chain) if sees_the_last_only(&waves, masses) => dual_of(coordinates, chain, &minimum.theta),
            _ => None,
        };
        let other = match dual {
            Some(DualOf::At(theta)) => {
                places.push(theta.clone());
                // What the search stopped at is the bound of the minimum: that of the other place in its dual.
                let on_bound = coordinates.exchanged(&minimum.on_bound);
                solution(&problem, &Optimum { theta, on_bound, ..minimum.clone() }, evaluations)
            }
            Some(DualOf::Outside(chain)) => {
                primal.excluded_dual = Some(chain);
                None
            }
            None => None,
        };
        match other {
            // The one with the softer first spring comes first, whichever was found first.
            Some(mut other) => {
                if first_spring(&other) < first_spring(&primal) {
                    std::mem::swap(&mut primal, &mut other);
                }
                let (first, second) = (Some(place), Some(place + 1));
                solutions.push(Candidate { index: place, equivalent_to: second, ..primal });
                solutions.push(Candidate { index: place + 1, equivalent_to: first, ..other });
            }
            None => solutions.push(Candidate { index: place, ..primal }),
        }
    }
    Ok(solutions)
}

/// Stiffness of the spring next to the barrier at no compression, N/m: orders a solution and its dual.
fn first_spring(candidate: &Candidate) -> f64 {
    let Model::Chain(chain) = &candidate.model else { return 0.0 };
    chain.springs().first().map_or(0.0, |spring| spring.at(0.0))
}

/// A minimum as a candidate, with errors and noise levels of every wave; `None` where the response there is not finite.
fn solution(problem: &Problem<'_>, minimum: &Optimum, evaluations: u64) -> Option<Candidate> {
    let (coordinates, waves) = (problem.coordinates, problem.observed);
    let masses = coordinates.masses();
    let sensors = waves.waves.iter().map(|wave| (String::new(), wave.mass.unwrap_or(masses - 1) + 1)).collect();
    let descent = (minimum.iterations, evaluations, minimum.stop);
    let minimum = finish(problem, minimum, evaluations)?;
    let on_bound = minimum.names_on_bound().collect();
    let fit = Fit::of_waves(waves, &waves.rmse(&minimum.misfit_m), sensors, descent, on_bound);
    let free_masses = coordinates.free.iter().any(|number| number.kind == ParameterKind::Mass);
    Some(Candidate {
        division_undecided: free_masses && masses > 1 && sees_the_last_only(waves, masses),
        fit: Some(fit),
        minimum: Some(minimum.clone()),
        ..Candidate::new(minimum.model, Method::DirectFit, 1, Vec::new())
    })
}
