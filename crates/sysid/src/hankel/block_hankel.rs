//! Hankel matrices that are multiplied without being formed.

use std::sync::Arc;

use crumple_numerics::linalg::{Complex64, ComplexToReal, RealToComplex, RealTransform, real_transform};
use nalgebra::DMatrix;

use crate::hankel::shift_pair::{Shift, ShiftPair};

/// The block Hankel pair of Markov parameters: block `(i, j)` of `H0` is `Y[i+j]` and of its shift `H1` is `Y[i+j+1]`,
/// with `Y` of `outputs x inputs`; `rows x columns` blocks. Row `i * outputs + r` belongs to output `r`.
///
/// A product with a vector is a sum of correlations, done by FFT in `O(N log N)` time and `O(N)` memory: for one
/// channel `(H x)[i] = sum_j y[i+j] x[j]`. Rounding error about the rounding unit times `|y| |x|`, that is relative to
/// the largest singular value, not to the result.
pub(crate) struct Hankel<'a> {
    /// `y[r * inputs + c]`.
    /// Sequences in the order of the Markov parameters, each at least `rows + columns` long.
    y: Vec<&'a [f64]>,
    /// Outputs and inputs, `q` and `m`: size of a block.
    outputs: usize,
    inputs: usize,
    block_rows: usize,
    block_columns: usize,
    /// Plans of the transform, of a length that is a product of 2, 3 and 5.
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// Of every sequence.
    spectra: Vec<Vec<Complex64>>,
    time: Vec<f64>,
    /// Transform of the part of the factor that belongs to each input (output, for the transposed product).
    factors: Vec<Vec<Complex64>>,
    frequency: Vec<Complex64>,
    forward_scratch: Vec<Complex64>,
    inverse_scratch: Vec<Complex64>,
}

impl<'a> Hankel<'a> {
    /// Takes `rows + columns` values of every sequence: the last is the last entry of `H1`. `y[r * inputs + c]` is the
    /// sequence of output `r` and input `c`. The caller has checked the lengths.
    pub(crate) fn new(y: Vec<&'a [f64]>, inputs: usize, rows: usize, columns: usize) -> Self {
        let values = rows + columns;
        debug_assert!(
            rows > 0 && columns > 0 && y.iter().all(|y| y.len() >= values),
            "too short for {rows} x {columns}"
        );
        let outputs = y.len() / inputs;
        let length = fast_length(values);
        let RealTransform { forward, inverse } = real_transform(length);
        let mut hankel = Self {
            outputs,
            inputs,
            block_rows: rows,
            block_columns: columns,
            time: forward.make_input_vec(),
            factors: vec![forward.make_output_vec(); inputs.max(outputs)],
            frequency: forward.make_output_vec(),
            forward_scratch: forward.make_scratch_vec(),
            inverse_scratch: inverse.make_scratch_vec(),
            spectra: Vec::with_capacity(y.len()),
            y,
            forward,
            inverse,
        };
        for sequence in 0..hankel.y.len() {
            let y = hankel.y[sequence];
            hankel.time[..values].copy_from_slice(&y[..values]);
            let mut spectrum = hankel.forward.make_output_vec();
            transform(&hankel.forward, &mut hankel.time, values, &mut spectrum, &mut hankel.forward_scratch);
            hankel.spectra.push(spectrum);
        }
        hankel
    }

    /// `out[i, r] = sum_jc y_rc[i + j + shift] x[j, c]`; for the transposed product rows and columns change places, for
    /// a transposed block Hankel matrix is one of the transposed blocks. No index wraps round within the transform.
    ///
    /// By the correlation theorem: `out = irfft(rfft(y) conj(rfft(x)))`, cut to the rows. The transform is at least
    /// `rows + columns` long, so the part that would wrap lies beyond what is read. Cost: one transform for each
    /// input (output) of the factor and one back for each output (input), whatever the number of sequences; their
    /// spectra are kept.
    fn correlate(&mut self, shift: Shift, transposed: bool, x: &[f64], out: &mut [f64]) {
        let (to, from) = if transposed { (self.inputs, self.outputs) } else { (self.outputs, self.inputs) };
        let length = x.len() / from;
        for (c, factor) in self.factors[..from].iter_mut().enumerate() {
            if from == 1 {
                self.time[..length].copy_from_slice(x);
            } else {
                for (time, x) in self.time.iter_mut().zip(x.iter().skip(c).step_by(from)) {
                    *time = *x;
                }
            }
            transform(&self.forward, &mut self.time, length, factor, &mut self.forward_scratch);
        }
        let offset = usize::from(shift == Shift::One);
        let scale = 1.0 / self.time.len() as f64;
        let even = self.time.len().is_multiple_of(2);
        for r in 0..to {
            for (c, factor) in self.factors[..from].iter().enumerate() {
                let spectrum = &self.spectra[if transposed { c * self.inputs + r } else { r * self.inputs + c }];
                for ((product, y), x) in self.frequency.iter_mut().zip(spectrum).zip(factor) {
                    let term = y * x.conj();
                    *product = if c == 0 { term } else { *product + term };
                }
            }
            // Real signals have real first and (even length) last bins; the transform back insists on it.
            if let Some(first) = self.frequency.first_mut() {
                first.im = 0.0;
            }
            if let Some(last) = self.frequency.last_mut().filter(|_| even) {
                last.im = 0.0;
            }
            let done =
                self.inverse.process_with_scratch(&mut self.frequency, &mut self.time, &mut self.inverse_scratch);
            debug_assert!(done.is_ok());
            for (result, value) in out.iter_mut().skip(r).step_by(to).zip(&self.time[offset..]) {
                *result = value * scale;
            }
        }
    }
}

impl ShiftPair for Hankel<'_> {
    fn rows(&self) -> usize {
        self.block_rows * self.outputs
    }

    fn columns(&self) -> usize {
        self.block_columns * self.inputs
    }

    /// One sequence and as many rows as columns: `H[i,j] = y[i+j] = H[j,i]`.
    fn symmetric(&self) -> bool {
        self.y.len() == 1 && self.block_rows == self.block_columns
    }

    fn multiply(&mut self, shift: Shift, x: &[f64], out: &mut [f64]) {
        debug_assert_eq!((x.len(), out.len()), (self.columns(), self.rows()));
        self.correlate(shift, false, x, out);
    }

    fn multiply_transposed(&mut self, shift: Shift, x: &[f64], out: &mut [f64]) {
        debug_assert_eq!((x.len(), out.len()), (self.rows(), self.columns()));
        self.correlate(shift, true, x, out);
    }

    /// The matrix written out, `rows q x columns m`: `O(rows columns)` memory, so for small ones only.
    fn dense(&mut self) -> DMatrix<f64> {
        let (q, m) = (self.outputs, self.inputs);
        DMatrix::from_fn(self.rows(), self.columns(), |i, j| self.y[(i % q) * m + j % m][i / q + j / m])
    }
}

/// Transforms the first `length` values of `time`; the rest is taken for zeros.
fn transform(
    plan: &Arc<dyn RealToComplex<f64>>,
    time: &mut [f64],
    length: usize,
    out: &mut [Complex64],
    scratch: &mut [Complex64],
) {
    time[length..].fill(0.0);
    // The lengths come from the plan itself, the only thing the transform can object to.
    let done = plan.process_with_scratch(time, out, scratch);
    debug_assert!(done.is_ok());
}

/// The least even length of the form `2^a 3^b 5^c` that is at least `n`.
fn fast_length(n: usize) -> usize {
    (n.max(2)..)
        .find(|&length| {
            length.is_multiple_of(2)
                && [2, 3, 5].iter().fold(length, |mut rest, p| {
                    while rest.is_multiple_of(*p) {
                        rest /= p;
                    }
                    rest
                }) == 1
        })
        .unwrap_or(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_equal_those_of_the_formed_matrix() {
        for (q, m, rows, columns) in
            [(1, 1, 1, 1), (1, 1, 3, 5), (1, 1, 40, 17), (1, 1, 64, 64), (3, 1, 20, 31), (1, 2, 9, 12), (3, 2, 17, 10)]
        {
            let y: Vec<Vec<f64>> = (0..q * m)
                .map(|s| (0..rows + columns).map(|k| (k as f64 * 0.7 + s as f64).sin() + 0.01 * k as f64).collect())
                .collect();
            let x: Vec<f64> = (0..(columns * m).max(rows * q)).map(|k| (k as f64 * 1.3).cos()).collect();
            for (shift, offset) in [(Shift::Zero, 0), (Shift::One, 1)] {
                let dense =
                    DMatrix::from_fn(rows * q, columns * m, |i, j| y[(i % q) * m + j % m][i / q + j / m + offset]);
                let mut h = Hankel::new(y.iter().map(Vec::as_slice).collect(), m, rows, columns);
                let (mut out, mut out_t) = (vec![0.0; rows * q], vec![0.0; columns * m]);
                h.multiply(shift, &x[..columns * m], &mut out);
                h.multiply_transposed(shift, &x[..rows * q], &mut out_t);
                let exact = &dense * DMatrix::from_column_slice(columns * m, 1, &x[..columns * m]);
                let exact_t = dense.transpose() * DMatrix::from_column_slice(rows * q, 1, &x[..rows * q]);
                for (estimated, expected) in out.iter().chain(&out_t).zip(exact.iter().chain(exact_t.iter())) {
                    // Sums of up to 64 terms of size 1 to 2: a few hundred rounding units.
                    assert!((estimated - expected).abs() < 1e-13, "{rows}x{columns}: {estimated} against {expected}");
                }
                if shift == Shift::Zero {
                    assert_eq!(h.dense(), dense);
                }
            }
        }
    }

    #[test]
    fn lengths_are_even_smooth_and_close() {
        assert_eq!([1, 2, 2499, 2501, 97].map(fast_length), [2, 2, 2500, 2560, 100]);
    }
}
