//! The stages of a run.

use crumple_stage::{ChainStage, Pipeline, chain};

use crate::command::options::Options;
use crate::command::program::Program;

/// Stands for the record and the flags after it among the inputs of a stage.
pub(crate) const RECORD: &str = "RECORD";
/// The stage from which on a run is made again.
const FIRST_AGAIN: &str = "predict";

/// One stage of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stage {
    /// Its name in the chain.
    pub(crate) name: &'static str,
    /// Its program.
    pub(crate) program: Program,
    /// Names in the run folder, or [`RECORD`].
    pub(crate) inputs: Vec<&'static str>,
    /// Names in the run folder; the program is told the first.
    pub(crate) outputs: Vec<&'static str>,
}

impl Stage {
    /// Its output.
    pub(crate) fn output(&self) -> &'static str {
        self.outputs.first().copied().unwrap_or_default()
    }

    /// Whether it writes an artifact, not a report.
    pub(crate) fn writes_an_artifact(&self) -> bool {
        self.output().ends_with(".mcap")
    }
}

/// The lines of the chain from the first stage of the run on.
pub(crate) fn chain_of(options: &Options) -> impl Iterator<Item = ChainStage> {
    let again = options.again.is_some();
    chain().skip_while(move |stage| again && stage.name != FIRST_AGAIN)
}

/// The stages of the run, without what the others would have written among their inputs; and the outputs of the others.
/// Errors: a program that does not exist, or would only print.
pub(crate) fn stages_of(options: &Options, pipeline: &Pipeline) -> anyhow::Result<(Vec<Stage>, Vec<&'static str>)> {
    let again = options.again.is_some();
    let in_use = |stage: &ChainStage| again || !stage.is_optional || pipeline.table(stage.name).is_some();
    let (used, others): (Vec<ChainStage>, Vec<ChainStage>) = chain_of(options).partition(in_use);
    let left_out: Vec<&str> = others.into_iter().flat_map(|stage| stage.outputs).collect();
    let with_program = |stage: ChainStage| -> anyhow::Result<Stage> {
        let program = Program::of_stage(stage.name, &options.flags)?;
        let mut inputs: Vec<&str> = stage.inputs.into_iter().filter(|input| !left_out.contains(input)).collect();
        if again && stage.name == FIRST_AGAIN {
            inputs.push(RECORD);
        }
        Ok(Stage { name: stage.name, program, inputs, outputs: stage.outputs })
    };
    let mut stages = used.into_iter().map(with_program).collect::<anyhow::Result<Vec<Stage>>>()?;
    if let Some(last) = stages.last_mut() {
        last.program.flags.extend_from_slice(&options.flags_of_last);
    }
    Ok((stages, left_out))
}

/// Names of what is made from the output of a stage, directly or not, in the order in which it is to be removed: the
/// report first, which says the most, then the artifacts from the last one on.
pub(crate) fn dependents(stages: &[Stage], number: usize) -> impl Iterator<Item = &'static str> {
    stages.iter().skip(number + 1).rev().flat_map(|later| later.outputs.iter().copied())
}
