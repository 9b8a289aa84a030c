//! How a stage ended.

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process;

use crumple_stage::{ExitStatus, say};

use crate::folder::content::{Content, content_of, is_artifact};

/// How a stage ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// With a result: [`ExitStatus::Done`] or [`ExitStatus::NoAcceptableResult`].
    WithResult(ExitStatus),
    /// Without a result, by an exit code that says so: 1, 2 or 3.
    Failed(ExitStatus),
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

impl Ending {
    /// What the exit code says.
    pub(crate) fn of(status: process::ExitStatus) -> Self {
        match (status.code(), status.signal()) {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn ending(command: &str) -> Ending {
        Ending::of(process::Command::new("sh").args(["-c", command]).status().unwrap())
    }

    #[test]
    fn exit_codes_of_stages_and_all_others() {
        assert_eq!(ending("exit 0"), Ending::WithResult(ExitStatus::Done));
        assert_eq!(ending("exit 3"), Ending::Failed(ExitStatus::Refused));
        assert_eq!(ending("exit 4"), Ending::WithResult(ExitStatus::NoAcceptableResult));
        assert_eq!(ending("exit 77"), Ending::Unforeseen(Unforeseen::Code(77)));
        assert_eq!(ending("exit 127"), Ending::Unforeseen(Unforeseen::Code(127)));
        assert_eq!(ending("kill -SEGV $$"), Ending::Unforeseen(Unforeseen::Signal(11)));
        assert_eq!(ending("exit 139"), Ending::Unforeseen(Unforeseen::Signal(11)));
    }

    #[test]
    fn all_results_must_be_there_and_artifacts_be_artifacts() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &[u8]| std::fs::write(folder.path().join(name), text).unwrap();
        let done = Ending::WithResult(ExitStatus::Done);
        let checked = |names: &[&str]| done.checked(folder.path(), names);
        assert_eq!(checked(&["x.mcap"]), Ending::Unforeseen(Unforeseen::NothingWritten(0)));
        write("x.mcap", b"text");
        assert_eq!(checked(&["x.mcap"]), Ending::Unforeseen(Unforeseen::NoArtifact(0)));
        write("x.mcap", b"\x89MCAP0\r\n");
        assert_eq!(checked(&["x.mcap"]), done);
        write("report.html", b"text");
        assert_eq!(checked(&["report.html"]), done);
        assert_eq!(checked(&["report.html", "summary.json"]), Ending::Unforeseen(Unforeseen::NothingWritten(1)));
        let failed = Ending::Failed(ExitStatus::Refused);
        assert_eq!(failed.checked(folder.path(), &["none"]), failed);
    }
}
