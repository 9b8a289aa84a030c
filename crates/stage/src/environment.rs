//! The variables of the environment that the project reads, in one list: any other that looks like one is refused.

use std::sync::LazyLock;

use crate::error::{REASON_FILE, Usage};
use crate::names::chain;
use crate::typed::IN_RUN;

/// What begins the names of all variables.
const PREFIX: &str = "CRUMPLE_";

/// Variables beside those of the stages: of programs, of the recipes, of CI, of tests, of what writes documents again.
const OTHERS: [&str; 30] = [
    IN_RUN,
    REASON_FILE,
    "CRUMPLE_AUTHOR",
    "CRUMPLE_BENCH",
    "CRUMPLE_BENCH_COUNTED",
    "CRUMPLE_BROWSER",
    "CRUMPLE_BUILD",
    "CRUMPLE_COMMENT",
    "CRUMPLE_EXPECTED",
    "CRUMPLE_FAIL_ON",
    "CRUMPLE_FLEET_RECORDS",
    "CRUMPLE_FRESH",
    "CRUMPLE_KILLS",
    "CRUMPLE_KNOWN_TRUTH",
    "CRUMPLE_NO_BROWSER",
    "CRUMPLE_OUT",
    "CRUMPLE_PAGE",
    "CRUMPLE_PROFILE",
    "CRUMPLE_PROGRAM",
    "CRUMPLE_RECORDS",
    "CRUMPLE_SHARED",
    "CRUMPLE_SLURM",
    "CRUMPLE_SLURM_FOR",
    "CRUMPLE_TOLERANCE",
    "CRUMPLE_WHEEL",
    "CRUMPLE_WRITE_COMMENT",
    "CRUMPLE_WRITE_DOCS",
    "CRUMPLE_WRITE_NOTEBOOK",
    "CRUMPLE_WRITE_PAPERS",
    "CRUMPLE_WRITE_SCHEMAS",
];

/// Most letters that may be wrong in the name of a stage's variable for it to be meant.
const MISTYPED: usize = 2;

static OF_STAGES: LazyLock<Vec<String>> = LazyLock::new(|| chain().map(|stage| variable_of(stage.name)).collect());

/// The variable that names the program of a stage: `CRUMPLE_PARAMETER_SOLVE`.
pub fn variable_of(stage: &str) -> String {
    format!("{PREFIX}{}", stage.to_ascii_uppercase().replace('-', "_"))
}

/// All variables that the project reads.
pub fn variables() -> impl Iterator<Item = &'static str> {
    OF_STAGES.iter().map(String::as_str).chain(OTHERS)
}

/// Errors: the environment has a variable that nothing reads, and its name begins with `CRUMPLE_` or is two letters
/// away from that of a stage: what it was to do would not be done.
pub fn refuse_unknown_variables() -> Result<(), Usage> {
    let mut names: Vec<String> = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok()).collect();
    names.sort();
    names.iter().try_for_each(|name| refuse_unknown(name))
}

fn refuse_unknown(name: &str) -> Result<(), Usage> {
    if variables().any(|known| known == name) {
        return Ok(());
    }
    let typed = name.to_ascii_uppercase();
    let distance = |known: &str| strsim::osa_distance(&typed, known);
    let is_mistyped = OF_STAGES.iter().any(|known| distance(known) <= MISTYPED);
    if !is_mistyped && !name.starts_with(PREFIX) {
        return Ok(());
    }
    let near = variables().min_by_key(|known| distance(known)).unwrap_or_default();
    let problem = format!("nothing reads the variable {name} of the environment; nothing was run");
    Err(Usage::new(problem).hint(format!("did you mean {near}? Else: unset {name}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_that_nothing_reads_is_refused_with_the_nearest() {
        for (name, near) in [
            ("CRUMPLE_FILTR", "CRUMPLE_FILTER"),
            ("CRUMPLE_FILTERS", "CRUMPLE_FILTER"),
            ("CRUMPEL_INTEGRATE", "CRUMPLE_INTEGRATE"),
            ("crumple_identify", "CRUMPLE_IDENTIFY"),
            ("CRUMPLE_PARAMETERS_SOLVE", "CRUMPLE_PARAMETER_SOLVE"),
            ("CRUMPLE_SHARE", "CRUMPLE_SHARED"),
        ] {
            let error = refuse_unknown(name).unwrap_err();
            let problem = format!("nothing reads the variable {name} of the environment; nothing was run");
            assert_eq!(error, Usage::new(problem).hint(format!("did you mean {near}? Else: unset {name}")));
        }
        for name in ["CRUMPLE_FILTER", "CRUMPLE_IN_RUN", "PATH", "FILTER", "CRUMBS"] {
            assert_eq!(refuse_unknown(name), Ok(()), "{name}");
        }
    }
}
