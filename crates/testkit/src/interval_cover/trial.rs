//! One car, its record, and what the programs say of its parameters.

use std::ops::Range;
use std::path::Path;

use crumple_artifact::records::{CandidateV1, Certainty};
use crumple_lumped::{LumpedError, Model};
use crumple_numerics::estimation::random::RandomNumbers;
use rayon::prelude::*;
use serde_json::Value;

use super::car::{Car, Draw};
use super::cover::Cover;
use super::family::Family;
use super::record::record;
use crate::programs::steps::{StepError, Steps, records};

/// Interval, s, and number of the instants at which motions are compared: up to 100 ms.
const INTERVAL_S: f64 = 1e-3;
const INSTANTS: usize = 101;

/// Why a trial could not be made.
#[derive(Debug)]
pub enum CoverError {
    /// A program or a file.
    Step(StepError),
    /// The car has no motion.
    Model(LumpedError),
    /// A candidate that is none.
    Record(serde_json::Error),
}

impl std::fmt::Display for CoverError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Step(error) => error.fmt(f),
            Self::Model(error) => error.fmt(f),
            Self::Record(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for CoverError {}

impl From<StepError> for CoverError {
    fn from(error: StepError) -> Self {
        Self::Step(error)
    }
}

impl From<serde_json::Error> for CoverError {
    fn from(error: serde_json::Error) -> Self {
        Self::Record(error)
    }
}

impl From<LumpedError> for CoverError {
    fn from(error: LumpedError) -> Self {
        Self::Model(error)
    }
}

/// The cover of a family's intervals over the cars of these numbers.
///
/// Cars run beside each other; a car and its noise follow from its number and the family alone, so the counts are the
/// same for any number of threads. `clean`: trigger and stated speed without error, a filter without phase. Errors: a
/// program that is missing or fails.
pub fn cover_of(
    family: &Family,
    records: Range<usize>,
    clean: bool,
    (bin, folder): (&Path, &Path),
) -> Result<Cover, CoverError> {
    let trials = records.into_par_iter().map(|number| {
        let folder = folder.join(number.to_string());
        trial(family, number, clean, &Steps { bin, folder: &folder, pipeline: None })
    });
    let covers: Vec<Cover> = trials.collect::<Result<_, _>>()?;
    Ok(covers.iter().fold(Cover::default(), |mut total, one| {
        total.add(one);
        total
    }))
}

/// Draws a car, records its test, solves for its parameters and counts their intervals.
fn trial(family: &Family, number: usize, clean: bool, programs: &Steps<'_>) -> Result<Cover, CoverError> {
    let car = measured((family.name, family.draw, number), clean, programs)?;
    let mut arguments = vec!["2.mcap", "3.mcap", "--json", "-o", "5.mcap"];
    arguments.extend(family.flags);
    let printed = programs.run("parameter-solve", &arguments)?;
    programs.remove_folder()?;
    count(family.id, number, &car, &printed)
}

/// Draws a car and measures its test: `2.mcap` and `3.mcap` in the folder of the programs. Without a pipeline no
/// input's uncertainty is propagated, so that the intervals are those of the fits.
pub(super) fn measured(
    (name, draw, number): (&str, Draw, usize),
    clean: bool,
    programs: &Steps<'_>,
) -> Result<Car, CoverError> {
    let mut random = RandomNumbers::seeded(blend(name, number));
    let car = draw.car(&mut random)?;
    programs.write("crash.csv", &record(&car, clean, &mut random)?)?;
    programs.run("ingest", &["crash.csv", "--time-zero", "0s", "--channel", "accel", "-o", "1.mcap"])?;
    programs.run("filter", &["1.mcap", "-o", "2.mcap"])?;
    let channels = if car.engine { "all,engine" } else { "all" };
    programs.run("integrate", &["2.mcap", "--uncertainty-replicates", "0", "--channels", channels, "-o", "3.mcap"])?;
    Ok(car)
}

/// A seed that depends on the family and the number.
fn blend(name: &str, number: usize) -> u64 {
    name.bytes().fold(number as u64, |seed, byte| seed.wrapping_mul(1_099_511_628_211) ^ u64::from(byte))
}

/// Counts the intervals of the candidate of a model and method whose masses move most like those of the car: a record
/// cannot tell duals apart, and both are given; their springs and dampers may be near each other, the motion of the
/// front is not.
pub(super) fn count(id: &str, number: usize, car: &Car, printed: &str) -> Result<Cover, CoverError> {
    let truth = car.model.parameters();
    let below = format!("/parameters/{id}/");
    let candidates = records(printed, &below).map(|(_, candidate)| candidate);
    let displacements = |model: &Model| {
        let response = model.respond(car.impact_speed_m_per_s, INTERVAL_S, INSTANTS).ok()?;
        Some(response.motions.into_iter().flat_map(|motion| motion.displacement_m).collect::<Vec<f64>>())
    };
    let true_motion = displacements(&car.model).unwrap_or_default();
    let distance = |candidate: &Value| -> f64 {
        let parameters = serde_json::from_value(candidate["parameters"].clone()).unwrap_or_default();
        let model = Model::from_parameters(car.model.kind(), &parameters).ok();
        let motion = model.and_then(|model| displacements(&model));
        motion.map_or(f64::INFINITY, |x| x.iter().zip(&true_motion).map(|(x, truth)| (x - truth).powi(2)).sum())
    };
    let mut cover = Cover::default();
    let Some(nearest) = candidates.min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
        cover.without = 1;
        return Ok(cover);
    };
    let nearest: CandidateV1 = serde_json::from_value(nearest.clone())?;
    let ends = nearest.uncertainty.iter().flat_map(|u| u.interval_low.iter().map(move |(name, low)| (u, name, *low)));
    for (known, name, low) in ends {
        if let Some(truth) = truth.get(name) {
            let is_determined = nearest.certainty(name) == Some(Certainty::Determined);
            let high = known.interval_high.get(name).copied().flatten();
            cover.count(number, (name, *truth, is_determined), (low, high));
        }
    }
    Ok(cover)
}
