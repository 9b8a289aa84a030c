//! Filters for crash records: the channel frequency classes of SAE J211-1 Appendix C and ISO 6487 Annex A, Butterworth
//! filters of any order, moving averages; resampling, and the delay between channels.
//!
//! [`filter`] does for one channel what the stage does for all: remove the zero level, check the sampling rate,
//! run the filter, and say in notes what a reader should know. The parts are here to be used alone: [`Coefficients`]
//! (the difference equation of a class), [`filter_both_ways`] (the two passes and the ends), [`corridor`] (its response
//! against the limits), [`Butterworth`] and [`run_sections`], [`resample`], [`delay`],
//! [`pre_event`] (the zero level).
//!
//! Quantities are SI in `f64`: times in s on the record's own axis, frequencies in Hz, gains in dB where a name says
//! so. The unit of the samples does not matter, every filter here is linear. A filter returns as many samples as it is
//! given, on the same grid: sample `k` before and after belong to the same instant `t0 + k·dt`.
//!
//! Every recursive filter is a chain of second-order difference equations whose coefficients are `a0, a1, a2, b1, b2`
//! in this order, with `+b1` and `+b2` as SAE J211-1 prints them. Many programs write the denominator as
//! `1 + a1·z⁻¹ + a2·z⁻²`: their a1 and a2 are -b1 and -b2 here.
//!
//! Without phase means: the pass forward is followed by the same pass backward in time. The gains multiply, the delays
//! cancel, and events keep their times. The price is that a jump is spread to both sides of its place: at CFC 60 a step
//! has 1 % of its height 7 ms and 0.1 % of it 11 ms before it.
//!
//! Definitions and how sure they are: `docs/methods/cfc-filter.md`.

mod butterworth;
mod cfc;
mod channels;
mod error;
mod filter;
mod recursion;
mod samples;

pub use butterworth::{Butterworth, Design, Pass, Phase, run_sections};
pub use cfc::class::{Cfc, Class};
pub use cfc::coefficients::Coefficients;
pub use cfc::corridor::{CorridorPoint, corridor};
pub use cfc::mode::Mode;
pub use cfc::zero_phase::{filter_both_ways, filter_both_ways_into, samples_added};
pub use channels::{SelectionError, class_of_body, is_barrier_force, occupants_left, resolve_id, resolve_ids, select};
pub use error::FilterError;
pub use filter::{Applied, Filtered, Instead, Settings, filter, filter_reporting};
pub use samples::delay::{Delay, delay};
pub use samples::derivative::{acceleration_of_velocity_change, derivative_note};
pub use samples::kept::{keep_every, kept};
pub use samples::resampling::{Interpolation, Resampling, resample};
pub use samples::zero_level::{ZeroLevel, pre_event};
