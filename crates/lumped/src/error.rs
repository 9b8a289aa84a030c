//! Why a model cannot be built or asked for its response, and the checks of its numbers.

use crate::ModelKind;

/// Why a model cannot be built or asked for its response.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LumpedError {
    /// No model has this name.
    #[error("unknown model {given:?}, expected one of {expected}")]
    UnknownModel {
        /// What was given.
        given: String,
        /// All names.
        expected: String,
    },
    /// A parameter of the model is not given.
    #[error("model {model} needs the parameter {name}")]
    MissingParameter {
        /// The model.
        model: ModelKind,
        /// The parameter.
        name: &'static str,
    },
    /// A parameter is given that the model does not have.
    #[error("model {model} has no parameter {name:?}, its parameters are {expected}")]
    UnknownParameter {
        /// The model.
        model: ModelKind,
        /// What was given.
        name: String,
        /// The names it has.
        expected: String,
    },
    /// A parameter is NaN or infinite, or must be positive and is not.
    #[error("{name} is {value}, expected {expected}")]
    Value {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// The poles could not be computed.
    #[error("poles or motion of a chain of masses: {0}")]
    Poles(#[from] crumple_numerics::lti::LtiError),
    /// The response leaves the range of numbers.
    #[error("the response of the {model} model is not finite from t = {time_s} s on: it diverges or is too stiff")]
    Diverges {
        /// The model.
        model: ModelKind,
        /// Time of the first such sample.
        time_s: f64,
    },
    /// A parameter of a chain of masses is missing, or there is one too many.
    #[error("a chain of masses {problem} {name}")]
    ChainParameter {
        /// What is wrong with it.
        problem: &'static str,
        /// The parameter.
        name: String,
    },
    /// The text of an own model is wrong.
    #[error("the file of the own model: {0}")]
    Law(#[from] crate::LawMistake),
    /// A candidate of an own model comes without the text of its law.
    #[error("an own model needs the text of its law, which its record does not have")]
    NoLaw,
    /// The motion of a chain of masses leaves the range of numbers.
    #[error("the motion of the chain of masses cannot be followed beyond t = {time_s} s: it diverges or is too stiff")]
    ChainDiverges {
        /// How far it was followed.
        time_s: f64,
    },
}

/// Refuses NaN, infinities and, where asked, what is not positive.
pub(crate) fn finite(name: &'static str, value: f64) -> Result<(), LumpedError> {
    if value.is_finite() { Ok(()) } else { Err(LumpedError::Value { name, value, expected: "a finite number" }) }
}

/// Refuses NaN, infinities, zero and what is negative.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), LumpedError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(LumpedError::Value { name, value, expected: "a positive number" })
    }
}

/// Refuses lists of springs and dampers that do not belong to so many masses, and masses that are not positive.
pub(crate) fn row_of_masses(masses_kg: &[f64], springs: usize, dampers: usize) -> Result<(), LumpedError> {
    let n = masses_kg.len();
    if n == 0 || springs != n || dampers != n {
        return Err(LumpedError::Value {
            name: "number of springs and dampers",
            value: springs.min(dampers) as f64,
            expected: "one spring and one damper for each mass, and at least one mass",
        });
    }
    masses_kg.iter().try_for_each(|mass| positive("mass_kg", *mass))
}
