//! How a run was made: its record, its pipeline, and what was typed beside them.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_report::Summary;
use crumple_stage::records::TestV1;
use crumple_stage::{Artifact, Pipeline, Usage, chain, variable_of};

use crate::program::{digest_of, find as in_path, own_command};
use crate::words::Words;

/// Flags of a stage, each with its value, as they were typed.
pub(crate) type Flags = Vec<Vec<String>>;

/// How a run was made, and what it gave.
#[derive(Debug, Clone)]
pub(crate) struct Recipe {
    pub folder: PathBuf,
    pub record: PathBuf,
    /// What the record is: kind and digest of the file, and of that beside it.
    pub made_from: Vec<(String, String)>,
    pub pipeline: Pipeline,
    pub typed: Typed,
    pub summary: Summary,
}

/// What was typed for a run beside its record and its pipeline.
#[derive(Debug, Clone)]
pub(crate) struct Typed {
    /// Flags of stages; those of the first stand behind the record.
    pub flags: BTreeMap<String, Flags>,
    /// Flags of every stage.
    pub of_all: String,
    /// Programs from elsewhere, by stage.
    pub programs: BTreeMap<String, Foreign>,
}

impl Recipe {
    /// How the run in a folder was made; `typed_again` is what to type once all is at hand.
    ///
    /// Errors: the folder does not say it, its record or programs are not at hand, or its version is another one.
    pub(crate) fn of(folder: &Path, typed_again: &str) -> anyhow::Result<Self> {
        let lacks = |what: String, hint: &str| {
            Usage::new(format!("{}: {what}, so its change cannot be divided", folder.display())).hint(hint.to_owned())
        };
        let again = "run both records again";
        let pipeline = Pipeline::read(&folder.join(Pipeline::OF_A_RUN), None)?;
        for stage in chain().filter(|stage| !pipeline.is_foreign(stage.name)) {
            let Some(file) = stage.outputs.first().map(|name| folder.join(name)).filter(|file| is_artifact(file))
            else {
                continue;
            };
            let artifact = Artifact::open(&file).map_err(|error| lacks(error.to_string(), again))?;
            let version = artifact.provenance().map_or("", |made| made.stage_version.as_str());
            if version != VERSION {
                let what = format!("{} is of version {version:?}, this is {VERSION}", file.display());
                return Err(lacks(what, "run both records again with one version").into());
            }
        }
        let named = pipeline.record().unwrap_or_default();
        let Some(record) = place_of(folder, named).filter(|_| !named.is_empty()) else {
            let here = std::path::absolute(named).unwrap_or_else(|_| PathBuf::from(named));
            let hint = format!(
                "looked for {}, and for {named} in every folder above {}; put the record there and type {typed_again}",
                here.display(),
                folder.display()
            );
            return Err(lacks(format!("the record {named:?} is not at hand"), &hint).into());
        };
        let typed = Typed::of(&pipeline)?;
        if let Some(name) = typed.programs.values().find_map(Foreign::changed) {
            let hint = "put it back as it was, or run both records again";
            return Err(lacks(format!("the program {name} is another one by now, or not at hand"), hint).into());
        }
        Ok(Self {
            record,
            made_from: made_from(folder).ok_or_else(|| lacks("there is no 1-ingest.mcap".to_owned(), again))?,
            typed,
            summary: Self::summary(folder).ok_or_else(|| lacks("there is no summary.json".to_owned(), again))?,
            folder: folder.to_owned(),
            pipeline: pipeline.without_run(),
        })
    }

    /// The summary of a run folder.
    pub(crate) fn summary(folder: &Path) -> Option<Summary> {
        serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).ok()?).ok()
    }
}

impl Typed {
    /// What a run noted in its pipeline.
    pub(crate) fn of(pipeline: &Pipeline) -> anyhow::Result<Self> {
        let mut flags = BTreeMap::new();
        for stage in chain() {
            let typed: Words = pipeline.typed("flags", stage.name).unwrap_or_default().parse()?;
            flags.insert(stage.name.to_owned(), grouped(&typed));
        }
        let foreign = |stage: &str| Some((stage.to_owned(), Foreign::of(pipeline, stage)?));
        Ok(Self {
            flags,
            of_all: pipeline.typed("flags", "every stage").unwrap_or_default().to_owned(),
            programs: chain().filter_map(|stage| foreign(stage.name)).collect(),
        })
    }

    /// Runs the chain with it, and with nothing that the environment names.
    pub(crate) fn run(&self, project: &Path, pipeline: &OsStr, record: &Path, out: &Path) -> Command {
        let mut command = own_command("run");
        chain().for_each(|stage| _ = command.env_remove(variable_of(stage.name)));
        command.arg("--project").arg(project).arg("--pipeline").arg(pipeline).arg("--out").arg(out);
        command.args(["-q", "--flags", &self.of_all]);
        self.commands().for_each(|typed| _ = command.arg("--stage").arg(typed));
        command.arg(record).args(self.flags.get("ingest").into_iter().flatten().flatten());
        command
    }

    /// The commands of stages that are not run as they are: programs from elsewhere, and flags of the project's own.
    pub(crate) fn commands(&self) -> impl Iterator<Item = String> {
        chain().filter(|stage| stage.name != "ingest" || self.programs.contains_key("ingest")).filter_map(|stage| {
            let flags = self.flags.get(stage.name).into_iter().flatten().flatten().cloned().collect();
            match self.programs.get(stage.name) {
                Some(program) => Some(format!("{}={}", stage.name, program.typed)),
                None => Some(Words(flags))
                    .filter(|flags| !flags.is_empty())
                    .map(|flags| format!("{}=crumple {} {flags}", stage.name, stage.name)),
            }
        })
    }
}

/// Whether a stage wrote an artifact there.
fn is_artifact(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "mcap") && file.is_file()
}

/// The version that this program makes runs with.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A program from elsewhere: its command, and its files with their digests.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Foreign {
    pub typed: String,
    pub files: BTreeMap<String, String>,
}

impl Foreign {
    fn of(pipeline: &Pipeline, stage: &str) -> Option<Self> {
        Some(Self { typed: pipeline.typed("program", stage)?.to_owned(), files: pipeline.files(stage) })
    }

    /// The first of its files that is no longer what it was.
    fn changed(&self) -> Option<&str> {
        let now = |name: &str| {
            let here = Some(PathBuf::from(name)).filter(|path| path.is_file());
            digest_of(&here.or_else(|| in_path(name))?)
        };
        let is_changed = |(name, digest): &(&String, &String)| now(name).as_ref() != Some(digest);
        self.files.iter().find(is_changed).map(|(name, _)| name.as_str())
    }
}

/// What a run was made from: kind and digest of the record and of the file beside it.
pub(crate) fn made_from(folder: &Path) -> Option<Vec<(String, String)>> {
    let ingested = Artifact::open(&folder.join("1-ingest.mcap")).ok()?;
    let test = ingested.record::<TestV1>("/test").ok()??;
    let inputs = ingested.provenance().map_or(&[][..], |made| &made.inputs[..]);
    let inputs = inputs.iter().map(|input| (input.kind.clone(), input.digest.clone()));
    Some(std::iter::once(("record".to_owned(), test.source.digest)).chain(inputs).collect())
}

/// A record by the path that a run noted: from here, or from a folder above the run, which was its project.
pub(crate) fn place_of(folder: &Path, named: &str) -> Option<PathBuf> {
    let folder = folder.canonicalize().ok()?;
    let from = std::iter::once(Path::new("")).chain(folder.ancestors());
    from.map(|project| project.join(named)).find(|path| path.exists())
}

/// Flags with their values: `--mass 1450kg`, `--trim`.
pub(crate) fn grouped(words: &[String]) -> Flags {
    let mut groups = Flags::new();
    for word in words {
        match groups.last_mut() {
            Some(group) if !word.starts_with("--") => group.push(word.clone()),
            _ => groups.push(vec![word.clone()]),
        }
    }
    groups
}

/// The name of a flag: `--mass`, `--mass=1450kg`.
pub(crate) fn flag_name(group: &[String]) -> &str {
    group[0].split('=').next().unwrap_or_default()
}
