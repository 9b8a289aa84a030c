//! Prior covariance of an impulse response: it dies out, and neighbouring samples are correlated.

use nalgebra::DMatrix;

/// Prior covariance of the samples of an impulse response: it dies out, and neighbours are alike.
///
/// Chen, Ohlsson & Ljung, "On the estimation of transfer functions, regularizations and Gaussian processes -
/// revisited", Automatica 48, 2012.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernel {
    /// Tuned and correlated: `K[i,j] = c lambda^max(i,j)`, one decay for size and likeness.
    #[default]
    TunedCorrelated,
    /// Diagonal and correlated: `K[i,j] = c lambda^((i+j)/2) rho^|i-j|`. With `rho = sqrt lambda` the same as above; a
    /// negative `rho` expects alternation.
    DiagonalCorrelated,
    /// No prior: ordinary least squares.
    None,
}

impl Kernel {
    /// All of them, the default first.
    pub const ALL: [Self; 3] = [Self::TunedCorrelated, Self::DiagonalCorrelated, Self::None];

    /// Name in options: `tc`, `dc`, `none`.
    pub fn name(self) -> &'static str {
        match self {
            Self::TunedCorrelated => "tc",
            Self::DiagonalCorrelated => "dc",
            Self::None => "none",
        }
    }
}

/// Shape of a kernel, as unbounded numbers for a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KernelShape {
    /// `ln(-ln lambda)`: the logarithm of the rate of decay per sample.
    pub(crate) log_rate: f64,
    /// `atanh(rho)`; `None`: `rho = sqrt lambda`.
    pub(crate) likeness: Option<f64>,
}

impl KernelShape {
    /// Decay of variance per sample, from 0 to 1.
    pub(crate) fn lambda(self) -> f64 {
        (-self.log_rate.exp()).exp()
    }

    /// Correlation of neighbours.
    pub(crate) fn rho(self) -> f64 {
        self.likeness.map_or_else(|| self.lambda().sqrt(), f64::tanh)
    }

    /// The kernel with `c = 1`, the same for each of the inputs, whose responses are independent.
    pub(crate) fn matrix(self, taps: usize, inputs: usize) -> DMatrix<f64> {
        let (half_rate, rho) = (0.5 * self.log_rate.exp(), self.rho());
        let powers: Vec<f64> = (0..taps).map(|d| rho.powi(i32::try_from(d).unwrap_or(i32::MAX))).collect();
        let sizes: Vec<f64> = (0..taps).map(|i| (-half_rate * i as f64).exp()).collect();
        DMatrix::from_fn(taps * inputs, taps * inputs, |i, j| {
            let (ti, tj) = (i % taps, j % taps);
            if i / taps == j / taps { sizes[ti] * sizes[tj] * powers[ti.abs_diff(tj)] } else { 0.0 }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tuned_kernel_is_the_diagonal_one_with_the_root_of_its_decay() {
        let lambda = 0.8_f64;
        let log_rate = (-lambda.ln()).ln();
        let tuned = KernelShape { log_rate, likeness: None }.matrix(6, 2);
        let diagonal = KernelShape { log_rate, likeness: Some(lambda.sqrt().atanh()) }.matrix(6, 2);
        let exact = DMatrix::from_fn(12, 12, |i, j| {
            if i / 6 == j / 6 { lambda.powi(i32::try_from((i % 6).max(j % 6)).unwrap_or(0)) } else { 0.0 }
        });
        // Rounding of powers.
        assert!((&tuned - &exact).amax() < 1e-14 && (&diagonal - &exact).amax() < 1e-14);
    }
}
