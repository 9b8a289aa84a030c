//! The parameters of a model that a fit moves, each with a coordinate of size one and its bounds, and how the mass
//! divides.
//!
//! A coordinate is the logarithm of a value over its unit, or a share: near zero of the unit, of the next knot, or of
//! the mass that is left. All are of size one, so that descents can use one step size and one tolerance for all.

use std::borrow::Cow;

use crumple_lumped::{Model, Parameter, ParameterKind};

use crate::error::SolveError;

/// How a coordinate `x` becomes a value `p`.
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

/// A parameter of a model that a fit moves. Values in the SI unit of its name.
#[derive(Debug, Clone, PartialEq)]
pub struct FitParameter {
    /// Name with unit.
    pub name: Cow<'static, str>,
    /// What it is.
    pub kind: ParameterKind,
    /// Scale of its kind, `m (v0/C)²` for springs and `m v0/C` for dampers; 0 where a logarithm is its only coordinate.
    pub scale: f64,
    /// Largest and smallest value allowed; speeds and lengths of a curve stay inside it.
    pub(crate) limit: f64,
    pub(crate) lowest: f64,
    /// Index among the values of the model.
    pub(crate) index: usize,
    /// How its value follows from its coordinate.
    pub(crate) map: Map,
    /// Bounds of the coordinate in a descent.
    pub(crate) bounds: (f64, f64),
    /// Range of the coordinate in which searches start, inside the bounds.
    pub(crate) starts: (f64, f64),
}

/// A spring or damper below this share of the scale of its kind is near zero: its coordinate is its share of the
/// scale.
const NEAR_ZERO: f64 = 0.01;
/// Values are searched within this factor above and below the unit of the coordinate.
const RANGE: f64 = 1e4;

impl FitParameter {
    /// A parameter whose coordinate stays the same, with its bounds and the range in which searches start.
    pub(crate) fn of_search(
        (index, name, kind): (usize, Cow<'static, str>, ParameterKind),
        map: Map,
        bounds: (f64, f64),
        starts: (f64, f64),
    ) -> Self {
        Self { name, kind, scale: 0.0, limit: f64::INFINITY, lowest: 0.0, index, map, bounds, starts }
    }

    /// The same parameter with the coordinate that suits `value`: the logarithm, or the share of the scale near zero.
    pub(crate) fn described_at(&self, value: f64) -> Self {
        let logarithmic = value > NEAR_ZERO * self.scale;
        self.with_map(if logarithmic { Map::Logarithm(value) } else { Map::Share(self.scale) })
    }

    /// The same with this coordinate, within the values that are allowed.
    pub(crate) fn with_map(&self, map: Map) -> Self {
        let bounds = match map {
            Map::Logarithm(unit) => {
                ((self.lowest / unit).ln().max(-RANGE.ln()), (self.limit / unit).ln().min(RANGE.ln()))
            }
            Map::Share(unit) => (0.0, (self.limit / unit).min(RANGE)),
            _ => self.bounds,
        };
        Self { map, bounds, starts: bounds, ..self.clone() }
    }

    /// The same with another largest value.
    pub(crate) fn with_limit(&self, limit: f64) -> Self {
        Self { limit, ..self.clone() }.with_map(self.map)
    }

    /// Whether its coordinate is a logarithm; a share ends at zero.
    pub(crate) fn is_logarithmic(&self) -> bool {
        matches!(self.map, Map::Logarithm(_))
    }

    /// The value at a coordinate, in the unit of its name; of one that follows from others, its distance or share.
    pub(crate) fn value(&self, x: f64) -> f64 {
        match self.map {
            Map::Logarithm(unit) => unit * x.exp(),
            Map::Share(unit) | Map::Above(_, unit) => unit * x,
            Map::ShareOf(_) | Map::MassShare => x,
        }
    }

    /// The coordinate of that.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        match self.map {
            Map::Logarithm(unit) => (value / unit).ln(),
            Map::Share(unit) | Map::Above(_, unit) => value / unit,
            Map::ShareOf(_) | Map::MassShare => value,
        }
    }

    /// Derivative of it by the coordinate.
    pub(crate) fn slope(&self, x: f64) -> f64 {
        match self.map {
            Map::Logarithm(_) => self.value(x),
            _ => self.value(1.0),
        }
    }
}

/// The springs, dampers and knots of a model that a displacement can determine. Masses, and the last knots of a
/// nonlinear model, are given by the test.
///
/// `crush_m` and the impact speed set the scales: `m (v0/C)²`, N/m, and `m v0/C`, N·s/m. Inner knots of a curve stay
/// below 0.999999 of the last one.
pub fn free_parameters(model: &Model, impact_speed_m_per_s: f64, crush_m: f64) -> Vec<FitParameter> {
    let rate = impact_speed_m_per_s / crush_m;
    let (mass, values) = (mass_of(model), model.values());
    let parameters = model.kind().parameters();
    // Knots of a curve stay inside its last one.
    let last_knot = |kind: ParameterKind| {
        let last = parameters.iter().position(|p| p.of_the_test && p.kind == kind);
        0.999_999 * last.map_or(f64::INFINITY, |index| values[index])
    };
    let free = parameters.iter().zip(&values).enumerate();
    free.filter(|(_, (p, value))| !(p.kind == ParameterKind::Mass || p.of_the_test || value.is_nan()))
        .map(|(index, (&Parameter { name, kind, .. }, value))| {
            let (scale, limit) = match kind {
                ParameterKind::Damping => (mass * rate, f64::INFINITY),
                ParameterKind::Stiffness => (mass * rate * rate, f64::INFINITY),
                ParameterKind::Force => (mass * rate * impact_speed_m_per_s, f64::INFINITY),
                kind => (0.0, last_knot(kind)),
            };
            of_value((index, name, kind), *value, scale, (0.0, limit))
        })
        .collect()
}

/// The masses of a model whose total is known, but the last one, which is the rest. Each lies between the shares
/// `lower` and `upper` of what the masses in front of it leave.
pub(crate) fn free_masses(model: &Model, (lower, upper): (f64, f64)) -> Vec<FitParameter> {
    let masses = masses_of(model);
    let mut left: f64 = masses.iter().map(|(_, kg)| kg).sum();
    let (_, but_last) = masses.split_last().unwrap_or((&("", 0.0), &[]));
    let but_last = but_last.iter().enumerate();
    but_last
        .map(|(index, &(name, value))| {
            let (limit, lowest) = (upper * left, lower * left);
            left -= value;
            of_value((index, name, ParameterKind::Mass), value, 0.0, (lowest, limit))
        })
        .collect()
}

/// A parameter described at its value.
fn of_value(
    (index, name, kind): (usize, &'static str, ParameterKind),
    value: f64,
    scale: f64,
    (lowest, limit): (f64, f64),
) -> FitParameter {
    let described = FitParameter::of_search((index, name.into(), kind), Map::MassShare, (0.0, 0.0), (0.0, 0.0));
    FitParameter { scale, lowest, limit, ..described }.described_at(value)
}

/// Names and values of the masses of a family, kg, from the barrier on.
pub(crate) fn masses_of(model: &Model) -> Vec<(&'static str, f64)> {
    let masses = model.kind().parameters().iter().zip(model.values());
    masses.filter(|(p, _)| p.kind == ParameterKind::Mass).map(|(p, kg)| (p.name, kg)).collect()
}

/// Sum of the masses of a model, kg.
pub(crate) fn mass_of(model: &Model) -> f64 {
    model.masses_kg().iter().sum()
}

/// How the test mass divides into chassis (next to the barrier) and compartment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MassSplit {
    /// `m1/(m1 + m2)`.
    FrontFraction(f64),
    /// Mass of the chassis alone, kg; the compartment is the rest.
    Front(f64),
    /// Mass of the compartment alone, kg; the chassis is the rest.
    Rear(f64),
    /// Both, kg.
    Both(f64, f64),
}

impl MassSplit {
    /// Engine and front structure of a passenger car are about a quarter of it: an assumption, which a note states.
    pub const USUAL_FRONT: f64 = 0.25;

    /// Masses of chassis and compartment, kg, where sensors of the compartment alone are at hand, with the sentence
    /// that says where they come from. Errors: a share outside 0 to 1, a mass that is not positive or not below the
    /// test mass.
    pub fn masses(self, mass_kg: f64) -> Result<(f64, f64, String), SolveError> {
        masses(mass_kg, self, MassEvidence::Compartment)
    }
}

/// Which sensors could tell how the mass divides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MassEvidence {
    /// Those of the compartment alone, which a division and its mirror image move alike.
    Compartment,
    /// One on another mass too.
    SeveralMasses,
}

impl MassEvidence {
    /// What it means for a division that is assumed.
    fn in_words(self) -> &'static str {
        match self {
            Self::Compartment => "one sensor cannot identify it, and the parameters depend on it",
            Self::SeveralMasses => {
                "the parameters depend on it; the sensors on several masses can identify it, with fit_masses = \"free\""
            }
        }
    }
}

/// Masses of chassis and compartment, kg, with the sentence that says where they come from.
///
/// All springs and dampers of the double model depend on how the mass divides. Errors: a share outside 0 to 1, a mass
/// that is not positive or not below the test mass.
pub(crate) fn masses(mass_kg: f64, split: MassSplit, evidence: MassEvidence) -> Result<(f64, f64, String), SolveError> {
    let value = |name, value, expected| SolveError::Value { name, value, expected };
    let below = "positive and below the test mass";
    let (m1, m2, source) = match split {
        MassSplit::FrontFraction(f) if f > 0.0 && f < 1.0 => {
            let words = format!("front mass fraction {f} is an assumption: {}", evidence.in_words());
            (f * mass_kg, (1.0 - f) * mass_kg, words)
        }
        MassSplit::FrontFraction(f) => return Err(value("front_mass_fraction", f, "between 0 and 1")),
        MassSplit::Front(m1) if m1 > 0.0 && m1 < mass_kg => (m1, mass_kg - m1, "m1 given, m2 is the rest".to_owned()),
        MassSplit::Front(m1) => return Err(value("m1_kg", m1, below)),
        MassSplit::Rear(m2) if m2 > 0.0 && m2 < mass_kg => (mass_kg - m2, m2, "m2 given, m1 is the rest".to_owned()),
        MassSplit::Rear(m2) => return Err(value("m2_kg", m2, below)),
        MassSplit::Both(m1, m2) => {
            crate::error::positive("m1_kg", m1)?;
            crate::error::positive("m2_kg", m2)?;
            (m1, m2, "both masses given".to_owned())
        }
    };
    let total = sum_remark(m1 + m2, mass_kg);
    Ok((m1, m2, format!("m1 = {m1:.2} kg, m2 = {m2:.2} kg: {source}{total}")))
}

/// The remark on given masses whose sum differs from the test mass by more than 0.5 %; empty otherwise.
fn sum_remark(sum_kg: f64, mass_kg: f64) -> String {
    if (sum_kg - mass_kg).abs() > 5e-3 * mass_kg {
        format!("; their sum {sum_kg:.1} kg is not the test mass {mass_kg:.1} kg")
    } else {
        String::new()
    }
}

/// Masses of engine, of suspension and chassis, and of the compartment, kg, with the sentence that says where they
/// come from: those given, else the front mass of the double model halved, which is an assumption.
pub(crate) fn triple_masses(
    mass_kg: f64,
    split: MassSplit,
    given: Option<[f64; 3]>,
    evidence: MassEvidence,
) -> Result<([f64; 3], String), SolveError> {
    if let Some(masses) = given {
        for (name, mass) in ["m1_kg", "m2_kg", "m3_kg"].into_iter().zip(masses) {
            crate::error::positive(name, mass)?;
        }
        let [a, b, c] = masses;
        let total = sum_remark(a + b + c, mass_kg);
        return Ok((masses, format!("m1 = {a:.2} kg, m2 = {b:.2} kg, m3 = {c:.2} kg: given{total}")));
    }
    let (front, rear, _) = masses(mass_kg, split, evidence)?;
    let half = 0.5 * front;
    let text = format!(
        "m1 = m2 = {half:.2} kg, m3 = {rear:.2} kg: engine and chassis share the front mass equally, an assumption: {}",
        evidence.in_words()
    );
    Ok(([half, half, rear], text))
}
