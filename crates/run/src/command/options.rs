//! The command line of `crumple-run`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_stage::Usage;

use crate::command::pipeline::Pipeline;
use crate::command::words::{Words, request_for_information};

/// Runs the stages of a pipeline on a record, one after another, into one run folder.
///
/// The recipe `run` of the justfile calls it. Which stage reads and writes what stands in `pipelines/chain`; each is
/// started as `COMMAND INPUT... --pipeline FILE -o OUTPUT`, its inputs and outputs in the run folder. CRUMPLE_FILTER in
/// the environment is the command of the stage filter where it is not the program of the project, and so on.
/// A stage whose result is up to date leaves it alone; all that was made from an old result is removed before a new one
/// appears.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-run",
    version,
    after_help = "One run at a time works in a folder; a second one waits and says for which.\n\
                  Exit codes: 0 done, 1 a stage failed unforeseen, 2 usage, 3 record refused, 4 no acceptable result \
                  (the report shows the diagnosis)."
)]
pub struct Options {
    /// Folder with `pipelines/` and `runs/`.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub(crate) project: PathBuf,

    /// Pipeline: a file below `pipelines/` without its ending, or the path of a file elsewhere.
    #[arg(long, value_name = "NAME|FILE", default_value = "default", allow_hyphen_values = true)]
    pub(crate) pipeline: String,

    /// Run folder [default: runs/NAME-OF-RECORD/NAME-OF-PIPELINE in the project].
    #[arg(long, value_name = "FOLDER", allow_hyphen_values = true)]
    pub(crate) out: Option<OsString>,

    /// Predicts again in the folder of a run that was made; behind `--` stand flags of the stage predict.
    #[arg(long, value_name = "FOLDER", allow_hyphen_values = true, conflicts_with = "out")]
    pub(crate) again: Option<PathBuf>,

    /// Flags for every stage, as one would type them.
    #[arg(long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    pub(crate) flags: Words,

    /// Flags for the last stage alone.
    #[arg(long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    pub(crate) flags_of_last: Words,

    /// One option of a stage, over the pipeline: `filter.cfc=180`, `identify.methods=era,arx`. Several; it may stand
    /// behind the record too.
    #[arg(long, value_name = "STAGE.OPTION=VALUE", conflicts_with = "again")]
    pub(crate) set: Vec<String>,

    /// The record, and flags of the stage that reads it.
    #[arg(last = true, required_unless_present = "again", value_name = "RECORD")]
    pub(crate) record: Vec<OsString>,
}

impl Options {
    /// Takes the options set behind `--` from among the flags of the first stage.
    pub(crate) fn take_set(&mut self) -> Result<(), Usage> {
        if self.again.is_some() {
            return Ok(());
        }
        let mut words = std::mem::take(&mut self.record).into_iter();
        while let Some(word) = words.next() {
            match word.to_str().and_then(|text| text.strip_prefix("--set")) {
                Some("") => {
                    let typed = words.next().and_then(|word| word.into_string().ok());
                    self.set.push(typed.ok_or_else(|| Usage::new("--set needs STAGE.OPTION=VALUE behind it"))?);
                }
                Some(typed) if typed.starts_with('=') => self.set.push(typed[1..].to_owned()),
                _ => self.record.push(word),
            }
        }
        Ok(())
    }

    /// Whether a flag for every stage keeps it quiet.
    pub(crate) fn is_quiet(&self) -> bool {
        self.flags.iter().any(|word| matches!(word.as_str(), "-q" | "--quiet"))
    }

    /// The run folder: what `--out` says, else one below `runs/` by the names of record and pipeline.
    pub(crate) fn folder(&self, pipeline: &Pipeline) -> anyhow::Result<PathBuf> {
        let out = self.out.as_deref().filter(|out| !out.is_empty()).map(Path::new);
        if let Some(out) = out {
            // Stages must not take it for a flag.
            let looks_like_a_flag = out.as_os_str().as_encoded_bytes().starts_with(b"-");
            return Ok(if looks_like_a_flag { Path::new(".").join(out) } else { out.to_owned() });
        }
        let stem = self.record.first().and_then(|record| Path::new(record).file_stem());
        let stem =
            stem.context(Usage::new("the record has no file name").hint("say where to: just out=DIR run RECORD"))?;
        Ok(self.project.join("runs").join(stem).join(&pipeline.name))
    }

    /// The flags of the first stage: all that stands behind the record.
    pub(crate) fn flags_of_the_first(&self) -> &[OsString] {
        if self.again.is_some() { &self.record } else { self.record.get(1..).unwrap_or_default() }
    }

    /// Whether they ask what the first stage prints about itself or the record.
    pub(crate) fn asks_for_information(&self) -> bool {
        request_for_information(self.flags_of_the_first().iter().map(|flag| flag.to_string_lossy())).is_some()
    }
}
