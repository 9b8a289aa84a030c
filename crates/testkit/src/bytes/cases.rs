//! What is compared byte by byte: committed and made records, every pipeline.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use crumple_stage::{ChainStage, chain};

use crate::bytes::flags::{
    CHAINS, DIFF, FILTER, IDENTIFY, IDENTIFY_PROCESS, INGEST, INTEGRATE, INTEGRATE_OCCUPANTS, PREDICT, PROGRAMS,
    SIMULATE, SOLVE, SOLVE_IDENTIFIED, SOLVE_SENSORS, SOLVER_VARIANTS, SOLVERS,
};
use crate::random::uniform;

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
fn chain_path(name: &str) -> String {
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

const DT_S: f64 = 1e-4;
const BEFORE: usize = 500;
const AFTER: usize = 2001;

/// Writes all of them below `folder`.
pub fn write_records(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("two-sensors.csv"), two_sensors()?)?;
    fs::write(folder.join("two-sensors.csv.toml"), "channel = \"accel\"\n")?;
    fs::write(folder.join("process.csv"), process())?;
    occupants(&folder.join("occupants"))
}

fn number(text: &mut String, value: f64) {
    let _infallible = write!(text, ",{value:.9}");
}

/// Compartment and engine (channel 95) of a double model.
fn two_sensors() -> io::Result<String> {
    let model = Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
        m1_kg: 375.0,
        m2_kg: 1125.0,
        k1_n_per_m: 900_000.0,
        k2_n_per_m: 1_000_000.0,
        c1_n_s_per_m: 6_000.0,
        c2_n_s_per_m: 9_000.0,
    });
    let response = model.respond(50.0 / 3.6, DT_S, AFTER).map_err(io::Error::other)?;
    let mut csv =
        "# title: two sensors\n# mass: 1500 kg\n# impact speed: 50 km/h\ntime (s),accel (g),95 (g)\n".to_owned();
    for k in 0..BEFORE + AFTER {
        let _infallible = write!(csv, "{:.4}", (k as f64 - BEFORE as f64) * DT_S);
        for motion in [response.compartment(), &response.motions[0]] {
            let a = k.checked_sub(BEFORE).map_or(0.0, |k| motion.acceleration_m_per_s2[k] / G);
            number(&mut csv, a + 0.05 * uniform(k as u64));
        }
        csv.push('\n');
    }
    Ok(csv)
}

/// `y` answers to `p` and `q` by a pair of poles, `z` to both of them a step later.
fn process() -> String {
    let mut csv = "p,q,y,z\n".to_owned();
    let (mut y1, mut y2, mut before) = (0.3, -0.1, (0.0, 0.0));
    for k in 0..400_u64 {
        let y = 1.5 * y1 - 0.7 * y2 + 0.5 * before.0 - 0.2 * before.1;
        let z = 0.4 * y1 + 0.3 * before.1 + 0.05 * uniform(3 * k);
        before = (5.0 * uniform(3 * k + 1), 6.0 * uniform(3 * k + 2));
        let _infallible = writeln!(csv, "{:.9},{:.9},{:.9},{z:.9}", before.0, before.1, y + 0.02 * uniform(7 * k));
        (y2, y1) = (y1, y);
    }
    csv
}

/// An ISO-MME test: structure, engine, two occupants, cells of the barrier, yaw rate.
fn occupants(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder.join("Channel"))?;
    let test = "Data format edition number  :1.6\r\nTitle                       :occupants\r\nMass test object \
        1          :1500 kg\r\n\
                Velocity test object 1      :14 m/s\r\n";
    fs::write(folder.join("T1.mme"), test)?;
    let force = -1500.0 * G / 4.0;
    let channels = [
        ("10SECMLERE00ACXP", "g", 1.0),
        ("10SECMRIRE00ACXP", "g", 0.98),
        ("10SILBLERE00ACXP", "g", 1.02),
        ("10ENGN000000ACXP", "g", 1.6),
        ("10VEHCCG0000ACXP", "g", 1.0),
        ("10VEHCCG0000ACYP", "g", 0.2),
        ("10VEHCCG0000AVZP", "deg/s", 3.0),
        ("11HEAD0000H3ACXA", "g", 1.4),
        ("11HEAD0000H3ACYA", "g", 0.3),
        ("11HEAD0000H3ACZA", "g", 0.7),
        ("11CHST0000H3ACXC", "g", 1.2),
        ("13HEAD0000H3ACXA", "g", 1.1),
        ("B0LOMA010100FOXP", "N", force),
        ("B0LOMA010200FOXP", "N", force),
        ("B0LOMA020100FOXP", "N", force),
        ("B0LOMA020200FOXP", "N", force),
    ];
    for (place, (code, unit, factor)) in channels.iter().enumerate() {
        let mut text = format!(
            "Test object number          :1\r\nChannel code                :{code}\r\nUnit                        \
             :{unit}\r\n\
             Reference channel           :implicit\r\nSampling interval           :0.0001\r\n\
             Time of first sample        :-0.05\r\nNumber of samples           :2501\r\n"
        );
        for k in 0..2501 {
            let t = (k as f64 - BEFORE as f64) * DT_S;
            let pulse = if (0.0..0.1).contains(&t) { -25.0 * (PI * t / 0.1).sin() } else { 0.0 };
            let noise = 0.1 * uniform((place * 10_007 + k) as u64);
            let _infallible = write!(text, "{:.6}\r\n", factor * (pulse + noise));
        }
        fs::write(folder.join(format!("Channel/T1.{:03}", place + 1)), text)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

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
