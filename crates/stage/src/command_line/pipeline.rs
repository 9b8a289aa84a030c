//! Options from the stage's table of a pipeline file, and flags over them.

use std::path::Path;

use anyhow::Context;
use clap::ArgMatches;
use clap::parser::ValueSource;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::command_line::left_out::{self, LeftOut};
use crate::command_line::pipeline_file::Pipeline;
use crate::error::{Usage, find_in_chain, unknown_name};

/// Merges the stage's table of `pipeline` with the flags given on the command line; a flag wins.
///
/// Errors: an unreadable file; a table or key that does not exist, with the nearest name; a value of the wrong type.
pub(crate) fn merge<O>(
    stage: &str,
    left_out: &[LeftOut],
    pipeline: Option<&Path>,
    flags: &O,
    matches: &ArgMatches,
) -> anyhow::Result<O>
where
    O: clap::Args + Serialize + DeserializeOwned + Default,
{
    let command = O::augment_args(clap::Command::new("options"));
    let keys = option_keys::<O>(&command)?;
    let pipeline = pipeline.map(|path| Pipeline::read(path, None)).transpose()?;
    if let Some(pipeline) = &pipeline
        && let Some(table) = pipeline.table(stage)
    {
        left_out::refuse(table, left_out, &format!("{}: ", pipeline.file()))?;
    }
    let mut table = match &pipeline {
        Some(pipeline) => with_lists(stage_table(stage, pipeline, &keys, &command)?, &command),
        None => toml::Table::new(),
    };
    let given = toml::Table::try_from(flags).context("the flags cannot be written as a table")?;
    for (key, value) in given {
        if is_flag(matches, &key) {
            table.insert(key, value);
        }
    }
    let names: Vec<String> = table.keys().cloned().collect();
    table.try_into().map_err(|error: toml::de::Error| {
        // The text names the key on a line of its own.
        let text = error.to_string().trim().replace('\n', " ");
        let option = names.iter().find(|name| text.contains(&format!("in `{name}")));
        let place = pipeline.map(|pipeline| pipeline.place(stage, option.map_or("", String::as_str)));
        let place = place.map_or_else(String::new, |place| format!("{place}, "));
        Usage::new(format!("{place}options of {stage}: {text}")).into()
    })
}

/// A usage error about keys that nobody stated: they are the default pipeline's, below the one that was given, where
/// nothing but standing alone leaves them out.
pub(crate) fn hint_default_pipeline(stage: &str, pipeline: Option<&Path>, error: anyhow::Error) -> anyhow::Error {
    let Some(pipeline) = pipeline.and_then(|path| Pipeline::read(path, None).ok()) else { return error };
    if find_in_chain::<Usage>(&error).is_none() {
        return error;
    }
    let text = format!("{error:#}");
    let named = |key: &String| {
        let mut words = text.split(|c: char| !(c.is_alphanumeric() || "-_".contains(c)));
        words.any(|word| word.replace('-', "_") == *key)
    };
    let keys: Vec<String> = pipeline.keys_of_default(stage).into_iter().filter(named).collect();
    if keys.is_empty() {
        return error;
    }
    let file = pipeline.file();
    let hint = format!(
        "{} of [{stage}] is the default pipeline's, which {file} is laid over: base = \"none\" on the first line of a \
         pipeline file makes it stand alone",
        keys.join(", ")
    );
    Usage::new(text).hint(hint).into()
}

/// A single value in place of a list is a list of one.
fn with_lists(mut table: toml::Table, command: &clap::Command) -> toml::Table {
    for (key, value) in &mut table {
        let is_list =
            command.get_arguments().any(|a| a.get_id() == key && matches!(a.get_action(), clap::ArgAction::Append));
        if is_list && !value.is_array() && !value.is_table() {
            *value = toml::Value::Array(vec![value.clone()]);
        }
    }
    table
}

/// Whether an option was typed on the command line.
fn is_flag(matches: &ArgMatches, key: &str) -> bool {
    matches.try_contains_id(key).is_ok() && matches.value_source(key) == Some(ValueSource::CommandLine)
}

/// Every flag, and the tables that only a pipeline file can hold: those stand in the options as an empty map.
fn option_keys<O: Serialize + Default>(command: &clap::Command) -> anyhow::Result<Vec<String>> {
    let mut keys: Vec<String> = command.get_arguments().map(|argument| argument.get_id().to_string()).collect();
    let defaults = toml::Table::try_from(O::default()).context("the default options cannot be written as a table")?;
    for (key, _) in defaults.into_iter().filter(|(_, value)| value.is_table()) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    Ok(keys)
}

/// The table of a program in a pipeline file, which may hold `keys`; empty where there is none.
pub fn pipeline_table(stage: &str, pipeline: &Pipeline, keys: &[&str]) -> anyhow::Result<toml::Table> {
    let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    stage_table(stage, pipeline, &keys, &clap::Command::new("options"))
}

/// The table of a stage. A key may be named as its flag: `inputs` of `--inputs`, whose own name is `input_channels`.
fn stage_table(
    stage: &str,
    pipeline: &Pipeline,
    keys: &[String],
    command: &clap::Command,
) -> anyhow::Result<toml::Table> {
    let of_flag = |key: &str| {
        let is_named = |argument: &&clap::Arg| argument.get_long().is_some_and(|long| long.replace('-', "_") == key);
        command.get_arguments().find(is_named).map(|argument| argument.get_id().to_string())
    };
    let mut table = toml::Table::new();
    for (key, value) in pipeline.table(stage).cloned().unwrap_or_default() {
        let own = if keys.contains(&key) { Some(key.clone()) } else { of_flag(&key) };
        let Some(own) = own else {
            let known: Vec<&str> = keys.iter().map(String::as_str).collect();
            let place = pipeline.place(stage, &key);
            return Err(unknown_name(&format!("{place}: unknown key {key:?} in [{stage}]"), &key, &known));
        };
        table.insert(own, value);
    }
    Ok(table)
}

/// Settings as canonical JSON: keys sorted, no blanks.
pub(crate) fn canonical_json<S: Serialize>(settings: &S) -> anyhow::Result<String> {
    let value = serde_json::to_value(settings).context("the settings cannot be written as JSON")?;
    let mut text = String::new();
    write_sorted(&value, &mut text);
    Ok(text)
}

/// Sorts explicitly: whether serde_json's own map is sorted depends on a feature that any dependency may switch on.
fn write_sorted(value: &serde_json::Value, text: &mut String) {
    match value {
        serde_json::Value::Object(map) => {
            let mut entries: Vec<_> = map.iter().collect();
            entries.sort_by(|a, b| a.0.cmp(b.0));
            text.push('{');
            for (k, (key, value)) in entries.into_iter().enumerate() {
                if k > 0 {
                    text.push(',');
                }
                text.push_str(&serde_json::Value::from(key.as_str()).to_string());
                text.push(':');
                write_sorted(value, text);
            }
            text.push('}');
        }
        serde_json::Value::Array(items) => {
            text.push('[');
            for (k, item) in items.iter().enumerate() {
                if k > 0 {
                    text.push(',');
                }
                write_sorted(item, text);
            }
            text.push(']');
        }
        scalar => text.push_str(&scalar.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, FromArgMatches};

    use super::*;
    use crate::command_line::args::Cli;
    use crate::error::render;

    #[test]
    fn a_fault_of_a_key_that_only_the_default_states_says_how_to_leave_it_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my.toml");
        let hint = |text: &str| {
            std::fs::write(&path, text).unwrap();
            let error = Usage::new("paper \"era\" prescribes orders, which is given too").hint("leave out orders");
            render(&hint_default_pipeline("identify", Some(&path), error.into()))
        };
        let laid_over = hint("[identify]\npaper = 'era'\n");
        assert!(laid_over.contains("hint: orders of [identify] is the default pipeline's"), "{laid_over}");
        assert!(laid_over.contains("base = \"none\"") && laid_over.contains("my.toml"), "{laid_over}");
        for own in ["base = 'none'\n[identify]\npaper = 'era'\norders = [4]\n", "[identify]\norders = [6]\n"] {
            assert!(hint(own).ends_with("hint: leave out orders"), "{own}");
        }
    }

    #[derive(Debug, Default, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Options {
        /// Class.
        #[arg(long)]
        cfc: Option<u16>,
        /// Models.
        #[arg(long, value_delimiter = ',')]
        models: Vec<String>,
        /// Speed.
        #[arg(long)]
        impact_speed: Option<crumple_signal::value::Speed>,
    }

    fn merged(pipeline: &str, flags: &[&str]) -> anyhow::Result<Options> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.toml");
        std::fs::write(&path, format!("base = 'none'\n{pipeline}")).unwrap();
        let arguments = ["x", "in.mcap", "-o", "out.mcap"].iter().chain(flags);
        let matches = Cli::<Options>::command().try_get_matches_from(arguments).unwrap();
        let cli = Cli::<Options>::from_arg_matches(&matches).unwrap();
        merge("filter", &[], Some(&path), &cli.options, &matches)
            .map_err(|e| anyhow::anyhow!(render(&e).replace(&path.display().to_string(), "p.toml")))
    }

    #[test]
    fn a_flag_beats_the_table_and_the_table_beats_nothing() {
        let table =
            "title = 'x'\n[filter]\ncfc = 180\nmodels = ['a', 'b']\nimpact_speed = '36 km/h'\n[identify]\nany = 1\n";
        let options = merged(table, &["--cfc", "60"]).unwrap();
        assert_eq!(options.cfc, Some(60));
        assert_eq!(options.models, ["a", "b"]);
        assert_eq!(options.impact_speed.unwrap().si(), 10.0);
        assert_eq!(merged(table, &["--models", "c"]).unwrap().models, ["c"]);
        assert_eq!(merged("", &[]).unwrap(), Options::default());
    }

    #[test]
    fn unknown_names_are_answered_with_the_nearest() {
        let text = |pipeline| merged(pipeline, &[]).unwrap_err().to_string();
        insta::assert_snapshot!(text("[filter]\nmodel = ['a']"), @r#"
        error: p.toml: unknown key "model" in [filter]
          hint: did you mean "models"?
        "#);
        insta::assert_snapshot!(text("[filtre]\ncfc = 60"), @r#"
        error: p.toml: unknown table "filtre"
          hint: did you mean "filter"?
        "#);
        insta::assert_snapshot!(text("titel = 'x'"), @r#"
        error: p.toml: unknown key "titel"
          hint: did you mean "title"?
        "#);
        assert_eq!(
            text("[filter]\nimpact_speed = 35"),
            "error: p.toml, options of filter: \"35\" has no unit: write a speed, e.g. 35 km/h (units: m/s, km/h, mph, \
             mm/s, ft/s) in `impact_speed`"
        );
    }

    #[test]
    fn canonical_json_sorts_keys_at_every_depth() {
        let value = serde_json::json!({ "b": 1, "a": { "d": [1.5, null], "c": "x" } });
        assert_eq!(canonical_json(&value).unwrap(), r#"{"a":{"c":"x","d":[1.5,null]},"b":1}"#);
    }
}
