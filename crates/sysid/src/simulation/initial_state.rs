//! The initial state of a model on a record.
//!
//! The output is linear in the initial state: `y[k] = forced[k] + C A^k x0`. One linear least-squares problem with a
//! row for every sample and output, solved by QR of blocks of rows, so that memory does not grow with the record.

use crumple_numerics::linalg::TriangularFactor;
use crumple_numerics::linalg::dot;
use crumple_numerics::lti::{StateSpace, end_what_decayed};

use crate::data::{columns_of, rows_of};
use crate::{IdentifyError, IoData};

/// Directions of the state that the record shows with less than this fraction of the strongest are left at zero.
const TRUNCATION: f64 = 1e-13;

/// `v' a` with `a` given by its columns.
pub(crate) fn left_multiply(v: &[f64], columns: &[Vec<f64>], out: &mut [f64]) {
    for (out, column) in out.iter_mut().zip(columns) {
        *out = dot(v, column);
    }
}

/// The state at the first sample that, added to the forced response, fits all outputs best, each divided by its root
/// mean square. States that no output shows are zero.
///
/// `forced` is one signal per output, from rest; the result has one number per state. Errors: other numbers of
/// outputs than the model has, a decomposition that does not converge.
pub(crate) fn initial_state(model: &StateSpace, data: &IoData, forced: &[Vec<f64>]) -> Result<Vec<f64>, IdentifyError> {
    let n = model.order();
    let outputs = data.outputs();
    if outputs.len() != model.c.nrows() {
        return Err(IdentifyError::Channels {
            method: "a simulation",
            needed: "as many inputs and outputs as the model has",
            inputs: data.inputs().len(),
            outputs: outputs.len(),
        });
    }
    if n == 0 {
        return Ok(Vec::new());
    }
    let scales = data.output_scales();
    let columns = columns_of(&model.a);
    let mut factor = TriangularFactor::new(n + 1);
    let rows = TriangularFactor::block_rows(n + 1);
    for (i, (measured, scale)) in outputs.iter().zip(&scales).enumerate() {
        let mut v: Vec<f64> = model.c.row(i).iter().copied().collect();
        let mut next = vec![0.0; n];
        let errors: Vec<f64> = measured.iter().zip(&forced[i]).map(|(y, f)| (y - f) / scale).collect();
        for block in errors.chunks(rows) {
            let mut data = vec![0.0; block.len() * (n + 1)];
            for (k, error) in block.iter().enumerate() {
                for (s, v) in v.iter().enumerate() {
                    data[s * block.len() + k] = v / scale;
                }
                data[n * block.len() + k] = *error;
                left_multiply(&v, &columns, &mut next);
                std::mem::swap(&mut v, &mut next);
                end_what_decayed(&mut v);
            }
            factor.push(block.len(), &mut data);
        }
    }
    let solution = factor.solve(1, TRUNCATION).ok_or(IdentifyError::NotConverged("the fit of the initial state"))?;
    Ok(solution.coefficients.iter().copied().collect())
}

/// Outputs without input from the state `x0`.
///
/// `y_i[k] = C_i A^k x0`, one signal of `samples` per output.
pub(crate) fn free_outputs(model: &StateSpace, x0: &[f64], samples: usize) -> Vec<Vec<f64>> {
    let (a, c) = (rows_of(&model.a), rows_of(&model.c));
    let mut x = x0.to_vec();
    let mut next = vec![0.0; x.len()];
    let mut outputs = vec![Vec::with_capacity(samples); c.len()];
    for _ in 0..samples {
        for (output, c) in outputs.iter_mut().zip(&c) {
            output.push(dot(c, &x));
        }
        for (next, a) in next.iter_mut().zip(&a) {
            *next = dot(a, &x);
        }
        std::mem::swap(&mut x, &mut next);
        end_what_decayed(&mut x);
    }
    outputs
}
