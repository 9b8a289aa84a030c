//! Tolerances as a user writes them: TOML, one line a pattern.

use serde::Deserialize;

use crate::DiffError;

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

impl ToleranceRule {
    /// Characters that are not a star: the more of them, the more is said.
    pub(crate) fn length(&self) -> usize {
        self.topic.chars().chain(self.place.chars()).filter(|c| *c != '*').count()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    abs: Option<f64>,
    rel: Option<f64>,
    #[serde(default)]
    ignore: bool,
}

/// Reads the text of a tolerance file: `"<topic>#<place>" = { abs = 1e-6, rel = 1e-9 }` or `{ ignore = true }`.
///
/// `#<place>` may be left out: everything under the topic. An empty topic: every topic.
pub fn parse_rules(text: &str) -> Result<Vec<ToleranceRule>, DiffError> {
    let lines: std::collections::BTreeMap<String, Line> =
        toml::from_str(text).map_err(|error| DiffError::Tolerance(error.to_string().trim_end().to_owned()))?;
    lines.into_iter().map(|(pattern, line)| rule(&pattern, line)).collect()
}

fn rule(pattern: &str, line: Line) -> Result<ToleranceRule, DiffError> {
    let bad = |problem: &str| Err(DiffError::Tolerance(format!("{pattern:?}: {problem}")));
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
    Ok(ToleranceRule { topic: topic.into(), place: place.into(), abs: line.abs, rel: line.rel, ignore: line.ignore })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_is_wrong_with_a_line() {
        let problem = |text: &str| parse_rules(text).unwrap_err().to_string();
        insta::assert_snapshot!(
            problem("\"/a\" = { abs = -1.0 }"),
            @"tolerances: \"/a\": -1 is no tolerance, expected a number from 0"
        );
        insta::assert_snapshot!(
            problem("\"/a\" = {}"),
            @"tolerances: \"/a\": no tolerance is given, expected abs, rel or ignore = true"
        );
        insta::assert_snapshot!(
            problem("\"/a\" = { ignore = true, abs = 1.0 }"),
            @"tolerances: \"/a\": ignore is given together with abs or rel, expected one or the other"
        );
        assert!(problem("\"/a\" = { relative = 1.0 }").contains("unknown field `relative`"));
        assert!(problem("\"/a\" = nan").contains("TOML parse error at line 1"));
    }
}
