//! How often the model that a record was made of is the one that is recommended, or the simplest.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;
use serde_json::Value;

use super::car::Draw;
use super::cover::Cover;
use super::trial::{CoverError, count, measured};
use crate::programs::steps::{Steps, records};

/// A model that cars are made of.
#[derive(Debug, Clone, Copy)]
pub struct Drawn {
    /// Name in the table.
    pub name: &'static str,
    /// Model name of its candidates.
    model: &'static str,
    pub(super) draw: Draw,
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
    /// Another, where the record has too few independent samples for the numbers of that model, so that its corrected
    /// criterion is infinite, and where the uncorrected one is not worse by more than [`TOLD_APART`] either.
    TooFewSamples,
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
    /// Of the others, those too short for the numbers of the true model.
    too_short: usize,
    /// By name in the recommendation and choice.
    counts: BTreeMap<(&'static str, Choice), usize>,
    /// Models recommended where the record tells them from the true one.
    others: BTreeMap<String, usize>,
    /// Intervals of the true model: of its fitted candidate, or of its closed form.
    cover: Cover,
}

/// The choices over the cars of these numbers, by the programs in `bin` with a pipeline.
///
/// A car and its noise follow from its number and model alone. `clean`: trigger and stated speed without error, a
/// filter without phase. Errors: a program that is missing or fails.
pub fn choices_of(
    drawn: &Drawn,
    numbers: Range<usize>,
    clean: bool,
    (bin, pipeline): (&Path, &Path),
    folder: &Path,
) -> Result<Choices, CoverError> {
    let recommendations = numbers.into_par_iter().map(|number| -> Result<(Value, Cover), CoverError> {
        let folder = folder.join(number.to_string());
        let programs = Steps { bin, folder: &folder, pipeline: None };
        let car = measured((drawn.name, drawn.draw, number), clean, &programs)?;
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
        // `N ln V + 2 p`, Akaike's criterion without a correction for short records.
        let samples = recommendation["evidence"]["effective_samples"].as_f64();
        let uncorrected = |of: &dyn Fn(&str) -> bool| {
            let of = candidates.iter().filter(|candidate| candidate["id"].as_str().is_some_and(of));
            let value = |candidate: &Value| {
                let (misfit, parameters) = (candidate["misfit"].as_f64()?, candidate["parameters"].as_f64()?);
                Some(2.0 * samples? * misfit.ln() + 2.0 * parameters)
            };
            of.filter_map(value).min_by(f64::total_cmp)
        };
        let too_short = uncorrected(&|id| model_of(id) == model).filter(|_| truth.is_none());
        let choice = |name: &str| match recommendation[name].as_str() {
            None => Choice::Nothing,
            Some(id) if model_of(id) == model => Choice::True,
            Some(id) => match criterion(&|other| other == id).zip(truth) {
                Some((chosen, truth)) if chosen <= truth + TOLD_APART => Choice::NotToldApart,
                None => match uncorrected(&|other| other == id).zip(too_short) {
                    Some((chosen, truth)) if chosen <= truth + TOLD_APART => Choice::TooFewSamples,
                    _ => Choice::Other,
                },
                _ => Choice::Other,
            },
        };
        let named = ["recommended", "simplest"].map(|name| (name, choice(name)));
        self.records += 1;
        let best = named.iter().map(|(_, choice)| *choice).min();
        self.held += usize::from(best.is_some_and(|choice| choice <= Choice::NotToldApart));
        self.too_short += usize::from(best == Some(Choice::TooFewSamples));
        for key in named {
            *self.counts.entry(key).or_default() += 1;
        }
        if let (Choice::Other, Some(id)) = (named[0].1, recommendation["recommended"].as_str()) {
            *self.others.entry(model_of(id).to_owned()).or_default() += 1;
        }
    }

    /// Share of records, %, with the true model or one not told apart as recommended or simplest, with those that have
    /// too few independent samples for that model and do not tell it apart by the uncorrected criterion.
    pub fn held_percent(&self) -> f64 {
        100.0 * (self.held + self.too_short) as f64 / self.records as f64
    }

    /// Head of the table of [`Choices::row`].
    pub const HEAD: &str = "\
| made of | held, % | held, or too few samples, % | recommended: it / not told apart / too few samples / other / none \
| simplest | others | intervals that hold | width of stiffnesses, % |
|---|---|---|---|---|---|---|---|";

    /// A row of a Markdown table: model, share of records with the true model or one not told apart, %, the same with
    /// the records that have too few independent samples for that model, then the counts of the recommended and of the
    /// simplest: true, not told apart, too few samples, other, none; others that are recommended; of the closed 95 %
    /// intervals of the true model those that hold the truth, and the median width of those of stiffnesses.
    pub fn row(&self, name: &str) -> String {
        let held = 100.0 * self.held as f64 / self.records as f64;
        let mut row = format!("| {name} | {held:.1} | {:.1} |", self.held_percent());
        for of in ["recommended", "simplest"] {
            let count = |choice| self.counts.get(&(of, choice)).copied().unwrap_or_default();
            let [truth, not_told_apart, too_few, other, nothing] =
                [Choice::True, Choice::NotToldApart, Choice::TooFewSamples, Choice::Other, Choice::Nothing].map(count);
            let _infallible = write!(row, " {truth} / {not_told_apart} / {too_few} / {other} / {nothing} |");
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
        // A criterion of the true model that nobody can state: too many numbers for the samples.
        let too_many = serde_json::json!({ "id": "a/fit/1", "aicc": null, "misfit": 0.1, "parameters": 9 });
        // 9 ln V + 2 p: 7 numbers less are worth a misfit larger by exp(7/9), and 10 more one by exp(12/9).
        for ratio in [1.3_f64, 1.4] {
            let misfit = 0.1 * ratio.exp();
            let other = serde_json::json!({ "id": "c/fit/1", "aicc": 11.0, "misfit": misfit, "parameters": 2 });
            choices.count(
                &serde_json::json!({
                    "recommended": "c/fit/1", "simplest": null, "candidates": [too_many, other],
                    "evidence": { "effective_samples": 9.0 }
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
