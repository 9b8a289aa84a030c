//! State spaces, transfer functions, sums of exponentials, polynomials.

use crumple_numerics::linalg::jacobi_svd;
use crumple_numerics::lti::{
    Complex, StateSpace, TransferFunction, discretize_zero_order_hold, eigenvalues, eigenvectors, polynomial_roots,
};
use nalgebra::DMatrix;
use serde_json::{Value, json};

use crate::papers::chains::configuration;
use crate::papers::inputs::{Inputs, complexes, text};

pub fn quotient(i: &Inputs<'_>) -> Result<Value, String> {
    let (product, target) = (i.n("a")? * i.n("b")?, i.n("m1")? * i.n("m2")? * i.n("w")?);
    Ok(json!({ "product": product, "target": target, "ratio": product / target }))
}

pub fn eig(i: &Inputs<'_>) -> Result<Value, String> {
    let a = i.matrix("A")?;
    let values = eigenvalues(&a).map_err(text)?;
    let mut upper: Vec<Complex> = values.iter().copied().filter(|z| z.im >= 0.0).collect();
    // The order that the printed values are named by: the fastest swing first.
    upper.sort_by(|a, b| b.im.total_cmp(&a.im).then(b.re.total_cmp(&a.re)));
    let vectors = eigenvectors(&a, &upper).ok_or("no eigenvectors")?;
    let modes: Vec<Value> = upper
        .iter()
        .enumerate()
        .map(|(j, z)| {
            let column = vectors.column(j);
            let mut largest = Complex::new(0.0, 0.0);
            for x in column.iter() {
                if x.norm() > largest.norm() {
                    largest = *x;
                }
            }
            let scale = largest.conj() / (largest.norm() * column.norm());
            json!({
                "lambda": { "re": z.re, "im": z.im },
                "abs": z.norm(),
                "two_pi_abs": std::f64::consts::TAU * z.norm(),
                "zeta": -z.re / z.norm(),
                "eigenvector": complexes(column.iter().map(|x| x * scale)),
            })
        })
        .collect();
    Ok(json!({
        "modes_with_nonnegative_imaginary_part": modes,
        "stable": values.iter().all(|z| z.re < 0.0),
        "trace": a.trace(),
    }))
}

pub fn realization(i: &Inputs<'_>) -> Result<Value, String> {
    let a = i.matrix("A")?;
    let n = a.nrows();
    let (b, c, d, dt) = (i.list("B")?, i.list("C")?, i.n("D")?, i.n("dt")?);
    let (rows, columns) = (i.n("alpha")? as usize, i.n("beta")? as usize);
    let row = DMatrix::from_row_slice(1, n, &c);
    let continuous =
        StateSpace::new(a, DMatrix::from_column_slice(n, 1, &b), row.clone(), DMatrix::from_element(1, 1, d), None)
            .map_err(text)?;
    let discrete = discretize_zero_order_hold(&continuous, dt).map_err(text)?;
    let (ad, bd) = (discrete.a.clone(), discrete.b.clone());
    // As many as the two Hankel matrices of an eigensystem realization hold: alpha + beta, and the direct one.
    let mut markov = vec![d];
    let mut state = bd.clone();
    for _ in 0..rows + columns {
        markov.push((&row * &state)[(0, 0)]);
        state = &ad * state;
    }
    let hankel = DMatrix::from_fn(rows, columns, |p, q| markov[1 + p + q]);
    let svd = jacobi_svd(&hankel).ok_or("no singular values")?;
    let rows_of = |m: &DMatrix<f64>| -> Vec<Vec<f64>> { m.row_iter().map(|r| r.iter().copied().collect()).collect() };
    Ok(json!({
        "A_discrete": rows_of(&ad),
        "B_discrete": bd.as_slice(),
        "markov_parameters": markov,
        "hankel_singular_values_first": svd.values.iter().take(n + 1).collect::<Vec<_>>(),
        "discrete_eigenvalues": complexes(eigenvalues(&ad).map_err(text)?),
    }))
}

pub fn transfer_function(i: &Inputs<'_>) -> Result<Value, String> {
    let (numerator, denominator) = (i.list("num")?, i.list("den")?);
    let model = TransferFunction::new(&numerator, &denominator).map_err(text)?;
    let poles = model.poles().map_err(text)?;
    let order = denominator.len() - 1;
    let mut companion = vec![vec![0.0; order]; order];
    for (j, c) in denominator[1..].iter().enumerate() {
        companion[0][j] = -c / denominator[0];
    }
    for j in 1..order {
        companion[j][j - 1] = 1.0;
    }
    let mut input = vec![0.0; order];
    input[0] = 1.0;
    let mut output = vec![0.0; order - numerator.len()];
    output.extend(numerator.iter().map(|c| c / denominator[0]));
    Ok(json!({
        "zeros": complexes(model.zeros().map_err(text)?),
        "poles": complexes(poles.iter().copied()),
        "dc_gain": numerator[numerator.len() - 1] / denominator[order],
        "A_companion": companion,
        "B": input,
        "C": output,
        "D": 0.0,
        "configuration": configuration(&poles),
    }))
}

pub fn exponential_sum(i: &Inputs<'_>) -> Result<Value, String> {
    let (s, c) = (i.list("s")?, i.list("C")?);
    let sum = |t: f64, power: i32| -> f64 { s.iter().zip(&c).map(|(s, c)| c * s.powi(power) * (s * t).exp()).sum() };
    let mut peak = None;
    for k in 0..20_000 {
        let (mut low, mut high) = (f64::from(k) * 1e-4, f64::from(k + 1) * 1e-4);
        if sum(low, 1) > 0.0 && sum(high, 1) <= 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if sum(middle, 1) > 0.0 { low = middle } else { high = middle }
            }
            // One Newton step more: the rate there is smooth.
            peak = Some(high - sum(high, 1) / sum(high, 2));
            break;
        }
    }
    Ok(json!({
        "x_at_0": sum(0.0, 0),
        "v_at_0": sum(0.0, 1),
        "v_at_0_kmh": 3.6 * sum(0.0, 1),
        "t_peak": peak,
        "x_peak": peak.map(|t| sum(t, 0)),
    }))
}

pub fn roots_to_coefficients(i: &Inputs<'_>) -> Result<Value, String> {
    let roots = i.poles("roots")?;
    let mut coefficients = vec![Complex::new(1.0, 0.0)];
    for root in roots {
        coefficients.push(Complex::new(0.0, 0.0));
        for k in (1..coefficients.len()).rev() {
            let below = coefficients[k - 1];
            coefficients[k] -= below * root;
        }
    }
    let real: Vec<f64> = coefficients.iter().map(|c| c.re).collect();
    // The way back must exist.
    polynomial_roots(&real).map_err(text)?;
    Ok(json!({ "coefficients_descending_monic": real }))
}
