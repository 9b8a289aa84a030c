//! Inputs of a case by name, and numbers as the case files write them.

use crumple_numerics::lti::Complex;
use nalgebra::DMatrix;
use serde_json::{Value, json};

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
