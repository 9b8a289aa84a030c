//! Why a record cannot be integrated.

use crumple_signal::SignalError;

/// Why an acceleration cannot be integrated. Each variant holds what was stated and what the record has, in SI units
/// on the record's own time axis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegrateError {
    /// The impact speed, m/s, is negative, infinite or no number; 0 is a motion from rest and allowed.
    #[error("impact speed {0} m/s is negative or no number")]
    ImpactSpeed(f64),
    /// The mass, kg, is not a positive number, so `F = -m·a` has no meaning.
    #[error("mass {0} kg is not a positive number")]
    Mass(f64),
    /// The record does not cover time zero and what follows it: it needs two samples at or after time zero, and its
    /// first sample may come no more than one interval late, because the speed there is known only at time zero.
    #[error(
        "time zero {time_zero_s} s needs two samples after it and a record that starts no later, \
         the record runs from {first_s:.6} s to {last_s:.6} s"
    )]
    TimeZero {
        /// Time zero on the record's axis.
        time_zero_s: f64,
        /// First sample.
        first_s: f64,
        /// Last sample.
        last_s: f64,
    },
    /// The time of a known velocity is not in the motion, or is its first sample, where the velocity is given already
    /// and a drift has done nothing yet.
    #[error("the known velocity is stated at {time_s} s, the motion runs from {first_s:.6} s to {last_s:.6} s")]
    EndCondition {
        /// When it is stated, on the record's axis.
        time_s: f64,
        /// Start of the motion.
        first_s: f64,
        /// Its end.
        last_s: f64,
    },
    /// The result is not a signal: the samples are so large that the sum overflows.
    #[error("the integrated channel is not a finite signal")]
    Result(#[from] SignalError),
}
