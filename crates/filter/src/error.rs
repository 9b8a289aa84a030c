//! Why a channel cannot be filtered.

use crumple_signal::SignalError;

use crate::butterworth::HIGHEST_ORDER;
use crate::cfc::class::Cfc;

/// Why a channel cannot be filtered, resampled or aligned. In each case the result would be wrong or does not exist, so
/// no option lets it pass.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The sampling rate is below ten times the class, which SAE J211-1 asks for (six times the -3 dB frequency). The
    /// bilinear transform has then moved the -3 dB point by more than 5 %, from 1.667·CFC to above 1.751·CFC.
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
    /// Too few samples for the ends: each pass starts from the mean of ten samples, and four samples with the three
    /// that can be mirrored at each end are the fewest that make ten.
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
    /// A moving average whose width is not a positive number, or that is longer than the record.
    #[error("a moving average over {width_s} s does not fit a record of {record_s:.4} s")]
    Width {
        /// What was asked for.
        width_s: f64,
        /// Length of the record.
        record_s: f64,
    },
    /// A new sampling rate that is not a positive number, or more than 1000 times that of the record; the bound
    /// keeps the length of the result in proportion to the record.
    #[error("cannot resample from {} Hz to {to_hz} Hz: a positive rate up to 1000 times the record's is \
        needed", short(*from_hz))]
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
    /// One of two channels to align is zero throughout, or the sum of its squares overflows: the correlation
    /// coefficient has no denominator then.
    #[error("a channel to align has no signal: its samples are all zero or too large")]
    NothingToAlign,
    /// The result is not a signal: the samples are so large that the filter overflows.
    #[error("the filtered channel is not a finite signal")]
    Result(#[source] SignalError),
}

/// A rate in Hz, rounded to 0.001 Hz, as a person writes it: 1/0.0025 is 400, not 399.99999999999994.
fn short(rate_hz: f64) -> f64 {
    (rate_hz * 1e3).round() / 1e3
}
