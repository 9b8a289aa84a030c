//! State spaces, transfer functions, sums of exponentials, polynomials.

use crumple_lumped::{Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2};
use crumple_lumped_fit::{
    KelvinBranch, MaxwellExponents, centroid_to_crush_time_ratio, elastoplastic_from_events, kelvin_from_events,
};
use crumple_numerics::linalg::jacobi_svd;
use crumple_numerics::lti::{
    Complex, StateSpace, TransferFunction, discretize_zero_order_hold, eigenvalues, eigenvectors, polynomial_roots,
};
use nalgebra::DMatrix;
use serde_json::{Value, json};

use crate::papers::chains;
use crate::papers::chains::configuration;

fn quotient(i: &Inputs<'_>) -> Result<Value, String> {
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

fn exponential_sum(i: &Inputs<'_>) -> Result<Value, String> {
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

fn kelvin_curve(i: &Inputs<'_>) -> Result<Value, String> {
    let zeta = i.n("zeta")?;
    let unit = Kelvin { mass_kg: 1.0, stiffness_n_per_m: 1.0, damping_n_s_per_m: 2.0 * zeta };
    let events = unit.events(1.0);
    Ok(json!({
        "tau_m": events.time_of_dynamic_crush_s,
        "tau_c": events.dynamic_crush_m,
        "ratio": centroid_to_crush_time_ratio(zeta),
    }))
}

fn kelvin_invert(i: &Inputs<'_>) -> Result<Value, String> {
    let solution = kelvin_from_events(1.0, 1.0, 1.0, i.n("ratio")?).map_err(text)?;
    let solvable = !matches!(solution.branch, KelvinBranch::UndampedReduction { .. });
    Ok(json!({ "zeta": solvable.then_some(solution.damping_ratio), "solvable": solvable }))
}

fn kelvin_identify(i: &Inputs<'_>) -> Result<Value, String> {
    let (v0, crush, t_m) = (i.n("v0")?, i.n("C")?, i.n("t_m")?);
    let solution = kelvin_from_events(i.n("m")?, v0, t_m, crush).map_err(text)?;
    let (branch, used) = match solution.branch {
        KelvinBranch::Underdamped => ("underdamped", t_m),
        KelvinBranch::Overdamped => ("overdamped", t_m),
        KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s: t } => ("undamped_fallback", t),
    };
    Ok(json!({
        "t_c": crush / v0,
        "ratio": solution.time_ratio,
        "branch": branch,
        "zeta": solution.damping_ratio,
        "t_m_used": used,
        "omega_e": solution.natural_frequency_rad_per_s,
        "k": solution.model.stiffness_n_per_m,
        "c": solution.model.damping_n_s_per_m,
    }))
}

fn kelvin_response(i: &Inputs<'_>) -> Result<Value, String> {
    let v0 = i.n("v0")?;
    let model = Kelvin { mass_kg: i.n("m")?, stiffness_n_per_m: i.n("k")?, damping_n_s_per_m: i.n("c")? };
    let e = model.events(v0);
    let t_c = e.dynamic_crush_m.map(|c| c / v0);
    Ok(json!({
        "omega_e": model.natural_frequency_rad_per_s(),
        "zeta": model.damping_ratio(),
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "t_c": t_c,
        "ratio": t_c.zip(e.time_of_dynamic_crush_s).map(|(c, m)| c / m),
        "a_at_0_plus": model.state(v0, 0.0).acceleration_m_per_s2 + 0.0,
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
    }))
}

pub fn elastoplastic(i: &Inputs<'_>) -> Result<Value, String> {
    let (m, v0, crush) = (i.n("m")?, i.n("v0")?, i.n("C")?);
    let model: Elastoplastic = elastoplastic_from_events(m, v0, crush, i.n("v_rebound")? / v0).map_err(text)?;
    let e = model.events(v0);
    let (loading, unloading) = (model.loading_stiffness_n_per_m, model.unloading_stiffness_n_per_m);
    Ok(json!({
        "COR": model.coefficient_of_restitution(),
        "k_E": loading,
        "k_P": unloading,
        "d_e": crush * loading / unloading,
        "F_max": loading * crush,
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "omega_P": (unloading / m).sqrt(),
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
        "permanent_set": model.permanent_set_m(v0),
    }))
}

fn maxwell_printed(i: &Inputs<'_>) -> Result<Value, String> {
    let (a, b) = (i.n("a")?, i.n("b")?);
    let exponents = if i.0["root_type"] == "real" {
        MaxwellExponents::Real { a_per_s: a, b_per_s: b }
    } else {
        MaxwellExponents::Complex { a_per_s: a, b_rad_per_s: b }
    };
    let (k, c) = exponents.constants(i.n("m")?);
    Ok(json!({ "k": k, "c": c }))
}

pub fn maxwell(i: &Inputs<'_>) -> Result<Value, String> {
    let (m, k, c, v0) = (i.n("m")?, i.n("k")?, i.n("c")?, i.n("v0")?);
    let model = Maxwell { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: c };
    model.check().map_err(text)?;
    let a = -0.5 * k / c;
    let square = k / m - a * a;
    let b = square.abs().sqrt();
    let rest = m * v0 / c;
    // x = C1 + e^(a t) (C2 cos b t + C3 sin b t), or C1 + C2 e^((a+b) t) + C3 e^((a-b) t) for real exponents; at the
    // start x = 0, x' = v0, x'' = 0.
    let swing = (v0 + a * rest) / b;
    let (c2, c3) = if square > 0.0 { (-rest, swing) } else { (0.5 * (swing - rest), -0.5 * (swing + rest)) };
    let e = model.events(v0);
    Ok(json!({
        "a": a,
        "b": b,
        "kind": if square > 0.0 { "imaginary" } else { "real" },
        "x_inf": rest,
        "C1": rest,
        "C2": c2,
        "C3": c3,
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
    }))
}

fn nonlinear(i: &Inputs<'_>) -> Result<Value, String> {
    let (mass_kg, v0, end) = (i.n("m")?, i.n("v0")?, i.n("T")?);
    let (kx, k, cv, c) = (i.list("k_knots")?, i.list("k_values")?, i.list("c_knots")?, i.list("c_values")?);
    let model = match (&kx[..], &k[..], &cv[..], &c[..]) {
        ([_, crush], [k1, k2], [_, knee, last], [c1, c2, c3]) => Model::Nonlinear1(Nonlinear1 {
            mass_kg,
            k1_n_per_m: *k1,
            k2_n_per_m: *k2,
            c1_n_s_per_m: *c1,
            c2_n_s_per_m: *c2,
            c3_n_s_per_m: *c3,
            v_thresh_m_per_s: *knee,
            crush_m: *crush,
            v0_m_per_s: *last,
        }),
        ([_, x1, crush], [k1, k2, k3], [_, v1, v2, last], [c1, c2, c3, c4]) => Model::Nonlinear2(Nonlinear2 {
            mass_kg,
            k1_n_per_m: *k1,
            k2_n_per_m: *k2,
            k3_n_per_m: *k3,
            x1_m: *x1,
            c1_n_s_per_m: *c1,
            c2_n_s_per_m: *c2,
            c3_n_s_per_m: *c3,
            c4_n_s_per_m: *c4,
            v1_m_per_s: *v1,
            v2_m_per_s: *v2,
            crush_m: *crush,
            v0_m_per_s: *last,
        }),
        _ => return Err("no nonlinear model has so many knots".to_owned()),
    };
    let e = model.events(v0).map_err(text)?;
    // One step to each instant asked for: the series know no grid.
    let at = |t: f64| -> Result<(f64, f64, f64), String> {
        let response = model.respond(v0, t, 2).map_err(text)?;
        let motion = response.compartment();
        Ok((motion.displacement_m[1], motion.velocity_m_per_s[1], motion.acceleration_m_per_s2[1]))
    };
    let times = if i.0[CHECKPOINT_TIMES].is_array() { i.list(CHECKPOINT_TIMES)? } else { Vec::new() };
    let checkpoints: Vec<Value> = times
        .into_iter()
        .map(|t| at(t).map(|(x, v, a)| json!({ "t": t, "x": x, "v": v, "a": a })))
        .collect::<Result<_, _>>()?;
    let (x_end, v_end, _) = at(end)?;
    let mut found = json!({
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
        "x_at_T": x_end,
        "v_at_T": v_end,
        "checkpoints": checkpoints,
        "t_c": e.dynamic_crush_m.map(|c| c / v0),
    });
    if let Ok(dt) = i.n("euler_dt") {
        found["euler_first_nonpositive_v"] = euler(mass_kg, v0, dt, (&kx, &k), (&cv, &c));
    }
    Ok(found)
}

/// The explicit integration a paper's figures were made with: where its velocity is first not positive.
fn euler(m: f64, v0: f64, dt: f64, spring: (&[f64], &[f64]), damper: (&[f64], &[f64])) -> Value {
    let curve = |(knots, values): (&[f64], &[f64]), x: f64| {
        let j = knots.partition_point(|k| *k <= x).clamp(1, knots.len() - 1);
        let share = ((x - knots[j - 1]) / (knots[j] - knots[j - 1])).clamp(0.0, 1.0);
        values[j - 1] + share * (values[j] - values[j - 1])
    };
    let (mut x, mut v) = (0.0, v0);
    for step in 1..100_000 {
        let a = -(curve(spring, f64::abs(x)) * x + curve(damper, f64::abs(v)) * v) / m;
        (x, v) = (x + dt * v, v + dt * a);
        if v <= 0.0 {
            return json!({ "step": step, "t": f64::from(step) * dt, "x": x });
        }
    }
    Value::Null
}

fn firefly(i: &Inputs<'_>) -> Result<Value, String> {
    let length = i.list("lower")?.iter().zip(i.list("upper")?).map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt();
    let gamma = length.sqrt().recip();
    let delta = 0.5_f64.powf(1.0 / 500.0);
    Ok(json!({
        "delta": delta,
        "L": length,
        "gamma": gamma,
        "gamma_L_squared": gamma * length * length,
        "log10_attractiveness_at_L": -gamma * length * length * std::f64::consts::LOG10_E,
        "alpha_after_500": i.n("alpha0")? * delta.powi(500),
    }))
}

/// Inputs by name.
pub struct Inputs<'a>(pub &'a Value);

impl Inputs<'_> {
    pub fn n(&self, name: &str) -> Result<f64, String> {
        self.0[name].as_f64().ok_or_else(|| format!("input {name} is missing"))
    }

    pub fn list(&self, name: &str) -> Result<Vec<f64>, String> {
        numbers(&self.0[name]).ok_or_else(|| format!("input {name} is no list of numbers"))
    }

    pub fn poles(&self, name: &str) -> Result<Vec<Complex>, String> {
        let list = self.0[name].as_array().ok_or_else(|| format!("input {name} is missing"))?;
        list.iter().map(|x| complex_of(x).ok_or_else(|| format!("input {name} holds {x}"))).collect()
    }

    pub fn matrix(&self, name: &str) -> Result<DMatrix<f64>, String> {
        let rows = self.0[name].as_array().ok_or_else(|| format!("input {name} is missing"))?;
        let rows: Vec<Vec<f64>> = rows.iter().filter_map(numbers).collect();
        let columns = rows.first().map_or(0, Vec::len);
        if rows.iter().any(|row| row.len() != columns) {
            return Err(format!("input {name} is no matrix"));
        }
        Ok(DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]))
    }
}

/// Input that lists the instants at which a motion is asked for, s.
pub const CHECKPOINT_TIMES: &str = "checkpoint_times";

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

/// A number or `{re, im}`.
pub fn complex_of(value: &Value) -> Option<Complex> {
    match value.as_f64() {
        Some(re) => Some(Complex::new(re, 0.0)),
        None => Some(Complex::new(value["re"].as_f64()?, value["im"].as_f64()?)),
    }
}

pub fn complex(z: Complex) -> Value {
    if z.im == 0.0 { json!(z.re) } else { json!({ "re": z.re, "im": z.im }) }
}

pub fn complexes(list: impl IntoIterator<Item = Complex>) -> Value {
    Value::Array(list.into_iter().map(complex).collect())
}

pub fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// The recomputed quantities of a case, named as in the case files. An unknown kind is an error with its name.
pub fn evaluate(kind: &str, inputs: &Value) -> Result<Value, String> {
    let i = Inputs(inputs);
    match kind {
        "charpoly_two_mass" => chains::charpoly_two_mass(&i),
        chain if chain.starts_with("charpoly") => chains::charpoly_chain(&i),
        "crush" => chains::crush(&i),
        "match" => chains::matching(&i),
        "kelvin_curve" => kelvin_curve(&i),
        "kelvin_invert" => kelvin_invert(&i),
        "kelvin_identify" => kelvin_identify(&i),
        "kelvin_response" => kelvin_response(&i),
        "elastoplastic" => elastoplastic(&i),
        "maxwell_constants" => maxwell_printed(&i),
        "maxwell" => maxwell(&i),
        "nonlinear" => nonlinear(&i),
        "firefly_constants" => firefly(&i),
        "quotient" => quotient(&i),
        "eig" => eig(&i),
        "realization" => realization(&i),
        "transfer_function" => transfer_function(&i),
        "lsq_k2c2" => chains::lsq_rear(&i),
        "lsq_k1c1" => chains::lsq_front(&i),
        "exp_sum" => exponential_sum(&i),
        "roots_to_coefficients" => roots_to_coefficients(&i),
        unknown => Err(format!("unknown kind {unknown}")),
    }
}
