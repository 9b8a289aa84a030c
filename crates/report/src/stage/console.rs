//! What a person at the terminal reads of a run.

use std::path::Path;

use crate::{OverviewLine, Ranking, Run, Summary, overview};
use crumple_stage::{columns, labelled, labelled_and_cut, wrapped};

/// The status, the verdict, the numbers, the gravest warnings and where the rest is.
pub fn lines(run: &Run, ranking: &Ranking, summary: &Summary, report: &Path) -> Vec<String> {
    let verdict = &summary.verdict;
    let columns = columns();
    let sentences = std::iter::once(&verdict.status_sentence).chain(&verdict.sentences);
    let mut printed: Vec<String> = sentences.flat_map(|sentence| wrapped(sentence, columns)).collect();
    let folder = report.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut lines = overview(run, ranking, summary, folder);
    let text = report.display().to_string();
    lines.push(OverviewLine { label: "report".to_owned(), text, code: String::new(), may_be_cut: false });
    let width = lines.iter().map(|line| line.label.chars().count()).max().unwrap_or(0) + 2;
    for OverviewLine { label, text, code, may_be_cut } in &lines {
        let code = if code.is_empty() { String::new() } else { format!(" [{code}]") };
        if *may_be_cut {
            let cut = labelled_and_cut(label, width, text, columns.saturating_sub(code.len()));
            printed.push(cut + &code);
        } else {
            printed.extend(labelled(label, width, &(text.clone() + &code), columns));
        }
    }
    printed
}
