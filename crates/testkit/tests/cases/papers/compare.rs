//! Recomputed against expected, by relative tolerance.

use crumple_numerics::lti::Complex;
use serde_json::Value;

use crate::papers::systems::complex_of;

/// Lists whose order means nothing.
const UNORDERED: [&str; 7] = [
    "roots",
    "poles",
    "zeros",
    "discrete_eigenvalues",
    "cubic_in_q_roots",
    "solutions",
    "modes_with_nonnegative_imaginary_part",
];
/// Lists whose entries are compared with the largest of them: sampled responses and matrices.
const ONE_SCALE: [&str; 7] = [
    "A_discrete",
    "B_discrete",
    "markov_parameters",
    "hankel_singular_values_first",
    "eigenvector",
    "A_companion",
    "coefficients_by_scale",
];

/// A case file's value without its decimals: `{value, digits}`, `{value}` and `{re, im, digits}` become plain numbers.
pub fn plain(value: &Value) -> Value {
    match value {
        Value::Object(map) if map.contains_key("value") && (map.contains_key("digits") || map.len() == 1) => {
            map["value"].clone()
        }
        Value::Object(map) => map.iter().filter(|(k, _)| *k != "digits").map(|(k, v)| (k.clone(), plain(v))).collect(),
        Value::Array(list) => list.iter().map(plain).collect(),
        other => other.clone(),
    }
}

/// The first difference, as a path and both values; `None` where all of `expected` is met.
pub fn difference(expected: &Value, found: &Value, tolerance: f64) -> Option<String> {
    walk("", "", expected, found, tolerance, None)
}

fn walk(path: &str, key: &str, expected: &Value, found: &Value, tolerance: f64, scale: Option<f64>) -> Option<String> {
    let differs = || Some(format!("{path}: {found} instead of {expected}"));
    if let (Some(a), Some(b)) = (complex_of(expected), complex_of(found)) {
        let size = scale.unwrap_or(0.0).max(a.norm());
        let allowed = if size > 0.0 { tolerance * size } else { tolerance };
        return if (a - b).norm() <= allowed { None } else { differs() };
    }
    match (expected, found) {
        (Value::Object(wanted), Value::Object(has)) => wanted.iter().find_map(|(name, value)| {
            let here = format!("{path}.{name}");
            // A bound of the reference's own residual, stated in its fifty digits: ours is that of rounded results.
            if name == "max_relative_residual_below" {
                let residual = has.get("max_relative_residual").and_then(Value::as_f64).unwrap_or(f64::INFINITY);
                return (residual > 1e-15).then(|| format!("{here}: residual {residual:e}"));
            }
            match has.get(name) {
                Some(found) => walk(&here, name, value, found, tolerance, None),
                None => Some(format!("{here} is not recomputed")),
            }
        }),
        (Value::Array(wanted), Value::Array(has)) => {
            // Equal solutions stand side by side in one list, and once with their multiplicity in the other.
            let (wanted, has) =
                if wanted.len() == has.len() { (wanted.clone(), has.clone()) } else { (counted(wanted), counted(has)) };
            if wanted.len() != has.len() {
                return Some(format!("{path}: {} entries instead of {}", has.len(), wanted.len()));
            }
            let scale = ONE_SCALE.contains(&key).then(|| largest(expected)).or(scale);
            if !UNORDERED.contains(&key) {
                let pairs = wanted.iter().zip(&has).enumerate();
                return pairs.map(|(k, (a, b))| (format!("{path}[{k}]"), a, b)).find_map(|(here, a, b)| {
                    let key = if key == "eigenvector" { "" } else { key };
                    walk(&here, key, a, b, tolerance, scale)
                });
            }
            let mut left: Vec<&Value> = has.iter().collect();
            for (k, a) in wanted.iter().enumerate() {
                let here = format!("{path}[{k}]");
                match left.iter().position(|b| walk(&here, "", a, b, tolerance, scale).is_none()) {
                    Some(place) => {
                        left.remove(place);
                    }
                    None => {
                        let nearest = left.iter().min_by(|x, y| distance(a, x).total_cmp(&distance(a, y)))?;
                        return walk(&here, "", a, nearest, tolerance, scale)
                            .or_else(|| Some(format!("{here}: no partner")));
                    }
                }
            }
            None
        }
        _ => (expected != found).then(differs).flatten(),
    }
}

/// The entries as often as they count. A list whose entries repeat gives each a multiplicity of 1, or none.
fn counted(list: &[Value]) -> Vec<Value> {
    let entries = list.iter().flat_map(|entry| {
        let times = entry["multiplicity"].as_u64().unwrap_or(1) as usize;
        std::iter::repeat_n(entry.clone(), times)
    });
    entries.map(without_multiplicity).collect()
}

fn without_multiplicity(mut entry: Value) -> Value {
    if let Some(map) = entry.as_object_mut() {
        map.remove("multiplicity");
    }
    entry
}

fn largest(value: &Value) -> f64 {
    match value {
        Value::Array(list) => list.iter().map(largest).fold(0.0, f64::max),
        other => complex_of(other).map_or(0.0, Complex::norm),
    }
}

/// How far apart two entries of a list are, to name the likeliest partner of one that has none.
fn distance(a: &Value, b: &Value) -> f64 {
    if let (Some(a), Some(b)) = (complex_of(a), complex_of(b)) {
        return (a - b).norm();
    }
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            a.iter().filter_map(|(k, v)| Some(distance(v, b.get(k)?))).filter(|d| d.is_finite()).sum()
        }
        _ => f64::INFINITY,
    }
}
