//! The `masses` of a chain in a pipeline file: from the barrier on, each with the spring and damper in front of it.

use std::fmt::Display;
use std::str::FromStr;

use crumple_signal::value::{Damping, Length, Mass, Speed, Stiffness};
use toml::{Table, Value};

use crate::chain_table::keys::{check_keys, table_at, typed};
use crate::error::Usage;

const MASS_KEYS: [&str; 4] = ["name", "mass", "stiffness", "damping"];

/// A mass with the spring and damper in front of it: `M` is what its mass is read as, `N` a stiffness or damping.
#[derive(Debug, Clone, PartialEq)]
pub struct MassOfTable<M, N> {
    /// Its name; `m1`, `m2`, ... where it has none.
    pub name: String,
    /// kg.
    pub mass_kg: M,
    /// N/m, at knots in m.
    pub stiffness_n_per_m: LawOfTable<N>,
    /// N·s/m, at knots in m/s.
    pub damping_n_s_per_m: LawOfTable<N>,
}

/// A coefficient: one value, or values at knots.
#[derive(Debug, Clone, PartialEq)]
pub enum LawOfTable<N> {
    /// The same everywhere.
    Constant(N),
    /// Knot and value.
    Knots(Vec<(f64, N)>),
}

/// Reads a value with its unit in SI: place, value.
pub type InSi<'a> = &'a dyn Fn(&str, &Value) -> anyhow::Result<f64>;

/// How the numbers of a `masses` table are read, each from its place, its value and the reader of a value with its
/// unit.
#[derive(Debug, Clone, Copy)]
pub struct NumberReaders<M, N> {
    /// A mass.
    pub mass: fn(&str, &Value, InSi<'_>) -> anyhow::Result<M>,
    /// A stiffness or damping.
    pub coefficient: fn(&str, &Value, InSi<'_>) -> anyhow::Result<N>,
    /// The damping of a mass that states none.
    pub no_damping: N,
    /// What a whole table looks like, for hints.
    pub example: &'static str,
    /// What a coefficient with knots looks like, for hints.
    pub knots_example: &'static str,
}

/// Reads the key `masses` of the table at `place`.
///
/// Refused: no masses, unknown keys, a mass without mass or stiffness, two of one name, a value that is neither a
/// number nor a list of pairs. Whether the numbers make a chain is not seen here.
pub fn read_masses<M, N: Clone>(
    place: &str,
    table: &Table,
    readers: &NumberReaders<M, N>,
) -> anyhow::Result<Vec<MassOfTable<M, N>>> {
    let list = match table.get("masses") {
        Some(Value::Array(list)) if !list.is_empty() => list,
        None | Some(Value::Array(_)) => {
            return Err(Usage::new(format!("{place} has no masses")).hint(readers.example).into());
        }
        Some(_) => {
            return Err(Usage::new(format!("{place}: masses is no list, expected a table for each mass"))
                .hint(readers.example)
                .into());
        }
    };
    let mut masses: Vec<MassOfTable<M, N>> = Vec::new();
    for (number, value) in (1..).zip(list) {
        let mass = mass(place, number, value, readers)?;
        if masses.iter().any(|other| other.name == mass.name) {
            return Err(Usage::new(format!("{place}: two masses are named {:?}", mass.name)).into());
        }
        masses.push(mass);
    }
    Ok(masses)
}

fn mass<M, N: Clone>(
    place: &str,
    number: usize,
    value: &Value,
    readers: &NumberReaders<M, N>,
) -> anyhow::Result<MassOfTable<M, N>> {
    let place = format!("{place}, mass {number}");
    let table = table_at(&place, value, "{ name = ..., mass = ..., stiffness = ..., damping = ... }")?;
    check_keys(&place, table, &MASS_KEYS)?;
    let get = |key: &str| {
        let missing = || anyhow::Error::from(Usage::new(format!("{place} has no {key}")).hint(readers.example));
        table.get(key).ok_or_else(missing)
    };
    let name = match table.get("name") {
        None => format!("m{number}"),
        Some(Value::String(name)) if !name.trim().is_empty() => name.trim().to_owned(),
        Some(_) => return Err(Usage::new(format!("{place}: name is no text")).into()),
    };
    let stiffness = format!("{place}, stiffness");
    let damping = format!("{place}, damping");
    Ok(MassOfTable {
        name,
        mass_kg: (readers.mass)(&format!("{place}, mass"), get("mass")?, &in_si(Mass::si))?,
        stiffness_n_per_m: law(&stiffness, get("stiffness")?, &in_si(Length::si), &in_si(Stiffness::si), readers)?,
        damping_n_s_per_m: match table.get("damping") {
            Some(value) => law(&damping, value, &in_si(Speed::si), &in_si(Damping::si), readers)?,
            None => LawOfTable::Constant(readers.no_damping.clone()),
        },
    })
}

fn in_si<V: FromStr<Err: Display>>(si: impl Fn(V) -> f64) -> impl Fn(&str, &Value) -> anyhow::Result<f64> {
    move |place, value| Ok(si(typed(place, value)?))
}

/// `"350 kN/m"`, or `[["0 mm", "350 kN/m"], ["200 mm", "150 kN/m"]]`.
fn law<M, N>(
    place: &str,
    value: &Value,
    knot_si: InSi<'_>,
    value_si: InSi<'_>,
    readers: &NumberReaders<M, N>,
) -> anyhow::Result<LawOfTable<N>> {
    let Value::Array(points) = value else {
        return Ok(LawOfTable::Constant((readers.coefficient)(place, value, value_si)?));
    };
    let pairs = points.iter().map(|point| match point.as_array().map(Vec::as_slice) {
        Some([knot, value]) => Ok((knot_si(place, knot)?, (readers.coefficient)(place, value, value_si)?)),
        _ => Err(Usage::new(format!("{place}: expected one value, or a list of pairs of a knot and a value"))
            .hint(readers.knots_example)
            .into()),
    });
    pairs.collect::<anyhow::Result<_>>().map(LawOfTable::Knots)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIVEN: NumberReaders<f64, f64> = NumberReaders {
        mass: |place, value, si| si(place, value),
        coefficient: |place, value, si| si(place, value),
        no_damping: 0.0,
        example: "masses = [...]",
        knots_example: "[[knot, value], ...]",
    };

    fn read(text: &str) -> Result<Vec<MassOfTable<f64, f64>>, String> {
        let table: Table = text.parse().unwrap();
        read_masses("[stage.chain.car]", &table, &GIVEN).map_err(|error| format!("{error:#}"))
    }

    #[test]
    fn numbers_are_in_si_and_what_is_left_out_has_its_default() {
        let found = read(
            r#"masses = [
                { name = " engine ", mass = "250 kg", stiffness = [["0 mm", "9 kN/m"], ["200 mm", "350 kN/m"]] },
                { mass = "1 t", stiffness = "1 MN/m", damping = "4 kN*s/m" },
            ]"#,
        )
        .unwrap();
        assert_eq!((found[0].name.as_str(), found[1].name.as_str()), ("engine", "m2"));
        assert_eq!((found[0].mass_kg, found[1].mass_kg), (250.0, 1000.0));
        assert_eq!(found[0].stiffness_n_per_m, LawOfTable::Knots(vec![(0.0, 9e3), (0.2, 3.5e5)]));
        assert_eq!(found[0].damping_n_s_per_m, LawOfTable::Constant(0.0));
        assert_eq!(found[1].damping_n_s_per_m, LawOfTable::Constant(4e3));
    }

    #[test]
    fn what_cannot_be_read_is_refused_with_its_place() {
        let one = |mass: &str| format!("masses = [{{ {mass} }}]");
        for (text, expected) in [
            (String::new(), "[stage.chain.car] has no masses"),
            ("masses = []".to_owned(), "has no masses"),
            ("masses = 3".to_owned(), "masses is no list, expected a table for each mass"),
            ("masses = [3]".to_owned(), "mass 1 is no table"),
            (one("mass = \"3 kg\""), "[stage.chain.car], mass 1 has no stiffness"),
            (one("stiffness = \"3 kN/m\""), "mass 1 has no mass"),
            (one("mass = \"3 kg\", stifness = \"3 kN/m\""), "mass 1: unknown key \"stifness\""),
            (one("mass = 3, stiffness = \"3 kN/m\""), "mass 1, mass: "),
            (one("mass = \"3 kg\", stiffness = [[\"0 mm\"]]"), "list of pairs of a knot and a value"),
            (one("name = 3, mass = \"3 kg\", stiffness = \"3 kN/m\""), "mass 1: name is no text"),
            (
                "masses = [{ name = \"m2\", mass = \"3 kg\", stiffness = \"1 N/m\" }, \
                 { mass = \"3 kg\", stiffness = \"1 N/m\" }]"
                    .to_owned(),
                "two masses are named \"m2\"",
            ),
        ] {
            let error = read(&text).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
