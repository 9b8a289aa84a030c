//! Starting poles for a continuous transfer function.
//!
//! The search for poles is local, its starts are not: regressions behind filters, instrumental variables, subspace
//! methods, ARX models, and seeded random poles, each over a grid where it has a parameter of its own. No start has to
//! be good; one of them has to lie in the right valley.

use std::f64::consts::PI;

use crumple_numerics::estimation::random::uniform_at;
use crumple_numerics::linalg::TriangularFactor;
use crumple_numerics::linalg::dot;
use crumple_numerics::lti::{Complex, polynomial_roots};
use nalgebra::{DMatrix, DVector};

use crate::data::scale;
use crate::poles::cascade::{Drive, SectionChain, sections_of};
use crate::{ArxOrder, Hold, IoData, Subspace, SubspaceOptions, Weighting, arx, automatic_thinning, thinned};

/// Break frequencies of the filters that are tried, evenly spaced in the logarithm.
const FILTERS: usize = 8;

/// Iterations of the refined instrumental variables; a starting point need not converge.
const IV_ITERATIONS: usize = 12;

/// Regressions on derivatives are starts up to this order: above, their coefficients have lost the digits.
pub(crate) const MOST_CONTINUOUS: usize = 10;

/// Samples that a thinned record keeps at least, in units of what its factorisation needs.
const KEPT: usize = 2;

/// Block rows of a subspace start, at least.
const SHORTEST_HORIZON: usize = 10;

/// Taps of the longer ARX start, in units of the poles.
const LONGER: usize = 4;

/// A way to a starting point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// State-variable filter: least squares on derivatives behind `(lambda/(s+lambda))^np`.
    /// The derivatives of noisy signals are never formed: both sides of the differential equation are filtered alike,
    /// which leaves the equation as it is. Biased by noise, the more the wider the filter.
    Svf,
    /// Refined instrumental variables (SRIVC), started from the filters: Young & Jakeman 1980, Garnier & Wang 2008.
    /// Instruments from the simulated output take the bias away; needs a start, and gives no poles where it diverges.
    Iv,
    /// Subspace methods at the full rate, and on the filtered and thinned record where its band allows.
    N4sid,
    /// ARX models at the full rate, of as many taps as poles and of four times as many, their least damped poles.
    Arx,
    /// One or two integrators beside damped poles: how acceleration, velocity and displacement of one body hang
    /// together.
    Integrators,
    /// Seeded random poles.
    Random,
    /// Given by the caller.
    Given,
}

impl Start {
    /// Name in options and records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Svf => "svf",
            Self::Iv => "iv",
            Self::N4sid => "n4sid",
            Self::Arx => "arx",
            Self::Integrators => "integrators",
            Self::Random => "random",
            Self::Given => "given",
        }
    }
}

/// The record in scaled time (0 to 1), and what is looked for.
pub(crate) struct StartProblem<'a> {
    /// The driving signal, in units of its root mean square.
    pub(crate) input: &'a [f64],
    /// The answering signal, likewise.
    pub(crate) output: &'a [f64],
    /// What the input does between samples.
    pub(crate) hold: Hold,
    /// Number of poles to start from.
    pub(crate) poles: usize,
    /// Number of numerator coefficients.
    pub(crate) numerator: usize,
    /// Whether a free motion is part of the model.
    pub(crate) free: bool,
}

impl StartProblem<'_> {
    /// Sampling interval in scaled time.
    fn dt(&self) -> f64 {
        1.0 / self.output.len() as f64
    }

    /// Poles of every starting point of one kind that looks at one input and one output, in scaled time.
    ///
    /// An empty list where the method gives none, and for those of all channels.
    pub(crate) fn poles_by(&self, start: Start, random_starts: usize) -> Vec<Vec<Complex>> {
        match start {
            Start::Svf | Start::Iv if self.poles > MOST_CONTINUOUS => Vec::new(),
            Start::Svf => self.filters().into_iter().filter_map(|f| self.filtered(f)).collect(),
            Start::Iv => {
                // From the slowest, a middle and the fastest filter: convergence is local.
                let filters = self.filters();
                [1, FILTERS / 2, FILTERS - 2]
                    .into_iter()
                    .filter_map(|i| self.refined_instruments(self.filtered(filters[i])?))
                    .collect()
            }
            Start::Integrators => self.integrators(),
            Start::Random => (0..random_starts).map(|k| self.random(k)).collect(),
            Start::N4sid | Start::Arx | Start::Given => Vec::new(),
        }
    }

    /// Break frequencies from one over the record to a third of the Nyquist frequency.
    /// In scaled time, rising, evenly spaced in the logarithm.
    fn filters(&self) -> Vec<f64> {
        let (low, high) = (2.0_f64.ln(), (PI / self.dt() / 3.0).max(4.0).ln());
        (0..FILTERS).map(|k| (low + (high - low) * k as f64 / (FILTERS - 1) as f64).exp()).collect()
    }

    /// Signals `s^i/(s+1)^order x` for i below the order, in time units of one over `lambda`, of an input or of a unit
    /// impulse.
    fn derivatives(denominator: &[f64], drive: Drive<'_>, dt: f64) -> Option<Vec<Vec<f64>>> {
        // The companion form of a denominator whose coefficients are near 1: one chain of integrators.
        let n = denominator.len() - 1;
        let a = DMatrix::from_fn(
            n,
            n,
            |i, j| {
                if i + 1 < n { f64::from(u8::from(j == i + 1)) } else { -denominator[n - j] }
            },
        );
        crate::poles::cascade::propagate(&a, n - 1, drive, dt).ok()
    }

    /// Least squares behind as many equal filters as poles; the roots of the denominator found.
    fn filtered(&self, lambda: f64) -> Option<Vec<Complex>> {
        let dt = lambda * self.dt();
        let binomial = (0..self.poles).fold(vec![1.0], |p, _| crate::poles::cascade::multiply(&p, &[1.0, 1.0]));
        let columns = self.regression(&binomial, dt)?;
        let (regressors, target) = (&columns.regressors, &columns.target);
        let width = regressors.len() + 1;
        let mut factor = TriangularFactor::new(width);
        let mut block: Vec<f64> = regressors.iter().flatten().copied().collect();
        block.extend(target);
        factor.push(target.len(), &mut block);
        let solution = factor.solve(1, 1e-13)?;
        self.roots(solution.coefficients.as_slice(), lambda)
    }

    /// Regressors of the denominator (constant term first), of the numerator, of the free motion; and the highest
    /// derivative of the output.
    fn regression(&self, denominator: &[f64], dt: f64) -> Option<Regression> {
        let n = self.poles;
        let y = Self::derivatives(denominator, Drive::Input(self.output, Hold::First), dt)?;
        let u = Self::derivatives(denominator, Drive::Input(self.input, self.hold), dt)?;
        // s^n/A y = y - sum of lower terms.
        let target = (0..self.output.len())
            .map(|k| self.output[k] - (0..n).map(|i| denominator[n - i] * y[i][k]).sum::<f64>())
            .collect();
        let mut regressors: Vec<Vec<f64>> =
            y.into_iter().take(n).map(|y| y.into_iter().map(|y| -y).collect()).collect();
        for j in 0..self.numerator {
            regressors.push(match u.get(j) {
                Some(u) => u.clone(),
                None => (0..self.input.len())
                    .map(|k| self.input[k] - (0..n).map(|i| denominator[n - i] * u[i][k]).sum::<f64>())
                    .collect(),
            });
        }
        if self.free {
            let free = Self::derivatives(denominator, Drive::Free(self.output.len()), dt)?;
            regressors.extend(free);
        }
        Some(Regression { regressors, target })
    }

    /// Poles, in scaled time, of the denominator whose coefficients (constant first) are in units of `lambda`.
    fn roots(&self, coefficients: &[f64], lambda: f64) -> Option<Vec<Complex>> {
        let mut polynomial = vec![1.0];
        polynomial.extend(coefficients[..self.poles].iter().rev());
        let roots = polynomial_roots(&polynomial).ok()?;
        Some(roots.into_iter().map(|s| s * lambda).collect())
    }

    /// SRIVC: the filter is the denominator of the step before, the instruments come from its simulated output.
    ///
    /// Solves `Z' Phi x = Z' y` with regressors `Phi` and instruments `Z` (the same regressors of the simulated
    /// output), all prefiltered by `1/A` of the step before; at most [`IV_ITERATIONS`] steps, or until no pole moves
    /// by more than 1e-6 of itself. Young & Jakeman, Int. J. Control 31(4), 1980; Garnier & Wang (ed.), 2008.
    fn refined_instruments(&self, mut poles: Vec<Complex>) -> Option<Vec<Complex>> {
        for _ in 0..IV_ITERATIONS {
            for s in &mut poles {
                // Mirrored into the left half plane: the filter must be stable.
                s.re = -s.re.abs().max(1e-3 * s.im.abs()).max(1e-3);
            }
            let lambda = poles.iter().map(|s| s.norm().max(1e-3).ln()).sum::<f64>() / poles.len() as f64;
            let lambda = lambda.exp();
            let dt = lambda * self.dt();
            let scaled: Vec<Complex> = poles.iter().map(|s| s / lambda).collect();
            let chain = SectionChain::new(sections_of(&scaled, false));
            let denominator = chain.denominator();
            let noisy = self.regression(&denominator, dt)?;
            // The output of the model with these poles and the best zeros.
            let fitted = self.simulated(&noisy, &denominator)?;
            let clean = StartProblem { output: &fitted, ..*self }.regression(&denominator, dt)?;
            let width = noisy.regressors.len();
            let norms: Vec<f64> = clean.regressors.iter().map(|z| scale(z)).collect();
            let norms_noisy: Vec<f64> = noisy.regressors.iter().map(|z| scale(z)).collect();
            let left = DMatrix::from_fn(width, width, |i, j| {
                dot(&clean.regressors[i], &noisy.regressors[j]) / (norms[i] * norms_noisy[j])
            });
            let right = DVector::from_fn(width, |i, _| dot(&clean.regressors[i], &noisy.target) / norms[i]);
            let solution = left.full_piv_lu().solve(&right)?;
            let coefficients: Vec<f64> = solution.iter().zip(&norms_noisy).map(|(x, norm)| x / norm).collect();
            if coefficients.iter().any(|x| !x.is_finite()) {
                return None;
            }
            let next = self.roots(&coefficients, lambda)?;
            let moved = next.iter().zip(&poles).map(|(a, b)| (a - b).norm() / b.norm()).fold(0.0, f64::max);
            poles = next;
            if moved < 1e-6 {
                break;
            }
        }
        Some(poles)
    }

    /// `y ~ (numerator u + free motion)/A`: the linear fit for a given denominator.
    fn simulated(&self, regression: &Regression, denominator: &[f64]) -> Option<Vec<f64>> {
        let driven = &regression.regressors[denominator.len() - 1..];
        let mut factor = TriangularFactor::new(driven.len() + 1);
        let mut block: Vec<f64> = driven.iter().flatten().copied().collect();
        block.extend(self.output);
        factor.push(self.output.len(), &mut block);
        let solution = factor.solve(1, 1e-13)?;
        let mut sum = vec![0.0; self.output.len()];
        for (column, c) in driven.iter().zip(solution.coefficients.iter()) {
            for (sum, x) in sum.iter_mut().zip(column) {
                *sum += c * x;
            }
        }
        sum.iter().all(|x| x.is_finite()).then_some(sum)
    }

    /// Poles near zero (a thousandth of one over the record), the others with a damping ratio of 0.7 at several
    /// frequencies.
    fn integrators(&self) -> Vec<Vec<Complex>> {
        let slow = Complex::new(-1e-3, 0.0);
        let mut result = Vec::new();
        for count in 1..=self.poles.min(2) {
            for w in self.filters().into_iter().skip(2) {
                let mut poles = vec![slow; count];
                for k in 0..(self.poles - count) / 2 {
                    let s = Complex::new(-0.7 * w, 0.714 * w) * (1.0 + 0.5 * k as f64);
                    poles.extend([s, s.conj()]);
                }
                if poles.len() < self.poles {
                    poles.push(Complex::new(-w, 0.0));
                }
                result.push(poles);
            }
        }
        result
    }

    /// Frequencies evenly spread in the logarithm, damping ratios from light to creeping.
    /// Number `start` of a seeded sequence: the same on every machine and for any number of threads.
    fn random(&self, start: usize) -> Vec<Complex> {
        random_poles(start, self.poles, PI / self.dt() / 5.0)
    }
}

/// Random stable poles with moduli from 1 to `fastest`.
///
/// Pairs with a modulus uniform in the logarithm and a damping ratio `2 u² + 0.01`, `u` uniform: half of them below
/// 0.51; ratios above 1 make two real poles. An odd `count` adds a real one. Scaled time.
pub(crate) fn random_poles(start: usize, count: usize, fastest: f64) -> Vec<Complex> {
    let mut poles = Vec::with_capacity(count);
    let modulus = |k: usize| (fastest.max(2.0).ln() * uniform_at(start, 3 * k)).exp();
    for k in 0..count / 2 {
        let w = modulus(k);
        let damping = 2.0 * uniform_at(start, 3 * k + 1).powi(2) + 0.01;
        if damping < 1.0 {
            let s = Complex::new(-damping * w, w * (1.0 - damping * damping).sqrt());
            poles.extend([s, s.conj()]);
        } else {
            let root = (damping * damping - 1.0).sqrt();
            poles.extend([Complex::new(-w * (damping + root), 0.0), Complex::new(-w / (damping + root), 0.0)]);
        }
    }
    if count % 2 == 1 {
        poles.push(Complex::new(-modulus(count), 0.0));
    }
    poles
}

/// Poles of every starting point of one kind that looks at all channels together, in the time of `data`; none for the
/// other kinds, and where the record is too short for a method.
///
/// The subspace methods see twice the order of samples and more, and three times it; ARX sees each output alone.
pub(crate) fn poles_of_all(start: Start, data: &IoData, poles: usize, direct: bool) -> Vec<Vec<Complex>> {
    match start {
        Start::N4sid => {
            let horizons = [SHORTEST_HORIZON.max(poles + 2), 3 * poles + 2];
            let needed = KEPT * Subspace::needed(horizons[0], data.inputs().len(), data.outputs().len());
            let thin = Some(automatic_thinning(data, needed)).filter(|every| *every > 1);
            let thin = thin.and_then(|every| thinned(data, every).ok());
            let mut found = Vec::new();
            for record in std::iter::once(data).chain(&thin) {
                for (weighting, block_rows) in Weighting::ALL.into_iter().flat_map(|w| horizons.map(|rows| (w, rows))) {
                    let options = SubspaceOptions { weighting, block_rows, direct };
                    let Ok(sampled) = Subspace::new(record, options).and_then(|s| s.poles(poles)) else { continue };
                    found.push(continuous(&sampled, poles, record.sample_time_s()));
                }
            }
            found
        }
        Start::Arx => {
            let mut found = Vec::new();
            for output in data.outputs() {
                let single = IoData::new(data.inputs().to_vec(), vec![output.clone()], data.sample_time_s());
                let Ok(single) = single else { continue };
                for taps in [poles, LONGER * poles] {
                    let (nb, nk) = (taps + usize::from(direct), usize::from(!direct));
                    let Ok(model) = arx(&single, ArxOrder { na: taps, nb, nk }) else { continue };
                    let Ok(mut sampled) = model.state_space().and_then(|model| Ok(model.poles()?)) else { continue };
                    // The least damped ones, pairs kept together.
                    sampled.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.im.abs().total_cmp(&a.im.abs())));
                    found.push(continuous(&sampled, poles, data.sample_time_s()));
                }
            }
            found
        }
        _ => Vec::new(),
    }
}

/// The leading `count` of sampled poles as continuous ones, pairs kept together. One on the negative real axis or at
/// zero, which has no counterpart, becomes as fast as the sampling shows; so does what is missing.
pub(crate) fn continuous(sampled: &[Complex], count: usize, dt: f64) -> Vec<Complex> {
    let fastest = Complex::new(-PI / dt, 0.0);
    let mut poles: Vec<Complex> = Vec::with_capacity(count);
    for &z in sampled {
        let s = if z.im == 0.0 && z.re <= 1e-9 { fastest } else { z.ln() / dt };
        if z.im > 0.0 && poles.len() + 2 <= count {
            poles.extend([s, s.conj()]);
        } else if z.im == 0.0 && poles.len() < count {
            poles.push(s);
        }
    }
    poles.resize(count, fastest);
    poles
}

/// A linear regression behind filters: one regressor per unknown coefficient, and what they should add up to.
struct Regression {
    regressors: Vec<Vec<f64>>,
    target: Vec<f64>,
}
