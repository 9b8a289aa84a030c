//! `truth [--bin BIN] [--cars N] [--short] [NAME ...]`: every sentence of runs of known truth, read back
//! and compared with it, by the programs in the folder BIN: a table of templates, then what contradicts the truth and
//! what no rule reads. N made cars a family and kind. NAME: parts of names of runs. Exit code 1: something does.

use std::path::PathBuf;
use std::process::ExitCode;

use crumple_testkit::truth::{Extent, Failure, Made, Net, Registry, RunCase, cases, run};
use crumple_testkit::workspace;
use rayon::prelude::*;

const USAGE: &str = "usage: truth [--bin BIN] [--cars N] [--short] [NAME ...]";

fn main() -> ExitCode {
    match truth() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn truth() -> Result<bool, Failure> {
    let mut bin = workspace().join("target/release");
    let mut extent = Extent::Long(4);
    let mut wanted: Vec<String> = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--bin" => bin = PathBuf::from(arguments.next().ok_or(USAGE)?),
            "--cars" => extent = Extent::Long(arguments.next().ok_or(USAGE)?.parse()?),
            "--short" => extent = Extent::Short,
            flag if flag.starts_with('-') => return Err(USAGE.into()),
            name => wanted.push(name.to_owned()),
        }
    }
    let folder = std::env::temp_dir().join(format!("truth-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let all = cases(extent, &folder)?;
    let asked = |case: &&RunCase| wanted.is_empty() || wanted.iter().any(|part| case.name.contains(part.as_str()));
    let asked: Vec<&RunCase> = all.iter().filter(asked).collect();
    let runs: Vec<Result<Made, Failure>> = asked.par_iter().map(|case| run(case, &bin, &folder)).collect();
    std::fs::remove_dir_all(&folder)?;
    let failed = runs.iter().filter_map(|run| run.as_ref().err()).inspect(|error| eprintln!("error: {error}")).count();
    let registry = Registry::new();
    let mut net = Net::default();
    runs.iter().flatten().for_each(|made| net.read(&registry, made));
    print!("{}", net.table(&registry));
    let without = registry.without_rule();
    if !without.is_empty() {
        println!("\n{} texts without a rule: {}", without.len(), without.join(", "));
    }
    let too_low = net.counts.too_low();
    too_low.iter().for_each(|line| println!("too low: {line}"));
    Ok(failed == 0
        && net.contradictions.is_empty()
        && net.unread.is_empty()
        && without.is_empty()
        && too_low.is_empty())
}
