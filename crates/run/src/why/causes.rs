//! What two runs were made with that differs, and the runs in between.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crumple_report::Summary;
use crumple_stage::records::TestV1;
use crumple_stage::{Artifact, Pipeline, Usage, chain};

use crate::program::{digest_of, find as in_path};
use crate::words::Words;

/// Flags of a stage, each with its value, as they were typed.
type Flags = Vec<Vec<String>>;

/// How a run was made, and what it gave.
#[derive(Debug, Clone)]
pub(super) struct Recipe {
    pub folder: PathBuf,
    pub record: PathBuf,
    /// What the record is: kind and digest of the file, and of that beside it.
    pub made_from: Vec<(String, String)>,
    pub pipeline: Pipeline,
    /// Flags of stages; those of the first stand behind the record.
    pub flags: BTreeMap<String, Flags>,
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
            let hint = "call it where the record lies: the path is counted from the project";
            return Err(lacks(format!("the record {named:?} is not at hand"), hint).into());
        };
        let programs: BTreeMap<_, _> =
            chain().filter_map(|stage| Some((stage.name.to_owned(), Foreign::of(&pipeline, stage.name)?))).collect();
        if let Some(name) = programs.values().find_map(Foreign::changed) {
            let hint = "put it back as it was, or run both records again";
            return Err(lacks(format!("the program {name} is another one by now, or not at hand"), hint).into());
        }
        let mut flags = BTreeMap::new();
        for stage in chain() {
            let typed: Words = pipeline.typed("flags", stage.name).unwrap_or_default().parse()?;
            flags.insert(stage.name.to_owned(), grouped(&typed));
        }
        Ok(Self {
            record,
            made_from: made_from(folder).ok_or_else(|| lacks("there is no 1-ingest.mcap".to_owned(), again))?,
            flags,
            of_all: pipeline.typed("flags", "every stage").unwrap_or_default().to_owned(),
            programs,
            summary: Self::summary(folder).ok_or_else(|| lacks("there is no summary.json".to_owned(), again))?,
            folder: folder.to_owned(),
            pipeline: pipeline.without_run(),
        })
    }

    /// The summary of a run folder.
    pub(super) fn summary(folder: &Path) -> Option<Summary> {
        serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).ok()?).ok()
    }

    /// The commands of stages that are not run as they are: programs from elsewhere, and flags of the project's own.
    pub(super) fn commands(&self) -> impl Iterator<Item = String> {
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
pub(super) fn made_from(folder: &Path) -> Option<Vec<(String, String)>> {
    let ingested = Artifact::open(&folder.join("1-ingest.mcap")).ok()?;
    let test = ingested.record::<TestV1>("/test").ok()??;
    let inputs = ingested.provenance().map_or(&[][..], |made| &made.inputs[..]);
    let inputs = inputs.iter().map(|input| (input.kind.clone(), input.digest.clone()));
    Some(std::iter::once(("record".to_owned(), test.source.digest)).chain(inputs).collect())
}

/// A record by the path that a run noted: from here, or from a folder above the run, which was its project.
fn place_of(folder: &Path, named: &str) -> Option<PathBuf> {
    let folder = folder.canonicalize().ok()?;
    let from = std::iter::once(Path::new("")).chain(folder.ancestors());
    from.map(|project| project.join(named)).find(|path| path.exists())
}

/// Flags with their values: `--mass 1450kg`, `--trim`.
fn grouped(words: &Words) -> Flags {
    let mut groups = Flags::new();
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
    /// A flag of a stage.
    Flag(String, String),
    /// The flags of every stage.
    OfAll,
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
    /// All that differs, each by itself.
    pub(super) fn between<'a>(a: &'a Recipe, b: &'a Recipe) -> Self {
        let place = |stage: &str| chain().position(|known| known.name == stage).unwrap_or(0);
        let mut all = Vec::new();
        let mut add =
            |name: String, stage: &str, what: What| all.push(Cause { name, stage: place(stage), what: vec![what] });
        if a.made_from != b.made_from {
            add("record".to_owned(), "ingest", What::Record);
        }
        if a.of_all != b.of_all {
            add("flags of every stage".to_owned(), "ingest", What::OfAll);
        }
        for stage in chain() {
            let of = |recipe: &'a Recipe| recipe.flags.get(stage.name).map_or(&[][..], Vec::as_slice);
            let names: BTreeSet<&str> = of(a).iter().chain(of(b)).map(|group| flag_name(group)).collect();
            let flags = |recipe: &'a Recipe, name: &str| -> Flags {
                of(recipe).iter().filter(|group| flag_name(group) == name).cloned().collect()
            };
            for name in names.into_iter().filter(|name| flags(a, name) != flags(b, name)) {
                let shown = format!("{}.{}", stage.name, name.trim_start_matches('-').replace('-', "_"));
                add(shown, stage.name, What::Flag(stage.name.to_owned(), name.to_owned()));
            }
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
        Self(all)
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
                What::Record => (mixed.record, mixed.made_from) = (b.record.clone(), b.made_from.clone()),
                What::OfAll => b.of_all.clone_into(&mut mixed.of_all),
                What::Flag(stage, name) => {
                    let is_meant = |group: &Vec<String>| flag_name(group) == name;
                    let taken: Flags = b.flags[stage].iter().filter(|group| is_meant(group)).cloned().collect();
                    let flags = mixed.flags.entry(stage.clone()).or_default();
                    flags.retain(|group| !is_meant(group));
                    flags.extend(taken);
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
