//! Poles of all orders from one factorisation, for the stabilisation diagram.
//!
//! In balanced coordinates the model of order `n` is the leading `n x n` part of any larger one. So a diagram over
//! all orders costs one decomposition and one eigenvalue problem per order, instead of one identification each.

use crumple_estimation::statistics::autoregressive_effective_samples;
use crumple_lti::{Complex, eigenvalues, eigenvectors};
use nalgebra::DMatrix;

use crate::hankel::block_hankel::Hankel;
use crate::hankel::golub_kahan::GolubKahan;
use crate::hankel::shift_pair::{Shift, ShiftPair};
use crate::hankel::svd::factorize;
use crate::{EraError, MarkovParameters, OrderPoles, Subspace};

/// Hankel matrices up to this size are decomposed whole.
const DENSE_UP_TO: usize = 64;

/// Lanczos steps at which convergence is looked at; the last is the limit.
const CHECKPOINTS: [usize; 5] = [30, 45, 68, 100, 150];

/// Relative residual of a singular value that is good enough here: the diagram compares changes of 1 %, and the poles'
/// errors go with the square of this.
const GOOD: f64 = 0.03;

/// Poles of the ERA models of the orders 2, 4, ... up to `highest` or to what the record supports.
///
/// In the balanced form the model of order n is the leading part of every larger one, so all orders cost one
/// decomposition and one small eigenproblem each. `markov` as for [`era`](crate::era()); half of the samples are rows,
/// half columns, unless given. Errors: as there.
pub fn era_order_scan(
    markov: &[f64],
    highest: usize,
    rows: Option<usize>,
    columns: Option<usize>,
) -> Result<Vec<OrderPoles>, EraError> {
    era_order_scan_of(MarkovParameters::new(vec![markov], 1)?, highest, rows, columns)
}

/// The same for any number of outputs and inputs, with mode shapes where outputs are several.
pub fn era_order_scan_of(
    markov: MarkovParameters<'_>,
    highest: usize,
    rows: Option<usize>,
    columns: Option<usize>,
) -> Result<Vec<OrderPoles>, EraError> {
    let (q, m) = (markov.outputs(), markov.inputs());
    let parameters = markov.samples().saturating_sub(1);
    let half = parameters / 2;
    let rows = rows.unwrap_or_else(|| columns.map_or(half, |columns| parameters.saturating_sub(columns)));
    let columns = columns.unwrap_or_else(|| if rows == half { half } else { parameters.saturating_sub(rows) });
    if rows == 0 || columns == 0 || rows.saturating_add(columns) > parameters {
        return Err(EraError::TooShort { parameters, rows: rows.max(1), columns: columns.max(1) });
    }
    let used = || markov.sequences().iter().map(|y| &y[1..=rows + columns]);
    if used().all(|y| y[..y.len() - 1].iter().all(|y| *y == 0.0)) {
        return Err(EraError::Silent { samples: rows + columns });
    }
    let largest = used().flatten().fold(0.0_f64, |m, y| m.max(y.abs()));
    let scaled: Vec<Vec<f64>> = used().map(|y| y.iter().map(|y| y / largest).collect()).collect();
    let mut hankel = Hankel::new(scaled.iter().map(Vec::as_slice).collect(), m, rows, columns);
    let (values, left, right) = triplets(&mut hankel, highest)?;
    let count = values.len();
    let mut products = DMatrix::zeros(hankel.rows(), count);
    let mut product = vec![0.0; hankel.rows()];
    for i in 0..count {
        hankel.multiply(Shift::One, right.column(i).as_slice(), &mut product);
        products.column_mut(i).copy_from_slice(&product);
    }
    let shifted = left.columns(0, count).tr_mul(&products);
    let roots: Vec<f64> = values.iter().map(|s| s.sqrt()).collect();
    let balanced = DMatrix::from_fn(count, count, |i, j| shifted[(i, j)] / (roots[i] * roots[j]));
    (2..=count)
        .step_by(2)
        .map(|order| {
            let a = balanced.view((0, 0), (order, order)).into_owned();
            let poles = eigenvalues(&a)?;
            let b = DMatrix::from_fn(order, m, |i, j| roots[i] * right[(j, i)]);
            let c = DMatrix::from_fn(q, order, |j, i| roots[i] * left[(j, i)]);
            let (shapes, strengths) = evidence(&a, &b, &c, &poles, &scaled).unwrap_or_default();
            Ok(OrderPoles { order, poles, shapes: if q > 1 { shapes } else { Vec::new() }, strengths })
        })
        .collect()
}

/// Mode shapes, one vector per pole with an entry per output, and strengths, one per pole.
type ShapesAndStrengths = (Vec<Vec<Complex>>, Vec<f64>);

/// What the outputs show of every pole; and energy of its wave in the Markov parameters, over `2 s² (N/Ne) ln Ne`: that
/// of the strongest of all frequencies in noise of the residual's mean square `s²` and effective number of samples.
/// Sequences stand one after the other. `None` without a basis of eigenvectors, or where a wave leaves the range of
/// numbers.
fn evidence(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    c: &DMatrix<f64>,
    poles: &[Complex],
    markov: &[Vec<f64>],
) -> Option<ShapesAndStrengths> {
    let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
    let vectors = eigenvectors(a, poles)?;
    let b = vectors.clone().try_inverse()? * complex(b);
    let c = complex(c) * vectors;
    let mut residual = markov.concat();
    let (inputs, length) = (b.ncols(), markov.first()?.len());
    let mut energies = Vec::with_capacity(poles.len());
    for (i, z) in poles.iter().enumerate() {
        // Of a pair the wave is the real part of both together.
        let both = if z.im == 0.0 { 1.0 } else { 2.0 };
        let mut energy = 0.0;
        for (sequence, residual) in residual.chunks_exact_mut(length).enumerate() {
            let mut wave = c[(sequence / inputs, i)] * b[(i, sequence % inputs)];
            for e in residual {
                let y = both * wave.re;
                energy += y * y;
                if z.im >= 0.0 {
                    *e -= y;
                }
                wave *= z;
            }
        }
        energies.push(energy);
    }
    let samples = residual.len() as f64;
    let square = residual.iter().map(|e| e * e).sum::<f64>() / samples;
    let effective = autoregressive_effective_samples(&residual).max(2.0);
    let noise = 2.0 * square * samples / effective * effective.ln();
    let strengths: Vec<f64> = energies.into_iter().map(|energy| energy / noise.max(f64::MIN_POSITIVE)).collect();
    let shapes = c.column_iter().map(|column| column.iter().copied().collect()).collect();
    strengths.iter().all(|x| x.is_finite()).then_some((shapes, strengths))
}

/// Singular values, left vectors, right vectors, the vectors as columns.
type Triplets = (Vec<f64>, DMatrix<f64>, DMatrix<f64>);

/// The leading singular triplets, at most `wanted`, fewer where the record has fewer or they do not converge.
fn triplets(hankel: &mut Hankel<'_>, wanted: usize) -> Result<Triplets, EraError> {
    if hankel.rows().min(hankel.columns()) <= DENSE_UP_TO {
        let factors = factorize(hankel, wanted, false, |_| wanted)?;
        let count = factors.rank().min(wanted);
        return Ok((factors.values[..count].to_vec(), factors.left, factors.right));
    }
    let mut lanczos = GolubKahan::new(hankel.columns());
    let last = CHECKPOINTS[CHECKPOINTS.len() - 1];
    for steps in CHECKPOINTS {
        lanczos.extend(hankel, steps);
        let Some(ritz) = lanczos.ritz() else { break };
        let floor = 1e-12 * ritz.values.first().copied().unwrap_or(0.0);
        let good = ritz
            .values
            .iter()
            .zip(&ritz.residuals)
            .take_while(|(value, residual)| **value > floor && **residual <= GOOD * **value)
            .count();
        let all = ritz.values.get(good).is_none_or(|value| *value <= floor);
        if good >= wanted || all || lanczos.exhausted() || steps == last {
            let count = good.min(wanted);
            let (left, right) = lanczos.vectors(&ritz, count);
            return Ok((ritz.values[..count].to_vec(), left, right));
        }
    }
    Err(EraError::NotConverged { rows: hankel.rows(), columns: hankel.columns(), steps: lanczos.steps() })
}

/// Poles, and with several outputs mode shapes, of the subspace models of the orders 2, 4, ... up to `highest` or to
/// what the factorisation supports.
///
/// Shift invariance in the least-squares sense for all orders at once: with the observability matrix without its last
/// block row `= Q R` and `T = Q'` times that without its first, the state matrix of order n is
/// `R[..n, ..n]^-1 T[..n, ..n]` (Döhler & Mevel, Mech. Syst. Signal Process. 38, 2013). Growing poles stay as they are.
pub fn subspace_order_scan(subspace: &Subspace<'_>, highest: usize) -> Vec<OrderPoles> {
    let (observability, outputs) = subspace.observability();
    let rows = observability.nrows() - outputs;
    let count = subspace.highest_order().min(highest).min(observability.ncols());
    let (q, r) = observability.view((0, 0), (rows, count)).into_owned().qr().unpack();
    let t = q.tr_mul(&observability.view((outputs, 0), (rows, count)));
    let c = observability.view((0, 0), (outputs, count)).into_owned();
    let scales = subspace.output_scales();
    (2..=count)
        .step_by(2)
        .filter_map(|order| {
            let a = r.view((0, 0), (order, order)).solve_upper_triangular(&t.view((0, 0), (order, order)))?;
            let poles = eigenvalues(&a).ok()?;
            let shapes = if outputs > 1 {
                let vectors = eigenvectors(&a, &poles)?;
                let seen = DMatrix::from_fn(outputs, order, |i, k| Complex::new(c[(i, k)] * scales[i], 0.0)) * vectors;
                seen.column_iter().map(|column| column.iter().copied().collect()).collect()
            } else {
                Vec::new()
            };
            Some(OrderPoles { order, poles, shapes, strengths: Vec::new() })
        })
        .collect()
}
