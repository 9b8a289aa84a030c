//! Coefficients of a transfer function: numbers of different units in one list.
//!
//! A coefficient's rounding error is measured by its effect on the value of the polynomial near its roots: with roots
//! of modulus w, `c_p s^p` is compared with the largest of all `|c_q| w^q`.

use serde_json::{Map, Value};

fn numbers(value: Option<&Value>) -> Option<Vec<f64>> {
    value?.as_array()?.iter().map(Value::as_f64).collect()
}

/// Geometric mean of the moduli of the denominator's roots, `|d_0 / d_n|^(1/n)`, the larger of both sides; `None` if
/// there are none away from zero.
pub(crate) fn root_modulus(a: &Map<String, Value>, b: &Map<String, Value>) -> Option<f64> {
    let mean = |object: &Map<String, Value>| {
        let denominator = numbers(object.get("denominator"))?;
        let (first, last) = (denominator.first()?, denominator.last()?);
        let modulus = (last / first).abs().powf(1.0 / (denominator.len() - 1) as f64);
        (modulus.is_finite() && modulus > 0.0).then_some(modulus)
    };
    Some(mean(a)?.max(mean(b)?))
}

/// The scale of each coefficient, highest power first; `None` if the lists are not numbers of equal count.
pub(crate) fn scales(a: &[Value], b: &[Value], modulus: f64) -> Option<Vec<f64>> {
    if a.len() != b.len() {
        return None;
    }
    let power = |k: usize| modulus.powf((a.len() - 1 - k) as f64);
    let mut most = 0.0_f64;
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        most = most.max(a.as_f64()?.abs().max(b.as_f64()?.abs()) * power(k));
    }
    Some((0..a.len()).map(|k| most / power(k)).collect())
}
