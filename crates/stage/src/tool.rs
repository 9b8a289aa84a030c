//! The shell of programs that read artifacts and write something else: report, diff, artifact.

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches};

use crate::error::{ExitStatus, render, status_of};

/// Parses the command line, runs the program, prints its error with cause and hint, and returns its exit code.
pub fn tool_main<C: CommandFactory + FromArgMatches>(run: impl FnOnce(C) -> anyhow::Result<ExitStatus>) -> ExitCode {
    finish(parse::<C>(C::command()).map_err(Ok).and_then(|(cli, _)| run(cli).map_err(Err)))
}

/// Parses a command line; `Err` is the exit status after help, version or a usage error was printed.
pub(crate) fn parse<C: FromArgMatches>(command: clap::Command) -> Result<(C, clap::ArgMatches), ExitStatus> {
    let matches = command.try_get_matches().and_then(|matches| Ok((C::from_arg_matches(&matches)?, matches)));
    matches.map_err(|error| {
        // A closed pipe while printing help is nobody's problem.
        let _ = error.print();
        match error.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => ExitStatus::Done,
            _ => ExitStatus::Usage,
        }
    })
}

pub(crate) fn finish(result: Result<ExitStatus, Result<ExitStatus, anyhow::Error>>) -> ExitCode {
    match result {
        Ok(status) | Err(Ok(status)) => status.into(),
        Err(Err(error)) => {
            eprintln!("{}", render(&error));
            status_of(&error).into()
        }
    }
}
