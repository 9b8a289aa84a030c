//! One stage: how it is started, how it ended, how the result of a program from elsewhere is taken over.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, panic, process};

use anyhow::Context;
use crumple_artifact::{Artifact, remove_in_order};
use crumple_stage::joints::{Contradiction, contradictions};
use crumple_stage::{Call, ExitStatus, IN_RUN, Way, chain, program, refuse_a_mixture, say};

use crate::command::{RECORD, Stage};
use crate::folder::content::{Content, content_of, is_artifact};
use crate::folder::lock::LockedFolder;
use crate::program::{Program, held};

// How a stage ended.

/// How a stage ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StageExit {
    /// With a result: [`ExitStatus::Done`] or [`ExitStatus::NoAcceptableResult`].
    WithResult(ExitStatus),
    /// Without a result, by an exit code that says so: 1, 2 or 3.
    Failed(ExitStatus),
    /// With a result that contradicts itself, or what it was made from: what contradicts was said.
    Contradicts,
    /// In a way that the contract of a stage does not know.
    Unforeseen(Unforeseen),
}

/// What breaks the contract of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unforeseen {
    /// An exit code without a meaning.
    Code(i32),
    /// The end by a signal.
    Signal(i32),
    /// A result was announced, and the output of this number is missing or empty.
    NothingWritten(usize),
    /// The output of this number is no artifact.
    NoArtifact(usize),
}

impl StageExit {
    /// What a stage in this process says.
    fn of_held(status: ExitStatus) -> Self {
        match status {
            ExitStatus::Done | ExitStatus::NoAcceptableResult => Self::WithResult(status),
            failure => Self::Failed(failure),
        }
    }

    /// What the exit code says.
    pub(crate) fn of(status: process::ExitStatus) -> Self {
        match (status.code(), signal_of(status)) {
            (Some(0), _) => Self::WithResult(ExitStatus::Done),
            (Some(1), _) => Self::Failed(ExitStatus::Failure),
            (Some(2), _) => Self::Failed(ExitStatus::Usage),
            (Some(3), _) => Self::Failed(ExitStatus::Refused),
            (Some(4), _) => Self::WithResult(ExitStatus::NoAcceptableResult),
            // So a shell tells that its program was ended by a signal.
            (Some(code), _) if signal_name(code - 128).is_some() => Self::Unforeseen(Unforeseen::Signal(code - 128)),
            (Some(code), _) => Self::Unforeseen(Unforeseen::Code(code)),
            (None, signal) => Self::Unforeseen(Unforeseen::Signal(signal.unwrap_or_default())),
        }
    }

    /// The exit status of what rests on it; an end that the contract does not know is a failure, and named.
    pub(crate) fn status_of(self, program: &Path) -> ExitStatus {
        match self {
            Self::WithResult(status) | Self::Failed(status) => status,
            Self::Contradicts => ExitStatus::Refused,
            Self::Unforeseen(_) => {
                say(format_args!("error: {} ended in an unforeseen way", program.display()));
                ExitStatus::Failure
            }
        }
    }

    /// The same, unless one of the outputs that it speaks of is not in the folder.
    pub(crate) fn checked(self, folder: &Path, outputs: &[&str]) -> Self {
        if !matches!(self, Self::WithResult(_)) {
            return self;
        }
        for (number, name) in outputs.iter().enumerate() {
            match content_of(&folder.join(name)) {
                Content::Nothing => return Self::Unforeseen(Unforeseen::NothingWritten(number)),
                Content::Other if is_artifact(name) => return Self::Unforeseen(Unforeseen::NoArtifact(number)),
                _ => {}
            }
        }
        self
    }
}

/// The signal that ended a process.
#[cfg(unix)]
fn signal_of(status: process::ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

/// The signal that ended a process: elsewhere than on Unix an exit code stands for it.
#[cfg(not(unix))]
fn signal_of(_: process::ExitStatus) -> Option<i32> {
    None
}

/// The exit code of a process, as a shell tells it of one that a signal ended.
pub(crate) fn exit_code_of(status: process::ExitStatus) -> i32 {
    status.code().unwrap_or_else(|| 128 + signal_of(status).unwrap_or_default())
}

/// Name of a signal that ends programs.
pub(crate) fn signal_name(signal: i32) -> Option<&'static str> {
    const NAMES: [(i32, &str); 14] = [
        (1, "SIGHUP"),
        (2, "SIGINT"),
        (3, "SIGQUIT"),
        (4, "SIGILL"),
        (5, "SIGTRAP"),
        (6, "SIGABRT"),
        (7, "SIGBUS"),
        (8, "SIGFPE"),
        (9, "SIGKILL"),
        (11, "SIGSEGV"),
        (13, "SIGPIPE"),
        (15, "SIGTERM"),
        (24, "SIGXCPU"),
        (31, "SIGSYS"),
    ];
    NAMES.iter().find(|(number, _)| *number == signal).map(|(_, name)| *name)
}

// Starting a stage.

/// Settings of the allocator of glibc: the heap grows by 8 MiB at a time, in pages of 2 MiB where the system has them.
/// A page of 4 KiB is taken from the system at its first use, and a stage that writes a megabyte used some thousand.
const ALLOCATOR: (&str, &str) = ("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1:glibc.malloc.top_pad=8388608");

/// Runs the program of a stage: flags of its own, these arguments, flags of every stage. One of the project runs in
/// this process where this holds it.
pub(crate) fn start(program: &Program, arguments: &[OsString], flags: &[String]) -> anyhow::Result<StageExit> {
    let own = program.flags.iter().map(OsString::from);
    let words: Vec<OsString> = own.chain(arguments.iter().cloned()).chain(flags.iter().map(OsString::from)).collect();
    let Some(stage) = held(program.stage).filter(|_| program.is_own) else {
        return run_program(Command::new(&program.file).args(words).env(IN_RUN, "1"));
    };
    let call = Call { program: format!("crumple {}", stage.name), words, way: Way::InRun };
    // A program that panics has said why and ends with 101.
    let ended = panic::catch_unwind(|| (stage.run)(&call));
    Ok(ended.map_or(StageExit::Unforeseen(Unforeseen::Code(101)), StageExit::of_held))
}

/// Runs a program.
pub(crate) fn run_program(process: &mut Command) -> anyhow::Result<StageExit> {
    if env::var_os(ALLOCATOR.0).is_none() {
        process.env(ALLOCATOR.0, ALLOCATOR.1);
    }
    let status = process.status().with_context(|| format!("cannot start {}", process.get_program().display()))?;
    Ok(StageExit::of(status))
}

/// The arguments of a stage: its inputs, the pipeline file, its output.
pub(crate) fn arguments(
    stage: &Stage,
    folder: &LockedFolder,
    record: &[OsString],
    pipeline: &OsStr,
    output: OsString,
) -> Vec<OsString> {
    let mut arguments = Vec::new();
    for input in &stage.inputs {
        if *input == RECORD {
            arguments.extend_from_slice(record);
        } else {
            arguments.push(folder.path().join(input).into());
        }
    }
    arguments.extend(["--pipeline".into(), pipeline.to_owned(), "-o".into(), output]);
    arguments
}

/// Says what a new artifact of a program from elsewhere contradicts, itself or those in the run folder that its stage
/// reads, and returns whether nothing can be made from it. Damage of the file is said by who reads it.
pub(crate) fn contradicts(stage: &Stage, new: &Path, folder: &Path, asked: &crumple_stage::Pipeline) -> bool {
    let before = chain().take_while(|earlier| earlier.name != stage.name);
    let before = before.filter_map(|earlier| earlier.outputs.first().map(|name| folder.join(name)));
    let files = before.chain([new.join(stage.output())]);
    let artifacts: Vec<Artifact> = files.filter_map(|file| Artifact::open(&file).ok()).collect();
    let found = contradictions(&artifacts, Some(asked)).into_iter();
    let found = found.filter(|found| found.ends_the_run && found.stage == stage.name);
    let found: Vec<Contradiction> = found.collect();
    let name = |artifact: &Artifact| artifact.path().file_name().unwrap_or_default().display().to_string();
    let mixture = refuse_a_mixture(&artifacts, name).err();
    if let Some(mixture) = mixture.as_ref().filter(|_| found.is_empty()) {
        say(format_args!("error: {mixture}"));
        say(format_args!("  written by: {}", stage.program.typed));
    }
    for contradiction in &found {
        say(format_args!("error: {}: {} [{}]", stage.output(), contradiction.text, contradiction.kind.code));
        say(format_args!("  written by: {}", stage.program.typed));
        say(format_args!(
            "  hint: {}; {} explains it",
            contradiction.kind.explanation[3],
            program(&format!("artifact explain {}", contradiction.kind.code))
        ));
    }
    !found.is_empty() || mixture.is_some()
}

/// Says which of the inputs that a stage of the project refused are by programs from elsewhere.
pub(crate) fn say_who_wrote(inputs: &[&str], stages: &[Stage]) {
    for stage in stages.iter().filter(|stage| !stage.program.is_own && inputs.contains(&stage.output())) {
        say(format_args!("note: {} was written by: {}", stage.output(), stage.program.typed));
    }
}

// Taking over what a program from elsewhere wrote.
//
// Only the stages of the project know by themselves whether their output is up to date, and remove what was made from
// the old one before the new one appears. Any other program writes into a folder of its own, and this is done for it.

/// Moves new results from one folder to another.
///
/// Results that are the same as the old ones leave these alone. Else `dependents`, made from the old ones, go first,
/// and of several results that belong together no old one stands beside a new one at any moment.
pub(crate) fn install_outputs(from: &Path, to: &Path, names: &[&str], dependents: &[PathBuf]) -> io::Result<()> {
    let written: Vec<&&str> = names.iter().filter(|name| from.join(name).exists()).collect();
    let mut unchanged = written.len() == names.len();
    for name in &written {
        unchanged = unchanged && same_bytes(&from.join(name), &to.join(name))?;
    }
    if unchanged {
        return Ok(());
    }
    for name in &written {
        // To the disk before the move: after a power cut the name must not point at an empty file.
        File::open(from.join(name))?.sync_data()?;
    }
    remove_in_order(dependents)?;
    if names.len() > 1 {
        remove_in_order(&names.iter().map(|name| to.join(name)).collect::<Vec<_>>())?;
    }
    for name in written {
        fs::rename(from.join(name), to.join(name))?;
    }
    Ok(())
}

/// Whether two files hold the same; one that does not exist holds nothing.
fn same_bytes(a: &Path, b: &Path) -> io::Result<bool> {
    let (Ok(length_a), Ok(length_b)) = (fs::metadata(a), fs::metadata(b)) else { return Ok(false) };
    if length_a.len() != length_b.len() {
        return Ok(false);
    }
    let (mut a, mut b) = (BufReader::new(File::open(a)?), BufReader::new(File::open(b)?));
    let (mut of_a, mut of_b) = ([0; 1 << 16], [0; 1 << 16]);
    loop {
        let read = a.read(&mut of_a)?;
        if read == 0 {
            return Ok(true);
        }
        b.read_exact(&mut of_b[..read])?;
        if of_a[..read] != of_b[..read] {
            return Ok(false);
        }
    }
}

#[cfg(test)]
mod tests {

    use super::*;

    fn ending(command: &str) -> StageExit {
        StageExit::of(Command::new("sh").args(["-c", command]).status().unwrap())
    }

    #[test]
    fn exit_codes_of_stages_and_all_others() {
        assert_eq!(ending("exit 0"), StageExit::WithResult(ExitStatus::Done));
        assert_eq!(ending("exit 3"), StageExit::Failed(ExitStatus::Refused));
        assert_eq!(ending("exit 4"), StageExit::WithResult(ExitStatus::NoAcceptableResult));
        assert_eq!(ending("exit 77"), StageExit::Unforeseen(Unforeseen::Code(77)));
        assert_eq!(ending("exit 127"), StageExit::Unforeseen(Unforeseen::Code(127)));
        assert_eq!(ending("kill -SEGV $$"), StageExit::Unforeseen(Unforeseen::Signal(11)));
        assert_eq!(ending("exit 139"), StageExit::Unforeseen(Unforeseen::Signal(11)));
    }

    #[test]
    fn all_results_must_be_there_and_artifacts_be_artifacts() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &[u8]| fs::write(folder.path().join(name), text).unwrap();
        let done = StageExit::WithResult(ExitStatus::Done);
        let checked = |names: &[&str]| done.checked(folder.path(), names);
        assert_eq!(checked(&["x.mcap"]), StageExit::Unforeseen(Unforeseen::NothingWritten(0)));
        write("x.mcap", b"text");
        assert_eq!(checked(&["x.mcap"]), StageExit::Unforeseen(Unforeseen::NoArtifact(0)));
        write("x.mcap", b"\x89MCAP0\r\n");
        assert_eq!(checked(&["x.mcap"]), done);
        write("report.html", b"text");
        assert_eq!(checked(&["report.html"]), done);
        assert_eq!(checked(&["report.html", "summary.json"]), StageExit::Unforeseen(Unforeseen::NothingWritten(1)));
        let failed = StageExit::Failed(ExitStatus::Refused);
        assert_eq!(failed.checked(folder.path(), &["none"]), failed);
    }

    #[test]
    fn the_same_result_changes_nothing_and_another_takes_the_dependents_away() {
        let root = tempfile::tempdir().unwrap();
        let (from, to) = (root.path().join("new"), root.path().join("run"));
        let names = ["report.html", "summary.json"];
        let dependent = to.join("later");
        for folder in [&from, &to] {
            fs::create_dir(folder).unwrap();
            names.iter().for_each(|name| fs::write(folder.join(name), "old").unwrap());
        }
        fs::write(&dependent, "x").unwrap();
        let take = || install_outputs(&from, &to, &names, std::slice::from_ref(&dependent)).unwrap();
        take();
        assert!(dependent.exists());

        // Of two results only one is written: the other is not that of an older run.
        fs::remove_file(from.join("summary.json")).unwrap();
        fs::write(from.join("report.html"), "new").unwrap();
        take();
        assert!(!dependent.exists() && !to.join("summary.json").exists());
        assert_eq!(fs::read(to.join("report.html")).unwrap(), b"new");
    }
}
