//! Parameters of a model that are free in a fit, as coordinates of size one.

use crumple_lumped::Model;

/// One parameter that is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeParameter {
    /// Name with unit.
    pub name: &'static str,
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

/// A spring or damper below this share of the scale of its kind is near zero: its logarithm means nothing.
const NEAR_ZERO: f64 = 0.01;
/// Springs and dampers are looked for within this factor.
const RANGE: f64 = 1e4;

impl FreeParameter {
    /// The same parameter described about another value: by its logarithm, or by its share of the scale near zero.
    pub fn described_at(&self, value: f64) -> Self {
        let logarithmic = value > NEAR_ZERO * self.scale;
        Self { value, unit: if logarithmic { value } else { self.scale }, logarithmic, ..*self }
    }

    /// The coordinate of a value.
    pub fn coordinate(&self, value: f64) -> f64 {
        if self.logarithmic { (value / self.unit).ln() } else { value / self.unit }
    }

    /// The value at a coordinate.
    pub fn at(&self, coordinate: f64) -> f64 {
        if self.logarithmic { self.unit * coordinate.exp() } else { self.unit * coordinate }
    }

    /// Smallest and largest coordinate.
    pub fn bounds(&self) -> (f64, f64) {
        if self.logarithmic {
            ((self.lowest / self.unit).ln().max(-RANGE.ln()), (self.limit / self.unit).ln().min(RANGE.ln()))
        } else {
            (0.0, (self.limit / self.unit).min(RANGE))
        }
    }

    /// Derivative of the value by the coordinate.
    pub fn slope(&self, coordinate: f64) -> f64 {
        if self.logarithmic { self.at(coordinate) } else { self.unit }
    }
}

/// The springs, dampers and knots of a model that a displacement can tell, with coordinates of size one. Masses, and the end
/// knots of a nonlinear model, are given.
///
/// `crush_m` and `time_s` are those of the test; `with_unloading`: whether the window goes beyond the dynamic crush.
pub fn free_parameters(
    model: &Model,
    impact_speed_m_per_s: f64,
    crush_m: f64,
    with_unloading: bool,
) -> Vec<FreeParameter> {
    let rate = impact_speed_m_per_s / crush_m;
    let values = model.parameters();
    let mass: f64 = values.iter().filter(|(name, _)| name.ends_with("_kg")).map(|(_, value)| value).sum();
    let names = model.kind().parameter_names();
    names
        .iter()
        .filter(|name| !(name.ends_with("_kg") || **name == "crush_m" || **name == "v0_m_per_s"))
        .filter(|name| with_unloading || **name != "unloading_stiffness_n_per_m")
        .map(|&name| {
            let value = values[name];
            let knot = |last: &str| 0.999_999 * values.get(last).copied().unwrap_or(f64::INFINITY);
            let (scale, limit) = match name {
                _ if name.ends_with("_n_s_per_m") => (mass * rate, f64::INFINITY),
                _ if name.ends_with("_n_per_m") => (mass * rate * rate, f64::INFINITY),
                _ if name.ends_with("_m_per_s") => (0.0, knot("v0_m_per_s")),
                _ => (0.0, knot("crush_m")),
            };
            FreeParameter { name, value, unit: value, scale, logarithmic: true, limit, lowest: 0.0 }.described_at(value)
        })
        .collect()
}

/// The masses but the last of a model whose total is known, each between two shares of what the masses before it leave.
pub fn free_masses(model: &Model, (lower, upper): (f64, f64)) -> Vec<FreeParameter> {
    let masses = masses_of(model);
    let mut left: f64 = masses.iter().map(|(_, kg)| kg).sum();
    let (_, but_last) = masses.split_last().unwrap_or((&("", 0.0), &[]));
    but_last
        .iter()
        .map(|&(name, value)| {
            let (limit, lowest) = (upper * left, lower * left);
            left -= value;
            FreeParameter { name, value, unit: value, scale: 0.0, logarithmic: true, limit, lowest }
        })
        .collect()
}

/// Masses of a model from the barrier on.
pub(crate) fn masses_of(model: &Model) -> Vec<(&'static str, f64)> {
    let values = model.parameters();
    let names = model.kind().parameter_names().iter();
    names.filter(|name| name.ends_with("_kg")).map(|name| (*name, values[*name])).collect()
}

/// The last mass where masses are free: the rest of the total. Its name and its value.
pub(crate) fn rest_mass(model: &Model, free: &[FreeParameter]) -> Option<(&'static str, f64)> {
    free.iter().any(|p| p.name.ends_with("_kg")).then(|| masses_of(model).pop()).flatten()
}
