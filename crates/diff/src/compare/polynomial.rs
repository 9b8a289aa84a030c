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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn modulus(a: &Value, b: &Value) -> Option<f64> {
        let object = |list: &Value| json!({ "denominator": list }).as_object().cloned().unwrap_or_default();
        root_modulus(&object(a), &object(b))
    }

    #[test]
    fn roots_are_as_far_from_zero_as_the_ends_of_the_denominator_say() {
        // Roots of modulus 100 and 10; 8 against 1.
        assert_eq!(modulus(&json!([1.0, 20.0, 1e4]), &json!([1.0, 20.0, 1e4])), Some(100.0));
        assert_eq!(modulus(&json!([2.0, 3.0, 200.0]), &json!([1.0, 0.0, 1e4])), Some(100.0), "the larger side");
        assert_eq!(modulus(&json!([2.0, 3.0, 200.0]), &json!([4.0, 1.0, 16.0])), Some(10.0));
        assert_eq!(modulus(&json!([-1.0, 0.0, 64.0]), &json!([1.0, 0.0, 0.0, 1.0])), Some(8.0));
        for none in [json!([1.0, 2.0, 0.0]), json!([0.0, 2.0, 1.0]), json!([]), json!(["x", 1.0]), json!(1.0)] {
            assert_eq!(modulus(&json!([1.0, 2.0]), &none), None, "{none}");
            assert_eq!(modulus(&none, &json!([1.0, 2.0])), None, "{none}");
        }
    }

    #[test]
    fn a_coefficient_is_measured_by_the_largest_term_near_the_roots() {
        let list = |x: &[f64]| x.iter().map(|x| json!(x)).collect::<Vec<Value>>();
        // 3·10², 1·10 and 20 near roots of modulus 10: the first is the largest.
        assert_eq!(scales(&list(&[3.0, 1.0, 20.0]), &list(&[-2.0, 1.0, 7.0]), 10.0), Some(vec![3.0, 30.0, 300.0]));
        assert_eq!(scales(&list(&[1.0]), &list(&[1.0, 2.0]), 10.0), None);
        assert_eq!(scales(&list(&[1.0]), &[json!("x")], 10.0), None);
    }
}
