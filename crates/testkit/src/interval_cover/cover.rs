//! Trials: how many intervals hold the truth, and what is recommended.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use crumple_artifact::records::{CandidateV1, Certainty};
use crumple_lumped::{LumpedError, Model};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_numerics::estimation::statistics::normal_distribution;
use rayon::prelude::*;
use serde_json::Value;

use crate::interval_cover::{Car, Draw, Family, record};
use crate::programs::{StepError, Steps, records};
use crate::records::Errors;

/// Interval, s, and number of the instants at which motions are compared: up to 100 ms.
const INTERVAL_S: f64 = 1e-3;
const INSTANTS: usize = 101;

/// Why a trial could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CoverError {
    /// A program or a file.
    #[error("{0}")]
    Step(#[from] StepError),
    /// The car has no motion.
    #[error("{0}")]
    Model(#[from] LumpedError),
    /// A candidate that is none.
    #[error("{0}")]
    Record(#[from] serde_json::Error),
}

/// The cover of a family's intervals over the cars of these numbers.
///
/// Cars run beside each other; a car and its noise follow from its number and the family alone, so the counts are the
/// same for any number of threads. Errors: a program that is missing or fails.
pub fn cover_of(
    family: &Family,
    records: Range<usize>,
    errors: Errors,
    (bin, folder): (&Path, &Path),
) -> Result<Cover, CoverError> {
    let trials = records.into_par_iter().map(|number| {
        let folder = folder.join(number.to_string());
        trial(family, number, errors, &Steps { bin, folder: &folder, pipeline: None })
    });
    let covers: Vec<Cover> = trials.collect::<Result<_, _>>()?;
    Ok(covers.iter().fold(Cover::default(), |mut total, one| {
        total.add(one);
        total
    }))
}

/// Draws a car, records its test, solves for its parameters and counts their intervals.
fn trial(family: &Family, number: usize, errors: Errors, programs: &Steps<'_>) -> Result<Cover, CoverError> {
    let car = measured((family.name, family.draw, number), errors, programs)?;
    let mut arguments = vec!["2.mcap", "3.mcap", "--json", "-o", "5.mcap"];
    arguments.extend(family.flags);
    let printed = programs.run("parameter-solve", &arguments)?;
    programs.remove_folder()?;
    count(family.id, number, &car, &printed)
}

/// Draws a car and measures its test: `2.mcap` and `3.mcap` in the folder of the programs. Without a pipeline no
/// input's uncertainty is propagated, so that the intervals are those of the fits.
pub(crate) fn measured(
    (name, draw, number): (&str, Draw, usize),
    errors: Errors,
    programs: &Steps<'_>,
) -> Result<Car, CoverError> {
    let mut random = RandomNumbers::seeded(blend(name, number));
    let car = draw.car(&mut random)?;
    programs.write("crash.csv", &record(&car, errors, &mut random)?)?;
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
pub(crate) fn count(id: &str, number: usize, car: &Car, printed: &str) -> Result<Cover, CoverError> {
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
            let value = nearest.parameters.get(name).copied();
            cover.count(number, (name, *truth, is_determined), (low, high));
            let rank = value.zip(low.zip(high)).map(|(value, ends)| rank(*truth, value, ends, HALF_OF_95_PERCENT));
            cover.parameters.entry(name.clone()).or_default().ranks.extend(rank);
        }
    }
    Ok(cover)
}

/// Half width, in deviations, of an interval of 95 % of a normal distribution.
const HALF_OF_95_PERCENT: f64 = 1.959_963_984_540_054;

/// Share of the posterior below the truth: uniform from 0 to 1 over many records if the posterior is right.
///
/// The posterior is the one that has the value as its median and the interval of `half_width` deviations: to each side
/// log-normal, where the interval is positive, else normal.
pub(crate) fn rank(truth: f64, value: f64, (low, high): (f64, f64), half_width: f64) -> f64 {
    let scale = |x: f64| if low > 0.0 && truth > 0.0 && value > 0.0 { x.ln() } else { x };
    let end = if truth > value { high } else { low };
    let (far, width) = (scale(truth) - scale(value), (scale(end) - scale(value)).abs());
    // An end at the value itself: nothing of the posterior is beyond it.
    let deviations = if width > 0.0 { half_width * far / width } else { far.signum() * f64::INFINITY };
    if far == 0.0 { 0.5 } else { normal_distribution(deviations) }
}

/// Closed intervals of one kind.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Closed {
    /// Those with the truth inside.
    pub held: usize,
    /// Their widths over the truth.
    pub widths: Vec<f64>,
}

/// The counts of one parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Counts {
    /// Closed intervals of records that determine the parameter, as the report says it.
    pub determined: Closed,
    /// Other closed intervals: the parameter is open, or known to an order of magnitude only.
    pub not_determined: Closed,
    /// Intervals that are open on a side.
    pub open: usize,
    /// `rank` of the truth by closed interval.
    pub ranks: Vec<f64>,
}

impl Closed {
    fn add(&mut self, other: &Self) {
        self.held += other.held;
        self.widths.extend(&other.widths);
    }

    /// How many, and how many in a hundred hold the truth.
    fn cells(&self) -> String {
        let count = self.widths.len();
        match count {
            0 => "0 | -".to_owned(),
            _ => format!("{count} | {:.1}", 100.0 * self.held as f64 / count as f64),
        }
    }

    /// Median width in percent of the truth.
    fn width(&self) -> String {
        let mut widths = self.widths.clone();
        widths.sort_by(f64::total_cmp);
        widths.get(widths.len() / 2).map_or_else(|| "-".to_owned(), |width| format!("{:.1}", 100.0 * width))
    }
}

/// A closed interval without the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Miss {
    /// Number of the record.
    pub record: usize,
    /// Name of the parameter.
    pub parameter: String,
    /// Its true value.
    pub truth: f64,
    /// The interval that was stated.
    pub interval: (f64, f64),
}

/// The counts of a family by parameter, and of records without a candidate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cover {
    /// By parameter.
    pub parameters: BTreeMap<String, Counts>,
    /// Records that gave no candidate.
    pub without: usize,
    /// Every closed interval that misses the truth, by the number of the record.
    pub misses: Vec<Miss>,
}

impl Cover {
    /// Adds another count of the same family.
    pub(crate) fn add(&mut self, other: &Self) {
        self.without += other.without;
        for (name, more) in &other.parameters {
            let counts = self.parameters.entry(name.clone()).or_default();
            counts.determined.add(&more.determined);
            counts.not_determined.add(&more.not_determined);
            counts.open += more.open;
            counts.ranks.extend(&more.ranks);
        }
        self.misses.extend(other.misses.iter().cloned());
    }

    /// Adds the interval that this record gives of a parameter whose true value is known.
    pub(crate) fn count(
        &mut self,
        record: usize,
        (parameter, truth, is_determined): (&str, f64, bool),
        (low, high): (Option<f64>, Option<f64>),
    ) {
        let counts = self.parameters.entry(parameter.to_owned()).or_default();
        let Some((low, high)) = low.zip(high) else {
            counts.open += 1;
            return;
        };
        let closed = if is_determined { &mut counts.determined } else { &mut counts.not_determined };
        closed.widths.push((high - low) / truth);
        if low <= truth && truth <= high {
            closed.held += 1;
        } else {
            self.misses.push(Miss { record, parameter: parameter.to_owned(), truth, interval: (low, high) });
        }
    }

    /// All closed intervals: how many hold the truth, of how many, and the median width in percent of the truth of
    /// those of parameters whose name ends so.
    pub(crate) fn held(&self, unit: &str) -> (usize, usize, String) {
        let mut all = Closed::default();
        let mut of_unit = Closed::default();
        for (name, counts) in &self.parameters {
            for closed in [&counts.determined, &counts.not_determined] {
                all.add(closed);
                if name.ends_with(unit) {
                    of_unit.add(closed);
                }
            }
        }
        (all.held, all.widths.len(), of_unit.width())
    }

    /// What stands over the [`rows`](Self::rows).
    pub const HEAD: &str = "| family | parameter | determined | cover, % | median width, % | closed, not determined | \
                            cover, % | open | records without a candidate |\n|---|---|---|---|---|---|---|---|---|";

    /// Rows of a Markdown table: family, parameter; of records that determine it how many, cover and median width in
    /// percent of the truth; other closed intervals and their cover; open, without a candidate.
    pub fn rows(&self, family: &str) -> String {
        let mut rows = String::new();
        for (name, counts) in &self.parameters {
            let (determined, others) = (&counts.determined, &counts.not_determined);
            let _infallible = writeln!(
                rows,
                "| {family} | {name} | {} | {} | {} | {} | {} |",
                determined.cells(),
                determined.width(),
                others.cells(),
                counts.open,
                self.without
            );
        }
        rows
    }
}

impl std::fmt::Display for Miss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { record, parameter, truth, interval: (low, high) } = self;
        write!(f, "record {record}: {parameter} = {truth:.6e} is not in {low:.6e} to {high:.6e}")
    }
}

/// A model that cars are made of.
#[derive(Debug, Clone, Copy)]
pub struct Drawn {
    /// Name in the table.
    pub name: &'static str,
    /// Model name of its candidates.
    model: &'static str,
    pub(crate) draw: Draw,
}

/// All of them.
pub const DRAWN: &[Drawn] = &[
    Drawn { name: "kelvin", model: "kelvin", draw: Draw::Kelvin },
    Drawn { name: "elastoplastic", model: "elastoplastic", draw: Draw::Elastoplastic },
    Drawn { name: "maxwell", model: "maxwell", draw: Draw::Maxwell },
    Drawn { name: "nonlinear-1", model: "nonlinear-1", draw: Draw::Nonlinear1 },
    Drawn { name: "nonlinear-2", model: "nonlinear-2", draw: Draw::Nonlinear2 },
    Drawn {
        name: "double",
        model: "double-spring-mass-damper",
        draw: Draw::Double { front: (0.25, 0.25), engine: false },
    },
    Drawn {
        name: "double, split 15 to 35 % taken as 25 %",
        model: "double-spring-mass-damper",
        draw: Draw::Double { front: (0.15, 0.35), engine: false },
    },
    Drawn {
        name: "double-two-sensors, split 18 to 33 % taken as 25 %",
        model: "double-spring-mass-damper",
        draw: Draw::Double { front: (0.18, 0.33), engine: true },
    },
    Drawn { name: "triple", model: "triple-spring-mass-damper", draw: Draw::Triple },
    Drawn { name: "force-deflection", model: "force-deflection", draw: Draw::ForceDeflection },
];

/// A record tells two candidates apart where their criteria differ by more (Burnham & Anderson 2002, section 2.6:
/// essentially no support above 10).
const TOLD_APART: f64 = 10.0;

/// What a record's choice is, beside the model it was made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Choice {
    /// That model.
    True,
    /// Another, whose criterion is not worse by more than [`TOLD_APART`].
    NotToldApart,
    /// Another, where the record leaves numbers of the true model open: a rule passes such a model over for one that
    /// the record's own force over crush makes.
    OpenNumbers,
    /// Another.
    Other,
    /// None.
    Nothing,
}

/// Counts of choices.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Choices {
    records: usize,
    /// Records with the true model, or one not told apart, as recommended or simplest.
    held: usize,
    /// Of the others, those that leave numbers of the true model open.
    open: usize,
    /// By name in the recommendation and choice.
    counts: BTreeMap<(&'static str, Choice), usize>,
    /// Models recommended where the record tells them from the true one.
    others: BTreeMap<String, usize>,
    /// Intervals of the true model: of its fitted candidate, or of its closed form.
    cover: Cover,
}

/// The choices over the cars of these numbers, by the programs in `bin` with a pipeline.
///
/// A car and its noise follow from its number and model alone. Errors: a program that is missing or fails.
pub fn choices_of(
    drawn: &Drawn,
    numbers: Range<usize>,
    errors: Errors,
    (bin, pipeline): (&Path, &Path),
    folder: &Path,
) -> Result<Choices, CoverError> {
    let recommendations = numbers.into_par_iter().map(|number| -> Result<(Value, Cover), CoverError> {
        let folder = folder.join(number.to_string());
        let programs = Steps { bin, folder: &folder, pipeline: None };
        let car = measured((drawn.name, drawn.draw, number), errors, &programs)?;
        let programs = Steps { pipeline: Some(pipeline), ..programs };
        programs.run("identify", &["2.mcap", "3.mcap", "-o", "4.mcap"])?;
        let mut arguments = vec!["2.mcap", "3.mcap", "4.mcap", "--json", "-o", "5.mcap"];
        arguments.extend(if car.engine { &["--sensors", "compartment=accel,engine=engine"][..] } else { &[] });
        let printed = programs.run("parameter-solve", &arguments)?;
        programs.remove_folder()?;
        let mut cover = count(&format!("{}/direct-fit", drawn.model), number, &car, &printed)?;
        if cover.parameters.is_empty() {
            cover = count(&format!("{}/closed-form", drawn.model), number, &car, &printed)?;
        }
        let recommendation = records(&printed, "/recommendation").next().map(|(_, record)| record);
        Ok((recommendation.unwrap_or_default(), cover))
    });
    let recommendations: Vec<(Value, Cover)> = recommendations.collect::<Result<_, _>>()?;
    let mut choices = Choices::default();
    for (recommendation, cover) in &recommendations {
        choices.count(recommendation, drawn.model);
        choices.cover.add(cover);
    }
    Ok(choices)
}

/// The model of a candidate's id.
fn model_of(id: &str) -> &str {
    id.split_once('/').map_or(id, |(model, _)| model)
}

impl Choices {
    fn count(&mut self, recommendation: &Value, model: &str) {
        let candidates = recommendation["candidates"].as_array().map_or(&[][..], Vec::as_slice);
        let criterion = |of: &dyn Fn(&str) -> bool| {
            let of = candidates.iter().filter(|candidate| candidate["id"].as_str().is_some_and(of));
            of.filter_map(|candidate| candidate["aicc"].as_f64()).min_by(f64::total_cmp)
        };
        let truth = criterion(&|id| model_of(id) == model);
        let number = |candidate: &Value, name: &str| candidate[name].as_f64();
        let mut of_truth = candidates.iter().filter(|c| c["id"].as_str().is_some_and(|id| model_of(id) == model));
        let leaves_open = of_truth.all(|c| number(c, "determined") < number(c, "parameters"));
        let choice = |name: &str| match recommendation[name].as_str() {
            None => Choice::Nothing,
            Some(id) if model_of(id) == model => Choice::True,
            Some(id) => match criterion(&|other| other == id).zip(truth) {
                Some((chosen, truth)) if chosen <= truth + TOLD_APART => Choice::NotToldApart,
                Some(_) if leaves_open => Choice::OpenNumbers,
                _ => Choice::Other,
            },
        };
        let named = ["recommended", "simplest"].map(|name| (name, choice(name)));
        self.records += 1;
        let best = named.iter().map(|(_, choice)| *choice).min();
        self.held += usize::from(best.is_some_and(|choice| choice <= Choice::NotToldApart));
        self.open += usize::from(best == Some(Choice::OpenNumbers));
        for key in named {
            *self.counts.entry(key).or_default() += 1;
        }
        if let (Choice::Other, Some(id)) = (named[0].1, recommendation["recommended"].as_str()) {
            *self.others.entry(model_of(id).to_owned()).or_default() += 1;
        }
    }

    /// Share of records, %, with the true model or one not told apart as recommended or simplest, with those that leave
    /// numbers of the true model open.
    pub fn held_percent(&self) -> f64 {
        100.0 * (self.held + self.open) as f64 / self.records as f64
    }

    /// Head of the table of [`Choices::row`].
    pub const HEAD: &str = "\
| made of | held, % | held, or open numbers, % | recommended: it / not told apart / open numbers / other / none \
| simplest | others | intervals that hold | width of stiffnesses, % |
|---|---|---|---|---|---|---|---|";

    /// A row of a Markdown table: model, share of records with the true model or one not told apart, %, the same with
    /// the records that leave numbers of that model open, then the counts of the recommended and of the simplest: true,
    /// not told apart, open numbers, other, none; others that are recommended; of the closed 95 %
    /// intervals of the true model those that hold the truth, and the median width of those of stiffnesses.
    pub fn row(&self, name: &str) -> String {
        let held = 100.0 * self.held as f64 / self.records as f64;
        let mut row = format!("| {name} | {held:.1} | {:.1} |", self.held_percent());
        for of in ["recommended", "simplest"] {
            let count = |choice| self.counts.get(&(of, choice)).copied().unwrap_or_default();
            let [truth, not_told_apart, open, other, nothing] =
                [Choice::True, Choice::NotToldApart, Choice::OpenNumbers, Choice::Other, Choice::Nothing].map(count);
            let _infallible = write!(row, " {truth} / {not_told_apart} / {open} / {other} / {nothing} |");
        }
        let others: Vec<String> = self.others.iter().map(|(model, count)| format!("{model} {count}")).collect();
        let (held, closed, width) = self.cover.held("_n_per_m");
        let _infallible = writeln!(row, " {} | {held} of {closed} | {width} |", others.join(", "));
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_at_an_end_of_a_95_percent_interval_has_the_ranks_2_5_and_97_5_percent() {
        let of = |truth: f64| rank(truth, 2.0, (1.0, 8.0), HALF_OF_95_PERCENT);
        for (truth, wanted) in [(1.0, 0.025), (2.0, 0.5), (8.0, 0.975)] {
            assert!((of(truth) - wanted).abs() < 1e-6, "{truth}: {}", of(truth));
        }
        // One deviation of a log-normal side.
        assert!((of(2.0 * 4.0_f64.powf(1.0 / HALF_OF_95_PERCENT)) - normal_distribution(1.0)).abs() < 1e-9);
        // An interval that reaches zero is normal; one that ends at the value has nothing beyond.
        assert!((rank(1.0, 2.0, (0.0, 4.0), HALF_OF_95_PERCENT) - normal_distribution(-0.979_982)).abs() < 1e-6);
        assert_eq!(rank(3.0, 2.0, (1.0, 2.0), HALF_OF_95_PERCENT), 1.0);
    }

    #[test]
    fn closed_intervals_are_counted_apart_from_open_ones() {
        let mut cover = Cover::default();
        cover.count(0, ("k", 2.0, true), (Some(1.0), Some(3.0)));
        cover.count(1, ("k", 4.0, true), (Some(1.0), Some(3.0)));
        cover.count(2, ("k", 2.0, false), (None, Some(3.0)));
        cover.count(3, ("k", 2.0, false), (Some(1e-4), Some(3.0)));
        let mut both = cover.clone();
        both.add(&cover);
        let counts = &cover.parameters["k"];
        assert_eq!(counts.determined, Closed { held: 1, widths: vec![1.0, 0.5] });
        assert_eq!((counts.not_determined.held, counts.open), (1, 1));
        assert_eq!(cover.held("k"), (2, 3, "100.0".to_owned()));
        assert_eq!(cover.held("c"), (2, 3, "-".to_owned()));
        assert_eq!(cover.rows("x"), "| x | k | 2 | 50.0 | 100.0 | 1 | 100.0 | 1 | 0 |\n");
        assert_eq!(both.rows("x"), "| x | k | 4 | 50.0 | 100.0 | 2 | 100.0 | 2 | 0 |\n");
        assert_eq!(cover.misses[0].to_string(), "record 1: k = 4.000000e0 is not in 1.000000e0 to 3.000000e0");
    }

    #[test]
    fn a_record_that_cannot_tell_two_models_apart_counts_for_both() {
        let candidate = |id: &str, aicc: f64| serde_json::json!({ "id": id, "aicc": aicc });
        let mut choices = Choices::default();
        for (recommended, simplest) in [("a/fit/1", "b/fit/1"), ("b/fit/1", "c/fit/1"), ("c/fit/1", "c/fit/1")] {
            let candidates = [candidate("a/fit/1", 0.0), candidate("b/fit/1", 9.0), candidate("c/fit/1", 11.0)];
            let record = serde_json::json!({
                "recommended": recommended, "simplest": simplest, "candidates": candidates
            });
            choices.count(&record, "a");
        }
        choices.count(&serde_json::json!({ "recommended": null, "simplest": null }), "a");
        // Of the true model one number of two is open, or none.
        for determined in [1, 2] {
            let truth = serde_json::json!({ "id": "a/fit/1", "aicc": 0.0, "parameters": 2, "determined": determined });
            choices.count(
                &serde_json::json!({
                    "recommended": "c/fit/1", "simplest": null, "candidates": [truth, candidate("c/fit/1", 11.0)],
                }),
                "a",
            );
        }
        assert_eq!(
            choices.row("a"),
            "| a | 33.3 | 50.0 | 1 / 1 / 1 / 2 / 1 | 0 / 1 / 0 / 2 / 3 | c 2 | 0 of 0 | - |\n"
        );
    }
}
