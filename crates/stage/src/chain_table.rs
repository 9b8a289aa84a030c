//! The table of a chain of masses in a pipeline file, key by key.

use std::fmt::Display;
use std::str::FromStr;

use crumple_signal::value::{Damping, Length, Mass, Speed, Stiffness};
use toml::{Table, Value};

use crate::error::{Usage, unknown_name};

// Whether the masses of a chain add up to the mass of the test.

/// A chain that is lighter or heavier than the test by more than this share is not the vehicle that was tested; scales
/// and rounded masses stay below.
const TOTAL_MASS_TOLERANCE: f64 = 0.01;

/// What is to be said of a chain whose masses differ from the test's by more than 1 %.
pub fn total_mass_remark(masses_kg: &[f64], test_mass_kg: f64) -> Option<String> {
    let sum: f64 = masses_kg.iter().sum();
    let difference = sum / test_mass_kg - 1.0;
    // Rounding of a sum is no difference.
    if !(difference.abs() > TOTAL_MASS_TOLERANCE + 1e-12 && difference.is_finite()) {
        return None;
    }
    Some(format!(
        "its masses add up to {sum:.1} kg, the test has {test_mass_kg:.1} kg: {:.1} % {} (noted above {:.0} %); its \
         forces and energies are those of its own masses",
        100.0 * difference.abs(),
        if difference > 0.0 { "more" } else { "less" },
        100.0 * TOTAL_MASS_TOLERANCE
    ))
}

// Tables of a pipeline file that a stage reads key by key, since a flag could not state them.

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

// The table of a chain of masses in a pipeline file, `[<stage>.chain.<name>]`: from the barrier on, each mass with the
// spring and damper in front of it.

const MASS_KEYS: [&str; 4] = ["name", "mass", "stiffness", "damping"];

const BOUND_KEYS: [&str; 3] = ["start", "lower", "upper"];

const KNOTS_EXAMPLE: &str = "stiffness = [[\"0 mm\", \"350 kN/m\"], [\"200 mm\", \"150 kN/m\"]]";

/// A number of the table in SI: given, or to be found by a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NumberOfTable {
    /// `"350 kN/m"`.
    Given(f64),
    /// `"free"`, or `{ start = "350 kN/m", lower = ..., upper = ... }`.
    Free {
        /// Where the search starts.
        start: Option<f64>,
        /// Smallest value.
        lower: Option<f64>,
        /// Largest value.
        upper: Option<f64>,
    },
    /// `"rest"`, of a mass: what the others leave of the total.
    Rest,
}

/// Which numbers a stage takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TakenNumbers {
    /// Given ones only: there is no fit.
    Given,
    /// Any.
    GivenOrFree,
}

/// A mass with the spring and damper in front of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MassOfTable {
    /// Its name; `m1`, `m2`, ... where it has none.
    pub name: String,
    /// kg.
    pub mass_kg: NumberOfTable,
    /// N/m, at knots in m; a constant is one knot at zero.
    pub stiffness_n_per_m: Vec<(f64, NumberOfTable)>,
    /// N·s/m, at knots in m/s; no damping where none is stated.
    pub damping_n_s_per_m: Vec<(f64, NumberOfTable)>,
}

/// Reads a value with its unit in SI: place, value.
type InSi<'a> = &'a dyn Fn(&str, &Value) -> anyhow::Result<f64>;

/// Reads `[<stage>.chain.<name>]`: the table, for keys that the stage adds (`more_keys`), and its masses.
///
/// Refused: a name that cannot stand in a topic, unknown keys, no masses, a mass without mass or stiffness, two of one
/// name, a value that is neither a number nor a list of pairs, a free number where only given ones are taken. Whether
/// the numbers make a chain is not seen here.
pub fn read_chain<'a>(
    stage: &str,
    name: &str,
    value: &'a Value,
    more_keys: &[&str],
    taken: TakenNumbers,
) -> anyhow::Result<(&'a Table, Vec<MassOfTable>)> {
    let place = format!("[{stage}.chain.{name}]");
    check_name(&place, name)?;
    let table = table_at(&place, value, &format!("[{stage}.chain.car] with masses = [...]"))?;
    check_keys(&place, table, &[&["masses"], more_keys].concat())?;
    Ok((table, read_masses(&place, table, taken)?))
}

/// Reads the key `masses` of the table at `place`.
fn read_masses(place: &str, table: &Table, taken: TakenNumbers) -> anyhow::Result<Vec<MassOfTable>> {
    let list = match table.get("masses") {
        Some(Value::Array(list)) if !list.is_empty() => list,
        None | Some(Value::Array(_)) => {
            return Err(Usage::new(format!("{place} has no masses")).hint(taken.example()).into());
        }
        Some(_) => {
            return Err(Usage::new(format!("{place}: masses is no list, expected a table for each mass"))
                .hint(taken.example())
                .into());
        }
    };
    let mut masses: Vec<MassOfTable> = Vec::new();
    for (number, value) in (1..).zip(list) {
        let mass = mass(place, number, value, taken)?;
        if masses.iter().any(|other| other.name == mass.name) {
            return Err(Usage::new(format!("{place}: two masses are named {:?}", mass.name)).into());
        }
        masses.push(mass);
    }
    Ok(masses)
}

fn mass(place: &str, number: usize, value: &Value, taken: TakenNumbers) -> anyhow::Result<MassOfTable> {
    let place = format!("{place}, mass {number}");
    let table = table_at(&place, value, "{ name = ..., mass = ..., stiffness = ..., damping = ... }")?;
    check_keys(&place, table, &MASS_KEYS)?;
    let get = |key: &str| {
        let missing = || anyhow::Error::from(Usage::new(format!("{place} has no {key}")).hint(taken.example()));
        table.get(key).ok_or_else(missing)
    };
    let name = match table.get("name") {
        None => format!("m{number}"),
        Some(Value::String(name)) if !name.trim().is_empty() => name.trim().to_owned(),
        Some(_) => return Err(Usage::new(format!("{place}: name is no text")).into()),
    };
    let stiffness = format!("{place}, stiffness");
    let damping = format!("{place}, damping");
    let mass_kg = match get("mass")? {
        Value::String(text) if text == "rest" && taken == TakenNumbers::GivenOrFree => NumberOfTable::Rest,
        value => taken.read(&format!("{place}, mass"), value, &in_si(Mass::si))?,
    };
    Ok(MassOfTable {
        name,
        mass_kg,
        stiffness_n_per_m: law(&stiffness, get("stiffness")?, &in_si(Length::si), &in_si(Stiffness::si), taken)?,
        damping_n_s_per_m: match table.get("damping") {
            Some(value) => law(&damping, value, &in_si(Speed::si), &in_si(Damping::si), taken)?,
            None => vec![(0.0, NumberOfTable::Given(0.0))],
        },
    })
}

fn in_si<V: FromStr<Err: Display>>(si: impl Fn(V) -> f64) -> impl Fn(&str, &Value) -> anyhow::Result<f64> {
    move |place, value| Ok(si(typed(place, value)?))
}

/// `"350 kN/m"`, or `[["0 mm", "350 kN/m"], ["200 mm", "150 kN/m"]]`.
fn law(
    place: &str,
    value: &Value,
    knot_si: InSi<'_>,
    value_si: InSi<'_>,
    taken: TakenNumbers,
) -> anyhow::Result<Vec<(f64, NumberOfTable)>> {
    let Value::Array(points) = value else {
        return Ok(vec![(0.0, taken.read(place, value, value_si)?)]);
    };
    let pairs = points.iter().map(|point| match point.as_array().map(Vec::as_slice) {
        Some([knot, value]) => Ok((knot_si(place, knot)?, taken.read(place, value, value_si)?)),
        _ => Err(Usage::new(format!("{place}: expected one value, or a list of pairs of a knot and a value"))
            .hint(KNOTS_EXAMPLE)
            .into()),
    });
    pairs.collect()
}

impl TakenNumbers {
    /// What a whole table looks like, for hints.
    fn example(self) -> &'static str {
        match self {
            Self::Given => {
                "masses = [{ name = \"engine\", mass = \"200 kg\", stiffness = \"900 kN/m\", damping = \"8 kN*s/m\" \
                 }, ...], from the barrier on"
            }
            Self::GivenOrFree => {
                "masses = [{ name = \"engine\", mass = \"200 kg\", stiffness = \"free\", damping = { start = \"8 \
                 kN*s/m\" } }, { mass = \"rest\", stiffness = \"900 kN/m\" }], from the barrier on"
            }
        }
    }

    /// One number.
    fn read(self, place: &str, value: &Value, si: InSi<'_>) -> anyhow::Result<NumberOfTable> {
        let free = match value {
            Value::String(text) if text == "free" || text == "rest" => true,
            Value::Table(_) => true,
            _ => false,
        };
        if free && self == Self::Given {
            return Err(Usage::new(format!("{place}: a number that is free has no value here"))
                .hint("state it; [parameter-solve.chain.<name>] finds free numbers")
                .into());
        }
        match value {
            Value::String(text) if text == "free" => Ok(NumberOfTable::Free { start: None, lower: None, upper: None }),
            Value::Table(table) => {
                check_keys(place, table, &BOUND_KEYS)?;
                let get = |key: &str| table.get(key).map(|value| si(&format!("{place}, {key}"), value)).transpose();
                Ok(NumberOfTable::Free { start: get("start")?, lower: get("lower")?, upper: get("upper")? })
            }
            value => Ok(NumberOfTable::Given(si(place, value)?)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use NumberOfTable::{Free, Given, Rest};
    use crumple_signal::value::Mass;

    #[test]
    fn a_difference_of_more_than_a_percent_is_said_with_both_masses() {
        assert_eq!(total_mass_remark(&[250.0, 350.0, 900.0], 1500.0), None);
        assert_eq!(total_mass_remark(&[100.0, 890.0], 1000.0), None);
        assert_eq!(
            total_mass_remark(&[250.0, 350.0, 600.0], 1500.0).unwrap(),
            "its masses add up to 1200.0 kg, the test has 1500.0 kg: 20.0 % less (noted above 1 %); its forces \
             and energies are those of its own masses"
        );
        assert!(total_mass_remark(&[1530.0], 1500.0).unwrap().contains("2.0 % more"));
        assert_eq!(total_mass_remark(&[1530.0], 0.0), None);
        assert!(total_mass_remark(&[1012.0], 1000.0).is_some() && total_mass_remark(&[1009.0], 1000.0).is_none());
    }

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

    fn read_as(text: &str, taken: TakenNumbers) -> Result<Vec<MassOfTable>, String> {
        let table: Table = text.parse().unwrap();
        let read = read_chain("stage", "car", &Value::Table(table), &[], taken).map(|(_, masses)| masses);
        read.map_err(|error| format!("{error:#}"))
    }

    fn read(text: &str) -> Result<Vec<MassOfTable>, String> {
        read_as(text, TakenNumbers::Given)
    }

    #[test]
    fn numbers_are_in_si_and_what_is_left_out_has_its_default() {
        let masses = read(
            r#"masses = [
                { name = " engine ", mass = "250 kg", stiffness = [["0 mm", "9 kN/m"], ["200 mm", "350 kN/m"]] },
                { mass = "1 t", stiffness = "1 MN/m", damping = "4 kN*s/m" },
            ]"#,
        )
        .unwrap();
        assert_eq!((masses[0].name.as_str(), masses[1].name.as_str()), ("engine", "m2"));
        assert_eq!((masses[0].mass_kg, masses[1].mass_kg), (Given(250.0), Given(1000.0)));
        assert_eq!(masses[0].stiffness_n_per_m, [(0.0, Given(9e3)), (0.2, Given(3.5e5))]);
        assert_eq!(masses[0].damping_n_s_per_m, [(0.0, Given(0.0))]);
        assert_eq!(masses[1].damping_n_s_per_m, [(0.0, Given(4e3))]);
    }

    #[test]
    fn numbers_are_given_free_or_between_bounds() {
        let text = r#"masses = [
            { name = "engine", mass = "250 kg", stiffness = [["0 mm", "free"], ["200 mm", "350 kN/m"]] },
            { mass = "rest", stiffness = { start = "1 MN/m", lower = "100 kN/m" }, damping = "free" },
        ]"#;
        let masses = read_as(text, TakenNumbers::GivenOrFree).unwrap();
        let free = Free { start: None, lower: None, upper: None };
        assert_eq!(masses[0].stiffness_n_per_m, [(0.0, free), (0.2, Given(3.5e5))]);
        assert_eq!(masses[1].mass_kg, Rest);
        let bounded = Free { start: Some(1e6), lower: Some(1e5), upper: None };
        assert_eq!((masses[1].stiffness_n_per_m[0].1, masses[1].damping_n_s_per_m[0].1), (bounded, free));
        let error = read(text).unwrap_err();
        assert!(error.contains("mass 1, stiffness: a number that is free has no value here"), "{error}");
        let misspelt = r#"masses = [{ mass = "3 kg", stiffness = { begin = "1 kN/m" } }]"#;
        let error = read_as(misspelt, TakenNumbers::GivenOrFree).unwrap_err();
        assert!(error.contains("[stage.chain.car], mass 1, stiffness: unknown key \"begin\""), "{error}");
    }

    #[test]
    fn what_cannot_be_read_is_refused_with_its_place() {
        let one = |mass: &str| format!("masses = [{{ {mass} }}]");
        for (text, expected) in [
            (String::new(), "[stage.chain.car] has no masses"),
            ("mass = 3".to_owned(), "[stage.chain.car]: unknown key \"mass\""),
            ("masses = []".to_owned(), "has no masses"),
            ("masses = 3".to_owned(), "masses is no list, expected a table for each mass"),
            ("masses = [3]".to_owned(), "mass 1 is no table"),
            (one("mass = \"3 kg\""), "[stage.chain.car], mass 1 has no stiffness"),
            (one("stiffness = \"3 kN/m\""), "mass 1 has no mass"),
            (one("mass = \"3 kg\", stifness = \"3 kN/m\""), "mass 1: unknown key \"stifness\""),
            (one("mass = 3, stiffness = \"3 kN/m\""), "mass 1, mass: "),
            (one("mass = \"3 kg\", stiffness = [[\"0 mm\"]]"), "list of pairs of a knot and a value"),
            (one("name = \" \", mass = \"3 kg\", stiffness = \"3 kN/m\""), "mass 1: name is no text"),
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
        // Only where numbers may be free is a mass the rest.
        assert!(read(&one("mass = \"rest\", stiffness = \"3 kN/m\"")).is_err());
        assert!(read(&one("mass = { start = \"3 kg\" }, stiffness = \"3 kN/m\"")).unwrap_err().contains("is free"));
        for taken in [TakenNumbers::Given, TakenNumbers::GivenOrFree] {
            let example: Table =
                taken.example().replace(", ...", "").replace(", from the barrier on", "").parse().unwrap();
            let example = Value::Table(example);
            let read = read_chain("stage", "car", &example, &[], taken);
            assert!(read.is_ok(), "{read:?}");
        }
    }
}
