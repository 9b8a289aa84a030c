//! From acceleration to velocity, displacement and barrier force, and what the motion says about the crash.
//!
//! [`integrate`] makes the motion, [`integrate_without_drift`] one that meets a known velocity, [`events_of`] finds its
//! events, [`findings`] puts them into words. [`threshold_crossing`], [`edr_start`] and [`contact_edge`] find time zero,
//! [`sum_of_cells`] the force on a barrier; [`propagate`] says how far the uncertainty of the inputs moves everything. The
//! numbers themselves (events, metrics) are in `crumple-metrics`.
//!
//! rooms: stage | uncertainty events | motion barrier

mod barrier;
mod error;
mod events;
mod motion;
mod uncertainty;

pub use barrier::cell_sum::{CellSum, impulse_n_s, sum_of_cells};
pub use barrier::inertia_force::barrier_force;
pub use error::IntegrateError;
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
