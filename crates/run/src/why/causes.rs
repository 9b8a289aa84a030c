//! What two runs were made with that differs, and the runs in between.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_report::Summary;
use crumple_stage::records::TestV1;
use crumple_stage::{Artifact, Pipeline, Refused, Usage, chain};

use crate::program::digest_of;
use crate::words::Words;

/// How a run was made, and what it gave.
#[derive(Debug, Clone)]
pub(super) struct Recipe {
    pub folder: PathBuf,
    pub record: PathBuf,
    /// Digest of the record.
    pub digest: String,
    pub pipeline: Pipeline,
    /// Flags of the stage that reads the record, each with its value: as they were typed.
    pub flags: Vec<Vec<String>>,
    /// Flags of every stage.
    pub of_all: String,
    /// Programs from elsewhere, by stage.
    pub programs: BTreeMap<String, Foreign>,
    pub summary: Summary,
}

impl Recipe {
    pub(super) fn of(folder: &Path) -> anyhow::Result<Self> {
        let lacks = |what: String, hint: &str| {
            Usage::new(format!("{}: {what}, so its change cannot be divided", folder.display())).hint(hint.to_owned())
        };
        let file = folder.join(Pipeline::OF_A_RUN);
        if !file.is_file() {
            let hint = "two folders that crumple run made: runs/RECORD/PIPELINE";
            return Err(lacks(format!("there is no {}", Pipeline::OF_A_RUN), hint).into());
        }
        let pipeline = Pipeline::read(&file, None)?;
        let ingested = Artifact::open(&folder.join("1-ingest.mcap")).map_err(Refused::from)?;
        let version = ingested.provenance().map_or("", |made| made.stage_version.as_str());
        if version != VERSION && !pipeline.is_foreign("ingest") {
            let hint = "run both records again with one version";
            return Err(lacks(format!("version {version} made it, this is {VERSION}"), hint).into());
        }
        let named = pipeline.record().unwrap_or_default();
        let Some(record) = place_of(folder, named).filter(|_| !named.is_empty()) else {
            let hint = "call it where the record lies: the path is counted from the project";
            return Err(lacks(format!("the record {named:?} is not at hand"), hint).into());
        };
        let programs: BTreeMap<_, _> =
            chain().filter_map(|stage| Some((stage.name.to_owned(), Foreign::of(&pipeline, stage.name)?))).collect();
        if let Some(name) = programs.values().find_map(Foreign::changed) {
            let hint = "put it back as it was, or run both records again";
            return Err(lacks(format!("the program {name} is another one by now"), hint).into());
        }
        let flags: Words = pipeline.typed("flags", "ingest").unwrap_or_default().parse()?;
        Ok(Self {
            record,
            digest: digest_of_record(&ingested).unwrap_or_default(),
            flags: grouped(&flags),
            of_all: pipeline.typed("flags", "every stage").unwrap_or_default().to_owned(),
            programs,
            summary: Self::summary(folder)?,
            folder: folder.to_owned(),
            pipeline: pipeline.without_run(),
        })
    }

    /// The summary of a run folder.
    pub(super) fn summary(folder: &Path) -> anyhow::Result<Summary> {
        let file = folder.join("summary.json");
        let text = fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
        serde_json::from_str(&text).with_context(|| format!("{} is no summary of a run", file.display()))
    }
}

/// The version that this program makes runs with.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A program from elsewhere: its command, and its files with their digests.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Foreign {
    pub typed: String,
    files: BTreeMap<String, String>,
}

impl Foreign {
    fn of(pipeline: &Pipeline, stage: &str) -> Option<Self> {
        Some(Self { typed: pipeline.typed("program", stage)?.to_owned(), files: pipeline.files(stage) })
    }

    /// The first of its files that is there and no longer what it was.
    fn changed(&self) -> Option<&str> {
        let is_changed =
            |(name, digest): &(&String, &String)| digest_of(Path::new(name)).is_some_and(|now| now != **digest);
        self.files.iter().find(is_changed).map(|(name, _)| name.as_str())
    }
}

/// The digest of the record that an artifact of ingest is of.
pub(super) fn digest_of_record(ingested: &Artifact) -> Option<String> {
    Some(ingested.record::<TestV1>("/test").ok()??.source.digest)
}

/// A record by the path that a run noted: from here, or from a folder above the run, which was its project.
fn place_of(folder: &Path, named: &str) -> Option<PathBuf> {
    let folder = folder.canonicalize().ok()?;
    let from = std::iter::once(Path::new("")).chain(folder.ancestors());
    from.map(|project| project.join(named)).find(|path| path.exists())
}

/// Flags with their values: `--mass 1450kg`, `--trim`.
fn grouped(words: &Words) -> Vec<Vec<String>> {
    let mut groups: Vec<Vec<String>> = Vec::new();
    for word in words.iter() {
        match groups.last_mut() {
            Some(group) if !word.starts_with("--") => group.push(word.clone()),
            _ => groups.push(vec![word.clone()]),
        }
    }
    groups
}

/// The name of a flag: `--mass`, `--mass=1450kg`.
fn flag_name(group: &[String]) -> &str {
    group[0].split('=').next().unwrap_or_default()
}

/// One thing that differs.
#[derive(Debug, Clone, PartialEq)]
enum What {
    Record,
    /// A flag of the stage that reads the record.
    Flag(String),
    /// Whether a stage runs at all.
    Stage(String),
    /// An option of the pipeline.
    Option(String),
    Program(String),
}

/// What is changed at once, and what people call it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cause {
    name: String,
    /// Place of its stage in the chain.
    stage: usize,
    what: Vec<What>,
}

/// What two runs were made with that differs, in the order of the chain.
#[derive(Debug)]
pub(super) struct Causes(Vec<Cause>);

impl Causes {
    /// Errors: what cannot be made again.
    pub(super) fn between(a: &Recipe, b: &Recipe) -> anyhow::Result<Self> {
        let place = |stage: &str| chain().position(|known| known.name == stage).unwrap_or(0);
        let mut all = Vec::new();
        let mut add =
            |name: String, stage: &str, what: What| all.push(Cause { name, stage: place(stage), what: vec![what] });
        if a.digest != b.digest {
            add("record".to_owned(), "ingest", What::Record);
        }
        let names: BTreeSet<&str> = a.flags.iter().chain(&b.flags).map(|group| flag_name(group)).collect();
        let flags = |recipe: &Recipe, name: &str| -> Vec<Vec<String>> {
            recipe.flags.iter().filter(|group| flag_name(group) == name).cloned().collect()
        };
        for name in names.into_iter().filter(|name| flags(a, name) != flags(b, name)) {
            add(
                format!("ingest.{}", name.trim_start_matches('-').replace('-', "_")),
                "ingest",
                What::Flag(name.to_owned()),
            );
        }
        let runs = |recipe: &Recipe, stage: &str| recipe.pipeline.table(stage).is_some();
        for stage in chain().filter(|stage| runs(a, stage.name) != runs(b, stage.name)) {
            add(stage.name.to_owned(), stage.name, What::Stage(stage.name.to_owned()));
        }
        for name in b.pipeline.changed_options(&a.pipeline) {
            let stage = name.split('.').next().unwrap_or_default().to_owned();
            if runs(a, &stage) && runs(b, &stage) {
                add(name.clone(), &stage, What::Option(name));
            }
        }
        for stage in chain().filter(|stage| a.programs.get(stage.name) != b.programs.get(stage.name)) {
            add(format!("program of {}", stage.name), stage.name, What::Program(stage.name.to_owned()));
        }
        all.sort_by_key(|cause| cause.stage);
        Ok(Self(all))
    }

    /// The same with no more causes than so many: those of one stage come together, then those of the last stages.
    pub(super) fn at_most(self, most: usize) -> Self {
        let mut causes = self.0;
        let join = |first: &mut Cause, next: Cause| {
            first.name = format!("{}, {}", first.name, next.name);
            first.what.extend(next.what);
        };
        while causes.len() > most {
            let pairs = (1..causes.len()).rev();
            let of_one_stage = pairs.clone().find(|k| causes[*k].stage == causes[k - 1].stage);
            let k = of_one_stage.unwrap_or(causes.len() - 1);
            let next = causes.remove(k);
            join(&mut causes[k - 1], next);
        }
        Self(causes)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|cause| cause.name.clone())
    }

    /// The first stage that a set of causes concerns, by its place in the chain; the length of the chain for none.
    pub(super) fn first_stage(&self, set: usize) -> usize {
        let concerned = self.0.iter().enumerate().filter(|(k, _)| set & (1 << k) != 0);
        concerned.map(|(_, cause)| cause.stage).min().unwrap_or_else(|| chain().count())
    }

    /// The recipe of the first run with a set of causes of the second.
    pub(super) fn mixed(&self, a: &Recipe, b: &Recipe, set: usize) -> Recipe {
        let mut mixed = a.clone();
        let chosen = self.0.iter().enumerate().filter(|(k, _)| set & (1 << k) != 0);
        for what in chosen.flat_map(|(_, cause)| &cause.what) {
            match what {
                What::Record => (mixed.record, mixed.digest) = (b.record.clone(), b.digest.clone()),
                What::Flag(name) => {
                    mixed.flags.retain(|group| flag_name(group) != name);
                    mixed.flags.extend(b.flags.iter().filter(|group| flag_name(group) == name).cloned());
                }
                What::Stage(stage) => mixed.pipeline.take_stage(&b.pipeline, stage),
                What::Option(name) => mixed.pipeline.take_option(&b.pipeline, name),
                What::Program(stage) => match b.programs.get(stage) {
                    Some(program) => _ = mixed.programs.insert(stage.clone(), program.clone()),
                    None => _ = mixed.programs.remove(stage),
                },
            }
        }
        mixed
    }
}
