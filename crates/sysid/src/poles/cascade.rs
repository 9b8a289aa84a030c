//! Continuous-time sections of first and second order in cascade: poles that may coincide, and signals through them.
//!
//! A transfer function of order `n` in one polynomial loses its poles to rounding: coefficients of a record at a high
//! sampling rate range over `n` powers of the rate, and a relative error of 1e-16 in one moves close poles by its
//! `1/m`-th power, `m` of them together. In cascade every section keeps its own two numbers, and errors stay with
//! their section.

use crumple_numerics::lti::{Complex, LtiError, StateSpace, discretize_first_order_hold, discretize_zero_order_hold};
use nalgebra::DMatrix;

use crate::Hold;

/// Denominators `s² + p s + q` and `s + r` in cascade, the first driven by the input.
///
/// States: of a second-order section its output and that one's derivative, of a first-order one its output. Every
/// strictly proper numerator is a sum of states, and poles may coincide: nothing is divided by their difference.
///
/// State matrix, for sections of second order: companion blocks `[0 1; -q -p]` on the diagonal, and a 1 from the
/// output of every section to the last state of the next.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SectionChain {
    sections: Vec<Section>,
}

/// One denominator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Section {
    /// `s + r`.
    /// Its pole is `-r`.
    First(f64),
    /// `s² + p s + q`.
    /// Its poles are `-p/2 ± sqrt(p²/4 - q)`: a conjugate pair, or two real ones.
    Second(f64, f64),
}

impl Section {
    fn order(self) -> usize {
        match self {
            Self::First(_) => 1,
            Self::Second(..) => 2,
        }
    }

    /// Coefficients, highest power first.
    fn polynomial(self) -> Vec<f64> {
        match self {
            Self::First(r) => vec![1.0, r],
            Self::Second(p, q) => vec![1.0, p, q],
        }
    }
}

/// Signals of a chain: one per state.
pub(crate) type States = Vec<Vec<f64>>;

impl SectionChain {
    pub(crate) fn new(sections: Vec<Section>) -> Self {
        Self { sections }
    }

    pub(crate) fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Number of states, which is that of the poles.
    pub(crate) fn order(&self) -> usize {
        self.sections.iter().map(|s| s.order()).sum()
    }

    /// Index of the state that the input drives.
    pub(crate) fn entry(&self) -> usize {
        self.sections.first().map_or(0, |s| s.order() - 1)
    }

    /// First state of every section.
    pub(crate) fn offsets(&self) -> Vec<usize> {
        self.sections
            .iter()
            .scan(0, |at, section| {
                let offset = *at;
                *at += section.order();
                Some(offset)
            })
            .collect()
    }

    /// State matrix.
    /// `A` of `x' = A x + e_entry u`, block lower triangular.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        let n = self.order();
        let mut a = DMatrix::zeros(n, n);
        let offsets = self.offsets();
        for (index, (section, &at)) in self.sections.iter().zip(&offsets).enumerate() {
            fill_section(&mut a, at, *section);
            if index > 0 {
                a[(at + section.order() - 1, offsets[index - 1])] = 1.0;
            }
        }
        a
    }

    /// Poles, section after section.
    pub(crate) fn poles(&self) -> Vec<Complex> {
        self.sections.iter().flat_map(|section| section_poles(*section)).collect()
    }

    /// Numerator of every state over the common denominator, highest power first, each as long as the order: the
    /// product of the sections behind it, times s for a derivative.
    /// With `D` the common denominator, `X_s/U = N_s/D`; for `D` of degree `n` every `N_s` is of degree below `n`,
    /// and together they span those polynomials, so that any strictly proper transfer function is a sum of states.
    pub(crate) fn state_numerators(&self) -> Vec<Vec<f64>> {
        let n = self.order();
        let mut result = vec![Vec::new(); n];
        let mut behind = vec![1.0];
        for (section, at) in self.sections.iter().zip(self.offsets()).rev() {
            result[at] = padded(&behind, n);
            if section.order() == 2 {
                let mut derivative = behind.clone();
                derivative.push(0.0);
                result[at + 1] = padded(&derivative, n);
            }
            behind = multiply(&behind, &section.polynomial());
        }
        result
    }

    /// The common denominator, highest power first.
    pub(crate) fn denominator(&self) -> Vec<f64> {
        self.sections.iter().fold(vec![1.0], |product, section| multiply(&product, &section.polynomial()))
    }

    /// The states from the lowest degree of their numerator up: the first `count` span all numerators of degree below
    /// `count`.
    pub(crate) fn by_degree(&self) -> Vec<usize> {
        let mut result = Vec::with_capacity(self.order());
        for (section, at) in self.sections.iter().zip(self.offsets()).rev() {
            result.extend(at..at + section.order());
        }
        result
    }

    /// All states, driven by `input` from rest, exact for the hold; or the free motion from the unit entry state.
    /// One signal per state, as long as the input. Exact means: the sampled response of the continuous chain to the
    /// input as the hold continues it, with no error of the order of the interval.
    pub(crate) fn states(&self, drive: Drive<'_>, dt: f64) -> Result<States, LtiError> {
        propagate(&self.matrix(), self.entry(), drive, dt)
    }

    /// Derivatives of `sum c_s x_s` by the coefficients of every section, `(by p, by q)` or `(by r)` at the indices of
    /// the section's states `(first: q or r, second: p)`.
    ///
    /// The derivative by `p` is `-(s/A_j) f`, by `q` it is `-(1/A_j) f`, `f` the part of the sum that runs through
    /// section j. All are states of one larger chain, discretised exactly at once.
    pub(crate) fn sensitivities(&self, c: &[f64], drive: Drive<'_>, dt: f64) -> Result<States, LtiError> {
        let n = self.order();
        // The result is linear in the coefficients: at most 1, they do not upset the matrix exponential.
        let largest = c.iter().fold(0.0_f64, |m, c| m.max(c.abs())).max(f64::MIN_POSITIVE);
        let mut big = DMatrix::zeros(2 * n, 2 * n);
        big.view_mut((0, 0), (n, n)).copy_from(&self.matrix());
        for (section, at) in self.sections.iter().zip(self.offsets()) {
            fill_section(&mut big, n + at, *section);
            let driven = n + at + section.order() - 1;
            for s in at..n {
                big[(driven, s)] = -c[s] / largest;
            }
        }
        let mut states = propagate(&big, self.entry(), drive, dt)?;
        let mut result = states.split_off(n);
        result.iter_mut().flatten().for_each(|x| *x *= largest);
        Ok(result)
    }
}

/// What sets a chain in motion.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Drive<'a> {
    /// An input from rest.
    /// One value a sample, in scaled units, held or joined by straight lines.
    Input(&'a [f64], Hold),
    /// The entry state is 1 at first, then nothing: this number of samples.
    Free(usize),
}

/// States of `x' = a x + e_entry u`, one signal each. Zeros of `a` are skipped where a chain has them: nothing acts
/// backwards.
///
/// `x[k+1] = Ad x[k] + now u[k] + next u[k+1]` with `Ad = exp(A dt)`; after the last sample the input is taken for
/// zero, which no returned sample sees. Errors: a matrix exponential beyond the range of `f64`.
pub(crate) fn propagate(a: &DMatrix<f64>, entry: usize, drive: Drive<'_>, dt: f64) -> Result<States, LtiError> {
    let n = a.nrows();
    let unit = DMatrix::from_fn(n, 1, |i, _| if i == entry { 1.0 } else { 0.0 });
    let model = StateSpace::new(a.clone(), unit, DMatrix::zeros(1, n), DMatrix::zeros(1, 1), None)?;
    let (ad, now, next) = match drive {
        Drive::Input(_, Hold::First) => {
            let d = discretize_first_order_hold(&model, dt)?;
            (d.a, d.b_now, d.b_next)
        }
        Drive::Input(_, Hold::Zero) => {
            let d = discretize_zero_order_hold(&model, dt)?;
            (d.a, d.b, DMatrix::zeros(n, 1))
        }
        Drive::Free(_) => {
            (crumple_numerics::lti::matrix_exponential(&(a * dt))?, DMatrix::zeros(n, 1), DMatrix::zeros(n, 1))
        }
    };
    let mut x = vec![0.0; n];
    let (input, samples) = match drive {
        Drive::Input(input, _) => (Some(input), input.len()),
        Drive::Free(samples) => {
            x[entry] = 1.0;
            (None, samples)
        }
    };
    Ok(match n {
        2 => recur::<2>(&ad, &now, &next, input, &x, samples),
        4 => recur::<4>(&ad, &now, &next, input, &x, samples),
        6 => recur::<6>(&ad, &now, &next, input, &x, samples),
        8 => recur::<8>(&ad, &now, &next, input, &x, samples),
        _ => recur_any(&ad, &now, &next, input, &x, samples),
    })
}

/// The recursion with its size known to the compiler, columns of the matrix in vector registers.
///
/// The same arithmetic as [`recur_any`] but for the order of the sums: two partial sums of even and odd columns, and
/// for a chain whose first half does not see the second, half of the products.
fn recur<const N: usize>(
    ad: &DMatrix<f64>,
    now: &DMatrix<f64>,
    next: &DMatrix<f64>,
    input: Option<&[f64]>,
    start: &[f64],
    samples: usize,
) -> States {
    let column = |m: &DMatrix<f64>, j: usize| std::array::from_fn::<f64, N, _>(|i| m[(i, j)]);
    let columns: [[f64; N]; N] = std::array::from_fn(|j| column(ad, j));
    let (now, next) = (column(now, 0), column(next, 0));
    let mut x: [f64; N] = std::array::from_fn(|i| start[i]);
    let mut states = vec![Vec::with_capacity(samples); N];
    // Later sections do not act on earlier ones: their half of the matrix above the diagonal is zero.
    let half = if N.is_multiple_of(4) { N / 2 } else { 0 };
    let one_way = half > 0 && columns[half..].iter().all(|column| column[..half].iter().all(|x| *x == 0.0));
    // Kept together for some steps, then dealt out: the state stays in registers meanwhile.
    let mut steps = [[0.0; N]; 64];
    for start in (0..samples).step_by(steps.len()) {
        let count = steps.len().min(samples - start);
        for (k, step) in (start..).zip(&mut steps[..count]) {
            *step = x;
            let (u0, u1) = input.map_or((0.0, 0.0), |u| (u[k], u.get(k + 1).copied().unwrap_or(0.0)));
            // Two sums that do not wait for each other.
            let mut even: [f64; N] = std::array::from_fn(|i| now[i] * u0 + next[i] * u1);
            let mut odd = [0.0; N];
            let first = if one_way { half } else { N };
            for (column, x) in columns[..first].chunks_exact(2).zip(x.chunks_exact(2)) {
                for i in 0..N {
                    even[i] += column[0][i] * x[0];
                    odd[i] += column[1][i] * x[1];
                }
            }
            if one_way {
                for (column, x) in columns[half..].chunks_exact(2).zip(x[half..].chunks_exact(2)) {
                    for i in N / 2..N {
                        even[i] += column[0][i] * x[0];
                        odd[i] += column[1][i] * x[1];
                    }
                }
            }
            x = std::array::from_fn(|i| even[i] + odd[i]);
        }
        for (i, state) in states.iter_mut().enumerate() {
            state.extend(steps[..count].iter().map(|step| step[i]));
        }
    }
    states
}

/// The same for any size.
fn recur_any(
    ad: &DMatrix<f64>,
    now: &DMatrix<f64>,
    next: &DMatrix<f64>,
    input: Option<&[f64]>,
    start: &[f64],
    samples: usize,
) -> States {
    let n = ad.nrows();
    let mut x = start.to_vec();
    let mut sum = vec![0.0; n];
    let mut states = vec![Vec::with_capacity(samples); n];
    for k in 0..samples {
        for (state, x) in states.iter_mut().zip(&x) {
            state.push(*x);
        }
        let (u0, u1) = input.map_or((0.0, 0.0), |u| (u[k], u.get(k + 1).copied().unwrap_or(0.0)));
        for i in 0..n {
            sum[i] = now[i] * u0 + next[i] * u1;
        }
        for (column, x) in ad.as_slice().chunks_exact(n.max(1)).zip(&x) {
            for (sum, a) in sum.iter_mut().zip(column) {
                *sum += a * x;
            }
        }
        std::mem::swap(&mut x, &mut sum);
    }
    states
}

/// Writes the companion block of a section at row and column `at`.
fn fill_section(a: &mut DMatrix<f64>, at: usize, section: Section) {
    match section {
        Section::First(r) => a[(at, at)] = -r,
        Section::Second(p, q) => {
            a[(at, at + 1)] = 1.0;
            a[(at + 1, at)] = -q;
            a[(at + 1, at + 1)] = -p;
        }
    }
}

/// Roots of one denominator; for real ones the larger by the formula and the other by `q` over it, so that neither
/// loses digits in a difference.
fn section_poles(section: Section) -> Vec<Complex> {
    match section {
        Section::First(r) => vec![Complex::new(-r, 0.0)],
        Section::Second(p, q) => {
            let discriminant = p * p / 4.0 - q;
            if discriminant < 0.0 {
                let im = (-discriminant).sqrt();
                vec![Complex::new(-p / 2.0, im), Complex::new(-p / 2.0, -im)]
            } else {
                // Without cancellation.
                let large = -(p / 2.0 + discriminant.sqrt().copysign(p));
                let small = if large == 0.0 { 0.0 } else { q / large };
                vec![Complex::new(large, 0.0), Complex::new(small, 0.0)]
            }
        }
    }
}

/// Product of polynomials, highest power first.
pub(crate) fn multiply(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// The polynomial with zeros for the powers above its degree, `length` coefficients.
fn padded(polynomial: &[f64], length: usize) -> Vec<f64> {
    let mut result = vec![0.0; length - polynomial.len()];
    result.extend(polynomial);
    result
}

/// Sections of a set of poles, conjugates once: pairs as they are, real ones two by two (the fastest with the slowest,
/// a last one alone), or all alone.
///
/// Real poles are paired fastest with slowest so that the sections can turn into oscillations of any frequency while
/// they are fitted; `real_alone` is for sums of real exponentials, where they must not.
pub(crate) fn sections_of(poles: &[Complex], real_alone: bool) -> Vec<Section> {
    let mut result: Vec<Section> =
        poles.iter().filter(|s| s.im > 0.0).map(|s| Section::Second(-2.0 * s.re, s.norm_sqr())).collect();
    let mut real: Vec<f64> = poles.iter().filter(|s| s.im == 0.0).map(|s| s.re).collect();
    real.sort_by(f64::total_cmp);
    if real_alone {
        result.extend(real.into_iter().map(|s| Section::First(-s)));
        return result;
    }
    while real.len() >= 2 {
        let (fast, slow) = (real.remove(0), real.pop().unwrap_or(0.0));
        result.push(Section::Second(-(fast + slow), fast * slow));
    }
    result.extend(real.into_iter().map(|s| Section::First(-s)));
    result
}
