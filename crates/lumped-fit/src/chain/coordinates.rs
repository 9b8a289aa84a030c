//! A chain of masses as it is stated for a fit, and its free numbers as logarithms.
//!
//! Every mass, spring and damper is given or free. Free ones are fitted as logarithms, so that each trial is
//! positive; bounds that are not stated follow from the size of the chain, see
//! [`search_bounds`](crate::free::search_bounds).

use std::f64::consts::FRAC_PI_2;

use crumple_lumped::{Chain, Instants, LumpedError, ParameterKind, PiecewiseLinear, Sensitivity};

use serde::Serialize;

use crate::SolveError;
use crate::free::free_numbers::FreeNumbers;
use crate::free::parameterisation::{Axis, Parameterisation};
use crate::free::search_bounds::{DAMPER_BOUNDS, DAMPER_STARTS, SPRING_BOUNDS, SPRING_STARTS};

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

/// Which number of the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ChainNumber {
    Mass(usize),
    Spring(usize, usize),
    Damper(usize, usize),
}

/// A chain with its free numbers. A coordinate is the logarithm of a mass, spring or damper, in the order: mass,
/// springs, dampers of the first element, then of the next.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ChainCoordinates {
    /// Values of everything; free ones are overwritten.
    masses: Vec<f64>,
    /// `(knot, value)` of each spring, m and N/m.
    springs: Vec<Vec<(f64, f64)>>,
    /// `(knot, value)` of each damper, m/s and N·s/m.
    dampers: Vec<Vec<(f64, f64)>>,
    /// Place of the mass that is the rest of the total.
    rest: Option<usize>,
    /// Whether a mass is stated to be the rest, wherever it stands.
    leaves_a_rest: bool,
    /// The total, or the sum of the given masses where no total is known.
    total_kg: f64,
    total_known: bool,
    /// The free numbers with the bounds of their logarithms.
    free: Vec<(ChainNumber, Axis)>,
    /// Whether a person gave the lower and the upper bound of each.
    given_bounds: Vec<(bool, bool)>,
    /// The starts that were given, logarithms; the middle of the box for others.
    pub start: Vec<f64>,
    /// Their names with units, `k1_n_per_m` or `k1_knot2_n_per_m`.
    pub names: Vec<String>,
}

/// Bounds of springs and where searches start, in their unit; of dampers.
const SPRINGS: [(f64, f64); 2] = [SPRING_BOUNDS, SPRING_STARTS];
const DAMPERS: [(f64, f64); 2] = [DAMPER_BOUNDS, DAMPER_STARTS];
/// Bounds of free masses as shares of the total, and the shares between which searches start.
const MASSES: [(f64, f64); 2] = [(1e-3, 0.999), (0.05, 0.6)];
/// Two numbers nearer than this, relatively, are the same.
const ROUNDING: f64 = 1e-9;
/// A start that is given is the middle of a range from a fifth to five times it, in which the other starts lie.
const AROUND: f64 = 5.0;

impl ChainCoordinates {
    /// Reads a stated chain for a fit over a window that ends `length_s` after contact.
    ///
    /// Errors: nothing that is free, a rest without a total or stated twice, given masses that leave nothing for the
    /// rest, numbers and bounds without meaning, a coefficient whose first knot is not at zero.
    pub fn new(stated: &StatedChain, length_s: f64) -> Result<Self, SolveError> {
        let fixed: f64 = stated.elements.iter().filter_map(|e| fixed_kg(e.mass_kg)).sum();
        let total_kg = stated.total_mass_kg.unwrap_or(fixed);
        let total_kg = if total_kg > 0.0 { total_kg } else { 1.0 };
        let sizes = (total_kg * (FRAC_PI_2 / length_s).powi(2), total_kg / length_s);
        let mut chain = Self {
            masses: Vec::new(),
            springs: Vec::new(),
            dampers: Vec::new(),
            rest: None,
            leaves_a_rest: stated.elements.iter().any(|element| element.mass_kg == StatedMass::Rest),
            total_kg,
            total_known: stated.total_mass_kg.is_some(),
            free: Vec::new(),
            given_bounds: Vec::new(),
            start: Vec::new(),
            names: Vec::new(),
        };
        for (i, element) in stated.elements.iter().enumerate() {
            let number = i + 1;
            for law in [&element.stiffness, &element.damping] {
                if let Some((knot, _)) = law.first().filter(|(knot, _)| *knot != 0.0) {
                    let expected = "zero, where a coefficient that is fitted begins";
                    return Err(SolveError::Value { name: "first knot", value: *knot, expected });
                }
            }
            let mass = match element.mass_kg {
                StatedMass::Own(mass) => {
                    chain.take(mass, ChainNumber::Mass(i), (total_kg, MASSES), || format!("m{number}_kg"))?
                }
                StatedMass::Rest => {
                    let total = stated.total_mass_kg.ok_or(SolveError::RestWithoutTotal)?;
                    if chain.rest.replace(i).is_some() {
                        return Err(SolveError::TwoRests);
                    }
                    crate::error::positive("total mass", total)?;
                    if fixed >= total {
                        return Err(SolveError::NothingLeft { total_kg: total, given_kg: fixed });
                    }
                    total - fixed
                }
            };
            chain.masses.push(mass);
            let name = |symbol: char, j: usize, count: usize, unit: &str| match count {
                1 => format!("{symbol}{number}_{unit}"),
                _ => format!("{symbol}{number}_knot{}_{unit}", j + 1),
            };
            let mut springs = Vec::new();
            let count = element.stiffness.len();
            for (j, (knot, value)) in element.stiffness.iter().enumerate() {
                let scale = (sizes.0, SPRINGS);
                springs.push((
                    *knot,
                    chain.take(*value, ChainNumber::Spring(i, j), scale, || name('k', j, count, "n_per_m"))?,
                ));
            }
            let mut dampers = Vec::new();
            let count = element.damping.len();
            for (j, (knot, value)) in element.damping.iter().enumerate() {
                let scale = (sizes.1, DAMPERS);
                dampers.push((
                    *knot,
                    chain.take(*value, ChainNumber::Damper(i, j), scale, || name('c', j, count, "n_s_per_m"))?,
                ));
            }
            chain.springs.push(springs);
            chain.dampers.push(dampers);
        }
        if chain.free.is_empty() {
            return Err(SolveError::NothingFree);
        }
        // What is given must make a chain, whatever the free numbers are.
        chain.built(&chain.masses, &chain.springs, &chain.dampers)?;
        Ok(chain)
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
        place: ChainNumber,
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
        if matches!(place, ChainNumber::Mass(_)) && !self.total_known && (lower.is_none() || upper.is_none()) {
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
        let axis = Axis { lower: from.ln(), upper: to.ln(), box_lower: low.ln(), box_upper: high.ln() };
        let value = start.unwrap_or((low * high).sqrt());
        self.start.push(value.ln());
        self.free.push((place, axis));
        self.given_bounds.push((lower.is_some(), upper.is_some()));
        self.names.push(name);
        Ok(value)
    }

    /// The chain of these values, `(knot, value)` for each law. Errors: a mass that is not positive, knots that do
    /// not rise.
    fn built(
        &self,
        masses: &[f64],
        springs: &[Vec<(f64, f64)>],
        dampers: &[Vec<(f64, f64)>],
    ) -> Result<Chain, LumpedError> {
        let laws = |of: &[Vec<(f64, f64)>]| -> Result<Vec<PiecewiseLinear>, LumpedError> {
            of.iter().map(|points| PiecewiseLinear::new(points)).collect()
        };
        Chain::new(masses, &laws(springs)?, &laws(dampers)?)
    }

    /// Number of masses.
    pub fn masses(&self) -> usize {
        self.masses.len()
    }

    /// Names of all free numbers; a mass that is the rest, and follows from a free one, comes last.
    pub fn all_names(&self) -> Vec<String> {
        let rest = self.free_rest().map(|rest| format!("m{}_kg", rest + 1));
        self.names.iter().cloned().chain(rest).collect()
    }

    /// Whether a mass is the rest of the total.
    pub fn has_rest(&self) -> bool {
        self.rest.is_some()
    }

    /// Place of a mass that is the rest and follows from a free one.
    pub fn free_rest(&self) -> Option<usize> {
        self.rest.filter(|_| (0..self.free.len()).any(|i| self.is_mass(i)))
    }

    /// All masses but this one, kg.
    fn others_kg(&self, rest: usize, theta: &[f64]) -> f64 {
        let free: f64 = (0..theta.len()).filter(|&i| self.is_mass(i)).map(|i| theta[i].exp()).sum();
        let given =
            (0..self.masses.len()).filter(|&i| i != rest && !self.free.iter().any(|(p, _)| *p == ChainNumber::Mass(i)));
        free + given.map(|i| self.masses[i]).sum::<f64>()
    }

    /// The coordinates of a chain, if it is one that was stated: numbers that were given have their values to a
    /// rounding, free ones lie within the bounds that were stated. Bounds of the search alone exclude nothing. `None`
    /// otherwise.
    pub fn point(&self, chain: &Chain) -> Option<Vec<f64>> {
        let value = |place: ChainNumber| match place {
            ChainNumber::Mass(i) => chain.masses_kg().get(i).copied(),
            ChainNumber::Spring(i, j) => chain.springs().get(i)?.points().nth(j).map(|(_, value)| value),
            ChainNumber::Damper(i, j) => chain.dampers().get(i)?.points().nth(j).map(|(_, value)| value),
        };
        let within = |((place, axis), (lower, upper)): (&(ChainNumber, Axis), &(bool, bool))| {
            let x = value(*place).filter(|value| *value > 0.0)?.ln();
            let low = if *lower { axis.lower } else { f64::NEG_INFINITY };
            let high = if *upper { axis.upper } else { f64::INFINITY };
            (x >= low - ROUNDING && x <= high + ROUNDING).then(|| x.clamp(low, high))
        };
        let theta = self.free.iter().zip(&self.given_bounds).map(within).collect::<Option<Vec<f64>>>()?;
        let (own, other) = (self.model(&theta)?.parameters(), chain.parameters());
        let same = |(name, value): (&String, &f64)| {
            other.get(name).is_some_and(|other| (value - other).abs() <= 4.0 * ROUNDING * value.abs())
        };
        (own.len() == other.len() && own.iter().all(same)).then_some(theta)
    }

    /// The same chain in a test of `ratio` times the mass: the rest of the total takes the difference; where no mass
    /// is the rest, all masses change alike. Springs, dampers and bounds stay.
    #[must_use]
    pub fn of_mass(&self, ratio: f64) -> Self {
        let mut other = self.clone();
        other.total_kg *= ratio;
        if self.rest.is_none() {
            other.masses.iter_mut().for_each(|kg| *kg *= ratio);
        }
        other
    }

    /// A flag of every free number, carried over to the dual of two masses, in which the first and second spring
    /// change places, and so do the dampers.
    pub fn exchanged(&self, of: &[bool]) -> Vec<bool> {
        let other = |place: ChainNumber| match place {
            ChainNumber::Mass(i) => ChainNumber::Mass(i),
            ChainNumber::Spring(i, j) => ChainNumber::Spring(1 - i.min(1), j),
            ChainNumber::Damper(i, j) => ChainNumber::Damper(1 - i.min(1), j),
        };
        let at = |place: ChainNumber| self.free.iter().position(|(free, _)| *free == other(place));
        self.free.iter().map(|(place, _)| at(*place).is_some_and(|k| of.get(k) == Some(&true))).collect()
    }

    /// Whether this free number is a mass.
    pub fn is_mass(&self, index: usize) -> bool {
        self.kind(index) == ParameterKind::Mass
    }
}

/// A mass that is given, kg.
fn fixed_kg(mass: StatedMass) -> Option<f64> {
    match mass {
        StatedMass::Own(Stated::Fixed(kg)) => Some(kg),
        _ => None,
    }
}

impl Parameterisation for ChainCoordinates {
    type Model = Chain;

    /// Bounds and start range of each logarithm.
    fn axes(&self) -> Vec<Axis> {
        self.free.iter().map(|(_, axis)| *axis).collect()
    }

    /// The chain at a point; `None` where the rest of the total is not positive.
    fn model(&self, theta: &[f64]) -> Option<Chain> {
        let (mut masses, mut springs, mut dampers) = (self.masses.clone(), self.springs.clone(), self.dampers.clone());
        for ((place, _), x) in self.free.iter().zip(theta) {
            match *place {
                ChainNumber::Mass(i) => masses[i] = x.exp(),
                ChainNumber::Spring(i, j) => springs[i][j].1 = x.exp(),
                ChainNumber::Damper(i, j) => dampers[i][j].1 = x.exp(),
            }
        }
        if let Some(rest) = self.rest {
            masses[rest] = 0.0;
            masses[rest] = self.total_kg - masses.iter().sum::<f64>();
        }
        // A rest that is nothing, or less, is refused here.
        self.built(&masses, &springs, &dampers).ok()
    }

    fn masses_kg(&self, model: &Chain) -> Vec<f64> {
        model.masses_kg().to_vec()
    }

    /// Motions and their derivatives, with knots or without.
    fn sensitivity(
        &self,
        model: &Chain,
        impact_speed_m_per_s: f64,
        at: &Instants,
        places: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        model.sensitivity(impact_speed_m_per_s, at, places)
    }

    /// `dp/d(ln p) = p`; a free mass takes what it gains from the rest of the total. Places count as [`Chain::places`].
    fn derivatives_by_coordinate(&self, theta: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let n = self.masses.len();
        // A first knot above zero holds down to zero, where the law has a knot of its own.
        let beyond_zero = |points: &[(f64, f64)]| usize::from(points[0].0 > 0.0);
        let knots = |laws: &[Vec<(f64, f64)>]| -> usize { laws.iter().map(|law| law.len() + beyond_zero(law)).sum() };
        let at_knot = |first: usize, laws: &[Vec<(f64, f64)>], (i, j): (usize, usize), value: f64| {
            let first = first + knots(&laws[..i]);
            let place = first + j + beyond_zero(&laws[i]);
            std::iter::once((place, value)).chain((j == 0 && place > first).then_some((first, value))).collect()
        };
        let changes = |((place, _), x): (&(ChainNumber, Axis), &f64)| {
            let value = x.exp();
            match *place {
                ChainNumber::Mass(i) => {
                    let rest = self.rest.map(|rest| (rest, -value));
                    std::iter::once((i, value)).chain(rest).collect()
                }
                ChainNumber::Spring(i, j) => at_knot(n, &self.springs, (i, j), value),
                ChainNumber::Damper(i, j) => at_knot(n + knots(&self.springs), &self.dampers, (i, j), value),
            }
        };
        self.free.iter().zip(theta).map(changes).collect()
    }
}

impl FreeNumbers for ChainCoordinates {
    fn names(&self) -> Vec<String> {
        self.names.clone()
    }

    fn kind(&self, index: usize) -> ParameterKind {
        match self.free[index].0 {
            ChainNumber::Mass(_) => ParameterKind::Mass,
            ChainNumber::Spring(..) => ParameterKind::Stiffness,
            ChainNumber::Damper(..) => ParameterKind::Damping,
        }
    }

    fn rest(&self, theta: &[f64]) -> Option<(String, f64)> {
        let rest = self.free_rest()?;
        Some((format!("m{}_kg", rest + 1), self.total_kg - self.others_kg(rest, theta)))
    }
}
