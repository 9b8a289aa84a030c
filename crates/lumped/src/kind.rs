//! The families by name and what their parameters are: mass, stiffness, damping, the place of a knot.

use std::fmt;
use std::str::FromStr;

use crate::error::LumpedError;

// The names are part of the file format: candidates, pipelines and summaries carry them.

/// The model families that candidates are named after.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ModelKind {
    /// One mass, spring and damper in parallel.
    Kelvin,
    /// One mass, one stiffness to load and another to unload.
    Elastoplastic,
    /// One mass, spring and damper in series.
    Maxwell,
    /// One mass, spring and damper piecewise linear, the paper's first version.
    Nonlinear1,
    /// The paper's second version.
    Nonlinear2,
    /// Chassis and compartment.
    DoubleSpringMassDamper,
    /// Three masses in a row.
    TripleSpringMassDamper,
    /// One mass behind a structure that is crushed along a force-deflection curve.
    ForceDeflection,
    /// The same family with two masses, engine and compartment, and a curve of each load path between them and the
    /// barrier.
    LoadPaths,
    /// Any number of masses in a row, as a person states them: the names of its parameters follow from their number
    /// and from the knots of its springs and dampers.
    Chain,
    /// Masses and elements with forces that a person states in a file.
    Own,
}

impl ModelKind {
    /// All families with a table of parameters: all kinds but chain and own model.
    pub const ALL: [Self; 9] = [
        Self::Kelvin,
        Self::Elastoplastic,
        Self::Maxwell,
        Self::Nonlinear1,
        Self::Nonlinear2,
        Self::DoubleSpringMassDamper,
        Self::TripleSpringMassDamper,
        Self::ForceDeflection,
        Self::LoadPaths,
    ];

    /// The name in candidate ids and pipeline files. Crushed structures of one mass and of two have one name: the
    /// parameters of a candidate tell which it is.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kelvin => "kelvin",
            Self::Elastoplastic => "elastoplastic",
            Self::Maxwell => "maxwell",
            Self::Nonlinear1 => "nonlinear-1",
            Self::Nonlinear2 => "nonlinear-2",
            Self::DoubleSpringMassDamper => "double-spring-mass-damper",
            Self::TripleSpringMassDamper => "triple-spring-mass-damper",
            Self::ForceDeflection | Self::LoadPaths => "force-deflection",
            Self::Chain => "chain",
            Self::Own => "own",
        }
    }
}

impl fmt::Display for ModelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

// What the parameters of the families are: masses, springs, dampers and the places of knots, each with its unit.
//
// A stage that needs to know whether a number is a mass asks here ([`ModelKind::parameter`]) and never the end of a
// name.

/// What a parameter of a model is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ParameterKind {
    /// A mass, kg.
    Mass,
    /// The stiffness of a spring, or its value at a knot, N/m.
    Stiffness,
    /// The coefficient of a damper, or its value at a knot, N·s/m.
    Damping,
    /// A compression at which a spring has a knot, m.
    Length,
    /// A rate of compression at which a damper has a knot, m/s.
    Rate,
    /// The force of a structure at a knot of its curve, N.
    Force,
    /// Share by which a force grows with the rate of compression, s/m.
    RateFactor,
    /// A number of an own model with a unit of its own, or without one.
    Other,
}

impl ParameterKind {
    /// All kinds with a unit; one whose unit ends like another's comes first.
    pub const ALL: [Self; 7] =
        [Self::Mass, Self::Stiffness, Self::Damping, Self::RateFactor, Self::Length, Self::Rate, Self::Force];

    /// SI unit as it is printed: `kg`, `N/m`, `N·s/m`, `m`, `m/s`, `N`, `s/m`.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Mass => "kg",
            Self::Stiffness => "N/m",
            Self::Damping => "N·s/m",
            Self::Length => "m",
            Self::Rate => "m/s",
            Self::Force => "N",
            Self::RateFactor => "s/m",
            Self::Other => "",
        }
    }

    /// SI unit as it stands in the name of a parameter: `kg`, `n_per_m`, `n_s_per_m`, `m`,
    /// `m_per_s`, `n`, `s_per_m`.
    pub const fn unit_in_name(self) -> &'static str {
        match self {
            Self::Mass => "kg",
            Self::Stiffness => "n_per_m",
            Self::Damping => "n_s_per_m",
            Self::Length => "m",
            Self::Rate => "m_per_s",
            Self::Force => "n",
            Self::RateFactor => "s_per_m",
            Self::Other => "",
        }
    }

    /// The name of a parameter of this kind without its unit: `k1` of `k1_n_per_m`. A name without this unit stays
    /// whole.
    pub fn symbol_of(self, name: &str) -> &str {
        let symbol = name.strip_suffix(self.unit_in_name()).and_then(|symbol| symbol.strip_suffix('_'));
        // `kg_per_m` is no length.
        symbol.filter(|symbol| !symbol.ends_with("_per")).unwrap_or(name)
    }
}

/// One parameter of a family.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parameter {
    /// Its name in candidates, with the unit.
    pub name: &'static str,
    /// What it is.
    pub kind: ParameterKind,
    /// Whether it is given, by the test (dynamic crush or impact speed, where the last knot stands) or by a rule (where
    /// the knots of a crushed structure stand, its unloading, its rate factor): no fit changes it.
    pub of_the_test: bool,
}

impl Parameter {
    const fn new(name: &'static str, kind: ParameterKind) -> Self {
        Self { name, kind, of_the_test: false }
    }

    const fn mass(name: &'static str) -> Self {
        Self::new(name, ParameterKind::Mass)
    }

    const fn spring(name: &'static str) -> Self {
        Self::new(name, ParameterKind::Stiffness)
    }

    const fn damper(name: &'static str) -> Self {
        Self::new(name, ParameterKind::Damping)
    }

    /// The last knots of spring and damper of the nonlinear models.
    const LAST_KNOTS: [Self; 2] = [
        Self { name: "crush_m", kind: ParameterKind::Length, of_the_test: true },
        Self { name: "v0_m_per_s", kind: ParameterKind::Rate, of_the_test: true },
    ];
}

/// Kelvin and Maxwell.
const SPRING_AND_DAMPER: [Parameter; 3] =
    [Parameter::mass("mass_kg"), Parameter::spring("stiffness_n_per_m"), Parameter::damper("damping_n_s_per_m")];

const ELASTOPLASTIC: [Parameter; 3] = [
    Parameter::mass("mass_kg"),
    Parameter::spring("loading_stiffness_n_per_m"),
    Parameter::spring("unloading_stiffness_n_per_m"),
];

const NONLINEAR_1: [Parameter; 9] = [
    Parameter::mass("mass_kg"),
    Parameter::spring("k1_n_per_m"),
    Parameter::spring("k2_n_per_m"),
    Parameter::damper("c1_n_s_per_m"),
    Parameter::damper("c2_n_s_per_m"),
    Parameter::damper("c3_n_s_per_m"),
    Parameter::new("v_thresh_m_per_s", ParameterKind::Rate),
    Parameter::LAST_KNOTS[0],
    Parameter::LAST_KNOTS[1],
];

const NONLINEAR_2: [Parameter; 13] = [
    Parameter::mass("mass_kg"),
    Parameter::spring("k1_n_per_m"),
    Parameter::spring("k2_n_per_m"),
    Parameter::spring("k3_n_per_m"),
    Parameter::new("x1_m", ParameterKind::Length),
    Parameter::damper("c1_n_s_per_m"),
    Parameter::damper("c2_n_s_per_m"),
    Parameter::damper("c3_n_s_per_m"),
    Parameter::damper("c4_n_s_per_m"),
    Parameter::new("v1_m_per_s", ParameterKind::Rate),
    Parameter::new("v2_m_per_s", ParameterKind::Rate),
    Parameter::LAST_KNOTS[0],
    Parameter::LAST_KNOTS[1],
];

const DOUBLE: [Parameter; 6] = [
    Parameter::mass("m1_kg"),
    Parameter::mass("m2_kg"),
    Parameter::spring("k1_n_per_m"),
    Parameter::spring("k2_n_per_m"),
    Parameter::damper("c1_n_s_per_m"),
    Parameter::damper("c2_n_s_per_m"),
];

const TRIPLE: [Parameter; 9] = [
    Parameter::mass("m1_kg"),
    Parameter::mass("m2_kg"),
    Parameter::mass("m3_kg"),
    Parameter::spring("k1_n_per_m"),
    Parameter::spring("k2_n_per_m"),
    Parameter::spring("k3_n_per_m"),
    Parameter::damper("c1_n_s_per_m"),
    Parameter::damper("c2_n_s_per_m"),
    Parameter::damper("c3_n_s_per_m"),
];

/// A parameter that a rule gives.
const fn by_rule(name: &'static str, kind: ParameterKind) -> Parameter {
    Parameter { name, kind, of_the_test: true }
}

/// Knots of a crushed structure at most, that at zero not counted.
pub const MOST_KNOTS: usize = 14;

const KNOT_FORCES: [&str; MOST_KNOTS] = [
    "knot1_n", "knot2_n", "knot3_n", "knot4_n", "knot5_n", "knot6_n", "knot7_n", "knot8_n", "knot9_n", "knot10_n",
    "knot11_n", "knot12_n", "knot13_n", "knot14_n",
];

const KNOT_DEFLECTIONS: [&str; MOST_KNOTS] = [
    "knot1_m", "knot2_m", "knot3_m", "knot4_m", "knot5_m", "knot6_m", "knot7_m", "knot8_m", "knot9_m", "knot10_m",
    "knot11_m", "knot12_m", "knot13_m", "knot14_m",
];

/// Mass, forces at the knots, unloading, rate factor, places of the knots. A model has as many knots as it needs.
const FORCE_DEFLECTION: [Parameter; 3 + 2 * MOST_KNOTS] = {
    let mut parameters = [Parameter::mass("mass_kg"); 3 + 2 * MOST_KNOTS];
    let mut j = 0;
    while j < MOST_KNOTS {
        parameters[1 + j] = Parameter::new(KNOT_FORCES[j], ParameterKind::Force);
        parameters[3 + MOST_KNOTS + j] = by_rule(KNOT_DEFLECTIONS[j], ParameterKind::Length);
        j += 1;
    }
    parameters[1 + MOST_KNOTS] = by_rule("unloading_stiffness_n_per_m", ParameterKind::Stiffness);
    parameters[2 + MOST_KNOTS] = by_rule("rate_s_per_m", ParameterKind::RateFactor);
    parameters
};

/// Load paths of a front with two masses.
pub const LOAD_PATHS: usize = 3;

/// Knots of a load path at most, that at zero not counted.
pub const MOST_KNOTS_OF_PATH: usize = 8;

/// Parameters of a load path: forces at its knots, unloading, rate factor, places of its knots.
pub(crate) const OF_PATH: usize = 2 * MOST_KNOTS_OF_PATH + 2;

/// The parameters of a load path of this name.
macro_rules! load_path {
    ($path:literal: $($knot:literal)+) => {
        [
            $(Parameter::new(concat!($path, "_knot", $knot, "_n"), ParameterKind::Force),)+
            by_rule(concat!($path, "_unloading_n_per_m"), ParameterKind::Stiffness),
            by_rule(concat!($path, "_rate_s_per_m"), ParameterKind::RateFactor),
            $(by_rule(concat!($path, "_knot", $knot, "_m"), ParameterKind::Length),)+
        ]
    };
}

/// Two masses, then path by path: from the barrier to the first mass, from there to the second, from the barrier to the
/// second. A model has the knots and the paths that it needs.
const TWO_MASSES: [Parameter; 2 + LOAD_PATHS * OF_PATH] = {
    const PATHS: [[Parameter; OF_PATH]; LOAD_PATHS] = [
        load_path!("front": 1 2 3 4 5 6 7 8),
        load_path!("rear": 1 2 3 4 5 6 7 8),
        load_path!("parallel": 1 2 3 4 5 6 7 8),
    ];
    let mut parameters = [Parameter::mass("m1_kg"); 2 + LOAD_PATHS * OF_PATH];
    parameters[1] = Parameter::mass("m2_kg");
    let mut i = 0;
    while i < LOAD_PATHS * OF_PATH {
        parameters[2 + i] = PATHS[i / OF_PATH][i % OF_PATH];
        i += 1;
    }
    parameters
};

/// The names of a table.
const fn names<const N: usize>(parameters: &[Parameter; N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = parameters[i].name;
        i += 1;
    }
    names
}

impl ModelKind {
    /// Its parameters, masses first: the order in which solvers and derivatives count them.
    ///
    /// A name occurs once; the last knots of the nonlinear models come last. Of the knots of a crushed structure a
    /// model has as many as it needs. A chain has no table: see `Model::names`.
    pub const fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::Kelvin | Self::Maxwell => &SPRING_AND_DAMPER,
            Self::Elastoplastic => &ELASTOPLASTIC,
            Self::Nonlinear1 => &NONLINEAR_1,
            Self::Nonlinear2 => &NONLINEAR_2,
            Self::DoubleSpringMassDamper => &DOUBLE,
            Self::TripleSpringMassDamper => &TRIPLE,
            Self::ForceDeflection => &FORCE_DEFLECTION,
            Self::LoadPaths => &TWO_MASSES,
            Self::Chain | Self::Own => &[],
        }
    }

    /// Names of its parameters, masses first.
    pub const fn parameter_names(self) -> &'static [&'static str] {
        match self {
            Self::Kelvin | Self::Maxwell => const { &names(&SPRING_AND_DAMPER) },
            Self::Elastoplastic => const { &names(&ELASTOPLASTIC) },
            Self::Nonlinear1 => const { &names(&NONLINEAR_1) },
            Self::Nonlinear2 => const { &names(&NONLINEAR_2) },
            Self::DoubleSpringMassDamper => const { &names(&DOUBLE) },
            Self::TripleSpringMassDamper => const { &names(&TRIPLE) },
            Self::ForceDeflection => const { &names(&FORCE_DEFLECTION) },
            Self::LoadPaths => const { &names(&TWO_MASSES) },
            Self::Chain | Self::Own => &[],
        }
    }

    /// The parameter of this name; `None` if the family has none.
    pub fn parameter(self, name: &str) -> Option<&'static Parameter> {
        self.parameters().iter().find(|parameter| parameter.name == name)
    }
}

// Letters and hyphens exactly as [`ModelKind::name`] has them; of crushed structures the kind of one mass. Errors: any
// other text, with all names in the message.

impl FromStr for ModelKind {
    type Err = LumpedError;

    fn from_str(text: &str) -> Result<Self, LumpedError> {
        Self::ALL.into_iter().chain([Self::Chain, Self::Own]).find(|kind| kind.name() == text).ok_or_else(|| {
            LumpedError::UnknownModel {
                given: text.to_owned(),
                expected: {
                    let mut names = Self::ALL.map(Self::name).to_vec();
                    names.dedup();
                    names.extend([Self::Chain, Self::Own].map(Self::name));
                    names.join(", ")
                },
            }
        })
    }
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn every_name_ends_in_the_unit_of_its_kind() {
        for model in ModelKind::ALL {
            for parameter in model.parameters() {
                let symbol = parameter.kind.symbol_of(parameter.name);
                assert_eq!(format!("{symbol}_{}", parameter.kind.unit_in_name()), parameter.name);
                assert_eq!(model.parameter(parameter.name), Some(parameter));
            }
            let names: Vec<_> = model.parameters().iter().map(|parameter| parameter.name).collect();
            assert_eq!(names, model.parameter_names());
            assert!(model.parameters().is_sorted_by_key(|p| p.kind != ParameterKind::Mass), "masses first");
        }
        assert_eq!(ModelKind::Kelvin.parameter("k1_n_per_m"), None);
        assert_eq!(ParameterKind::Length.symbol_of("v1_m_per_s"), "v1_m_per_s");
    }

    #[test]
    fn every_name_reads_back() {
        for kind in ModelKind::ALL {
            let one_mass = if kind == ModelKind::LoadPaths { ModelKind::ForceDeflection } else { kind };
            assert_eq!(kind.name().parse(), Ok(one_mass));
        }
        assert_eq!("chain".parse(), Ok(ModelKind::Chain));
        assert!(matches!("Kelvin".parse::<ModelKind>(), Err(LumpedError::UnknownModel { .. })));
    }
}
