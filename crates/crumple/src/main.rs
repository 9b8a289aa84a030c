//! `crumple`: every program of the project in one. `crumple filter` is `crumple-filter`, as it is where the program is
//! called by a link of that name.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{ArgMatches, Command, CommandFactory, FromArgMatches};
use crumple_stage::{Call, ExitStatus, OF_ARTIFACT, Program, Way, run_tool, unknown_name};

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

/// The other programs in the order of the help.
static OTHERS: &[Program] = &[
    #[cfg(feature = "run")]
    crumple_run::RUN,
    #[cfg(feature = "run")]
    crumple_run::TOGETHER,
    #[cfg(feature = "run")]
    crumple_run::FLEET,
    #[cfg(feature = "run")]
    crumple_run::STUDY,
    #[cfg(feature = "run")]
    crumple_run::EXPORT,
    #[cfg(feature = "run")]
    crumple_run::VIEW,
    #[cfg(feature = "run")]
    crumple_run::PASSPORT,
    #[cfg(feature = "run")]
    crumple_run::DAMAGE,
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
        Some(program) => (program.run)(&call),
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
        return (ARTIFACT.run)(&within("crumple", words));
    }
    if let Some(program) = program(&first) {
        words.remove(0);
        // Completions and man pages are of the link.
        let blank = if words.iter().any(|word| word == "--generate") { '-' } else { ' ' };
        return (program.run)(&within(&format!("crumple{blank}{first}"), words));
    }
    run_tool(&within("crumple", words), |All(word)| {
        let names: Vec<&str> = programs().map(|program| program.name).chain(OF_ARTIFACT).collect();
        Err(unknown_name(&format!("crumple has no command {word:?}"), &word, &names))
    })
}

/// The command line as a whole: for its help, its completions, and a word that names no program.
struct All(String);

/// What a command is about, up to the first details.
fn in_a_line(command: Command) -> Command {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let end = [". ", " (", ": ", "; ", ", "].iter().filter_map(|mark| about.find(mark)).min().unwrap_or(about.len());
    command.about(about[..end].trim_end_matches('.').to_owned())
}

impl CommandFactory for All {
    fn command() -> Command {
        let artifact = (ARTIFACT.command)();
        let of_artifact = artifact.get_subcommands().filter(|command| OF_ARTIFACT.contains(&command.get_name()));
        let commands = programs().map(|program| (program.command)().name(program.name)).chain(of_artifact.cloned());
        Command::new("crumple")
            .version(env!("CARGO_PKG_VERSION"))
            .about("A crash pulse in, a physical model out: crumple run crash.csv")
            .arg_required_else_help(true)
            .disable_help_subcommand(true)
            .allow_external_subcommands(true)
            .subcommands(commands.enumerate().map(|(number, command)| in_a_line(command).display_order(number)))
            .after_help("crumple COMMAND -h says what a command takes, crumple completions bash|zsh|fish completes it.")
    }

    fn command_for_update() -> Command {
        Self::command()
    }
}

impl FromArgMatches for All {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        Ok(Self(matches.subcommand_name().unwrap_or_default().to_owned()))
    }

    fn update_from_arg_matches(&mut self, _: &ArgMatches) -> Result<(), clap::Error> {
        Ok(())
    }
}
