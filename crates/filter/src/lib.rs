//! Filters for crash records: the channel frequency classes of SAE J211-1 Appendix C and ISO 6487 Annex A, Butterworth
//! filters of any order, moving averages; resampling, and the delay between channels.
//!
//! [`filter`] does for one channel what the stage does for all: remove the zero level, check the sampling rate,
//! run the filter, and say in notes what a reader should know. The parts are here to be used alone: [`Coefficients`]
//! (the difference equation of a class), [`filter_both_ways`] (the two passes and the ends), [`corridor`] (its response
//! against the limits), [`Butterworth`] and [`run_sections`], [`moving_average`], [`resample`], [`delay`],
//! [`pre_event`] (the zero level).

mod butterworth;
mod cfc;
mod channels;
mod filter;
mod recursion;
mod samples;

pub use butterworth::design::{Butterworth, Design, HIGHEST_ORDER, Pass, Phase, Section};
pub use butterworth::sections::{run_sections, sections_extension};
pub use cfc::class::{Cfc, Class};
pub use cfc::coefficients::Coefficients;
pub use cfc::corridor::{CorridorPoint, corridor, limits_db};
pub use cfc::mode::Mode;
pub use cfc::zero_phase::{Report, filter_both_ways, filter_both_ways_into, samples_added};
pub use channels::selection::{
    SelectionError, class_of_body, id_meant, ids_meant, is_barrier_force, is_of_body, occupants_left, select,
};
pub use filter::{Applied, Filtered, Instead, Settings, filter, filter_reporting};
pub use samples::delay::{Delay, delay};
pub use samples::derivative::{acceleration_of_velocity_change, derivative_note, printed_step_m_per_s};
pub use samples::moving_average::{moving_average, moving_average_gain, samples_of_width};
pub use samples::resampling::{Interpolation, Resampling, resample};
pub use samples::zero_level::{ZeroLevel, pre_event};

use crumple_signal::SignalError;

/// Why a channel cannot be filtered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The sampling rate is below ten times the class.
    #[error(
        "sampling rate {} Hz is too low for cfc {cfc}: at least {needed_hz} Hz (10 times the class) is needed",
        short(*rate_hz)
    )]
    Rate {
        /// What the record has.
        rate_hz: f64,
        /// What was asked for.
        cfc: Cfc,
        /// The lowest rate for it.
        needed_hz: f64,
    },
    /// Too few samples for the ends.
    #[error("{samples} samples are too few for a channel frequency class filter, at least 4 are needed")]
    TooShort {
        /// How many there are.
        samples: usize,
    },
    /// The window of the zero level ends before it starts.
    #[error("the zero level window ends at {to_s} s, before it starts at {from_s} s")]
    Window {
        /// Its start.
        from_s: f64,
        /// Its end.
        to_s: f64,
    },
    /// The order of a Butterworth filter is none.
    #[error("order {order} is not offered, an order from 1 to {HIGHEST_ORDER} is needed")]
    Order {
        /// What was asked for.
        order: usize,
    },
    /// A cut-off that the sampling rate cannot show, or so low that the coefficients lose their digits.
    #[error(
        "cut-off {cutoff_hz} Hz does not lie between {} Hz and half the sampling rate, {} Hz",
        short(1e-5 * rate_hz), short(rate_hz / 2.0)
    )]
    Cutoff {
        /// What was asked for.
        cutoff_hz: f64,
        /// What the record has.
        rate_hz: f64,
    },
    /// A band whose ends are exchanged.
    #[error("the band from {low_hz} Hz to {high_hz} Hz is empty: its lower end must lie below its upper end")]
    Band {
        /// Lower end.
        low_hz: f64,
        /// Upper end.
        high_hz: f64,
    },
    /// A moving average without a width, or longer than the record.
    #[error("a moving average over {width_s} s does not fit a record of {record_s:.4} s")]
    Width {
        /// What was asked for.
        width_s: f64,
        /// Length of the record.
        record_s: f64,
    },
    /// A new sampling rate that is none.
    #[error("cannot resample from {} Hz to {to_hz} Hz: a positive rate up to 1000 times the record's is needed", short(*from_hz))]
    ResampleRate {
        /// What was asked for.
        to_hz: f64,
        /// What the record has.
        from_hz: f64,
    },
    /// No sample of the new grid lies in the record.
    #[error("{samples} samples are too few for the new sampling rate: no point of its grid lies among them")]
    TooShortToResample {
        /// How many there are.
        samples: usize,
    },
    /// Two channels of different rates.
    #[error(
        "the channel is sampled at {} Hz, the one to align it to at {} Hz: one rate is needed",
        short(*channel_hz), short(*reference_hz)
    )]
    Rates {
        /// Rate of the channel.
        channel_hz: f64,
        /// Rate of the other.
        reference_hz: f64,
    },
    /// One of two channels to align is zero throughout, or overflows.
    #[error("a channel to align has no signal: its samples are all zero or too large")]
    NothingToAlign,
    /// The result is not a signal: the samples are so large that the filter overflows.
    #[error("the filtered channel is not a finite signal")]
    Result(#[source] SignalError),
}

/// A rate as a person writes it: 1/0.0025 is 400, not 399.99999999999994.
fn short(rate_hz: f64) -> f64 {
    (rate_hz * 1e3).round() / 1e3
}
