//! One case: command lines that follow each other, in a folder of their own.

use crumple_stage::{ChainStage, chain};

/// One process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// The program without `crumple-`.
    pub program: &'static str,
    /// Its arguments; paths are relative to the folder of all cases.
    pub arguments: Vec<String>,
}

/// Command lines whose outputs are digested; what they write goes into the folder of the case's name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Case {
    /// Path of the folder, e.g. `run/double/default`.
    pub name: String,
    /// The processes, one after the other, whatever their exit codes.
    pub steps: Vec<Step>,
}

fn words(text: &str) -> impl Iterator<Item = String> + '_ {
    text.split_whitespace().map(str::to_owned)
}

impl Case {
    /// The whole pipeline on a record.
    pub fn run(name: String, record: &str, pipeline: &str) -> Self {
        let path = |input: &str| if input == "RECORD" { record.to_owned() } else { format!("{name}/{input}") };
        let step = |stage: ChainStage| {
            let inputs = stage.inputs.iter().map(|input| path(input));
            let output = format!("-o {name}/{} --pipeline {pipeline}", stage.outputs[0]);
            Step { program: stage.name, arguments: inputs.chain(words(&output)).collect() }
        };
        let steps = chain().map(step).collect();
        Self { name, steps }
    }

    /// One stage with flags, on artifacts of another case.
    pub fn stage(program: &'static str, name: &str, of: &str, flags: &str) -> Self {
        let inputs = chain().find(|stage| stage.name == program).map_or_else(Vec::new, |stage| stage.inputs);
        let inputs: Vec<String> = inputs.iter().map(|input| format!("{of}/{input}")).collect();
        Self::on(program, name, &inputs, flags)
    }

    /// One program with flags on these inputs; its artifact is `out.mcap`.
    pub fn on(program: &'static str, name: &str, inputs: &[String], flags: &str) -> Self {
        let name = format!("{program}/{name}");
        let mut arguments = inputs.to_vec();
        arguments.extend(words(&format!("-o {name}/out.mcap {flags}")));
        Self { name, steps: vec![Step { program, arguments }] }
    }

    /// One program that prints.
    pub fn printing(program: &'static str, name: &str, arguments: &str) -> Self {
        Self { name: format!("{program}/{name}"), steps: vec![Step { program, arguments: words(arguments).collect() }] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_hands_every_stage_the_artifacts_it_reads() {
        let run = Case::run("run/a/default".to_owned(), "records/a.csv", "pipelines/default.toml");
        assert_eq!(run.steps.len(), 8);
        assert_eq!(
            run.steps[4].arguments.join(" "),
            "run/a/default/2-filter.mcap run/a/default/3-integrate.mcap run/a/default/4-identify.mcap \
             -o run/a/default/5-parameter-solve.mcap --pipeline pipelines/default.toml"
        );
        let stage = Case::stage("filter", "wide", "run/a/default", "--cfc 180");
        assert_eq!(stage.steps[0].arguments.join(" "), "run/a/default/1-ingest.mcap -o filter/wide/out.mcap --cfc 180");
    }
}
