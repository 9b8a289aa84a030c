//! What the completion scripts know beside flags: keys of `--set`, names of pipelines, commands behind `help`.

use clap::builder::PossibleValuesParser;
use clap::{Arg, Command};
use crumple_stage::{Pipeline, Program};

/// Keys of all stages as `--set` takes them, up to the value: `filter.cfc=`. Options of a stage have a heading in its
/// help, flags that every stage has do not. They live as long as the process, which ends with the script.
pub fn keys(stages: &[Program]) -> Vec<&'static str> {
    let of_stage = |stage: &Program| {
        let command = (stage.command)();
        let options = command.get_arguments().filter(|arg| arg.get_help_heading().is_some());
        let key = |long: &str| -> &'static str { format!("{}.{}=", stage.name, long.replace('-', "_")).leak() };
        options.filter_map(Arg::get_long).map(key).collect::<Vec<_>>()
    };
    stages.iter().flat_map(of_stage).collect()
}

/// A command of runs with what may stand behind `--set` and `--pipeline`.
pub fn with_values(command: Command, keys: &[&'static str]) -> Command {
    command.mut_args(|arg| match arg.get_long().unwrap_or_default() {
        "set" => arg.value_parser(PossibleValuesParser::new(keys.to_vec())),
        "pipeline" | "pipelines" => arg.value_parser(PossibleValuesParser::new(Pipeline::built_in())),
        _ => arg,
    })
}

/// The words in front of all commands: `help COMMAND`, `completions SHELL`.
pub fn words(commands: Vec<&'static str>) -> [Command; 2] {
    let takes = |values: PossibleValuesParser| Arg::new("WORD").value_parser(values);
    [
        Command::new("help").arg(takes(commands.into())).about("Explains a command, with examples"),
        Command::new("completions").arg(takes(["bash", "zsh", "fish"].into())).about("Prints a completion script"),
    ]
}

/// Stands behind the script of bash: no blank behind `filter.cfc=`, where the value follows.
pub const BASH: &str = r#"
_crumple_without_blank() {
    _crumple "$@"
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]]; then compopt -o nospace; fi
}
complete -F _crumple_without_blank -o nosort -o bashdefault -o default crumple 2>/dev/null ||
    complete -F _crumple_without_blank -o bashdefault -o default crumple
"#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_the_options_of_stages_and_no_other_flags() {
        let keys = keys(&[crumple_ingest::PROGRAM, crumple_filter::PROGRAM, crumple_parameter_solve::PROGRAM]);
        let has = |key: &str| keys.contains(&key);
        assert!(["filter.cfc=", "ingest.mass=", "parameter-solve.front_mass_fraction="].into_iter().all(has));
        assert!(!["ingest.list=", "filter.output=", "filter.force=", "filter.generate="].into_iter().any(has));
    }
}
