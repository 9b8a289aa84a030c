//! Covariance of the unknowns of a separable fit, and of quantities that follow from them.
//!
//! `P = s² (J'J)^-1`, `s²` the mean square of the residuals over the degrees of freedom, widened by samples over
//! effective samples where residuals are correlated. Linear: right while the response is straight over the interval.

use crate::linalg::{Solution, TriangularFactor, dot};
use nalgebra::DMatrix;

use super::variable_projection::{Separable, SeparableFit, evaluate, projected_jacobian};

/// Covariance of all unknowns of a fit (poles, then linear ones), for as many independent samples as there effectively
/// are, and the condition number of their column-scaled sensitivities.
pub fn unknowns_covariance(
    problem: &impl Separable,
    best: &SeparableFit,
    effective: f64,
) -> (Option<DMatrix<f64>>, f64) {
    let samples = problem.targets()[0].len();
    let outputs = problem.targets().len();
    let (Some(basis), Some(sensitivities)) =
        (problem.basis(&best.theta), problem.sensitivities(&best.theta, &best.coefficients))
    else {
        return (None, f64::INFINITY);
    };
    // The linear unknowns of an output move that output alone.
    let width = sensitivities.len() + outputs * basis.columns.len() + 1;
    let rows = samples * outputs;
    let mut factor = TriangularFactor::new(width);
    let mut block: Vec<f64> = Vec::with_capacity(width * rows);
    block.extend(sensitivities.iter().flatten());
    for output in 0..outputs {
        for column in &basis.columns {
            block.resize(block.len() + output * samples, 0.0);
            block.extend(column);
            block.resize(block.len() + (outputs - 1 - output) * samples, 0.0);
        }
    }
    block.extend(&best.residual);
    factor.push(rows, &mut block);
    let Some(Solution { inverse_square, condition, .. }) = factor.solve(1, 0.0) else {
        return (None, f64::INFINITY);
    };
    let unknowns = inverse_square.nrows() as f64;
    let variance = dot(&best.residual, &best.residual) / (rows as f64 - unknowns).max(1.0);
    (Some(inverse_square * (variance * rows as f64 / effective)), condition)
}

/// Covariance of the nonlinear unknowns alone, the linear ones projected out: the same block of [`unknowns_covariance`]
/// at a fraction of its cost where there are many outputs. The condition number is that of their projected
/// sensitivities.
pub fn nonlinear_covariance(
    problem: &impl Separable,
    best: &SeparableFit,
    effective: f64,
) -> (Option<DMatrix<f64>>, f64) {
    let Some((point, jacobian)) = evaluate(problem, &best.theta)
        .and_then(|point| projected_jacobian(problem, &best.theta, &point).map(|jacobian| (point, jacobian)))
    else {
        return (None, f64::INFINITY);
    };
    let (rows, count) = (point.residual.len(), jacobian.len());
    let mut factor = TriangularFactor::new(count + 1);
    let mut block: Vec<f64> = jacobian.concat();
    block.extend(&point.residual);
    factor.push(rows, &mut block);
    let Some(Solution { inverse_square, condition, .. }) = factor.solve(1, 0.0) else {
        return (None, f64::INFINITY);
    };
    let unknowns = (count + point.coefficients.len()) as f64;
    let variance = point.cost / (rows as f64 - unknowns).max(1.0);
    (Some(inverse_square * (variance * rows as f64 / effective)), condition)
}

/// Covariance of `describe(unknowns)` by central differences.
pub fn propagated(describe: &impl Fn(&[f64]) -> Vec<f64>, unknowns: &[f64], covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let count = describe(unknowns).len();
    let mut jacobian = DMatrix::zeros(count, unknowns.len());
    for i in 0..unknowns.len() {
        let h = 1e-6 * unknowns[i].abs().max(1e-3);
        let moved = |sign: f64| {
            let mut x = unknowns.to_vec();
            x[i] += sign * h;
            describe(&x)
        };
        for (j, (up, down)) in moved(1.0).iter().zip(moved(-1.0)).enumerate() {
            jacobian[(j, i)] = (up - down) / (2.0 * h);
        }
    }
    &jacobian * covariance * jacobian.transpose()
}
