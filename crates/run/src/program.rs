//! The program of a stage: what a person names for it, by flag or by environment, and the file that is started.

use std::collections::BTreeMap;
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsString;
use std::path::{Path, PathBuf, is_separator};

use std::{env, fs, process};

use crumple_stage::{Refused, Usage, chain, program, refuse_unknown_variables, unknown_name, variable_of};

use crate::words::{Words, request_for_information};

// What a person names.

/// Programs for single stages, by flags.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct NamedPrograms {
    /// The program of a stage in place of that of the project: `filter="python3 my.py"`. Several; each counts over the
    /// variable of its stage, such as CRUMPLE_FILTER.
    #[arg(long = "stage", value_name = "STAGE=COMMAND")]
    pub(crate) stage: Vec<String>,
}

impl NamedPrograms {
    /// The same flags, for a program of the project that this one starts.
    pub(crate) fn arguments(&self) -> impl Iterator<Item = OsString> {
        self.stage.iter().flat_map(|typed| ["--stage".into(), OsString::from(typed)])
    }

    /// The command of every stage. Errors: a flag that is no STAGE=COMMAND, a variable that nothing reads.
    pub(crate) fn commands(&self) -> anyhow::Result<Commands> {
        refuse_unknown_variables()?;
        let mut commands = BTreeMap::new();
        for stage in chain() {
            let own = || format!("crumple-{}", stage.name);
            let typed = env::var_os(variable_of(stage.name));
            commands.insert(stage.name, typed.map_or_else(own, |typed| typed.to_string_lossy().into_owned()));
        }
        for typed in &self.stage {
            let (name, command) = typed.split_once('=').ok_or_else(|| {
                Usage::new(format!("--stage {typed:?} is no STAGE=COMMAND")).hint("--stage filter=\"python3 my.py\"")
            })?;
            let Some(known) = commands.get_mut(name.replace('_', "-").as_str()) else {
                let stages: Vec<&str> = chain().map(|stage| stage.name).collect();
                return Err(unknown_name(&format!("{name:?} is no stage"), name, &stages));
            };
            command.clone_into(known);
        }
        Ok(Commands(commands))
    }
}

/// The command of every stage as it was typed; `crumple-filter` where none was.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Commands(BTreeMap<&'static str, String>);

impl Commands {
    /// As they were typed.
    pub(crate) fn typed(&self) -> impl Iterator<Item = &str> {
        self.0.values().map(String::as_str)
    }

    /// The program of a stage. Errors: there is no such program, it is that of another stage, or it is one of the
    /// project with a flag of its own, or one of every stage, that makes it print and compute nothing, while an old
    /// result passes for its own.
    pub(crate) fn program(&self, stage: &'static str, flags: &Words) -> anyhow::Result<Program> {
        let found = Program::find(stage, self.0.get(stage).cloned().unwrap_or_default())?;
        let place = format!("the command of the stage {stage}");
        for (place, words) in [(place.as_str(), &found.flags), ("flags", &flags.0)] {
            if let Some(flag) = request_for_information(words.iter()).filter(|_| found.is_own) {
                let own = program(stage);
                let problem = format!("{flag} in {place}: {own} would print and compute nothing; nothing was run");
                return Err(Usage::new(problem).hint(format!("call the program by itself: {own} {flag}")).into());
            }
        }
        Ok(found)
    }

    /// Errors: a program that was named for a stage does not exist, or is that of another stage.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        let mut named = self.0.iter().filter(|(stage, typed)| **typed != format!("crumple-{stage}"));
        named.try_for_each(|(stage, _)| self.program(stage, &Words::default()).map(drop))
    }
}

// The file that is started.

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
    /// The stage that it is of.
    pub(crate) stage: &'static str,
}

/// Digest of a file as it is now.
pub(crate) fn digest_of(path: &Path) -> Option<String> {
    let mut hasher = blake3::Hasher::new();
    std::io::copy(&mut fs::File::open(path).ok()?, &mut hasher).ok()?;
    Some(format!("blake3:{}", hasher.finalize()))
}

/// Programs of the project that are no stages.
const NO_STAGES: [&str; 12] =
    ["run", "demo", "together", "fleet", "watch", "study", "export", "view", "passport", "damage", "plan", "artifact"];

/// Whose program of the project a command names.
enum Named {
    /// The stage's own, with its flags.
    Own(Vec<String>),
    /// That of another stage.
    Other(&'static str),
    /// The whole project without a stage behind it, or what is no stage.
    NoStage,
    /// None of the project.
    Foreign,
}

impl Program {
    /// The files that its command names, with their digests: the program, and a script or settings that it is given.
    pub(crate) fn files(&self) -> impl Iterator<Item = (String, String)> {
        let name = self.typed.parse::<Words>().ok().and_then(|words| words.first().cloned()).unwrap_or_default();
        let named = self.flags.iter().map(|word| (word.clone(), PathBuf::from(word)));
        let all = std::iter::once((name, self.file.clone())).chain(named).filter(|(_, path)| path.is_file());
        all.filter_map(|(name, path)| Some((name, digest_of(&path)?)))
    }

    fn find(stage: &'static str, typed: String) -> anyhow::Result<Self> {
        let refused = |problem: String| Usage::new(format!("{problem}; nothing was run"));
        let words: Words =
            typed.parse().map_err(|error| refused(format!("the command of the stage {stage}: {error}: {typed}")))?;
        let Some((first, flags)) = words.split_first() else {
            return Err(refused(format!("the command of the stage {stage} is empty"))
                .hint(format!("leave {}= out for the program of the project", stage.replace('-', "_")))
                .into());
        };
        match named(stage, first, flags) {
            Named::Own(flags) => {
                let file = own_program(stage);
                if !is_program(&file) {
                    return Err(refused(format!("{}: no such program", file.display())).into());
                }
                return Ok(Self { flags, file, is_own: true, stage, typed });
            }
            Named::Other(other) => {
                let found = format!("{typed} is the program of the stage {other}, not of {stage}; nothing was run");
                return Err(Refused::new(found)
                    .expected(format!("a program that does what {} does", program(stage)))
                    .hint(format!("leave {} out for the program of the project", variable_of(stage)))
                    .into());
            }
            Named::NoStage => {
                return Err(refused(format!("the command of the stage {stage} is {typed}, which is no stage"))
                    .hint(format!("crumple {stage}, or leave it out for the program of the project"))
                    .into());
            }
            Named::Foreign => {}
        }
        let file = find(first).ok_or_else(|| {
            if first.contains(is_separator) && Path::new(first).is_file() {
                let command =
                    std::iter::once("sh").chain(words.iter().map(String::as_str)).collect::<Vec<_>>().join(" ");
                let hint = format!("chmod +x {first}, or name what runs it: --stage {stage}=\"{command}\"");
                return refused(format!("{first} is not executable")).hint(hint);
            }
            refused(format!("{first}: no such program")).hint(match first.starts_with(".venv/") {
                true => "scripts/setup.sh test makes the Python environment .venv".to_owned(),
                false => format!("it is the command of the stage {stage}; for what only a shell can do: sh -c '...'"),
            })
        })?;
        Ok(Self { flags: flags.to_vec(), file, is_own: false, stage, typed })
    }
}

/// Whose program `first` is: by its name where that stands alone, else by the file. The program that holds all stages
/// is told by the name it is called by, `crumple-filter`, or by the word behind it, `crumple filter`.
fn named(stage: &str, first: &str, flags: &[String]) -> Named {
    let name = Path::new(first).file_stem().unwrap_or_default().to_string_lossy();
    let (own, word, flags) = match (name.strip_prefix("crumple-"), flags.split_first()) {
        (Some(word), _) => (own_program(word), Some(word), flags),
        (None, words) if name == "crumple" => {
            let whole = env::current_exe().unwrap_or_default().with_file_name(format!("crumple{EXE_SUFFIX}"));
            let own = if is_one_program() { own_program(stage) } else { whole };
            (own, words.map(|(word, _)| word.as_str()), words.map_or(flags, |(_, flags)| flags))
        }
        _ => return Named::Foreign,
    };
    let is_this = || matches!((Path::new(first).canonicalize(), own.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if first.contains(is_separator) && !is_this() {
        return Named::Foreign;
    }
    let Some(word) = word else { return Named::NoStage };
    match chain().find(|known| known.name == word).map(|known| known.name) {
        Some(other) if other != stage => Named::Other(other),
        Some(_) => Named::Own(flags.to_vec()),
        None if NO_STAGES.contains(&word) => Named::NoStage,
        None => Named::Foreign,
    }
}

/// A stage that runs in this process.
pub(crate) fn held(stage: &str) -> Option<&'static crumple_stage::Program> {
    crumple_stage::held().iter().find(|program| program.name == stage)
}

/// Whether this program holds the stages: it then stands for all others of the project too, and takes their name as its
/// first word.
pub(crate) fn is_one_program() -> bool {
    !crumple_stage::held().is_empty()
}

/// A program of the project: beside this one, unless this one stands for it.
pub(crate) fn own_program(name: &str) -> PathBuf {
    let this = env::current_exe().unwrap_or_default();
    if is_one_program() { this } else { this.with_file_name(format!("crumple-{name}{EXE_SUFFIX}")) }
}

/// Starts a program of the project as a process.
pub(crate) fn own_command(name: &str) -> process::Command {
    let mut command = process::Command::new(own_program(name));
    command.args(is_one_program().then_some(name));
    command
}

/// A program is where a shell would look.
pub(crate) fn find(word: &str) -> Option<PathBuf> {
    if word.contains(is_separator) {
        return Some(PathBuf::from(word)).filter(|path| is_program(path));
    }
    let folders = env::var_os("PATH").unwrap_or_default();
    let in_path =
        env::split_paths(&folders).flat_map(|folder| [folder.join(word), folder.join(format!("{word}{EXE_SUFFIX}"))]);
    in_path.into_iter().find(|path| !word.is_empty() && is_program(path))
}

/// Whether it is a file that the system would start, as far as its permissions tell.
fn is_program(path: &Path) -> bool {
    #[cfg(unix)]
    let may_run = |found: &fs::Metadata| std::os::unix::fs::PermissionsExt::mode(&found.permissions()) & 0o111 != 0;
    #[cfg(not(unix))]
    let may_run = |_: &fs::Metadata| true;
    fs::metadata(path).is_ok_and(|found| found.is_file() && may_run(&found))
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
            ("/etc/passwd", "/etc/passwd is not executable"),
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
