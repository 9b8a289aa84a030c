//! What a pipeline states of its runs beside the stages: limits within which they are the same, `[diff]`, and remarks
//! that they may have, `[remarks]` with `allow = ["CR210"]`.

use std::path::Path;

use crumple_artifact::{TOLERANCE_HINT, TOPICS, ToleranceRule};
use toml::{Table, Value};

use crate::artifacts::remarks::{NoResult, held, kinds};
use crate::error::Usage;
use crate::joints::invariants;

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
        let what_ends = NoResult::KIND.code.eq_ignore_ascii_case(code)
            || invariants().any(|row| row.kind.code.eq_ignore_ascii_case(code));
        if what_ends {
            let problem =
                format!("remarks.allow names {code}: what contradicts, and a missing result, cannot be allowed");
            return Err(Usage::new(format!("{}: {problem}", path.display())).hint("take it out of the list").into());
        }
        refuse_unknown_code(code).map_err(|error| error.context(format!("{}: remarks.allow", path.display())))?;
    }
    Ok(())
}

/// Errors: no remark has this code. A program that stands for itself alone knows the form of codes only.
pub fn refuse_unknown_code(code: &str) -> anyhow::Result<()> {
    let upper = code.to_ascii_uppercase();
    let digits = upper.strip_prefix("CR").unwrap_or(&upper);
    let is_code = upper.starts_with("CR") && digits.len() == 3 && digits.bytes().all(|byte| byte.is_ascii_digit());
    let known = kinds();
    if is_code && (held().is_empty() || known.iter().any(|kind| kind.code == upper)) {
        return Ok(());
    }
    let meant = known.iter().find(|kind| kind.code.strip_prefix("CR") == Some(digits));
    let hint = meant.map_or_else(
        || {
            "codes stand behind warnings; crumple explain RUN explains those of a run, docs/remarks.md has all"
                .to_owned()
        },
        |kind| format!("did you mean {}?", kind.code),
    );
    Err(Usage::new(format!("no remark has the code {code:?}")).hint(hint).into())
}
