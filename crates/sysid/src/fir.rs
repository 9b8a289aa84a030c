//! Impulse responses by regularised least squares.

use crumple_numerics::linalg::CONDITION_LIMIT;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;

use crate::regression::data_triangle::triangular_factor;
use crate::{IdentifyError, IoData};

// Estimation of impulse responses with a Gaussian prior.

/// Decay of the variance over all taps, in powers of e, at the corners of the grid.
const DECAYS: [f64; 10] = [0.3, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0, 40.0, 80.0, 160.0];

/// Correlations of neighbours at the corners of the grid, beside that of the tuned kernel.
const LIKENESSES: [f64; 6] = [0.0, 0.7, 0.9, 0.97, 0.99, 0.998];

/// Smallest step of the search in logarithms of rates: beyond, the likelihood is flat.
const STEP: f64 = 0.01;

/// Evaluations of the search from the best corner at most.
const EVALUATIONS: usize = 60;

/// QR steps per eigenvalue before a symmetric matrix counts as stuck; two are usual.
const EIGEN_STEPS_PER_VALUE: usize = 60;

/// Settings of [`fir`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FirOptions {
    /// Samples of the impulse response, that of the same instant included.
    pub taps: usize,
    /// What is expected of it.
    pub kernel: Kernel,
    /// Whether the inputs were zero before the first sample. Otherwise the first `taps - 1` samples serve as past only.
    pub at_rest: bool,
}

/// What the likelihood chose for one output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hyperparameters {
    /// Decay of variance per sample, `lambda`.
    pub decay: f64,
    /// Correlation of neighbours, `rho`.
    pub likeness: f64,
    /// Variance of the first sample over that of the noise, in scaled units.
    pub signal_to_noise: f64,
    /// Variance of the noise, square of the output's unit.
    pub noise_variance: f64,
    /// Effective number of parameters, the trace of the smoother: at most the number of taps.
    pub effective_parameters: f64,
}

/// Estimated impulse responses.
#[derive(Debug, Clone, PartialEq)]
pub struct Fir {
    /// Of every pair, in the order of [`MarkovParameters::new`](crate::MarkovParameters::new); `taps` samples each.
    pub sequences: Vec<Vec<f64>>,
    /// One per output; `None` without a kernel.
    pub hyperparameters: Vec<Option<Hyperparameters>>,
}

/// Estimates `y[k] = sum_i h[i] u[k-i] + white noise` with a Gaussian prior of covariance `c K` on `h`.
///
/// With `R` the triangular factor of the regressors, `r` the rotated output and `R K R' = U diag(d) U'`, the estimate
/// is `h = g K R' U diag(1/(1 + g d)) U' r`, `g = c/noise variance`: the kernel is never inverted, however
/// ill-conditioned. The likelihood of the output (noise variance eliminated) is maximised over `g` exactly on every
/// corner of a grid of kernel shapes, then by a compass search over `(ln -ln lambda, atanh rho)`. One optimum of
/// several may be missed; the estimate depends weakly on it.
///
/// This keeps short and noisy records usable, where least squares needs several samples for each tap. Without a kernel
/// it is least squares: a condition number above 1e12 is an error.
///
/// Chen & Ljung, "Implementation of algorithms for tuning parameters in regularized least squares problems in system
/// identification", Automatica 49, 2013.
pub fn fir(data: &IoData, options: FirOptions) -> Result<Fir, IdentifyError> {
    let FirOptions { taps, kernel, at_rest } = options;
    let (m, q, samples) = (data.inputs().len(), data.outputs().len(), data.samples());
    if m == 0 {
        return Err(IdentifyError::Channels { method: "fir", needed: "one input at least", inputs: 0, outputs: q });
    }
    let past = taps.saturating_sub(1);
    let unknowns = taps.saturating_mul(m);
    let rows = if at_rest { samples } else { samples.saturating_sub(past) };
    // With a prior there may be fewer equations than unknowns.
    let least = if kernel == Kernel::None { unknowns + 1 } else { 3 };
    if taps == 0 || rows < least {
        return Err(IdentifyError::TooShort {
            method: "fir",
            samples,
            needed: if at_rest { least } else { least + past },
            why: format!("{taps} taps of {m} inputs"),
        });
    }
    if data.outputs().iter().all(|y| y.iter().all(|x| *x == 0.0)) {
        return Err(IdentifyError::Silent("outputs"));
    }
    let (u_scales, y_scales) = (data.input_scales(), data.output_scales());
    let pad = if at_rest { past } else { 0 };
    let inputs: Vec<Vec<f64>> = data
        .inputs()
        .iter()
        .zip(&u_scales)
        .map(|(u, scale)| std::iter::repeat_n(0.0, pad).chain(u.iter().map(|x| x / scale)).collect())
        .collect();
    let outputs: Vec<Vec<f64>> =
        data.outputs().iter().zip(&y_scales).map(|(y, scale)| y.iter().map(|x| x / scale).collect()).collect();
    let mut stretches: Vec<(&[f64], usize)> = Vec::with_capacity(unknowns + q);
    for u in &inputs {
        stretches.extend((0..taps).map(|i| (u.as_slice(), past - i)));
    }
    stretches.extend(outputs.iter().map(|y| (y.as_slice(), past - pad)));
    let factor = triangular_factor(&stretches, rows);
    let failed = || IdentifyError::NotConverged("the fit of the impulse response");

    let estimates: Vec<(DVector<f64>, Option<Hyperparameters>)> = if kernel == Kernel::None {
        let solution = factor.solve(q, 0.0).ok_or_else(failed)?;
        if solution.condition > CONDITION_LIMIT {
            return Err(IdentifyError::IllConditioned {
                method: "fir",
                condition: solution.condition,
                limit: CONDITION_LIMIT,
            });
        }
        (0..q).map(|i| (solution.coefficients.column(i).into_owned(), None)).collect()
    } else {
        let whole = factor.matrix();
        let r = whole.view((0, 0), (unknowns, unknowns)).into_owned();
        let mut all = Vec::with_capacity(q);
        for (i, scale) in y_scales.iter().enumerate() {
            let target = whole.column(unknowns + i);
            let evidence = Evidence {
                r: &r,
                target: target.rows(0, unknowns).into_owned(),
                rest: target.rows(unknowns, q).norm_squared(),
                rows: rows as f64,
                taps,
                inputs: m,
            };
            let best = evidence.search(kernel).ok_or_else(failed)?;
            let h = evidence.estimate(&best);
            let hyperparameters = Hyperparameters {
                decay: best.shape.lambda(),
                likeness: best.shape.rho(),
                signal_to_noise: best.ratio,
                noise_variance: best.noise_variance * scale * scale,
                effective_parameters: best.values.iter().map(|d| best.ratio * d / (1.0 + best.ratio * d)).sum(),
            };
            all.push((h, Some(hyperparameters)));
        }
        all
    };
    let mut sequences = Vec::with_capacity(q * m);
    for (i, (h, _)) in estimates.iter().enumerate() {
        for (j, scale) in u_scales.iter().enumerate() {
            sequences.push((0..taps).map(|k| h[j * taps + k] * y_scales[i] / scale).collect());
        }
    }
    Ok(Fir { sequences, hyperparameters: estimates.into_iter().map(|(_, hyper)| hyper).collect() })
}

/// What one output says of kernels.
///
/// Marginal likelihood of a kernel: with `z = U' r` and eigenvalues `d` the output has the variances `1 + g d` in
/// units of the noise, so that its likelihood needs one eigendecomposition per shape and nothing more for any `g`.
struct Evidence<'a> {
    /// Triangular factor of the regressors, `taps inputs` square.
    r: &'a DMatrix<f64>,
    /// Rotated output.
    target: DVector<f64>,
    /// Square of what no response explains.
    rest: f64,
    /// Number of equations.
    rows: f64,
    taps: usize,
    inputs: usize,
}

/// A kernel shape with the best ratio of its size to the noise.
struct Candidate {
    shape: KernelShape,
    ratio: f64,
    noise_variance: f64,
    /// `-2 ln likelihood`, up to a constant.
    cost: f64,
    /// Eigenvalues `d` and eigenvectors `U` of `R K R'`.
    values: Vec<f64>,
    vectors: DMatrix<f64>,
}

impl Evidence<'_> {
    /// The best ratio for a kernel shape, by steps of a factor e from far too little to far too much and 25 golden
    /// sections around the best of them: to about 1e-5 of its logarithm. `None` where the kernel leaves the range of
    /// numbers.
    fn candidate(&self, shape: KernelShape) -> Option<Candidate> {
        let kernel = shape.matrix(self.taps, self.inputs);
        let n = self.r.nrows();
        let product = self.r * kernel * self.r.transpose();
        let symmetric = (&product + product.transpose()) * 0.5;
        if symmetric.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let eigen = SymmetricEigen::try_new(symmetric, f64::EPSILON, EIGEN_STEPS_PER_VALUE * n)?;
        let parts: Vec<f64> = eigen.eigenvectors.tr_mul(&self.target).iter().map(|z| z * z).collect();
        // Rounding makes the smallest slightly negative.
        let values: Vec<f64> = eigen.eigenvalues.iter().map(|d| d.max(0.0)).collect();
        let largest = values.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return None;
        }
        let energy = self.rest + parts.iter().sum::<f64>();
        let noise = |ratio: f64| {
            let left: f64 = values.iter().zip(&parts).map(|(d, z)| z / (1.0 + ratio * d)).sum();
            // A record without noise: down to rounding.
            ((self.rest + left) / self.rows).max(f64::EPSILON * f64::EPSILON * energy / self.rows)
        };
        let cost = |log: f64| {
            let ratio = log.exp() / largest;
            self.rows * noise(ratio).ln() + values.iter().map(|d| (ratio * d).ln_1p()).sum::<f64>()
        };
        // From nothing to as many digits as there are, in steps of a factor e, then by golden sections.
        let start = (-5..=60).map(f64::from).fold(-5.0, |best, log| if cost(log) < cost(best) { log } else { best });
        let (mut low, mut high) = (start - 1.0, start + 1.0);
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        for _ in 0..25 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if cost(a) <= cost(b) { high = b } else { low = a }
        }
        let log = 0.5 * (low + high);
        let ratio = log.exp() / largest;
        let candidate = Candidate {
            shape,
            ratio,
            noise_variance: noise(ratio),
            cost: cost(log),
            values,
            vectors: eigen.eigenvectors,
        };
        candidate.cost.is_finite().then_some(candidate)
    }

    /// Best of the grid, then a compass search from there. Ties go to the first.
    fn search(&self, kernel: Kernel) -> Option<Candidate> {
        let mut corners = Vec::new();
        for decay in DECAYS {
            let log_rate = (decay / self.taps as f64).ln();
            corners.push(KernelShape { log_rate, likeness: None });
            if kernel == Kernel::DiagonalCorrelated {
                corners.extend(LIKENESSES.map(|rho| KernelShape { log_rate, likeness: Some(rho.atanh()) }));
            }
        }
        let candidates: Vec<Option<Candidate>> = corners.par_iter().map(|shape| self.candidate(*shape)).collect();
        let better = |a: Candidate, b: Candidate| if b.cost < a.cost { b } else { a };
        let mut best = candidates.into_iter().flatten().reduce(better)?;
        if kernel == Kernel::DiagonalCorrelated {
            best.shape.likeness = Some(best.shape.rho().atanh());
        }
        let (mut step, mut evaluations) = (0.4, 0);
        while step > STEP && evaluations < EVALUATIONS {
            let KernelShape { log_rate, likeness } = best.shape;
            let mut around = vec![
                KernelShape { log_rate: log_rate - step, likeness },
                KernelShape { log_rate: log_rate + step, likeness },
            ];
            if let Some(likeness) = likeness {
                around.push(KernelShape { log_rate, likeness: Some(likeness - step) });
                around.push(KernelShape { log_rate, likeness: Some(likeness + step) });
            }
            evaluations += around.len();
            let tried: Vec<Option<Candidate>> = around.par_iter().map(|shape| self.candidate(*shape)).collect();
            match tried.into_iter().flatten().reduce(better).filter(|next| next.cost < best.cost) {
                Some(next) => best = next,
                None => step *= 0.5,
            }
        }
        Some(best)
    }

    /// `g K R' U diag(1/(1 + g d)) U' r`.
    fn estimate(&self, candidate: &Candidate) -> DVector<f64> {
        let mut parts = candidate.vectors.tr_mul(&self.target);
        for (z, d) in parts.iter_mut().zip(&candidate.values) {
            *z *= candidate.ratio / (1.0 + candidate.ratio * d);
        }
        candidate.shape.matrix(self.taps, self.inputs) * self.r.tr_mul(&(&candidate.vectors * parts))
    }
}

// Prior covariance of an impulse response: it dies out, and neighbouring samples are correlated.

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
