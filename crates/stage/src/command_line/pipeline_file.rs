//! A pipeline file: a table for each stage, laid over the default pipeline unless it stands alone.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::Context;
use toml::{Table, Value};

use crate::command_line::of_runs::{ALLOW, LIMITS, REMARKS, refuse_wrong_codes, refuse_wrong_limits};
use crate::error::{Usage, unknown_name};
use crate::names::STAGES;

/// A name with the pipeline of it.
macro_rules! built_in {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../../../../pipelines/", $name, ".toml")))),*]
    };
}

/// The pipelines as they were when the program was built, the default one first.
const BUILT_IN: [(&str, &str); 6] =
    built_in!("default" "unfiltered" "two-sensors" "papers/civic" "papers/era" "papers/firefly");
const DEFAULT: &str = BUILT_IN[0].1;
/// Keys beside the tables of stages: what a pipeline says of itself, and the limits within which its runs are the same.
const HEADER_KEYS: [&str; 5] = ["title", "description", "base", LIMITS, REMARKS];
/// What a run adds to the pipeline that it hands to its stages.
const OF_A_RUN: &str = "run";

/// The key of that table that says that the file lay below `pipelines/`.
const IS_NAMED: &str = "is_named";

/// The key of that table that names what the pipeline was laid over.
const LAID_OVER: &str = "laid_over";

/// A pipeline with everything that it is laid over.
///
/// `base = "none"` in a file makes it stand alone; any other file says what it changes, and all else is that of the
/// default pipeline: a key of a stage's table replaces that key, whatever it holds. `STAGE = false` leaves out a stage
/// that a run can do without.
#[derive(Debug, Clone, PartialEq)]
pub struct Pipeline {
    path: PathBuf,
    header: Table,
    stages: Table,
    run: Table,
}

/// The table of [`Pipeline::note_files`] in that of the run.
const FILES: &str = "files";

impl Pipeline {
    /// Names of the pipelines that the program has without a file.
    pub fn built_in() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// Reads a file, and what it is laid over: `default`, or without it the default pipeline built in.
    ///
    /// Errors: a file that cannot be read, what is no TOML, a table, key or base that does not exist.
    pub fn read(path: &Path, default: Option<&Path>) -> anyhow::Result<Self> {
        let mut pipeline = Self::read_alone(path)?;
        let base = match pipeline.header.get("base") {
            None => "default",
            Some(Value::String(base)) if ["default", "none"].contains(&base.as_str()) => base,
            Some(other) => {
                let problem = format!("{}: base is {other}, expected \"default\" or \"none\"", path.display());
                let hint = "leave it out to change the default pipeline, base = \"none\" for a file that stands alone";
                return Err(Usage::new(problem).hint(hint).into());
            }
        };
        if base == "default" {
            let below = match default {
                Some(default) => Self::read_alone(default)?,
                None => Self::parse(Path::new("pipelines/default.toml"), DEFAULT)?,
            };
            pipeline.run.insert(LAID_OVER.to_owned(), Value::from(base));
            let own = std::mem::replace(&mut pipeline.stages, below.stages);
            for (stage, value) in own {
                match (value, pipeline.stages.get_mut(&stage)) {
                    (Value::Table(own), Some(Value::Table(below))) => below.extend(own),
                    (value, _) => {
                        pipeline.stages.insert(stage, value);
                    }
                }
            }
        }
        // What a table was laid over stands in it now.
        pipeline.header.insert("base".to_owned(), Value::from("none"));
        pipeline.stages.retain(|_, value| *value != Value::Boolean(false));
        Ok(pipeline)
    }

    /// A file, or without one the pipeline that was built in under the name of its path.
    fn read_alone(path: &Path) -> anyhow::Result<Self> {
        let named = |name: &str| path.ends_with(Path::new("pipelines").join(name).with_extension("toml"));
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(path, &text),
            Err(error) => match BUILT_IN.iter().find(|(name, _)| named(name)) {
                Some((_, text)) if error.kind() == ErrorKind::NotFound => Self::parse(path, text),
                _ => {
                    let name = path.with_extension("").to_string_lossy().into_owned();
                    let name = name.rsplit_once("pipelines/").map_or(name.as_str(), |(_, name)| name);
                    let problem = format!("cannot read the pipeline file {}: {error}", path.display());
                    Err(unknown_name(&problem, name, &BUILT_IN.map(|(name, _)| name)))
                }
            },
        }
    }

    fn parse(path: &Path, text: &str) -> anyhow::Result<Self> {
        let file: Table = text.parse().map_err(|error: toml::de::Error| {
            let line = error.span().map_or(0, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
            Usage::new(format!("{}, line {line}: {}", path.display(), error.message()))
        })?;
        let mut pipeline =
            Self { path: path.to_owned(), header: Table::new(), stages: Table::new(), run: Table::new() };
        for (key, value) in file {
            match (key.as_str(), value) {
                (OF_A_RUN, Value::Table(run)) => pipeline.run = run,
                (LIMITS, value) if !value.is_table() => {
                    return Err(Usage::new(format!("{}: {LIMITS} is not a table", path.display())).into());
                }
                (LIMITS, Value::Table(limits)) => {
                    refuse_wrong_limits(path, &limits)?;
                    pipeline.header.insert(key, Value::Table(limits));
                }
                (REMARKS, value) => {
                    refuse_wrong_codes(path, &value)?;
                    pipeline.header.insert(key, value);
                }
                (header, value) if HEADER_KEYS.contains(&header) => {
                    pipeline.header.insert(key, value);
                }
                (stage, value @ (Value::Table(_) | Value::Boolean(false))) if STAGES.contains(&stage) => {
                    pipeline.stages.insert(key, value);
                }
                (stage, _) if STAGES.contains(&stage) => {
                    return Err(Usage::new(format!("{}: {stage} is not a table", path.display())).into());
                }
                (_, value) => {
                    let what = if value.is_table() { "table" } else { "key" };
                    let choices: Vec<&str> = STAGES.iter().chain(&HEADER_KEYS).copied().collect();
                    return Err(unknown_name(&format!("{}: unknown {what} {key:?}", path.display()), &key, &choices));
                }
            }
        }
        Ok(pipeline)
    }

    /// Sets one option, as typed: `filter.cfc=180`. What is no TOML value is a text; with commas outside of quotes and
    /// brackets it is a list.
    pub fn set(&mut self, typed: &str) -> anyhow::Result<()> {
        let form = || {
            Usage::new(format!("--set {typed}: expected STAGE.OPTION=VALUE"))
                .hint("e.g. --set filter.cfc=180, --set identify.methods=era,arx, --set predict=false")
        };
        let (key, text) = typed.split_once('=').ok_or_else(form)?;
        let mut names: Vec<String> = key.trim().split('.').map(str::to_owned).collect();
        // Options are flags too, with hyphens.
        names.iter_mut().skip(1).for_each(|name| *name = name.replace('-', "_"));
        let (Some(option), Some(stage)) = (names.pop(), names.first().cloned()) else {
            let stage = key.trim();
            if !STAGES.contains(&stage) || text.trim() != "false" {
                return Err(form().into());
            }
            self.stages.remove(stage);
            return self.note_set(typed);
        };
        if !STAGES.contains(&stage.as_str()) {
            return Err(unknown_name(&format!("--set {typed}: unknown stage {stage:?}"), &stage, &STAGES));
        }
        if option.is_empty() || names.iter().any(String::is_empty) {
            return Err(form().into());
        }
        let mut table = &mut self.stages;
        for name in names {
            let inner = table.entry(name).or_insert_with(|| Value::Table(Table::new()));
            table = inner.as_table_mut().ok_or_else(form)?;
        }
        let value = value_of(text.trim());
        let value = match (table.get(&option), value) {
            (Some(Value::Array(_)), value) if !value.is_array() => Value::Array(vec![value]),
            (_, value) => value,
        };
        table.insert(option, value);
        self.note_set(typed)
    }

    fn note_set(&mut self, typed: &str) -> anyhow::Result<()> {
        let set = self.run.entry("set").or_insert_with(|| Value::Array(Vec::new()));
        set.as_array_mut().context("the key set of [run] is no list")?.push(Value::from(typed));
        Ok(())
    }

    /// Name of the file in a run folder.
    pub const OF_A_RUN: &str = "0-pipeline.toml";

    /// What [`note_end`](Self::note_end) notes in place of a digest where the last run failed.
    pub const FAILED: &str = "failed";

    /// Notes what a run hands on with the pipeline: its name, the file it was read from without the folder that this
    /// lies in, so that the same run elsewhere has the same bytes.
    pub fn note_run(&mut self, name: &str) {
        self.run.insert("name".to_owned(), Value::from(name));
        let parts: Vec<String> = self.path.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        let from = parts.iter().rposition(|part| part == "pipelines").unwrap_or(parts.len().saturating_sub(1));
        self.run.insert("file".to_owned(), Value::from(parts[from..].join("/")));
        if parts.get(from).is_some_and(|part| part == "pipelines") {
            self.run.insert(IS_NAMED.to_owned(), Value::from(true));
        }
    }

    /// Whether a run named it: its file lay below `pipelines/`.
    pub fn is_named(&self) -> bool {
        self.run.get(IS_NAMED) == Some(&Value::from(true))
    }

    /// Notes which record the run is of.
    pub fn note_record(&mut self, record: &str) {
        self.run.insert("record".to_owned(), Value::from(record));
    }

    /// What [`note_record`](Self::note_record) noted.
    pub fn record(&self) -> Option<&str> {
        self.run.get("record").and_then(Value::as_str)
    }

    /// Notes what was typed for a stage: `what` is `flags`, or `program` for one from elsewhere.
    pub fn note_typed(&mut self, what: &str, stage: &str, typed: &str) {
        let table = self.run.entry(what).or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(table) = table {
            table.insert(stage.to_owned(), Value::from(typed));
        }
    }

    /// What [`note_typed`](Self::note_typed) noted.
    pub fn typed(&self, what: &str, stage: &str) -> Option<&str> {
        self.run.get(what)?.get(stage)?.as_str()
    }

    /// Notes how the run ended that the pipeline is of: a digest of all that it left and was made by, its exit code.
    pub fn note_end(&mut self, state: &str, code: u8) {
        self.run.insert("state".to_owned(), Value::from(state));
        self.run.insert("exit_code".to_owned(), Value::from(i64::from(code)));
    }

    /// What [`note_end`](Self::note_end) noted.
    pub fn end(&self) -> Option<(&str, u8)> {
        let code = self.run.get("exit_code")?.as_integer()?;
        Some((self.run.get("state")?.as_str()?, u8::try_from(code).ok()?))
    }

    /// The exit code of the last run into a folder, where it failed: what lies there is of an earlier run.
    pub fn failure_in(folder: &Path) -> Option<u8> {
        let pipeline = Self::read(&folder.join(Self::OF_A_RUN), None).ok()?;
        pipeline.end().filter(|(state, _)| *state == Self::FAILED).map(|(_, code)| code)
    }

    /// The name that a run noted.
    pub fn name(&self) -> Option<&str> {
        self.run.get("name").and_then(Value::as_str)
    }

    /// Whether options were set beside the file.
    pub fn is_set(&self) -> bool {
        self.run.contains_key("set")
    }

    /// Codes of the remarks that its runs may have: they are counted, and speak against nothing.
    pub fn allowed(&self) -> impl Iterator<Item = String> {
        let list = self.header.get(REMARKS).and_then(|remarks| remarks.get(ALLOW)).and_then(Value::as_array);
        list.into_iter().flatten().filter_map(Value::as_str).map(str::to_ascii_uppercase)
    }

    /// The table of a stage.
    pub fn table(&self, stage: &str) -> Option<&Table> {
        self.stages.get(stage).and_then(Value::as_table)
    }

    /// The limits within which runs of it are the same, as a tolerance file of `crumple diff` has them.
    pub fn limits(&self) -> Option<&Table> {
        self.header.get(LIMITS).and_then(Value::as_table)
    }

    /// Keys of a stage that came from the default pipeline, below this one; none if it stands alone.
    pub(crate) fn keys_of_default(&self, stage: &str) -> Vec<String> {
        let default = Self::parse(Path::new("pipelines/default.toml"), DEFAULT).ok();
        let (Some(default), true) = (default, self.run.contains_key(LAID_OVER)) else { return Vec::new() };
        let (own, below) = (self.table(stage).into_iter().flatten(), default.table(stage));
        let same = own.filter(|(key, value)| below.and_then(|table| table.get(*key)) == Some(*value));
        same.map(|(key, _)| key.clone()).collect()
    }

    /// The file that the pipeline was read from, for messages.
    pub fn file(&self) -> String {
        let noted = self.run.get("file").and_then(Value::as_str).map(str::to_owned);
        noted.unwrap_or_else(|| self.path.display().to_string())
    }

    /// Where the option of a stage was stated, for messages.
    pub(crate) fn place(&self, stage: &str, option: &str) -> String {
        let is_meant = |typed: &str| {
            let key = typed.split('=').next().unwrap_or_default().trim().replace('-', "_");
            key == format!("{stage}.{option}").replace('-', "_")
        };
        let mut set = self.run.get("set").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
        set.rfind(|typed| is_meant(typed)).map_or_else(|| self.file(), |typed| format!("--set {typed}"))
    }

    /// Notes the files that the program of a stage is, from elsewhere: their names and digests.
    pub fn note_files(&mut self, stage: &str, files: impl IntoIterator<Item = (String, String)>) {
        let files: Table = files.into_iter().map(|(name, digest)| (name, Value::from(digest))).collect();
        let table = self.run.entry(FILES).or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(table) = table {
            table.insert(stage.to_owned(), Value::from(files));
        }
    }

    /// What [`note_files`](Self::note_files) noted for a stage.
    pub fn files(&self, stage: &str) -> BTreeMap<String, String> {
        let files = self.run.get(FILES).and_then(|files| files.get(stage)?.as_table());
        let digests = files.into_iter().flatten().map(|(name, digest)| (name, digest.as_str()));
        digests.filter_map(|(name, digest)| Some((name.clone(), digest?.to_owned()))).collect()
    }

    /// Whether a program from elsewhere stood for a stage.
    pub fn is_foreign(&self, stage: &str) -> bool {
        self.typed("program", stage).is_some()
    }

    /// The same without what a run noted.
    pub fn without_run(self) -> Self {
        Self { run: Table::new(), ..self }
    }

    /// Takes the table of a stage from another pipeline; a stage that the other leaves out is left out.
    pub fn take_stage(&mut self, other: &Self, stage: &str) {
        match other.stages.get(stage) {
            Some(table) => _ = self.stages.insert(stage.to_owned(), table.clone()),
            None => _ = self.stages.remove(stage),
        }
    }

    /// Takes one option from another pipeline, by its name: `filter.cfc`; what the other leaves out is left out.
    pub fn take_option(&mut self, other: &Self, name: &str) {
        let value = other.options_of_stages().remove(name).cloned();
        let mut names: Vec<&str> = name.split('.').collect();
        let Some(option) = names.pop() else { return };
        let mut table = &mut self.stages;
        for name in names {
            let inner = table.entry(name).or_insert_with(|| Value::Table(Table::new()));
            let Value::Table(inner) = inner else { return };
            table = inner;
        }
        match value {
            Some(value) => _ = table.insert(option.to_owned(), value),
            None => _ = table.remove(option),
        }
    }

    /// The names of the options of stages that differ from those of an earlier pipeline.
    pub fn changed_options(&self, before: &Self) -> Vec<String> {
        let (old, new) = (before.options_of_stages(), self.options_of_stages());
        let changes = Self::changes(&old, &new);
        changes.into_iter().map(|(name, _, _)| name).collect()
    }

    /// The options that differ from those of an earlier pipeline: name, old value, new value.
    pub fn changes_since(&self, before: &Self) -> Vec<(String, Option<String>, Option<String>)> {
        Self::changes(&before.options(), &self.options())
    }

    fn changes(old: &Options<'_>, new: &Options<'_>) -> Vec<(String, Option<String>, Option<String>)> {
        let names: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
        let text = |options: &Options<'_>, name: &String| options.get(name).map(ToString::to_string);
        // 180 and "180" are one value to a stage.
        let plain = |value: &&Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let changes = names.into_iter().filter(|name| old.get(*name).map(plain) != new.get(*name).map(plain));
        changes.map(|name| (name.clone(), text(old, name), text(new, name))).collect()
    }

    /// Every option by its name, `filter.cfc`, and the flags noted by a run.
    fn options(&self) -> Options<'_> {
        let mut options = self.options_of_stages();
        for (what, value) in &self.run {
            if let Value::Table(typed) = value {
                walk(&format!("{what} of "), typed, &mut options);
            }
        }
        options
    }

    fn options_of_stages(&self) -> Options<'_> {
        let mut options = Options::new();
        walk("", &self.stages, &mut options);
        options
    }
}

/// Options by their names.
type Options<'a> = BTreeMap<String, &'a Value>;

fn walk<'a>(at: &str, table: &'a Table, into: &mut Options<'a>) {
    for (key, value) in table {
        let name = format!("{at}{key}");
        match value {
            Value::Table(inner) => walk(&format!("{name}."), inner, into),
            value => _ = into.insert(name, value),
        }
    }
}

/// The pipeline as a file that stands alone.
impl std::fmt::Display for Pipeline {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut file = self.header.clone();
        file.extend(self.stages.clone());
        if !self.run.is_empty() {
            file.insert(OF_A_RUN.to_owned(), Value::Table(self.run.clone()));
        }
        f.write_str(&toml::to_string_pretty(&file).map_err(|_| std::fmt::Error)?)
    }
}

/// A value as typed behind `=`.
fn value_of(text: &str) -> Value {
    let as_toml = |text: &str| format!("value = {text}").parse::<Table>().ok().and_then(|mut t| t.remove("value"));
    if let Some(value) = as_toml(text) {
        return value;
    }
    if text.contains(',') && !text.contains(['"', '\'', '[', '{']) {
        return Value::Array(text.split(',').map(|piece| value_of(piece.trim())).collect());
    }
    Value::from(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::render;

    /// A pipeline file with this text, over a default.
    fn read(text: &str) -> anyhow::Result<Pipeline> {
        let folder = tempfile::tempdir().unwrap();
        let (path, default) = (folder.path().join("my.toml"), folder.path().join("default.toml"));
        std::fs::write(&path, text).unwrap();
        std::fs::write(
            &default,
            "title = 'Default'\nbase = 'none'\n[filter]\ncfc = '60'\nmode = 'iso6487'\n[identify]\norders = [4]\n\
             [predict]\n",
        )
        .unwrap();
        Pipeline::read(&path, Some(&default))
            .map_err(|e| anyhow::anyhow!(render(&e).replace(&path.display().to_string(), "my.toml")))
    }

    fn value(pipeline: &Pipeline, stage: &str, key: &str) -> Option<String> {
        pipeline.table(stage)?.get(key).map(ToString::to_string)
    }

    #[test]
    fn every_pipeline_of_the_project_is_built_in() {
        fn names(folder: &Path, before: &str) -> Vec<String> {
            let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
            let of = |path: PathBuf| {
                let name = format!("{before}{}", path.file_stem().unwrap().to_string_lossy());
                match path.is_dir() {
                    true => names(&path, &format!("{name}/")),
                    false => vec![name].into_iter().filter(|_| path.extension().is_some_and(|e| e == "toml")).collect(),
                }
            };
            entries.flat_map(of).collect()
        }
        let mut there = names(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines"), "");
        let mut built_in = BUILT_IN.map(|(name, _)| name.to_owned());
        there.sort();
        built_in.sort();
        assert_eq!(there, built_in);
    }

    #[test]
    fn a_file_says_what_it_changes_and_keeps_the_rest_of_the_default() {
        let over = read("title = 'Mine'\n[filter]\ncfc = 180\n[simulate]\n").unwrap();
        assert_eq!(value(&over, "filter", "cfc").unwrap(), "180");
        assert_eq!(value(&over, "filter", "mode").unwrap(), "\"iso6487\"");
        assert_eq!(value(&over, "identify", "orders").unwrap(), "[4]");
        assert!(over.table("simulate").is_some() && over.table("predict").is_some() && over.table("report").is_none());
        let alone = read("base = 'none'\n[filter]\ncfc = 180\n").unwrap();
        assert_eq!((value(&alone, "filter", "mode"), alone.table("predict")), (None, None));
        assert_eq!(read("predict = false\n").unwrap().table("predict"), None);
        // Its own text stands alone and says the same.
        assert_eq!(read(&over.to_string()).unwrap().to_string(), over.to_string());
    }

    #[test]
    fn the_built_in_default_is_that_of_the_project_and_stands_alone() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines/default.toml");
        let folder = tempfile::tempdir().unwrap();
        let empty = folder.path().join("p.toml");
        std::fs::write(&empty, "").unwrap();
        let (built_in, file) = (Pipeline::read(&empty, None).unwrap(), Pipeline::read(&path, None).unwrap());
        assert_eq!(built_in.stages, file.stages);
        assert_eq!(file.header["base"].as_str(), Some("none"));
    }

    #[test]
    fn a_base_that_does_not_exist_is_refused() {
        insta::assert_snapshot!(read("base = 'papers/civic'").unwrap_err().to_string(), @r#"
        error: my.toml: base is "papers/civic", expected "default" or "none"
          hint: leave it out to change the default pipeline, base = "none" for a file that stands alone
        "#);
    }

    #[test]
    fn options_are_set_as_typed() {
        let mut pipeline = read("").unwrap();
        for typed in [
            "filter.cfc=180",
            "filter.zero-level=none",
            "predict.speeds=40 km/h, 56km/h",
            "identify.orders=6",
            "identify.arx_orders=\"2,2,3\"",
            "predict.partner.barrier=mpdb",
        ] {
            pipeline.set(typed).unwrap();
        }
        assert_eq!(value(&pipeline, "filter", "cfc").unwrap(), "180");
        assert_eq!(value(&pipeline, "filter", "zero_level").unwrap(), "\"none\"");
        assert_eq!(value(&pipeline, "predict", "speeds").unwrap(), r#"["40 km/h", "56km/h"]"#);
        assert_eq!(value(&pipeline, "identify", "orders").unwrap(), "[6]");
        assert_eq!(value(&pipeline, "identify", "arx_orders").unwrap(), "\"2,2,3\"");
        assert_eq!(value(&pipeline, "predict", "partner").unwrap(), r#"{ barrier = "mpdb" }"#);
        assert_eq!(pipeline.place("filter", "zero_level"), "--set filter.zero-level=none");
        pipeline.set("predict=false").unwrap();
        assert_eq!(pipeline.table("predict"), None);
        for wrong in ["cfc", "cfc=60", ".cfc=60", "filter.=60", "predict=true", "filter.cfc.x=1"] {
            assert!(pipeline.set(wrong).is_err(), "{wrong}");
        }
        let error = render(&pipeline.set("filtr.cfc=60").unwrap_err());
        assert!(error.contains("did you mean \"filter\"?"), "{error}");
    }

    #[test]
    fn what_a_run_notes_is_read_back() {
        let mut pipeline = read("").unwrap();
        assert_eq!((pipeline.name(), pipeline.end(), pipeline.is_set()), (None, None, false));
        pipeline.note_run("my");
        pipeline.note_end("blake3:aa", 4);
        pipeline.set("filter.cfc=180").unwrap();
        assert_eq!((pipeline.name(), pipeline.end(), pipeline.is_set()), (Some("my"), Some(("blake3:aa", 4)), true));
    }

    #[test]
    fn a_fault_in_the_file_is_named_by_its_line() {
        let error = read("title = 'x'\n\n[filter]\ncfc = = 60\n").unwrap_err().to_string();
        assert!(error.starts_with("error: my.toml, line 4: "), "{error}");
        let error = read("filter = 60").unwrap_err().to_string();
        assert!(error.contains("filter is not a table"), "{error}");
        // A list stays the list that was typed.
        let mut pipeline = read("").unwrap();
        pipeline.set("identify.orders=[4, 6]").unwrap();
        assert_eq!(value(&pipeline, "identify", "orders").unwrap(), "[4, 6]");
    }

    #[test]
    fn a_number_and_its_text_are_one_value() {
        let (text, number) = (read("[filter]\ncfc = '180'\n").unwrap(), read("[filter]\ncfc = 180\n").unwrap());
        assert_eq!(number.changes_since(&text), []);
    }

    #[test]
    fn changes_are_told_by_option_with_both_values() {
        let before = read("[filter]\nmode = 'sae'\n").unwrap();
        let mut now = read("").unwrap();
        now.set("filter.cfc=180").unwrap();
        now.note_run("my");
        now.note_typed("flags", "ingest", "--mass 900kg");
        let text = |value: &str| Some(value.to_owned());
        assert_eq!(
            now.changes_since(&before),
            [
                ("filter.cfc".to_owned(), text("\"60\""), text("180")),
                ("filter.mode".to_owned(), text("\"sae\""), text("\"iso6487\"")),
                ("flags of ingest".to_owned(), None, text("\"--mass 900kg\"")),
            ]
        );
        assert_eq!(now.changes_since(&now.clone()), []);
    }
}
