//! One of the runs that are compared.

use super::expected::Limits;
use crate::findings::{CandidateResult, Ranking, Run, Summary, summary};

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
    /// What a script reads of it.
    pub summary: Summary,
    /// The limits within which its pipeline says that runs are the same.
    pub limits: Limits,
}

impl ComparedRun {
    /// A run under a name; `report` is the address of its page.
    pub fn new(name: String, report: Option<String>, run: Run) -> Self {
        let ranking = Ranking::of_run(&run);
        let summary = summary(&run, &ranking);
        Self { name, report, run, ranking, summary, limits: Limits::new() }
    }

    /// The candidate that its run recommends.
    pub fn recommended(&self) -> Option<&CandidateResult> {
        self.run.candidate(self.ranking.best.as_deref()?)
    }
}
