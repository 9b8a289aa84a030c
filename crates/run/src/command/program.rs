//! Which program a shell command starts.

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

/// Words that a shell runs itself and that one may well put before a program.
const BUILT_INTO_SHELLS: [&str; 4] = ["command", "eval", "exec", "."];

/// What is known of the program that a shell command starts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Program {
    /// This file.
    File(PathBuf),
    /// There is no such program.
    Missing(String),
    /// Only a shell can tell.
    Unknown,
}

impl Program {
    /// Looks where a shell would look.
    pub(crate) fn of(command: &str) -> Self {
        match first_word(command) {
            None => Self::Unknown,
            Some(word) if BUILT_INTO_SHELLS.contains(&word.as_str()) => Self::Unknown,
            Some(word) => find(&word).map_or(Self::Missing(word), Self::File),
        }
    }

    /// Whether it is the file at `path`, under whatever name.
    pub(crate) fn is(&self, path: &Path) -> bool {
        let Self::File(file) = self else { return false };
        matches!((file.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b)
    }
}

/// A program of the project: beside this one.
pub(crate) fn own_program(stage: &str) -> PathBuf {
    env::current_exe().unwrap_or_default().with_file_name(format!("crumple-{stage}"))
}

fn find(word: &str) -> Option<PathBuf> {
    let is_program = |path: &Path| fs::metadata(path).is_ok_and(|m| m.is_file() && m.permissions().mode() & 0o111 != 0);
    if word.contains('/') {
        return Some(PathBuf::from(word)).filter(|path| is_program(path));
    }
    let folders = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&folders).map(|folder| folder.join(word)).find(|path| !word.is_empty() && is_program(path))
}

/// The first word of a shell command without its quotes; `None` where a shell would put something in its place.
fn first_word(command: &str) -> Option<String> {
    let mut word = String::new();
    let mut chars = command.trim_start().chars();
    while let Some(c) = chars.next() {
        match c {
            ' ' | '\t' | '\n' => break,
            '\'' => word.extend(chars.by_ref().take_while(|c| *c != '\'')),
            '"' => {
                while let Some(c) = chars.next().filter(|c| *c != '"') {
                    match c {
                        '$' | '`' => return None,
                        '\\' => word.extend(chars.next()),
                        c => word.push(c),
                    }
                }
            }
            '\\' => word.extend(chars.next()),
            '$' | '`' | '(' | ')' | '{' | '}' | '<' | '>' | '|' | '&' | ';' | '*' | '?' | '[' | ']' | '~' | '#'
            | '=' => {
                return None;
            }
            c => word.push(c),
        }
    }
    Some(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_is_read_as_a_shell_reads_it() {
        for (command, word) in [
            ("cat -n", Some("cat")),
            ("  'a b/c'\"'\"'d' --x", Some("a b/c'd")),
            (r#""a \"b\"" c"#, Some("a \"b\"")),
            (r"a\ b c", Some("a b")),
            ("$HOME/x y", None),
            ("\"$HOME\"/x y", None),
            ("A=1 x", None),
            ("(x)", None),
            ("", Some("")),
        ] {
            assert_eq!(first_word(command).as_deref(), word, "{command}");
        }
    }

    #[test]
    fn programs_are_found_in_path_and_by_path() {
        assert!(matches!(Program::of("sh -c 'exit 3'"), Program::File(_)));
        assert!(matches!(Program::of("/bin/sh"), Program::File(_)));
        assert_eq!(Program::of("no-such-program --flag"), Program::Missing("no-such-program".to_owned()));
        assert_eq!(Program::of("/etc/passwd"), Program::Missing("/etc/passwd".to_owned()));
        assert_eq!(Program::of("exec sh"), Program::Unknown);
        assert!(Program::of("sh").is(&find("sh").unwrap()));
    }
}
