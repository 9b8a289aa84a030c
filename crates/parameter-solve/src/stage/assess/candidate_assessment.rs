//! The assessment of one candidate, with the propagation of uncertain inputs.

use crumple_lumped_fit::{Assessment, Propagation};

/// How well the parameters of one candidate are determined, and how that was found.
#[derive(Debug, Clone)]
pub struct CandidateAssessment {
    pub assessment: Assessment,
    pub propagation: Option<Propagation>,
    /// What the propagation repeated: a fit or a closed form.
    pub repeated: &'static str,
    /// Whether the model was followed through the filter of the record.
    pub through_filter: bool,
    /// Half width of the share of the mass in front that is in the intervals; 0: none.
    pub front_mass_uncertainty: f64,
}
