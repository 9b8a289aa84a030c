//! Filters for crash records: the channel frequency classes of SAE J211-1 Appendix C and ISO 6487 Annex A, Butterworth
//! filters of any order, moving averages; resampling, and the delay between channels.
//!
//! [`filter`] does for one channel what the stage does for all: remove the zero level, check the sampling rate,
//! run the filter, and say in notes what a reader should know. The parts are here to be used alone: [`Coefficients`]
//! (the difference equation of a class), [`filter_both_ways`] (the two passes and the ends), [`corridor`] (its response
//! against the limits), [`Butterworth`] and [`run_sections`], [`moving_average`], [`resample`], [`delay`],
//! [`pre_event`] (the zero level).
//!
//! rooms: stage | channels | cfc butterworth samples | recursion

mod butterworth;
mod cfc;
mod channels;
mod error;
mod filter;
mod recursion;
mod samples;

pub use butterworth::design::{Design, Section};
pub use butterworth::pass::{Butterworth, HIGHEST_ORDER, Pass, Phase};
pub use butterworth::sections::{run_sections, sections_extension};
pub use cfc::class::{Cfc, Class};
pub use cfc::coefficients::Coefficients;
pub use cfc::corridor::{CorridorPoint, corridor, limits_db};
pub use cfc::mode::Mode;
pub use cfc::zero_phase::{Report, filter_both_ways, filter_both_ways_into, samples_added};
pub use channels::selection::{
    SelectionError, class_of_body, id_meant, ids_meant, is_barrier_force, is_of_body, occupants_left, select,
};
pub use error::FilterError;
pub use filter::{Applied, Filtered, Instead, Settings, filter, filter_reporting};
pub use samples::delay::{Delay, delay};
pub use samples::derivative::{acceleration_of_velocity_change, derivative_note, printed_step_m_per_s};
pub use samples::moving_average::{moving_average, moving_average_gain, samples_of_width};
pub use samples::resampling::{Interpolation, Resampling, resample};
pub use samples::zero_level::{ZeroLevel, pre_event};
