//! Every kind of case: inputs in, recomputed quantities out, by the project's own libraries.

use crumple_lti::{
    Complex, StateSpace, TransferFunction, discretize_zero_order_hold, eigenvalues, eigenvectors, jacobi_svd,
    polynomial_roots,
};
use crumple_lumped::{
    Chain, CoefficientMatching, CrushEvents, DoubleSpringMassDamper, Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1,
    Nonlinear2, Reading,
};
use crumple_parameter_solve::{
    KelvinBranch, MaxwellExponents, centroid_to_crush_time_ratio, elastoplastic_from_events, front_from_amplitudes,
    kelvin_from_events, maxwell_constants, rear_from_amplitudes,
};
use nalgebra::DMatrix;
use serde_json::{Map, Value, json};

/// Inputs by name.
pub struct Inputs<'a>(pub &'a Value);

impl Inputs<'_> {
    fn n(&self, name: &str) -> Result<f64, String> {
        self.0[name].as_f64().ok_or_else(|| format!("input {name} is missing"))
    }

    fn list(&self, name: &str) -> Result<Vec<f64>, String> {
        numbers(&self.0[name]).ok_or_else(|| format!("input {name} is no list of numbers"))
    }

    fn poles(&self, name: &str) -> Result<Vec<Complex>, String> {
        let list = self.0[name].as_array().ok_or_else(|| format!("input {name} is missing"))?;
        list.iter().map(|x| complex_of(x).ok_or_else(|| format!("input {name} holds {x}"))).collect()
    }

    fn matrix(&self, name: &str) -> Result<DMatrix<f64>, String> {
        let rows = self.0[name].as_array().ok_or_else(|| format!("input {name} is missing"))?;
        let rows: Vec<Vec<f64>> = rows.iter().filter_map(numbers).collect();
        let columns = rows.first().map_or(0, Vec::len);
        if rows.iter().any(|row| row.len() != columns) {
            return Err(format!("input {name} is no matrix"));
        }
        Ok(DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]))
    }
}

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

fn complex(z: Complex) -> Value {
    if z.im == 0.0 { json!(z.re) } else { json!({ "re": z.re, "im": z.im }) }
}

fn complexes(list: impl IntoIterator<Item = Complex>) -> Value {
    Value::Array(list.into_iter().map(complex).collect())
}

/// Input that lists the instants at which a motion is asked for, s.
pub const CHECKPOINT_TIMES: &str = "checkpoint_times";

/// The recomputed quantities of a case, named as in the case files. An unknown kind is an error with its name.
pub fn evaluate(kind: &str, inputs: &Value) -> Result<Value, String> {
    let i = Inputs(inputs);
    match kind {
        "charpoly_two_mass" => charpoly_two_mass(&i),
        chain if chain.starts_with("charpoly") => charpoly_chain(&i),
        "crush" => crush(&i),
        "match" => matching(&i),
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
        "lsq_k2c2" => lsq_rear(&i),
        "lsq_k1c1" => lsq_front(&i),
        "exp_sum" => exponential_sum(&i),
        "roots_to_coefficients" => roots_to_coefficients(&i),
        unknown => Err(format!("unknown kind {unknown}")),
    }
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn double(i: &Inputs<'_>) -> Result<DoubleSpringMassDamper, String> {
    Ok(DoubleSpringMassDamper {
        m1_kg: i.n("m1")?,
        m2_kg: i.n("m2")?,
        k1_n_per_m: i.n("k1")?,
        k2_n_per_m: i.n("k2")?,
        c1_n_s_per_m: i.n("c1")?,
        c2_n_s_per_m: i.n("c2")?,
    })
}

fn configuration(poles: &[Complex]) -> Value {
    let pairs = poles.iter().filter(|p| p.im > 0.0).count();
    json!({
        "complex_pairs": pairs,
        "real_roots": poles.len() - 2 * pairs,
        "stable": poles.iter().all(|p| p.re < 0.0),
    })
}

/// The roots with those that coincide made one: `m` roots close together whose mean is a zero of the polynomial and of its
/// first `m - 1` derivatives to rounding. Such roots come apart by the m-th root of a rounding; their mean does not move.
fn settled(polynomial: &[f64], roots: &[Complex]) -> Vec<Complex> {
    let mut found = roots.to_vec();
    let mut taken = vec![false; found.len()];
    // The largest groups first.
    for size in (2..=found.len()).rev() {
        for first in 0..found.len() {
            let mut group: Vec<usize> = (0..found.len()).filter(|&k| !taken[k]).collect();
            if taken[first] || group.len() < size {
                continue;
            }
            group.sort_by(|&a, &b| (roots[a] - roots[first]).norm().total_cmp(&(roots[b] - roots[first]).norm()));
            group.truncate(size);
            let mean = group.iter().map(|&k| roots[k]).sum::<Complex>() / size as f64;
            let spread = group.iter().map(|&k| (roots[k] - mean).norm()).fold(0.0, f64::max);
            if spread > 10.0 * 1e-15_f64.powf(1.0 / size as f64) * mean.norm() {
                continue;
            }
            // Derivatives over factorials, by repeated division.
            let mut rest: Vec<Complex> = polynomial.iter().map(|c| Complex::new(*c, 0.0)).collect();
            let mut sizes: Vec<f64> = polynomial.iter().map(|c| c.abs()).collect();
            let zero = (0..size).all(|_| {
                for k in 1..rest.len() {
                    let (above, bound) = (rest[k - 1], sizes[k - 1]);
                    rest[k] += above * mean;
                    sizes[k] += bound * mean.norm();
                }
                let (value, bound) = (rest.pop().unwrap_or_default(), sizes.pop().unwrap_or_default());
                value.norm() <= 1e-13 * bound
            });
            if zero {
                // A real multiple root has no imaginary part left.
                let mean = if mean.im.abs() <= 1e-12 * mean.norm() { Complex::new(mean.re, 0.0) } else { mean };
                for k in group {
                    (found[k], taken[k]) = (mean, true);
                }
            }
        }
    }
    found
}

fn charpoly_two_mass(i: &Inputs<'_>) -> Result<Value, String> {
    let model = double(i)?;
    let [_, t, u, v, w] = model.characteristic_polynomial();
    let poles = settled(&[1.0, t, u, v, w], &model.poles().map_err(text)?);
    Ok(json!({
        "t": t, "u": u, "v": v, "w": w,
        "coefficients_descending_monic": [1.0, t, u, v, w],
        "roots": complexes(poles.iter().copied()),
        "configuration": configuration(&poles),
    }))
}

/// Masses `m1, m2, ...` with `k1, ...` and `c1, ...`, or lists `m`, `k`, `c`.
fn chain(i: &Inputs<'_>) -> Result<Chain, String> {
    let list = |name: &str| -> Result<Vec<f64>, String> {
        let word = match name {
            "m" => "masses",
            "k" => "stiffnesses",
            _ => "dampings",
        };
        for key in [name.to_owned(), format!("{name}s"), format!("{name}_values"), word.to_owned()] {
            if i.0[&key].is_array() {
                return i.list(&key);
            }
        }
        Ok((1..).map_while(|k| i.n(&format!("{name}{k}")).ok()).collect())
    };
    Chain::new(&list("m")?, &list("k")?, &list("c")?).map_err(text)
}

fn charpoly_chain(i: &Inputs<'_>) -> Result<Value, String> {
    let chain = chain(i)?;
    let coefficients = chain.characteristic_polynomial();
    let poles = settled(&coefficients, &chain.poles().map_err(text)?);
    let mut found = Map::new();
    for (k, c) in coefficients.iter().enumerate() {
        found.insert(format!("a{}", coefficients.len() - 1 - k), json!(c));
    }
    found.insert("coefficients_descending_monic".to_owned(), json!(coefficients));
    found.insert("coefficients".to_owned(), json!(coefficients));
    found.insert("roots".to_owned(), complexes(poles.iter().copied()));
    found.insert("poles".to_owned(), complexes(poles.iter().copied()));
    found.insert("configuration".to_owned(), configuration(&poles));
    Ok(Value::Object(found))
}

fn crush(i: &Inputs<'_>) -> Result<Value, String> {
    let v0 = i.n("v0")?;
    let until = i.n("T").unwrap_or(2.0);
    let mut found = Map::new();
    let events: Vec<CrushEvents> = if i.n("m3").is_ok() || i.0["m"].is_array() || i.0["masses"].is_array() {
        let chain = chain(i)?;
        let poles = settled(&chain.characteristic_polynomial(), &chain.poles().map_err(text)?);
        found.insert("roots".to_owned(), complexes(poles.iter().copied()));
        found.insert("configuration".to_owned(), configuration(&poles));
        chain.events(v0, until).map_err(text)?
    } else {
        let model = double(i)?;
        let poles = settled(&model.characteristic_polynomial(), &model.poles().map_err(text)?);
        found.insert("roots".to_owned(), complexes(poles.iter().copied()));
        found.insert("configuration".to_owned(), configuration(&poles));
        model.events(v0).map_err(text)?.to_vec()
    };
    for (k, event) in events.iter().enumerate() {
        let within = event.time_of_dynamic_crush_s.filter(|t| *t <= until);
        found.insert(format!("t_m{}", k + 1), json!(within));
        found.insert(format!("C{}", k + 1), json!(event.dynamic_crush_m.filter(|_| within.is_some())));
    }
    found.insert("searched_until_s".to_owned(), json!(until));
    Ok(Value::Object(found))
}

fn matching(i: &Inputs<'_>) -> Result<Value, String> {
    let (m1, m2) = (i.n("m1")?, i.n("m2")?);
    let matching = if i.0["roots"].is_array() {
        let poles: [Complex; 4] = i.poles("roots")?.try_into().map_err(|_| "four roots are needed".to_owned())?;
        CoefficientMatching::from_poles(&poles, m1, m2, Reading::Decimal)
    } else {
        // A right-hand side typed otherwise than m1 m2 t.
        let t = i.n("P").map_or_else(|_| i.n("t"), |p| Ok(p / (m1 * m2)))?;
        CoefficientMatching::new([t, i.n("u")?, i.n("v")?, i.n("w")?], m1, m2, Reading::Decimal)
    }
    .map_err(text)?;
    let found = matching.solve();
    let count = |which: &dyn Fn(&crumple_lumped::MatchedSolution) -> bool| -> usize {
        found.solutions.iter().filter(|s| which(s)).map(|s| s.multiplicity).sum()
    };
    // q = m2 (m1 + m2) c1 c2.
    let to_q = m2 * (m1 + m2) * m1 * m2;
    let roots = found.roots.iter().flat_map(|r| std::iter::repeat_n(r.zeta * to_q, r.multiplicity));
    let solutions: Vec<Value> = found
        .solutions
        .iter()
        .map(|s| {
            json!({
                "k1": complex(s.k1_n_per_m), "k2": complex(s.k2_n_per_m),
                "c1": complex(s.c1_n_s_per_m), "c2": complex(s.c2_n_s_per_m),
                "real": s.real, "physical": s.physical, "multiplicity": s.multiplicity,
                "zero_minus_k2_over_c2": s.zero().map(complex),
            })
        })
        .collect();
    Ok(json!({
        "cubic_in_q_roots": complexes(roots),
        "n_solutions_with_multiplicity": count(&|_| true),
        "n_solutions_distinct": found.solutions.len(),
        "n_real_with_multiplicity": count(&|s| s.real),
        "n_real_distinct": found.solutions.iter().filter(|s| s.real).count(),
        "n_physical_with_multiplicity": count(&|s| s.physical),
        "n_physical_distinct": found.solutions.iter().filter(|s| s.physical).count(),
        "largest_mass_ratio": found.largest_mass_ratio,
        "max_relative_residual": found.solutions.iter().map(|s| s.residual).fold(0.0, f64::max),
        "solutions": solutions,
    }))
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

fn elastoplastic(i: &Inputs<'_>) -> Result<Value, String> {
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
    let (k, c) = maxwell_constants(i.n("m")?, exponents);
    Ok(json!({ "k": k, "c": c }))
}

fn maxwell(i: &Inputs<'_>) -> Result<Value, String> {
    let (m, k, c, v0) = (i.n("m")?, i.n("k")?, i.n("c")?, i.n("v0")?);
    let model = Maxwell { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: c };
    model.check().map_err(text)?;
    let a = -0.5 * k / c;
    let square = k / m - a * a;
    let b = square.abs().sqrt();
    let rest = m * v0 / c;
    let e = model.events(v0);
    Ok(json!({
        "a": a,
        "b": b,
        "kind": if square > 0.0 { "imaginary" } else { "real" },
        "x_inf": rest,
        "C1": rest,
        "C2": -rest,
        "C3": (v0 + a * rest) / b,
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

fn quotient(i: &Inputs<'_>) -> Result<Value, String> {
    let (product, target) = (i.n("a")? * i.n("b")?, i.n("m1")? * i.n("m2")? * i.n("w")?);
    Ok(json!({ "product": product, "target": target, "ratio": product / target }))
}

fn eig(i: &Inputs<'_>) -> Result<Value, String> {
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

fn realization(i: &Inputs<'_>) -> Result<Value, String> {
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
        "markov_parameters": markov[..21.min(markov.len())],
        "hankel_singular_values_first": svd.values.iter().take(n + 1).collect::<Vec<_>>(),
        "discrete_eigenvalues": complexes(eigenvalues(&ad).map_err(text)?),
    }))
}

fn transfer_function(i: &Inputs<'_>) -> Result<Value, String> {
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

fn lsq_rear(i: &Inputs<'_>) -> Result<Value, String> {
    let (k2, c2) = rear_from_amplitudes(&i.list("s")?, &i.list("C")?, i.n("m2")?);
    Ok(json!({ "k2": k2, "c2": c2 }))
}

fn lsq_front(i: &Inputs<'_>) -> Result<Value, String> {
    let (s, m1, m2) = (i.list("s")?, i.n("m1")?, i.n("m2")?);
    let rear = rear_from_amplitudes(&s, &i.list("C")?, m2);
    let (k1, c1) = front_from_amplitudes(&s, m1, m2, rear);
    Ok(json!({ "k1": k1, "c1": c1, "k2": rear.0, "c2": rear.1 }))
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

fn roots_to_coefficients(i: &Inputs<'_>) -> Result<Value, String> {
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
