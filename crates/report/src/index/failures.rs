//! Runs without a result, by their reason.

use crate::phrases::PHRASES;
use std::collections::BTreeMap;

use crate::drawing::escape::html;
use crate::phrases::words::fill;

use super::indexed_run::{IndexedRun, status};

/// Most runs that are named with a reason.
const NAMED: usize = 20;
/// Most characters of a reason.
const SHOWN: usize = 200;

/// A section of reasons, the most frequent first; empty where every run is done.
pub(super) fn failures(runs: &[IndexedRun<'_>]) -> String {
    let texts = &PHRASES.runs;
    let mut groups: BTreeMap<(i32, String), Vec<&IndexedRun<'_>>> = BTreeMap::new();
    for run in runs.iter().filter(|run| !run.is_done()) {
        groups.entry((run.exit_code, reason(&run.error, &run.name, texts.no_word))).or_default().push(run);
    }
    if groups.is_empty() {
        return String::new();
    }
    let mut groups: Vec<_> = groups.into_iter().collect();
    groups.sort_by_key(|(_, runs)| std::cmp::Reverse(runs.len()));
    let mut out = format!("<section id=\"failures\">\n<h2>{}</h2>\n", texts.failures);
    for ((code, reason), runs) in groups {
        out.push_str(&format!(
            "<details><summary>{} × {}: {}</summary><p>",
            runs.len(),
            status(code),
            html(&shortened(&reason, SHOWN))
        ));
        let names: Vec<String> = runs.iter().take(NAMED).map(|run| run.linked()).collect();
        out.push_str(&names.join(", "));
        if runs.len() > NAMED {
            out.push_str(&fill(texts.and_more, &[("count", (runs.len() - NAMED).to_string())]));
        }
        out.push_str("</p></details>\n");
    }
    out.push_str("</section>\n");
    out
}

/// The line of an error that says why.
pub(super) fn line_of<'a>(error: &'a str, no_word: &'a str) -> &'a str {
    let says_why = |line: &&str| line.contains("caused by:") || line.contains("no acceptable result:");
    let line = error.lines().find(says_why).or_else(|| error.lines().next()).unwrap_or(no_word);
    line.split_once("caused by:").or_else(|| line.split_once("error: ")).map_or(line, |(_, cause)| cause).trim()
}

/// Why a run has no result, without what is particular to one record: its name, texts in quotes, numbers.
fn reason(error: &str, name: &str, no_word: &str) -> String {
    let file = name.rsplit('/').next().unwrap_or(name);
    let line = line_of(error, no_word).replace(name, "…").replace(file, "…");
    let mut reason = String::new();
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => {
                quoted = !quoted;
                reason.push_str(if quoted { "\"…" } else { "\"" });
            }
            _ if quoted => {}
            c if c.is_ascii_digit() => {
                if !reason.ends_with('#') {
                    reason.push('#');
                }
            }
            c => reason.push(c),
        }
    }
    reason
}

/// A text of at most so many characters, cut between words.
pub(super) fn shortened(text: &str, most: usize) -> String {
    let Some((end, _)) = text.char_indices().nth(most) else { return text.to_owned() };
    let cut = &text[..end];
    // A word longer than half of the room is cut itself.
    let cut = cut.rsplit_once(' ').map(|(before, _)| before).filter(|before| before.len() > end / 2).unwrap_or(cut);
    format!("{}…", cut.trim_end_matches([',', ';', ':', ' ', '(']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_fault_of_two_records_is_one_reason() {
        let of = |name: &str, line: u32, word: &str| {
            let error = format!("error: cannot read {name}\n  caused by: {name}, line {line}: \"{word}\" is no number");
            reason(&error, name, "")
        };
        assert_eq!(of("a/b.csv", 7, "x"), of("c.csv", 12, "nothing"));
        assert_eq!(of("c.csv", 12, "x"), "…, line #: \"…\" is no number");
    }

    #[test]
    fn a_long_text_is_cut_between_words() {
        assert_eq!(shortened("the pulse is short", 18), "the pulse is short");
        assert_eq!(shortened("the pulse is, short", 14), "the pulse is…");
        assert_eq!(shortened(&"ä".repeat(30), 10), format!("{}…", "ä".repeat(10)));
    }
}
