//! One of the runs that are compared.

use crate::findings::{CandidateResult, Ranking, Run};

/// A run under the name that the comparison calls it.
#[derive(Debug)]
pub struct ComparedRun {
    /// Short and unlike the others.
    pub name: String,
    /// Address of its report; `None`: it has none.
    pub report: Option<String>,
    /// What its artifacts say.
    pub run: Run,
    /// The order of its candidates.
    pub ranking: Ranking,
}

impl ComparedRun {
    /// The candidate that its run recommends.
    pub fn recommended(&self) -> Option<&CandidateResult> {
        self.run.candidate(self.ranking.best.as_deref()?)
    }
}
