//! The motion of a test and a simulation beside it.

use crumple_lumped::{CrushEvents, Dynamics, Motion};
use crumple_lumped_fit::Measurement;
use crumple_signal::Sampled;

use crate::comparison::ratings::Rating;

/// The motion of the test. The records may have grids of their own, all on one time axis; the displacement gives the
/// sampling interval of the simulation, and where it ends the simulation ends.
#[derive(Debug, Clone, Copy)]
pub struct Measured<'a> {
    /// Time zero on the axis of the records, s.
    pub time_zero_s: f64,
    /// Speed at time zero, m/s.
    pub impact_speed_m_per_s: f64,
    /// Displacement, m, zero at time zero.
    pub displacement: &'a Sampled,
    /// How it was measured.
    pub measurement: Measurement,
    /// Velocity, if there is one.
    pub velocity: Option<&'a Sampled>,
    /// Acceleration, if there is one.
    pub acceleration: Option<&'a Sampled>,
    /// Dynamic crush, if the velocity reaches zero.
    pub dynamic_crush_m: Option<f64>,
    /// Its time after time zero.
    pub time_of_dynamic_crush_s: Option<f64>,
}

/// Where model and test are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// End of the window, s after time zero; `None`: dynamic crush of the test, or the record's end without one.
    pub to_s: Option<f64>,
}

/// A model beside the test. A number is `None` where a record is missing, has no variation (fits) or leaves the range
/// of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Start of the window, s after time zero.
    pub from_s: f64,
    /// Time of its last sample.
    pub to_s: f64,
    /// Displacement error, root mean square, m.
    pub rmse_displacement_m: Option<f64>,
    /// Largest displacement error, m.
    pub max_displacement_error_m: Option<f64>,
    /// Fit of the displacement, percent.
    pub fit_displacement_percent: Option<f64>,
    /// The same of the model measured as the record was; `None` under a drive.
    pub fit_as_measured_percent: Option<f64>,
    /// Fit of the velocity, percent.
    pub fit_velocity_percent: Option<f64>,
    /// Fit of the acceleration, percent.
    pub fit_acceleration_percent: Option<f64>,
    /// ISO/TS 18571 rating of the acceleration over the window, 0 to 1; `None` unless sampled at 10 kHz as the standard
    /// wants it.
    pub iso18571_score: Option<f64>,
    /// Dynamic crush of the model minus that of the test, m; `None` if either has none.
    pub dynamic_crush_error_m: Option<f64>,
    /// Time of dynamic crush of the model minus that of the test, s.
    pub time_of_dynamic_crush_error_s: Option<f64>,
    /// ISO/TS 18571 of the acceleration; CORA, Sprague-Geers and Theil of acceleration and displacement.
    pub ratings: Vec<Rating>,
}

/// The response of a model from time zero to the end of the test's displacement record.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// Motion of the compartment at `k·dt` after time zero, `dt` that of the test.
    pub motion: Motion,
    /// Its events, from the exact solution.
    pub events: CrushEvents,
    /// Beside the test.
    pub comparison: Comparison,
    /// Motion of every mass, from the barrier on.
    pub masses: Vec<Motion>,
    /// Which of them is the compartment, from 0: the last, unless a chain has an occupant behind it.
    pub compartment: usize,
    /// Displacement of the model minus that of the test at every sample of the window, m.
    pub error_m: Vec<f64>,
    /// The force in every spring and damper, and the energy; `None` where the heat leaves the range of numbers.
    pub dynamics: Option<Dynamics>,
}
