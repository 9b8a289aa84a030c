//! Whether what was found is what is expected, number by number.

use serde_json::Value;

#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    pub relative: f64,
    pub absolute: f64,
}

impl Tolerance {
    fn holds(self, expected: f64, found: f64) -> bool {
        (found - expected).abs() <= self.relative * expected.abs() + self.absolute
    }
}

/// Every value that is expected; what is found beside is not asked for.
pub fn values(expected: &Value, found: &Value, path: &str, tolerance: Tolerance) -> Result<(), String> {
    match (expected, found) {
        (Value::Object(wanted), Value::Object(found)) => wanted.iter().try_for_each(|(name, value)| {
            let path = format!("{path}.{name}");
            let found = found.get(name).ok_or_else(|| format!("{path} is not known"))?;
            values(value, found, &path, tolerance)
        }),
        (Value::Array(wanted), Value::Array(found)) => {
            if wanted.len() != found.len() {
                return Err(format!("{path} has {} entries, expected {}", found.len(), wanted.len()));
            }
            let mut pairs = wanted.iter().zip(found).enumerate();
            pairs.try_for_each(|(i, (wanted, found))| values(wanted, found, &format!("{path}[{i}]"), tolerance))
        }
        (Value::Number(wanted), Value::Number(got)) => {
            let (wanted, got) = (wanted.as_f64().unwrap(), got.as_f64().unwrap());
            let apart = || format!("{path} is {got:e}, expected {wanted:e}, apart by {:e}", got - wanted);
            tolerance.holds(wanted, got).then_some(()).ok_or_else(apart)
        }
        _ if expected == found => Ok(()),
        _ => Err(format!("{path} is {found}, expected {expected}")),
    }
}

/// The same events at the same times; those of one instant in any order.
pub fn events(expected: &Value, found: &Value, tolerance: Tolerance) -> Result<(), String> {
    let (wanted, found) = (expected.as_array().unwrap(), found.as_array().unwrap());
    let mut left: Vec<&Value> = found.iter().collect();
    for event in wanted {
        let time = event["time_s"].as_f64().ok_or("event without a time")?;
        let is_it = |other: &&Value| {
            tolerance.holds(time, other["time_s"].as_f64().unwrap())
                && other["element"] == event["element"]
                && other["what"] == event["what"]
        };
        match left.iter().position(is_it) {
            Some(place) => drop(left.remove(place)),
            None => return Err(format!("event {event} does not happen; left: {left:?}")),
        }
    }
    match left.first() {
        Some(event) => Err(format!("event {event} is not expected")),
        None => Ok(()),
    }
}
