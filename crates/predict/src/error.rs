//! Why a candidate predicts nothing.

use crumple_lumped::LumpedError;

/// Why a candidate predicts nothing for an impact.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PredictError {
    /// The model has no such response.
    #[error(transparent)]
    Model(#[from] LumpedError),
    /// The crush asked for has no interval: the model does not stop.
    #[error("the model does not stop in this impact, so that its crush has no interval")]
    NoInterval,
    /// The mass asked for is less than what the model has in front of its compartment.
    #[error("{asked_kg} kg leave the compartment no mass: {front_kg:.1} kg of the model are in front of it")]
    Mass {
        /// Mass asked for, kg.
        asked_kg: f64,
        /// Mass in front of the compartment, kg.
        front_kg: f64,
    },
}
