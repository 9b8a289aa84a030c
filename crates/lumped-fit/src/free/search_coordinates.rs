//! The free parameters of a model as coordinates of size one, for fits to sensors.
//!
//! Springs and dampers are logarithms over the scale of the test, knots are shares of the crush, of the impact speed
//! or of the next knot, masses are shares of what is left of the total: every point in the bounds is a model.

use crumple_lumped::{Model, ModelKind, Parameter, ParameterKind};

use crate::free::coordinates::{Axis, Coordinates, FreeNumber, Map};
use crate::free::search_bounds::{DAMPER_BOUNDS, DAMPER_STARTS, SPRING_BOUNDS, SPRING_STARTS};

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

impl Coordinates<Model> {
    /// The coordinates of a search for a model with these masses, kg.
    ///
    /// Springs and dampers of chains have the bounds of [`search_bounds`](crate::free::search_bounds). The unloading
    /// stiffness of the elastoplastic model lies between 1e-2 and 1e5 spring units and starts higher, and the damper
    /// of the Maxwell model starts at 0.1 to 30. Coefficients of the nonlinear models lie between 1e-8 and 1e3 of `m
    /// (v0/C)²` and `m v0/C`; knots between 0.5 and 99.5 % of the next one.
    pub fn of_search(kind: ModelKind, masses_kg: &[f64], fit: MassFit, scale: &Scale) -> Option<Self> {
        let total_mass_kg: f64 = masses_kg.iter().sum();
        let spring = total_mass_kg * (std::f64::consts::FRAC_PI_2 / scale.length_s).powi(2);
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
            let ((lower, upper), (box_lower, box_upper)) = (bounds, searched);
            let [lower, upper, box_lower, box_upper] = [lower, upper, box_lower, box_upper].map(to);
            let axis = Axis { lower, upper, box_lower, box_upper };
            free.push(FreeNumber { name: name.into(), kind, index, map, axis });
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
        for kind in ModelKind::ALL.into_iter().filter(|kind| *kind != ModelKind::ForceDeflection) {
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
                .map(|(k, FreeNumber { axis, .. })| {
                    axis.box_lower + (axis.box_upper - axis.box_lower) * (0.3 + 0.05 * k as f64)
                })
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
