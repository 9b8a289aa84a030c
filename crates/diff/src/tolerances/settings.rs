//! Settings of a comparison.

use super::table::Tolerances;

/// What counts as different.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CompareSettings {
    /// Tolerance by topic and place.
    pub tolerances: Tolerances,
    /// Whether -0.0 and 0.0 differ.
    pub bits: bool,
    /// Whether another stage version, configuration or input is a difference by itself.
    pub provenance: bool,
}
