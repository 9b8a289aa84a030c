//! What a crate may ask a run for: options of stages, and nothing that names a file to write or to delete.

use std::path::Path;

use crumple_stage::{Refused, is_shared_flag};

use crate::command::{OWN_BEHIND_RECORD, Options};
use crate::recipe::{Typed, flag_name, grouped};
use crate::words::Words;

/// Flags that change no result.
const WITHOUT_EFFECT: [&str; 5] = ["--compress", "--memory-limit", "--json", "--force", "--quiet"];

/// What was typed for a run, without what changes no result. `file` says whose flags they are.
///
/// A crate comes from anybody, and its flags go to stages that write: `--dependent FILE` deletes a file. The flags of
/// the report only name files.
///
/// Errors: a flag that is no option of a stage, or one of the report.
pub(crate) fn repeatable(typed: Typed, file: &Path) -> Result<Typed, Refused> {
    let checked = |stage: &str, words: &[String]| -> Result<Vec<Vec<String>>, Refused> {
        let mut groups = grouped(words);
        groups.retain(|group| !WITHOUT_EFFECT.contains(&flag_name(group)));
        let is_short = |word: &String| word.strip_prefix('-').is_some_and(|rest| rest.starts_with(char::is_alphabetic));
        let is_option = |group: &Vec<String>| {
            let name = flag_name(group);
            let is_long = name.len() > 2 && name.starts_with("--") && !group.iter().any(is_short);
            is_long && !is_shared_flag(name) && has_its_words(group, stage)
        };
        match groups.iter().find(|group| stage == "report" || !is_option(group)) {
            None => Ok(groups),
            Some(flag) => Err(Refused::new(format!("{}: flag of {stage}: {}", file.display(), Words(flag.clone())))
                .expected("options of stages, which write no file of their own")
                .hint("run the record again without it, and make the passport of that run")),
        }
    };
    let mut flags = typed.flags;
    for (stage, groups) in &mut flags {
        *groups = checked(stage, &groups.concat())?;
    }
    let words: Words = typed.of_all.parse().unwrap_or_default();
    let of_all = checked("every stage", &words)?.concat();
    Ok(Typed { flags, of_all: Words(of_all).to_string(), programs: typed.programs })
}

/// Whether a flag has as many words as it takes. Those of ingest stand among the flags of a run, which has some that
/// name programs and folders: they must be its own.
fn has_its_words(group: &[String], stage: &str) -> bool {
    let is_whole = group[0].contains('=');
    if stage != "ingest" {
        return group.len() <= if is_whole { 1 } else { 2 };
    }
    let long = flag_name(group).trim_start_matches('-');
    let ingest = (crumple_ingest::PROGRAM.command)();
    let of_run = <Options as clap::CommandFactory>::command();
    let is_taken = OWN_BEHIND_RECORD.iter().any(|(flag, _)| *flag == flag_name(group));
    let is_of_run = is_taken || of_run.get_arguments().any(|arg| arg.get_long() == Some(long));
    let own = ingest.get_arguments().find(|arg| arg.get_long() == Some(long)).filter(|_| !is_of_run);
    own.is_some_and(|arg| {
        let takes_word = arg.get_action().takes_values() && !is_whole && !arg.is_require_equals_set();
        group.len() == 1 + usize::from(takes_word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(stage: &str, words: &str) -> Option<String> {
        let words: Words = words.parse().unwrap();
        let flags = [(stage.to_owned(), grouped(&words))].into();
        let typed = Typed { flags, of_all: String::new(), programs: std::collections::BTreeMap::new() };
        repeatable(typed, Path::new("x")).ok().map(|typed| Words(typed.flags[stage].concat()).to_string())
    }

    #[test]
    fn options_of_stages_stay_and_what_names_a_file_is_refused() {
        let kept = |words: &str| asked("ingest", words).unwrap();
        assert_eq!(kept("--mass 1450kg --time-zero -5ms"), "--mass 1450kg --time-zero -5ms");
        assert_eq!(kept("--mass=9kg --compress zstd --memory-limit=2GiB"), "'--mass=9kg'");
        for words in
            ["--dependent x", "-o x", "--mass 1kg -ox", "--output=x", "--pipeline x", "x", "-- x", "--check-options"]
        {
            assert_eq!(asked("filter", words), None, "{words}");
        }
        for words in [
            "--stage filter=true",
            "--stage=filter=true",
            "--set filter.cfc=60",
            "--out x",
            "--project x",
            "--again x",
            "--mass=9kg x",
            "--mass 9kg x",
            "--allow-missing x",
            "--unknown x",
        ] {
            assert_eq!(asked("ingest", words), None, "{words}");
        }
        assert_eq!(kept("--allow-missing --sign flip"), "--allow-missing --sign flip");
        assert_eq!(asked("report", "--markdown x"), None);
    }
}
