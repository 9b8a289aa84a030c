//! The program of a stage.

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use crumple_stage::{Usage, chain};

use crate::command::words::{Words, request_for_information};

/// The program of a stage with flags of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Program {
    /// As it was typed.
    pub(crate) typed: String,
    /// Its words but the first.
    pub(crate) flags: Vec<String>,
    /// The file that is started.
    pub(crate) file: PathBuf,
    /// Whether it is that of the project, under whatever name.
    pub(crate) is_own: bool,
}

impl Program {
    /// That of a stage. Errors: there is no such program, or it is one of the project with a flag of its own, or one of
    /// every stage, that makes it print and compute nothing, while an old result passes for its own.
    pub(crate) fn of_stage(stage: &str, flags: &Words) -> Result<Self, Usage> {
        let program = Self::find(stage, typed_command(stage))?;
        let place = format!("the command of the stage {stage}");
        for (place, words) in [(place.as_str(), &program.flags), ("flags", &flags.0)] {
            if let Some(flag) = request_for_information(words.iter()).filter(|_| program.is_own) {
                let problem =
                    format!("{flag} in {place}: crumple-{stage} would print and compute nothing; nothing was run");
                return Err(Usage::new(problem).hint(format!("call the program by itself: crumple-{stage} {flag}")));
            }
        }
        Ok(program)
    }

    fn find(stage: &str, typed: String) -> Result<Self, Usage> {
        let refused = |problem: String| Usage::new(format!("{problem}; nothing was run"));
        let words: Words =
            typed.parse().map_err(|error| refused(format!("the command of the stage {stage}: {error}: {typed}")))?;
        let Some((first, flags)) = words.split_first() else {
            return Err(refused(format!("the command of the stage {stage} is empty"))
                .hint(format!("leave {}= out for the program of the project", stage.replace('-', "_"))));
        };
        let file = find(first).ok_or_else(|| {
            refused(format!("{first}: no such program")).hint(match first.starts_with(".venv/") {
                true => "scripts/setup.sh test makes the Python environment .venv".to_owned(),
                false => format!("it is the command of the stage {stage}; for what only a shell can do: sh -c '...'"),
            })
        })?;
        let is_own = matches!((file.canonicalize(), own_program(stage).canonicalize()), (Ok(a), Ok(b)) if a == b);
        Ok(Self { flags: flags.to_vec(), file, is_own, typed })
    }
}

/// A program of the project: beside this one.
pub fn own_program(stage: &str) -> PathBuf {
    env::current_exe().unwrap_or_default().with_file_name(format!("crumple-{stage}"))
}

/// The command of a stage as typed: `CRUMPLE_PARAMETER_SOLVE` in the environment, else the program of the project.
fn typed_command(stage: &str) -> String {
    let variable = format!("CRUMPLE_{}", stage.to_ascii_uppercase().replace('-', "_"));
    env::var_os(variable).map_or_else(|| format!("crumple-{stage}"), |typed| typed.to_string_lossy().into_owned())
}

/// The commands of all stages as they were typed.
pub fn typed_commands() -> Vec<String> {
    chain().map(|stage| typed_command(stage.name)).collect()
}

/// A program of the project is beside this one; any other is where a shell would look.
fn find(word: &str) -> Option<PathBuf> {
    let is_program = |path: &Path| fs::metadata(path).is_ok_and(|m| m.is_file() && m.permissions().mode() & 0o111 != 0);
    if word.contains('/') {
        return Some(PathBuf::from(word)).filter(|path| is_program(path));
    }
    let own = word.strip_prefix("crumple-").map(own_program);
    let folders = env::var_os("PATH").unwrap_or_default();
    let in_path = env::split_paths(&folders).map(|folder| folder.join(word));
    own.into_iter().chain(in_path).find(|path| !word.is_empty() && is_program(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_found_in_path_and_by_path_and_no_shell_is_guessed() {
        let found = |typed: &str| Program::find("identify", typed.to_owned()).map_err(|error| error.to_string());
        let shell = found("sh -c 'exit 3'").unwrap();
        assert_eq!((shell.flags, shell.is_own), (vec!["-c".to_owned(), "exit 3".to_owned()], false));
        assert!(shell.file.ends_with("sh") && found("/bin/sh").is_ok());
        for (typed, problem) in [
            ("no-such-program --flag", "no-such-program: no such program"),
            ("/etc/passwd", "/etc/passwd: no such program"),
            ("ulimit -v 8000000; x/crumple-identify", "ulimit: no such program"),
            ("A=1 sh", "A=1: no such program"),
            ("'' x", ": no such program"),
            (" ", "the command of the stage identify is empty"),
            ("sh 'x", "the command of the stage identify: missing closing quote: sh 'x"),
        ] {
            assert_eq!(found(typed), Err(format!("{problem}; nothing was run")), "{typed}");
        }
    }
}
