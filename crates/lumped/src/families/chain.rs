//! Masses in a row, each on a spring and a damper: double, triple and the user's chains.
//!
//! Chains of masses by the names of their parameters, as candidates carry them.
//!
//! Every mass i has `m<i>_kg`; the spring in front of it is `k<i>_n_per_m`, or with knots j = 1, 2, ... values
//! `k<i>_knot<j>_n_per_m` at compressions `k<i>_knot<j>_m`; the damper likewise `c<i>_...` over rates in m/s. A knot at
//! zero has no place in the names: it is always there. Written and read back, a chain is the same to the bit.

use std::collections::{BTreeMap, BTreeSet};

use crumple_numerics::lti::{Complex, polynomial_roots};

use crate::error::{finite, positive, row_of_masses};
use crate::structure::connected_masses::{Place, Structure};
use crate::structure::elements::{Damper, Spring};
use crate::structure::piecewise_linear::PiecewiseLinear;
use crate::{
    CrushEvents, Drive, Dynamics, Instants, LumpedError, ModelKind, Motion, ParameterKind, Response, Sensitivity,
};

/// Any number of masses in a row: barrier - (k1, c1) - m1 - (k2, c2) - m2 - ... - mN, the compartment last.
///
/// Spring and damper `i` stand in parallel in front of mass `i`; their force is `k_i(|u|) u + c_i(|w|) w`, `u` the
/// compression and `w` the rate of it, positive in compression, with coefficients that are constant or piecewise
/// linear. The secant reading is that of the single-mass paper, carried to elements between masses; contact stays
/// closed, and an element is as stiff in tension as in compression.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    masses_kg: Vec<f64>,
    springs: Vec<PiecewiseLinear>,
    dampers: Vec<PiecewiseLinear>,
}

/// A row of masses on springs and dampers with constant coefficients.
pub(crate) fn constants(masses_kg: &[f64], springs: &[f64], dampers: &[f64]) -> Result<Structure, LumpedError> {
    Chain::with_constants(masses_kg, springs, dampers)?.structure()
}

/// Where the parameters of so many masses with constant coefficients stand: masses, springs, dampers.
pub(crate) fn places_of_constants(masses: usize) -> Vec<Place> {
    let element = |connection| Place::Element { connection, parameter: 0 };
    let of_springs = (0..masses).map(|i| element(2 * i));
    (0..masses).map(Place::Mass).chain(of_springs).chain((0..masses).map(|i| element(2 * i + 1))).collect()
}

impl Chain {
    /// Masses in kg, springs in N/m over m and dampers in N·s/m over m/s in front of them, from the barrier on. Errors:
    /// lists of unequal length or none, masses that are not positive.
    pub fn new(
        masses_kg: &[f64],
        springs: &[PiecewiseLinear],
        dampers: &[PiecewiseLinear],
    ) -> Result<Self, LumpedError> {
        row_of_masses(masses_kg, springs.len(), dampers.len())?;
        Ok(Self { masses_kg: masses_kg.to_vec(), springs: springs.to_vec(), dampers: dampers.to_vec() })
    }

    /// The same with constant coefficients, N/m and N·s/m. Errors: also values that are not finite.
    pub fn with_constants(masses_kg: &[f64], springs: &[f64], dampers: &[f64]) -> Result<Self, LumpedError> {
        springs.iter().try_for_each(|k| finite("stiffness_n_per_m", *k))?;
        dampers.iter().try_for_each(|c| finite("damping_n_s_per_m", *c))?;
        let laws =
            |values: &[f64]| -> Vec<_> { values.iter().map(|value| PiecewiseLinear::constant(*value)).collect() };
        Self::new(masses_kg, &laws(springs), &laws(dampers))
    }

    /// Masses, kg, from the barrier on.
    pub fn masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// Springs in front of the masses, N/m over the compression in m.
    pub fn springs(&self) -> &[PiecewiseLinear] {
        &self.springs
    }

    /// Dampers in front of the masses, N·s/m over the rate of the compression in m/s.
    pub fn dampers(&self) -> &[PiecewiseLinear] {
        &self.dampers
    }

    /// Whether no spring or damper is negative anywhere.
    pub fn is_passive(&self) -> bool {
        self.springs.iter().chain(&self.dampers).all(PiecewiseLinear::is_passive)
    }

    /// The structure it is: spring and damper of each mass in turn.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        let laws = self.springs.iter().zip(&self.dampers);
        Structure::row(&self.masses_kg, laws.map(|(k, c)| vec![Spring(k.clone()).into(), Damper(c.clone()).into()]))
    }

    /// Where its parameters stand in [`sensitivity`](Self::sensitivity): masses, values of the springs at their knots,
    /// values of the dampers, each from the barrier on; then the places of the knots of the springs, and of the
    /// dampers, but of those at zero, which stay. So a chain of constant coefficients counts masses, springs, dampers.
    pub fn places(&self) -> Vec<Place> {
        let knots = |laws: &[PiecewiseLinear], side: usize, which: usize| -> Vec<Place> {
            let place = |(i, j)| Place::Element { connection: 2 * i + side, parameter: 2 * j + which };
            laws.iter().enumerate().flat_map(|(i, law)| (which..law.len()).map(move |j| (i, j))).map(place).collect()
        };
        let lists = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let of_laws = lists.map(|(side, which)| knots([&self.springs, &self.dampers][side], side, which));
        (0..self.masses_kg.len()).map(Place::Mass).chain(of_laws.into_iter().flatten()).collect()
    }

    /// Masses, kg, then the values of the springs at their knots, N/m, and of the dampers, N·s/m: the first of
    /// [`places`](Self::places).
    pub fn values(&self) -> Vec<f64> {
        let laws = self.springs.iter().chain(&self.dampers);
        self.masses_kg.iter().copied().chain(laws.flat_map(PiecewiseLinear::points).map(|(_, value)| value)).collect()
    }

    /// The same chain with other [`values`](Self::values); knots stay where they are. Errors: masses that are not
    /// positive, values that are not finite or too few.
    pub fn with_values(&self, values: &[f64]) -> Result<Self, LumpedError> {
        let mut values = values.iter().copied();
        let mut next = || values.next().unwrap_or(f64::NAN);
        let masses: Vec<f64> = self.masses_kg.iter().map(|_| next()).collect();
        let mut law = |law: &PiecewiseLinear| {
            PiecewiseLinear::new(&law.points().map(|(knot, _)| (knot, next())).collect::<Vec<_>>())
        };
        let springs = self.springs.iter().map(&mut law).collect::<Result<Vec<_>, _>>()?;
        let dampers = self.dampers.iter().map(&mut law).collect::<Result<Vec<_>, _>>()?;
        Self::new(&masses, &springs, &dampers)
    }

    /// Motions, forces and energies at `k dt`, k = 0 .. `samples`. Errors: as [`Structure::dynamics`].
    pub fn dynamics(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
        self.structure()?.dynamics(drive, dt_s, samples)
    }

    /// The motions of [`dynamics`](Self::dynamics).
    pub fn respond(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Response, LumpedError> {
        Ok(self.dynamics(drive, dt_s, samples)?.response)
    }

    /// Dynamic crush and rebound of every mass. Errors: as [`Structure::events`].
    pub fn events(&self, impact_speed_m_per_s: f64, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        self.structure()?.events(impact_speed_m_per_s, horizon_s)
    }

    /// The motion of every mass at these instants after an impact. Errors: as [`Structure::sensitivity`].
    pub fn motions_at(&self, impact_speed_m_per_s: f64, at: &Instants) -> Result<Vec<Motion>, LumpedError> {
        self.structure()?.motions_at(impact_speed_m_per_s, at)
    }

    /// Motions and their derivatives by the parameters that stand at these indices of [`places`](Self::places).
    /// Errors: an index that is none, and as [`Structure::sensitivity`].
    pub fn sensitivity(
        &self,
        impact_speed_m_per_s: f64,
        at: &Instants,
        parameters: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        let places = self.places();
        let place = |index: &usize| {
            let expected = "the place of a mass, spring or damper of the chain";
            let error = LumpedError::Value { name: "parameter", value: *index as f64, expected };
            places.get(*index).copied().ok_or(error)
        };
        let places: Vec<Place> = parameters.iter().map(place).collect::<Result<_, _>>()?;
        self.structure()?.sensitivity(impact_speed_m_per_s, at, &places)
    }

    /// Characteristic polynomial, monic, highest power first; of coefficients with knots the values at contact count.
    ///
    /// Built from the compartment forwards as a dynamic stiffness `N/D`: an element in series makes `q N/(N + q D)` of
    /// it, a mass adds `m s²`. Sums of positive terms only, so every coefficient is right to a few roundings.
    pub fn characteristic_polynomial(&self) -> Vec<f64> {
        // Lowest power first.
        let times = |p: &[f64], q: &[f64]| {
            let mut product = vec![0.0; p.len() + q.len() - 1];
            for (i, a) in p.iter().enumerate() {
                for (j, b) in q.iter().enumerate() {
                    product[i + j] += a * b;
                }
            }
            product
        };
        let plus = |p: &[f64], q: &[f64]| -> Vec<f64> {
            let at = |v: &[f64], i: usize| v.get(i).copied().unwrap_or(0.0);
            (0..p.len().max(q.len())).map(|i| at(p, i) + at(q, i)).collect()
        };
        let (mut top, mut bottom) = (vec![0.0], vec![1.0]);
        for i in (0..self.masses_kg.len()).rev() {
            top = plus(&top, &times(&[0.0, 0.0, self.masses_kg[i]], &bottom));
            let q = [self.springs[i].at(0.0), self.dampers[i].at(0.0)];
            let closed = plus(&top, &times(&q, &bottom));
            top = times(&q, &top);
            bottom = closed;
        }
        let order = 2 * self.masses_kg.len();
        let leading = bottom[order];
        (0..=order).rev().map(|k| bottom[k] / leading).collect()
    }

    /// Poles, 1/s, as `polynomial_roots` sorts them.
    ///
    /// Two for each mass. Errors: parameters so extreme that the roots of the characteristic polynomial are not found.
    pub fn poles(&self) -> Result<Vec<Complex>, LumpedError> {
        Ok(polynomial_roots(&self.characteristic_polynomial())?)
    }
}

/// Three masses in a row: engine, suspension and chassis, compartment. See [`Chain`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TripleSpringMassDamper {
    /// Masses from the barrier on, kg.
    pub masses_kg: [f64; 3],
    /// Springs in front of them, N/m.
    pub springs_n_per_m: [f64; 3],
    /// Dampers in front of them, N·s/m.
    pub dampers_n_s_per_m: [f64; 3],
}

impl TripleSpringMassDamper {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::TripleSpringMassDamper, &self.values())?;
        constants(&self.masses_kg, &self.springs_n_per_m, &self.dampers_n_s_per_m)
    }

    /// Its parameters, masses first.
    pub(crate) fn values(&self) -> Vec<f64> {
        [self.masses_kg, self.springs_n_per_m, self.dampers_n_s_per_m].concat()
    }

    /// The model of these parameters; one that is left out is not a number.
    pub(crate) fn from_values(values: &[f64]) -> Self {
        let three = |from: usize| std::array::from_fn(|i| values.get(from + i).copied().unwrap_or(f64::NAN));
        Self { masses_kg: three(0), springs_n_per_m: three(3), dampers_n_s_per_m: three(6) }
    }
}

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

/// Refuses values without meaning: what is not finite, and what must be positive and is not.
///
/// Negative springs and dampers pass where the equations allow them: solvers do return such sets. In series, and where
/// a spring unloads along a line of its own, the equations do not.
pub(crate) fn check_values(kind: ModelKind, values: &[f64]) -> Result<(), LumpedError> {
    let is_strict = matches!(kind, ModelKind::Maxwell | ModelKind::Elastoplastic);
    kind.parameters().iter().zip(values).try_for_each(|(parameter, value)| match parameter.kind {
        ParameterKind::Stiffness | ParameterKind::Damping if !is_strict => finite(parameter.name, *value),
        _ => positive(parameter.name, *value),
    })
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
