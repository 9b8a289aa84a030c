//! The families of models.
//!
//! The names are part of the file format: candidates, pipelines and summaries carry them.

use std::fmt;

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
}

impl ModelKind {
    /// All kinds.
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
        }
    }
}

impl fmt::Display for ModelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
