//! What a pipeline states of its runs beside the stages: limits within which they are the same, `[diff]`, and remarks
//! that they may have, `[remarks]` with `allow = ["CR210"]`.

use std::path::Path;

use crumple_artifact::{TOLERANCE_HINT, TOPICS, ToleranceRule};
use toml::{Table, Value};

use crate::error::Usage;

/// The table of the limits.
pub const LIMITS: &str = "diff";
/// The table of the remarks.
pub const REMARKS: &str = "remarks";
/// Its one key.
pub const ALLOW: &str = "allow";

/// Letters that differ in a topic that was mistyped.
const MISTYPED: usize = 2;

/// Errors: a limit that is none, or a pattern near to a topic of the stages that matches none of them.
pub fn refuse_wrong_limits(path: &Path, limits: &Table) -> Result<(), Usage> {
    for (pattern, line) in limits {
        let refused = |problem: String| Usage::new(format!("{}, [{LIMITS}]: {problem}", path.display()));
        let rule =
            ToleranceRule::read(pattern, line.clone()).map_err(|problem| refused(problem).hint(TOLERANCE_HINT))?;
        let is_near = |topic: &&str| strsim::damerau_levenshtein(topic, &rule.topic) <= MISTYPED;
        let near = TOPICS.iter().copied().find(is_near).filter(|_| !rule.is_of_known_topic());
        if near.is_some() || !(rule.topic.starts_with(['/', '*', '?']) || rule.topic.contains('.')) {
            let near = near.unwrap_or("/metrics");
            return Err(refused(format!("{pattern:?}: no stage writes a topic {:?}", rule.topic)).hint(format!(
                "did you mean {near:?}? docs/format.md has all; one of your own: crumple diff A B --tolerance FILE"
            )));
        }
    }
    Ok(())
}

/// Errors: the table of remarks holds more than a list of codes, or a code that no remark has.
pub fn refuse_wrong_codes(path: &Path, table: &Value) -> anyhow::Result<()> {
    let refused = |problem: String| {
        let hint = "[remarks] with allow = [\"CR210\"], codes as the warnings print them";
        Usage::new(format!("{}: {problem}", path.display())).hint(hint)
    };
    let Value::Table(table) = table else { return Err(refused("remarks is not a table".to_owned()).into()) };
    if let Some(key) = table.keys().find(|key| *key != ALLOW) {
        return Err(refused(format!("unknown key {key:?} of [remarks]")).into());
    }
    let codes = table.get(ALLOW).map_or(Some(&[][..]), |list| list.as_array().map(Vec::as_slice));
    let codes = codes.ok_or_else(|| refused("remarks.allow is no list".to_owned()))?;
    for code in codes {
        let code = code.as_str().ok_or_else(|| refused(format!("remarks.allow holds {code}, which is no text")))?;
        if !is_code(code) {
            return Err(refused(format!("remarks.allow holds {code:?}, which is no code")).into());
        }
    }
    Ok(())
}

/// Whether a text has the form of a code: `CR210`.
pub fn is_code(text: &str) -> bool {
    let digits = text.get(..2).filter(|front| front.eq_ignore_ascii_case("CR")).map_or("", |_| &text[2..]);
    digits.len() == 3 && digits.bytes().all(|byte| byte.is_ascii_digit())
}
