//! `[parameter-solve.chain.<name>]`: a chain of masses of which some numbers are to be found.

use std::fmt::Display;
use std::str::FromStr;

use crumple_parameter_solve::{Stated, StatedChain, StatedElement, StatedMass};
use crumple_signal::value::{Damping, Length, Mass, Speed, Stiffness};
use crumple_stage::{Usage, check_keys, check_name, table_at, typed};
use serde::Serialize;
use toml::Value;

const CHAIN_KEYS: [&str; 1] = ["masses"];
const MASS_KEYS: [&str; 4] = ["name", "mass", "stiffness", "damping"];
const BOUND_KEYS: [&str; 3] = ["start", "lower", "upper"];

const EXAMPLE: &str = "masses = [{ name = \"engine\", mass = \"200 kg\", stiffness = \"free\", damping = { start = \"8 kN*s/m\" } }, \
                       { mass = \"rest\", stiffness = \"900 kN/m\" }], from the barrier on";

/// A chain to be fitted, in SI.
#[derive(Debug, Clone, Serialize)]
pub struct FittedChain {
    pub name: String,
    /// Names of the masses, from the barrier on.
    pub masses: Vec<String>,
    pub elements: Vec<StatedElement>,
}

impl FittedChain {
    /// Reads the table; whether its numbers make sense together is seen when the total mass is known.
    pub fn read(name: &str, table: &Value) -> anyhow::Result<Self> {
        let place = format!("[parameter-solve.chain.{name}]");
        check_name(&place, name)?;
        let table = table_at(&place, table, "[parameter-solve.chain.car] with masses = [...]")?;
        check_keys(&place, table, &CHAIN_KEYS)?;
        let list = match table.get("masses") {
            Some(Value::Array(list)) if !list.is_empty() => list,
            _ => return Err(Usage::new(format!("{place} has no masses")).hint(EXAMPLE).into()),
        };
        let mut masses: Vec<String> = Vec::new();
        let mut elements = Vec::new();
        for (number, mass) in (1..).zip(list) {
            let (name, element) = element(&place, number, mass)?;
            if masses.contains(&name) {
                return Err(Usage::new(format!("{place}: two masses are named {name:?}")).into());
            }
            masses.push(name);
            elements.push(element);
        }
        Ok(Self { name: name.to_owned(), masses, elements })
    }

    /// Its id among the candidates.
    pub fn id(&self, index: usize) -> String {
        format!("chain/{}/{index}", self.name)
    }

    /// What is fitted.
    pub fn stated(&self, total_mass_kg: Option<f64>) -> StatedChain {
        StatedChain { elements: self.elements.clone(), total_mass_kg }
    }
}

fn element(place: &str, number: usize, mass: &Value) -> anyhow::Result<(String, StatedElement)> {
    let place = format!("{place}, mass {number}");
    let table = table_at(&place, mass, "{ name = ..., mass = ..., stiffness = ..., damping = ... }")?;
    check_keys(&place, table, &MASS_KEYS)?;
    let get = |key: &str| {
        table.get(key).ok_or_else(|| anyhow::Error::from(Usage::new(format!("{place} has no {key}")).hint(EXAMPLE)))
    };
    let name = match table.get("name") {
        None => format!("m{number}"),
        Some(Value::String(name)) if !name.trim().is_empty() => name.trim().to_owned(),
        Some(_) => return Err(Usage::new(format!("{place}: name is no text")).into()),
    };
    let mass_kg = match get("mass")? {
        Value::String(text) if text == "rest" => StatedMass::Rest,
        value => StatedMass::Own(number_of::<Mass>(&format!("{place}, mass"), value, Mass::si)?),
    };
    let stiffness =
        law::<Length, Stiffness>(&format!("{place}, stiffness"), get("stiffness")?, Length::si, Stiffness::si)?;
    let damping = match table.get("damping") {
        Some(value) => law::<Speed, Damping>(&format!("{place}, damping"), value, Speed::si, Damping::si)?,
        None => vec![(0.0, Stated::Fixed(0.0))],
    };
    Ok((name, StatedElement { mass_kg, stiffness, damping }))
}

/// `"350 kN/m"`, `"free"` or `{ start = "350 kN/m", lower = ..., upper = ... }`.
fn number_of<V: FromStr<Err: Display>>(place: &str, value: &Value, si: impl Fn(V) -> f64) -> anyhow::Result<Stated> {
    match value {
        Value::String(text) if text == "free" => Ok(Stated::Free { start: None, lower: None, upper: None }),
        Value::Table(table) => {
            check_keys(place, table, &BOUND_KEYS)?;
            let get = |key: &str| {
                table.get(key).map(|value| typed::<V>(&format!("{place}, {key}"), value).map(&si)).transpose()
            };
            Ok(Stated::Free { start: get("start")?, lower: get("lower")?, upper: get("upper")? })
        }
        value => Ok(Stated::Fixed(si(typed(place, value)?))),
    }
}

/// One number, or a list of pairs of a knot and a number.
fn law<K: FromStr<Err: Display>, V: FromStr<Err: Display>>(
    place: &str,
    value: &Value,
    knot_si: impl Fn(K) -> f64,
    value_si: impl Fn(V) -> f64,
) -> anyhow::Result<Vec<(f64, Stated)>> {
    let Value::Array(points) = value else { return Ok(vec![(0.0, number_of(place, value, value_si)?)]) };
    points
        .iter()
        .map(|point| match point.as_array().map(Vec::as_slice) {
            Some([knot, value]) => Ok((knot_si(typed(place, knot)?), number_of(place, value, &value_si)?)),
            _ => Err(Usage::new(format!("{place}: expected one value, or a list of pairs of a knot and a value"))
                .hint("stiffness = [[\"0 mm\", \"free\"], [\"200 mm\", \"150 kN/m\"]]")
                .into()),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<FittedChain, String> {
        let table: toml::Table = text.parse().unwrap();
        FittedChain::read("car", &Value::Table(table)).map_err(|error| format!("{error:#}"))
    }

    #[test]
    fn numbers_are_given_free_or_between_bounds() {
        let chain = read(
            r#"masses = [
                { name = "engine", mass = "250 kg", stiffness = [["0 mm", "free"], ["200 mm", "350 kN/m"]] },
                { mass = "rest", stiffness = { start = "1 MN/m", lower = "100 kN/m" }, damping = "free" },
            ]"#,
        )
        .unwrap();
        assert_eq!(chain.masses, ["engine", "m2"]);
        let free = Stated::Free { start: None, lower: None, upper: None };
        assert_eq!(chain.elements[0].mass_kg, StatedMass::Own(Stated::Fixed(250.0)));
        assert_eq!(chain.elements[0].stiffness, [(0.0, free), (0.2, Stated::Fixed(3.5e5))]);
        assert_eq!(chain.elements[0].damping, [(0.0, Stated::Fixed(0.0))]);
        assert_eq!(chain.elements[1].mass_kg, StatedMass::Rest);
        let bounded = Stated::Free { start: Some(1e6), lower: Some(1e5), upper: None };
        assert_eq!((chain.elements[1].stiffness[0].1, chain.elements[1].damping[0].1), (bounded, free));
    }

    #[test]
    fn what_cannot_be_read_is_refused_with_its_place() {
        for (text, expected) in [
            ("", "[parameter-solve.chain.car] has no masses"),
            ("mass = 3", "[parameter-solve.chain.car]: unknown key \"mass\""),
            ("masses = [{ mass = \"3 kg\" }]", "[parameter-solve.chain.car], mass 1 has no stiffness"),
            (
                "masses = [{ mass = \"3 kg\", stiffness = { begin = \"1 kN/m\" } }]",
                "[parameter-solve.chain.car], mass 1, stiffness: unknown key \"begin\"",
            ),
            ("masses = [{ mass = \"3 kg\", stiffness = [[\"0 mm\"]] }]", "list of pairs of a knot and a value"),
            ("masses = [{ mass = 3, stiffness = \"free\" }]", "mass 1, mass: "),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
