//! What a crate may ask a run for: options of stages, and nothing that names a file to write or to delete.

use std::path::Path;

use crumple_stage::{Refused, is_shared_flag};

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
            name.len() > 2 && name.starts_with("--") && !is_shared_flag(name) && !group.iter().any(is_short)
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
        assert_eq!(kept("--mass=9kg --compress zstd --memory-limit=2GiB"), "--mass=9kg");
        for words in
            ["--dependent x", "-o x", "--mass 1kg -ox", "--output=x", "--pipeline x", "x", "-- x", "--check-options"]
        {
            assert_eq!(asked("filter", words), None, "{words}");
        }
        assert_eq!(asked("report", "--markdown x"), None);
    }
}
