//! From acceleration to velocity, displacement and barrier force, and what the motion says about the crash.
//!
//! [`integrate`] makes the motion, [`integrate_without_drift`] one that meets a known velocity, [`events_of`] finds its
//! events, [`findings`] puts them into words. [`threshold_crossing`], [`edr_start`] and [`contact_edge`] find time zero, [`sum_of_cells`] the
//! force on a barrier; [`propagate`] says how far the uncertainty of the inputs moves everything. The numbers themselves (events, metrics) are in `crumple-metrics`.

mod barrier;
mod events;
mod motion;
mod uncertainty;

pub use barrier::cell_sum::{CellSum, impulse_n_s, sum_of_cells};
pub use barrier::inertia_force::barrier_force;
pub use events::findings::findings;
pub use events::sign::{WRONG_SIGN, events_of, wrong_sign};
pub use events::time_zero::{FoundZero, contact_edge, edr_start, threshold_crossing};
pub use motion::drift::{Drift, DriftShape, EndCondition, integrate_without_drift};
pub use motion::integration::{Motion, Settings, integrate, integrate_reporting};
pub use motion::rule::{Rule, integrate_twice, integrate_twice_into};
pub use motion::start::{Start, UsedStart};

pub use uncertainty::propagation::{
    EVENT_NAMES, Intervals, MOST_SAMPLES, Perturbation, Spread, Uncertainty, event_values, perturbed, propagate,
};

pub use crumple_signal::Distribution;
use crumple_signal::SignalError;

/// Why an acceleration cannot be integrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegrateError {
    /// The impact speed is no speed.
    #[error("impact speed {0} m/s is negative or no number")]
    ImpactSpeed(f64),
    /// The mass is no mass.
    #[error("mass {0} kg is not a positive number")]
    Mass(f64),
    /// The record does not cover time zero and what follows it.
    #[error(
        "time zero {time_zero_s} s needs two samples after it and a record that starts no later, \
         the record runs from {first_s} s to {last_s} s"
    )]
    TimeZero {
        /// Time zero on the record's axis.
        time_zero_s: f64,
        /// First sample.
        first_s: f64,
        /// Last sample.
        last_s: f64,
    },
    /// The time of a known velocity is not in the motion.
    #[error("the known velocity is stated at {time_s} s, the motion runs from {first_s} s to {last_s} s")]
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
