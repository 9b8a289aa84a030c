//! Why a metric cannot be computed.

/// Why a metric cannot be computed from what was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MetricsError {
    /// Two signals of one motion differ in start, interval or length.
    #[error(
        "{first} has {first_len} samples from {first_t0_s} s, {second} has {second_len} from {second_t0_s} s: one grid \
         is needed"
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
    /// A rating against nothing.
    #[error("the reference is zero everywhere, a rating needs a reference that is not")]
    ZeroReference,
    /// The impact speed is no speed.
    #[error("impact speed {0} m/s is not a positive number")]
    ImpactSpeed(f64),
    /// The result is not a signal: the samples are so large that a sum overflows.
    #[error("the result is not a finite signal")]
    Result(#[from] crumple_signal::SignalError),
}
