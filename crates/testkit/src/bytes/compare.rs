//! Compares two lists of digests, line by line.

use std::collections::BTreeMap;
use std::fmt;

/// How a file differs between two lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Difference {
    /// The content is the same: provenance, schemas or layout differ.
    AroundContent,
    /// Only texts of the content differ.
    Texts,
    /// Numbers, names or the number of records differ; of a process, its exit code.
    Content,
    /// Only the first list has it.
    OnlyInFirst,
    /// Only the second list has it.
    OnlyInSecond,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AroundContent => "around the content",
            Self::Texts => "texts",
            Self::Content => "content",
            Self::OnlyInFirst => "only in the first",
            Self::OnlyInSecond => "only in the second",
        })
    }
}

/// Digests by file.
type Lines<'a> = BTreeMap<&'a str, [&'a str; 3]>;

fn lines(list: &str) -> Result<Lines<'_>, String> {
    list.lines()
        .filter(|line| !line.is_empty())
        .map(|line| {
            let mut parts = line.splitn(4, "  ");
            match [parts.next(), parts.next(), parts.next(), parts.next()] {
                [Some(whole), Some(content), Some(masked), Some(file)] => Ok((file, [whole, content, masked])),
                _ => Err(format!("no list of digests: {line:?}")),
            }
        })
        .collect()
}

/// The files that differ, by name.
///
/// # Errors
/// A line that is none of such a list.
pub fn compare<'a>(first: &'a str, second: &'a str) -> Result<Vec<(&'a str, Difference)>, String> {
    let (first, second) = (lines(first)?, lines(second)?);
    let mut differences = Vec::new();
    for (file, [whole, content, masked]) in &first {
        let difference = match second.get(file) {
            None => Difference::OnlyInFirst,
            Some(other) if other == &[*whole, *content, *masked] => continue,
            Some([_, _, other]) if other != masked => Difference::Content,
            Some([_, other, _]) if other != content => Difference::Texts,
            Some(_) => Difference::AroundContent,
        };
        differences.push((*file, difference));
    }
    let added = second.keys().filter(|file| !first.contains_key(*file));
    differences.extend(added.map(|file| (*file, Difference::OnlyInSecond)));
    differences.sort_unstable();
    Ok(differences)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn every_kind_of_difference_is_named() {
        let first = "a  b  c  one\na  b  c  two\na  b  c  three\na  b  c  four\na  b  c  five\n";
        let second = "a  b  c  one\nx  b  c  two\nx  y  c  three\nx  y  z  four\na  b  c  six\n";
        let expected = [
            ("five", Difference::OnlyInFirst),
            ("four", Difference::Content),
            ("six", Difference::OnlyInSecond),
            ("three", Difference::Texts),
            ("two", Difference::AroundContent),
        ];
        assert_eq!(compare(first, second).unwrap(), expected);
        assert_eq!(compare(first, first).unwrap(), []);
        assert!(compare("a b c", first).is_err());
    }
}
