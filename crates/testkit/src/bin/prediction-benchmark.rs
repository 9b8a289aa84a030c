//! `prediction-benchmark [--bin BIN] [--cars N] [--first K] [--tests 56,40] [--candidates] [--keep FOLDER] [KIND ...]`:
//! how far predictions of other tests are off, for N made cars a kind from number K on, by the programs in the folder
//! BIN, as Markdown. A kind is named by a part of its name. `--tests`: speeds in km/h at which each car is tested;
//! several are joined to one model. `--candidates`: what every candidate predicts too. `--keep` leaves the records and
//! artifacts of every car in FOLDER.

use std::path::PathBuf;
use std::process::ExitCode;

use crumple_testkit::prediction_error::{KINDS, outcomes, tables};
use crumple_testkit::workspace;

type Failure = Box<dyn std::error::Error>;

const USAGE: &str = "usage: prediction-benchmark [--bin BIN] [--cars N] [--first K] [--tests 56,40] [--candidates] \
                     [--keep FOLDER] [KIND ...]";

fn main() -> ExitCode {
    match benchmark() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn benchmark() -> Result<(), Failure> {
    let mut bin = workspace().join("target/release");
    let (mut cars, mut first, mut tests, mut candidates) = (50, 0, vec![56.0], false);
    let mut keep: Option<PathBuf> = None;
    let mut wanted: Vec<String> = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--bin" => bin = std::path::absolute(arguments.next().ok_or(USAGE)?)?,
            "--cars" => cars = arguments.next().ok_or(USAGE)?.parse()?,
            "--first" => first = arguments.next().ok_or(USAGE)?.parse()?,
            "--tests" => {
                let speeds = arguments.next().ok_or(USAGE)?;
                tests = speeds.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            }
            "--candidates" => candidates = true,
            "--keep" => keep = Some(PathBuf::from(arguments.next().ok_or(USAGE)?)),
            flag if flag.starts_with('-') => return Err(USAGE.into()),
            kind => wanted.push(kind.to_owned()),
        }
    }
    let made_here = std::env::temp_dir().join(format!("prediction-benchmark-{}", std::process::id()));
    let folder = keep.clone().unwrap_or_else(|| made_here.clone());
    let pipeline = workspace().join("pipelines/default.toml");
    let asked = |name: &str| wanted.is_empty() || wanted.iter().any(|part| name.contains(part.as_str()));
    let kinds: Vec<_> = KINDS.iter().filter(|kind| asked(kind.name)).collect();
    if kinds.is_empty() {
        return Err(format!("no kind has one of these in its name: {}", wanted.join(", ")).into());
    }
    let all = outcomes(&kinds, &(first..first + cars), (&tests, candidates), (&bin, &pipeline), &folder)?;
    print!("{}", tables(&all));
    if keep.is_none() {
        std::fs::remove_dir_all(&made_here)?;
    }
    Ok(())
}
