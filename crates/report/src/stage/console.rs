//! What a person at the terminal reads of a run.

use std::path::Path;

use crumple_artifact::records::ConcernV1;
use crumple_report::{Conclusion, Ranking, Run, overview};
use crumple_stage::{columns, labelled, say, wrapped};

/// Prints the verdict, the numbers, the gravest warnings and where the rest is.
pub fn print(run: &Run, ranking: &Ranking, verdict: &Conclusion, concerns: &[ConcernV1], report: &Path) {
    let columns = columns();
    for sentence in &verdict.sentences {
        wrapped(sentence, columns).iter().for_each(say);
    }
    let folder = report.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let notes = format!("just notes {}", folder.display());
    let mut lines = overview(run, ranking, verdict, concerns, &notes);
    lines.push((run.language.phrases().conclusion.files_label.to_owned(), report.display().to_string()));
    let width = lines.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(0) + 2;
    for (label, text) in &lines {
        labelled(label, width, text, columns).iter().for_each(say);
    }
}
