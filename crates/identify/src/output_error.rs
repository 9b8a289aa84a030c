//! Output-error models in discrete time: the poles that simulate a record best.

use crumple_lti::{Complex, StateSpace};
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::balanced_truncation::balanced_truncation;
use crate::random::uniform;
use crate::separable::{Basis, Separable, SeparableFit, Stop, Termination, evaluate, minimize};
use crate::transfer_starts::{Start, StartProblem};
use crate::{ArxOrder, Hold, IdentifyError, InformationCriteria, IoData, Subspace, SubspaceOptions, Weighting, arx};

/// Poles are kept inside a circle of radius `tanh` of this: 1 - 4e-9.
const EDGE: f64 = 10.0;

/// Starting points that are refined, of all that were tried.
const REFINED: usize = 6;

/// Continuous transfer functions are starts up to this order: above, their coefficients have lost the digits.
const MOST_CONTINUOUS: usize = 10;

/// Settings of [`output_error`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputErrorOptions {
    /// Number of poles.
    pub order: usize,
    /// Whether outputs may follow an input within the same sample.
    pub direct: bool,
    /// Samples by which every input acts late.
    pub delay: usize,
    /// Random starting points in addition to those from ARX and subspace models.
    pub random_starts: usize,
    /// When to stop.
    pub stop: Stop,
}

impl OutputErrorOptions {
    /// Of an order, with a direct term, without delay, 8 random starts.
    pub fn new(order: usize) -> Self {
        Self { order, direct: true, delay: 0, random_starts: 8, stop: Stop::default() }
    }
}

/// A model whose simulation fits best.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputError {
    /// Sampled model; the delay is not part of it.
    pub model: StateSpace,
    /// Samples by which inputs act late.
    pub delay: usize,
    /// Mean square of the simulation error, of all outputs each divided by its root mean square.
    pub loss: f64,
    /// Information criteria of that loss.
    pub criteria: InformationCriteria,
    /// Iterations of the best start.
    pub iterations: usize,
    /// Evaluations of all starts.
    pub evaluations: usize,
    /// Why the best start stopped.
    pub termination: Termination,
    /// Loss of every refined start, best first: how alone the best one is.
    pub losses: Vec<f64>,
}

/// Finds the stable model of given order whose simulated output, from a free initial state, is nearest to the measured
/// one, for data with one input or one output.
///
/// Poles are unknowns of a bounded Levenberg-Marquardt, everything else is linear and projected out. The poles stand
/// in second-order sections in cascade, each with reflection coefficients `tanh` of its two unknowns, so that every
/// model on the way is stable and coinciding poles are ordinary points. Starts: ARX of the order and of four times as
/// many taps, by its least damped poles and by balanced truncation, the three subspace methods, continuous transfer
/// functions by refined instrumental variables and by a subspace method on a thinned record, and seeded random poles;
/// the best six are refined in parallel.
///
/// A local method: it is as good as its best start. With one output and several inputs, or one input and several
/// outputs, the model has exactly `order` states; data with several of both are refused, for there common poles do not
/// make a model of that order.
pub fn output_error(data: &IoData, options: OutputErrorOptions) -> Result<OutputError, IdentifyError> {
    let problem = CascadeFilter::new(data, options)?;
    let candidates = starts(data, options);
    let tried = candidates.len();
    let mut scored: Vec<(f64, Vec<f64>)> =
        candidates.into_par_iter().filter_map(|theta| Some((evaluate(&problem, &theta)?.cost, theta))).collect();
    // Stable sort: equal losses keep the order of the starts.
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    scored.truncate(REFINED);
    let mut fits: Vec<SeparableFit> =
        scored.par_iter().filter_map(|(_, theta)| minimize(&problem, theta, options.stop)).collect();
    fits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let evaluations = tried + fits.iter().map(|fit| fit.evaluations).sum::<usize>();
    let count = (data.samples() * data.outputs().len()) as f64;
    let losses = fits.iter().map(|fit| fit.cost / count).collect();
    let Some(best) = fits.into_iter().next() else {
        return Err(IdentifyError::NoStart { method: "output error", starts: tried });
    };
    let loss = best.cost / count;
    let parameters = best.theta.len() + best.coefficients.len();
    Ok(OutputError {
        model: problem.state_space(&best)?,
        delay: options.delay,
        loss,
        criteria: InformationCriteria::new(loss, count, parameters),
        iterations: best.iterations,
        evaluations,
        termination: best.termination,
        losses,
    })
}

/// Poles of candidate models, as unknowns.
fn starts(data: &IoData, options: OutputErrorOptions) -> Vec<Vec<f64>> {
    let n = options.order;
    let first_tap = options.delay + usize::from(!options.direct);
    let mut poles: Vec<Vec<Complex>> = Vec::new();
    // Of several outputs each alone; they share the poles.
    for output in data.outputs() {
        let Ok(single) = IoData::new(data.inputs().to_vec(), vec![output.clone()], data.sample_time_s()) else {
            continue;
        };
        for taps in [n, 4 * n] {
            let order = ArxOrder { na: taps, nb: taps + usize::from(options.direct), nk: first_tap };
            let Ok(model) = arx(&single, order).and_then(|model| model.state_space()) else { continue };
            let Ok(mut found) = model.poles() else { continue };
            // What matters most of many taps: the start for a poor signal-to-noise ratio.
            poles.extend(balanced_truncation(&model, n).and_then(|(reduced, _)| reduced.poles().ok()));
            // The least damped ones, pairs kept together; poles at zero are those of the delay.
            found.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.im.abs().total_cmp(&a.im.abs())));
            poles.push(found);
        }
    }
    for weighting in Weighting::ALL {
        for block_rows in [(n + 2).max(10), 3 * n + 2] {
            let options = SubspaceOptions { weighting, block_rows, direct: options.direct };
            let Ok(found) = Subspace::new(data, options).and_then(|s| s.realize(n)) else { continue };
            poles.extend(found.model.poles());
        }
    }
    poles.extend(continuous_starts(data, options));
    let mut starts: Vec<Vec<f64>> = poles.iter().map(|poles| unknowns(poles, n)).collect();
    for start in 0..options.random_starts {
        let random: Vec<Complex> = (0..n.div_ceil(2))
            .flat_map(|k| {
                let (radius, angle) = (uniform(start, 2 * k), uniform(start, 2 * k + 1));
                let z = Complex::from_polar(0.7 + 0.299 * radius, std::f64::consts::PI * angle);
                [z, z.conj()]
            })
            .collect();
        starts.push(unknowns(&random, n));
    }
    starts
}

/// Sampled poles of continuous transfer functions between every input and output, by refined instrumental variables
/// behind filters of several bandwidths: a regression over one step sees little but noise where poles crowd at 1. None
/// above [`MOST_CONTINUOUS`].
fn continuous_starts(data: &IoData, options: OutputErrorOptions) -> Vec<Vec<Complex>> {
    if options.order > MOST_CONTINUOUS {
        return Vec::new();
    }
    let late = data.delayed(options.delay);
    let pairs: Vec<(&Vec<f64>, &Vec<f64>)> =
        late.inputs().iter().flat_map(|u| late.outputs().iter().map(move |y| (u, y))).collect();
    pairs
        .into_par_iter()
        .flat_map_iter(|(input, output)| {
            let problem = StartProblem {
                input,
                output,
                hold: Hold::First,
                poles: options.order,
                numerator: options.order + usize::from(options.direct),
                free: true,
            };
            let dt = 1.0 / output.len() as f64;
            let sampled = move |poles: Vec<Complex>| poles.into_iter().map(|s| (s * dt).exp()).collect::<Vec<_>>();
            let kinds = [Start::Iv, Start::N4sid];
            kinds.into_iter().flat_map(|start| problem.poles_by(start, 0)).map(sampled).collect::<Vec<_>>()
        })
        .collect()
}

/// The leading `n` poles as unknowns of [`CascadeFilter`]: pairs first, real ones two by two, at most one alone.
fn unknowns(poles: &[Complex], n: usize) -> Vec<f64> {
    let inside = |z: Complex| {
        let radius = z.norm();
        if radius >= 1.0 { z / (radius * radius) * 0.999 } else { z }
    };
    let poles: Vec<Complex> = poles.iter().map(|z| inside(*z)).collect();
    let mut theta = Vec::with_capacity(n);
    let mut real: Vec<f64> = Vec::new();
    let mut taken = 0;
    for z in &poles {
        if z.im > 0.0 && taken + 2 <= n {
            theta.extend(reflection(-2.0 * z.re, z.norm_sqr()));
            taken += 2;
        } else if z.im == 0.0 && taken < n {
            real.push(z.re);
            taken += 1;
        }
    }
    while taken < n {
        real.push(0.5);
        taken += 1;
    }
    for pair in real.chunks(2) {
        match *pair {
            [a, b] => theta.extend(reflection(-(a + b), a * b)),
            [a] => theta.push((-a).clamp(-1.0 + 1e-9, 1.0 - 1e-9).atanh()),
            _ => {}
        }
    }
    theta
}

/// `z² + a1 z + a0` with both roots inside the unit circle, as two unknowns.
fn reflection(a1: f64, a0: f64) -> [f64; 2] {
    let cut = |x: f64| x.clamp(-1.0 + 1e-9, 1.0 - 1e-9).atanh();
    [cut(a1 / (1.0 + a0)), cut(a0)]
}

/// Coefficients and their derivatives by the unknowns.
struct Section {
    /// `a0`, and `a1` unless the section is of first order.
    a: [f64; 2],
    second_order: bool,
    /// `da[i]/dtheta[k]`.
    derivative: [[f64; 2]; 2],
}

/// `y = sum over inputs and sections of coefficients times (1, z)/(A1 ... Ai) u`, plus free responses.
struct CascadeFilter {
    inputs: Vec<Vec<f64>>,
    outputs: Vec<Vec<f64>>,
    input_scales: Vec<f64>,
    output_scales: Vec<f64>,
    sample_time_s: f64,
    order: usize,
    direct: bool,
}

impl CascadeFilter {
    fn new(data: &IoData, options: OutputErrorOptions) -> Result<Self, IdentifyError> {
        let (m, q) = (data.inputs().len(), data.outputs().len());
        let n = options.order;
        if n == 0 {
            return Err(IdentifyError::OrderZero);
        }
        if m == 0 || (m > 1 && q > 1) {
            return Err(IdentifyError::Channels {
                method: "output error",
                needed: "one input or one output",
                inputs: m,
                outputs: q,
            });
        }
        let needed = options.delay + (m + 2) * n + m + 1;
        if data.samples() < needed {
            return Err(IdentifyError::TooShort {
                method: "output error",
                samples: data.samples(),
                needed,
                why: format!("{} parameters of order {n}", (m + 2) * n + m),
            });
        }
        let (input_scales, output_scales) = (data.input_scales(), data.output_scales());
        let scaled = |signals: &[Vec<f64>], scales: &[f64], delay: usize| -> Vec<Vec<f64>> {
            let shifted = |s: &Vec<f64>, scale: f64| {
                let zeros = std::iter::repeat_n(0.0, delay);
                zeros.chain(s[..s.len() - delay].iter().map(|x| x / scale)).collect()
            };
            signals.iter().zip(scales).map(|(s, scale)| shifted(s, *scale)).collect()
        };
        Ok(Self {
            inputs: scaled(data.inputs(), &input_scales, options.delay),
            outputs: scaled(data.outputs(), &output_scales, 0),
            input_scales,
            output_scales,
            sample_time_s: data.sample_time_s(),
            order: n,
            direct: options.direct,
        })
    }

    fn sections(theta: &[f64]) -> Vec<Section> {
        theta
            .chunks(2)
            .map(|unknowns| match *unknowns {
                [x1, x0] => {
                    let (k1, k0) = (x1.tanh(), x0.tanh());
                    let (d1, d0) = (1.0 - k1 * k1, 1.0 - k0 * k0);
                    Section {
                        a: [k0, k1 * (1.0 + k0)],
                        second_order: true,
                        derivative: [[0.0, d0], [d1 * (1.0 + k0), k1 * d0]],
                    }
                }
                _ => {
                    let k = unknowns[0].tanh();
                    Section { a: [k, 0.0], second_order: false, derivative: [[1.0 - k * k, 0.0], [0.0, 0.0]] }
                }
            })
            .collect()
    }

    /// `1/A u` and, for second order, `z/A u`, from the section's state `first`, `second` at sample 0.
    fn filter(
        section: &Section,
        input: Option<&[f64]>,
        mut first: f64,
        mut second: f64,
        samples: usize,
    ) -> [Vec<f64>; 2] {
        let [a0, a1] = section.a;
        let mut now = Vec::with_capacity(samples);
        let mut ahead = Vec::new();
        if section.second_order {
            ahead.reserve(samples);
            for k in 0..samples {
                now.push(first);
                ahead.push(second);
                let u = input.map_or(0.0, |u| u[k]);
                (first, second) = (second, u - a0 * first - a1 * second);
            }
        } else {
            for k in 0..samples {
                now.push(first);
                first = input.map_or(0.0, |u| u[k]) - a0 * first;
            }
        }
        [now, ahead]
    }

    /// All chain states driven by `input` from rest, or by a unit impulse at sample -1.
    fn chain(sections: &[Section], input: Option<&[f64]>, samples: usize) -> Vec<Vec<f64>> {
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(2 * sections.len());
        let mut previous: Option<Vec<f64>> = None;
        for section in sections {
            let start = if previous.is_none() && input.is_none() { 1.0 } else { 0.0 };
            let (first, second) = if section.second_order { (0.0, start) } else { (start, 0.0) };
            let [now, ahead] = Self::filter(section, previous.as_deref().or(input), first, second, samples);
            previous = Some(now.clone());
            columns.push(now);
            if section.second_order {
                columns.push(ahead);
            }
        }
        columns
    }

    /// The model of a fit, in units of the data.
    fn state_space(&self, fit: &SeparableFit) -> Result<StateSpace, IdentifyError> {
        let sections = Self::sections(&fit.theta);
        let n = self.order;
        let (m, q) = (self.inputs.len(), self.outputs.len());
        let mut a = DMatrix::zeros(n, n);
        let mut at = 0;
        for (index, section) in sections.iter().enumerate() {
            let last = at + usize::from(section.second_order);
            a[(last, at)] = -section.a[0];
            if section.second_order {
                a[(at, last)] = 1.0;
                a[(last, last)] = -section.a[1];
            }
            if index > 0 {
                let before = at - if sections[index - 1].second_order { 2 } else { 1 };
                a[(last, before)] = 1.0;
            }
            at = last + 1;
        }
        let entry = usize::from(sections[0].second_order);
        let per_input = n + usize::from(self.direct);
        let c = |j: usize, s: usize, i: usize| {
            fit.coefficients[(j * per_input + s, i)] * self.output_scales[i] / self.input_scales[j]
        };
        let d = DMatrix::from_fn(q, m, |i, j| if self.direct { c(j, n, i) } else { 0.0 });
        let unit = |k: usize| if k == entry { 1.0 } else { 0.0 };
        let (a, b, c) = if m == 1 {
            (a, DMatrix::from_fn(n, 1, |s, _| unit(s)), DMatrix::from_fn(q, n, |i, s| c(0, s, i)))
        } else {
            (a.transpose(), DMatrix::from_fn(n, m, |s, j| c(j, s, 0)), DMatrix::from_fn(1, n, |_, s| unit(s)))
        };
        Ok(StateSpace::new(a, b, c, d, Some(self.sample_time_s))?)
    }
}

impl Separable for CascadeFilter {
    fn targets(&self) -> &[Vec<f64>] {
        &self.outputs
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(-EDGE, EDGE); self.order]
    }

    fn basis(&self, theta: &[f64]) -> Option<Basis> {
        let sections = Self::sections(theta);
        let samples = self.outputs[0].len();
        let mut columns = Vec::new();
        for input in &self.inputs {
            columns.extend(Self::chain(&sections, Some(input), samples));
            if self.direct {
                columns.push(input.clone());
            }
        }
        columns.extend(Self::chain(&sections, None, samples));
        Some(Basis { columns, known: Vec::new() })
    }

    fn sensitivities(&self, theta: &[f64], coefficients: &DMatrix<f64>) -> Option<Vec<Vec<f64>>> {
        let sections = Self::sections(theta);
        let columns = self.basis(theta)?.columns;
        let samples = self.outputs[0].len();
        let n = self.order;
        let per_input = n + usize::from(self.direct);
        let mut result = vec![Vec::with_capacity(samples * self.outputs.len()); n];
        for output in 0..self.outputs.len() {
            // Sum of all terms that contain section i, from the last section to the first.
            let mut sum = vec![0.0; samples];
            let mut at = n;
            for section in sections.iter().rev() {
                let width = if section.second_order { 2 } else { 1 };
                at -= width;
                for s in at..at + width {
                    for group in 0..=self.inputs.len() {
                        let column = group * per_input + s;
                        let c = coefficients[(column, output)];
                        for (sum, x) in sum.iter_mut().zip(&columns[column]) {
                            *sum += c * x;
                        }
                    }
                }
                // d/da0 = -(1/A) sum, d/da1 = -(z/A) sum.
                let [now, ahead] = Self::filter(section, Some(&sum), 0.0, 0.0, samples);
                for k in 0..width {
                    let [d0, d1] = [section.derivative[0][k], section.derivative[1][k]];
                    if width == 2 {
                        result[at + k].extend(now.iter().zip(&ahead).map(|(x0, x1)| -d0 * x0 - d1 * x1));
                    } else {
                        result[at + k].extend(now.iter().map(|x0| -d0 * x0));
                    }
                }
            }
        }
        Some(result)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_lti::simulate;

    fn data(m: usize, q: usize, delay: usize) -> (IoData, Vec<Complex>) {
        // Poles 0.9 +- 0.3i and 0.5, with every coupling different.
        let a = nalgebra::dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.1; 0.0, 0.0, 0.5];
        let b = DMatrix::from_fn(3, m, |i, j| 1.0 + 0.3 * i as f64 - 0.8 * j as f64);
        let c = DMatrix::from_fn(q, 3, |i, j| 1.0 - 0.4 * j as f64 + 0.7 * i as f64);
        let d = DMatrix::from_fn(q, m, |i, j| 0.2 + 0.1 * (i + j) as f64);
        let model = StateSpace::new(a, b, c, d, Some(0.01)).unwrap();
        let u: Vec<Vec<f64>> = (0..m).map(|j| (0..300).map(|k| uniform(j + 40, k) - 0.5).collect()).collect();
        let late: Vec<Vec<f64>> = u
            .iter()
            .map(|u| std::iter::repeat_n(0.0, delay).chain(u[..300 - delay].iter().copied()).collect())
            .collect();
        let y = simulate(&model, &late, &[1.0, -2.0, 0.5]).unwrap();
        (IoData::new(u, y, 0.01).unwrap(), model.poles().unwrap())
    }

    #[test]
    fn poles_come_back_for_one_input_or_one_output_with_delay_and_motion_at_the_start() {
        for (m, q, delay) in [(1, 1, 0), (2, 1, 3), (1, 3, 0)] {
            let (data, poles) = data(m, q, delay);
            let found = output_error(&data, OutputErrorOptions { delay, ..OutputErrorOptions::new(3) }).unwrap();
            for (found, exact) in found.model.poles().unwrap().iter().zip(&poles) {
                // A perfect fit: rounding over the sensitivity of the poles.
                assert!((found - exact).norm() < 1e-8, "{m} inputs, {q} outputs: {found} {exact}");
            }
            assert!(found.loss < 1e-18, "{}", found.loss);
            if delay == 0 {
                let fit = crate::compare(&found.model, &data).unwrap()[0].unwrap();
                assert!(fit.fit_percent.unwrap() > 99.9999, "{fit:?}");
            }
        }
    }

    #[test]
    fn no_transfer_function_of_the_order_simulates_better() {
        use crate::{TransferFunctionOptions, transfer_function_fit};
        const DT_S: f64 = 1e-3;
        for system in 0..20 {
            // Fourth order, slow and stiff: two real poles apart, and a pair; gains of either sign.
            let draw = |k: usize| uniform(900 + system, k);
            let (slow, fast) = (-1.0 - 2.0 * draw(0), -20.0 - 60.0 * draw(1));
            let (re, im) = (-5.0 - 30.0 * draw(2), 40.0 + 100.0 * draw(3));
            let a = nalgebra::dmatrix![slow, 0.0, 0.0, 0.0; 0.0, fast, 0.0, 0.0; 0.0, 0.0, re, im; 0.0, 0.0, -im, re];
            let b = DMatrix::from_element(4, 1, 1.0);
            let c = DMatrix::from_fn(1, 4, |_, j| (draw(4 + j) - 0.5) * [1.0, 30.0, 60.0, 60.0][j]);
            let model = StateSpace::new(a, b, c, DMatrix::zeros(1, 1), None).unwrap();
            let held = crumple_lti::discretize_first_order_hold(&model, DT_S).unwrap();
            let u: Vec<f64> = (0..500).map(|k| uniform(950 + system, k) - 0.5).collect();
            let mut x = nalgebra::DVector::zeros(4);
            let mut y = Vec::new();
            for k in 0..u.len() {
                y.push((&model.c * &x)[0]);
                let next = u.get(k + 1).copied().unwrap_or(0.0);
                x = &held.a * x + held.b_now.column(0) * u[k] + held.b_next.column(0) * next;
            }
            let rms = crate::io_data::scale(&y);
            for (k, y) in y.iter_mut().enumerate() {
                // Uniform noise of 10 %: deviation 1/sqrt 12 without the factor.
                *y += 0.1 * 12.0_f64.sqrt() * rms * (uniform(980 + system, k) - 0.5);
            }
            let data = IoData::single(u, y, DT_S).unwrap();
            let sampled = output_error(&data, OutputErrorOptions::new(4)).unwrap();
            // Output error is stable by construction.
            let options = TransferFunctionOptions { stable: true, ..TransferFunctionOptions::new(4, 3) };
            let reference = transfer_function_fit(&data, &options).unwrap();
            let scale = data.output_scales()[0];
            let (sampled, reference) = (sampled.loss * scale * scale, reference.loss);
            // Sampled models of the order hold every continuous one under straight lines; 0.1 % for where they stop.
            assert!(sampled <= 1.001 * reference, "{system}: {sampled} {reference}");
        }
    }

    #[test]
    fn sensitivities_are_the_derivatives() {
        let (data, _) = data(1, 2, 0);
        let problem = CascadeFilter::new(&data, OutputErrorOptions::new(3)).unwrap();
        let theta = [-1.2, 1.5, -0.3];
        let point = evaluate(&problem, &theta).unwrap();
        let exact = problem.sensitivities(&theta, &point.coefficients).unwrap();
        let predict = |theta: &[f64]| {
            let columns = problem.basis(theta).unwrap().columns;
            let one = |i: usize| {
                (0..300)
                    .map(|k| (0..columns.len()).map(|c| columns[c][k] * point.coefficients[(c, i)]).sum::<f64>())
                    .collect::<Vec<f64>>()
            };
            [one(0), one(1)].concat()
        };
        for i in 0..3 {
            let h = 1e-6;
            let moved = |sign: f64| {
                let mut theta = theta;
                theta[i] += sign * h;
                predict(&theta)
            };
            let (up, down) = (moved(1.0), moved(-1.0));
            for k in 0..600 {
                let numeric = (up[k] - down[k]) / (2.0 * h);
                // Central differences: rounding over the step, 1e-10, and h² times third derivatives.
                assert!((numeric - exact[i][k]).abs() < 1e-6, "{i} {k}: {numeric} {}", exact[i][k]);
            }
        }
    }
}
