//! The free numbers of a model as coordinates of size one, within bounds: what searches, fits and assessments move.
//!
//! A coordinate is the logarithm of a number over its unit, or a share: near zero of the unit, of the next knot, or of
//! the mass that is left. All are of size one, so that descents can use one step size and one tolerance for all.

use std::borrow::Cow;

use crumple_lumped::{ParameterKind, Place, Structure};

use crate::free::parametric::Parametric;

/// Bounds of one coordinate in a descent, and the range in which searches start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    /// Bounds of the descent.
    pub lower: f64,
    pub upper: f64,
    /// Range of the starts, inside the bounds.
    pub box_lower: f64,
    pub box_upper: f64,
}

/// How a coordinate `x` becomes a number `p`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Map {
    /// `p = unit exp(x)`: positive whatever is tried.
    Logarithm(f64),
    /// `p = unit x`.
    Share(f64),
    /// `p = x p[of]`: a knot as a share of the next one, so that they stay in order.
    ShareOf(usize),
    /// `p = p[of] + unit x`: no smaller than another, which stands before it among those that are free.
    Above(usize, f64),
    /// The mass `p` takes this share of what the masses before it leave of the total; the last mass is the rest.
    MassShare,
}

/// A number of a model that is free.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FreeNumber {
    /// Name with unit.
    pub name: Cow<'static, str>,
    /// What it is.
    pub kind: ParameterKind,
    /// Index among the numbers of the model.
    pub index: usize,
    /// How it follows from its coordinate.
    pub map: Map,
    /// Bounds of its coordinate, and where searches start.
    pub axis: Axis,
}

impl FreeNumber {
    /// Whether its coordinate is a logarithm; a share ends at zero.
    pub fn is_logarithmic(&self) -> bool {
        matches!(self.map, Map::Logarithm(_))
    }

    /// The number at a coordinate, in the unit of its name; of one that follows from others, its distance or share.
    pub fn value(&self, x: f64) -> f64 {
        match self.map {
            Map::Logarithm(unit) => unit * x.exp(),
            Map::Share(unit) | Map::Above(_, unit) => unit * x,
            Map::ShareOf(_) | Map::MassShare => x,
        }
    }

    /// The coordinate of that.
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.map {
            Map::Logarithm(unit) => (value / unit).ln(),
            Map::Share(unit) | Map::Above(_, unit) => value / unit,
            Map::ShareOf(_) | Map::MassShare => value,
        }
    }

    /// Derivative of it by the coordinate.
    pub fn slope(&self, x: f64) -> f64 {
        match self.map {
            Map::Logarithm(_) => self.value(x),
            _ => self.value(1.0),
        }
    }
}

/// A model of which some numbers are free, its others known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coordinates<M> {
    /// The model with the values of everything that is not free.
    pub template: M,
    /// Its numbers; those that are free are overwritten.
    known: Vec<f64>,
    /// Where they stand.
    places: Vec<Place>,
    /// What is free, in the order of the coordinates.
    pub free: Vec<FreeNumber>,
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

impl<M: Parametric> Coordinates<M> {
    /// These numbers of a model free; no mass is the rest.
    pub fn new(template: M, free: Vec<FreeNumber>) -> Self {
        let (known, places) = (template.values(), template.places());
        let masses = places.iter().zip(&known).filter(|(place, _)| matches!(place, Place::Mass(_)));
        let total_kg = masses.map(|(_, kg)| kg).sum();
        Self { template, known, places, free, total_kg, rest: None, duals_are_one: false, either_order: None }
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
    pub fn coordinates_of(&self, model: &M) -> Vec<f64> {
        let values = model.values();
        let mut left = self.total_kg;
        let coordinate = |number: &FreeNumber| {
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
    pub fn model(&self, theta: &[f64]) -> Option<M> {
        self.template.with_values(&self.values(theta)).filter(|model| model.structure().is_some())
    }

    /// Its structure.
    pub fn structure(&self, theta: &[f64]) -> Option<Structure> {
        self.template.with_values(&self.values(theta))?.structure()
    }

    /// For each coordinate the numbers that it moves, by their index, and their derivatives by it, its own first.
    ///
    /// `dp/dx = p` for a logarithm, the unit for a share. A knot that is a share of another moves with it. A mass that
    /// is free takes from the rest; one that takes a larger share of `left` grows by `left` and makes those behind it
    /// lose in proportion to their values.
    pub fn derivatives(&self, theta: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let values = self.as_tried(theta);
        let exchanged = self.exchanged_knots(&values);
        let moved = |(number, x): (&FreeNumber, &f64)| {
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
        let shared = || self.model(theta)?.shared_by_duals();
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

/// The numbers that any coordinate moves, each once, in rising order: those whose derivatives of the motion are needed.
pub(crate) fn moved_numbers(derivatives: &[Vec<(usize, f64)>]) -> Vec<usize> {
    let mut moved: Vec<usize> = derivatives.iter().flatten().map(|(index, _)| *index).collect();
    moved.sort_unstable();
    moved.dedup();
    moved
}
