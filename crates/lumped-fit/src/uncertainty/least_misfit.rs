//! Where a model meets the accelerations best: what the evidence for it is taken at.

use std::collections::BTreeMap;

/// Where a model meets the accelerations best: a fit to the displacement, which sums their errors twice, is elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastMisfit {
    /// The free numbers there, by name, in the unit of each.
    pub parameters: BTreeMap<String, f64>,
    /// Those of them that stand on no bound.
    pub inside: Vec<String>,
}
