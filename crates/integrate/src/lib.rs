//! From acceleration to velocity, displacement and barrier force, and what the motion says about the crash.
//!
//! [`integrate`] makes the motion, [`integrate_without_drift`] one that meets a known velocity, [`events_of`] finds its
//! events, [`findings`] puts them into words. [`threshold_crossing`], [`edr_start`] and [`contact_edge`] find time
//! zero, [`sum_of_cells`] the force on a barrier; [`propagate`] says how far the uncertainty of the inputs moves
//! everything. The numbers themselves (events, metrics) are in `crumple-metrics`.
//!
//! Quantities are SI. Axes and signs are those of SAE J211-1: x points forward, a frontal pulse is a negative
//! acceleration, the impact speed v0 is positive, and the displacement is crush while the vehicle is in contact:
//! `x'' = a`, `x'(0) = v0`, `x(0) = 0`. The impact speed comes from the test; an accelerometer does not measure it.
//!
//! Every signal of a motion has the grid of the record, and all three have the same number of samples. Time zero is an
//! offset on that axis; times of events count from it.
//!
//! What an error of an input does to the crush C at the time t_m of dynamic crush, to first order:
//!
//! | input | effect on C | barrier test at 57 km/h |
//! |---|---|---|
//! | impact speed, 0.1 km/h | `t_m·δv0` | 2 mm |
//! | zero level, 0.05 g | `t_m²·δb/2`; started τ earlier `δb·(t_m²/2 + τ·t_m)` | 1.3 mm |
//! | gain, 1 % | `δg·(v0·t_m - C)` | 4 mm |
//! | time zero, 0.5 ms | `v0·δt` | 8 mm |
//!
//! The rule of summation is smaller than any of them: below 0.01 mm for the trapezoid at 10 kHz. Definitions and how
//! sure they are: `docs/methods/integration.md`.

mod barrier;
mod error;
mod events;
mod motion;
mod uncertainty;

pub use barrier::barrier_force;
pub use barrier::{CellSum, impulse_n_s, sum_of_cells};
pub use error::IntegrateError;
pub use events::findings::findings;
pub use events::sign::{WRONG_SIGN, events_of, wrong_sign};
pub use events::speed_question::question_speed;
pub use events::time_zero::{TimeZeroEstimate, contact_edge, edr_start, threshold_crossing};
pub use motion::drift::{Drift, DriftShape, EndCondition, integrate_without_drift};
pub use motion::integration::{Motion, Settings, integrate, integrate_reporting};
pub use motion::rule::{Rule, integrate_twice, integrate_twice_into};
pub use motion::start::{Start, UsedStart};

pub use uncertainty::{
    EVENT_NAMES, Intervals, MOST_SAMPLES, Perturbation, Spread, Uncertainty, event_values, perturbed, propagate,
};

pub use crumple_signal::Distribution;
