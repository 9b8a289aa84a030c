//! The command line of `crumple-together`.

use std::ffi::OsString;
use std::path::PathBuf;

use crumple_stage::Usage;

use crate::command::Words;

/// Fits one model to several tests, and predicts every test from the others.
///
/// The recipe `together` of the justfile calls it. Each record has its ordinary run first; then the joint fit, its
/// predictions, and for each test a fit to the others that predicts it: into one folder, with summary.json.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-together",
    version,
    after_help = "Exit codes: 0 done, 1 a program failed unforeseen, 2 usage, 3 a record refused, 4 no acceptable \
                  result (its diagnosis is written)."
)]
pub struct TogetherOptions {
    /// Folder with `pipelines/` and `runs/`.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub(crate) project: PathBuf,

    /// Pipeline: a file below `pipelines/` without its ending, or the path of a file elsewhere.
    #[arg(long, value_name = "NAME|FILE", default_value = "default", allow_hyphen_values = true)]
    pub(crate) pipeline: String,

    /// Folder of the joint result [default: runs/together/NAME in the project].
    #[arg(long, value_name = "FOLDER", default_value = "", allow_hyphen_values = true)]
    pub(crate) out: OsString,

    /// Flags for every stage, as one would type them.
    #[arg(long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    pub(crate) flags: Words,

    /// Predicts again with the joint result in this folder; behind `--` stand flags of that prediction.
    #[arg(long, value_name = "FOLDER", allow_hyphen_values = true, conflicts_with = "out")]
    pub(crate) again: Option<PathBuf>,

    /// Records or run folders, then `--name NAME` and flags of the joint prediction, such as --speed 64km/h.
    #[arg(last = true, required_unless_present = "again", value_name = "RECORD")]
    pub(crate) rest: Vec<OsString>,
}

/// What stands behind `--`.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Asked {
    /// Records and run folders.
    pub(crate) records: Vec<PathBuf>,
    /// Name of the result.
    pub(crate) name: Option<String>,
    /// Flags of the joint prediction.
    pub(crate) flags: Vec<OsString>,
}

impl Asked {
    /// Records up to the first flag, then flags. Errors: fewer than two records, a name without value or with a slash.
    pub(crate) fn read(rest: &[OsString]) -> Result<Self, Usage> {
        let is_flag = |word: &OsString| word.as_encoded_bytes().starts_with(b"-");
        let count = rest.iter().take_while(|word| !is_flag(word)).count();
        let mut asked = Self { records: rest[..count].iter().map(PathBuf::from).collect(), ..Self::default() };
        let mut words = rest[count..].iter();
        while let Some(word) = words.next() {
            let text = word.to_string_lossy();
            let value = match text.strip_prefix("--name") {
                Some("") => words.next().map(|value| value.to_string_lossy().into_owned()),
                Some(value) if value.starts_with('=') => Some(value[1..].to_owned()),
                _ => {
                    asked.flags.push(word.clone());
                    continue;
                }
            };
            let name = value.filter(|name| !name.is_empty() && !name.contains('/') && !name.starts_with(['-', '.']));
            asked.name = Some(name.ok_or_else(|| Usage::new("--name needs a name without slashes"))?);
        }
        if asked.records.len() < 2 {
            return Err(Usage::new(format!(
                "{} record, and one model for several tests needs two",
                asked.records.len()
            ))
            .hint("just together A.EV5 B.EV5 ... [--name NAME]; records come first"));
        }
        Ok(asked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(words: &[&str]) -> Result<Asked, Usage> {
        Asked::read(&words.iter().map(OsString::from).collect::<Vec<_>>())
    }

    #[test]
    fn records_come_first_and_the_name_is_no_flag_of_a_stage() {
        let asked = read(&["a.csv", "b.csv", "--speed", "64km/h", "--name", "both", "--mass=9kg"]).unwrap();
        assert_eq!(asked.records, [PathBuf::from("a.csv"), PathBuf::from("b.csv")]);
        assert_eq!(asked.name.as_deref(), Some("both"));
        assert_eq!(asked.flags, ["--speed", "64km/h", "--mass=9kg"]);
        assert_eq!(read(&["a", "b", "--name=c"]).unwrap().name.as_deref(), Some("c"));
    }

    #[test]
    fn one_record_and_a_name_that_is_a_path_are_refused() {
        assert!(read(&["a.csv"]).unwrap_err().to_string().starts_with("1 record"));
        assert!(read(&["--name", "x", "a", "b"]).is_err());
        for name in ["", "a/b", "..", "-x"] {
            assert!(read(&["a", "b", "--name", name]).is_err(), "{name:?}");
        }
        assert!(read(&["a", "b", "--name"]).is_err());
    }
}
