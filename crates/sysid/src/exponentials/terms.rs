//! The terms of a sum of exponentials, and the numbers they are made of.

use crumple_lti::Complex;

use crate::poles::cascade::SectionChain;
use crate::poles::time_scale::unscaled;

/// `amplitude exp(exponent t)`, t from the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExponentialTerm {
    /// Amplitude, unit of the record.
    pub amplitude: Complex,
    /// Exponent, 1/s and rad/s.
    pub exponent: Complex,
}

/// Residues of the free motion at its poles.
///
/// `free` are coefficients of the chain's states, one each, in scaled time and units; `scale` takes the unit back
/// out. The residue at a simple pole `s_i` is `N(s_i)/prod_(j != i)(s_i - s_j)`: it grows without bound as poles
/// meet, where two large terms cancel. Exponents come in 1/s.
pub(crate) fn terms(chain: &SectionChain, free: &[f64], duration: f64, scale: f64) -> Vec<ExponentialTerm> {
    let numerators = chain.state_numerators();
    let poles = chain.poles();
    let seconds = unscaled(chain, duration).poles();
    poles
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let numerator: Complex = numerators
                .iter()
                .zip(free)
                .map(|(p, c)| p.iter().fold(Complex::new(0.0, 0.0), |sum, p| sum * s + p) * *c)
                .sum();
            let slope: Complex = poles
                .iter()
                .enumerate()
                .filter(|(j, _)| *j != i)
                .map(|(_, other)| s - other)
                .fold(Complex::new(1.0, 0.0), |product, difference| product * difference);
            ExponentialTerm { amplitude: numerator / slope * scale, exponent: seconds[i] }
        })
        .collect()
}

/// One number of a term.
/// A real amplitude or exponent has no imaginary part to vary.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Part {
    ReAmplitude,
    ImAmplitude,
    RePerS,
    ImRadPerS,
}

impl Part {
    /// Name in records, to which the number of the term is added.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ReAmplitude => "re_amplitude",
            Self::ImAmplitude => "im_amplitude",
            Self::RePerS => "re_per_s",
            Self::ImRadPerS => "im_rad_per_s",
        }
    }

    fn value_in(self, term: &ExponentialTerm) -> f64 {
        match self {
            Self::ReAmplitude => term.amplitude.re,
            Self::ImAmplitude => term.amplitude.im,
            Self::RePerS => term.exponent.re,
            Self::ImRadPerS => term.exponent.im,
        }
    }
}

/// The numbers that terms of their kind have, conjugates once.
pub(crate) fn parts(terms: &[ExponentialTerm]) -> Vec<(usize, Part)> {
    let parts_of = |exponent: Complex| match exponent.im {
        0.0 => &[Part::ReAmplitude, Part::RePerS][..],
        im if im > 0.0 => &[Part::ReAmplitude, Part::ImAmplitude, Part::RePerS, Part::ImRadPerS][..],
        _ => &[],
    };
    terms.iter().enumerate().flat_map(|(i, term)| parts_of(term.exponent).iter().map(move |part| (i, *part))).collect()
}

/// Their values, in this order.
pub(crate) fn values(parts: &[(usize, Part)], terms: &[ExponentialTerm]) -> Vec<f64> {
    parts.iter().map(|(term, part)| part.value_in(&terms[*term])).collect()
}
