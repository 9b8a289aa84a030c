//! Why a channel cannot be filtered, and why an acceleration cannot be integrated.

use crate::butterworth::HIGHEST_ORDER;
use crate::{Cfc, SignalError};

/// Why a channel cannot be filtered or resampled. In each case the result would be wrong or does not exist, so
/// no option lets it pass.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The sampling rate is below ten times the class, which SAE J211-1 asks for (six times the -3 dB frequency). The
    /// bilinear transform has then moved the -3 dB point by more than 5 %, from 1.667·CFC to above 1.751·CFC.
    #[error(
        "a sampling rate of {} Hz is too low for CFC {cfc}, which needs at least {needed_hz} Hz (10 times the class)",
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
    /// The result is not a signal: the samples are so large that the filter overflows.
    #[error("the filtered channel is not a finite signal")]
    Result(#[source] SignalError),
}

/// A rate in Hz, rounded to 0.001 Hz, as a person writes it: 1/0.0025 is 400, not 399.99999999999994.
fn short(rate_hz: f64) -> f64 {
    (rate_hz * 1e3).round() / 1e3
}

/// Why an acceleration cannot be integrated. Each variant holds what was stated and what the record has, in SI units
/// on the record's own time axis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegrateError {
    /// The impact speed, m/s, is negative, infinite or no number; 0 is a motion from rest and allowed.
    #[error("impact speed {0} m/s is negative or no number")]
    ImpactSpeed(f64),
    /// The mass, kg, is not a positive number, so that `F = -m·a` has no meaning.
    #[error("mass {0} kg is not a positive number")]
    Mass(f64),
    /// The record does not cover contact and what follows it: it needs two samples at or after contact, and its first
    /// sample may come no more than one interval late, because the speed is known at contact alone.
    #[error(
        "contact (0 s) needs two samples after it and a record that starts no later, the record runs from \
         {first_s:.6} s to {last_s:.6} s"
    )]
    NoContact {
        /// First sample, s from contact.
        first_s: f64,
        /// Last sample.
        last_s: f64,
    },
    /// The time of a known velocity is not in the motion, or is its first sample, where the velocity is given already
    /// and a drift has done nothing yet.
    #[error("the known velocity is stated at {time_s} s, the motion runs from {first_s:.6} s to {last_s:.6} s")]
    EndCondition {
        /// When it is stated, on the record's axis.
        time_s: f64,
        /// IntegrationStart of the motion.
        first_s: f64,
        /// Its end.
        last_s: f64,
    },
    /// The result is not a signal: the samples are so large that the sum overflows.
    #[error("the integrated channel is not a finite signal")]
    Result(#[from] SignalError),
}
