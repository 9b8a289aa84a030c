//! Whose a flag is that the first stage does not know.

use std::ffi::OsString;

use crumple_stage::{Pipeline, chain, say};

/// Flags behind the record go to the first stage: says of each that is an option of another stage in this pipeline, and
/// of options of other stages in general, how they are set.
pub(crate) fn say_whose_flags(flags: &[OsString], pipeline: &Pipeline) {
    let mut is_told = flags.is_empty();
    for flag in flags {
        let flag = flag.to_string_lossy();
        let Some(option) = flag.strip_prefix("--").and_then(|flag| flag.split('=').next()) else { continue };
        let has = |stage: &str| pipeline.table(stage).is_some_and(|t| t.contains_key(&option.replace('-', "_")));
        for stage in chain().skip(1).filter(|stage| has(stage.name)) {
            is_told = true;
            say(format_args!("tip: --{option} is an option of {0}: --set {0}.{option}=VALUE", stage.name));
        }
    }
    if !is_told {
        say("tip: flags behind the record go to ingest; for options of other stages: --set STAGE.OPTION=VALUE");
    }
}
