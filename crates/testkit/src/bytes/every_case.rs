//! The list of all cases: records by pipelines, every method and solver, every stage's flags, every file format there
//! is.

use std::path::Path;

use super::case::{Case, Step};
use super::method_flags::{
    CHAINS, IDENTIFY, IDENTIFY_PROCESS, SOLVE, SOLVE_IDENTIFIED, SOLVE_SENSORS, SOLVER_VARIANTS, SOLVERS,
};
use super::stage_flags::{DIFF, FILTER, INGEST, INTEGRATE, INTEGRATE_OCCUPANTS, PREDICT, PROGRAMS, SIMULATE};

/// Cases that may run at the same time, and those that need their results.
pub type Phases = Vec<Vec<Case>>;

/// Runs that the cases of single stages read.
const DOUBLE: &str = "run/double/default";
const NOISY: &str = "run/noisy/default";
const SENSORS: &str = "run/two-sensors/two-sensors";
const OCCUPANTS: &str = "run/occupants/default";

/// All cases over these records (name and path) and pipeline files, and over these files of the reference material.
/// Paths are relative to the folder of the cases.
pub fn phases(records: &[(String, String)], pipelines: &[String], files: &[String]) -> Phases {
    let mut first = Vec::new();
    for (record, path) in records {
        for pipeline in pipelines {
            let name = pipeline.trim_start_matches("pipelines/").trim_end_matches(".toml");
            first.push(Case::run(format!("run/{record}/{name}"), path, pipeline));
        }
    }
    let flags = "--sample-time=0.01s --allow-missing";
    let process = Case::on("ingest", "process", &["records/process.csv".to_owned()], flags);
    first.push(process);
    first.extend(files.iter().flat_map(|file| reading(file)));
    first.extend(PROGRAMS.iter().map(|program| Case::printing(program, "help", "--help")));
    vec![first, of_stages(), of_models()]
}

/// A file as ingest lists it and as it reads it, whatever it is.
fn reading(file: &str) -> [Case; 2] {
    let name = file.trim_start_matches("reference/");
    let folder = format!("ingest/file/{name}");
    let step = |arguments: &[&str]| Step {
        program: "ingest",
        arguments: arguments.iter().map(|argument| (*argument).to_owned()).collect(),
    };
    let output = format!("{folder}/out.mcap");
    [
        Case { name: folder.clone(), steps: vec![step(&[file, "-o", &output, "--allow-missing"])] },
        Case { name: format!("{folder}.list"), steps: vec![step(&["--list", file])] },
    ]
}

/// Every stage with its flags.
fn of_stages() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |program, of: &str, flags: &[(&str, &str)]| {
        cases.extend(flags.iter().map(|(name, flags)| Case::stage(program, name, of, flags)));
    };
    add("filter", OCCUPANTS, FILTER);
    add("integrate", DOUBLE, INTEGRATE);
    add("identify", DOUBLE, IDENTIFY);
    add("parameter-solve", DOUBLE, SOLVE);
    add("simulate", DOUBLE, SIMULATE);
    add("predict", DOUBLE, PREDICT);
    let named = |kind: &str, name: &str| format!("{kind}-{name}");
    for (name, flags) in INGEST {
        cases.push(Case::on("ingest", name, &["records/double.csv".to_owned()], flags));
    }
    for (name, flags) in INTEGRATE_OCCUPANTS {
        cases.push(Case::stage("integrate", &named("occupants", name), OCCUPANTS, flags));
    }
    for (name, flags) in IDENTIFY_PROCESS {
        cases.push(Case::on("identify", name, &["ingest/process/out.mcap".to_owned()], flags));
    }
    for (model, methods) in SOLVERS {
        for (variant, flags) in SOLVER_VARIANTS {
            let flags = format!("--models={model} --method={methods} {flags}");
            cases.push(Case::stage("parameter-solve", &named(model, variant), NOISY, &flags));
        }
    }
    for (name, flags) in SOLVE_SENSORS {
        cases.push(Case::stage("parameter-solve", &named("sensors", name), SENSORS, flags));
    }
    for (name, stage, _) in CHAINS {
        let flags = format!("--pipeline {}", chain_path(name));
        cases.push(Case::stage(stage, &named("chain", name), DOUBLE, &flags));
    }
    for (name, flags) in DIFF {
        cases.push(Case::printing("diff", name, &format!("{DOUBLE} {NOISY} {flags}")));
    }
    for (name, stage) in [("candidates", "5-parameter-solve"), ("models", "4-identify"), ("filtered", "2-filter")] {
        cases.push(Case::printing("artifact", &named("show", name), &format!("show {DOUBLE}/{stage}.mcap")));
        cases.push(Case::printing("artifact", &named("check", name), &format!("check {DOUBLE}/{stage}.mcap")));
        let unpacked = format!("unpack {DOUBLE}/{stage}.mcap artifact/unpack-{name}/files");
        cases.push(Case::printing("artifact", &named("unpack", name), &unpacked));
    }
    cases
}

/// Where the pipeline file of a chain is written.
pub fn chain_path(name: &str) -> String {
    format!("chains/{name}.toml")
}

/// The pipeline files of chains: path and content.
pub fn chain_files() -> impl Iterator<Item = (String, &'static str)> {
    CHAINS.iter().map(|(name, _, content)| (chain_path(name), *content))
}

/// Parameters from the models that other cases identified.
fn of_models() -> Vec<Case> {
    let solve = |(name, model, flags): &(&str, &str, &str)| {
        let inputs = [
            format!("{DOUBLE}/2-filter.mcap"),
            format!("{DOUBLE}/3-integrate.mcap"),
            Path::new(model).join("out.mcap").to_string_lossy().into_owned(),
        ];
        let flags = format!("--models=double-spring-mass-damper,maxwell {flags}");
        Case::on("parameter-solve", &format!("identified-{name}"), &inputs, &flags)
    };
    SOLVE_IDENTIFIED.iter().map(solve).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_cases_share_a_folder_and_what_a_case_reads_is_made_before() {
        let records =
            ["double", "noisy", "two-sensors", "occupants"].map(|n| (n.to_owned(), format!("records/{n}.csv")));
        let pipelines = ["default", "two-sensors", "papers/era"].map(|name| format!("pipelines/{name}.toml"));
        let mut made: BTreeSet<String> = BTreeSet::new();
        for phase in phases(&records, &pipelines, &["reference/a b.csv".to_owned()]) {
            for case in &phase {
                for argument in case.steps.iter().flat_map(|step| &step.arguments) {
                    let kind = argument.split('/').next().unwrap_or_default();
                    let of_a_case = argument.contains('/') && (kind == "run" || PROGRAMS.contains(&kind));
                    let is_there =
                        argument.starts_with(&case.name) || made.iter().any(|name| argument.starts_with(name));
                    assert!(!of_a_case || is_there, "{}: {argument}", case.name);
                }
            }
            for case in phase {
                assert!(made.insert(case.name.clone()), "{}", case.name);
            }
        }
        for name in &made {
            assert!(!made.contains(Path::new(name).parent().map_or("", |parent| parent.to_str().unwrap_or_default())));
        }
    }
}
