//! What a motion says about the crash: events in words, the force on a barrier, and how far the uncertainty
//! of the inputs moves everything. The motion is made by `crumple-signal`, events and metrics by `crumple-metrics`.

mod barrier;
mod events;
mod stage;
mod uncertainty;

pub use barrier::{CellSum, barrier_force, impulse_n_s, sum_of_cells};
pub use events::{WRONG_SIGN, events_of, events_within, findings, question_speed, wrong_sign};
pub use uncertainty::{
    EVENT_NAMES, Intervals, MOST_SAMPLES, Perturbation, Uncertainty, ZeroShift, event_values, perturbed, propagate,
    stroke_interval,
};

/// The program.
pub const PROGRAM: crumple_stage::Program = crumple_stage::Program::of_stage::<stage::Integrate>();
