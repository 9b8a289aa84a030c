//! Why a candidate cannot be compared with the test.

use crumple_lumped::LumpedError;

/// Why a candidate cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// The model cannot be simulated: parameters without meaning, or a response that leaves the range of numbers.
    #[error(transparent)]
    Model(#[from] LumpedError),
    /// The impact speed, m/s, is not a positive number: a model that meets the barrier at rest does not move.
    #[error("impact speed is {0} m/s, expected a positive number")]
    Speed(f64),
    /// There is no record after time zero, or the window ends before its first samples.
    #[error(
        "the displacement record ends {end_s:.6} s after time zero and the window at {to_s:.6} s: nothing to compare"
    )]
    Empty {
        /// End of the record after time zero.
        end_s: f64,
        /// End of the window.
        to_s: f64,
    },
}
