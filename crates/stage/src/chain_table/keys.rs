//! Tables of a pipeline file that a stage reads key by key, since a flag could not state them.

use std::fmt::Display;
use std::str::FromStr;

use toml::{Table, Value};

use crate::error::{Usage, unknown_name};

/// The table at a place of the pipeline file; `expected` says what should stand there.
pub fn table_at<'a>(place: &str, value: &'a Value, expected: &str) -> anyhow::Result<&'a Table> {
    value.as_table().ok_or_else(|| Usage::new(format!("{place} is no table, expected {expected}")).into())
}

/// Refuses a key that is not known, with the nearest that is.
pub fn check_keys(place: &str, table: &Table, known: &[&str]) -> anyhow::Result<()> {
    match table.keys().find(|key| !known.contains(&key.as_str())) {
        Some(key) => Err(unknown_name(&format!("{place}: unknown key {key:?}"), key, known)),
        None => Ok(()),
    }
}

/// A value with its unit; a bare number is asked back.
pub fn typed<T: FromStr<Err: Display>>(place: &str, value: &Value) -> anyhow::Result<T> {
    let text = match value {
        Value::String(text) => text.clone(),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => number.to_string(),
        _ => return Err(Usage::new(format!("{place}: expected a number with its unit in quotes")).into()),
    };
    text.parse().map_err(|error| Usage::new(format!("{place}: {error}")).into())
}

/// Refuses a name that cannot stand in a topic.
pub fn check_name(place: &str, name: &str) -> anyhow::Result<()> {
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_') {
        let problem = format!("{place}: the name of a chain has letters, digits, - and _ only: it stands in topics");
        return Err(Usage::new(problem).into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crumple_signal::value::Mass;

    use super::*;

    #[test]
    fn a_value_is_read_with_its_unit_and_a_bare_number_is_asked_for_one() {
        let read = |value: Value| typed::<Mass>("place", &value).map(Mass::si).map_err(|error| error.to_string());
        assert_eq!(read(Value::from("1.5 t")), Ok(1500.0));
        for bare in [Value::from(1500), Value::from(1500.5)] {
            let refused = read(bare.clone()).unwrap_err();
            assert!(refused.starts_with("place: ") && refused.contains(&format!("\"{bare}\"")), "{refused}");
        }
        assert_eq!(read(Value::from(true)), Err("place: expected a number with its unit in quotes".to_owned()));
    }

    #[test]
    fn a_name_that_stands_in_topics_has_letters_digits_and_two_signs() {
        for good in ["a", "two-mass_2", "9"] {
            assert!(check_name("place", good).is_ok(), "{good}");
        }
        for bad in ["", "a/b", "a b", "ä", "a."] {
            assert!(check_name("place", bad).is_err(), "{bad}");
        }
    }
}
