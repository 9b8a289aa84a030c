//! Which program a shell command starts.

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use crumple_stage::only_program;

/// Words that a shell runs itself or that belong to its language: what comes after them, only a shell can tell.
const WORDS_OF_SHELLS: [&str; 34] = [
    ".", ":", "alias", "builtin", "case", "cd", "command", "eval", "exec", "exit", "export", "for", "function", "hash",
    "if", "let", "local", "read", "readonly", "return", "set", "shift", "source", "time", "times", "trap", "type",
    "ulimit", "umask", "unset", "until", "wait", "while", "!",
];

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
        match only_program(command) {
            None => Self::Unknown,
            Some(word) if WORDS_OF_SHELLS.contains(&word.as_str()) => Self::Unknown,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_found_in_path_and_by_path() {
        assert!(matches!(Program::of("sh -c 'exit 3'"), Program::File(_)));
        assert!(matches!(Program::of("/bin/sh"), Program::File(_)));
        assert_eq!(Program::of("no-such-program --flag"), Program::Missing("no-such-program".to_owned()));
        assert_eq!(Program::of("/etc/passwd"), Program::Missing("/etc/passwd".to_owned()));
        for unknown in
            ["exec sh", "ulimit -v 8000000; x/crumple-identify", "cd d && ./x", "no-such | x", "if a; then b"]
        {
            assert_eq!(Program::of(unknown), Program::Unknown, "{unknown}");
        }
        assert!(Program::of("sh").is(&find("sh").unwrap()));
    }
}
