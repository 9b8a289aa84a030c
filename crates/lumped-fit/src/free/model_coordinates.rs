//! The free parameters of a model as coordinates of size one, for fits to sensors.
//!
//! Springs and dampers are logarithms over the scale of the test, knots are shares of the crush, of the impact speed
//! or of the next knot, masses are shares of what is left of the total: every point in the bounds is a model.

use std::collections::BTreeMap;

use crumple_lumped::{Instants, LumpedError, Model, ModelKind, Parameter, ParameterKind, Sensitivity};

use crate::free::parameterisation::{Axis, Parameterisation};
use crate::free::search_bounds::{DAMPER_BOUNDS, DAMPER_STARTS, SPRING_BOUNDS, SPRING_STARTS};

/// How a coordinate becomes a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Map {
    /// `p = scale exp(theta)`: positive whatever the search tries.
    Logarithm(f64),
    /// `p = scale theta`.
    Share(f64),
    /// `p = theta p[of]`: a knot as a share of the next one, so that they stay in order.
    ShareOf(usize),
    /// The mass `p` takes this share of what the masses before it leave of the total; the last mass is the rest.
    MassShare,
}

/// One free parameter with the bounds of its coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coordinate {
    /// Name of the parameter it stands for.
    pub name: &'static str,
    /// Place among the names of the model.
    place: usize,
    /// How the parameter follows.
    map: Map,
    /// Its bounds, and where searches start.
    pub axis: Axis,
}

/// A model with its known and its free parameters, and how the free ones follow from coordinates.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ModelCoordinates {
    pub kind: ModelKind,
    /// Every parameter, in the order of the names; free ones are overwritten.
    known: Vec<f64>,
    /// The free parameters, in the order of the coordinates.
    pub free: Vec<Coordinate>,
    /// Sum of all masses: what masses that are fitted divide.
    total_mass_kg: f64,
    /// Whether an elastoplastic model leaves the barrier.
    release: bool,
    /// Whether nothing tells a double model from its dual.
    duals_are_one: bool,
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

impl ModelCoordinates {
    /// The coordinates of a model with these masses, kg.
    ///
    /// Springs and dampers of chains have the bounds of [`search_bounds`](crate::free::search_bounds). The unloading
    /// stiffness of the elastoplastic model lies between 1e-2 and 1e5 spring units and starts higher, and the damper
    /// of the Maxwell model starts at 0.1 to 30. Coefficients of the nonlinear models lie between 1e-8 and 1e3 of `m
    /// (v0/C)²` and `m v0/C`; knots between 0.5 and 99.5 % of the next one.
    pub fn new(kind: ModelKind, masses_kg: &[f64], fit: MassFit, scale: &Scale) -> Self {
        let names = kind.parameter_names();
        let total_mass_kg: f64 = masses_kg.iter().sum();
        let spring = total_mass_kg * (std::f64::consts::FRAC_PI_2 / scale.length_s).powi(2);
        let damper = total_mass_kg / scale.length_s;
        let rate = scale.impact_speed_m_per_s / scale.crush_m;
        // With the rear scaled by it, the dual model is the exchange of front and rear: the box of a search holds both.
        let is_double = kind == ModelKind::DoubleSpringMassDamper;
        let rear = if is_double { masses_kg[1] / total_mass_kg } else { 1.0 };
        let of_rear = |name: &str| if matches!(name, "k2_n_per_m" | "c2_n_s_per_m") { rear } else { 1.0 };
        let nonlinear = matches!(kind, ModelKind::Nonlinear1 | ModelKind::Nonlinear2);
        let mut known = vec![1.0; names.len()];
        known[..masses_kg.len()].copy_from_slice(masses_kg);
        let mut free = Vec::new();
        let mut push = |place, map, bounds: (f64, f64), searched: (f64, f64)| {
            let name = names[place];
            let logarithm = matches!(map, Map::Logarithm(_));
            let to = |x: f64| if logarithm { x.ln() } else { x };
            let ((lower, upper), (box_lower, box_upper)) = (bounds, searched);
            let [lower, upper, box_lower, box_upper] = [lower, upper, box_lower, box_upper].map(to);
            free.push(Coordinate { name, place, map, axis: Axis { lower, upper, box_lower, box_upper } });
        };
        if let MassFit::Shares { lower, upper } = fit {
            for place in 0..masses_kg.len().saturating_sub(1) {
                push(place, Map::MassShare, (lower, upper), (lower, upper));
            }
        }
        let parameters = kind.parameters();
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
                ParameterKind::Force | ParameterKind::RateFactor => {}
                // Masses stand in front of all others.
                ParameterKind::Stiffness | ParameterKind::Mass => {
                    let scale = spring * of_rear(parameter.name);
                    push(place, Map::Logarithm(scale), SPRING_BOUNDS, SPRING_STARTS);
                }
            }
        }
        // A knot that is a share of another needs that one first.
        free.sort_by_key(|c| matches!(c.map, Map::ShareOf(_)));
        let duals_are_one = is_double && scale.compartment_alone;
        Self { kind, known, free, total_mass_kg, release: scale.release, duals_are_one }
    }

    /// Names of the free parameters, in the order of the coordinates.
    pub fn names(&self) -> Vec<&'static str> {
        self.free.iter().map(|c| c.name).collect()
    }

    /// Every parameter, in the order of the names.
    fn values(&self, theta: &[f64]) -> Vec<f64> {
        let mut values = self.known.clone();
        let mut left = self.total_mass_kg;
        for (coordinate, x) in self.free.iter().zip(theta) {
            values[coordinate.place] = match coordinate.map {
                Map::Logarithm(scale) => scale * x.exp(),
                Map::Share(scale) => scale * x,
                Map::ShareOf(of) => x * values[of],
                Map::MassShare => {
                    let mass = x * left;
                    left -= mass;
                    // The next mass takes the rest, unless its own share comes.
                    values[coordinate.place + 1] = left;
                    mass
                }
            };
        }
        values
    }

    /// Coordinates of a model, moved into the bounds; a parameter of zero gets the lower bound of its logarithm.
    pub fn theta(&self, model: &Model) -> Vec<f64> {
        let parameters = model.parameters();
        let names = self.kind.parameter_names();
        let value = |place: usize| parameters.get(names[place]).copied().unwrap_or(1.0);
        let mut left = self.total_mass_kg;
        let coordinate = |c: &Coordinate| {
            let p = value(c.place);
            let x = match c.map {
                Map::Logarithm(scale) => (p / scale).ln(),
                Map::Share(scale) => p / scale,
                Map::ShareOf(of) => p / value(of),
                Map::MassShare => {
                    let share = p / left;
                    left -= p;
                    share
                }
            };
            // A zero has no logarithm: the bound stands for it.
            x.max(c.axis.lower).min(c.axis.upper)
        };
        self.free.iter().map(coordinate).collect()
    }
}

impl Parameterisation for ModelCoordinates {
    type Model = Model;

    /// Bounds and start range of each coordinate.
    fn axes(&self) -> Vec<Axis> {
        self.free.iter().map(|c| c.axis).collect()
    }

    /// The model at a point; `None` where its parameters are not physical.
    fn model(&self, theta: &[f64]) -> Option<Model> {
        let names = self.kind.parameter_names();
        let named: BTreeMap<String, f64> = names.iter().map(|n| (*n).to_owned()).zip(self.values(theta)).collect();
        let mut model = Model::from_parameters(self.kind, &named).ok()?;
        if let Model::Elastoplastic(elastoplastic) = &mut model {
            elastoplastic.release = self.release;
        }
        Some(model)
    }

    fn masses_kg(&self, model: &Model) -> Vec<f64> {
        model.masses_kg()
    }

    /// That of the model itself.
    fn sensitivity(
        &self,
        model: &Model,
        impact_speed_m_per_s: f64,
        at: &Instants,
        places: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        model.sensitivity(impact_speed_m_per_s, at, places)
    }

    /// The coordinates. Of a double model that nothing tells from its dual what the two share: the four coefficients of
    /// the characteristic polynomial and the product of the dampers, in logarithms, and the masses.
    fn place(&self, theta: &[f64]) -> Vec<f64> {
        let Some(Model::DoubleSpringMassDamper(model)) = self.model(theta).filter(|_| self.duals_are_one) else {
            return theta.to_vec();
        };
        let [_, t, u, v, w] = model.characteristic_polynomial();
        let shared = [t, u, v, w, model.c1_n_s_per_m * model.c2_n_s_per_m, model.m1_kg];
        shared.map(f64::ln).to_vec()
    }

    /// For each coordinate the places of the parameters that it moves and their derivatives by it, its own parameter
    /// first.
    ///
    /// `dp/dx = p` for a logarithm, the scale for a share. A knot that is a share of another moves with it. A mass
    /// that takes a larger share of `left` grows by `left` and makes those behind it lose in proportion to their
    /// values.
    fn derivatives_by_coordinate(&self, theta: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let values = self.values(theta);
        let masses = self.kind.parameters().iter().filter(|p| p.kind == ParameterKind::Mass).count();
        self.free
            .iter()
            .zip(theta)
            .map(|(coordinate, x)| {
                let place = coordinate.place;
                match coordinate.map {
                    Map::Logarithm(_) => vec![(place, values[place])],
                    Map::Share(scale) => {
                        let follows = |c: &&Coordinate| c.map == Map::ShareOf(place);
                        let follower = self.free.iter().find(follows);
                        let itself = (place, scale);
                        std::iter::once(itself).chain(follower.map(|c| (c.place, values[c.place] / x))).collect()
                    }
                    Map::ShareOf(of) => vec![(place, values[of])],
                    Map::MassShare => {
                        // Its itself mass grows by what the others behind it lose in proportion.
                        let left: f64 = values[place..masses].iter().sum();
                        let behind = left - values[place];
                        let loses = |i: usize| (i, -left * values[i] / behind);
                        std::iter::once((place, left)).chain((place + 1..masses).map(loses)).collect()
                    }
                }
            })
            .collect()
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
            let coordinates = ModelCoordinates::new(kind, masses, MassFit::Shares { lower: 0.05, upper: 0.6 }, &scale);
            let theta: Vec<f64> = coordinates
                .free
                .iter()
                .enumerate()
                .map(|(k, Coordinate { axis, .. })| {
                    axis.box_lower + (axis.box_upper - axis.box_lower) * (0.3 + 0.05 * k as f64)
                })
                .collect();
            let model = coordinates.model(&theta).unwrap();
            for (a, b) in coordinates.theta(&model).iter().zip(&theta) {
                // Two roundings of a logarithm.
                assert!((a - b).abs() < 1e-13, "{kind}");
            }
            for (j, by) in coordinates.derivatives_by_coordinate(&theta).iter().enumerate() {
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
