//! Runs without a result, by their reason.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::page::markup::{escaped, link};
use crate::tables::rows::Row;
use crate::tables::tests_table::status;

/// Most records that are named with a reason.
const NAMED: usize = 20;

/// A list of reasons, the most frequent first; empty where every run is done.
pub(crate) fn failures(rows: &[Row]) -> String {
    let mut groups: BTreeMap<(i32, String), Vec<&Row>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.ended.exit_code != 0) {
        let reason = reason(&row.ended.error, &row.run.record.identity);
        groups.entry((row.ended.exit_code, reason)).or_default().push(row);
    }
    let mut groups: Vec<_> = groups.into_iter().collect();
    groups.sort_by_key(|(_, rows)| std::cmp::Reverse(rows.len()));
    let mut html = String::new();
    for ((code, reason), rows) in groups {
        // Writing to a string does not fail.
        let _ = write!(html, "<details><summary>{} × {}: {}</summary><p>", rows.len(), status(code), escaped(&reason));
        for row in rows.iter().take(NAMED) {
            let name = escaped(&row.run.record.identity);
            let _ = match row.summary {
                Some(_) => write!(html, "<a href=\"{}/report.html\">{name}</a> ", link(&row.run.folder)),
                None => write!(html, "<span title=\"{}\">{name}</span> ", escaped(&row.ended.error)),
            };
        }
        if rows.len() > NAMED {
            let _ = write!(html, "and {} more", rows.len() - NAMED);
        }
        html.push_str("</p></details>");
    }
    html
}

/// Why a run has no result, without what is particular to one record: its name, texts in quotes, numbers.
fn reason(error: &str, identity: &str) -> String {
    let says_why = |line: &&str| line.contains("caused by:") || line.contains("no acceptable result:");
    let line = error.lines().find(says_why).or_else(|| error.lines().next()).unwrap_or("no word of why");
    let line = line.split_once("caused by:").or_else(|| line.split_once("error: ")).map_or(line, |(_, cause)| cause);
    let file = identity.rsplit('/').next().unwrap_or(identity);
    let line = line.replace(identity, "…").replace(file, "…");
    let mut reason = String::new();
    let mut quoted = false;
    for c in line.trim().chars() {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_fault_of_two_records_is_one_reason() {
        let of = |name: &str, line: u32, word: &str| {
            let error = format!("error: cannot read {name}\n  caused by: {name}, line {line}: \"{word}\" is no number");
            reason(&error, name)
        };
        assert_eq!(of("a/b.csv", 7, "x"), of("c.csv", 12, "nothing"));
        assert_eq!(of("c.csv", 12, "x"), "…, line #: \"…\" is no number");
    }
}
