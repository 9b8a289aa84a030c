//! Crash metrics: pure functions of sampled motion, one definition or one group of definitions a file.
//!
//! Everything is SI, times count from time zero, crush and impact speed are positive towards the barrier and a
//! frontal pulse is a negative acceleration (SAE J211-1). A metric that a record does not show is a
//! [`Metric`] without a value whose definition says why; it is never a number in disguise.

mod centroid;
mod energy;
mod events;
mod mean;
mod peak;
mod pulse_metrics;
mod square_wave;
mod stiffness;

pub use centroid::{centroid_time_by_moment, centroid_time_from_crush};
pub use energy::{absorbed_energy, kinetic_energy, loading_work_per_kg};
pub use events::{CrashEvents, DynamicCrush, Rebound, crash_events};
pub use mean::mean_deceleration;
pub use peak::{Peak, peak};
pub use pulse_metrics::{Metric, Pulse, pulse_metrics};
pub use square_wave::{average_square_wave, equivalent_square_wave};
pub use stiffness::average_stiffness;

/// Why a metric cannot be computed from what was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MetricsError {
    /// Two signals of one motion differ in start, interval or length.
    #[error(
        "{first} has {first_len} samples from {first_t0_s} s, \
         {second} has {second_len} from {second_t0_s} s: one grid is needed"
    )]
    Grids {
        /// What the first is.
        first: &'static str,
        /// Its length.
        first_len: usize,
        /// Its start, s.
        first_t0_s: f64,
        /// What the second is.
        second: &'static str,
        /// Its length.
        second_len: usize,
        /// Its start, s.
        second_t0_s: f64,
    },
    /// There are no samples.
    #[error("the motion has no samples")]
    Empty,
}

/// Refuses two signals that are not sampled at the same times.
pub(crate) fn same_grid(
    (first, a): (&'static str, &crumple_signal::Sampled),
    (second, b): (&'static str, &crumple_signal::Sampled),
) -> Result<(), MetricsError> {
    if a.is_empty() {
        return Err(MetricsError::Empty);
    }
    if a.len() != b.len() || a.t0_s() != b.t0_s() || a.dt_s() != b.dt_s() {
        return Err(MetricsError::Grids {
            first,
            first_len: a.len(),
            first_t0_s: a.t0_s(),
            second,
            second_len: b.len(),
            second_t0_s: b.t0_s(),
        });
    }
    Ok(())
}
