//! Which runs a fleet has.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_run::Pipeline;
use crumple_stage::Usage;

use crate::command::options::Options;
use crate::command::sweep::combinations;
use crate::records::record::{Digests, Record};
use crate::runs::programs::digest_of_programs;

/// One run of a record.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    /// The record.
    pub(crate) record: Record,
    /// Pipeline as it is typed.
    pub(crate) pipeline: String,
    /// Name of the pipeline.
    pub(crate) pipeline_name: String,
    /// Options set for it, `STAGE.KEY=VALUE`.
    pub(crate) settings: Vec<String>,
    /// Its folder below that of the fleet.
    pub(crate) folder: String,
    /// Digest of all that its result depends on; `None`: the record cannot be read.
    pub(crate) key: Option<String>,
}

impl Run {
    /// The options set for it, as one text.
    pub(crate) fn settings(&self) -> String {
        self.settings.join(",")
    }

    /// `blake3:<hex>` of the record; empty where it cannot be read.
    pub(crate) fn record_digest(&self) -> &str {
        self.record.digests.as_ref().map_or("", |digests| &digests.record)
    }
}

/// The runs of all records with all pipelines and settings, in the order of the tables: by digest of the record, name
/// of the pipeline, settings, name of the record.
pub(crate) fn plan(records: &[Record], options: &Options) -> anyhow::Result<Vec<Run>> {
    let programs = digest_of_programs().context("cannot read the programs")?;
    let settings = combinations(&options.sweeps);
    // Other pipelines may be laid over it.
    let default = fs::read(options.project.join("pipelines/default.toml")).unwrap_or_default();
    let mut runs = Vec::new();
    for typed in options.pipelines() {
        let pipeline = Pipeline::resolve(typed, &options.project);
        let content = fs::read(&pipeline.file).map_err(|error| {
            Usage::new(format!("{}: {error}", pipeline.file.display()))
                .hint(format!("the pipelines are the files below {}", options.project.join("pipelines").display()))
        })?;
        for settings in &settings {
            let (typed_settings, flags) = (settings.join("\n"), options.flags() + &options.report_flags(""));
            let setup = setup(&[&content, &default, typed_settings.as_bytes(), flags.as_bytes(), programs.as_bytes()]);
            let variant = [vec![pipeline.name.clone()], settings.clone()].concat().join(",");
            runs.extend(records.iter().map(|record| Run {
                record: record.clone(),
                pipeline: typed.clone(),
                pipeline_name: pipeline.name.clone(),
                settings: settings.clone(),
                folder: format!("runs/{}/{}", record.name, folder_name(&variant, &pipeline.name)),
                key: record.digests.as_ref().map(|digests| key(digests, setup)),
            }));
        }
    }
    runs.sort_by_cached_key(|run| {
        (run.record_digest().to_owned(), run.pipeline_name.clone(), run.settings(), run.record.identity.clone())
    });
    let mut folders: Vec<&str> = runs.iter().map(|run| run.folder.as_str()).collect();
    folders.sort_unstable();
    if let Some(pair) = folders.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Usage::new(format!("two runs would share the folder {}", pair[0]))
            .hint("name each pipeline and each value once")
            .into());
    }
    Ok(runs)
}

/// Digest of all that a run depends on.
fn key(digests: &Digests, setup: [u8; 32]) -> String {
    blake3::hash(&[*digests.input.as_bytes(), setup].concat()).to_hex().to_string()
}

/// Digest of what all records have in common.
fn setup(parts: &[&[u8]]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    *hasher.finalize().as_bytes()
}

/// A pipeline may lie in a folder; values must not make more of them.
fn folder_name(variant: &str, pipeline: &str) -> String {
    let settings = variant.strip_prefix(pipeline).unwrap_or_default();
    format!("{pipeline}{}", settings.replace('/', "-"))
}

/// The path of a run in the folder of a fleet.
pub(crate) fn path_in(fleet: &Path, run: &Run) -> PathBuf {
    fleet.join(&run.folder)
}
