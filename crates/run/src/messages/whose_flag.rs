//! Whose a flag is that the first stage does not know.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use crumple_stage::say;

use crate::command::program::own_program;
use crate::command::stages::Stage;

/// Flags behind the record go to the first stage: says of each that is another stage's how to give it to that one.
pub(crate) fn say_whose_flags(flags: &[OsString], stages: &[Stage]) {
    let Some((first, others)) = stages.split_first() else { return };
    let own = Flags::of(&own_program(first.name()));
    for flag in flags {
        let flag = flag.to_string_lossy();
        let flag = flag.split('=').next().unwrap_or_default();
        if !flag.starts_with("--") || own.has(flag) {
            continue;
        }
        for stage in others.iter().filter(|stage| stage.writes_an_artifact()) {
            let (name, program) = (stage.name(), own_program(stage.name()));
            if Flags::of(&program).has(flag) {
                say(format_args!(
                    "tip: {flag} is an option of crumple-{name}: just {}=\"{} {flag} ...\" run RECORD, \
                     or a key of [{name}] in a pipeline",
                    name.replace('-', "_"),
                    shell_word(&program)
                ));
            }
        }
    }
}

/// A path as one types it.
fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+".contains(c);
    if path.chars().all(is_plain) { path } else { format!("'{}'", path.replace('\'', r"'\''")) }
}

/// The flags of a program, by its help.
struct Flags(String);

impl Flags {
    fn of(program: &Path) -> Self {
        let help = Command::new(program).arg("--help").output();
        Self(help.map_or_else(|_| String::new(), |help| String::from_utf8_lossy(&help.stdout).into_owned()))
    }

    /// Whether a line of the help begins with the flag, or with its short form and the flag.
    fn has(&self, flag: &str) -> bool {
        self.0.lines().any(|line| {
            let words = line.trim_start();
            let words = if words.starts_with("--") { words } else { words.get(4..).unwrap_or_default() };
            words.strip_prefix(flag).is_some_and(|rest| rest.is_empty() || rest.starts_with([' ', '=']))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_is_known_by_its_line_of_the_help() {
        let flags =
            Flags("Usage: x\n  -o, --output <FILE>  See --cfc\n      --cfc <CLASS>\n      --force\n".to_owned());
        for flag in ["--output", "--cfc", "--force"] {
            assert!(flags.has(flag), "{flag}");
        }
        for flag in ["--cf", "--class", "-o", "See"] {
            assert!(!flags.has(flag), "{flag}");
        }
    }
}
