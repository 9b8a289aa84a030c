//! The separable problem of continuous poles: a transfer function's response, or a sum of exponentials.
//!
//! The model is `y(t) = sum over inputs of N_j(s)/A(s) u_j + F(s)/A(s) delta`: forced responses and a free motion
//! `F/A` from the state at the first sample. For given poles (the roots of `A`) it is linear in all numerators: their
//! coefficients are eliminated (variable projection) and the search is over the `n` numbers of `A` only. A sum of
//! exponentials is the free motion alone.

use crumple_numerics::estimation::minimise::variable_projection::{Basis, Separable};
use crumple_numerics::lti::Complex;
use nalgebra::DMatrix;

use crate::Hold;
use crate::poles::cascade::{Drive, Section, SectionChain, States};
use crate::poles::time_scale::{state_powers, unscaled};

/// Growth beyond `exp` of half of this over the record is not tried.
/// A pole with `Re s T = 20` grows by 5e8 from the first sample to the last: nothing of its start can be seen then.
const GROWTH: f64 = 40.0;

/// Poles of a chain, common to every input and output, against the measured signals. Time runs from 0 to 1 over the
/// record, signals are scaled.
///
/// Unknowns are `asinh` of the coefficients `p`, `q` (or `r`) of every section: logarithmic where they are large,
/// regular at zero, so that a pair may change between oscillating, creeping and growing on the way.
pub(crate) struct PoleProblem {
    /// Driving signals, if any.
    pub(crate) inputs: Vec<Vec<f64>>,
    /// What the inputs do between samples.
    pub(crate) hold: Hold,
    /// Measured signals; with `start` only one.
    pub(crate) output: Vec<Vec<f64>>,
    /// Orders of the sections.
    pub(crate) layout: Vec<usize>,
    /// Coefficients of the numerator of every input.
    pub(crate) numerator: usize,
    /// Whether the numerator has the degree of the denominator.
    pub(crate) direct: bool,
    /// Whether a free motion is part of the model.
    pub(crate) free: bool,
    /// Value and derivatives of the free motion at the start that are given, in scaled units.
    pub(crate) start: Vec<f64>,
    /// Whether poles must not grow.
    pub(crate) stable: bool,
}

impl PoleProblem {
    /// Sampling interval in scaled time.
    ///
    /// One over the number of samples: the record of `N` samples is taken to last `N dt`, as everywhere in this
    /// crate.
    pub(crate) fn dt(&self) -> f64 {
        1.0 / self.output[0].len() as f64
    }

    /// The chain of given unknowns: `q = sinh(theta_0)`, `p = sinh(theta_1)` of a section of second order,
    /// `r = sinh(theta)` of one of first order.
    pub(crate) fn chain(&self, theta: &[f64]) -> SectionChain {
        let mut at = 0;
        let sections = self
            .layout
            .iter()
            .map(|order| {
                let first = at;
                at += order;
                if *order == 2 {
                    Section::Second(theta[first + 1].sinh(), theta[first].sinh())
                } else {
                    Section::First(theta[first].sinh())
                }
            })
            .collect();
        SectionChain::new(sections)
    }

    /// Unknowns of poles given in scaled time; `None` if they do not fill the layout.
    ///
    /// The inverse of [`Self::chain`]; with `stable` the rates are taken by their magnitudes.
    pub(crate) fn unknowns(&self, sections: &[Section]) -> Option<Vec<f64>> {
        let mut seconds: Vec<(f64, f64)> = Vec::new();
        let mut firsts: Vec<f64> = Vec::new();
        for section in sections {
            match *section {
                Section::First(r) => firsts.push(r),
                Section::Second(p, q) => seconds.push((p, q)),
            }
        }
        let (mut seconds, mut firsts) = (seconds.into_iter(), firsts.into_iter());
        let mut theta = Vec::new();
        for order in &self.layout {
            if *order == 2 {
                let (p, q) = seconds.next()?;
                let p = if self.stable { p.abs() } else { p };
                theta.extend([q.asinh(), p.asinh()]);
            } else {
                let r = firsts.next()?;
                theta.push(if self.stable { r.abs() } else { r }.asinh());
            }
        }
        Some(theta)
    }

    /// Coefficients of the free motion that `start` fixes: indices, values, and derivatives by the unknowns.
    ///
    /// `y^(d)(0) = xi' A^d e_entry`; seen from the entry on, every derivative brings in one more state, so the given
    /// ones fix as many leading coefficients by a triangular system.
    fn fixed(&self, chain: &SectionChain, theta: &[f64]) -> (Vec<usize>, Vec<f64>, Vec<Vec<f64>>) {
        let count = self.start.len();
        if count == 0 {
            return (Vec::new(), Vec::new(), Vec::new());
        }
        let a = chain.matrix();
        let n = a.nrows();
        // States in the order in which the motion reaches them: velocity, then position, of section after section.
        let order: Vec<usize> = chain
            .sections()
            .iter()
            .zip(chain.offsets())
            .flat_map(|(section, at)| match section {
                Section::First(_) => vec![at],
                Section::Second(..) => vec![at + 1, at],
            })
            .take(count)
            .collect();
        let mut powers = vec![vec![0.0; n]];
        powers[0][chain.entry()] = 1.0;
        for d in 1..count {
            powers.push((&a * nalgebra::DVector::from_column_slice(&powers[d - 1])).iter().copied().collect());
        }
        // Lower triangular with ones on the diagonal.
        let solve = |right: &[f64]| {
            let mut xi = vec![0.0; count];
            for d in 0..count {
                let known: f64 = (0..d).map(|s| powers[d][order[s]] * xi[s]).sum();
                xi[d] = (right[d] - known) / powers[d][order[d]];
            }
            xi
        };
        let xi = solve(&self.start);
        let mut derivatives = Vec::with_capacity(n);
        for (k, (row, column)) in unknown_places(chain).into_iter().enumerate() {
            // dA = -cosh(theta) e_row e_column'; d(A^d e) = A d(A^(d-1) e) + dA A^(d-1) e.
            let factor = -theta[k].cosh();
            let mut change = vec![0.0; n];
            let mut right = vec![0.0; count];
            for d in 1..count {
                let mut next: Vec<f64> = (&a * nalgebra::DVector::from_column_slice(&change)).iter().copied().collect();
                next[row] += factor * powers[d - 1][column];
                change = next;
                right[d] = -(0..count).map(|s| change[order[s]] * xi[s]).sum::<f64>();
            }
            derivatives.push(solve(&right));
        }
        (order, xi, derivatives)
    }

    /// Factors from states of the free motion in time counted by samples to those in scaled time: of a numerator of
    /// degree `d` over order `n`, `N^(d-n+1)`; those of driven states have one `N` less.
    fn free_scales(&self, chain: &SectionChain) -> Vec<f64> {
        let samples = self.output[0].len() as f64;
        state_powers(chain).into_iter().map(|power| samples.powi(power + 1)).collect()
    }

    /// Signals of the motion forced by every input, and of the free one, in time counted by samples: there the entries
    /// of a discretised chain are of one size, however long the record is.
    ///
    /// First of every input one signal per state, then one per state of the free motion from the unit entry state;
    /// `None` where they leave the range of `f64`.
    fn signals(&self, chain: &SectionChain) -> Option<(Vec<States>, States)> {
        let samples = self.output[0].len();
        let chain = unscaled(chain, samples as f64);
        let forced = self
            .inputs
            .iter()
            .map(|u| chain.states(Drive::Input(u, self.hold), 1.0).ok())
            .collect::<Option<Vec<States>>>()?;
        let free = if self.free { chain.states(Drive::Free(samples), 1.0).ok()? } else { Vec::new() };
        Some((forced, free))
    }

    /// Columns of the basis that one input takes.
    pub(crate) fn columns_per_input(&self) -> usize {
        self.numerator + usize::from(self.direct)
    }

    /// Coefficients of all states in scaled time, forced by every input, then free, from those of the basis for one
    /// output.
    pub(crate) fn state_coefficients(&self, theta: &[f64], c: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let samples = self.output[0].len() as f64;
        let (mut forced, mut free) = self.sample_coefficients(theta, c);
        for (s, scale) in self.free_scales(&self.chain(theta)).into_iter().enumerate() {
            forced.iter_mut().for_each(|forced| forced[s] *= samples / scale);
            free[s] /= scale;
        }
        (forced, free)
    }

    /// The same of the states in time counted by samples.
    ///
    /// `c` is in the order of [`Separable::basis`]: of every input `numerator` states by rising degree and the direct
    /// term, then those states of the free motion that `start` does not fix.
    fn sample_coefficients(&self, theta: &[f64], c: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let chain = self.chain(theta);
        let n = chain.order();
        let mut forced = vec![vec![0.0; n]; self.inputs.len()];
        let mut at = 0;
        for forced in &mut forced {
            for &s in chain.by_degree().iter().take(self.numerator.min(n)) {
                forced[s] = c[at];
                at += 1;
            }
            at += usize::from(self.direct);
        }
        let mut free = vec![0.0; n];
        if self.free {
            let (order, xi, _) = self.fixed(&chain, theta);
            let scales = self.free_scales(&chain);
            for (s, free) in free.iter_mut().enumerate() {
                match order.iter().position(|o| *o == s) {
                    Some(fixed) => *free = xi[fixed] * scales[s],
                    None => {
                        *free = c[at];
                        at += 1;
                    }
                }
            }
        }
        (forced, free)
    }
}

/// Row and column of the state matrix where every unknown stands.
fn unknown_places(chain: &SectionChain) -> Vec<(usize, usize)> {
    chain
        .sections()
        .iter()
        .zip(chain.offsets())
        .flat_map(|(section, at)| match section {
            Section::First(_) => vec![(at, at)],
            Section::Second(..) => vec![(at + 1, at), (at + 1, at + 1)],
        })
        .collect()
}

impl Separable for PoleProblem {
    /// The scaled measured signals.
    fn targets(&self) -> &[Vec<f64>] {
        &self.output
    }

    /// Of `asinh` of the coefficients, in scaled time: a natural frequency up to the Nyquist frequency, and growth up
    /// to [`GROWTH`], or none with `stable`.
    fn bounds(&self) -> Vec<(f64, f64)> {
        // Nothing faster than the Nyquist frequency; damping ratios up to 10 there.
        let fastest = std::f64::consts::PI / self.dt();
        let low = |limit: f64| if self.stable { 0.0 } else { (-limit).asinh() };
        let first = (low(GROWTH / 2.0), (10.0 * fastest).asinh());
        let rate = (low(GROWTH), (20.0 * fastest).asinh());
        let stiffness = (low((GROWTH / 2.0).powi(2)), (fastest * fastest).asinh());
        self.layout.iter().flat_map(|order| if *order == 2 { vec![stiffness, rate] } else { vec![first] }).collect()
    }

    /// Responses to every input and of the free motion; `known` is what fixed start values contribute with
    /// coefficient 1.
    fn basis(&self, theta: &[f64]) -> Option<Basis> {
        let chain = self.chain(theta);
        let n = chain.order();
        let (mut forced, free) = self.signals(&chain)?;
        let mut columns = Vec::with_capacity(2 * n + 1);
        for (u, forced) in self.inputs.iter().zip(&mut forced) {
            for s in chain.by_degree().into_iter().take(self.numerator.min(n)) {
                columns.push(std::mem::take(&mut forced[s]));
            }
            if self.direct {
                columns.push(u.clone());
            }
        }
        let (order, xi, _) = self.fixed(&chain, theta);
        let mut known = Vec::new();
        if !order.is_empty() {
            let mut sum = vec![0.0; self.output[0].len()];
            let scales = self.free_scales(&chain);
            for (s, xi) in order.iter().zip(&xi) {
                for (sum, x) in sum.iter_mut().zip(&free[*s]) {
                    *sum += xi * scales[*s] * x;
                }
            }
            known.push(sum);
        }
        columns.extend(free.into_iter().enumerate().filter(|(s, _)| !order.contains(s)).map(|(_, x)| x));
        let finite = |signals: &[Vec<f64>]| signals.iter().all(|x| x.last().is_none_or(|x| x.is_finite()));
        (finite(&columns) && finite(&known)).then_some(Basis { columns, known })
    }

    /// Derivatives by every unknown, outputs one after the other. Exact: states of a chain twice as long, discretised
    /// at once (see [`SectionChain::sensitivities`]), times `cosh(theta)` for the `asinh` and the units of time, plus
    /// what changes with the coefficients that the start conditions fix.
    fn sensitivities(&self, theta: &[f64], coefficients: &DMatrix<f64>) -> Option<Vec<Vec<f64>>> {
        let samples = self.output[0].len();
        let scaled = self.chain(theta);
        let chain = unscaled(&scaled, samples as f64);
        let zeros = || vec![vec![0.0; samples * self.output.len()]; theta.len()];
        let mut result: States = if self.output.len() == 1 { Vec::new() } else { zeros() };
        for output in 0..self.output.len() {
            let c: Vec<f64> = coefficients.column(output).iter().copied().collect();
            let (forced, free) = self.sample_coefficients(theta, &c);
            let mut add = |signals: States| {
                if result.is_empty() {
                    // The first part of a single output needs no sum.
                    result = signals;
                    return;
                }
                for (result, signal) in result.iter_mut().zip(signals) {
                    for (result, x) in result[output * samples..].iter_mut().zip(signal) {
                        *result += x;
                    }
                }
            };
            for (u, forced) in self.inputs.iter().zip(&forced) {
                add(chain.sensitivities(forced, Drive::Input(u, self.hold), 1.0).ok()?);
            }
            if self.free {
                add(chain.sensitivities(&free, Drive::Free(samples), 1.0).ok()?);
            }
        }
        if result.is_empty() {
            // Nothing moves the model.
            result = zeros();
        }
        // By asinh of a coefficient in scaled time instead of the coefficient in time counted by samples.
        let units = self.layout.iter().flat_map(|order| if *order == 2 { &[2, 1][..] } else { &[1] });
        for ((result, theta), unit) in result.iter_mut().zip(theta).zip(units) {
            let factor = theta.cosh() * self.dt().powi(*unit);
            result.iter_mut().for_each(|x| *x *= factor);
        }
        if !self.start.is_empty() {
            let states = chain.states(Drive::Free(samples), 1.0).ok()?;
            let (order, _, derivatives) = self.fixed(&scaled, theta);
            let scales = self.free_scales(&scaled);
            for (result, change) in result.iter_mut().zip(&derivatives) {
                for (s, change) in order.iter().zip(change) {
                    for (result, x) in result.iter_mut().zip(&states[*s]) {
                        *result += change * scales[*s] * x;
                    }
                }
            }
        }
        Some(result)
    }
}

/// Poles in scaled time from those in 1/s.
pub(crate) fn scaled_poles(poles: &[Complex], duration_s: f64) -> Vec<Complex> {
    poles.iter().map(|s| s * duration_s).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::minimise::variable_projection::evaluate;

    fn check(problem: &PoleProblem, theta: &[f64]) {
        let point = evaluate(problem, theta).unwrap();
        let exact = problem.sensitivities(theta, &point.coefficients).unwrap();
        let predict = |theta: &[f64]| {
            let basis = problem.basis(theta).unwrap();
            let samples = problem.output[0].len();
            (0..samples * problem.output.len())
                .map(|k| {
                    let (output, k) = (k / samples, k % samples);
                    let sum = basis.columns.iter().enumerate().map(|(c, x)| x[k] * point.coefficients[(c, output)]);
                    basis.known.first().map_or(0.0, |known| known[k]) + sum.sum::<f64>()
                })
                .collect::<Vec<f64>>()
        };
        // The largest term of the sums: columns that nearly cancel.
        let columns = problem.basis(theta).unwrap().columns;
        let term = |j: usize| point.coefficients.row(j).amax() * columns[j].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let largest = (0..columns.len()).map(term).fold(0.0, f64::max);
        for i in 0..theta.len() {
            let moved = |sign: f64| {
                let mut theta = theta.to_vec();
                theta[i] += sign * 1e-6;
                predict(&theta)
            };
            let (up, down) = (moved(1.0), moved(-1.0));
            let size = exact[i].iter().fold(0.0_f64, |m, x| m.max(x.abs())).max(1.0);
            for k in 0..up.len() {
                let numeric = (up[k] - down[k]) / 2e-6;
                // Central differences: the step's square, and rounding of some ten terms over the step, 1e-9 of each.
                assert!(
                    (numeric - exact[i][k]).abs() < 1e-6 * size + 1e-9 * largest,
                    "{i} {k}: {numeric} {}",
                    exact[i][k]
                );
            }
        }
    }

    fn problem() -> PoleProblem {
        let signal = |f: f64| (0..80).map(|k| (f64::from(k) * f).sin() + 0.3).collect::<Vec<f64>>();
        PoleProblem {
            inputs: vec![signal(0.11)],
            hold: Hold::First,
            output: vec![signal(0.23)],
            layout: vec![2, 2, 1],
            numerator: 3,
            direct: false,
            free: true,
            start: Vec::new(),
            stable: false,
        }
    }

    #[test]
    fn sensitivities_are_the_derivatives_for_all_kinds_of_models() {
        let theta = [3.0, 1.0, 5.0, 2.0, 1.5];
        check(&problem(), &theta);
        check(&PoleProblem { hold: Hold::Zero, direct: true, numerator: 5, ..problem() }, &theta);
        check(&PoleProblem { free: false, ..problem() }, &theta);
        let several =
            |k: usize| (0..k).map(|k| problem().output[0].iter().map(|y| y * (k as f64 + 0.5) - 0.2 * y * y).collect());
        check(&PoleProblem { inputs: several(2).collect(), direct: true, ..problem() }, &theta);
        check(&PoleProblem { inputs: several(2).collect(), output: several(3).collect(), ..problem() }, &theta);
        // Coinciding pairs, and one that grows.
        check(&problem(), &[3.0, 1.0, 3.0, 1.0, -0.5]);
        for start in [vec![0.5], vec![0.0, 2.0], vec![0.1, 2.0, -3.0]] {
            check(&PoleProblem { inputs: Vec::new(), start: start.clone(), ..problem() }, &theta);
            check(&PoleProblem { inputs: Vec::new(), start, layout: vec![1; 5], ..problem() }, &theta);
        }
    }
}
