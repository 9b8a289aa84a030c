//! Hankel matrices that are multiplied without being formed.

use std::sync::Arc;

use nalgebra::DMatrix;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// The Hankel pair of a sequence: `H0[i,j] = y[i+j]` and its shift `H1[i,j] = y[i+j+1]`, both `rows x columns`.
///
/// A product with a vector is a correlation, done by FFT in `O(N log N)` time and `O(N)` memory: `(H x)[i] = sum_j
/// y[i+j] x[j]`. Rounding error about the rounding unit times `|y| |x|`, that is relative to the largest singular
/// value, not to the result.
pub(crate) struct Hankel<'a> {
    y: &'a [f64],
    rows: usize,
    columns: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    spectra: [Vec<Complex<f64>>; 2],
    time: Vec<f64>,
    frequency: Vec<Complex<f64>>,
    forward_scratch: Vec<Complex<f64>>,
    inverse_scratch: Vec<Complex<f64>>,
}

/// Which matrix of the pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shift {
    /// `H0`.
    Zero,
    /// `H1`.
    One,
}

impl<'a> Hankel<'a> {
    /// Takes `rows + columns` values: `y[rows + columns - 1]` is the last entry of `H1`. The caller has checked the
    /// length.
    pub(crate) fn new(y: &'a [f64], rows: usize, columns: usize) -> Self {
        let span = rows + columns - 1;
        debug_assert!(rows > 0 && columns > 0 && y.len() > span, "{} values for {rows} x {columns}", y.len());
        let length = fast_length(span);
        let mut planner = RealFftPlanner::new();
        let forward = planner.plan_fft_forward(length);
        let inverse = planner.plan_fft_inverse(length);
        let mut hankel = Self {
            y,
            rows,
            columns,
            time: forward.make_input_vec(),
            frequency: forward.make_output_vec(),
            forward_scratch: forward.make_scratch_vec(),
            inverse_scratch: inverse.make_scratch_vec(),
            spectra: [Vec::new(), Vec::new()],
            forward,
            inverse,
        };
        for shift in 0..2 {
            hankel.transform(&y[shift..shift + span]);
            hankel.spectra[shift] = hankel.frequency.clone();
        }
        hankel
    }

    /// Rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Columns.
    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    /// `out = H x`.
    pub(crate) fn multiply(&mut self, shift: Shift, x: &[f64], out: &mut [f64]) {
        debug_assert_eq!((x.len(), out.len()), (self.columns, self.rows));
        self.correlate(shift, x, out);
    }

    /// `out = H' x`: a Hankel matrix of the same sequence with rows and columns exchanged.
    pub(crate) fn multiply_transposed(&mut self, shift: Shift, x: &[f64], out: &mut [f64]) {
        debug_assert_eq!((x.len(), out.len()), (self.rows, self.columns));
        self.correlate(shift, x, out);
    }

    /// `H0` entry by entry.
    pub(crate) fn dense(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.rows, self.columns, |i, j| self.y[i + j])
    }

    fn transform(&mut self, x: &[f64]) {
        self.time[..x.len()].copy_from_slice(x);
        self.time[x.len()..].fill(0.0);
        // The lengths come from the plan itself, the only thing the transform can object to.
        let done = self.forward.process_with_scratch(&mut self.time, &mut self.frequency, &mut self.forward_scratch);
        debug_assert!(done.is_ok());
    }

    /// `out[i] = sum_j y[i+j] x[j]`, no index wrapping round for `i + j < rows + columns - 1`.
    fn correlate(&mut self, shift: Shift, x: &[f64], out: &mut [f64]) {
        self.transform(x);
        let spectrum = &self.spectra[usize::from(shift == Shift::One)];
        for (product, y) in self.frequency.iter_mut().zip(spectrum) {
            *product = y * product.conj();
        }
        // Real signals have real first and (even length) last bins; the transform back insists on it.
        let even = self.time.len().is_multiple_of(2);
        if let Some(first) = self.frequency.first_mut() {
            first.im = 0.0;
        }
        if let Some(last) = self.frequency.last_mut().filter(|_| even) {
            last.im = 0.0;
        }
        let done = self.inverse.process_with_scratch(&mut self.frequency, &mut self.time, &mut self.inverse_scratch);
        debug_assert!(done.is_ok());
        let scale = 1.0 / self.time.len() as f64;
        for (result, value) in out.iter_mut().zip(&self.time) {
            *result = value * scale;
        }
    }
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
        for (rows, columns) in [(1, 1), (3, 5), (40, 17), (64, 64)] {
            let y: Vec<f64> = (0..rows + columns).map(|k| (k as f64 * 0.7).sin() + 0.01 * k as f64).collect();
            let mut h = Hankel::new(&y, rows, columns);
            let x: Vec<f64> = (0..columns.max(rows)).map(|k| (k as f64 * 1.3).cos()).collect();
            for (shift, offset) in [(Shift::Zero, 0), (Shift::One, 1)] {
                let dense = DMatrix::from_fn(rows, columns, |i, j| y[i + j + offset]);
                let (mut out, mut out_t) = (vec![0.0; rows], vec![0.0; columns]);
                h.multiply(shift, &x[..columns], &mut out);
                h.multiply_transposed(shift, &x[..rows], &mut out_t);
                let exact = &dense * DMatrix::from_column_slice(columns, 1, &x[..columns]);
                let exact_t = dense.transpose() * DMatrix::from_column_slice(rows, 1, &x[..rows]);
                for (found, expected) in out.iter().chain(&out_t).zip(exact.iter().chain(exact_t.iter())) {
                    // Sums of up to 64 terms of size 1 to 2: a few hundred rounding units.
                    assert!((found - expected).abs() < 1e-13, "{rows}x{columns}: {found} against {expected}");
                }
            }
        }
    }

    #[test]
    fn lengths_are_even_smooth_and_close() {
        assert_eq!([1, 2, 2499, 2501, 97].map(fast_length), [2, 2, 2500, 2560, 100]);
    }
}
