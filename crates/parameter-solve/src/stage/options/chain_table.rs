//! `[parameter-solve.chain.<name>]`: a chain of masses of which some numbers are to be found.

use crumple_lumped_fit::{Stated, StatedChain, StatedElement, StatedMass};
use crumple_stage::{NumberOfTable, TakenNumbers, read_chain};
use serde::Serialize;
use toml::Value;

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
        let (_, masses) = read_chain("parameter-solve", name, table, &[], TakenNumbers::GivenOrFree)?;
        let law = |points: Vec<(f64, NumberOfTable)>| {
            points.into_iter().filter_map(|(knot, value)| Some((knot, stated(value)?))).collect()
        };
        let (masses, elements) = masses
            .into_iter()
            .map(|mass| {
                let element = StatedElement {
                    mass_kg: stated(mass.mass_kg).map_or(StatedMass::Rest, StatedMass::Own),
                    stiffness: law(mass.stiffness_n_per_m),
                    damping: law(mass.damping_n_s_per_m),
                };
                (mass.name, element)
            })
            .unzip();
        Ok(Self { name: name.to_owned(), masses, elements })
    }

    /// Whether its last mass is an occupant, behind the compartment: whether it is called so.
    pub fn has_occupant(&self) -> bool {
        self.masses.len() > 1 && self.masses.last().is_some_and(|name| name == "occupant")
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

/// A number of the table for the fit; `None` for the mass that is the rest.
fn stated(number: NumberOfTable) -> Option<Stated> {
    match number {
        NumberOfTable::Given(value) => Some(Stated::Fixed(value)),
        NumberOfTable::Free { start, lower, upper } => Some(Stated::Free { start, lower, upper }),
        NumberOfTable::Rest => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_table_are_those_of_the_fit() {
        let text = r#"masses = [
            { name = "engine", mass = "250 kg", stiffness = [["0 mm", "free"], ["200 mm", "350 kN/m"]] },
            { mass = "rest", stiffness = { start = "1 MN/m", lower = "100 kN/m" }, damping = "free" },
        ]"#;
        let chain = FittedChain::read("car", &Value::Table(text.parse().unwrap())).unwrap();
        assert_eq!(chain.masses, ["engine", "m2"]);
        let free = Stated::Free { start: None, lower: None, upper: None };
        assert_eq!(chain.elements[0].mass_kg, StatedMass::Own(Stated::Fixed(250.0)));
        assert_eq!(chain.elements[0].stiffness, [(0.0, free), (0.2, Stated::Fixed(3.5e5))]);
        assert_eq!(chain.elements[0].damping, [(0.0, Stated::Fixed(0.0))]);
        assert_eq!(chain.elements[1].mass_kg, StatedMass::Rest);
        let bounded = Stated::Free { start: Some(1e6), lower: Some(1e5), upper: None };
        assert_eq!((chain.elements[1].stiffness[0].1, chain.elements[1].damping[0].1), (bounded, free));
    }
}
