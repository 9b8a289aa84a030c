//! The notes of artifacts alone: warnings by weight, then what is good to know, each with its stage.

use crumple_artifact::records::{ConcernV1, ConcernsV2, NotesV1};
use crumple_artifact::{Artifact, ReadError};
use crumple_signal::{About, Note, Severity, Weight};

/// What stages remarked.
#[derive(Debug, Default)]
pub struct StageNotes {
    /// What speaks against the results.
    pub concerns: Vec<ConcernV1>,
    /// What is good to know: stage and text.
    pub infos: Vec<(String, String)>,
}

impl StageNotes {
    /// Gathers the notes of artifacts, each once, warnings that change most first. A warning that no `/concerns` weighs
    /// has the least weight.
    pub fn of<'a>(artifacts: impl IntoIterator<Item = &'a Artifact>) -> Result<Self, ReadError> {
        let mut all = Self::default();
        for artifact in artifacts {
            let concerns = artifact.record::<ConcernsV2>("/concerns")?.map_or(Vec::new(), |record| record.concerns);
            concerns.into_iter().for_each(|concern| all.add(concern));
            let Some(NotesV1 { stage, notes }) = artifact.record("/notes")? else { continue };
            for note in notes.iter().map(|text| Note::parse(text)) {
                match note.severity {
                    Severity::Warning if all.is_known(&stage, &note.text) => {}
                    Severity::Warning => all.add(ConcernV1 {
                        about: About::of_stage(&stage).to_string(),
                        stage: stage.clone(),
                        severity: ConcernV1::WARNING.to_owned(),
                        weight: Weight::Slight.number(),
                        text: note.text,
                        remedy: None,
                    }),
                    Severity::Info => all.infos.push((stage.clone(), note.text)),
                }
            }
        }
        // The sort is stable: equals stay in the order of the stages.
        all.concerns
            .sort_by_key(|concern| std::cmp::Reverse((concern.severity == ConcernV1::NO_RESULT, concern.weight)));
        Ok(all)
    }

    /// The same with the concerns of a run's `summary.json`, which weighs them by what it shows.
    #[must_use]
    pub fn ranked_as(mut self, concerns: Vec<ConcernV1>) -> Self {
        self.concerns = concerns;
        self
    }

    fn is_known(&self, stage: &str, text: &str) -> bool {
        self.concerns.iter().any(|concern| concern.stage == stage && concern.text == text)
    }

    fn add(&mut self, concern: ConcernV1) {
        if !self.is_known(&concern.stage, &concern.text) {
            self.concerns.push(concern);
        }
    }

    /// A label (mark, weight, stage) and a text for each of them; what to do has no label.
    pub fn lines(&self) -> Vec<(String, String)> {
        let mut lines = Vec::new();
        for ConcernV1 { stage, severity, weight, text, remedy, .. } in &self.concerns {
            let mark = if severity == ConcernV1::NO_RESULT { "none" } else { "warning" };
            lines.push((format!("{mark:<8}{weight:<3}{stage}"), text.clone()));
            lines.extend(remedy.iter().map(|remedy| (String::new(), format!("what to do: {remedy}"))));
        }
        lines.extend(self.infos.iter().map(|(stage, text)| (format!("{:<11}{stage}", "note"), text.clone())));
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_has_its_stage_in_front() {
        let infos = vec![("ingest".to_owned(), "a note on one record".to_owned())];
        let notes = StageNotes { infos, ..StageNotes::default() };
        assert_eq!(notes.lines(), [("note       ingest".to_owned(), "a note on one record".to_owned())]);
    }
}
