//! What a motion says about the crash: time zero, events in words, the force on a barrier, and how far the uncertainty
//! of the inputs moves everything. The motion is made by `crumple-signal`, events and metrics by `crumple-metrics`.

mod barrier;
mod events;
mod uncertainty;

pub use barrier::barrier_force;
pub use barrier::{CellSum, impulse_n_s, sum_of_cells};
pub use events::findings::findings;
pub use events::sign::{WRONG_SIGN, events_of, wrong_sign};
pub use events::speed_question::question_speed;
pub use events::time_zero::{TimeZeroEstimate, contact_edge, edr_start, threshold_crossing};
pub use uncertainty::{
    EVENT_NAMES, Intervals, MOST_SAMPLES, Perturbation, Spread, Uncertainty, event_values, perturbed, propagate,
};
