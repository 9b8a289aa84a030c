//! The shell that every stage binary shares.
//!
//! A stage implements [`Stage`]: how its options become settings, how its inputs are loaded, what it computes. The rest
//! happens here, once: the command line and the pipeline file, freshness, provenance, atomic output, notes, summaries,
//! progress, errors with cause and hint, exit codes.

mod artifacts {
    //! What a stage reads and what it writes.
    pub mod described;
    pub mod inputs;
    pub mod output;
    pub mod remarks;
}
mod chain_table;
mod command_line {
    //! Flags that all stages have, and the table of a pipeline file under them.

    pub mod args;
    pub mod display_flag;
    pub mod left_out;
    pub mod of_runs;
    pub mod pipeline;
    pub mod pipeline_file;
}
mod environment;
mod error;
pub mod joints;
mod kinds;
mod names;
pub mod numbers;
mod process;
mod terminal;
mod typed;

pub use artifacts::inputs::{Inputs, Loaded, Tests, load_artifacts, load_tests, refuse_a_mixture};
pub use artifacts::output::{
    Output, SummaryLine, artifacts_of_a_run, hint_for_a_run, refuse_to_overwrite, results_of_an_earlier_run,
};
pub use artifacts::remarks::{is_no_result, remark_on_model, remarks_of, remarks_of_model};
pub use chain_table::{MassOfTable, NumberOfTable, TakenNumbers, read_chain, total_mass_remark, typed};
pub use command_line::args::{is_shared_flag, keep_budget, memory_limit_flag};
pub use command_line::display_flag::DisplayFlag;
pub use command_line::left_out::LeftOut;
pub use command_line::pipeline::pipeline_table;
pub use command_line::pipeline_file::Pipeline;
pub use crumple_artifact::{Artifact, InputDigest, Record, Wave, records};
pub use environment::{refuse_unknown_variables, variable_of, variables};
pub use error::{ExitStatus, MissingTopic, REASON_FILE, RefuseExt, Refused, Usage, unknown_name};
pub use kinds::{held, hold, kinds, refuse_not_to_be_allowed, refuse_unknown_code};
pub use names::{ChainStage, chain, errors_in_words, nearest, sidecar_of, told_apart};
pub use process::{Call, Outcome, Program, Stage, run_stage, run_tool};
pub use terminal::{
    Mark, Progress, be_quiet, columns, labelled, painted, printable, say, say_as_it_is, stderr_has_colours,
    stdout_has_colours, to_stdout, wrapped,
};
pub use typed::{IN_RUN, OF_ARTIFACT, Way, by_way, flag, option, program};
