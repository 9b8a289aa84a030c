//! Input matrix, direct term and initial state of a model whose `A` and `C` are known.

use crumple_numerics::linalg::TriangularFactor;
use crumple_numerics::linalg::dot;
use crumple_numerics::lti::{StateSpace, end_what_decayed};
use nalgebra::DMatrix;

use crate::data::columns_of;
use crate::simulation::initial_state::left_multiply;
use crate::{IdentifyError, IoData};

/// Singular values below this fraction of the largest count as zero: states that the record does not show.
const TRUNCATION: f64 = 1e-12;

/// Growth over a record at which a model cannot be simulated with digits left.
const LARGEST_GROWTH: f64 = 1e8;

/// Finds `B`, `D` and `x0` that simulate the record best for given `A`, `C`, each output divided by its root mean
/// square.
///
/// The simulated output is linear in all three: with `w[k+1] = A' w[k] + c_i' u_j[k]`, output `i` takes `w[k] . b_j`
/// from input `j`. One linear least-squares problem over all samples; unlike the regression on a state sequence, which
/// many subspace codes use, it minimises what the model is used for. Columns that the data do not determine (a silent
/// input) are set to zero. Without `direct`, `D = 0`.
///
/// Meaningless when `A` has a pole well outside the unit circle: the responses overflow, which is an error.
///
/// `a` is `n x n`, `c` is `outputs x n`; unknowns are `n m + q m + n`. The result is the model and its `x0`, both in
/// the units of the data. McKelvey, Akçay & Ljung, IEEE Trans. Autom. Control 41(7), 1996, fit `B` and `D` so in the
/// frequency domain.
pub(crate) fn input_matrices(
    a: &DMatrix<f64>,
    c: &DMatrix<f64>,
    data: &IoData,
    direct: bool,
) -> Result<(StateSpace, Vec<f64>), IdentifyError> {
    let (n, m, q) = (a.nrows(), data.inputs().len(), data.outputs().len());
    let samples = data.samples();
    let columns = columns_of(a);
    let u_scales = data.input_scales();
    let y_scales = data.output_scales();
    // b of every input, d by output and input, x0, target.
    let width = n * m + if direct { q * m } else { 0 } + n + 1;
    let free_at = width - 1 - n;
    let mut factor = TriangularFactor::new(width);
    let rows = TriangularFactor::block_rows(width);
    for (i, measured) in data.outputs().iter().enumerate() {
        let c_row: Vec<f64> = c.row(i).iter().map(|x| x / y_scales[i]).collect();
        let mut free = c_row.clone();
        let mut duals = vec![vec![0.0; n]; m];
        let mut next = vec![0.0; n];
        for first in (0..samples).step_by(rows) {
            let count = rows.min(samples - first);
            let mut block = vec![0.0; count * width];
            for k in 0..count {
                for (j, dual) in duals.iter_mut().enumerate() {
                    let u = data.inputs()[j][first + k] / u_scales[j];
                    for (s, w) in dual.iter().enumerate() {
                        block[(j * n + s) * count + k] = *w;
                    }
                    if direct {
                        block[(n * m + i * m + j) * count + k] = u;
                    }
                    left_multiply(dual, &columns, &mut next);
                    for (next, c) in next.iter_mut().zip(&c_row) {
                        *next += c * u;
                    }
                    std::mem::swap(dual, &mut next);
                    end_what_decayed(dual);
                }
                for (s, v) in free.iter().enumerate() {
                    block[(free_at + s) * count + k] = *v;
                }
                left_multiply(&free, &columns, &mut next);
                std::mem::swap(&mut free, &mut next);
                end_what_decayed(&mut free);
                block[(width - 1) * count + k] = measured[first + k] / y_scales[i];
            }
            factor.push(count, &mut block);
        }
    }
    let solution = factor
        .solve(1, TRUNCATION)
        .ok_or(IdentifyError::NotConverged("the least-squares fit of the input matrices"))?;
    let x = solution.coefficients.column(0);
    let b = DMatrix::from_fn(n, m, |s, j| x[j * n + s] / u_scales[j]);
    let d = DMatrix::from_fn(q, m, |i, j| if direct { x[n * m + i * m + j] / u_scales[j] * y_scales[i] } else { 0.0 });
    let x0 = (0..n).map(|s| x[free_at + s]).collect();
    Ok((StateSpace::new(a.clone(), b, c.clone(), d, Some(data.sample_time_s()))?, x0))
}

/// Whether a row of ones times `a^k` has a norm of 1e8 or more within `samples` steps: beyond, a simulation and a fit
/// of its inputs keep less than half of the digits of what the record holds.
pub(crate) fn grows(a: &DMatrix<f64>, samples: usize) -> bool {
    let columns = columns_of(a);
    let mut v = vec![1.0; a.nrows()];
    let mut next = v.clone();
    for _ in 0..samples {
        left_multiply(&v, &columns, &mut next);
        std::mem::swap(&mut v, &mut next);
        let square = dot(&v, &v);
        // It has decayed to below 1e-160.
        if square == 0.0 {
            return false;
        }
        if square.is_nan() || square >= LARGEST_GROWTH * LARGEST_GROWTH {
            return true;
        }
    }
    false
}
