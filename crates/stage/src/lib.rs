//! The shell that every stage binary shares.
//!
//! A stage implements [`Stage`]: how its options become settings, how its inputs are loaded, what it computes. The rest
//! happens here, once: the command line and the pipeline file, freshness, provenance, atomic output, notes, summaries,
//! progress, errors with cause and hint, exit codes.

mod artifacts;
mod chain_table;
mod command_line;
mod error;
mod names;
mod process;
mod terminal;

pub use artifacts::inputs::{Inputs, Loaded, load_artifacts};
pub use artifacts::output::Output;
pub use artifacts::overwriting::refuse_to_overwrite;
pub use artifacts::run_folder::artifacts_of_a_run;
pub use artifacts::several_tests::{Tests, load_tests};
pub use chain_table::total_mass_remark;
pub use chain_table::typed;
pub use chain_table::{MassOfTable, NumberOfTable, TakenNumbers, read_chain};
pub use command_line::left_out::LeftOut;
pub use command_line::memory_limit::{keep_budget, memory_limit_flag};
pub use command_line::pipeline::pipeline_table;
pub use command_line::pipeline_file::Pipeline;
pub use error::{ExitStatus, MissingTopic, RefuseExt, Refused, Usage, unknown_name};
pub use names::nearest;
pub use names::told_apart;
pub use names::{ChainStage, chain};
pub use process::tool_main;
pub use process::{Outcome, Stage, main};
pub use terminal::{Progress, be_quiet};
pub use terminal::{columns, labelled, labelled_and_cut, wrapped};
pub use terminal::{printable, say, to_stdout};

pub use crumple_artifact::{Artifact, InputDigest, Record, Wave, records};
