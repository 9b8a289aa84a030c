//! `[parameter-solve.chain.<name>]`: a chain of masses of which some numbers are to be found.

use crumple_lumped_fit::{Stated, StatedChain, StatedElement, StatedMass};
use crumple_stage::{InSi, LawOfTable, NumberReaders, check_keys, check_name, read_masses, table_at};
use serde::Serialize;
use toml::Value;

const CHAIN_KEYS: [&str; 1] = ["masses"];
const BOUND_KEYS: [&str; 3] = ["start", "lower", "upper"];

const READERS: NumberReaders<StatedMass, Stated> = NumberReaders {
    mass: |place, value, si| match value {
        Value::String(text) if text == "rest" => Ok(StatedMass::Rest),
        value => Ok(StatedMass::Own(given_or_free(place, value, si)?)),
    },
    coefficient: given_or_free,
    no_damping: Stated::Fixed(0.0),
    example: "masses = [{ name = \"engine\", mass = \"200 kg\", stiffness = \"free\", damping = { start = \"8 kN*s/m\" \
        } }, { mass = \"rest\", stiffness = \"900 kN/m\" }], from the barrier on",
    knots_example: "stiffness = [[\"0 mm\", \"free\"], [\"200 mm\", \"150 kN/m\"]]",
};

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
        let (masses, elements) = read_masses(&place, table, &READERS)?
            .into_iter()
            .map(|mass| {
                let element = StatedElement {
                    mass_kg: mass.mass_kg,
                    stiffness: points(mass.stiffness_n_per_m),
                    damping: points(mass.damping_n_s_per_m),
                };
                (mass.name, element)
            })
            .unzip();
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

/// A constant is a single knot at zero.
fn points(law: LawOfTable<Stated>) -> Vec<(f64, Stated)> {
    match law {
        LawOfTable::Constant(value) => vec![(0.0, value)],
        LawOfTable::Knots(points) => points,
    }
}

/// `"350 kN/m"`, `"free"` or `{ start = "350 kN/m", lower = ..., upper = ... }`.
fn given_or_free(place: &str, value: &Value, si: InSi<'_>) -> anyhow::Result<Stated> {
    match value {
        Value::String(text) if text == "free" => Ok(Stated::Free { start: None, lower: None, upper: None }),
        Value::Table(table) => {
            check_keys(place, table, &BOUND_KEYS)?;
            let get = |key: &str| table.get(key).map(|value| si(&format!("{place}, {key}"), value)).transpose();
            Ok(Stated::Free { start: get("start")?, lower: get("lower")?, upper: get("upper")? })
        }
        value => Ok(Stated::Fixed(si(place, value)?)),
    }
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
