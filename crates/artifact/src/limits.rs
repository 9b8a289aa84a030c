//! Limits within which two results are the same, as people write them: a line a pattern of topics and places.

use serde::{Deserialize, Deserializer};

use crate::json::patterns_meet;

/// What a user allows for one pattern of topics and places.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceRule {
    /// Topic pattern; `*` is any text, `?` one character.
    pub topic: String,
    /// Pattern of the place inside a record.
    pub place: String,
    /// Absolute part; `None`: as without the rule.
    pub abs: Option<f64>,
    /// Relative part; `None`: as without the rule.
    pub rel: Option<f64>,
    /// Not compared at all.
    pub ignore: bool,
}

/// How a line is written, for hints.
pub const TOLERANCE_HINT: &str =
    r#"write lines like "/wave/*" = { abs = 1e-6, rel = 1e-9 }; docs/diff.md has them all"#;

/// Topics that stages write, and the summary beside them.
pub const TOPICS: [&str; 30] = [
    "summary.json",
    "/test",
    "/tests",
    "/damage",
    "/vehicles",
    "/quality/*",
    "/filter/*",
    "/wave/*",
    "/events",
    "/impacts",
    "/metrics",
    "/model/*",
    "/modes/*",
    "/shapes/*",
    "/identification/*",
    "/evidence/*",
    "/response/*",
    "/selection/*",
    "/scan/*",
    "/stabilisation/*",
    "/checks/*",
    "/parameters/*",
    "/matching/*",
    "/recommendation",
    "/simulation/*",
    "/prediction/*",
    "/notes",
    "/concerns",
    "/remarks",
    "/diagnosis",
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table such as { abs = 1e-6, rel = 1e-9 } or { ignore = true }")]
struct Line {
    abs: Option<f64>,
    rel: Option<f64>,
    #[serde(default)]
    ignore: bool,
}

impl ToleranceRule {
    /// Reads the line of a pattern, `{ abs = 1e-6, rel = 1e-9 }` or `{ ignore = true }`. `#<place>` in the pattern may
    /// be left out: everything under the topic. An empty topic: every topic.
    ///
    /// Errors: the pattern, what was found and what was expected, in one text.
    pub fn read<'de>(pattern: &str, line: impl Deserializer<'de>) -> Result<Self, String> {
        let bad = |problem: &str| Err(format!("{pattern:?}: {problem}"));
        let line = match Line::deserialize(line) {
            Ok(line) => line,
            Err(error) => return bad(&error.to_string().trim().replace('\n', " ")),
        };
        for value in [line.abs, line.rel].into_iter().flatten() {
            if !(value.is_finite() && value >= 0.0) {
                return bad(&format!("{value} is no tolerance, expected a number from 0"));
            }
        }
        if line.ignore && (line.abs.is_some() || line.rel.is_some()) {
            return bad("ignore is given together with abs or rel, expected one or the other");
        }
        if !line.ignore && line.abs.is_none() && line.rel.is_none() {
            return bad("no tolerance is given, expected abs, rel or ignore = true");
        }
        let (topic, place) = pattern.split_once('#').unwrap_or((pattern, "*"));
        let topic = if topic.is_empty() { "*" } else { topic };
        Ok(Self { topic: topic.into(), place: place.into(), abs: line.abs, rel: line.rel, ignore: line.ignore })
    }

    /// Characters that are not a star: the more of them, the more is said.
    pub fn length(&self) -> usize {
        self.topic.chars().chain(self.place.chars()).filter(|c| *c != '*').count()
    }

    /// Whether a topic that the format knows can match it.
    pub fn is_of_known_topic(&self) -> bool {
        TOPICS.iter().any(|topic| patterns_meet(&self.topic, topic))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_topics_of_the_format_are_known() {
        let page = include_str!("../../../docs/format.md");
        let cells = page.lines().filter(|line| line.starts_with('|')).filter_map(|line| line.split('|').nth(2));
        let topics = cells.flat_map(|cell| cell.split('`')).filter(|text| text.starts_with('/'));
        let topics: Vec<&str> = topics.map(|topic| topic.split('<').next().unwrap_or_default()).collect();
        assert!(topics.len() > 20, "{topics:?}");
        let is_known = |topic: &&&str| TOPICS.iter().any(|known| known.trim_end_matches('*') == **topic);
        let unknown: Vec<&&str> = topics.iter().filter(|topic| !is_known(topic)).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
    }

    #[test]
    fn a_pattern_is_of_a_known_topic_where_some_text_matches_both() {
        for (pattern, is_known) in [
            ("/metrics#[olc].value", true),
            ("#*_m_per_s", true),
            ("/wave/*/force", true),
            ("*", true),
            ("/event?", true),
            ("*.json#verdict", true),
            ("/predicton/*", false),
            ("metrics", false),
            ("/metrics/*", false),
            ("/model", false),
        ] {
            let rule = ToleranceRule::read(pattern, serde_json::json!({"ignore": true})).unwrap();
            assert_eq!(rule.is_of_known_topic(), is_known, "{pattern}");
        }
    }
}
