//! Linear models: state space, transfer function, and the modes of a pole.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::lti::eigenvalues::check_finite;
use crate::lti::{Complex, LtiError, eigenvalues, polynomial_roots};

/// One pole in continuous time, as an engineer reads it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Continuous pole: real part 1/s, imaginary part rad/s.
    pub pole: Complex,
    /// Modulus of the pole, rad/s. Not to be multiplied by 2 pi.
    pub natural_frequency_rad_per_s: f64,
    /// `-Re/|s|`: 1 for a real decaying pole, negative for a growing one; `None` for a pole at zero.
    pub damping_ratio: Option<f64>,
}

impl Mode {
    /// The mode of a continuous pole.
    pub fn continuous(pole: Complex) -> Self {
        let modulus = pole.norm();
        Self { pole, natural_frequency_rad_per_s: modulus, damping_ratio: (modulus > 0.0).then(|| -pole.re / modulus) }
    }

    /// The mode of a discrete pole, `s = ln(z)/dt` on the principal branch, so `|Im s| <= pi/dt`.
    ///
    /// `None` for `z = 0`, a pure delay. A negative real `z` lands on `Im s = pi/dt` without a partner: an artefact of
    /// sampling or of too high an order, for the caller to name.
    pub fn discrete(z: Complex, dt_s: f64) -> Option<Self> {
        let squared = z.norm_sqr();
        if squared == 0.0 || !squared.is_finite() {
            return None;
        }
        // Near the unit circle ln|z| cancels; its square minus one does not.
        let log_modulus = if (0.5..2.0).contains(&squared) {
            0.5 * ((z.re - 1.0) * (z.re + 1.0) + z.im * z.im).ln_1p()
        } else {
            z.norm().ln()
        };
        Some(Self::continuous(Complex::new(log_modulus / dt_s, z.arg() / dt_s)))
    }

    /// Natural frequency, Hz.
    pub fn natural_frequency_hz(&self) -> f64 {
        self.natural_frequency_rad_per_s / TAU
    }
}

/// `x' = a x + b u`, `y = c x + d u`, or with `x[k+1]` on the left for a sampled model.
///
/// Built by [`StateSpace::new`]: shapes agree and every entry is finite.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// State matrix, n x n.
    pub a: DMatrix<f64>,
    /// Input matrix, n x inputs.
    pub b: DMatrix<f64>,
    /// Output matrix, outputs x n.
    pub c: DMatrix<f64>,
    /// Direct term, outputs x inputs.
    pub d: DMatrix<f64>,
    /// Sampling interval, s; `None`: continuous time.
    pub sample_time_s: Option<f64>,
}

impl StateSpace {
    /// Checks shapes and values. Errors: [`LtiError::Shape`], [`LtiError::NotFinite`], [`LtiError::SampleTime`].
    pub fn new(
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        c: DMatrix<f64>,
        d: DMatrix<f64>,
        sample_time_s: Option<f64>,
    ) -> Result<Self, LtiError> {
        let (n, inputs, outputs) = (a.nrows(), b.ncols(), c.nrows());
        for (what, matrix, (rows, columns)) in
            [("a", &a, (n, n)), ("b", &b, (n, inputs)), ("c", &c, (outputs, n)), ("d", &d, (outputs, inputs))]
        {
            if matrix.shape() != (rows, columns) {
                return Err(LtiError::Shape {
                    what,
                    rows: matrix.nrows(),
                    columns: matrix.ncols(),
                    expected: format!("{rows} x {columns}"),
                });
            }
            check_finite(what, matrix)?;
        }
        if let Some(dt) = sample_time_s {
            check_sample_time(dt)?;
        }
        Ok(Self { a, b, c, d, sample_time_s })
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Eigenvalues of `a`, in the order of [`eigenvalues()`]: s-plane for a continuous model (1/s,
    /// rad/s), z-plane for a sampled one. Errors: [`LtiError::NotConverged`].
    pub fn poles(&self) -> Result<Vec<Complex>, LtiError> {
        eigenvalues(&self.a)
    }

    /// The sampling interval, s. Errors: [`LtiError::TimeDomain`] for a continuous model.
    pub fn require_discrete(&self) -> Result<f64, LtiError> {
        self.sample_time_s.ok_or(LtiError::TimeDomain { found: "continuous", needed: "a discrete one" })
    }

    /// Errors with [`LtiError::TimeDomain`] for a sampled model.
    pub fn require_continuous(&self) -> Result<(), LtiError> {
        match self.sample_time_s {
            None => Ok(()),
            Some(_) => Err(LtiError::TimeDomain { found: "discrete", needed: "a continuous one" }),
        }
    }

    /// Errors with [`LtiError::NotSingle`] unless there is one input and one output.
    pub fn require_single(&self) -> Result<(), LtiError> {
        match (self.b.ncols(), self.c.nrows()) {
            (1, 1) => Ok(()),
            (inputs, outputs) => Err(LtiError::NotSingle { inputs, outputs }),
        }
    }
}

/// Errors unless the interval is a positive number.
pub(crate) fn check_sample_time(dt_s: f64) -> Result<(), LtiError> {
    if dt_s.is_finite() && dt_s > 0.0 { Ok(()) } else { Err(LtiError::SampleTime(dt_s)) }
}

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
    use nalgebra::dmatrix;

    #[test]
    fn discrete_pole_returns_the_continuous_one() {
        let dt = 1e-4;
        for pole in [Complex::new(-18.04, 533.15), Complex::new(-274.9, 501.4), Complex::new(3.0, -40.0)] {
            let back = Mode::discrete((pole * dt).exp(), dt).unwrap();
            // One rounding of z is 1e-16/dt = 1e-12 in s.
            assert!((back.pole - pole).norm() < 4e-12, "{}", back.pole);
        }
    }

    #[test]
    fn damping_tells_decay_from_growth_and_is_undefined_at_zero() {
        assert_eq!(Mode::continuous(Complex::new(-3.0, 4.0)).damping_ratio, Some(0.6));
        assert_eq!(Mode::continuous(Complex::new(2.0, 0.0)).damping_ratio, Some(-1.0));
        assert_eq!(Mode::continuous(Complex::new(0.0, 0.0)).damping_ratio, None);
        assert!(Mode::discrete(Complex::new(0.0, 0.0), 1e-3).is_none());
    }

    #[test]
    fn names_the_matrix_that_does_not_fit() {
        let error = StateSpace::new(DMatrix::identity(2, 2), dmatrix![1.0], dmatrix![1.0, 0.0], dmatrix![0.0], None)
            .unwrap_err();
        assert_eq!(error.to_string(), "b is 1 x 1, expected 2 x 1");
    }

    #[test]
    fn refuses_a_nan_and_a_zero_interval() {
        let unit = dmatrix![1.0];
        let nan = StateSpace::new(dmatrix![f64::NAN], unit.clone(), unit.clone(), unit.clone(), None).unwrap_err();
        assert_eq!(nan.to_string(), "a holds a value that is not finite");
        let zero = StateSpace::new(unit.clone(), unit.clone(), unit.clone(), unit, Some(0.0)).unwrap_err();
        assert_eq!(zero, LtiError::SampleTime(0.0));
    }

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
