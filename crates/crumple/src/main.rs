//! `crumple`: every program of the project in one. `crumple filter` is `crumple-filter`, as it is where the program is
//! called by a link of that name.

mod completion;
mod examples;
mod help;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{ArgMatches, Command, CommandFactory, FromArgMatches};
use crumple_stage::{Call, ExitStatus, OF_ARTIFACT, Program, Way, run_tool, to_stdout, unknown_name};

/// Keeps the budget of memory; the fits take and return some hundred kilobytes at every evaluation of a model.
#[cfg(unix)]
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<mimalloc::MiMalloc> = crumple_memory::Budgeted(mimalloc::MiMalloc);

#[cfg(not(unix))]
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

/// The stages in the order of the chain.
static STAGES: [Program; 8] = [
    crumple_ingest::PROGRAM,
    crumple_filter::PROGRAM,
    crumple_integrate::PROGRAM,
    crumple_identify::PROGRAM,
    crumple_parameter_solve::PROGRAM,
    crumple_simulate::PROGRAM,
    PREDICT,
    crumple_report::PROGRAM,
];

/// `predict`: a stage, and in the folder of a run the user's command.
#[cfg(feature = "run")]
const PREDICT: Program = Program {
    run: |call| {
        match call.way {
            Way::InRun => None,
            _ => crumple_run::predict_in_a_run(call),
        }
        .unwrap_or_else(|| (crumple_predict::PROGRAM.run)(call))
    },
    ..crumple_predict::PROGRAM
};
#[cfg(not(feature = "run"))]
const PREDICT: Program = crumple_predict::PROGRAM;

/// The other programs.
static OTHERS: &[Program] = &[
    #[cfg(feature = "run")]
    crumple_run::DEMO,
    #[cfg(feature = "run")]
    crumple_run::RUN,
    #[cfg(feature = "run")]
    crumple_run::TOGETHER,
    #[cfg(feature = "run")]
    crumple_run::FLEET,
    #[cfg(feature = "run")]
    crumple_run::STUDY,
    #[cfg(feature = "run")]
    crumple_run::WATCH,
    #[cfg(feature = "run")]
    crumple_run::EXPORT,
    #[cfg(feature = "run")]
    crumple_run::VIEW,
    #[cfg(feature = "run")]
    crumple_run::PASSPORT,
    #[cfg(feature = "run")]
    crumple_run::DAMAGE,
    #[cfg(feature = "run")]
    crumple_predict::PLAN,
    #[cfg(feature = "run")]
    crumple_run::COMPARE,
    #[cfg(not(feature = "run"))]
    crumple_report::COMPARE,
    crumple_report::INDEX,
    #[cfg(feature = "run")]
    crumple_run::DIFF,
    #[cfg(not(feature = "run"))]
    crumple_report::DIFF,
    crumple_report::ACCEPT,
    ARTIFACT,
];

/// `artifact`, whose `check` runs a passport again where this program holds the chain.
#[cfg(feature = "run")]
const ARTIFACT: Program = crumple_run::ARTIFACT;
#[cfg(not(feature = "run"))]
const ARTIFACT: Program = crumple_artifact_cli::PROGRAM;

/// What a word in front of all others adds: the help of a program, the completion script of a shell.
const FIRST: [(&str, &str); 2] = [("help", "--help"), ("completions", "--generate")];

fn main() -> ExitCode {
    crumple_stage::hold(&STAGES);
    let call = Call::of_process();
    let link = call.program.strip_prefix("crumple-").unwrap_or_default();
    let of_artifact = OF_ARTIFACT.iter().filter(|name| **name == link).map(OsString::from);
    match program(link) {
        Some(program) => with_examples(link, &call.words, (program.run)(&call)),
        None => of_words(of_artifact.chain(call.words.clone()).collect()),
    }
    .into()
}

fn programs() -> impl Iterator<Item = &'static Program> {
    OTHERS.iter().chain(&STAGES)
}

fn program(name: &str) -> Option<&'static Program> {
    programs().find(|program| program.name == name)
}

fn within(program: &str, words: Vec<OsString>) -> Call {
    Call { program: program.to_owned(), words, way: Way::Within }
}

/// The words that stand for a program.
fn names() -> Vec<&'static str> {
    programs().map(|program| program.name).chain(OF_ARTIFACT).collect()
}

/// Runs the program that the first word names.
fn of_words(mut words: Vec<OsString>) -> ExitStatus {
    let first = words.first().and_then(|word| word.to_str()).unwrap_or_default().to_owned();
    if let Some((_, flag)) = FIRST.iter().find(|(word, _)| *word == first) {
        // `help filter` is `filter --help`, `completions bash` is `--generate bash`.
        words.remove(0);
        words.insert(if first == "help" { words.len() } else { 0 }, (*flag).into());
        return of_words(words);
    }
    if OF_ARTIFACT.contains(&first.as_str()) {
        let status = (ARTIFACT.run)(&within("crumple", words.clone()));
        return with_examples(&first, &words, status);
    }
    if let Some(program) = program(&first) {
        words.remove(0);
        // Completions and man pages are of the link.
        let blank = if is_generating(&words) { '-' } else { ' ' };
        let status = (program.run)(&within(&format!("crumple{blank}{first}"), words.clone()));
        return with_examples(&first, &words, status);
    }
    let unknown = |word: &str| Err(unknown_name(&format!("crumple has no command {word:?}"), word, &names()));
    let is_short = words.is_empty() || words.iter().any(|word| word == "-h");
    let is_bash = is_generating(&words) && words.last().is_some_and(|word| word.as_encoded_bytes().ends_with(b"bash"));
    let call = within("crumple", words);
    let status = match is_short {
        true => run_tool(&call, |All::<true>(word)| unknown(&word)),
        false => run_tool(&call, |All::<false>(word)| unknown(&word)),
    };
    if is_bash { and_print(completion::BASH, status) } else { status }
}

fn is_generating(words: &[OsString]) -> bool {
    words.iter().any(|word| word.as_encoded_bytes().starts_with(b"--generate"))
}

/// Prints the examples of a command behind its help and its man page.
fn with_examples(command: &str, words: &[OsString], status: ExitStatus) -> ExitStatus {
    let before = || words.iter().take_while(|word| *word != "--").filter_map(|word| word.to_str());
    // `artifact unpack` has its own; `artifact show` is `show`.
    let inner = before().next().filter(|word| !word.starts_with('-') && command == "artifact").unwrap_or_default();
    let whole = if OF_ARTIFACT.contains(&inner) { inner.to_owned() } else { format!("{command} {inner}") };
    match examples::of(whole.trim_end()) {
        Some(examples) if before().any(|word| word == "--help") => and_print(&examples::as_help(examples), status),
        Some(examples)
            if is_generating(words) && before().any(|word| word.trim_start_matches("--generate=") == "man") =>
        {
            and_print(&examples::as_man_page(examples), status)
        }
        _ => status,
    }
}

/// Prints more behind what a program printed that is done.
fn and_print(text: &str, status: ExitStatus) -> ExitStatus {
    if status == ExitStatus::Done && to_stdout(text.as_bytes()).is_err() { ExitStatus::Failure } else { status }
}

/// The command line as a whole: for its help, which may be short, its completions, and a word that names no program.
struct All<const SHORT: bool>(String);

impl<const SHORT: bool> CommandFactory for All<SHORT> {
    fn command() -> Command {
        let artifact = (ARTIFACT.command)();
        let of_artifact = artifact.get_subcommands().filter(|command| OF_ARTIFACT.contains(&command.get_name()));
        let keys = completion::keys(&STAGES);
        let of_runs =
            OTHERS.iter().map(|program| completion::with_values((program.command)().name(program.name), &keys));
        let stages = STAGES.iter().map(|stage| (stage.command)().name(stage.name));
        let commands: Vec<Command> = of_runs.chain(stages).chain(of_artifact.cloned()).collect();
        let in_a_line = |command: &Command| command.clone().about(help::in_a_line(command));
        Command::new("crumple")
            .version(env!("CARGO_PKG_VERSION"))
            .about("A crash pulse in, a physical model out: crumple run crash.csv")
            .arg_required_else_help(true)
            .disable_help_subcommand(true)
            .allow_external_subcommands(true)
            .help_template(help::template(&commands, SHORT))
            .subcommands(completion::words(names()))
            .subcommands(commands.iter().map(in_a_line))
            .after_help(
                "crumple help COMMAND explains a command, with examples; crumple COMMAND -h is shorter.\n\
                 crumple completions bash|zsh|fish prints a completion script; crumple --help has all options.",
            )
    }

    fn command_for_update() -> Command {
        Self::command()
    }
}

impl<const SHORT: bool> FromArgMatches for All<SHORT> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        Ok(Self(matches.subcommand_name().unwrap_or_default().to_owned()))
    }

    fn update_from_arg_matches(&mut self, _: &ArgMatches) -> Result<(), clap::Error> {
        Ok(())
    }
}

#[cfg(all(test, feature = "run"))]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_in_one_group_of_the_help() {
        let mut grouped: Vec<&str> = help::GROUPS.iter().flat_map(|group| group.commands).copied().collect();
        let mut all = names();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
    }

    /// What a command line of these words says, or why it says nothing.
    fn parsed(words: &[String]) -> Result<(), clap::Error> {
        let parse = |program: &Program, words: &[String]| {
            (program.command)().no_binary_name(true).try_get_matches_from(words).map(drop)
        };
        let first = words[0].as_str();
        if OF_ARTIFACT.contains(&first) {
            return parse(&ARTIFACT, words);
        }
        let mut rest = words[1..].to_vec();
        match first {
            // In the folder of a run, where the stage needs no output.
            "predict" => rest.extend(["-o".to_owned(), "7.mcap".to_owned()]),
            // A list needs no output either.
            "ingest" if rest.iter().any(|word| word == "--list") => {
                rest.extend(["-o".to_owned(), "1.mcap".to_owned()]);
            }
            // Records and flags of the joint prediction.
            "together" => rest.insert(0, "--".to_owned()),
            _ => {}
        }
        parse(program(first).unwrap_or_else(|| panic!("no command {first}")), &rest)
    }

    #[test]
    fn every_command_has_three_examples_that_parse() {
        for name in names().into_iter().chain(["artifact unpack", "artifact pack"]) {
            let examples = examples::of(name).unwrap_or_else(|| panic!("{name} has no examples"));
            for (_, typed) in examples {
                let words = shell_words::split(typed).unwrap();
                parsed(&words).unwrap_or_else(|error| panic!("crumple {typed}: {error}"));
            }
        }
    }
}
