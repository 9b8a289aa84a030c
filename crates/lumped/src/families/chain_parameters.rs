//! Chains of masses by the names of their parameters, as candidates carry them.
//!
//! Every mass i has `m<i>_kg`; the spring in front of it is `k<i>_n_per_m`, or with knots j = 1, 2, ... values
//! `k<i>_knot<j>_n_per_m` at compressions `k<i>_knot<j>_m`; the damper likewise `c<i>_...` over rates in m/s. A knot at
//! zero has no place in the names: it is always there. Written and read back, a chain is the same to the bit.

use std::collections::{BTreeMap, BTreeSet};

use crate::families::chain::Chain;
use crate::{LumpedError, ParameterKind, PiecewiseLinear};

/// What a coefficient is called: `k2_n_per_m`, or `k2_knot1_m` and `k2_knot1_n_per_m`.
struct Spelling {
    symbol: char,
    value: ParameterKind,
    place: ParameterKind,
}

const SPRING: Spelling = Spelling { symbol: 'k', value: ParameterKind::Stiffness, place: ParameterKind::Length };
const DAMPER: Spelling = Spelling { symbol: 'c', value: ParameterKind::Damping, place: ParameterKind::Rate };

impl Spelling {
    /// Adds the names of this coefficient of element `number`, from 1 at the barrier.
    fn write(&self, number: usize, law: &PiecewiseLinear, out: &mut BTreeMap<String, f64>) {
        let place = |j: usize| format!("{}{number}_knot{j}_{}", self.symbol, self.place.unit_in_name());
        for ((j, name), (knot, value)) in (1..).zip(self.names(number, law)).zip(law.points()) {
            if knot > 0.0 {
                out.insert(place(j), knot);
            }
            out.insert(name, value);
        }
    }

    /// The names of the values of this coefficient of element `number`, knot after knot.
    fn names(&self, number: usize, law: &PiecewiseLinear) -> Vec<String> {
        let (symbol, unit) = (format!("{}{number}", self.symbol), self.value.unit_in_name());
        match law.len() {
            1 => vec![format!("{symbol}_{unit}")],
            knots => (1..=knots).map(|j| format!("{symbol}_knot{j}_{unit}")).collect(),
        }
    }

    /// The coefficient; the names it takes are added to those taken.
    fn read(
        &self,
        number: usize,
        parameters: &BTreeMap<String, f64>,
        taken: &mut BTreeSet<String>,
    ) -> Result<PiecewiseLinear, LumpedError> {
        let symbol = format!("{}{number}", self.symbol);
        let (unit, unit_of_place) = (self.value.unit_in_name(), self.place.unit_in_name());
        let constant = format!("{symbol}_{unit}");
        if let Some(value) = parameters.get(&constant) {
            taken.insert(constant);
            return PiecewiseLinear::new(&[(0.0, *value)]);
        }
        let mut points = Vec::new();
        loop {
            let name = |unit: &str| format!("{symbol}_knot{}_{unit}", points.len() + 1);
            let (knot, value) = (name(unit_of_place), name(unit));
            let Some(coefficient) = parameters.get(&value) else { break };
            points.push((parameters.get(&knot).copied().unwrap_or(0.0), *coefficient));
            taken.extend([knot, value]);
        }
        if points.is_empty() {
            return Err(LumpedError::ChainParameter { problem: "needs the parameter", name: constant });
        }
        PiecewiseLinear::new(&points)
    }
}

impl Chain {
    /// Its parameters by name: `m1_kg`, `k1_n_per_m`, `c1_n_s_per_m`, `m2_kg`, ... from the barrier on; a coefficient
    /// with knots as `k1_knot1_n_per_m`, `k1_knot2_m`, `k1_knot2_n_per_m`, ... without the place of a knot at zero.
    pub fn parameters(&self) -> BTreeMap<String, f64> {
        let mut out = BTreeMap::new();
        for (i, mass) in self.masses_kg().iter().enumerate() {
            out.insert(format!("m{}_kg", i + 1), *mass);
            SPRING.write(i + 1, &self.springs()[i], &mut out);
            DAMPER.write(i + 1, &self.dampers()[i], &mut out);
        }
        out
    }

    /// The names of its [`values`](Self::values): masses, values of the springs at their knots, values of the dampers.
    pub fn names(&self) -> Vec<String> {
        let laws = |spelling: &'static Spelling, laws: &[PiecewiseLinear]| -> Vec<String> {
            (1..).zip(laws).flat_map(|(number, law)| spelling.names(number, law)).collect()
        };
        let masses = (1..=self.masses_kg().len()).map(|number| format!("m{number}_kg"));
        masses.chain(laws(&SPRING, self.springs())).chain(laws(&DAMPER, self.dampers())).collect()
    }

    /// The chain with exactly these parameters. Errors: one that is missing or belongs to no mass, and what the values
    /// themselves are refused for.
    pub fn from_parameters(parameters: &BTreeMap<String, f64>) -> Result<Self, LumpedError> {
        let (mut masses, mut springs, mut dampers) = (Vec::new(), Vec::new(), Vec::new());
        let mut taken = BTreeSet::new();
        loop {
            let name = format!("m{}_kg", masses.len() + 1);
            let Some(mass) = parameters.get(&name) else { break };
            taken.insert(name);
            masses.push(*mass);
            springs.push(SPRING.read(masses.len(), parameters, &mut taken)?);
            dampers.push(DAMPER.read(masses.len(), parameters, &mut taken)?);
        }
        if masses.is_empty() {
            return Err(LumpedError::ChainParameter { problem: "needs the parameter", name: "m1_kg".to_owned() });
        }
        if let Some(name) = parameters.keys().find(|name| !taken.contains(*name)) {
            return Err(LumpedError::ChainParameter { problem: "has no use for the parameter", name: name.clone() });
        }
        Self::new(&masses, &springs, &dampers)
    }

    /// What the parameter of a chain is that has this name: one of [`parameters`](Self::parameters), of a chain of any
    /// length with any number of knots. `None` for any other name.
    pub fn parameter_kind(name: &str) -> Option<ParameterKind> {
        let after_number = |text: &'_ str| -> Option<usize> {
            let digits = text.bytes().take_while(u8::is_ascii_digit).count();
            (digits > 0 && text[digits..].starts_with('_')).then_some(digits + 1)
        };
        let spelling = match name.as_bytes().first()? {
            b'm' => None,
            b'k' => Some(&SPRING),
            b'c' => Some(&DAMPER),
            _ => return None,
        };
        let rest = &name[1 + after_number(&name[1..])?..];
        let Some(Spelling { value, place, .. }) = spelling else {
            return (rest == ParameterKind::Mass.unit_in_name()).then_some(ParameterKind::Mass);
        };
        let (unit, kinds) = match rest.strip_prefix("knot") {
            Some(knot) => (&knot[after_number(knot)?..], &[*value, *place][..]),
            None => (rest, &[*value][..]),
        };
        kinds.iter().copied().find(|kind| kind.unit_in_name() == unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain() -> Chain {
        let knots = PiecewiseLinear::new(&[(0.0, 9e5), (0.2, 3.5e5)]).unwrap();
        let late = PiecewiseLinear::new(&[(1.0, 4e3), (8.0, 2e3)]).unwrap();
        let constant = PiecewiseLinear::constant;
        Chain::new(&[250.0, 900.0], &[knots, constant(6e5)], &[constant(8e3), late]).unwrap()
    }

    #[test]
    fn a_chain_reads_its_own_parameters_back() {
        let names = chain().parameters();
        assert_eq!(names["k1_knot2_m"], 0.2);
        assert!(names.keys().all(|name| Chain::parameter_kind(name).is_some()), "{names:?}");
        assert!(!names.contains_key("k1_knot1_m"));
        assert_eq!(Chain::from_parameters(&names).unwrap(), chain());
        let named: BTreeMap<String, f64> = chain().names().into_iter().zip(chain().values()).collect();
        assert!(named.iter().all(|(name, value)| names[name] == *value), "{named:?}");
    }

    #[test]
    fn a_name_tells_what_the_parameter_is() {
        use ParameterKind::{Damping, Length, Mass, Rate, Stiffness};
        let kinds = [
            ("m12_kg", Mass),
            ("k2_n_per_m", Stiffness),
            ("k2_knot10_n_per_m", Stiffness),
            ("k2_knot10_m", Length),
            ("c1_n_s_per_m", Damping),
            ("c1_knot2_n_s_per_m", Damping),
            ("c1_knot2_m_per_s", Rate),
        ];
        for (name, kind) in kinds {
            assert_eq!(Chain::parameter_kind(name), Some(kind), "{name}");
        }
        for name in [
            "",
            "m",
            "m_kg",
            "mass_kg",
            "m1",
            "m1_n_per_m",
            "k1_m",
            "k1_knot_m",
            "k1_knot2_m_per_s",
            "c1_n_per_m",
            "x1_m",
        ] {
            assert_eq!(Chain::parameter_kind(name), None, "{name}");
        }
    }

    #[test]
    fn knots_of_the_same_value_keep_their_names() {
        let flat = PiecewiseLinear::new(&[(0.0, 9e5), (0.2, 3.5e5), (0.3, 3.5e5)]).unwrap();
        let constant = PiecewiseLinear::new(&[(0.0, 4e3), (2.0, 4e3)]).unwrap();
        let chain = Chain::new(&[250.0], &[flat], &[constant]).unwrap();
        let names = chain.parameters();
        for name in ["k1_knot3_n_per_m", "k1_knot3_m", "c1_knot1_n_s_per_m", "c1_knot2_n_s_per_m"] {
            assert!(names.contains_key(name), "{name} {names:?}");
        }
        assert_eq!(Chain::from_parameters(&names).unwrap(), chain);
    }

    #[test]
    fn what_is_missing_or_belongs_to_no_mass_is_named() {
        let error = |change: fn(&mut BTreeMap<String, f64>)| {
            let mut names = chain().parameters();
            change(&mut names);
            Chain::from_parameters(&names).unwrap_err().to_string()
        };
        let missing = error(|names| {
            names.remove("k2_n_per_m");
        });
        assert_eq!(missing, "a chain of masses needs the parameter k2_n_per_m");
        let strange = error(|names| {
            names.insert("k4_n_per_m".to_owned(), 1.0);
        });
        assert_eq!(strange, "a chain of masses has no use for the parameter k4_n_per_m");
        assert!(error(BTreeMap::clear).ends_with("m1_kg"));
        let negative = error(|names| {
            names.insert("m2_kg".to_owned(), -1.0);
        });
        assert_eq!(negative, "mass_kg is -1, expected a positive number");
    }
}
