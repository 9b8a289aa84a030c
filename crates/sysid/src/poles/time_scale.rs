//! A cascade in scaled time converted to seconds, and sums over its states.
//!
//! The fits run in scaled time, from 0 to 1 over a record of `T` seconds: `s' = s T`. A pole is divided by `T`, a
//! denominator coefficient of `s^k` by `T^(n-k)`; what remains is which power of `T` belongs to each numerator.

use crate::poles::cascade::{Section, SectionChain};

/// `sum c_s p_s` of polynomials of one length.
pub(crate) fn combined(polynomials: &[Vec<f64>], c: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; polynomials.first().map_or(0, Vec::len)];
    for (polynomial, c) in polynomials.iter().zip(c) {
        for (sum, p) in sum.iter_mut().zip(polynomial) {
            *sum += c * p;
        }
    }
    sum
}

/// A numerator of degree below `n` over a chain of order `n`, of an impulse: from scaled time to seconds.
///
/// `polynomial` is highest power first, `duration` is `T` in seconds. The coefficient of `(sT)^j` is multiplied by
/// `T^(j-n+1)`: one `T` more than of a driven response, for the impulse is one in scaled time.
pub(crate) fn in_seconds(polynomial: &[f64], n: usize, duration: f64) -> Vec<f64> {
    let length = polynomial.len();
    polynomial
        .iter()
        .enumerate()
        .map(|(index, b)| {
            let degree = i32::try_from(length - 1 - index).unwrap_or(0);
            // Time response: N(sT)/A(sT) of an impulse delta(t/T) = T delta(t).
            b * duration.powi(degree - i32::try_from(n).unwrap_or(0)) * duration
        })
        .collect()
}

/// The chain in 1/s from one in scaled time.
///
/// `r -> r/T`, `p -> p/T`, `q -> q/T²`.
pub(crate) fn unscaled(chain: &SectionChain, duration: f64) -> SectionChain {
    SectionChain::new(
        chain
            .sections()
            .iter()
            .map(|section| match *section {
                Section::First(r) => Section::First(r / duration),
                Section::Second(p, q) => Section::Second(p / duration, q / duration / duration),
            })
            .collect(),
    )
}

/// Power of the duration that belongs to every state: one of degree d in the numerator is `(sT)^d/(sT)^n`.
pub(crate) fn state_powers(chain: &SectionChain) -> Vec<i32> {
    let n = chain.order();
    let degree = |numerator: &Vec<f64>| n - 1 - numerator.iter().position(|x| *x != 0.0).unwrap_or(n - 1);
    let power = |degree: usize| i32::try_from(degree).unwrap_or(0) - i32::try_from(n).unwrap_or(0);
    chain.state_numerators().iter().map(|numerator| power(degree(numerator))).collect()
}
