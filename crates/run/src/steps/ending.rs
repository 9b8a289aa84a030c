//! How a stage ended.

use std::fs::File;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process;

use crumple_stage::ExitStatus;

/// How a stage ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// As a stage may, with a result: [`ExitStatus::Done`] or [`ExitStatus::NoAcceptableResult`].
    WithResult(ExitStatus),
    /// As a stage may, without one: it has said why.
    Failed(ExitStatus),
    /// As no stage may.
    Unforeseen(Unforeseen),
}

/// What no stage may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unforeseen {
    /// End with an exit code that means nothing.
    Code(i32),
    /// Be ended by a signal.
    Signal(i32),
    /// Say that there is a result and write none.
    NothingWritten,
    /// Write something else than an artifact.
    NoArtifact,
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

    /// The same, unless the result that it speaks of is not there.
    pub(crate) fn checked(self, output: &Path, must_be_an_artifact: bool) -> Self {
        if !matches!(self, Self::WithResult(_)) {
            return self;
        }
        let mut start = Vec::new();
        let read = File::open(output).and_then(|file| file.take(5).read_to_end(&mut start));
        match read {
            Err(_) | Ok(0) => Self::Unforeseen(Unforeseen::NothingWritten),
            Ok(_) if must_be_an_artifact && start != b"\x89MCAP" => Self::Unforeseen(Unforeseen::NoArtifact),
            Ok(_) => self,
        }
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
    fn a_result_must_be_there_and_be_an_artifact() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let done = Ending::WithResult(ExitStatus::Done);
        assert_eq!(done.checked(&path, true), Ending::Unforeseen(Unforeseen::NothingWritten));
        std::fs::write(&path, "text").unwrap();
        assert_eq!(done.checked(&path, true), Ending::Unforeseen(Unforeseen::NoArtifact));
        assert_eq!(done.checked(&path, false), done);
        std::fs::write(&path, b"\x89MCAP0\r\n").unwrap();
        assert_eq!(done.checked(&path, true), done);
        let failed = Ending::Failed(ExitStatus::Refused);
        assert_eq!(failed.checked(Path::new("/nowhere"), true), failed);
    }
}
