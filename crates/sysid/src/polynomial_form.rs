//! A sampled model of one input and one output as polynomials of the shift `q⁻¹`, with their deviations.

use crumple_numerics::linalg::CONDITION_LIMIT;
use crumple_numerics::lti::{Complex, StateSpace, polynomial_roots, to_transfer_function};
use nalgebra::{DMatrix, DVector};

use crate::modes::{discrete_mode_deviations, root_gradient};
use crate::{IdentifyError, IoData};

/// `y = B/F u`, `B = b_0 + b_1 q⁻¹ + ...`, `F = 1 + f_1 q⁻¹ + ...`.
#[derive(Debug, Clone, PartialEq)]
pub struct PolynomialForm {
    /// `b_0 ... b_n`.
    pub numerator: Vec<f64>,
    /// `1, f_1 ... f_n`.
    pub denominator: Vec<f64>,
    sample_time_s: f64,
}

/// Standard deviations of a least-squares fit of the simulation, for errors that are white.
#[derive(Debug, Clone, PartialEq)]
pub struct PolynomialDeviations {
    /// Of `b_0 ... b_n, f_1 ... f_n`.
    pub coefficients: Vec<f64>,
    covariance: DMatrix<f64>,
}

impl PolynomialForm {
    /// Of a sampled model. Errors: several channels, coefficients beyond the range of `f64`.
    pub fn new(model: &StateSpace) -> Result<Self, IdentifyError> {
        let sample_time_s = model.require_discrete()?;
        let StateSpace { a, b, c, d, .. } = model.clone();
        // In the variable of the shift a sampled model has the polynomials of a continuous one in its own.
        let in_shift = to_transfer_function(&StateSpace::new(a, b, c, d, None)?)?;
        let denominator = in_shift.denominator().to_vec();
        let missing = denominator.len() - in_shift.numerator().len();
        let numerator = std::iter::repeat_n(0.0, missing).chain(in_shift.numerator().iter().copied()).collect();
        Ok(Self { numerator, denominator, sample_time_s })
    }

    /// `signal` through `1/F`, late by `lag`.
    fn filtered(&self, signal: &[f64], lag: usize) -> Vec<f64> {
        let mut out: Vec<f64> = Vec::with_capacity(signal.len());
        for k in 0..signal.len() {
            let past = self.denominator[1..].iter().enumerate();
            let past: f64 = past.filter_map(|(i, f)| Some(f * out[k.checked_sub(i + 1)?])).sum();
            out.push(k.checked_sub(lag).map_or(0.0, |at| signal[at]) - past);
        }
        out
    }

    /// Deviations of a model that was fitted from rest to `data` and left errors of this mean square: `s² (J'J)⁻¹`, `J`
    /// the sensitivities `q⁻ʲ/F u` and `-q⁻ⁱ/F y_h`, `s²` by `N` less the coefficients. Errors: not determined.
    pub fn white_deviations(&self, data: &IoData, loss: f64) -> Result<PolynomialDeviations, IdentifyError> {
        let u = &data.inputs()[0];
        let driven: Vec<Vec<f64>> = (0..self.numerator.len()).map(|lag| self.filtered(u, lag)).collect();
        let output: Vec<f64> =
            (0..u.len()).map(|k| self.numerator.iter().zip(&driven).map(|(b, x)| b * x[k]).sum()).collect();
        let fed_back = (1..self.denominator.len()).map(|lag| self.filtered(&output, lag));
        let columns: Vec<Vec<f64>> = driven.iter().cloned().chain(fed_back).collect();
        let (samples, count) = (u.len(), columns.len());
        let sensitivities = DMatrix::from_fn(samples, count, |k, j| columns[j][k]);
        let singular = || IdentifyError::IllConditioned {
            method: "output error",
            condition: f64::INFINITY,
            limit: CONDITION_LIMIT,
        };
        let inverse = sensitivities.qr().r().try_inverse().ok_or_else(singular)?;
        let variance = loss * samples as f64 / samples.saturating_sub(count).max(1) as f64;
        let covariance = &inverse * inverse.transpose() * variance;
        let coefficients = covariance.diagonal().iter().map(|x| x.sqrt()).collect();
        Ok(PolynomialDeviations { coefficients, covariance })
    }

    /// Square of the distance from the pole nearest to `near` to the zero nearest to that pole, in deviations of the
    /// two to first order: chi-square with two degrees of freedom where both lie in one place. `None`: no zero, or a
    /// multiple root.
    pub(crate) fn distance_of_zero(&self, of: &PolynomialDeviations, near: Complex) -> Option<f64> {
        let nearest = |polynomial: &[f64], to: Complex| {
            let roots = polynomial_roots(polynomial).ok()?;
            roots.into_iter().min_by(|a, b| (a - to).norm().total_cmp(&(b - to).norm()))
        };
        let leading = self.numerator.iter().position(|b| *b != 0.0)?;
        let numerator = &self.numerator[leading..];
        let pole = nearest(&self.denominator, near)?;
        let zero = nearest(numerator, pole)?;
        let of_zero = root_gradient(numerator, zero)?;
        let of_pole = root_gradient(&self.denominator, pole)?;
        let before = std::iter::repeat_n(Complex::new(0.0, 0.0), leading);
        let gradient: Vec<Complex> = before.chain(of_zero).chain(of_pole[1..].iter().map(|dz| -dz)).collect();
        let parts = DMatrix::from_fn(2, gradient.len(), |i, k| if i == 0 { gradient[k].re } else { gradient[k].im });
        let covariance = &parts * &of.covariance * parts.transpose();
        let distance = [(zero - pole).re, (zero - pole).im];
        // On the real axis there is one direction.
        if pole.im == 0.0 && zero.im == 0.0 {
            return Some(distance[0] * distance[0] / covariance[(0, 0)]).filter(|square| square.is_finite());
        }
        let distance = DVector::from_row_slice(&distance);
        Some(distance.dot(&covariance.lu().solve(&distance)?)).filter(|square| square.is_finite())
    }

    /// Deviations of natural frequency (rad/s) and damping ratio of the sampled poles.
    pub fn mode_deviations(&self, of: &PolynomialDeviations, poles: &[Complex]) -> Vec<Option<(f64, f64)>> {
        let (b, f) = (self.numerator.len(), self.denominator.len() - 1);
        let covariance = of.covariance.view((b, b), (f, f)).into_owned();
        discrete_mode_deviations(&self.denominator[1..], &covariance, poles, self.sample_time_s)
    }
}
