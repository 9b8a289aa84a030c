//! Discrete-time sections in cascade: the model of an output-error fit.
//!
//! The denominator `A(z) = A_1(z) ... A_k(z)` is a product of sections of second order, with one of first order last
//! where the order is odd. All inputs and outputs share it; what differs are the numerators, and those are linear:
//! they are the coefficients that variable projection solves for, while it iterates on the poles alone.
//!
//! A section `A_i(z) = z² + a1 z + a0` is described by its reflection coefficients `k0 = a0`, `k1 = a1/(1 + a0)`.
//! Both roots lie inside the unit circle exactly where `|k0| < 1` and `|k1| < 1` (Schur-Cohn), so that with
//! `k = tanh(theta)` every real unknown is a stable model; the bounds only keep `tanh` from rounding to 1.

use crumple_numerics::estimation::minimise::variable_projection::{Basis, Separable, SeparableFit};
use crumple_numerics::lti::{Complex, StateSpace};
use nalgebra::DMatrix;

use crate::output_error::options::OutputErrorOptions;
use crate::{IdentifyError, IoData};

/// Poles are kept inside a circle of radius `tanh` of this: 1 - 4e-9.
const EDGE: f64 = 10.0;

/// Coefficients and their derivatives by the unknowns.
/// `A_i(z) = z² + a[1] z + a[0]`, or `z + a[0]` of first order.
struct Section {
    /// `a0`, and `a1` unless the section is of first order.
    a: [f64; 2],
    second_order: bool,
    /// `da[i]/dtheta[k]`.
    derivative: [[f64; 2]; 2],
}

/// `y = sum over inputs and sections of coefficients times (1, z)/(A1 ... Ai) u`, plus free responses.
///
/// Signals are divided by their root mean squares and inputs are shifted by the delay when it is built;
/// [`Self::state_space`] takes both scales back out. `order` is the number of poles, not that of the states of a
/// model with several paths.
pub(crate) struct CascadeFilter {
    /// Scaled inputs, late by the delay.
    inputs: Vec<Vec<f64>>,
    /// Scaled outputs.
    outputs: Vec<Vec<f64>>,
    /// Root mean squares that the signals were divided by.
    input_scales: Vec<f64>,
    output_scales: Vec<f64>,
    sample_time_s: f64,
    order: usize,
    /// Whether an output follows an input within the same sample (`D` is fitted).
    direct: bool,
    /// Whether the record starts in a motion of its own.
    in_motion: bool,
}

impl CascadeFilter {
    /// Scales the record and checks it.
    ///
    /// Errors: order 0, no input, or fewer samples than the parameters of one output: `n` poles, `n` numerator
    /// coefficients of each input and `n` of the free motion, plus the direct terms and the delay.
    pub(crate) fn new(data: &IoData, options: OutputErrorOptions) -> Result<Self, IdentifyError> {
        let (m, q) = (data.inputs().len(), data.outputs().len());
        let n = options.order;
        if n == 0 {
            return Err(IdentifyError::OrderZero);
        }
        if m == 0 {
            return Err(IdentifyError::Channels {
                method: "output error",
                needed: "one input at least",
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
            in_motion: !options.from_rest,
        })
    }

    /// Coefficients of all sections from the unknowns, two of each section of second order: `(k1, k0)`.
    ///
    /// `a0 = k0`, `a1 = k1 (1 + k0)`, and by the chain rule `da0 = (1 - k0²) dx0`,
    /// `da1 = (1 - k1²)(1 + k0) dx1 + k1 (1 - k0²) dx0`.
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
    ///
    /// The recursion `x[k+2] = u[k] - a0 x[k] - a1 x[k+1]`; the second signal is empty for a section of first order.
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
    ///
    /// One column per state: section `i` is driven by the first state of section `i - 1`. `samples` long each.
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

    /// Poles of the chain, section after section; none of them is zero unless an unknown is on its bound.
    pub(crate) fn poles(theta: &[f64]) -> Vec<Complex> {
        let roots = |section: Section| match (section.second_order, section.a) {
            (false, [a0, _]) => vec![Complex::new(-a0, 0.0)],
            (true, [a0, a1]) => {
                let root = Complex::new(a1 * a1 / 4.0 - a0, 0.0).sqrt();
                vec![-a1 / 2.0 + root, -a1 / 2.0 - root]
            }
        };
        Self::sections(theta).into_iter().flat_map(roots).collect()
    }

    /// The model of a fit, in units of the data: as many states as poles times the lesser of the numbers of inputs and
    /// outputs.
    pub(crate) fn state_space(&self, fit: &SeparableFit) -> Result<StateSpace, IdentifyError> {
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
        // The chain once for every input, its states read by every output; or, where outputs are fewer, its transpose
        // once for every output, driven by every input.
        let (by_input, copies) = (m <= q, m.min(q));
        let a = DMatrix::from_fn(copies * n, copies * n, |i, k| match (i / n == k / n, by_input) {
            (false, _) => 0.0,
            (true, true) => a[(i % n, k % n)],
            (true, false) => a[(k % n, i % n)],
        });
        let unit = |state: usize, copy: usize| if state == copy * n + entry { 1.0 } else { 0.0 };
        let (b, c) = if by_input {
            (
                DMatrix::from_fn(copies * n, m, unit),
                DMatrix::from_fn(q, copies * n, |i, state| c(state / n, state % n, i)),
            )
        } else {
            (
                DMatrix::from_fn(copies * n, m, |state, j| c(j, state % n, state / n)),
                DMatrix::from_fn(q, copies * n, |i, state| unit(state, i)),
            )
        };
        Ok(StateSpace::new(a, b, c, d, Some(self.sample_time_s))?)
    }
}

impl Separable for CascadeFilter {
    /// The scaled outputs.
    fn targets(&self) -> &[Vec<f64>] {
        &self.outputs
    }

    /// The same for all unknowns: `|k| <= tanh(EDGE)`.
    fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(-EDGE, EDGE); self.order]
    }

    /// States of the chain driven by every input (and that input itself, with a direct term), then those of the free
    /// motion: `m (n + d) + n` columns, of which every output is a sum of its own.
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
        if self.in_motion {
            columns.extend(Self::chain(&sections, None, samples));
        }
        Some(Basis { columns, known: Vec::new() })
    }

    /// Derivatives of every model output by the unknowns, exact: the part `f` of the output that runs through section
    /// `i` changes by `-(1/A_i) f` with `a0` and by `-(z/A_i) f` with `a1`, one more filtering each.
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
                    for group in 0..self.inputs.len() + usize::from(self.in_motion) {
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
