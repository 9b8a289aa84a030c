//! How the exponential of a matrix is scaled: halvings before its Taylor series, squarings after it.

/// Taylor terms after scaling to a norm of 1/2: the rest of the series is below `0.5^17/17! = 3e-20`, and of its
/// derivative below `0.5^16/16! = 8e-19`.
pub(crate) const TERMS: usize = 16;

/// Halvings of a step after which a matrix of this norm is below 1/2. Beyond 2^60 the result is zero or infinite
/// anyway.
pub(crate) fn squarings_of(norm: f64) -> i32 {
    if norm > 0.5 { ((2.0 * norm).log2().ceil() as i32).clamp(0, 60) } else { 0 }
}
