//! Observer/Kalman filter identification: Markov parameters of system and observer from any input and output.

pub(crate) mod observer_regression;
pub(crate) mod okid;
