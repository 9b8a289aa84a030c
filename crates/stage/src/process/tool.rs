//! The shell of programs that read artifacts and write something else: report, diff, artifact.

use std::process::ExitCode;

use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;
use clap::{Arg, Command, CommandFactory, FromArgMatches};

use crate::command_line::memory_limit;
use crate::error::{ExitStatus, render, status_of};
use crate::terminal::say::{say, to_stdout};

/// Parses the command line, runs the program, prints its error with cause and hint, and returns its exit code.
pub fn tool_main<C: CommandFactory + FromArgMatches>(run: impl FnOnce(C) -> anyhow::Result<ExitStatus>) -> ExitCode {
    finish(parse::<C>(C::command()).map_err(Ok).and_then(|(cli, _)| run(cli).map_err(Err)))
}

/// Flag that prints a completion script or the man page instead of running.
const GENERATE: &str = "generate";
const SHELLS: [(&str, clap_complete::Shell); 3] =
    [("bash", clap_complete::Shell::Bash), ("zsh", clap_complete::Shell::Zsh), ("fish", clap_complete::Shell::Fish)];

/// Parses a command line; `Err` is the exit status after help, version, a completion script or a usage error was
/// printed.
pub(crate) fn parse<C: FromArgMatches>(command: Command) -> Result<(C, clap::ArgMatches), ExitStatus> {
    let kinds = PossibleValuesParser::new(SHELLS.iter().map(|(name, _)| *name).chain(["man"]));
    let flag = Arg::new(GENERATE)
        .long(GENERATE)
        .value_name("KIND")
        .value_parser(kinds)
        .exclusive(true)
        .help_heading(None)
        .help("Print a completion script for a shell, or the man page, and do nothing else");
    let command = memory_limit::with_flag(command.arg(flag));
    // Where a subcommand is needed, this flag is exclusive of it as well.
    let is_generating = std::env::args_os().any(|word| word.to_string_lossy().starts_with("--generate"));
    let parser = command.clone();
    let parser = if is_generating { parser.subcommand_required(false).arg_required_else_help(false) } else { parser };
    let matches = parser.try_get_matches().and_then(|matches| match matches.get_one::<String>(GENERATE) {
        Some(kind) => Ok(Err(generate(command, kind))),
        None => {
            memory_limit::take(&matches);
            Ok(Ok((C::from_arg_matches(&matches)?, matches)))
        }
    });
    match matches {
        Ok(parsed) => parsed,
        Err(error) => {
            // A closed pipe while printing help is nobody's problem.
            let _ = error.print();
            Err(match error.kind() {
                ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => ExitStatus::Done,
                _ => ExitStatus::Usage,
            })
        }
    }
}

/// Prints the completion script of a shell, or the man page.
fn generate(mut command: Command, kind: &str) -> ExitStatus {
    let name = command.get_bin_name().unwrap_or_else(|| command.get_name()).to_owned();
    let mut text = Vec::new();
    match SHELLS.iter().find(|(shell, _)| *shell == kind) {
        Some((_, shell)) => clap_complete::generate(*shell, &mut command, name, &mut text),
        None => {
            if clap_mangen::Man::new(command.name(name.leak() as &str)).render(&mut text).is_err() {
                return ExitStatus::Failure;
            }
        }
    }
    match to_stdout(&text) {
        Ok(()) => ExitStatus::Done,
        Err(error) => {
            say(render(&error));
            ExitStatus::Failure
        }
    }
}

pub(crate) fn finish(result: Result<ExitStatus, Result<ExitStatus, anyhow::Error>>) -> ExitCode {
    match result {
        Ok(status) | Err(Ok(status)) => status.into(),
        Err(Err(error)) => {
            say(render(&error));
            status_of(&error).into()
        }
    }
}
