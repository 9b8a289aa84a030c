//! A model of any family.
//!
//! [`Model`] is the one type that candidates, fits and simulations hold: whatever the family, it checks its parameters,
//! knows its masses and the [`Structure`] it is a name for. What a family is made of is in `families/`.

use crate::{
    CrushedStructure, DoubleSpringMassDamper, Elastoplastic, Kelvin, LumpedError, Maxwell, ModelKind, Nonlinear1,
    Nonlinear2, ParameterKind, Structure, TripleSpringMassDamper,
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
    /// A structure that is crushed.
    ForceDeflection(CrushedStructure),
}

/// The same of whatever family a model is.
macro_rules! of_family {
    ($model:expr, $family:ident => $what:expr) => {
        match $model {
            Model::Kelvin($family) => $what,
            Model::Elastoplastic($family) => $what,
            Model::Maxwell($family) => $what,
            Model::Nonlinear1($family) => $what,
            Model::Nonlinear2($family) => $what,
            Model::DoubleSpringMassDamper($family) => $what,
            Model::TripleSpringMassDamper($family) => $what,
            Model::ForceDeflection($family) => $what,
        }
    };
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
            Self::ForceDeflection(_) => ModelKind::ForceDeflection,
        }
    }

    /// Refuses parameters for which the model has no meaning: masses that are not positive, numbers that are not
    /// finite. Negative springs and dampers pass where the equations allow them: solvers do return such sets.
    pub fn check(&self) -> Result<(), LumpedError> {
        self.structure().map(drop)
    }

    /// The structure it is a name for: masses and elements. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        of_family!(self, model => model.structure())
    }

    /// The values of its parameters, in the order of [`ModelKind::parameters`]; not a number for a knot it does not
    /// have.
    ///
    /// Whether the elastoplastic model lets go is no parameter: it is a choice of whoever simulates it.
    pub fn values(&self) -> Vec<f64> {
        of_family!(self, model => model.values())
    }

    /// Masses from the barrier on, kg.
    pub fn masses_kg(&self) -> Vec<f64> {
        let parameters = self.kind().parameters().iter().zip(self.values());
        parameters.filter(|(parameter, _)| parameter.kind == ParameterKind::Mass).map(|(_, mass)| mass).collect()
    }
}
