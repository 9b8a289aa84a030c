//! A model of any family.
//!
//! [`Model`] is the one type that candidates, fits and simulations hold: whatever the family, it checks its parameters,
//! knows its masses and the [`Structure`] it is a name for. What a family is made of is in `families/`.

use crate::{
    DoubleSpringMassDamper, Elastoplastic, Kelvin, LumpedError, Maxwell, ModelKind, Nonlinear1, Nonlinear2, Structure,
    TripleSpringMassDamper,
};

/// A lumped model with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// Spring and damper in parallel.
    Kelvin(Kelvin),
    /// Stiff unloading.
    Elastoplastic(Elastoplastic),
    /// Spring and damper in series.
    Maxwell(Maxwell),
    /// Stiffening spring, weakening damper.
    Nonlinear1(Nonlinear1),
    /// The same with one knot more each.
    Nonlinear2(Nonlinear2),
    /// Chassis and compartment.
    DoubleSpringMassDamper(DoubleSpringMassDamper),
    /// Engine, suspension and chassis, compartment.
    TripleSpringMassDamper(TripleSpringMassDamper),
}

impl Model {
    /// Which family it is of.
    pub fn kind(&self) -> ModelKind {
        match self {
            Self::Kelvin(_) => ModelKind::Kelvin,
            Self::Elastoplastic(_) => ModelKind::Elastoplastic,
            Self::Maxwell(_) => ModelKind::Maxwell,
            Self::Nonlinear1(_) => ModelKind::Nonlinear1,
            Self::Nonlinear2(_) => ModelKind::Nonlinear2,
            Self::DoubleSpringMassDamper(_) => ModelKind::DoubleSpringMassDamper,
            Self::TripleSpringMassDamper(_) => ModelKind::TripleSpringMassDamper,
        }
    }

    /// Refuses parameters for which the model has no meaning: masses that are not positive, numbers that are not
    /// finite. Negative springs and dampers pass where the equations allow them: solvers do return such sets.
    pub fn check(&self) -> Result<(), LumpedError> {
        match self {
            Self::Kelvin(m) => m.check(),
            Self::Elastoplastic(m) => m.check(),
            Self::Maxwell(m) => m.check(),
            Self::Nonlinear1(m) => m.check(),
            Self::Nonlinear2(m) => m.check(),
            Self::DoubleSpringMassDamper(m) => m.check(),
            Self::TripleSpringMassDamper(m) => m.structure().map(drop),
        }
    }

    /// Masses from the barrier on, kg.
    pub fn masses_kg(&self) -> Vec<f64> {
        match self {
            Self::Kelvin(m) => vec![m.mass_kg],
            Self::Elastoplastic(m) => vec![m.mass_kg],
            Self::Maxwell(m) => vec![m.mass_kg],
            Self::Nonlinear1(m) => vec![m.mass_kg],
            Self::Nonlinear2(m) => vec![m.mass_kg],
            Self::DoubleSpringMassDamper(m) => vec![m.m1_kg, m.m2_kg],
            Self::TripleSpringMassDamper(m) => m.masses_kg.to_vec(),
        }
    }

    /// The structure it is a name for: masses and elements. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        self.check()?;
        match self {
            Self::Kelvin(m) => m.structure(),
            Self::Elastoplastic(m) => m.structure(),
            Self::Maxwell(m) => m.structure(),
            Self::Nonlinear1(m) => m.structure(),
            Self::Nonlinear2(m) => m.structure(),
            Self::DoubleSpringMassDamper(m) => m.structure(),
            Self::TripleSpringMassDamper(m) => m.structure(),
        }
    }
}
