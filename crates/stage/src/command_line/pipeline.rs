//! Options from the stage's table of a pipeline file, and flags over them.

use std::path::Path;

use anyhow::Context;
use clap::ArgMatches;
use clap::parser::ValueSource;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Usage;
use crate::names::nearest::nearest;
use crate::names::stages::STAGES;

/// Keys beside the tables: what a pipeline says of itself.
const HEADER_KEYS: [&str; 2] = ["title", "description"];

/// Merges the stage's table of `pipeline` with the flags given on the command line; a flag wins.
///
/// Errors: an unreadable file; a table or key that does not exist, with the nearest name; a value of the wrong type.
pub(crate) fn merge<O>(stage: &str, pipeline: Option<&Path>, flags: &O, matches: &ArgMatches) -> anyhow::Result<O>
where
    O: clap::Args + Serialize + DeserializeOwned + Default,
{
    let keys = option_keys::<O>()?;
    let mut table = match pipeline {
        Some(path) => stage_table(stage, path, &keys)?,
        None => toml::Table::new(),
    };
    let given = toml::Table::try_from(flags).context("the flags cannot be written as a table")?;
    for (key, value) in given {
        if is_flag(matches, &key) {
            table.insert(key, value);
        }
    }
    table.try_into().map_err(|error: toml::de::Error| {
        let place = pipeline.map_or_else(String::new, |path| format!("{}, ", path.display()));
        // The text names the key on a line of its own.
        Usage::new(format!("{place}options of {stage}: {}", error.to_string().trim().replace('\n', " "))).into()
    })
}

/// Whether an option was typed on the command line.
pub(crate) fn is_flag(matches: &ArgMatches, key: &str) -> bool {
    matches.try_contains_id(key).is_ok() && matches.value_source(key) == Some(ValueSource::CommandLine)
}

/// Every flag, and the tables that only a pipeline file can hold: those stand in the options as an empty map.
fn option_keys<O: clap::Args + Serialize + Default>() -> anyhow::Result<Vec<String>> {
    let command = O::augment_args(clap::Command::new("options"));
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
pub fn pipeline_table(stage: &str, path: &Path, keys: &[&str]) -> anyhow::Result<toml::Table> {
    let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    stage_table(stage, path, &keys)
}

fn stage_table(stage: &str, path: &Path, keys: &[String]) -> anyhow::Result<toml::Table> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        Usage::new(format!("cannot read the pipeline file {}: {error}", path.display()))
            .hint("pipelines lie in the folder pipelines/, e.g. --pipeline pipelines/default.toml")
    })?;
    let mut file: toml::Table = text.parse().map_err(|error: toml::de::Error| {
        let line = error.span().map_or(0, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
        Usage::new(format!("{}, line {line}: {}", path.display(), error.message()))
    })?;
    for key in file.keys() {
        if !STAGES.contains(&key.as_str()) && !HEADER_KEYS.contains(&key.as_str()) {
            let what = if file[key].is_table() { "table" } else { "key" };
            let choices: Vec<&str> = STAGES.iter().chain(&HEADER_KEYS).copied().collect();
            return Err(unknown_name(&format!("{}: unknown {what} {key:?}", path.display()), key, &choices));
        }
    }
    let table = match file.remove(stage) {
        None => return Ok(toml::Table::new()),
        Some(toml::Value::Table(table)) => table,
        Some(_) => return Err(Usage::new(format!("{}: {stage} is not a table", path.display())).into()),
    };
    for key in table.keys() {
        if !keys.iter().any(|known| known == key) {
            let known: Vec<&str> = keys.iter().map(String::as_str).collect();
            return Err(unknown_name(&format!("{}: unknown key {key:?} in [{stage}]", path.display()), key, &known));
        }
    }
    Ok(table)
}

/// An error about a name that does not exist: with the nearest that does, or all of them.
pub fn unknown_name(problem: &str, name: &str, choices: &[&str]) -> anyhow::Error {
    let hint = match nearest(name, choices.iter().copied()) {
        Some(near) => format!("did you mean {near:?}?"),
        None => format!("there are: {}", choices.join(", ")),
    };
    Usage::new(problem).hint(hint).into()
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
        std::fs::write(&path, pipeline).unwrap();
        let arguments = ["x", "in.mcap", "-o", "out.mcap"].iter().chain(flags);
        let matches = Cli::<Options>::command().try_get_matches_from(arguments).unwrap();
        let cli = Cli::<Options>::from_arg_matches(&matches).unwrap();
        merge("filter", Some(&path), &cli.options, &matches)
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
