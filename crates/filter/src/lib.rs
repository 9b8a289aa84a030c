//! Channel frequency class filters for crash records: SAE J211-1 Appendix C and ISO 6487 Annex A.
//!
//! [`filter`] does for one channel what the stage does for all: remove the zero level, check the sampling rate,
//! run the phaseless four-pole filter, and say in notes what a reader should know. The parts are here to be used
//! alone: [`Coefficients`] (the difference equation), [`filter_both_ways`] (the two passes and the ends),
//! [`pre_event`] (the zero level).

mod cfc;
mod channel;
mod coefficients;
mod mode;
mod selection;
mod zero_level;
mod zero_phase;

pub use cfc::{Cfc, Class};
pub use channel::{Applied, Filtered, Settings, filter};
pub use coefficients::Coefficients;
pub use mode::Mode;
pub use selection::{SelectionError, select};
pub use zero_level::{PreEvent, Window, ZeroLevel, pre_event};
pub use zero_phase::{filter_both_ways, samples_added};

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
    /// The result is not a signal: the samples are so large that the filter overflows.
    #[error("the filtered channel is not a finite signal")]
    Result(#[source] SignalError),
}

/// A rate as a person writes it: 1/0.0025 is 400, not 399.99999999999994.
fn short(rate_hz: f64) -> f64 {
    (rate_hz * 1e3).round() / 1e3
}
