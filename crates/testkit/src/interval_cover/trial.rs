//! One car, its record, and what the programs say of its parameters.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crumple_estimation::random::RandomNumbers;
use crumple_lumped::{LumpedError, Model};
use serde_json::Value;

use super::car::Car;
use super::cover::Cover;
use super::family::Family;
use super::record::record;

/// Interval, s, and number of the instants at which motions are compared: up to 100 ms.
const INTERVAL_S: f64 = 1e-3;
const INSTANTS: usize = 101;

/// Why a trial could not be made.
#[derive(Debug)]
pub enum CoverError {
    /// A program did not start, or a file could not be written.
    File(PathBuf, io::Error),
    /// A program ended badly on a good record.
    Program(String),
    /// The car has no motion.
    Model(LumpedError),
}

impl std::fmt::Display for CoverError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Program(said) => f.write_str(said),
            Self::Model(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for CoverError {}

/// The cover of a family's intervals over the cars of these numbers.
///
/// Cars run beside each other; a car and its noise follow from its number and the family alone, so the counts are the
/// same for any number of threads. Errors: a program that is missing or fails.
pub fn cover_of(family: &Family, records: Range<usize>, bin: &Path, folder: &Path) -> Result<Cover, CoverError> {
    let next = AtomicUsize::new(records.start);
    let total = Mutex::new(Ok(Cover::default()));
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= records.end {
                return;
            }
            let one = trial(family, number, bin, &folder.join(number.to_string()));
            let mut total = total.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            match (one, &mut *total) {
                (Ok(one), Ok(total)) => total.add(&one),
                (Err(error), Ok(_)) => *total = Err(error),
                (_, Err(_)) => return,
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    total.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Draws a car, records its test in `folder`, solves for its parameters and counts their intervals.
fn trial(family: &Family, number: usize, bin: &Path, folder: &Path) -> Result<Cover, CoverError> {
    let mut random = RandomNumbers::seeded(blend(family.name, number));
    let car = family.draw.car(&mut random).map_err(CoverError::Model)?;
    let csv = record(&car, &mut random).map_err(CoverError::Model)?;
    let at = |error| CoverError::File(folder.to_owned(), error);
    fs::create_dir_all(folder).map_err(at)?;
    fs::write(folder.join("crash.csv"), csv).map_err(at)?;
    let step = |program: &str, arguments: &[&str]| -> Result<String, CoverError> {
        let path = bin.join(format!("crumple-{program}"));
        let output = Command::new(&path)
            .args(arguments)
            .current_dir(folder)
            .env("RAYON_NUM_THREADS", "1")
            .output()
            .map_err(|error| CoverError::File(path, error))?;
        // 4: no acceptable result, which is an answer.
        match output.status.code() {
            Some(0 | 4) => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
            _ => Err(CoverError::Program(format!(
                "crumple-{program} {} in {}: {}",
                arguments.join(" "),
                folder.display(),
                String::from_utf8_lossy(&output.stderr)
            ))),
        }
    };
    step("ingest", &["crash.csv", "-q", "--time-zero", "0s", "--channel", "accel", "-o", "1.mcap"])?;
    let channels = if car.engine { "all,engine" } else { "all" };
    step("filter", &["1.mcap", "-q", "-o", "2.mcap"])?;
    step("integrate", &["2.mcap", "-q", "--uncertainty-replicates", "0", "--channels", channels, "-o", "3.mcap"])?;
    let mut arguments = vec!["2.mcap", "3.mcap", "-q", "--json", "-o", "5.mcap"];
    arguments.extend(family.flags);
    let printed = step("parameter-solve", &arguments)?;
    fs::remove_dir_all(folder).map_err(at)?;
    Ok(count(family, &car, &printed))
}

/// A seed that depends on the family and the number.
fn blend(name: &str, number: usize) -> u64 {
    name.bytes().fold(number as u64, |seed, byte| seed.wrapping_mul(1_099_511_628_211) ^ u64::from(byte))
}

/// Counts the intervals of the candidate whose masses move most like those of the car: a record cannot tell duals
/// apart, and both are given; their springs and dampers may be near each other, the motion of the front is not.
fn count(family: &Family, car: &Car, printed: &str) -> Cover {
    let truth = car.model.parameters();
    let prefix = format!("/parameters/{}/", family.id);
    let records = printed.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let candidates = records.filter(|record| record["topic"].as_str().is_some_and(|topic| topic.starts_with(&prefix)));
    let displacements = |model: &Model| {
        let response = model.respond(car.impact_speed_m_per_s, INTERVAL_S, INSTANTS).ok()?;
        Some(response.motions.into_iter().flat_map(|motion| motion.displacement_m).collect::<Vec<f64>>())
    };
    let true_motion = displacements(&car.model).unwrap_or_default();
    let distance = |candidate: &Value| -> f64 {
        let parameters = serde_json::from_value(candidate["data"]["parameters"].clone()).unwrap_or_default();
        let model = Model::from_parameters(car.model.kind(), &parameters).ok();
        let motion = model.and_then(|model| displacements(&model));
        motion.map_or(f64::INFINITY, |x| x.iter().zip(&true_motion).map(|(x, truth)| (x - truth).powi(2)).sum())
    };
    let mut cover = Cover::default();
    let Some(nearest) = candidates.min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
        cover.without = 1;
        return cover;
    };
    let uncertainty = &nearest["data"]["uncertainty"];
    let ends: BTreeMap<&String, &Value> = uncertainty["interval_low"].as_object().into_iter().flatten().collect();
    for (name, low) in ends {
        if let Some(truth) = truth.get(name) {
            cover.count(name, *truth, (low.as_f64(), uncertainty["interval_high"][name].as_f64()));
        }
    }
    cover
}
