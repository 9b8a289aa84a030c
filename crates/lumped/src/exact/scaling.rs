//! How the exponential of a matrix is scaled: halvings before its Taylor series, squarings after it.

/// Taylor terms after scaling to a norm of 1/2: the rest of the series is below `0.5^17/17! = 3e-20`, and of its
/// derivative below `0.5^16/16! = 8e-19`.
pub(crate) const TERMS: usize = 16;

/// Powers of the matrix that are formed: the series is one in the last of them, whose coefficients are sums of the
/// others (Paterson, Stockmeyer, *On the number of nonscalar multiplications necessary to evaluate polynomials*, 1973):
/// six products instead of fifteen.
pub(crate) const POWERS: usize = 4;

/// `1/k!` of the terms of the series.
pub(crate) const INVERSE_FACTORIALS: [f64; TERMS + 1] = {
    let mut inverse = [1.0; TERMS + 1];
    let mut k = 1;
    while k <= TERMS {
        inverse[k] = inverse[k - 1] / k as f64;
        k += 1;
    }
    inverse
};

/// Halvings of a step after which a matrix of this norm is below 1/2. Beyond 2^60 the result is zero or infinite
/// anyway.
pub(crate) fn squarings_of(norm: f64) -> i32 {
    if norm > 0.5 { ((2.0 * norm).log2().ceil() as i32).clamp(0, 60) } else { 0 }
}
