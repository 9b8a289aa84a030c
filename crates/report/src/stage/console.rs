//! What a person at the terminal reads of a run.

use std::ops::Range;
use std::path::Path;

use crate::{OverviewLine, Ranking, Run, Status, Summary, overview};
use crumple_stage::{
    Mark, columns, labelled, painted, printable, say_as_it_is, stderr_has_colours, stdout_has_colours, to_stdout,
    wrapped,
};

/// The status, the verdict, the numbers, the gravest warnings and where the rest is. A terminal with colours shows the
/// word of the status and what happened in the test marked.
#[derive(Debug, Clone, Default)]
pub struct Screen {
    lines: Vec<String>,
    status: Option<Status>,
    /// The lines of the sentence that says what happened.
    answer: Range<usize>,
}

impl Screen {
    /// Of a run whose report is here.
    pub fn of(run: &Run, ranking: &Ranking, summary: &Summary, report: &Path) -> Self {
        let verdict = &summary.verdict;
        let columns = columns();
        let mut lines = wrapped(&verdict.status_sentence, columns);
        let first = lines.len();
        lines.extend(verdict.sentences.first().into_iter().flat_map(|sentence| wrapped(sentence, columns)));
        let answer = first..lines.len();
        lines.extend(verdict.sentences.iter().skip(1).flat_map(|sentence| wrapped(sentence, columns)));
        let folder = report.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut overview = overview(run, ranking, summary, folder);
        let text = report.display().to_string();
        overview.push(OverviewLine { label: "report".to_owned(), text, code: String::new() });
        let width = overview.iter().map(|line| line.label.chars().count()).max().unwrap_or(0) + 2;
        for OverviewLine { label, text, code } in &overview {
            let code = if code.is_empty() { String::new() } else { format!(" [{code}]") };
            lines.extend(labelled(label, width, &(text.clone() + &code), columns));
        }
        Self { lines, status: verdict.status, answer }
    }

    /// Prints it to stderr.
    pub fn say(&self) {
        self.printed(stderr_has_colours()).iter().for_each(|line| say_as_it_is(line));
    }

    /// Prints it to stdout.
    pub(crate) fn to_stdout(&self) -> anyhow::Result<()> {
        to_stdout((self.printed(stdout_has_colours()).join("\n") + "\n").as_bytes())
    }

    fn printed(&self, in_colours: bool) -> Vec<String> {
        let lines = self.lines.iter().map(|line| printable(line).into_owned());
        if !in_colours {
            return lines.collect();
        }
        let of_line = |(k, line): (usize, String)| match self.status.filter(|_| k == 0) {
            Some(status) => match line.strip_prefix(status.word()) {
                Some(rest) => painted(status.word(), mark_of(status)) + rest,
                None => line,
            },
            None if self.answer.contains(&k) => painted(&line, Mark::Answer),
            None => line,
        };
        lines.enumerate().map(of_line).collect()
    }
}

fn mark_of(status: Status) -> Mark {
    match status {
        Status::Usable => Mark::Good,
        Status::UsableWithCare => Mark::Care,
        Status::DoNotUse => Mark::Bad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_add_marks_and_take_no_text_away() {
        let lines =
            ["do not use: why.", "The crush was 1 mm", "at 2 ms.", "peak  3 g \u{1b}[31m"].map(str::to_owned).to_vec();
        let screen = Screen { lines, status: Some(Status::DoNotUse), answer: 1..3 };
        let plain = screen.printed(false);
        assert_eq!(plain[3], "peak  3 g \\u{1b}[31m");
        let painted = screen.printed(true);
        assert!(painted[0].starts_with("\u{1b}[31m") && painted[0].ends_with(": why."), "{painted:?}");
        assert!(painted[1..3].iter().all(|line| line.starts_with("\u{1b}[1m")), "{painted:?}");
        assert_eq!(painted[3], plain[3]);
    }
}
