//! Parameters of a model that are free in a fit to an observation, as coordinates of size one.
//!
//! A value `p` has the coordinate `ln(p/u)`, `u` its value at the start; near zero, where a logarithm has no meaning,
//! `p/u` with `u` the scale of its kind. Both are of size one, which the descents and their differences rely on.

use crumple_lumped::{Model, Parameter, ParameterKind};

use crate::free::coordinates::{Axis, Coordinates, FreeNumber, Map};

/// A parameter that is free, with its coordinate and its bounds. All values in the SI unit of its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeParameter {
    /// Name with unit.
    pub name: &'static str,
    /// What it is.
    pub kind: ParameterKind,
    /// Value where the description was made.
    pub value: f64,
    /// Unit of its coordinate: the value itself for a logarithm, the scale of its kind otherwise.
    pub unit: f64,
    /// Scale of its kind, `m (v0/C)²` for springs and `m v0/C` for dampers; 0 for knots.
    pub scale: f64,
    /// Whether the coordinate is the logarithm of the value: all but those near zero.
    pub logarithmic: bool,
    /// Largest value allowed; speeds and lengths of a curve stay inside it.
    pub limit: f64,
    /// Smallest value allowed; 0 for all but masses.
    pub lowest: f64,
}

/// A spring or damper below this share of the scale of its kind is near zero: its coordinate is its share of the
/// scale.
const NEAR_ZERO: f64 = 0.01;
/// Values are searched within this factor above and below the unit of the coordinate.
const RANGE: f64 = 1e4;

impl FreeParameter {
    /// The same parameter with the coordinate that suits `value`: the logarithm, or the share of the scale near zero.
    pub fn described_at(&self, value: f64) -> Self {
        let logarithmic = value > NEAR_ZERO * self.scale;
        Self { value, unit: if logarithmic { value } else { self.scale }, logarithmic, ..*self }
    }

    /// Smallest and largest coordinate.
    fn bounds(&self) -> (f64, f64) {
        if self.logarithmic {
            ((self.lowest / self.unit).ln().max(-RANGE.ln()), (self.limit / self.unit).ln().min(RANGE.ln()))
        } else {
            (0.0, (self.limit / self.unit).min(RANGE))
        }
    }
}

/// The springs, dampers and knots of a model that a displacement can determine. Masses, and the last knots of a
/// nonlinear model, are given by the test.
///
/// `crush_m` and the impact speed set the scales: `m (v0/C)²`, N/m, and `m v0/C`, N·s/m. Inner knots of a curve stay
/// below 0.999999 of the last one.
pub fn free_parameters(model: &Model, impact_speed_m_per_s: f64, crush_m: f64) -> Vec<FreeParameter> {
    let rate = impact_speed_m_per_s / crush_m;
    let values = model.parameters();
    let mass = mass_of(model);
    let parameters = model.kind().parameters();
    // Knots of a curve stay inside its last one.
    let last_knot = |kind: ParameterKind| {
        let last = parameters.iter().find(|p| p.of_the_test && p.kind == kind);
        0.999_999 * last.map_or(f64::INFINITY, |p| values[p.name])
    };
    parameters
        .iter()
        .filter(|p| !(p.kind == ParameterKind::Mass || p.of_the_test))
        .filter_map(|&Parameter { name, kind, .. }| {
            let value = *values.get(name)?;
            let (scale, limit) = match kind {
                ParameterKind::Damping => (mass * rate, f64::INFINITY),
                ParameterKind::Stiffness => (mass * rate * rate, f64::INFINITY),
                ParameterKind::Force => (mass * rate * impact_speed_m_per_s, f64::INFINITY),
                kind => (0.0, last_knot(kind)),
            };
            let unit = value;
            let parameter = FreeParameter { name, kind, value, unit, scale, logarithmic: true, limit, lowest: 0.0 };
            Some(parameter.described_at(value))
        })
        .collect()
}

/// The masses of a model whose total is known, but the last one, which is the rest. Each lies between the shares
/// `lower` and `upper` of what the masses in front of it leave.
pub fn free_masses(model: &Model, (lower, upper): (f64, f64)) -> Vec<FreeParameter> {
    let masses = masses_of(model);
    let mut left: f64 = masses.iter().map(|(_, kg)| kg).sum();
    let (_, but_last) = masses.split_last().unwrap_or((&("", 0.0), &[]));
    but_last
        .iter()
        .map(|&(name, value)| {
            let (limit, lowest) = (upper * left, lower * left);
            left -= value;
            let kind = ParameterKind::Mass;
            FreeParameter { name, kind, value, unit: value, scale: 0.0, logarithmic: true, limit, lowest }
        })
        .collect()
}

/// Names and values of the masses of a model, kg, from the barrier on.
fn masses_of(model: &Model) -> Vec<(&'static str, f64)> {
    let values = model.parameters();
    let masses = model.kind().parameters().iter().filter(|p| p.kind == ParameterKind::Mass);
    masses.map(|p| (p.name, values[p.name])).collect()
}

/// Sum of the masses of a model, kg.
pub fn mass_of(model: &Model) -> f64 {
    masses_of(model).iter().map(|(_, kg)| kg).sum()
}

impl Coordinates<Model> {
    /// These parameters of a model free; nothing is searched for. With free masses the last one is the rest of the
    /// total.
    pub fn near(template: Model, free: &[FreeParameter]) -> Self {
        let names = template.kind().parameter_names();
        let number = |p: &FreeParameter| {
            let (lower, upper) = p.bounds();
            Some(FreeNumber {
                name: p.name.into(),
                kind: p.kind,
                index: names.iter().position(|name| *name == p.name)?,
                map: if p.logarithmic { Map::Logarithm(p.unit) } else { Map::Share(p.unit) },
                axis: Axis { lower, upper, box_lower: lower, box_upper: upper },
            })
        };
        let coordinates = Self::new(template, free.iter().filter_map(number).collect());
        let rest = free.iter().any(|p| p.kind == ParameterKind::Mass).then(|| coordinates.masses() - 1);
        coordinates.with_rest(rest, mass_of(&template))
    }
}
