//! Transfer functions.

use crate::{Complex, LtiError, polynomial_roots};

/// A continuous transfer function of one input and one output.
///
/// Coefficients with the highest power of s first. Always: the denominator is monic, the numerator is no longer than
/// it (leading zeros dropped), and every coefficient is finite.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl TransferFunction {
    /// Divides by the leading coefficient of the denominator and drops leading zeros of both.
    /// Errors: zero denominator, not finite, more zeros than poles.
    pub fn new(numerator: &[f64], denominator: &[f64]) -> Result<Self, LtiError> {
        let denominator = trimmed(denominator);
        let numerator = trimmed(numerator);
        let Some(&leading) = denominator.first().filter(|&&c| c != 0.0) else {
            return Err(LtiError::NoLeadingCoefficient { what: "the denominator" });
        };
        if numerator.len() > denominator.len() {
            return Err(LtiError::NotProper { numerator: numerator.len() - 1, denominator: denominator.len() - 1 });
        }
        let divided = |p: &[f64]| p.iter().map(|c| c / leading).collect::<Vec<f64>>();
        let (numerator, mut denominator) = (divided(numerator), divided(denominator));
        denominator[0] = 1.0;
        if numerator.iter().chain(&denominator).any(|c| !c.is_finite()) {
            return Err(LtiError::NotFinite { what: "a transfer function" });
        }
        Ok(Self { numerator, denominator })
    }

    /// Numerator, highest power first.
    pub fn numerator(&self) -> &[f64] {
        &self.numerator
    }

    /// Denominator, highest power first; the first coefficient is 1.
    pub fn denominator(&self) -> &[f64] {
        &self.denominator
    }

    /// Value at `s`; infinite or NaN at a pole.
    pub fn at(&self, s: Complex) -> Complex {
        let horner = |p: &[f64]| p.iter().fold(Complex::new(0.0, 0.0), |sum, &c| sum * s + c);
        horner(&self.numerator) / horner(&self.denominator)
    }

    /// Roots of the denominator. Errors: [`LtiError::NotConverged`].
    pub fn poles(&self) -> Result<Vec<Complex>, LtiError> {
        polynomial_roots(&self.denominator)
    }

    /// Roots of the numerator; none for a zero numerator. Errors: [`LtiError::NotConverged`].
    pub fn zeros(&self) -> Result<Vec<Complex>, LtiError> {
        if self.numerator.iter().all(|&c| c == 0.0) { Ok(Vec::new()) } else { polynomial_roots(&self.numerator) }
    }
}

/// Without leading zeros, but never empty unless given empty.
fn trimmed(p: &[f64]) -> &[f64] {
    let first = p.iter().position(|&c| c != 0.0).unwrap_or(p.len().saturating_sub(1));
    &p[first..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_made_monic_and_trimmed() {
        let tf = TransferFunction::new(&[0.0, 4.0, 8.0], &[2.0, 0.0, 6.0]).unwrap();
        assert_eq!((tf.numerator(), tf.denominator()), (&[2.0, 4.0][..], &[1.0, 0.0, 3.0][..]));
        assert_eq!(tf.zeros().unwrap(), [Complex::new(-2.0, 0.0)]);
        assert_eq!(tf.at(Complex::new(0.0, 0.0)), Complex::new(4.0 / 3.0, 0.0));
    }

    #[test]
    fn improper_and_empty_are_refused() {
        let error = TransferFunction::new(&[1.0, 0.0, 0.0], &[1.0, 2.0]).unwrap_err();
        assert_eq!(error.to_string(), "numerator of degree 2 over denominator of degree 1 is not proper");
        assert!(TransferFunction::new(&[1.0], &[0.0]).is_err());
        assert!(TransferFunction::new(&[], &[]).is_err());
    }
}
