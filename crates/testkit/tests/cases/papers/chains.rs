//! Chains of masses: characteristic polynomials, dynamic crush, coefficient matching, least squares of the curve fit.

use crumple_lumped::{Chain, CoefficientMatching, CrushEvents, DoubleSpringMassDamper, Reading};
use crumple_lumped_fit::{front_from_amplitudes, rear_from_amplitudes};
use crumple_numerics::lti::Complex;
use serde_json::{Map, Value, json};

use crate::papers::systems::{Inputs, complex, complexes, text};

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

pub fn configuration(poles: &[Complex]) -> Value {
    let pairs = poles.iter().filter(|p| p.im > 0.0).count();
    json!({
        "complex_pairs": pairs,
        "real_roots": poles.len() - 2 * pairs,
        "stable": poles.iter().all(|p| p.re < 0.0),
    })
}

/// The roots with those that coincide made one: `m` roots close together whose mean is a zero of the polynomial and of
/// its first `m - 1` derivatives to rounding. Such roots come apart by the m-th root of a rounding; their mean does not
/// move.
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

pub fn charpoly_two_mass(i: &Inputs<'_>) -> Result<Value, String> {
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
    Chain::with_constants(&list("m")?, &list("k")?, &list("c")?).map_err(text)
}

pub fn charpoly_chain(i: &Inputs<'_>) -> Result<Value, String> {
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

pub fn crush(i: &Inputs<'_>) -> Result<Value, String> {
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
        model.events(v0).map_err(text)?
    };
    for (k, event) in events.iter().enumerate() {
        let within = event.time_of_dynamic_crush_s.filter(|t| *t <= until);
        found.insert(format!("t_m{}", k + 1), json!(within));
        found.insert(format!("C{}", k + 1), json!(event.dynamic_crush_m.filter(|_| within.is_some())));
    }
    found.insert("searched_until_s".to_owned(), json!(until));
    Ok(Value::Object(found))
}

pub fn matching(i: &Inputs<'_>) -> Result<Value, String> {
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

pub fn lsq_rear(i: &Inputs<'_>) -> Result<Value, String> {
    let (k2, c2) = rear_from_amplitudes(&i.list("s")?, &i.list("C")?, i.n("m2")?);
    Ok(json!({ "k2": k2, "c2": c2 }))
}

pub fn lsq_front(i: &Inputs<'_>) -> Result<Value, String> {
    let (s, m1, m2) = (i.list("s")?, i.n("m1")?, i.n("m2")?);
    let rear = rear_from_amplitudes(&s, &i.list("C")?, m2);
    let (k1, c1) = front_from_amplitudes(&s, m1, m2, rear);
    Ok(json!({ "k1": k1, "c1": c1, "k2": rear.0, "c2": rear.1 }))
}
