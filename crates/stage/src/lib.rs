//! The shell that every stage binary shares.
//!
//! A stage implements [`Stage`]: how its options become settings, how its inputs are loaded, what it computes. The rest
//! happens here, once: the command line and the pipeline file, freshness, provenance, atomic output, notes, summaries,
//! progress, errors with cause and hint, exit codes.

mod args;
mod chain_total;
mod error;
mod inputs;
mod masses_table;
mod nearest;
mod output;
mod pipeline;
mod progress;
mod run;
mod say;
mod stages;
mod stated;
mod tool;

pub use args::Common;
pub use chain_total::{TOTAL_MASS_TOLERANCE, total_mass_remark};
pub use error::{ExitStatus, RefuseExt, Refused, Usage};
pub use inputs::{Inputs, Loaded, MissingTopic, load_artifacts};
pub use masses_table::{InSi, LawOfTable, MassOfTable, NumberReaders, read_masses};
pub use nearest::nearest;
pub use output::Output;
pub use pipeline::{check_pipeline, unknown_name};
pub use progress::{Progress, Watched, be_quiet};
pub use run::{Outcome, Stage, main};
pub use say::say;
pub use stages::{STAGES, stage_order, writer_of};
pub use stated::{check_keys, check_name, table_at, typed};
pub use tool::tool_main;

pub use crumple_artifact::{Artifact, InputDigest, Record, Wave, records};
