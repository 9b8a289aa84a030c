//! A model with its free parameters as coordinates: what searches, fits and assessments move.
//!
//! In fits to sensors springs and dampers are logarithms over the scale of the test, knots are shares of the crush, of
//! the impact speed or of the next knot, masses are shares of what is left of the total: every point in the bounds is a
//! model. Springs and dampers of chains have one set of bounds, for two, three and any number of masses. `M` is the
//! mass of the vehicle, kg, and `T` the length of the window, s. A spring is counted in units of `M (π/2T)²`, N/m: an
//! undamped mass `M` on a spring of one unit stops after `T`. A damper is counted in units of `M/T`, N·s/m.

use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::str::FromStr;

use crumple_lumped::{Model, ModelKind, Parameter, ParameterKind, Place, Structure};

use crate::parameters::{FitParameter, Map, mass_of};

/// A model of which some numbers are free, its others known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coordinates {
    /// The model with the values of everything that is not free.
    pub template: Model,
    /// Its numbers; those that are free are overwritten.
    known: Vec<f64>,
    /// Where they stand.
    places: Vec<Place>,
    /// What is free, in the order of the coordinates.
    pub free: Vec<FitParameter>,
    /// Sum of all masses, kg, that masses divide.
    total_kg: f64,
    /// Index of the mass that is the rest of the total.
    pub rest: Option<usize>,
    /// Whether nothing tells a model from its dual.
    pub duals_are_one: bool,
    /// Two knots of a curve that are tried in either order and put in rising order: index of the place and of the value
    /// of each.
    pub either_order: Option<[[usize; 2]; 2]>,
}

impl Coordinates {
    /// These numbers of a model free; no mass is the rest.
    pub fn new(template: Model, free: Vec<FitParameter>) -> Self {
        let (known, places) = (template.values(), template.places());
        let masses = places.iter().zip(&known).filter(|(place, _)| matches!(place, Place::Mass(_)));
        let total_kg = masses.map(|(_, kg)| kg).sum();
        Self { template, known, places, free, total_kg, rest: None, duals_are_one: false, either_order: None }
    }

    /// These parameters of a model free; nothing is searched for. With free masses the last one is the rest of the
    /// total.
    pub fn near(template: Model, free: Vec<FitParameter>) -> Self {
        let coordinates = Self::new(template, free);
        let has_masses = coordinates.free.iter().any(|p| p.kind == ParameterKind::Mass);
        let (rest, total_kg) = (coordinates.masses() - 1, mass_of(&coordinates.template));
        coordinates.with_rest(has_masses.then_some(rest), total_kg)
    }

    /// Number of masses; they stand first.
    pub fn masses(&self) -> usize {
        self.places.iter().filter(|place| matches!(place, Place::Mass(_))).count()
    }

    /// The mass at this index takes what the others leave of the total, kg; `None`: no mass does.
    #[must_use]
    pub fn with_rest(self, rest: Option<usize>, total_kg: f64) -> Self {
        Self { rest, total_kg, ..self }
    }

    /// The coordinates of the template.
    pub fn start(&self) -> Vec<f64> {
        self.coordinates_of(&self.template)
    }

    /// The coordinates of a model of this kind, inside the bounds or not.
    pub fn coordinates_of(&self, model: &Model) -> Vec<f64> {
        let values = model.values();
        let mut left = self.total_kg;
        let coordinate = |number: &FitParameter| {
            let value = values[number.index];
            match number.map {
                Map::ShareOf(of) => value / values[of],
                Map::Above(of, _) => number.coordinate(value - values[of]),
                Map::MassShare => {
                    let share = value / left;
                    left -= value;
                    share
                }
                _ => number.coordinate(value),
            }
        };
        self.free.iter().map(coordinate).collect()
    }

    /// Every number at a point.
    pub fn values(&self, theta: &[f64]) -> Vec<f64> {
        let mut values = self.as_tried(theta);
        if let Some([low, high]) = self.exchanged_knots(&values) {
            (0..2).for_each(|k| values.swap(low[k], high[k]));
        }
        values
    }

    /// The two knots that are tried in falling order.
    fn exchanged_knots(&self, tried: &[f64]) -> Option<[[usize; 2]; 2]> {
        self.either_order.filter(|[low, high]| tried[low[0]] > tried[high[0]])
    }

    /// Every number at a point, knots in the order in which they are tried.
    fn as_tried(&self, theta: &[f64]) -> Vec<f64> {
        let mut values = self.known.clone();
        let mut left = self.total_kg;
        for (number, x) in self.free.iter().zip(theta) {
            values[number.index] = match number.map {
                Map::ShareOf(of) => x * values[of],
                Map::Above(of, _) => values[of] + number.value(*x),
                Map::MassShare => {
                    let mass = x * left;
                    left -= mass;
                    // The next mass takes the rest, unless its own share comes.
                    values[number.index + 1] = left;
                    mass
                }
                _ => number.value(*x),
            };
        }
        if let Some(rest) = self.rest {
            let others = (0..self.masses()).filter(|mass| *mass != rest).map(|mass| values[mass]);
            values[rest] = self.total_kg - others.sum::<f64>();
        }
        values
    }

    /// The model at a point; `None` where its numbers are not physical.
    pub fn model(&self, theta: &[f64]) -> Option<Model> {
        self.template.with_values(&self.values(theta)).ok().filter(|model| model.check().is_ok())
    }

    /// Its structure.
    pub fn structure(&self, theta: &[f64]) -> Option<Structure> {
        self.template.with_values(&self.values(theta)).ok()?.structure().ok()
    }

    /// For each coordinate the numbers that it moves, by their index, and their derivatives by it, its own first.
    ///
    /// `dp/dx = p` for a logarithm, the unit for a share. A knot that is a share of another moves with it. A mass that
    /// is free takes from the rest; one that takes a larger share of `left` grows by `left` and makes those behind it
    /// lose in proportion to their values.
    pub fn derivatives(&self, theta: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let values = self.as_tried(theta);
        let exchanged = self.exchanged_knots(&values);
        let moved = |(number, x): (&FitParameter, &f64)| {
            let mut own = number.index;
            if let Some([low, high]) = exchanged {
                let pairs = low.into_iter().zip(high).flat_map(|(a, b)| [(a, b), (b, a)]);
                own = pairs.into_iter().find(|(from, _)| *from == own).map_or(own, |(_, to)| to);
            }
            match number.map {
                Map::MassShare => {
                    let masses = self.masses();
                    let left: f64 = values[own..masses].iter().sum();
                    let behind = left - values[own];
                    let loses = |i: usize| (i, -left * values[i] / behind);
                    std::iter::once((own, left)).chain((own + 1..masses).map(loses)).collect()
                }
                Map::ShareOf(of) => vec![(own, values[of])],
                _ => {
                    let slope = number.slope(*x);
                    let rest = self.rest.filter(|_| number.kind == ParameterKind::Mass).map(|rest| (rest, -slope));
                    let follower = self.free.iter().find(|other| other.map == Map::ShareOf(own));
                    let follows = follower.map(|other| (other.index, values[other.index] / x));
                    let mut moved: Vec<_> = std::iter::once((own, slope)).chain(rest).chain(follows).collect();
                    for other in &self.free {
                        let is_above = |of: usize| moved.iter().any(|(index, _)| *index == of);
                        if matches!(other.map, Map::Above(of, _) if is_above(of)) {
                            moved.push((other.index, slope));
                        }
                    }
                    moved
                }
            }
        };
        self.free.iter().zip(theta).map(moved).collect()
    }

    /// The places of these numbers.
    pub fn places(&self, indices: &[usize]) -> Vec<Place> {
        indices.iter().map(|index| self.places[*index]).collect()
    }

    /// Numbers of size one that models of one motion share: minima that agree in all of them are one.
    pub fn identity(&self, theta: &[f64]) -> Vec<f64> {
        let shared = || shared_by_duals(&self.model(theta)?);
        if self.duals_are_one { shared() } else { None }.unwrap_or_else(|| theta.to_vec())
    }

    /// Names of the free numbers, in the order of the coordinates.
    pub fn names(&self) -> Vec<String> {
        self.free.iter().map(|number| number.name.clone().into_owned()).collect()
    }

    /// Name and value, kg, of the mass that is the rest of a known total and follows from masses that are free.
    pub fn free_rest(&self, theta: &[f64]) -> Option<(String, f64)> {
        let is_free = self.free.iter().any(|number| number.kind == ParameterKind::Mass);
        self.rest.filter(|_| is_free).map(|rest| (format!("m{}_kg", rest + 1), self.values(theta)[rest]))
    }

    /// The same model in a test of `ratio` times the mass: the rest of the total takes the difference; where no mass is
    /// the rest, all masses change alike. Springs, dampers and bounds stay.
    #[must_use]
    pub fn of_mass(&self, ratio: f64) -> Self {
        let mut other = self.clone();
        other.total_kg *= ratio;
        if self.rest.is_none() {
            let masses = self.masses();
            other.known[..masses].iter_mut().for_each(|kg| *kg *= ratio);
        }
        other
    }
}

/// Numbers of size one that all models of one motion share, for a model that is not the only one with its motion: of a
/// double model the four coefficients of the characteristic polynomial, the product of the dampers, a mass.
fn shared_by_duals(model: &Model) -> Option<Vec<f64>> {
    let Model::DoubleSpringMassDamper(model) = model else { return None };
    let [_, t, u, v, w] = model.characteristic_polynomial();
    let shared = [t, u, v, w, model.c1_n_s_per_m * model.c2_n_s_per_m, model.m1_kg];
    Some(shared.map(f64::ln).to_vec())
}

/// The numbers that any coordinate moves, each once, in rising order: those whose derivatives of the motion are needed.
pub(crate) fn moved_numbers(derivatives: &[Vec<(usize, f64)>]) -> Vec<usize> {
    let mut moved: Vec<usize> = derivatives.iter().flatten().map(|(index, _)| *index).collect();
    moved.sort_unstable();
    moved.dedup();
    moved
}

/// Smallest and largest spring, in its unit.
pub(crate) const SPRING_BOUNDS: (f64, f64) = (1e-4, 1e4);
/// Between these a search starts: structures that stop a car within the window.
pub(crate) const SPRING_STARTS: (f64, f64) = (0.2, 30.0);
/// Smallest and largest damper, in its unit.
pub(crate) const DAMPER_BOUNDS: (f64, f64) = (1e-5, 1e3);
/// Between these a search starts.
pub(crate) const DAMPER_STARTS: (f64, f64) = (0.01, 3.0);

/// Largest spring, N/m, and damper, N s/m, that a search gives a chain of this mass over a window of this length.
pub fn largest_of_chain(mass_kg: f64, length_s: f64) -> (f64, f64) {
    let rate = FRAC_PI_2 / length_s;
    (SPRING_BOUNDS.1 * mass_kg * rate * rate, DAMPER_BOUNDS.1 * mass_kg / length_s)
}

/// The size of a test, from which the scales of springs, dampers and knots follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    /// Speed at contact, m/s: the last knot of a nonlinear damper.
    pub impact_speed_m_per_s: f64,
    /// Length of the window, s.
    pub length_s: f64,
    /// Largest displacement, m: the last knot of a nonlinear spring.
    pub crush_m: f64,
    /// Whether an elastoplastic model leaves the barrier.
    pub release: bool,
    /// Whether all sensors are on the compartment: nothing tells a double model from its dual then.
    pub compartment_alone: bool,
}

/// Whether masses are given, or fitted with a given total.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MassFit {
    /// Masses are known.
    Known,
    /// The total is known, and every mass but the last has between these shares of what is left behind it.
    Shares {
        /// Smallest share.
        lower: f64,
        /// Largest share.
        upper: f64,
    },
}

/// Shares of masses that are free.
const FREE_SHARES: (f64, f64) = (0.02, 0.95);

/// `known`, `free`, or the bounds of every share: `0.1..0.4`.
impl FromStr for MassFit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let of_bounds = |text: &str| {
            let (low, high) = text.split_once("..")?;
            let (lower, upper) = (low.parse().ok()?, high.parse().ok()?);
            (lower > 0.0 && lower < upper && upper < 1.0).then_some(Self::Shares { lower, upper })
        };
        match text {
            "known" => Ok(Self::Known),
            "free" => Ok(Self::Shares { lower: FREE_SHARES.0, upper: FREE_SHARES.1 }),
            _ => of_bounds(text)
                .ok_or_else(|| format!("{text:?} is not known, free or bounds such as 0.1..0.4 within 0 and 1")),
        }
    }
}

impl fmt::Display for MassFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Known => f.write_str("known"),
            Self::Shares { lower, upper } => write!(f, "{lower}..{upper}"),
        }
    }
}

impl Coordinates {
    /// The coordinates of a search for a model with these masses, kg.
    ///
    /// The unloading stiffness of the elastoplastic model lies between 1e-2 and 1e5 spring units and starts higher, and
    /// the damper of the Maxwell model starts at 0.1 to 30. Coefficients of the nonlinear models lie between 1e-8 and
    /// 1e3 of `m (v0/C)²` and `m v0/C`; knots between 0.5 and 99.5 % of the next one.
    pub fn of_search(kind: ModelKind, masses_kg: &[f64], fit: MassFit, scale: &Scale) -> Option<Self> {
        let total_mass_kg: f64 = masses_kg.iter().sum();
        let spring = total_mass_kg * (FRAC_PI_2 / scale.length_s).powi(2);
        let damper = total_mass_kg / scale.length_s;
        let rate = scale.impact_speed_m_per_s / scale.crush_m;
        // With the rear scaled by it, the dual model is the exchange of front and rear: the box of a search holds both.
        let is_double = kind == ModelKind::DoubleSpringMassDamper;
        let rear = if is_double { masses_kg[1] / total_mass_kg } else { 1.0 };
        let of_rear = |name: &str| if matches!(name, "k2_n_per_m" | "c2_n_s_per_m") { rear } else { 1.0 };
        let nonlinear = matches!(kind, ModelKind::Nonlinear1 | ModelKind::Nonlinear2);
        let mut known = vec![1.0; kind.parameters().len()];
        known[..masses_kg.len()].copy_from_slice(masses_kg);
        let mut free = Vec::new();
        let parameters = kind.parameters();
        let mut push = |index: usize, map, bounds: (f64, f64), searched: (f64, f64)| {
            let Parameter { name, kind, .. } = parameters[index];
            let logarithm = matches!(map, Map::Logarithm(_));
            let to = |x: f64| if logarithm { x.ln() } else { x };
            let both = |(low, high): (f64, f64)| (to(low), to(high));
            free.push(FitParameter::of_search((index, name.into(), kind), map, both(bounds), both(searched)));
        };
        if let MassFit::Shares { lower, upper } = fit {
            for place in 0..masses_kg.len().saturating_sub(1) {
                push(place, Map::MassShare, (lower, upper), (lower, upper));
            }
        }
        let free_rate = |p: &Parameter| p.kind == ParameterKind::Rate && !p.of_the_test;
        for (place, parameter) in parameters.iter().enumerate().skip(masses_kg.len()) {
            match parameter.kind {
                ParameterKind::Length if parameter.of_the_test => known[place] = scale.crush_m,
                ParameterKind::Rate if parameter.of_the_test => known[place] = scale.impact_speed_m_per_s,
                ParameterKind::Length => push(place, Map::Share(scale.crush_m), (0.005, 0.995), (0.1, 0.95)),
                // Below another knot that is free: a share of it.
                ParameterKind::Rate if parameters.get(place + 1).is_some_and(free_rate) => {
                    push(place, Map::ShareOf(place + 1), (0.005, 0.995), (0.05, 0.95));
                }
                ParameterKind::Rate => {
                    push(place, Map::Share(scale.impact_speed_m_per_s), (0.005, 0.995), (0.05, 0.95));
                }
                ParameterKind::Stiffness if nonlinear => {
                    push(place, Map::Logarithm(total_mass_kg * rate * rate), (1e-8, 1e3), (1e-3, 10.0));
                }
                ParameterKind::Damping if nonlinear => {
                    push(place, Map::Logarithm(total_mass_kg * rate), (1e-8, 1e3), (1e-3, 10.0));
                }
                ParameterKind::Stiffness if parameter.name == "unloading_stiffness_n_per_m" => {
                    push(place, Map::Logarithm(spring), (1e-2, 1e5), (1.0, 300.0));
                }
                ParameterKind::Damping => {
                    let searched = if kind == ModelKind::Maxwell { (0.1, 30.0) } else { DAMPER_STARTS };
                    let scale = damper * of_rear(parameter.name);
                    push(place, Map::Logarithm(scale), DAMPER_BOUNDS, searched);
                }
                // Of a crushed structure, which is read off the record and not searched for.
                ParameterKind::Force | ParameterKind::RateFactor | ParameterKind::Other => {}
                // Masses stand in front of all others.
                ParameterKind::Stiffness | ParameterKind::Mass => {
                    let scale = spring * of_rear(parameter.name);
                    push(place, Map::Logarithm(scale), SPRING_BOUNDS, SPRING_STARTS);
                }
            }
        }
        // A knot that is a share of another needs that one first.
        free.sort_by_key(|c| matches!(c.map, Map::ShareOf(_)));
        let mut template = Model::of_values(kind, &known).ok()?;
        if let Model::Elastoplastic(model) = &mut template {
            model.release = scale.release;
        }
        let mut coordinates = Self::new(template, free);
        coordinates.duals_are_one = is_double && scale.compartment_alone;
        Some(coordinates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_read_back_and_their_derivatives_agree_with_differences() {
        let scale =
            Scale { impact_speed_m_per_s: 10.0, length_s: 0.1, crush_m: 0.6, release: true, compartment_alone: false };
        // Nothing of a crushed structure is searched for.
        for kind in ModelKind::ALL.into_iter().filter(|kind| kind.name() != "force-deflection") {
            let masses: &[f64] = match kind {
                ModelKind::DoubleSpringMassDamper => &[300.0, 900.0],
                ModelKind::TripleSpringMassDamper => &[200.0, 100.0, 900.0],
                _ => &[1200.0],
            };
            let fit = MassFit::Shares { lower: 0.05, upper: 0.6 };
            let coordinates = Coordinates::of_search(kind, masses, fit, &scale).unwrap();
            let theta: Vec<f64> = coordinates
                .free
                .iter()
                .enumerate()
                .map(|(k, FitParameter { starts: (low, high), .. })| low + (high - low) * (0.3 + 0.05 * k as f64))
                .collect();
            let model = coordinates.model(&theta).unwrap();
            for (a, b) in coordinates.coordinates_of(&model).iter().zip(&theta) {
                // Two roundings of a logarithm.
                assert!((a - b).abs() < 1e-13, "{kind}");
            }
            for (j, by) in coordinates.derivatives(&theta).iter().enumerate() {
                let moved = |h: f64| {
                    let mut theta = theta.clone();
                    theta[j] += h;
                    coordinates.values(&theta)
                };
                let (up, down) = (moved(1e-5), moved(-1e-5));
                for place in 0..up.len() {
                    let derivative = by.iter().find(|(p, _)| *p == place).map_or(0.0, |(_, d)| *d);
                    let difference = (up[place] - down[place]) / 2e-5;
                    // h²/6 of the third derivative, and rounding over h.
                    assert!(
                        (derivative - difference).abs() <= 1e-9 * up[place].abs().max(derivative.abs()),
                        "{kind} {j} {place}"
                    );
                }
            }
        }
    }
}
