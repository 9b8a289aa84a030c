//! The kinds of remarks that a process knows, and the stages that it holds.

use std::sync::OnceLock;

use crumple_signal::Kind;

use crate::artifacts::remarks::{NoResult, REMARKS};
use crate::command_line::of_runs::is_code;
use crate::error::Usage;
use crate::joints::invariants;
use crate::process::Program;

/// The stages that this process holds.
static HELD: OnceLock<&[Program]> = OnceLock::new();

/// From now on this process stands for these stages.
pub fn hold(stages: &'static [Program]) {
    HELD.get_or_init(|| stages);
}

/// The stages that this process holds; none where a program stands for itself alone.
pub fn held() -> &'static [Program] {
    HELD.get().copied().unwrap_or_default()
}

/// Every kind of remark that this process knows, in the order of the codes: those of the stages that it holds, what
/// contradicts, and what every stage can say.
pub fn kinds() -> Vec<&'static Kind> {
    let of_stages = held().iter().flat_map(|stage| stage.remarks).copied().flatten().copied();
    let mut all: Vec<&Kind> =
        of_stages.chain(invariants().map(|row| &row.kind)).chain(REMARKS.iter().copied()).collect();
    all.sort_by_key(|kind| kind.code);
    all.dedup_by_key(|kind| kind.code);
    all
}

/// Errors: no remark has this code. A program that stands for itself alone knows the form of codes only.
pub fn refuse_unknown_code(code: &str) -> anyhow::Result<()> {
    let upper = code.to_ascii_uppercase();
    let digits = upper.strip_prefix("CR").unwrap_or(&upper);
    let known = kinds();
    if is_code(&upper) && (held().is_empty() || known.iter().any(|kind| kind.code == upper)) {
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

/// Errors: a remark that a pipeline cannot allow: of no kind, or what contradicts, or a missing result.
pub fn refuse_not_to_be_allowed(code: &str) -> anyhow::Result<()> {
    refuse_unknown_code(code)?;
    if code == NoResult::KIND.code || invariants().any(|row| row.kind.code == code) {
        let problem = format!("{code} cannot be allowed: it says what contradicts, or that a result is missing");
        return Err(Usage::new(problem).hint("take it out of remarks.allow of the pipeline").into());
    }
    Ok(())
}
