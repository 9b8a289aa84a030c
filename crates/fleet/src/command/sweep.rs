//! Options of stages that a fleet goes through.

use std::str::FromStr;

/// An option of a stage with the values to go through.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Sweep {
    /// `parameter-solve.front_mass_fraction`.
    pub(crate) key: String,
    /// Values as they are typed.
    pub(crate) values: Vec<String>,
}

impl FromStr for Sweep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, values) = text.split_once('=').ok_or("a value is missing: STAGE.KEY=VALUE,...")?;
        let has_stage = key.split_once('.').is_some_and(|(stage, key)| !stage.is_empty() && !key.is_empty());
        if !has_stage {
            return Err(format!("{key:?} names no stage: STAGE.KEY=VALUE,..., e.g. filter.cfc=60,180"));
        }
        let values = split(values);
        if values.iter().any(String::is_empty) {
            return Err(format!("a value of {key} is empty"));
        }
        Ok(Self { key: key.to_owned(), values })
    }
}

/// Values between commas; those inside brackets and quotes belong to a value.
fn split(text: &str) -> Vec<String> {
    let mut values = vec![String::new()];
    let (mut depth, mut quote) = (0_i32, None);
    for c in text.chars() {
        match (c, quote) {
            ('"' | '\'', None) => quote = Some(c),
            (_, Some(open)) if c == open => quote = None,
            ('[', None) => depth += 1,
            (']', None) => depth -= 1,
            (',', None) if depth <= 0 => {
                values.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(value) = values.last_mut() {
            value.push(c);
        }
    }
    values.iter().map(|value| value.trim().to_owned()).collect()
}

/// All combinations of the values, the last option changing first; one without options where there are none.
pub(crate) fn combinations(sweeps: &[Sweep]) -> Vec<Vec<String>> {
    sweeps.iter().fold(vec![Vec::new()], |all, sweep| {
        let with = |one: &Vec<String>| {
            let one = one.clone();
            sweep
                .values
                .iter()
                .map(move |value| one.iter().cloned().chain([format!("{}={value}", sweep.key)]).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        };
        all.iter().flat_map(with).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_meets_every_other() {
        let sweeps: Vec<Sweep> =
            ["filter.cfc=60,180", "identify.methods=[\"era\",\"okid\"]"].map(|text| text.parse().unwrap()).into();
        let all = combinations(&sweeps);
        let methods = "identify.methods=[\"era\",\"okid\"]";
        assert_eq!(all, [["filter.cfc=60", methods], ["filter.cfc=180", methods]]);
        assert_eq!(combinations(&[]), [Vec::<String>::new()]);
    }

    #[test]
    fn an_option_needs_a_stage_and_values() {
        for text in ["cfc=60", "filter.cfc", "filter.cfc=", "filter.cfc=60,,180", ".cfc=60"] {
            assert!(text.parse::<Sweep>().is_err(), "{text}");
        }
    }
}
