//! What an assessment says of one candidate.

use crumple_lumped_fit::{Assessment, DualScale, Propagation};

/// The verdict on one candidate.
#[derive(Debug, Clone)]
pub struct CandidateAssessment {
    pub assessment: Assessment,
    pub propagation: Option<Propagation>,
    /// What the propagation repeated: a fit or a closed form.
    pub repeated: &'static str,
    /// Whether the model was followed through the filter of the record.
    pub through_filter: bool,
}

impl CandidateAssessment {
    /// The verdict on the dual of the model judged.
    pub fn of_dual(&self, dual: &DualScale) -> Self {
        Self {
            assessment: self.assessment.of_dual(dual),
            propagation: self.propagation.as_ref().map(|p| dual.propagation(p)),
            repeated: self.repeated,
            through_filter: self.through_filter,
        }
    }
}
